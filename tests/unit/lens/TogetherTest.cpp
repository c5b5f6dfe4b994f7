// SPDX-License-Identifier: GPL-3.0-or-later
// Blended appearances that are drawn in one walk along each ray: they look as their parts, drawn one after
// the other and joined, do, and read the field no more often than the picture without a lens.
#include <gtest/gtest.h>

#include <cstring>

#include "LensHost.h"
#include "vernier/base/Random.h"
#include "vernier/base/Threads.h"
#include "vernier/lens/Shapes.h"
#include "vernier/native/LensRays.h"

namespace vernier::lens {
namespace {

using namespace vernier::test;

constexpr int kWidth_px = 52, kHeight_px = 44;

struct Dice {
  std::uint64_t seed, next = 0;
  double operator()(double low, double high) { return low + (high - low) * randomUnit(seed, next++); }
};

// A ball within a shell, -1000 to 1500, with some noise; `holes`: voxels here and there are no-data.
template <class T>
std::shared_ptr<const Volume> makeVolume(VoxelType type, bool holes) {
  VolumeInfo info;
  info.grid.columns = 34, info.grid.rows = 30, info.grid.slices = 26;
  info.grid.patientFromVoxel.linear[2][2] = 1.25;
  info.type = type;
  if (type != VoxelType::F32) info.rescale = {{type == VoxelType::U8 ? 10.0 : 1.0, -1000}};
  if (holes) info.noData = type == VoxelType::F32 ? NoDataRange{-1000, -1000} : NoDataRange{0, 0};
  std::vector<T> v;
  for (int k = 0; k < 26; ++k)
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 34; ++i) {
        const double r = glm::length(glm::dvec3(i - 16.5, j - 14.5, 1.25 * k - 15.6)) / 14;
        const auto n = static_cast<std::uint64_t>(i + 34 * (j + 30 * k));
        double value =
            r > 1.1 ? -900 : 300 * std::cos(3 * r) + 900 * std::exp(-std::pow((r - 0.85) / 0.1, 2));
        value += 40 * randomUnit(4, n);
        if (holes && randomUnit(9, n) < 0.02) value = -1000;
        v.push_back(static_cast<T>(type == VoxelType::F32  ? value
                                   : type == VoxelType::U8 ? std::round((value + 1000) / 10)
                                                           : std::round(value + 1000)));
      }
  auto buffer = Buffer::make(v.size() * sizeof(T));
  std::memcpy(buffer->data(), v.data(), v.size() * sizeof(T));
  return *Volume::make(std::move(info), std::move(*buffer));
}

TransferFunction functionOf(Dice& dice) {
  TransferFunction f;
  double value = -800;
  for (int n = 0; n < 4; ++n, value += dice(50, 500)) {
    f.colours.push_back({value, glm::dvec3(dice(0, 1), dice(0, 1), dice(0, 1))});
    f.opacities.push_back({value, n == 0 ? 0.0 : dice(0, 0.25)});
  }
  return f;
}

struct Case {
  Scene scene;
  View view{kWidth_px, kHeight_px};
  Sources sources;
  std::size_t lenses = 1;
  VolumeLayer& outside() { return std::get<VolumeLayer>(scene.layers.front()); }
};

LensShape shapeOf(Dice& dice, int n) {
  const MeshPoint middle(dice(8, 24), dice(8, 22), dice(6, 26));
  if (n % 3 == 0) return BoxShape{middle, {dice(4, 30), dice(4, 20), dice(4, 20)}};
  if (n % 3 == 1) return SphereShape{middle, dice(3, 12), 2};
  return ConeShape{middle, MeshPoint(dice(0, 33), dice(0, 29), dice(0, 31)), dice(2, 6), dice(2, 9), 24};
}

Case caseOf(int n) {
  Dice dice{static_cast<std::uint64_t>(n) + 50};
  Case c;
  const bool holes = n % 5 == 4;
  c.sources.volumes["v"] = n % 4 == 0   ? makeVolume<std::int16_t>(VoxelType::I16, holes)
                           : n % 4 == 1 ? makeVolume<std::uint16_t>(VoxelType::U16, holes)
                           : n % 4 == 2 ? makeVolume<std::uint8_t>(VoxelType::U8, holes)
                                        : makeVolume<float>(VoxelType::F32, holes);
  c.scene.background = {0.1, 0.2, 0.4};
  c.scene.camera.azimuth_deg = dice(-180, 180), c.scene.camera.elevation_deg = dice(-60, 60);
  if (n % 2) c.scene.camera.projection = Projection::Perspective;
  if (n % 6 == 3) c.scene.camera.distance_mm = dice(3, 12);  // the eye in the volume, or in a lens
  VolumeLayer layer;
  layer.source = "v", layer.transfer = functionOf(dice);
  layer.classification = n % 3 == 1 ? Classification::PreIntegrated : Classification::Post;
  if (n % 7 == 2) layer.shading = ShadingModel::ColourPerVoxel;
  if (n % 11 == 6) layer.classification = Classification::Pre;
  c.scene.layers.emplace_back(layer);
  c.lenses = static_cast<std::size_t>(1 + n % 3);
  for (std::size_t k = 0; k < c.lenses; ++k) {
    LensLayer lens;
    lens.shape = shapeOf(dice, n + static_cast<int>(k));
    VolumeLayer inner = layer;
    inner.transfer = functionOf(dice);
    if (n % 4 != 1 || k > 0) lens.inner = inner;  // else cut out
    c.scene.layers.emplace_back(lens);
  }
  if (n % 8 == 5) c.scene.clip.push_back({PatientVec(1, 0, 0), 20});
  return c;
}

void addTools(Case& c) {
  for (const double opacity : {0.4, 1.0}) {
    MeshBuilder b;
    const double z = opacity < 1 ? 11 : 19;
    const std::uint32_t v[3] = {b.vertex({-5, 2, z}), b.vertex({40, 4, z - 3}), b.vertex({14, 31, z + 2})};
    b.triangle(v[0], v[1], v[2]);
    const std::string name = opacity < 1 ? "sheet" : "wall";
    c.sources.meshes[name] = *b.finish();
    SurfaceLayer tool;
    tool.source = name, tool.opacity = opacity, tool.colour = {0.3, 0.9, 0.5};
    c.scene.layers.insert(c.scene.layers.begin() + 1, tool);
  }
}

struct Drawn {
  Plan plan;
  Images images;
};
Drawn drawn(const LensHost& host, const Case& c, QualityLevel level = QualityLevel::Reference) {
  Result<Plan> plan = host.plan(c.scene, c.view, c.sources, level);
  EXPECT_TRUE(plan.ok()) << (plan.ok() ? "" : plan.error().text());
  if (!plan) return {};
  Result<Images> images = host.draw(*plan);
  EXPECT_TRUE(images.ok()) << (images.ok() ? "" : images.error().text());
  return {*plan, images ? *images : Images{}};
}

bool isTogether(const Plan& plan) {
  return std::any_of(plan.passes.begin(), plan.passes.end(),
                     [](const Pass& p) { return p.rays.which == RaysOfPass::Which::Together; });
}

TEST(LensesTogether, LookAsTheirPartsJoined) {
  const LensHost together, parts(false);
  std::size_t different = 0;
  for (int n = 0; n < 48; ++n) {
    SCOPED_TRACE(n);
    Case c = caseOf(n);
    if (n % 4 == 3) addTools(c);
    const Drawn a = drawn(together, c), b = drawn(parts, c);
    ASSERT_FALSE(isTogether(b.plan));
    if (!isTogether(a.plan)) continue;  // no lens is seen
    ++different;
    std::size_t same = 0, later = 0;
    double most = 0;
    for (std::size_t p = 0; p < a.images.depth.size(); ++p) {
      for (std::size_t k = 0; k < 4; ++k)
        most = std::max(
            most, static_cast<double>(std::abs(a.images.colour[4 * p + k] - b.images.colour[4 * p + k])));
      const float x = a.images.depth[p], y = b.images.depth[p];
      if (std::isfinite(x) && std::isfinite(y)) ++(std::abs(x - y) <= 0.05f ? same : later);
      // A part that was drawn before what lies in front of it says its end, not where the light reaches a
      // half; where it just about does, it may do so in neither.
      if (std::isfinite(x) && std::isfinite(y)) {
        EXPECT_LT(x, y + 0.05f) << p;
      }
    }
    EXPECT_GE(same, 4 * later);
    EXPECT_LT(most, 4e-4);
  }
  EXPECT_GT(different, 36u);
}

std::size_t raysThroughLens(const Case& c) {
  const LensHost host;
  const Result<Plan> plan = host.plan(c.scene, c.view, c.sources);
  EXPECT_TRUE(plan.ok());
  const GridGeometry& grid = c.sources.volumes.at("v")->grid();
  native::LensRaysJob job;
  job.camera = *cameraPicture(c.scene.camera, c.view, cameraBox(grid));
  job.region = *keptRegion(c.scene, grid);
  for (const PlacedLens& l : plan->lenses) job.lenses.push_back(l.region);
  Images images;
  EXPECT_TRUE(native::cutRays(job, images).ok());
  std::size_t count = 0;
  for (std::size_t p = 0; p < images.rays->first.size() - 1; ++p) count += images.rays->meetsLens(p);
  return count;
}

// G2: a lens whose inside is its outside costs at most two cut steps on each ray that it meets, reads nothing
// else, and is not seen.
TEST(LensesTogether, G2_ANeutralLensReadsNoOtherSampleThanTwoCutSteps) {
  const LensHost host;
  for (int n = 0; n < 24; ++n)
    for (const QualityLevel level : {QualityLevel::Draft, QualityLevel::Reference}) {
      SCOPED_TRACE(n);
      Case c = caseOf(n);
      const bool inDouble = c.outside().classification == Classification::Pre || n % 5 == 4;
      if (inDouble) c.outside().classification = Classification::Post;
      if (n % 11 == 6) c.outside().interpolation = Interpolation::Nearest;  // the double path
      if (n % 4 == 3) addTools(c);
      for (Layer& l : c.scene.layers)
        if (auto* lens = std::get_if<LensLayer>(&l)) lens->inner = c.outside();
      Case plain = c;
      std::erase_if(plain.scene.layers, [](const Layer& l) { return std::holds_alternative<LensLayer>(l); });
      const Drawn with = drawn(host, c, level), without = drawn(host, plain, level);
      if (!isTogether(with.plan)) continue;
      const std::uint64_t read = with.images.counters.samples, wanted = without.images.counters.samples;
      EXPECT_LE(read, wanted + 2 * c.lenses * raysThroughLens(c));
      // By the kernel a cut step is read once for both sides.
      if (!inDouble) {
        EXPECT_EQ(read, wanted);
      }
      double most = 0;
      for (std::size_t p = 0; p < with.images.colour.size(); ++p)
        most =
            std::max(most, static_cast<double>(std::abs(with.images.colour[p] - without.images.colour[p])));
      EXPECT_LT(255 * most, 0.25);
      for (std::size_t p = 0; p < with.images.depth.size(); ++p)
        if (std::isfinite(with.images.depth[p]) && std::isfinite(without.images.depth[p])) {
          EXPECT_NEAR(with.images.depth[p], without.images.depth[p], 1e-2) << p;
        }
    }
}

// G2 of what is gathered: projections and shells, with tools and without. Shells go on through the face of a
// lens that shows the same levels.
TEST(LensesTogether, G2_ANeutralLensIsNotSeenInProjectionsAndShells) {
  const LensHost host;
  const auto check = [&](const auto& layer, double within) {
    for (const bool withTools : {false, true})
      for (const int n : {0, 3, 5, 7}) {
        Case c = caseOf(n);
        std::erase_if(c.scene.layers, [](const Layer& l) { return !std::holds_alternative<LensLayer>(l); });
        c.scene.layers.insert(c.scene.layers.begin(), layer);
        if (withTools) addTools(c);
        for (Layer& l : c.scene.layers)
          if (auto* lens = std::get_if<LensLayer>(&l)) lens->inner = layer;
        Case plain = c;
        std::erase_if(plain.scene.layers,
                      [](const Layer& l) { return std::holds_alternative<LensLayer>(l); });
        const Drawn with = drawn(host, c), without = drawn(host, plain);
        ASSERT_GT(with.plan.lenses.size(), 0u);
        double most = 0;
        for (std::size_t p = 0; p < with.images.colour.size(); ++p)
          most =
              std::max(most, static_cast<double>(std::abs(with.images.colour[p] - without.images.colour[p])));
        EXPECT_LT(255 * most, within) << n << (withTools ? " with tools" : "");
      }
  };
  for (const ProjectionMode mode : {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Mean,
                                    ProjectionMode::Sum, ProjectionMode::Attenuation}) {
    SCOPED_TRACE(static_cast<int>(mode));
    ProjectionLayer p;
    p.source = "v", p.mode = mode;
    check(p, 0.25);
  }
  for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit})
    for (const double beta0 : {0.0, 0.6}) {
      SCOPED_TRACE("shells " + std::to_string(static_cast<int>(mode)) + " " + std::to_string(beta0));
      ShellsLayer s;
      s.source = "v", s.mode = mode, s.levels = {-300, 100, 500};
      s.beta0 = beta0, s.phi0 = 0.5, s.a = mode == ShellsMode::Lit ? 0 : 0.4;
      // Darker than the tool behind them, which is seen then.
      if (mode == ShellsMode::Max && beta0 > 0)
        s.surfaceBlend = SurfaceBlend::Max, s.colour = {0.2, 0.1, 0.2};
      check(s, 0.25);
    }
}

// Bins of steps that lie within a lens on all rays of a packet are those of the lens alone.
TEST(LensesTogether, NothingIsReadWhereNothingIsShown) {
  const LensHost host;
  Case c = caseOf(0);
  c.scene.layers.resize(1);
  const std::uint64_t plain = drawn(host, c).images.counters.samples;
  LensLayer lens;
  lens.shape = BoxShape{MeshPoint(16, 15, 15), {90, 90, 90}};
  c.scene.layers.emplace_back(lens);
  const Drawn none = drawn(host, c);
  ASSERT_TRUE(isTogether(none.plan));
  EXPECT_EQ(none.images.counters.samples, 0u);
  // Half of it: about half of the samples, and the bins that the face runs through.
  std::get<BoxShape>(std::get<LensLayer>(c.scene.layers.back()).shape) =
      BoxShape{MeshPoint(16, 15, -29.4), {90, 90, 90}};
  const std::uint64_t half = drawn(host, c).images.counters.samples;
  EXPECT_GT(half, plain / 4);
  EXPECT_LT(half, 3 * plain / 4);
}

TEST(LensesTogether, TheSameBitsForAnyNumberOfThreads) {
  const LensHost host;
  for (const int n : {0, 1, 5, 9}) {
    const Case c = caseOf(n);
    setThreads(1);
    const Drawn one = drawn(host, c);
    setThreads(3);
    const Drawn three = drawn(host, c);
    setThreads(0);
    EXPECT_EQ(one.images.colour, three.images.colour) << n;
    EXPECT_EQ(one.images.depth, three.images.depth) << n;
    EXPECT_EQ(one.images.counters.samples, three.images.counters.samples) << n;
  }
}

TEST(LensesTogether, WhatDiffersInMoreThanItsFunctionIsDrawnInParts) {
  const LensHost host;
  Case c = caseOf(0);
  ASSERT_TRUE(isTogether(host.plan(c.scene, c.view, c.sources).value()));
  const auto inParts = [&](auto&& change) {
    Case other = c;
    change(std::get<VolumeLayer>(std::get<LensLayer>(other.scene.layers.back()).inner));
    return !isTogether(host.plan(other.scene, other.view, other.sources).value());
  };
  EXPECT_TRUE(inParts([](VolumeLayer& l) { l.shading = ShadingModel::ColourPerVoxel; }));
  EXPECT_TRUE(inParts([](VolumeLayer& l) { l.classification = Classification::PreIntegrated; }));
  EXPECT_TRUE(inParts([](VolumeLayer& l) { l.interpolation = Interpolation::Nearest; }));
  EXPECT_TRUE(inParts([](VolumeLayer& l) { l.opacity = OpacityRule::Linear; }));
  EXPECT_FALSE(inParts([](VolumeLayer& l) { l.material.ambient = 0.5; }));  // not lit
  const Layer lens = c.scene.layers.back();
  for (int n = 0; n < 8; ++n) c.scene.layers.push_back(lens);
  EXPECT_FALSE(isTogether(host.plan(c.scene, c.view, c.sources).value()));  // nine of them
  c.scene.layers.pop_back();
  EXPECT_TRUE(isTogether(host.plan(c.scene, c.view, c.sources).value()));
}

// Moving a lens makes nothing of the volume, and no hull, anew.
TEST(LensMoves, NothingIsMadeAnew) {
  LensHost host;
  Case c = caseOf(0);
  c.outside().shading = ShadingModel::ColourPerVoxel;
  HullShape hull;
  Dice dice{77};
  for (int n = 0; n < 500; ++n) hull.points.emplace_back(dice(8, 24), dice(8, 22), dice(6, 26));
  auto& lens = std::get<LensLayer>(c.scene.layers.back());
  lens.shape = hull;
  lens.inner = c.outside();
  drawn(host, c);
  const std::uint64_t made = host.derivedData().made();
  EXPECT_GT(made, 0u);
  std::vector<float> last;
  for (int n = 1; n < 5; ++n) {
    std::get<VolumeLayer>(lens.inner).transfer = c.outside().transfer;
    lens.pose.translation = {0.7 * n, -0.3 * n, 0.1};
    lens.pose.linear[0] = glm::dvec3(1, 0.05 * n, 0);
    drawn(host, c);
    EXPECT_EQ(host.derivedData().made(), made) << n;
  }
  // The same points in a list of their own: known by what they are.
  std::get<HullShape>(lens.shape).points.own();
  drawn(host, c);
  EXPECT_EQ(host.derivedData().made(), made + 1);  // the note that they are these
  // The counter counts: another hull is made.
  std::get<HullShape>(lens.shape).points.emplace_back(30, 15, 15);
  drawn(host, c);
  EXPECT_EQ(host.derivedData().made(), made + 3);
}

}  // namespace
}  // namespace vernier::lens
