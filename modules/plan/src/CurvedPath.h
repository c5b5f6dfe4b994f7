// SPDX-License-Identifier: GPL-3.0-or-later
// The path of a curved reformat as a curve over its arc length (CurvedGeometry.h says which curve).
#pragma once
#include <span>
#include <vector>

#include "vernier/base/Frames.h"
#include "vernier/base/Result.h"

namespace vernier {

// Consecutive points nearer than this count once.
inline constexpr double kCoincident_mm = 1e-6;

class CurvedPath {
 public:
  struct At {
    glm::dvec3 point, tangent, up;  // mm; unit vectors, perpendicular to each other
  };

  // The curve through the points, seen along `alongUp` when that is not zero: then its component along it is
  // taken away, and `up` is alongUp everywhere. Else `up` at the beginning is the given one, and follows.
  static Result<CurvedPath> make(std::span<const PatientPoint> points, glm::dvec3 up, bool seenAlongUp);

  double length_mm() const { return nodes_.back().s; }
  At at(double s_mm) const;  // s is clamped to the path
  std::size_t coincident() const { return coincident_; }
  // Of the curve itself, along `up`, from the least to the greatest.
  double lowest_mm() const { return lowest_; }
  double highest_mm() const { return highest_; }

  // Where the sheet, reaching `half` to both sides along up and `halfSlab` across, overlaps itself first:
  // the radius there; 0 when it does not.
  struct Overlap {
    double radius_mm = 0, at_mm = 0;
  };
  Overlap overlap(double half_mm, double halfSlab_mm) const;
  // Arc length at which the curve first meets itself again (within 1/2700 of its length), below 0 when it
  // does not.
  double crossing() const;

 private:
  // One piece between two points: point = c0 + v (c1 + v (c2 + v c3)), v in [0, 1].
  struct Piece {
    glm::dvec3 c0, c1, c2, c3;
    glm::dvec3 at(double v) const { return c0 + v * (c1 + v * (c2 + v * c3)); }
    glm::dvec3 slope(double v) const { return c1 + v * (2.0 * c2 + 3.0 * v * c3); }
    glm::dvec3 bend(double v) const { return 2.0 * c2 + 6.0 * v * c3; }
    double length(double a, double b) const;
  };
  // Nodes lie so close that the tangent turns by a few degrees from one to the next.
  struct Node {
    std::size_t piece = 0;
    double v = 0, s = 0;
    glm::dvec3 point, tangent, up;
  };

  static std::vector<Piece> piecesThrough(std::span<const glm::dvec3> points);
  void flatten(glm::dvec3 up);
  bool addNodes(std::size_t piece, double a, double b, int depth);
  void measure();
  bool carryUp(glm::dvec3 up);
  glm::dvec3 tangentAt(std::size_t piece, double v) const;

  std::vector<Piece> pieces_;
  std::vector<Node> nodes_;
  std::size_t coincident_ = 0;
  double lowest_ = 0, highest_ = 0;
  bool seenAlongUp_ = false;
};

}  // namespace vernier
