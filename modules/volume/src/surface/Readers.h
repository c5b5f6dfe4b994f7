// SPDX-License-Identifier: GPL-3.0-or-later
// The readers behind readSurface(), one per format. Each takes the file's bytes and fills a Polygons.
#pragma once
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "vernier/volume/SurfaceFile.h"

namespace vernier::surface {

// Where readers leave what they find: points in the file's order, polygons by index into them.
class Polygons {
 public:
  Polygons(MeshBuilder& builder, std::stop_token stop) : builder_(builder), stop_(std::move(stop)) {}

  void reserve(std::uint64_t triangles);  // at most as many as may be read
  void point(glm::dvec3 p) { points_.push_back(p), vertices_.push_back(builder_.vertex(p)); }
  std::size_t points() const { return points_.size(); }
  // Later polygons count from the next point on (a new node of a scene graph).
  void startPoints() { points_.clear(), vertices_.clear(); }

  // Three or more corners; fewer draw nothing and are ignored. Not convex: cut by ears. Errors (without a
  // place): FileDamaged for an index that is no point, LimitExceeded, Cancelled.
  Result<void> polygon(std::span<const std::uint32_t> corners);
  // For triangles that bring their own points (STL).
  Result<void> triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);

 private:
  Result<void> mayGoOn(std::size_t more);
  void cutEars(std::span<const std::uint32_t> corners, std::span<const glm::dvec2> flat);
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    builder_.triangle(vertices_[a], vertices_[b], vertices_[c]);
  }
  MeshBuilder& builder_;
  std::stop_token stop_;
  std::vector<glm::dvec3> points_;
  std::vector<std::uint32_t> vertices_;  // of points_, in the builder
};

// Errors of readers carry no file name: the caller adds it.
Result<void> readStl(std::string_view bytes, Polygons&, SurfaceFile&);
Result<void> readPly(std::string_view bytes, Polygons&, SurfaceFile&);
Result<void> readObj(std::string_view bytes, Polygons&, SurfaceFile&);
Result<void> readSceneGraph(std::string_view bytes, Polygons&, SurfaceFile&);  // Inventor and VRML
Result<void> readVtp(std::string_view bytes, Polygons&, SurfaceFile&);         // by VTK

}  // namespace vernier::surface
