// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes drawn slice by slice on GL, with lenses: stacks of one, two and four slices on a polygon, slabs and
// strips, beside rays. A lens that changes nothing is not seen, one that does shows what native rays show.
#include <gtest/gtest.h>

#include <cmath>

#include "../volume/Grids.h"
#include "GlHost.h"
#include "LensTechniques.h"
#include "vernier/dvr/Dvr.h"
#include "vernier/lens/Lens.h"
#include "vernier/plan/MakePlan.h"

namespace vernier::lens {
namespace {

test::GlHost& lensHost() {
  static test::GlHost host({dvr::registerDvr, registerLens});
  return host;
}

constexpr const char* kSliced[] = {"dvr.rays",    "dvr.stacks", "dvr.stacks2",
                                   "dvr.stacks4", "dvr.slabs",  "dvr.strips"};

// A smooth field, so that techniques differ by their own errors only a little.
struct PictureCase {
  Scene scene;
  View view{72, 60};
  Sources sources;

  PictureCase() {
    VolumeInfo info;
    info.grid = test::unitGrid(40, 36, 30);
    std::vector<std::int16_t> v;
    for (int k = 0; k < 30; ++k)
      for (int j = 0; j < 36; ++j)
        for (int i = 0; i < 40; ++i)
          v.push_back(static_cast<std::int16_t>(500 + 200 * std::sin(0.2 * i) * std::cos(0.15 * j) +
                                                100 * std::sin(0.2 * k)));
    sources.volumes["v"] = test::volumeOf(info, v);
    scene.layers.emplace_back(volume({0.9, 0.6, 0.3}, 0.06));
    scene.background = {0.1, 0.2, 0.3};
    scene.camera.azimuth_deg = 20, scene.camera.elevation_deg = 12;
  }
  static VolumeLayer volume(glm::dvec3 colour, double opacity) {
    VolumeLayer layer;
    layer.source = "v";
    layer.classification = Classification::Post;
    layer.transfer.emplace();
    layer.transfer->colours = {{0, {colour.x, colour.y, colour.z}}, {1000, {colour.z, colour.y, colour.x}}};
    layer.transfer->opacities = {{200, 0}, {900, opacity}};
    return layer;
  }
  void addLens(LensInner inner, glm::dvec3 shift = glm::dvec3(0), double radius_mm = 9) {
    LensLayer lens;
    SphereShape sphere;
    sphere.radius_mm = radius_mm, sphere.divisions = 2;
    lens.shape = sphere;
    lens.pose.translation = sources.volumes["v"]->grid().centre().p + shift;
    lens.inner = std::move(inner);
    scene.layers.emplace_back(lens);
  }
  // The technique that draws the parts: `named`, or native where it is "".
  Images draw(const char* named) const {
    Quality quality;
    quality.engine = *named ? EngineChoice::Gl : EngineChoice::Native;
    quality.technique = named;
    quality.step = 0.5;
    test::GlHost& host = lensHost();
    Images images;
    const Result<Plan> plan =
        makePlan(scene, view, quality, host.capabilities, CostTable{}, sources, host.registry);
    EXPECT_TRUE(plan.ok()) << named << ": " << (plan.ok() ? "" : plan.error().text());
    if (!plan) return images;
    images.allocate(view.width_px, view.height_px, false);
    bool drewIt = *named == 0;
    for (const Pass& pass : plan->passes) {
      drewIt = drewIt || pass.technique == named;
      const auto done = host.registry.find(pass.technique)->execute(pass, images, {});
      EXPECT_TRUE(done.ok()) << named << ": " << (done.ok() ? "" : done.error().text());
    }
    EXPECT_TRUE(drewIt) << named;
    EXPECT_FALSE(images.rays);
    return images;
  }
};

// The largest difference, levels of 255.
double difference(const Images& a, const Images& b) {
  double most = 0;
  EXPECT_EQ(a.colour.size(), b.colour.size());
  for (std::size_t n = 0; n < std::min(a.colour.size(), b.colour.size()); ++n)
    most =
        std::max(most, 255.0 * std::abs(static_cast<double>(a.colour[n]) - static_cast<double>(b.colour[n])));
  return most;
}

TEST(GlSlicesWithLenses, ALensThatChangesNothingIsNotSeen) {
  VERNIER_NEEDS_GL(device);
  for (const char* technique : kSliced)
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
      PictureCase c;
      c.scene.camera.projection = projection;
      const Images without = c.draw(technique);
      c.addLens(PictureCase::volume({0.9, 0.6, 0.3}, 0.06));
      c.addLens(PictureCase::volume({0.9, 0.6, 0.3}, 0.06), {7, 3, -4}, 11);
      EXPECT_LE(difference(c.draw(technique), without), 0.25) << technique;
    }
}

TEST(GlSlicesWithLenses, ShowWhatNativeRaysShow) {
  VERNIER_NEEDS_GL(device);
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    PictureCase c;
    c.scene.camera.projection = projection;
    const Images plain = c.draw("");
    std::map<std::string, double> own;  // of the technique without a lens
    for (const char* technique : kSliced) own[technique] = difference(c.draw(technique), plain);
    c.addLens(PictureCase::volume({0.1, 0.9, 0.9}, 0.3), {-4, 2, 0});
    c.addLens(CutOut{}, {7, 3, -4}, 8);
    const Images native = c.draw("");
    EXPECT_GT(difference(native, plain), 60);
    for (const char* technique : kSliced) {
      EXPECT_LE(own[technique], 3) << technique;
      EXPECT_LE(difference(c.draw(technique), native), own[technique] + 3) << technique;
    }
  }
}

// Of a sharp step the slices of a stack that a lens's face cuts belong to both parts, by length.
TEST(GlSlicesWithLenses, CutsStepsByTheirLength) {
  VERNIER_NEEDS_GL(device);
  PictureCase c;
  c.scene.camera.azimuth_deg = c.scene.camera.elevation_deg = 0;
  c.scene.background = {0, 0, 0};
  auto& layer = std::get<VolumeLayer>(c.scene.layers[0]);
  layer.transfer->colours = {{0, {1, 1, 1}}}, layer.transfer->opacities = {{0, 0.05}};
  LensLayer lens;  // 10.3 of 35 mm are cut out
  BoxShape box;
  box.size_mm = {100, 10.3, 100};
  lens.shape = box;
  lens.pose.translation = c.sources.volumes["v"]->grid().centre().p + glm::dvec3(0, 0.37, 0);
  lens.inner = CutOut{};
  c.scene.layers.emplace_back(lens);
  const double expected = 255 * (1 - std::pow(0.95, 35 - 10.3));
  for (const char* technique : kSliced) {
    const Images images = c.draw(technique);
    const std::size_t middle = 4 * (36 + 72 * 30);
    EXPECT_NEAR(255.0 * static_cast<double>(images.colour[middle]), expected, 0.05) << technique;
  }
}

TEST(GlSlicesWithLenses, ExtremesAreRefused) {
  VERNIER_NEEDS_GL(device);
  PictureCase c;
  std::get<VolumeLayer>(c.scene.layers[0]).mode = VolumeMode::Max;
  c.addLens(CutOut{});
  for (const char* technique : kSliced) {
    Quality quality;
    quality.engine = EngineChoice::Gl, quality.technique = technique;
    test::GlHost& host = lensHost();
    const auto plan =
        makePlan(c.scene, c.view, quality, host.capabilities, CostTable{}, c.sources, host.registry);
    ASSERT_FALSE(plan.ok());
    EXPECT_NE(plan.error().sentence.find("drawn by a projection"), std::string::npos)
        << plan.error().sentence;
  }
}

}  // namespace
}  // namespace vernier::lens
