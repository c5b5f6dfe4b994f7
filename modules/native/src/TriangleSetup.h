// SPDX-License-Identifier: GPL-3.0-or-later
// What a triangle is to a rasteriser: three lines in the picture, and depth as a function of the pixel.
// J. Pineda, A parallel algorithm for polygon rasterization (1988); M. Olano and T. Greer, Triangle scan
// conversion using 2D homogeneous coordinates (1997): a pixel (x, y, 1) is a sum of the three corners (X, Y,
// W) with weights of one sign exactly when it is seen through the triangle, whatever side of the eye the
// corners are on.
#pragma once
#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

#include "SurfaceCover.h"

namespace vernier::native {

// The line through two corners. Seen from the neighbour, whose edge runs the other way, all three numbers and
// E itself are exactly the negative ones: no pixel is lost between two triangles, and none is taken twice.
// Top-left: a centre exactly on the line lies to the right of a left edge and below a top edge (y runs down).
inline EdgeLine edgeThrough(const glm::dvec4& p, const glm::dvec4& q, bool forwards) {
  const double a = p.y * q.w - p.w * q.y, b = p.w * q.x - p.x * q.w, c = p.x * q.y - p.y * q.x;
  return {a, b, c, a > 0 || (a == 0 && (b > 0 || (b == 0 && forwards)))};
}

// Depth along the view axis as a function of the pixel.
class DepthPlane {
 public:
  // False for a triangle that is seen edge-on exactly.
  bool set(const glm::dvec4& p, const glm::dvec4& q, const glm::dvec4& r, bool perspective) {
    perspective_ = perspective;
    const glm::dvec3 u(q.x - p.x, q.y - p.y, q.w - p.w), v(r.x - p.x, r.y - p.y, r.w - p.w);
    least_ = std::min({p.z, q.z, r.z}), most_ = std::max({p.z, q.z, r.z});
    if (perspective) {
      const glm::dvec3 n = glm::cross(u, v);
      const double det = n.x * p.x + n.y * p.y + n.z * p.w;
      if (det == 0) return false;
      gx_ = n.x / det, gy_ = n.y / det, at0_ = n.z / det;  // of 1 / depth
    } else {
      const double area = u.x * v.y - u.y * v.x;
      if (area == 0) return false;
      const double du = q.z - p.z, dv = r.z - p.z;
      gx_ = (du * v.y - dv * u.y) / area, gy_ = (dv * u.x - du * v.x) / area;
      at0_ = p.z - gx_ * p.x - gy_ * p.y;
    }
    return std::isfinite(gx_ + gy_ + at0_);
  }
  // Negative where the triangle is behind the eye. Between the corners' depths, also where it is seen nearly
  // edge-on and the plane's slope is all rounding.
  double at(double x, double y) const {
    const double d = gx_ * x + gy_ * y + at0_;
    if (!perspective_) return std::clamp(d, least_, most_);
    if (!(d > 0)) return -1;
    return std::clamp(1 / d, std::max(least_, 0.0), most_);
  }

 private:
  double gx_ = 0, gy_ = 0, at0_ = 0, least_ = 0, most_ = 0;
  bool perspective_ = false;
};

}  // namespace vernier::native
