// SPDX-License-Identifier: GPL-3.0-or-later
// The reference's hits against ray-triangle tests in long double over all triangles, and its pictures against
// closed forms.
#include "SurfaceReference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vernier/base/Random.h"
#include "vernier/plan/CameraPicture.h"
#include "vernier/quality/Badge.h"

namespace vernier::quality {
namespace {

using V = glm::vec<3, long double>;

std::shared_ptr<const Mesh> soup(int n, double reach, double size, std::uint64_t seed) {
  MeshBuilder b;
  std::uint64_t draw = 0;
  const auto r = [&](double s) { return s * (2 * randomUnit(seed, draw++) - 1); };
  for (int i = 0; i < n; ++i) {
    const glm::dvec3 middle(r(reach), r(reach), r(reach));
    std::uint32_t v[3];
    for (std::uint32_t& corner : v) corner = b.vertex(middle + glm::dvec3(r(size), r(size), r(size)));
    b.triangle(v[0], v[1], v[2]);
  }
  return *b.finish();
}

struct Case {
  Scene scene;
  View view{96, 64};
  Sources sources;
  SurfaceLayer& add(std::shared_ptr<const Mesh> mesh, double opacity) {
    SurfaceLayer layer;
    layer.source = "m" + std::to_string(scene.layers.size());
    layer.opacity = opacity;
    sources.meshes[layer.source] = std::move(mesh);
    scene.layers.emplace_back(layer);
    return std::get<SurfaceLayer>(scene.layers.back());
  }
};

// Distances of all hits of a pixel, ascending, by the planner's camera; `margin`: how near an edge the ray
// passes.
std::vector<double> bruteForce(const Case& c, double x, double y, long double& margin) {
  const CameraPicture camera = *cameraPicture(c.scene.camera, c.view, *cameraBox(c.scene, c.sources));
  const PatientRay ray = camera.ray(x, y);
  const V d(ray.direction.v), o(ray.origin.p);
  std::vector<double> hits;
  for (const Layer& l : c.scene.layers) {
    const auto& layer = std::get<SurfaceLayer>(l);
    const Mesh& mesh = *c.sources.meshes.at(layer.source);
    for (const Triangle& t : mesh.triangles()) {
      const V a((layer.pose * mesh.vertices()[t[0]]).p), e1 = V((layer.pose * mesh.vertices()[t[1]]).p) - a,
                                                         e2 = V((layer.pose * mesh.vertices()[t[2]]).p) - a,
                                                         p = glm::cross(d, e2);
      const long double det = glm::dot(e1, p);
      if (det == 0) continue;
      const V s = o - a, q = glm::cross(s, e1);
      const long double u = glm::dot(s, p) / det, v = glm::dot(d, q) / det, h = glm::dot(e2, q) / det;
      margin = std::min({margin, std::abs(u), std::abs(v), std::abs(1 - u - v)});
      if (u >= 0 && v >= 0 && u + v <= 1 && h >= camera.near_mm * camera.rayPerDepth(x, y))
        hits.push_back(static_cast<double>(h));
    }
  }
  std::sort(hits.begin(), hits.end());
  return hits;
}

TEST(SurfaceReference, HitsAreThoseOfAllTrianglesTested) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const bool inside : {false, true}) {
      Case c;
      c.scene.camera.projection = projection;
      c.scene.camera.azimuth_deg = 33, c.scene.camera.elevation_deg = -21, c.scene.camera.roll_deg = 10;
      c.scene.camera.zoom = 1.3, c.scene.camera.pan_mm = {3, -4};
      if (inside) c.scene.camera.distance_mm = 1, c.scene.camera.fov_deg = 110, c.scene.camera.near_mm = 0.5;
      c.add(soup(150, 20, 12, 5), 0.5).pose.linear = glm::dmat3({1, 0.2, 0}, {0, 0.7, 0}, {0.3, 0, 1});
      c.add(soup(150, 20, 12, 6), 1).pose.translation = {2, 3, 4};
      const auto reference = SurfaceReference::make(c.scene, c.view, c.sources);
      ASSERT_TRUE(reference.ok());
      std::size_t met = 0;
      for (int n = 0; n < 1500; ++n) {
        const glm::dvec2 pixel(96 * randomUnit(3, 2 * n), 64 * randomUnit(3, 2 * n + 1));
        long double margin = 1;
        const std::vector<double> truth = bruteForce(c, pixel.x, pixel.y, margin);
        if (margin < 1e-11L) continue;
        const std::vector<SurfaceHit> hits = reference->hits(pixel);
        ASSERT_EQ(hits.size(), truth.size());
        for (std::size_t i = 0; i < hits.size(); ++i)
          ASSERT_NEAR(hits[i].t_mm, truth[i], 1e-9 * (1 + truth[i]));
        met += hits.size();
      }
      EXPECT_GT(met, 500u);
    }
}

// A sheet of two triangles, one translucent before one opaque: colour, depth and cover have closed forms.
TEST(SurfaceReference, ColourAndDepthHaveClosedForms) {
  const auto sheet = [](double y) {
    MeshBuilder b;
    const std::uint32_t v[4] = {b.vertex({-9, y, -9}), b.vertex({9, y, -9}), b.vertex({9, y, 9}),
                                b.vertex({-9, y, 9})};
    b.triangle(v[0], v[1], v[2]);
    b.triangle(v[0], v[2], v[3]);
    return *b.finish();
  };
  Case c;
  c.view = {65, 65};
  c.scene.camera.projection = Projection::Perspective;
  c.scene.camera.target = PatientPoint(0, 0, 0), c.scene.camera.distance_mm = 50, c.scene.camera.fov_deg = 40;
  c.scene.background = {0.1, 0.2, 0.3};
  c.add(sheet(10), 1).colour = {0.5, 1, 0};
  c.add(sheet(-10), 0.25).colour = {1, 0, 0};
  const auto reference = SurfaceReference::make(c.scene, c.view, c.sources);
  ASSERT_TRUE(reference.ok());
  const double step = 2 * std::tan(20 * std::numbers::pi / 180) / 65;
  for (int column = 0; column < 65; ++column) {
    const double slope = (column - 32) * step, ray = std::sqrt(1 + slope * slope), shade = 0.2 + 0.8 / ray;
    const bool front = std::abs(slope) * 40 < 9, back = std::abs(slope) * 60 < 9;
    const auto seen = reference->seen({column + 0.5, 32.5}, {0.1, 0.2, 0.3});
    EXPECT_EQ(seen.covered, front || back);
    EXPECT_EQ(std::isfinite(seen.depth_mm), back);
    if (back) {
      EXPECT_NEAR(seen.depth_mm, 60 * ray, 1e-10);
    }
    const glm::dvec3 behind = back ? shade * glm::dvec3(0.5, 1, 0) : glm::dvec3(0.1, 0.2, 0.3);
    const glm::dvec3 all = front ? 0.25 * shade * glm::dvec3(1, 0, 0) + 0.75 * behind : behind;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(seen.colour[i], all[i], 1e-13);
  }
}

// The badge must see what is wrong: a picture of another pose, and a single triangle that is missing.
TEST(SurfaceReference, TheMeasuredErrorSeesWhatIsWrong) {
  Case c;
  c.add(soup(60, 20, 14, 8), 1);
  const std::size_t count = 96 * 64;
  std::vector<std::size_t> all(count);
  for (std::size_t n = 0; n < count; ++n) all[n] = n;
  const auto truth = referencePixels(c.scene, c.view, c.sources, all);
  ASSERT_TRUE(truth.ok());
  Frame frame;
  frame.images.allocate(96, 64, false);
  for (std::size_t n = 0; n < count; ++n)
    for (int i = 0; i < 4; ++i)
      frame.images.colour[4 * n + static_cast<std::size_t>(i)] = static_cast<float>((*truth)[n].rgba[i]);
  ErrorOptions options;
  options.samples = count;
  const auto right = measureError(frame, c.scene, c.view, c.sources, options);
  ASSERT_TRUE(right.ok());
  EXPECT_TRUE(right->exhaustive);
  EXPECT_LT(right->max, 1e-4);
  EXPECT_LT(right->population, count);  // not all of the picture can show something
  for (std::size_t n = 0; n < count; ++n) {
    if ((*truth)[n].covered) {
      EXPECT_GT(frame.images.colour[4 * n], 0.0f);
    }
  }
  std::get<SurfaceLayer>(c.scene.layers[0]).pose.translation = {0, 0, 0.5};
  c.scene.camera.target = PatientPoint(0, 0, 0);
  const auto moved = measureError(frame, c.scene, c.view, c.sources, options);
  ASSERT_TRUE(moved.ok());
  EXPECT_GT(moved->max, 20);
}

// Every pixel that shows something is in the population, also where triangles reach behind the eye.
TEST(SurfaceReference, ThePopulationHoldsAllThatIsSeen) {
  for (const bool inside : {false, true}) {
    Case c;
    c.scene.camera.projection = Projection::Perspective, c.scene.camera.azimuth_deg = 70;
    if (inside) c.scene.camera.distance_mm = 0;
    c.add(soup(60, 20, 8, 9), 0.5);
    const auto reference = SurfaceReference::make(c.scene, c.view, c.sources);
    ASSERT_TRUE(reference.ok());
    std::size_t covered = 0;
    for (int row = 0; row < 64; ++row)
      for (int column = 0; column < 96; ++column) covered += reference->covers({column + 0.5, row + 0.5});
    Frame frame;
    frame.images.allocate(96, 64, false);
    ErrorOptions options;
    options.samples = 96 * 64;
    const auto r = measureError(frame, c.scene, c.view, c.sources, options);
    ASSERT_TRUE(r.ok());
    EXPECT_GE(r->population, covered);
    EXPECT_GT(covered, 100u);
  }
}

TEST(SurfaceReference, AMissingSourceIsSaid) {
  Case c;
  c.add(soup(3, 5, 5, 1), 1);
  c.sources.meshes.clear();
  EXPECT_EQ(SurfaceReference::make(c.scene, c.view, c.sources).error().code, ErrorCode::SceneInvalid);
}

}  // namespace
}  // namespace vernier::quality
