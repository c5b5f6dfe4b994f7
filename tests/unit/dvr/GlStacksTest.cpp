// SPDX-License-Identifier: GPL-3.0-or-later
// Object-aligned stacks against a double evaluation of their own slices, and several slices on a polygon
// against one.
#include <gmock/gmock.h>

#include "GlCases.h"
#include "StackGeometry.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

// From three sides, so that each of the stacks is needed once.
struct Side {
  double azimuth_deg, elevation_deg;
  int axis;
};
constexpr Side kSides[] = {{25, 15, 1}, {70, 10, 0}, {10, 75, 2}};

void lookFrom(DvrCase& c, const Side& side) {
  c.scene.camera.azimuth_deg = side.azimuth_deg, c.scene.camera.elevation_deg = side.elevation_deg;
  EXPECT_EQ(dvr::stackAxis(c.camera(), c.volume().grid()), side.axis);
}

void expectStack(const DvrCase& c, const std::string& technique = "dvr.stacks", double share = 0.001) {
  const DvrTruth truth(c);
  const int axis = dvr::stackAxis(c.camera(), c.volume().grid()),
            perVoxel = dvr::slicesPerVoxel(c.quality.step);
  expectClose(
      c, technique, [&](double x, double y) { return truth.stack(x, y, axis, perVoxel); }, share);
}

void cut(DvrCase& c) {
  c.scene.crop = CropBox{VoxelPoint(3.2, 2.7, 1.1), VoxelPoint(26.4, 25.1, 19.6)};
  const PatientPoint middle = c.volume().grid().centre();
  const PatientVec n = normalize(PatientVec(1, 2, -0.5)), m = normalize(PatientVec(-1, 0.3, 0.7));
  c.scene.clip = {{n, dot(n, PatientVec(middle.p)) + 2.3}, {m, dot(m, PatientVec(middle.p)) + 4}};
}

TEST(GlStacks, TheirOwnSlicesFromAllSidesInBothProjections) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const Side& side : kSides)
      for (const double step : {1.0, 0.5, 0.25}) {
        DvrCase c;
        c.scene.camera.projection = projection, c.quality.step = step;
        lookFrom(c, side);
        expectStack(c);
      }
}

TEST(GlStacks, FromTheOtherSideAndLeftHanded) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections) {
    DvrCase c(bumpyVolume(tiltedGrid(30, 28, 22, {0.8, 0.9, 1.2}, true)));
    c.scene.camera.projection = projection;
    c.scene.camera.azimuth_deg = 205, c.scene.camera.elevation_deg = -60;
    expectStack(c);
  }
}

TEST(GlStacks, EveryWayOfReadingAndClassifying) {
  VERNIER_NEEDS_GL(device);
  for (int way = 0; way < 6; ++way) {
    SCOPED_TRACE(way);
    // The unit grid, so that the probe's places between no-data voxels are exact.
    DvrCase c(way == 4   ? bumpyVolume(unitGrid(30, 28, 22), NoDataRange{500, 2000})
              : way == 5 ? colourVolume()
                         : bumpyVolume());
    c.quality.step = way == 0 ? 1 : 0.5;  // nearest: slices in the middle would be as near to both
    c.scene.camera.projection = way % 2 ? Projection::Perspective : Projection::Orthographic;
    if (way == 0) c.layer().interpolation = Interpolation::Nearest;
    if (way == 1) c.layer().classification = Classification::Pre;
    if (way == 2) c.layer().opacity = OpacityRule::Linear;
    if (way == 3) c.layer().transfer->opacities = {{0, 0}, {150, 1}};
    if (way == 5) c.layer().gains = {1.2, 0.8, 2, 1.7};
    expectStack(c, "dvr.stacks", way == 0 ? 0.02 : 0.001);
  }
}

TEST(GlStacks, CropClipPlanesAndToolsSplitSlabs) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const double step : {1.0, 0.5}) {
      DvrCase c;
      c.scene.camera.projection = projection, c.quality.step = step;
      c.scene.camera.near_mm = projection == Projection::Perspective ? 45 : 22;
      cut(c);
      c.addTool(3, 7, 1);
      expectStack(c);
    }
}

TEST(GlStacks, TheEyeInsideTheVolume) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : {"dvr.stacks", "dvr.stacks2", "dvr.stacks4"}) {
    DvrCase c;
    c.scene.camera.projection = Projection::Perspective, c.scene.camera.fov_deg = 140;
    // Turned so far that some rays meet the slices the other way round.
    c.scene.camera.distance_mm = 3, c.scene.camera.azimuth_deg = 40, c.scene.camera.elevation_deg = 25;
    c.layer().transfer->opacityLength_mm = 8;
    expectStack(c, technique);
  }
}

// The polygons of several slices give what one slice after the other gives (RENDERING 3).
TEST(GlStacks, SeveralSlicesOnAPolygonEqualSingleOnes) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const double step : {1.0, 0.5, 0.25})
      for (const char* technique : {"dvr.stacks2", "dvr.stacks4"}) {
        DvrCase c;
        c.scene.camera.projection = projection, c.quality.step = step;
        if (step == 0.5) c.scene.camera.azimuth_deg += 180;  // from where slices are met the other way round
        cut(c);
        const Result<Images> single = c.draw("dvr.stacks"), several = c.draw(technique);
        ASSERT_TRUE(single.ok() && several.ok());
        expectSomething(c, *single);
        const Off off = offFrom(*several, colourOf(*single));
        EXPECT_LT(off.worst, 0.5) << technique << " step " << step;
        expectStack(c, technique);
      }
}

TEST(GlStacks, UncorrectedPolygonsAreSeenToBeWrong) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections) {
    DvrCase c;
    c.scene.camera.projection = projection;
    c.scene.camera.azimuth_deg = 35, c.scene.camera.elevation_deg = 25;
    const Result<Images> single = c.draw("dvr.stacks"), wrong = c.draw("dvr.stacks2-uncorrected");
    ASSERT_TRUE(single.ok() && wrong.ok());
    EXPECT_GT(offFrom(*wrong, colourOf(*single)).worst, 10);
    // Straight at the slices both are the same.
    DvrCase straight(bumpyVolume(unitGrid(30, 28, 22)));
    const Result<Images> one = straight.draw("dvr.stacks");
    straight.scene.camera = {};
    const Result<Images> a = straight.draw("dvr.stacks"), b = straight.draw("dvr.stacks2-uncorrected");
    EXPECT_LT(offFrom(*b, colourOf(*a)).worst, 0.01);
  }
}

TEST(GlStacks, MoreSlicesApproachTheRays) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  c.scene.camera.projection = Projection::Perspective;
  DvrCase fine = c;
  fine.quality.step = 1.0 / 32;
  const Result<Images> rays = fine.draw("dvr.rays");
  double before = 1e9;
  for (const double step : {1.0, 0.5, 0.25, 0.125}) {
    c.quality.step = step;
    const double rms = offFrom(*c.draw("dvr.stacks"), colourOf(*rays)).rms;
    EXPECT_LT(rms, 0.6 * before);
    before = rms;
  }
  EXPECT_LT(before, 0.5);
}

TEST(GlStacks, ShadingReadsGradientTextures) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const ShadingModel model : {ShadingModel::GlobalAmbient, ShadingModel::ColourPerVoxel}) {
      DvrCase c(bumpyVolume(tiltedGrid(30, 28, 22), {}, 40));
      c.scene.camera.projection = projection, c.quality.step = 0.5;
      c.layer().shading = model;
      c.layer().material.ambientColour = {0.3, 0.4, 0.9};
      c.scene.lights = {Light{}, Light{PatientVec(1, -2, 3), {0.7, 0.2, 0.1}}};
      expectStack(c);
      expectStack(c, "dvr.stacks2");
    }
}

TEST(GlStacks, IsoSurfacesByTheAlphaTest) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const char* technique : {"dvr.stacks", "dvr.stacks4"}) {
      DvrCase c(bumpyVolume(tiltedGrid(30, 28, 22)), true);
      c.scene.camera.projection = projection, c.scene.camera.zoom = 2, c.quality.step = 0.25;
      c.scene.lights = {Light{}, Light{PatientVec(-1, -2, 1), {0.2, 0.3, 0.9}}};
      c.addTool(1, 4, 1);
      const DvrTruth truth(c);
      const int axis = dvr::stackAxis(c.camera(), c.volume().grid());
      // At the level itself rounding decides.
      expectClose(
          c, technique, [&](double x, double y) { return truth.stackIso(x, y, axis, 4); }, 0.002);
    }
}

TEST(GlStacks, ExtremesOfTheSlices) {
  VERNIER_NEEDS_GL(device);
  for (const VolumeMode mode : {VolumeMode::Max, VolumeMode::Min})
    for (const char* technique : {"dvr.stacks", "dvr.stacks2"}) {
      DvrCase c;
      c.layer().mode = mode;
      if (mode == VolumeMode::Min) c.layer().transfer->opacities = {{-100, 0.3}, {300, 0.9}};
      cut(c);
      const DvrTruth truth(c);
      const int axis = dvr::stackAxis(c.camera(), c.volume().grid());
      expectClose(c, technique, [&](double x, double y) { return truth.stackExtreme(x, y, axis, 1); });
    }
}

TEST(GlStacks, OnlyTheStackThatTheViewNeedsAndGradientsOnlyWhereItShades) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  lookFrom(c, kSides[2]);
  const Result<Images> first = c.draw("dvr.stacks");
  EXPECT_EQ(first->counters.textures3dCreated, 0u);
  const Result<Images> again = c.draw("dvr.stacks");
  EXPECT_EQ(again->colour, first->colour);
  EXPECT_EQ(first->counters.texturesCreated - again->counters.texturesCreated, 22u);
  EXPECT_EQ(first->counters.bytesUploaded - again->counters.bytesUploaded, 30u * 28 * 22 * 2);
  const DvrTruth truth(c);
  std::uint64_t met = 0;
  for (int y = 0; y < c.view.height_px; ++y)
    for (int x = 0; x < c.view.width_px; ++x)
      if (const RaySpan s = truth.span(x + 0.5, y + 0.5); !s.empty())
        met += truth.stackSamples(x + 0.5, y + 0.5, s, 2, 1).size();
  EXPECT_EQ(first->counters.samples, met);
  EXPECT_EQ(c.draw("dvr.stacks2")->counters.samples, met);
  // More slices need no more textures; several on a polygon draw fewer triangles.
  c.quality.step = 0.25;
  const Result<Images> more = c.draw("dvr.stacks");
  EXPECT_EQ(more->counters.texturesCreated, again->counters.texturesCreated);
  EXPECT_GT(more->counters.samples, 3 * again->counters.samples);
  EXPECT_LT(c.draw("dvr.stacks4")->counters.triangles, 0.6 * static_cast<double>(more->counters.triangles));
  c.quality.step = 1;
  lookFrom(c, kSides[1]);
  const Result<Images> other = c.draw("dvr.stacks");
  EXPECT_GE(other->counters.bytesUploaded, 30u * 28 * 22 * 2);
  c.layer().shading = ShadingModel::ColourPerVoxel;
  EXPECT_GE(c.draw("dvr.stacks")->counters.bytesUploaded, 30u * 28 * 22 * 16);
}

TEST(GlStacks, DepthIsWithinABatchOfWhereHalfTheLightIsGone) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  const Result<Images> stacks = c.draw("dvr.stacks"), rays = c.draw("dvr.rays");
  int both = 0, one = 0;
  for (std::size_t n = 0; n < rays->depth.size(); ++n) {
    const bool hit = !std::isinf(rays->depth[n]), met = !std::isinf(stacks->depth[n]);
    one += hit != met, both += hit && met;
    if (hit && met) {
      EXPECT_NEAR(stacks->depth[n], rays->depth[n], 8 * 1.2 * 1.5);
    }
  }
  EXPECT_GT(both, 300);
  EXPECT_LT(one, both / 10);
}

TEST(GlStacks, AllStateIsStated) {
  VERNIER_NEEDS_GL(device);
  for (int way = 0; way < 3; ++way) {
    DvrCase c(bumpyVolume(), way == 1);
    if (way == 2) c.layer().mode = VolumeMode::Max;
    const Result<Images> clean = c.draw("dvr.stacks2");
    for (const unsigned seed : {1u, 2u}) {
      device->setOddStateForTest(seed);
      EXPECT_EQ(c.draw("dvr.stacks2")->colour, clean->colour);
    }
  }
}

TEST(StackGeometry, TheAxisChangesAt45Degrees) {
  const auto volume = bumpyVolume(unitGrid(8, 8, 8));
  DvrCase c(volume);
  c.scene.camera = {};
  for (int degree = 0; degree <= 90; ++degree) {
    if (degree == 45) continue;
    c.scene.camera.azimuth_deg = degree;
    EXPECT_EQ(dvr::stackAxis(c.camera(), volume->grid()), degree < 45 ? 1 : 0) << degree;
  }
  c.scene.camera = {};
  for (int degree = 0; degree <= 90; ++degree) {
    if (degree == 45) continue;
    c.scene.camera.elevation_deg = degree;
    EXPECT_EQ(dvr::stackAxis(c.camera(), volume->grid()), degree < 45 ? 1 : 2) << degree;
  }
}

TEST(StackGeometry, SlicesBetweenSlices) {
  const auto slices = dvr::stackSlices(3, 4);
  ASSERT_EQ(slices.size(), 9u);
  EXPECT_EQ(slices[5].lower, 1);
  EXPECT_EQ(slices[5].alpha, 0.25);
  EXPECT_EQ(slices[5].place, 1.25);
  EXPECT_EQ(slices[8].alpha, 0);
  EXPECT_EQ(dvr::slicesPerVoxel(1), 1);
  EXPECT_EQ(dvr::slicesPerVoxel(0.5), 2);
  EXPECT_EQ(dvr::slicesPerVoxel(0.25), 4);
  EXPECT_EQ(dvr::slicesPerVoxel(1.0 / 32), 8);
}

}  // namespace
}  // namespace vernier::test
