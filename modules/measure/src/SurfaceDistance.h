// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest points of a point and a surface, and of two surfaces, in double. Exact for triangles: a tree of
// boxes only leaves out what cannot be nearer. Points and triangles in mm of the patient.
#pragma once
#include <array>
#include <stop_token>
#include <vector>

#include "vernier/volume/Mesh.h"

namespace vernier::measure {

struct Nearest {
  double distance_mm = 0;
  glm::dvec3 a{0}, b{0};  // on the first and on the second
};

class SurfaceTree {
 public:
  SurfaceTree(const Mesh&, const PatientFromMesh&);
  Nearest nearest(glm::dvec3 point) const;
  // 0 where they touch or pass through each other.
  Nearest nearest(const SurfaceTree&, std::stop_token) const;

 private:
  struct Box {
    glm::dvec3 low, high;
  };
  struct Node {
    Box box;
    std::uint32_t first = 0, count = 0;  // triangles of a leaf
    std::uint32_t left = 0, right = 0;
  };
  using Corners = std::array<glm::dvec3, 3>;
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  Box boxOf(std::uint32_t first, std::uint32_t count) const;
  static double apart(const Box&, const Box&);  // squared
  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace vernier::measure
