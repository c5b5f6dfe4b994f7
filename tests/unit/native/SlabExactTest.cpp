// SPDX-License-Identifier: GPL-3.0-or-later
// Exact slabs against closed forms, against quality's reference (which shares no code with the engine) and
// against 10,000 steps along each line; and when the planner takes them.
#include "vernier/native/SlabExact.h"

#include <thread>

#include "RenderForTest.h"
#include "SliceCases.h"
#include "vernier/base/Threads.h"
#include "vernier/quality/Badge.h"
#include "vernier/quality/Reference.h"

namespace vernier::test {
namespace {

constexpr SlabMode kModes[] = {SlabMode::Max, SlabMode::Min, SlabMode::Mean};

std::vector<NamedGrid> evenGrids() {
  std::vector<NamedGrid> grids;
  for (NamedGrid& g : everyGrid())
    if (g.grid.even()) grids.push_back(g);
  GridGeometry thick = grids[1].grid;  // oblique
  thick.patientFromVoxel.linear[2] *= 50 * 0.7 / 2.5;
  grids.push_back({"1:50", thick});
  for (int axis = 0; axis < 3; ++axis) {
    GridGeometry flat = grids[1].grid;
    (axis == 0 ? flat.columns : axis == 1 ? flat.rows : flat.slices) = 1;
    grids.push_back({"one along axis " + std::to_string(axis), flat});
  }
  return grids;
}

template <class T>
std::shared_ptr<const Volume> noise(const GridGeometry& grid, std::uint64_t seed, double slope = 0.75) {
  VolumeInfo info;
  info.grid = grid;
  info.rescale = {{slope, -1024.5}};
  double low = std::is_signed_v<T> ? -3000 : 0, high = 4000;
  if constexpr (sizeof(T) == 1) low = std::numeric_limits<T>::lowest(), high = std::numeric_limits<T>::max();
  if constexpr (std::is_same_v<T, std::uint32_t>) high = 4294967295.0;
  const auto n = static_cast<std::size_t>(grid.columns * grid.rows * grid.slices);
  return volumeOf<T>(std::move(info), randomValues<T>(n, seed, low, high));
}

double rangeOf(const Volume& v) { return v.modalityRange()->max - v.modalityRange()->min; }

// The value itself is kept as a float.
double tolerance(const Volume& v, double value) { return 1e-9 * rangeOf(v) + 6e-8 * std::abs(value); }

struct SlabScene {
  Scene scene;
  View view{37, 29, true};
  Sources sources;
  SliceLayer& layer() { return std::get<SliceLayer>(scene.layers[0]); }
};

// A plane at random through the volume, the border in the picture.
SlabScene randomScene(const std::shared_ptr<const Volume>& volume, std::uint64_t seed, Slab slab) {
  const auto unit = [&](std::uint64_t n) { return 2 * randomUnit(seed, n) - 1; };
  const GridGeometry& g = volume->grid();
  SlabScene s;
  SliceLayer layer;
  layer.source = "v";
  layer.plane.normal = PatientVec(unit(0), unit(1), unit(2));
  layer.plane.up = PatientVec(unit(3), unit(4), unit(5));
  layer.plane.point = g.centre() + 0.3 * unit(6) * normalize(layer.plane.normal);
  layer.window = VoiWindow{0, 1000, VoiFunction::LinearExact, ""};
  layer.slab = slab;
  s.scene.layers.emplace_back(layer);
  s.sources.volumes["v"] = volume;
  return s;
}

// Adds the pixels that show something to `all_px`.
void expectEqualsReference(const SlabScene& s, const std::string& what, int& all_px) {
  const Volume& v = *s.sources.volumes.at("v");
  const auto drawn = renderWith("mpr.exact", s.scene, s.view, s.sources);
  ASSERT_TRUE(drawn.ok()) << drawn.error().text();
  std::vector<std::size_t> all(static_cast<std::size_t>(s.view.width_px * s.view.height_px));
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = n;
  const auto truth = quality::referencePixels(s.scene, s.view, s.sources, all);
  ASSERT_TRUE(truth.ok());
  int shown = 0;
  for (std::size_t n : all) {
    const float got = drawn->frame.images.values[n];
    const quality::ReferencePixel& t = (*truth)[n];
    ASSERT_EQ(!std::isnan(got), t.covered) << what << " pixel " << n;
    ASSERT_EQ(drawn->frame.images.depth[n], t.covered ? 0.0f : kNothing_mm);
    ASSERT_NEAR(drawn->frame.images.colour[4 * n], t.rgba.x, 1e-4) << what << " pixel " << n;
    if (!t.covered) continue;
    ASSERT_NEAR(got, t.value, tolerance(v, t.value)) << what << " pixel " << n;
    ++shown;
  }
  all_px += shown;
  EXPECT_GE(drawn->frame.images.counters.cells, static_cast<std::uint64_t>(shown));
  EXPECT_GE(drawn->frame.images.counters.samples, static_cast<std::uint64_t>(shown));
}

template <class T>
class ExactSlabOfType : public testing::Test {};
using Types = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                             std::int32_t, float>;
TYPED_TEST_SUITE(ExactSlabOfType, Types);

// Thinner than a voxel, a few voxels, thicker than the volume.
TYPED_TEST(ExactSlabOfType, EqualsTheReferenceOnEveryGrid) {
  std::uint64_t seed = 10;
  for (const NamedGrid& g : evenGrids()) {
    int shown = 0;
    for (const SlabMode mode : kModes)
      for (const double thickness_mm : {0.05, 4.0, 1e4}) {
        seed += 2;
        const auto v = noise<TypeParam>(g.grid, seed, seed % 4 ? 0.75 : -0.75);
        expectEqualsReference(randomScene(v, seed + 1, {thickness_mm, mode}),
                              g.name + " " + std::to_string(thickness_mm), shown);
      }
    EXPECT_GT(shown, 100) << g.name << ": the pictures show nothing";
  }
}

// Lines along an axis, some of them exactly on faces and on the border.
TEST(ExactSlab, EqualsTheReferenceAlongTheAxes) {
  for (const NamedGrid& g : evenGrids()) {
    const auto v = noise<std::int16_t>(g.grid, 3);
    const glm::dmat3& m = g.grid.patientFromVoxel.linear;
    int shown = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const SlabMode mode : kModes) {
        SlabScene s = randomScene(v, 4, {5, mode});
        s.layer().plane = {g.grid.centre(), PatientVec(m[axis]), PatientVec(m[(axis + 1) % 3])};
        s.scene.camera.height_mm = 0.8 * 5 * glm::length(m[(axis + 1) % 3]);
        expectEqualsReference(s, g.name + " along " + std::to_string(axis), shown);
      }
    EXPECT_GT(shown, 100) << g.name << ": the pictures show nothing";
  }
}

// Many steps never beat the exact extremum, and come close to it.
TEST(ExactSlab, TenThousandStepsAgree) {
  std::uint64_t seed = 500;
  constexpr int kSteps = 10000;
  for (const NamedGrid& g : evenGrids())
    for (const SlabMode mode : kModes) {
      const auto v = noise<std::int16_t>(g.grid, ++seed);
      native::SliceJob job = randomJob(*v, ++seed, 6, 5);
      job.picture.right = 0.1 * job.picture.right;  // about the centre
      job.picture.down = 0.1 * job.picture.down;
      job.picture.origin = g.grid.centre() - 3.0 * job.picture.right - 2.5 * job.picture.down;
      job.slab = {6.0, mode};
      job.slabSamples = kSteps;
      Images images = imagesFor(job);
      ASSERT_TRUE(native::drawSlabExact(job, images).ok());
      int shown = 0;
      for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 6; ++x) {
          std::uint64_t samples = 0;
          const double truth = pixelTruth(job, x, y, samples).value;
          const double got = images.values[static_cast<std::size_t>(6 * y + x)];
          if (samples < 100) continue;  // a line that touches a corner
          ++shown;
          const double whole = rangeOf(*v), rounding = tolerance(*v, truth);
          ASSERT_NEAR(got, truth, 4e-3 * whole) << g.name;
          if (mode == SlabMode::Max) {
            ASSERT_GE(got, truth - rounding) << g.name;
          } else if (mode == SlabMode::Min) {
            ASSERT_LE(got, truth + rounding) << g.name;
          }
        }
      EXPECT_GT(shown, 3) << g.name;
    }
}

// One cell of eight voxels, 1000 where `lit`, and the line from corner (0,0,0) to `to`.
double alongOneCell(const std::vector<int>& lit, glm::dvec3 to, SlabMode mode) {
  VolumeInfo info;
  info.grid = unitGrid(2, 2, 2);
  std::vector<float> values(8, 0.0f);
  for (int n : lit) values[static_cast<std::size_t>(n)] = 1000;
  const auto v = volumeOf<float>(std::move(info), values);
  const glm::dvec3 normal = glm::normalize(to);
  const glm::dvec3 right =
      glm::normalize(glm::cross(normal, normal.z < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0)));
  native::SliceJob job;
  job.volume = v.get();
  job.width_px = job.height_px = 1;
  job.picture.normal = PatientVec(normal);
  job.picture.right = PatientVec(0.1 * right);
  job.picture.down = PatientVec(0.1 * glm::cross(right, normal));
  job.picture.origin = PatientPoint(0.5 * to) - 0.5 * job.picture.right - 0.5 * job.picture.down;
  job.window = {500, 1000, VoiFunction::LinearExact, ""};
  job.slab = {glm::length(to), mode};
  Images images = imagesFor(job);
  EXPECT_TRUE(native::drawSlabExact(job, images).ok());
  return images.values[0];
}

TEST(ExactSlab, ClosedForms) {
  // x (1 - y) along x = y: s (1 - s).
  EXPECT_NEAR(alongOneCell({1, 5}, {1, 1, 0}, SlabMode::Max), 250, 1e-4);
  EXPECT_NEAR(alongOneCell({1, 5}, {1, 1, 0}, SlabMode::Mean), 1000.0 / 6, 1e-4);
  EXPECT_NEAR(alongOneCell({1, 5}, {1, 1, 0}, SlabMode::Min), 0, 1e-4);
  // x y (1 - z) along the diagonal: s^2 (1 - s), greatest at 2/3.
  EXPECT_NEAR(alongOneCell({3}, {1, 1, 1}, SlabMode::Max), 4000.0 / 27, 1e-4);
  EXPECT_NEAR(alongOneCell({3}, {1, 1, 1}, SlabMode::Mean), 1000.0 / 12, 1e-4);
  // 1 - x y (1 - z).
  EXPECT_NEAR(alongOneCell({0, 1, 2, 4, 5, 6, 7}, {1, 1, 1}, SlabMode::Min), 1000 - 4000.0 / 27, 1e-4);
  // x (1 - y) z + (1 - x) y (1 - z) = s (1 - s): two corners, the cubic terms cancel.
  EXPECT_NEAR(alongOneCell({5, 2}, {1, 1, 1}, SlabMode::Max), 250, 1e-4);
  // Two extrema inside: x y z + 9/8 (x (1-y)(1-z)) and the like are covered by the random planes.
  EXPECT_NEAR(alongOneCell({7}, {1, 1, 1}, SlabMode::Max), 1000, 1e-4);
  EXPECT_NEAR(alongOneCell({7}, {1, 1, 1}, SlabMode::Mean), 250, 1e-4);
}

TEST(ExactSlab, APlaneOutsideShowsTheBackground) {
  const auto v = noise<std::int16_t>(unitGrid(8, 8, 8), 1);
  native::SliceJob job = randomJob(*v, 5, 9, 7);
  job.picture.origin = job.picture.origin + 40.0 * job.picture.normal;
  job.slab = {10, SlabMode::Mean};
  Images images = imagesFor(job);
  ASSERT_TRUE(native::drawSlabExact(job, images).ok());
  for (std::size_t n = 0; n < 63; ++n) {
    ASSERT_TRUE(std::isnan(images.values[n]));
    ASSERT_EQ(images.colour[4 * n + 1], 0.5f);
    ASSERT_EQ(images.depth[n], kNothing_mm);
  }
  EXPECT_EQ(images.counters.cells, 0u);
  EXPECT_EQ(images.counters.samples, 0u);
}

TEST(ExactSlab, CellsThatCannotWinAreNotEvaluated) {
  VolumeInfo info;
  info.grid = unitGrid(32, 32, 32);
  std::vector<std::int16_t> values(32 * 32 * 32, 0);
  values[16 + 32 * (16 + 32 * 16)] = 100;
  const auto v = volumeOf<std::int16_t>(std::move(info), values);
  native::SliceJob job = randomJob(*v, 5, 40, 40);
  job.slab = {20, SlabMode::Max};
  Images images = imagesFor(job);
  ASSERT_TRUE(native::drawSlabExact(job, images).ok());
  EXPECT_GT(images.counters.cells, 10u * images.counters.samples);
  EXPECT_LE(static_cast<double>(images.counters.cells), 40 * 40 * native::cellsPerSlabLine(job));
}

TEST(ExactSlab, BitEqualForAnyNumberOfThreads) {
  const auto v = noise<std::int16_t>(everyGrid()[2].grid, 8);
  for (const SlabMode mode : kModes) {
    native::SliceJob job = randomJob(*v, 6, 150, 70);
    job.slab = {7, mode};
    std::vector<Images> all;
    for (const int n : {1, 2, 3}) {
      setThreads(n);
      all.push_back(imagesFor(job));
      ASSERT_TRUE(native::drawSlabExact(job, all.back()).ok());
    }
    setThreads(0);
    for (const Images& i : all) {
      EXPECT_EQ(std::memcmp(i.colour.data(), all[0].colour.data(), 4 * i.colour.size()), 0);
      EXPECT_EQ(std::memcmp(i.values.data(), all[0].values.data(), 4 * i.values.size()), 0);
      EXPECT_EQ(i.counters.samples, all[0].counters.samples);
      EXPECT_EQ(i.counters.cells, all[0].counters.cells);
    }
  }
}

TEST(ExactSlab, StopsWhenAskedTo) {
  const auto v = noise<std::int16_t>(unitGrid(16, 16, 16), 8);
  native::SliceJob job = randomJob(*v, 6, 64, 64);
  job.slab = {7, SlabMode::Max};
  Images images = imagesFor(job);
  std::stop_source stop;
  stop.request_stop();
  const auto r = native::drawSlabExact(job, images, stop.get_token());
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::Cancelled);
  EXPECT_EQ(images.counters.cells, 0u);
}

TEST(ExactSlab, RefusesWhatItCannotDraw) {
  const auto v = noise<std::int16_t>(unitGrid(8, 8, 8), 8);
  native::SliceJob job = randomJob(*v, 6, 4, 4);
  EXPECT_NE(native::whyNotExactSlab(job), "");  // no thickness
  job.slab = {2, SlabMode::Max};
  EXPECT_EQ(native::whyNotExactSlab(job), "");
  Images small;
  small.allocate(3, 4, true);
  EXPECT_EQ(native::drawSlabExact(job, small).error().code, ErrorCode::Internal);
  job.interpolation = Interpolation::Nearest;
  EXPECT_NE(native::whyNotExactSlab(job), "");
  Images images = imagesFor(job);
  EXPECT_EQ(native::drawSlabExact(job, images).error().code, ErrorCode::Internal);
}

// ---- through the planner ----

Plan planned(const SlabScene& s, QualityLevel level) {
  Quality quality;
  quality.level = level;
  Capabilities desk;
  desk.threads = 2;
  const auto plan =
      makePlan(s.scene, s.view, quality, desk, CostTable{}, s.sources, TestHost::instance().registry);
  EXPECT_TRUE(plan.ok());
  return plan.ok() ? *plan : Plan{};
}

std::string whyRejected(const Plan& plan, const std::string& technique) {
  for (const Rejected& r : plan.rejected)
    if (r.what == technique) return r.why;
  return "";
}

TEST(ExactSlabPlan, DraftSamplesReviewAndReferenceAreExact) {
  const auto v = noise<std::int16_t>(everyGrid()[1].grid, 8);
  for (const SlabMode mode : {SlabMode::Max, SlabMode::Min}) {
    const SlabScene s = randomScene(v, 3, {10, mode});
    const Plan draft = planned(s, QualityLevel::Draft);
    ASSERT_EQ(draft.passes.size(), 1u);
    EXPECT_EQ(draft.passes[0].technique, "mpr.native");
    EXPECT_NE(whyRejected(draft, "mpr.exact").find("ms"), std::string::npos);
    for (const QualityLevel level : {QualityLevel::Review, QualityLevel::Reference}) {
      const Plan plan = planned(s, level);
      ASSERT_EQ(plan.passes.size(), 1u);
      EXPECT_EQ(plan.passes[0].technique, "mpr.exact");
      EXPECT_NE(whyRejected(plan, "mpr.native").find("predicted error"), std::string::npos);
      EXPECT_LT(plan.passes[0].predictedError, 0.01);
      EXPECT_NE(plan.passes[0].params->dump().find("of the whole line"), std::string::npos);
    }
  }
  EXPECT_EQ(planned(randomScene(v, 3, {10, SlabMode::Mean}), QualityLevel::Reference).passes[0].technique,
            "mpr.exact");
  // A single slice is no slab.
  const Plan slice = planned(randomScene(v, 3, {0, SlabMode::Max}), QualityLevel::Reference);
  EXPECT_EQ(slice.passes[0].technique, "mpr.native");
  EXPECT_NE(whyRejected(slice, "mpr.exact").find("no thickness"), std::string::npos);
}

TEST(ExactSlabPlan, WhereItRefusesItSaysWhyAndSamplingGoesOn) {
  const auto refusal = [](const SlabScene& s) {
    const Plan plan = planned(s, QualityLevel::Review);
    EXPECT_EQ(plan.passes.size(), 1u);
    EXPECT_EQ(plan.passes[0].technique, "mpr.native");
    return whyRejected(plan, "mpr.exact");
  };
  const auto all = everyGrid();
  EXPECT_NE(refusal(randomScene(noise<std::int16_t>(all[4].grid, 8), 3, {4, SlabMode::Max})).find("evenly"),
            std::string::npos);
  EXPECT_NE(refusal(randomScene(noise<std::int16_t>(all[5].grid, 8), 3, {4, SlabMode::Max})).find("gap"),
            std::string::npos);
  SlabScene nearest = randomScene(noise<std::int16_t>(all[0].grid, 8), 3, {4, SlabMode::Max});
  nearest.layer().interpolation = Interpolation::Nearest;
  EXPECT_NE(refusal(nearest).find("nearest"), std::string::npos);

  VolumeInfo info;
  info.grid = unitGrid(5, 5, 5);
  info.noData = NoDataRange{-2000, -2000};
  const std::vector<std::int16_t> values(125, 7);
  EXPECT_NE(refusal(randomScene(volumeOf<std::int16_t>(info, values), 3, {4, SlabMode::Max})).find("padding"),
            std::string::npos);
  info.noData.reset();
  std::vector<float> floats(125, 1.5f);
  floats[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusal(randomScene(volumeOf<float>(info, floats), 3, {4, SlabMode::Max})).find("be a number"),
            std::string::npos);
  // Converted from integers with padding: NaN may stand anywhere. Without, none can.
  for (const bool padded : {false, true}) {
    OriginalVoxels original;
    original.rescale = {{1, 0}};
    if (padded) original.noData = NoDataRange{3, 3};
    original.voxels = bufferOf(values);
    info.type = VoxelType::F32;
    auto made = Volume::make(info, bufferOf(std::vector<float>(125, 7.0f)), std::move(original));
    ASSERT_TRUE(made.ok());
    const Plan plan = planned(randomScene(*made, 3, {4, SlabMode::Max}), QualityLevel::Review);
    EXPECT_EQ(plan.passes[0].technique, padded ? "mpr.native" : "mpr.exact");
  }
}

TEST(ExactSlabPlan, MeasuredErrorIsThatOfFloats) {
  const auto v = noise<std::int16_t>(everyGrid()[2].grid, 8);
  for (const SlabMode mode : kModes) {
    const SlabScene s = randomScene(v, 12, {6, mode});
    const auto drawn = renderWith("mpr.exact", s.scene, s.view, s.sources);
    ASSERT_TRUE(drawn.ok());
    const auto error = quality::measureError(drawn->frame, s.scene, s.view, s.sources);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max, 0.01);
  }
}

}  // namespace
}  // namespace vernier::test
