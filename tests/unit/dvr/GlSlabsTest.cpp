// SPDX-License-Identifier: GPL-3.0-or-later
// View-aligned slices through slabs, and cut into strips, against a double evaluation of the same slices.
#include <gmock/gmock.h>

#include "GlCases.h"
#include "SlabGeometry.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kSlice = 30 * 28 * 2;  // bytes of a slice of bumpyVolume
constexpr const char* kBoth[] = {"dvr.slabs", "dvr.strips"};

void expectSlices(const DvrCase& c, const std::string& technique = "dvr.slabs", double share = 0.001) {
  const DvrTruth truth(c);
  expectClose(
      c, technique, [&](double x, double y) { return truth.rays(x, y, true); }, share);
}

void cut(DvrCase& c) {
  c.scene.crop = CropBox{VoxelPoint(3.2, 2.7, 1.1), VoxelPoint(26.4, 25.1, 19.6)};
  const PatientPoint middle = c.volume().grid().centre();
  const PatientVec n = normalize(PatientVec(1, 2, -0.5));
  c.scene.clip = {{n, dot(n, PatientVec(middle.p)) + 2.3}};
  c.scene.camera.near_mm = c.scene.camera.projection == Projection::Perspective ? 45 : 22;
}

TEST(GlSlabs, TheirOwnSlicesInBothProjections) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : kBoth)
    for (const Projection projection : kBothProjections)
      for (const double step : {1.0, 0.4}) {
        DvrCase c;
        c.scene.camera.projection = projection, c.quality.step = step;
        c.budget = 7 * kSlice;
        expectSlices(c, technique);
        cut(c);
        c.addTool(3, 7, 1);
        expectSlices(c, technique);
      }
}

TEST(GlSlabs, OrthographicSlicesAreTheRaysLattice) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  cut(c);
  EXPECT_LT(offFrom(*c.draw("dvr.slabs"), colourOf(*c.draw("dvr.rays"))).worst, 0.13);  // rays end early
}

TEST(GlSlabs, MovingABorderChangesNothing) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections)
    for (const double elevation : {15.0, -80.0}) {
      DvrCase c;
      c.scene.camera.projection = projection, c.scene.camera.elevation_deg = elevation;
      const Result<Images> whole = c.draw("dvr.slabs");
      EXPECT_LE(whole->counters.textures3dCreated, 1u);
      for (const std::uint64_t slices : {2, 3, 5, 8, 13, 21}) {
        c.budget = slices * kSlice;
        const Result<Images> images = c.draw("dvr.slabs");
        ASSERT_TRUE(images.ok()) << images.error().text();
        EXPECT_LT(offFrom(*images, colourOf(*whole)).worst, 0.25) << slices;
      }
    }
}

TEST(GlSlabs, EveryWayOfReadingAndClassifying) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : kBoth)
    for (int way = 0; way < 6; ++way) {
      SCOPED_TRACE(way);
      DvrCase c(way == 4   ? bumpyVolume(tiltedGrid(30, 28, 22), NoDataRange{500, 2000})
                : way == 5 ? colourVolume()
                           : bumpyVolume());
      c.scene.camera.projection = way % 2 ? Projection::Perspective : Projection::Orthographic;
      c.budget = 9 * kSlice;
      if (way == 0) c.layer().interpolation = Interpolation::Nearest;
      if (way == 1) c.layer().classification = Classification::Pre;
      if (way == 2) c.layer().opacity = OpacityRule::Linear;
      if (way == 3) c.layer().transfer->opacities = {{0, 0}, {150, 1}};
      if (way == 5) c.layer().gains = {1.2, 0.8, 2, 1.7};
      expectSlices(c, technique, way == 0 ? 0.03 : 0.001);
    }
}

TEST(GlSlabs, PreIntegratedTablesNeedTheVolumeAsOne) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : kBothProjections) {
    DvrCase c;
    c.scene.camera.projection = projection, c.view = {40, 36};
    c.layer().classification = Classification::PreIntegrated;
    c.layer().transfer->opacities = {{40, 0}, {60, .5}, {80, .1}, {300, .9}};
    cut(c);
    expectSlices(c);
    c.budget = 9 * kSlice;
    EXPECT_THAT(c.plan("dvr.slabs").error().sentence, HasSubstr("GL holds 9 of its 22 slices"));
  }
}

TEST(GlSlabs, ShadedWithGradientSlabs) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : kBoth)
    for (const Projection projection : kBothProjections) {
      DvrCase c(bumpyVolume(tiltedGrid(30, 28, 22), {}, 40));
      c.scene.camera.projection = projection;
      c.layer().shading =
          projection == Projection::Perspective ? ShadingModel::GlobalAmbient : ShadingModel::ColourPerVoxel;
      c.scene.lights = {Light{}, Light{PatientVec(1, -2, 3), {0.7, 0.2, 0.1}}};
      c.budget = 10 * 8 * kSlice;
      expectSlices(c, technique);
    }
}

TEST(GlSlabs, IsoSurfacesAndExtremes) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : kBoth)
    for (const Projection projection : kBothProjections) {
      DvrCase c(bumpyVolume(), true);
      c.scene.camera.projection = projection, c.scene.camera.zoom = 2, c.quality.step = 0.3;
      c.budget = 8 * 8 * kSlice;
      c.addTool(1, 4, 1);
      const DvrTruth truth(c);
      expectClose(
          c, technique, [&](double x, double y) { return truth.planarIso(x, y); }, 0.002);
      for (const VolumeMode mode : {VolumeMode::Max, VolumeMode::Min})
        for (const bool colours : {false, true}) {
          DvrCase e(colours ? colourVolume() : bumpyVolume());
          e.scene.camera.projection = projection, e.budget = 8 * kSlice;
          e.layer().mode = mode, e.layer().gains = {1.5, 0.7, 1, 0.5};
          if (mode == VolumeMode::Min) e.layer().transfer->opacities = {{-100, 0.3}, {300, 0.9}};
          cut(e);
          const DvrTruth extremes(e);
          expectClose(e, technique, [&](double x, double y) { return extremes.planarExtreme(x, y); });
        }
    }
}

TEST(GlSlabs, TranslucentToolsAndTheEyeInside) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  c.addTool(-4, 10, 0.4, {0.9, 0.1, 0.9});
  c.addTool(2, 6, 1);
  expectSlices(c);
  DvrCase inside;
  inside.scene.camera.projection = Projection::Perspective, inside.scene.camera.fov_deg = 110;
  inside.scene.camera.distance_mm = 3, inside.budget = 6 * kSlice;
  inside.layer().transfer->opacityLength_mm = 8;
  for (const char* technique : kBoth) expectSlices(inside, technique);
}

TEST(GlSlabs, OneSlabAtATimeWithinTheBudget) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  c.budget = 8 * kSlice;
  const Result<Images> first = c.draw("dvr.slabs");
  EXPECT_EQ(first->counters.textures3dCreated, 3u);  // 0..7, 7..14, 14..21
  EXPECT_GE(first->counters.bytesUploaded, 24 * kSlice);
  EXPECT_EQ(c.draw("dvr.slabs")->counters.textures3dCreated, 0u);  // the cache holds them
  const std::uint64_t limit = device->cache().limit();
  device->cache().setLimit(9 * kSlice);
  EXPECT_EQ(c.draw("dvr.slabs")->colour, first->colour);
  EXPECT_GE(c.draw("dvr.slabs")->counters.textures3dCreated, 2u);
  EXPECT_LE(device->cache().bytes(), 9 * kSlice);
  device->cache().setLimit(limit);
  const Result<Images> strips = c.draw("dvr.strips");
  EXPECT_EQ(strips->counters.textures3dCreated, 0u);
  // Each step of a ray is read once, whatever it is cut into.
  const DvrTruth truth(c);
  double steps = 0;
  for (int y = 0; y < c.view.height_px; ++y)
    for (int x = 0; x < c.view.width_px; ++x)
      if (const RaySpan s = truth.span(x + 0.5, y + 0.5); !s.empty())
        steps += std::ceil(s.exit_mm / c.step_mm()) - std::floor(s.entry_mm / c.step_mm());
  EXPECT_EQ(first->counters.samples, static_cast<std::uint64_t>(steps));
  EXPECT_EQ(strips->counters.samples, first->counters.samples);
}

TEST(GlSlabs, OutlinesOnRequestOnly) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  c.budget = 8 * kSlice;
  const Result<Images> plain = c.draw("dvr.slabs");
  c.layer().outlines = true;
  const Result<Images> lines = c.draw("dvr.slabs");
  const Off off = offFrom(*lines, colourOf(*plain), 2);
  EXPECT_GT(off.wrong, 200u);
  EXPECT_GT(off.worst, 30);
  EXPECT_THAT(c.plan("dvr.slabs")->notes, ::testing::Contains(HasSubstr("outlines")));
}

TEST(GlSlabs, AllStateIsStated) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : kBoth) {
    DvrCase c;
    c.budget = 8 * kSlice;
    const Result<Images> clean = c.draw(technique);
    for (const unsigned seed : {1u, 2u}) {
      device->setOddStateForTest(seed);
      EXPECT_EQ(c.draw(technique)->colour, clean->colour);
    }
  }
}

TEST(SlabGeometry, SizesFromTheBudget) {
  EXPECT_EQ(dvr::slabSize(100, 10, 10000, 1000), 100);
  EXPECT_EQ(dvr::slabSize(100, 10, 355, 1000), 35);
  EXPECT_EQ(dvr::slabSize(100, 10, 355, 16), 16);
  EXPECT_EQ(dvr::slabSize(100, 10, 20, 1000), 2);
  EXPECT_EQ(dvr::slabSize(100, 10, 19, 1000), std::nullopt);
}

TEST(SlabGeometry, NeighboursShareASliceAndComeInTheOrderOfRays) {
  DvrCase c(bumpyVolume(unitGrid(8, 8, 10)));
  c.scene.camera = {};
  c.scene.camera.elevation_deg = 80;  // from above, z is superior
  const auto toVoxel = c.volume().voxelFromPatient();
  const auto slabs = dvr::slabsOf(10, 4, c.camera(), toVoxel);
  ASSERT_EQ(slabs.size(), 3u);
  EXPECT_EQ(slabs[0].first, 6);
  EXPECT_EQ(slabs[1].first, 3);
  EXPECT_EQ(slabs[2].first, 0);
  EXPECT_EQ(slabs[1].count, 4);
  EXPECT_EQ(slabs[1].below, slabs[0].from);
  c.scene.camera.projection = Projection::Perspective, c.scene.camera.distance_mm = 0.5;
  EXPECT_EQ(dvr::slabsOf(10, 4, c.camera(), toVoxel)[0].first, 3);
  EXPECT_EQ(dvr::slabsOf(10, 2, c.camera(), toVoxel).size(), 9u);
  EXPECT_EQ(dvr::slabsOf(2, 2, c.camera(), toVoxel).size(), 1u);
}

}  // namespace
}  // namespace vernier::test
