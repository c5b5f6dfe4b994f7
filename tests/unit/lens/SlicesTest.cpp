// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses on slices: every pixel against all half-spaces of the lens.
#include <gtest/gtest.h>

#include <cstring>

#include "vernier/base/Random.h"
#include "vernier/lens/Lens.h"
#include "vernier/lens/Shapes.h"
#include "vernier/mpr/Mpr.h"
#include "vernier/plan/MakePlan.h"
#include "vernier/plan/PictureGeometry.h"

namespace vernier::lens {
namespace {

class SliceHost : public Host {
 public:
  SliceHost() {
    EXPECT_TRUE(mpr::registerMpr(*this).ok());
    EXPECT_TRUE(registerLens(*this).ok());
  }
  Result<void> addTechnique(Technique t) override { return techniques_.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override { return makeError(ErrorCode::GlUnavailable, "no GL here"); }
  Images draw(const Scene& scene, const View& view, const Sources& sources) const {
    Quality quality;
    quality.technique = "mpr.native";
    const Result<Plan> plan = makePlan(scene, view, quality, {}, {}, sources, techniques_);
    EXPECT_TRUE(plan.ok()) << (plan.ok() ? "" : plan.error().text());
    Images images;
    if (!plan) return images;
    for (const Pass& pass : plan->passes)
      EXPECT_TRUE(techniques_.find(pass.technique)->execute(pass, images, {}).ok());
    return images;
  }

 private:
  TechniqueRegistry techniques_;
};

std::shared_ptr<const Volume> makeVolume() {
  VolumeInfo info;
  info.grid.columns = 40, info.grid.rows = 36, info.grid.slices = 30;
  info.type = VoxelType::I16;
  std::vector<std::int16_t> v;
  for (int n = 0; n < 40 * 36 * 30; ++n) v.push_back(static_cast<std::int16_t>(100 + n % 40 + n / 40 % 36));
  auto buffer = Buffer::make(2 * v.size());
  std::memcpy(buffer->data(), v.data(), 2 * v.size());
  return *Volume::make(std::move(info), std::move(*buffer));
}

struct Dice {
  std::uint64_t seed, next = 0;
  double operator()(double low, double high) { return low + (high - low) * randomUnit(seed, next++); }
};

LensShape shapeOf(Dice& dice, int n) {
  const MeshPoint middle(dice(10, 30), dice(10, 26), dice(10, 20));
  if (n % 5 == 0) return BoxShape{middle, {dice(1, 40), dice(1, 30), dice(1, 20)}};
  if (n % 5 == 1) return SphereShape{middle, dice(2, 15), n % 4 + 2};
  if (n % 5 == 2) return ConeShape{MeshPoint(3, 4, 2), middle, dice(0, 4), dice(1, 9), 3 + n};
  // A box of whole numbers whose faces lie in the slice, or run through centres of pixels.
  if (n % 5 == 3) return BoxShape{MeshPoint(20, 18, 15), {8.0 + n % 3, 6, 10}};
  HullShape hull;
  for (int k = 0; k < 3000; ++k) {
    const glm::dvec3 p(dice(-1, 1), dice(-1, 1), dice(-1, 1));
    if (glm::length(p) > 0.1) hull.points.emplace_back(middle.p + 9.0 * glm::normalize(p));
  }
  return hull;
}

TEST(LensesOnSlices, PixelsAreThoseThatAllHalfSpacesHold) {
  const SliceHost host;
  Sources sources;
  sources.volumes["v"] = makeVolume();
  DerivedCache cache{64ull << 20};
  const View view{160, 120};
  std::size_t inside = 0, outside = 0, wrong = 0;
  for (int n = 0; n < 60; ++n) {
    Dice dice{static_cast<std::uint64_t>(n) + 3};
    Scene scene;
    scene.background = {1, 0, 1};  // of no grey
    SliceLayer slice;
    slice.source = "v";
    slice.plane.point = PatientPoint(dice(15, 25), dice(12, 24), dice(12, 18));
    slice.plane.normal = PatientVec(dice(-1, 1), dice(-1, 1), dice(-1, 1));
    slice.plane.up = PatientVec(0.1, 0.2, 1);
    if (n % 5 == 3) {
      slice.plane = {PatientPoint(20, 18, n % 2 ? 15 : 20), PatientVec(0, 0, 1), PatientVec(0, -1, 0)};
      scene.camera.height_mm = 60;  // half a mm a pixel
    }
    slice.window = VoiWindow{150, 200, VoiFunction::Linear, ""};
    scene.layers.emplace_back(slice);
    LensLayer lens;
    lens.shape = shapeOf(dice, n);
    if (n % 5 != 3) {
      const glm::dvec3 x = glm::normalize(glm::dvec3(1, dice(-0.4, 0.4), dice(-0.4, 0.4)));
      const glm::dvec3 y = glm::normalize(glm::cross(x, glm::dvec3(dice(-0.3, 0.3), 0.3, 1)));
      lens.pose.linear = glm::dmat3(x, y, glm::cross(x, y));
      const glm::dvec3 middle(20, 18, 15);
      lens.pose.translation = middle - lens.pose.linear * middle;
    }
    scene.layers.emplace_back(lens);
    const auto region = convexRegion(lens, sources, cache);
    ASSERT_TRUE(region.ok()) << region.error().text();
    const Result<SlicePicture> picture = slicePicture(slice, scene.camera, view, *sources.volumes["v"]);
    ASSERT_TRUE(picture.ok());
    const Images with = host.draw(scene, view, sources);
    scene.layers.pop_back();
    const Images plain = host.draw(scene, view, sources);
    for (std::size_t p = 0; p < with.depth.size(); ++p) {
      const glm::dvec2 at(static_cast<double>(p % 160) + 0.5, static_cast<double>(p / 160) + 0.5);
      const bool in = (*region)->contains(patientAt(*picture, at));
      ++(in ? inside : outside);
      const float wanted[3] = {in ? 1 : plain.colour[4 * p], in ? 0 : plain.colour[4 * p + 1],
                               in ? 1 : plain.colour[4 * p + 2]};
      for (std::size_t c = 0; c < 3; ++c) wrong += with.colour[4 * p + c] != wanted[c];
    }
  }
  EXPECT_GT(inside, 30000u);
  EXPECT_GT(outside, 400000u);
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace vernier::lens
