// SPDX-License-Identifier: GPL-3.0-or-later
// surface.native through the planner: its passes, its picture against the reference, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "SurfaceTechniques.h"
#include "TestPaths.h"
#include "vernier/plan/MakePlan.h"
#include "vernier/quality/Badge.h"

namespace vernier::test {
namespace {

using ::testing::HasSubstr;

// A torus around z: closed, not convex, curved everywhere.
std::shared_ptr<const Mesh> torus(double large, double small, int n) {
  MeshBuilder b;
  const auto at = [&](int i, int j) {
    const double u = 2 * std::numbers::pi * (i % n) / n, v = 2 * std::numbers::pi * (j % n) / n;
    return b.vertex({(large + small * std::cos(v)) * std::cos(u), (large + small * std::cos(v)) * std::sin(u),
                     small * std::sin(v)});
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      b.triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      b.triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return *b.finish();
}

struct Case {
  Scene scene;
  View view{160, 120};
  Sources sources;
  TechniqueRegistry techniques;
  Capabilities machine;
  Case() { EXPECT_TRUE(techniques.add(surfaces::nativeSurfaceTechnique()).ok()); }
  SurfaceLayer& add(std::shared_ptr<const Mesh> mesh, double opacity, Rgb colour = {1, 1, 1}) {
    SurfaceLayer layer;
    layer.source = "m" + std::to_string(scene.layers.size());
    layer.opacity = opacity, layer.colour = colour;
    sources.meshes[layer.source] = std::move(mesh);
    scene.layers.emplace_back(layer);
    return std::get<SurfaceLayer>(scene.layers.back());
  }
  Result<Plan> plan() const {
    return makePlan(scene, view, Quality{}, machine, CostTable{}, sources, techniques);
  }
  Result<Frame> draw(std::stop_token stop = {}) const {
    const Result<Plan> p = plan();
    if (!p) return p.error();
    Frame frame;
    for (const Pass& pass : p->passes)
      if (auto done = techniques.find(pass.technique)->execute(pass, frame.images, stop); !done)
        return done.error();
    return frame;
  }
};

void addThree(Case& c) {
  c.add(torus(30, 8, 60), 1, {0.9, 0.5, 0.2}).pose.translation = {0, 0, 5};
  c.add(torus(20, 6, 40), 0.4, {0.2, 0.5, 0.9}).pose.linear = glm::dmat3({1, 0, 0}, {0, 0, 1}, {0, -1, 0});
  c.add(torus(25, 5, 30), 0.7, {0.4, 0.9, 0.4}).pose.linear =
      glm::dmat3({0, 0, 1.2}, {0, 1.2, 0}, {-1.2, 0, 0});
}

// Every pixel of the population, against double rays with their own camera.
TEST(SurfaceTechnique, EveryPixelIsThatOfTheReference) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const double distance_mm : {300.0, 20.0}) {
      Case c;
      addThree(c);
      c.scene.background = {0.1, 0.1, 0.2};
      c.scene.camera.projection = projection;
      c.scene.camera.azimuth_deg = 30, c.scene.camera.elevation_deg = 20, c.scene.camera.roll_deg = -15;
      c.scene.camera.distance_mm = distance_mm, c.scene.camera.near_mm = 3, c.scene.camera.pan_mm = {5, 2};
      const Result<Frame> frame = c.draw();
      ASSERT_TRUE(frame.ok()) << frame.error().text();
      quality::ErrorOptions options;
      options.samples = 160 * 120;
      const auto error = quality::measureError(*frame, c.scene, c.view, c.sources, options);
      ASSERT_TRUE(error.ok());
      EXPECT_TRUE(error->exhaustive);
      EXPECT_GT(error->population, 2000u);  // not an empty picture
      // A ray that grazes an edge within rounding may fall to either side: none in these pictures.
      EXPECT_LT(error->max, 1e-4) << quality::errorSentence(*error);
    }
}

TEST(SurfaceTechnique, OnePassDrawsAllSurfacesAndCountsTheirTriangles) {
  Case c;
  addThree(c);
  const Result<Plan> plan = c.plan();
  ASSERT_TRUE(plan.ok());
  ASSERT_EQ(plan->passes.size(), 1u);
  EXPECT_TRUE(plan->showsWholeScene);
  EXPECT_EQ(plan->passes[0].name, "surfaces (3)");
  EXPECT_THAT(plan->passes[0].params->dump(),
              HasSubstr("7200 triangles, opacity 1; 3200 triangles, opacity 0.4; "
                        "1800 triangles, opacity 0.7, scaled 1.2"));
  const Result<Frame> frame = c.draw();
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->images.counters.triangles, 7200u + 3200 + 1800);
  // A hidden surface costs nothing.
  std::get<SurfaceLayer>(c.scene.layers[0]).opacity = 0;
  EXPECT_EQ(c.draw()->images.counters.triangles, 3200u + 1800);
}

TEST(SurfaceTechnique, PlanGolden) {
  Case c;
  addThree(c);
  c.scene.camera.projection = Projection::Perspective;
  const std::string path = std::string(VERNIER_SOURCE_DIR) + "/tests/plan/surfaces.plan.txt";
  std::ifstream in(path);
  std::stringstream golden;
  golden << in.rdbuf();
  EXPECT_EQ(dumpPlan(*c.plan()), golden.str()) << "golden: " << path;
}

TEST(SurfaceTechnique, WhatCannotBeDrawnIsSaidWithItsPlace) {
  const auto whereOf = [](const std::function<void(Case&)>& change) {
    Case c;
    addThree(c);
    change(c);
    const Result<Plan> plan = c.plan();
    EXPECT_FALSE(plan.ok());
    EXPECT_EQ(plan.error().code, ErrorCode::SceneInvalid) << plan.error().text();
    return plan.error().where;
  };
  const auto layer = [](Case& c, std::size_t n) -> SurfaceLayer& {
    return std::get<SurfaceLayer>(c.scene.layers[n]);
  };
  EXPECT_EQ(whereOf([&](Case& c) { layer(c, 1).source = "other"; }), "/layers/1/source");
  EXPECT_EQ(whereOf([&](Case& c) { layer(c, 2).pose.linear = glm::dmat3(0.0); }), "/layers/2/pose");
  EXPECT_EQ(whereOf([&](Case& c) { layer(c, 2).pose.translation.x = std::nan(""); }), "/layers/2/pose");
  EXPECT_EQ(whereOf([&](Case& c) { layer(c, 0).opacity = 1.01; }), "/layers/0/opacity");
  EXPECT_EQ(whereOf([&](Case& c) { c.scene.camera.fov_deg = 0; }), "/camera/fov_deg");
  Case mixed;
  addThree(mixed);
  mixed.scene.layers.insert(mixed.scene.layers.begin(), ImageLayer{});
  // Only a layer that something here draws can stand in the way.
  Technique images = surfaces::nativeSurfaceTechnique();
  images.name = "image.test", images.kinds = {"image"};
  ASSERT_TRUE(mixed.techniques.add(std::move(images)).ok());
  EXPECT_EQ(mixed.plan().error().code, ErrorCode::NotBuiltYet);
}

TEST(SurfaceTechnique, AMirroringPoseIsSaid) {
  Case c;
  c.add(torus(30, 8, 12), 1).pose.linear = glm::dmat3({-1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_THAT(c.plan()->passes[0].params->dump(), HasSubstr("mirrored"));
}

TEST(SurfaceTechnique, CancelledBeforeTheFirstTile) {
  Case c;
  addThree(c);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(c.draw(stop.get_token()).error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier::test
