// SPDX-License-Identifier: GPL-3.0-or-later
// Solids in Patient mm, painted in order along rows of voxels. Every shape is convex, so that a row meets it
// in one interval; the value at a voxel is the solid's fill, blended by coverage = clamp(0.5 - d / edge, 0,
// 1), where d is the signed distance to the surface at the voxel's centre (exact for boxes' faces, cylinders
// and balls, first order for ellipsoids). edge 0: inside or outside, nothing between.
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace vernier::phantoms {

enum class Shape { Ellipsoid, Box, Cylinder, Capsule };
enum class Fill {
  Constant,
  Speckle,  // cells of `cell_mm`, each with value or value2 by hash: air cells, spongy bone
  Folds,    // value2 where a smooth random field is near 0: winding sheets, as the sulci of a brain
  Blobs,    // value + value2 * a smooth random field in [-1, 1]: mottled tissue
  Combs,    // value2 in the gaps of a comb by angle about the local z axis: teeth
};

struct HalfSpace {  // dot(normal, p) <= offset_mm, unit normal
  glm::dvec3 normal{0, 0, 1};
  double offset_mm = 0;
};

struct Solid {
  std::string name;
  Shape shape = Shape::Ellipsoid;
  glm::dvec3 centre_mm{0};
  // Ellipsoid: semi-axes; Box: half edges; Cylinder: semi-axes x, y and half length z; Capsule: radius at -z,
  // at +z, half length.
  glm::dvec3 size_mm{1};
  glm::dmat3 patientFromLocal{1.0};  // rotation
  std::vector<HalfSpace> clips;
  Fill fill = Fill::Constant;
  double value = 0, value2 = 0, cell_mm = 1, threshold = 0;
  double noise = 0;           // standard deviation of the noise inside
  bool sheetsOnly = false;    // Folds: only the sheets are painted, what lies between shows through
  std::uint64_t texture = 0;  // solids with the same number (not 0) share one random field
  bool maximum = false;       // raises what is there, never lowers it (vessels)
};

// One row of voxels: voxel i lies at start + i * step.
struct RowLine {
  glm::dvec3 start_mm{0}, step_mm{1, 0, 0};
  std::int64_t count = 0;
};

struct AxisBox {
  glm::dvec3 low{0}, high{0};
  bool meets(const AxisBox& o) const {
    return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
           low.z <= o.high.z && o.low.z <= high.z;
  }
};

AxisBox boundsOf(const Solid&, double edge_mm);
// Signed distance of a patient point to the surface, clips included; negative inside.
double signedDistance(const Solid&, glm::dvec3 p_mm);
// Smooth value noise in [-1, 1] on a lattice of 1 unit; keeps the corners of the cell where it was last
// asked.
class SmoothNoise {
 public:
  explicit SmoothNoise(std::uint64_t seed) : seed_(seed) {}
  double at(glm::dvec3 p);

 private:
  std::uint64_t seed_;
  glm::dvec3 cell_{1e300};
  double corner_[8] = {};
};

// Value of the solid's fill at a point, and how much of it covers there (1 but for Folds with sheetsOnly).
struct FillValue {
  double value = 0, weight = 1;
};
struct Texture {
  explicit Texture(std::uint64_t seedOf) : seed(seedOf), coarse(seedOf), fine(seedOf + 1) {}
  std::uint64_t seed;
  SmoothNoise coarse, fine;
};
FillValue fillAt(const Solid&, glm::dvec3 p_mm, Texture&);

// Paints one solid over value and noise (standard deviation) of a row.
void paintRow(const Solid&, const RowLine&, double edge_mm, std::uint64_t seed, std::span<double> value,
              std::span<double> noise);

}  // namespace vernier::phantoms
