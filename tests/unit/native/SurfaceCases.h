// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes, cameras and the truth for the tests of surfaces: every pixel of a picture is one ray, answered by
// Moller and Trumbore's test in long double over all triangles.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vernier/base/Random.h"
#include "vernier/native/Surfaces.h"

namespace vernier::native {

using V = glm::vec<3, long double>;

struct Hit {
  double t_mm;
  std::size_t surface, triangle;
};

// Where a ray meets a triangle; nothing when it does not, or behind its origin. `margin` takes the smallest
// barycentric coordinate in size: near 0, rounding may decide.
inline std::optional<double> meet(const PatientRay& ray, const V& a, const V& b, const V& c,
                                  long double* margin) {
  const V d(ray.direction.v), o(ray.origin.p), e1 = b - a, e2 = c - a, p = glm::cross(d, e2);
  const long double det = glm::dot(e1, p);
  if (det == 0) return std::nullopt;
  const V s = o - a, q = glm::cross(s, e1);
  const long double u = glm::dot(s, p) / det, v = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
  *margin = std::min({*margin, std::abs(u), std::abs(v), std::abs(1 - u - v)});
  if (u < 0 || v < 0 || u + v > 1 || t < 0) return std::nullopt;
  return static_cast<double>(t);
}

inline std::vector<Hit> allHits(const SurfaceJob& job, double x, double y, long double* margin) {
  std::vector<Hit> hits;
  const PatientRay ray = job.camera.ray(x, y);
  const double nearest = job.camera.near_mm * job.camera.rayPerDepth(x, y);
  for (std::size_t s = 0; s < job.surfaces.size(); ++s) {
    const Mesh& mesh = *job.surfaces[s].mesh;
    const auto at = [&](std::uint32_t v) { return V((job.surfaces[s].pose * mesh.vertices()[v]).p); };
    for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
      const Triangle& t = mesh.triangles()[i];
      if (const auto d = meet(ray, at(t[0]), at(t[1]), at(t[2]), margin); d && *d >= nearest)
        hits.push_back({*d, s, i});
    }
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.t_mm < b.t_mm; });
  return hits;
}

inline std::shared_ptr<const Mesh> meshOf(const std::vector<std::array<glm::dvec3, 3>>& triangles) {
  MeshBuilder b;
  for (const auto& t : triangles) {
    const std::uint32_t p = b.vertex(t[0]), q = b.vertex(t[1]);
    b.triangle(p, q, b.vertex(t[2]));
  }
  return *b.finish();
}

inline std::shared_ptr<const Mesh> box(glm::dvec3 low, glm::dvec3 high) {
  std::vector<std::array<glm::dvec3, 3>> t;
  const auto at = [&](int n) {
    return glm::dvec3(n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z);
  };
  constexpr int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                               {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads)
    t.push_back({at(q[0]), at(q[1]), at(q[2])}), t.push_back({at(q[0]), at(q[2]), at(q[3])});
  return meshOf(t);
}

// A square facing the camera of azimuth 0 and elevation 0 (which looks along +y), cut in n x n x 2 triangles.
inline std::shared_ptr<const Mesh> square(double half, double y, int n = 1, bool otherDiagonal = false) {
  std::vector<std::array<glm::dvec3, 3>> t;
  const auto at = [&](int i, int k) {
    return glm::dvec3(half * (2.0 * i / n - 1), y, half * (2.0 * k / n - 1));
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const glm::dvec3 a = at(i, k), b = at(i + 1, k), c = at(i + 1, k + 1), d = at(i, k + 1);
      if (otherDiagonal)
        t.push_back({a, b, d}), t.push_back({b, c, d});
      else
        t.push_back({a, b, c}), t.push_back({a, c, d});
    }
  return meshOf(t);
}

inline std::shared_ptr<const Mesh> soup(int n, double reach, double size, std::uint64_t seed) {
  std::vector<std::array<glm::dvec3, 3>> t(static_cast<std::size_t>(n));
  std::uint64_t draw = 0;
  const auto r = [&](double s) { return s * (2 * randomUnit(seed, draw++) - 1); };
  for (auto& corners : t) {
    const glm::dvec3 middle(r(reach), r(reach), r(reach));
    for (glm::dvec3& c : corners) c = middle + glm::dvec3(r(size), r(size), r(size));
  }
  return meshOf(t);
}

inline CameraPicture cameraFor(const Camera& camera, int width, int height, double diagonal_mm = 100) {
  const auto picture =
      cameraPicture(camera, View{width, height}, CameraBox{PatientPoint(0, 0, 0), diagonal_mm});
  EXPECT_TRUE(picture.ok());
  return *picture;
}

inline Camera turned(double azimuth_deg, double elevation_deg, Projection projection, double roll_deg = 0) {
  Camera c;
  c.azimuth_deg = azimuth_deg, c.elevation_deg = elevation_deg, c.projection = projection,
  c.roll_deg = roll_deg;
  return c;
}

inline std::size_t layersAt(const SurfaceHits& hits, std::size_t pixel) {
  return hits.first[pixel + 1] - hits.first[pixel];
}

}  // namespace vernier::native
