// SPDX-License-Identifier: GPL-3.0-or-later
// All surface layers of a scene, ray by ray in double: the rays of its own camera against every triangle,
// found through a tree of boxes.
//
// A ray that passes exactly through an edge that two triangles share belongs to one of them: the one that
// also has the points just right of the pixel's centre, or below it (the top-left rule).
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "RayCamera.h"
#include "vernier/plan/Technique.h"

namespace vernier::quality {

struct SurfaceHit {
  double t_mm = 0;
  std::size_t layer = 0;     // among the surface layers, in the scene's order
  std::size_t triangle = 0;  // of the layer's mesh
  double cosine = 0;         // between ray and normal, never negative
};

// What the headlight leaves of a colour, by the cosine between ray and normal.
double shareOfHeadlight(double cosine);

class SurfaceReference {
 public:
  // Without a camera: that of surfaces alone. With a camera there may be none.
  static Result<SurfaceReference> make(const Scene&, const View&, const Sources&, const RayCamera* = nullptr);

  // All hits of the pixel's ray, nearest first; of those at one place the later layer first.
  std::vector<SurfaceHit> hits(glm::dvec2 pixel) const;
  bool covers(glm::dvec2 pixel) const { return !hits(pixel).empty(); }
  struct Look {
    glm::dvec3 colour;
    double opacity;
  };
  Look lookOf(const SurfaceHit&) const;  // lit
  // Over the background, and whether anything was hit.
  struct Seen {
    glm::dvec3 colour{0};
    double depth_mm = 0;  // of the first opaque hit; +inf where there is none
    bool covered = false;
  };
  Seen seen(glm::dvec2 pixel, glm::dvec3 background) const;

  // For the population: corners of a triangle in pixels; false when one of them is not before the eye.
  std::size_t triangles() const { return triangles_.size(); }
  bool corners(std::size_t triangle, std::array<glm::dvec2, 3>& px) const;

 private:
  struct Placed {
    std::array<glm::dvec3, 3> p;  // right, down, forward of the eye, mm
    std::size_t layer, triangle;
  };
  struct Node {
    glm::dvec3 low, high;
    std::size_t begin = 0, end = 0;  // leaf: of triangles_
    std::size_t right = 0;           // inner: the left child is the next node
  };
  struct Ray {
    glm::dvec3 origin, direction;  // in the eye's frame; direction.z == 1
  };
  Ray rayOf(glm::dvec2 pixel) const;
  void build(std::size_t begin, std::size_t end);
  bool meets(const Ray&, const Placed&, SurfaceHit&) const;

  RayCamera camera_;
  std::vector<Look> layers_;
  std::vector<Placed> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace vernier::quality
