// SPDX-License-Identifier: GPL-3.0-or-later
#include "StripGeometry.h"

#include <algorithm>
#include <cmath>

namespace vernier::mpr {
namespace {

constexpr double kBorderTolerance_vox = 1e-6;
constexpr double kInSlice_vox = 1e-6;

// The side of a line in the picture where offset + x * slope.x + y * slope.y >= 0.
struct HalfPlane {
  double offset = 0;
  glm::dvec2 slope{0};
  double value(glm::dvec2 p) const { return offset + glm::dot(slope, p); }
};

// coordinate >= bound or <= bound along one voxel axis.
HalfPlane beyond(const VoxelPlane& plane, int axis, double bound, bool above, Margin margin) {
  const double sign = above ? 1.0 : -1.0;
  const glm::dvec2 slope = sign * glm::dvec2(plane.right[axis], plane.down[axis]);
  return {sign * (plane.origin[axis] - bound) + std::max(margin.px * glm::length(slope), margin.vox), slope};
}

// Two strips meet in the same vertices, whichever side they are cut from: the crossing is computed from the
// inner end for neither of them, but in the order of the coordinates.
glm::dvec2 crossing(const HalfPlane& h, glm::dvec2 a, glm::dvec2 b) {
  if (b.x < a.x || (b.x == a.x && b.y < a.y)) std::swap(a, b);
  const double va = h.value(a), vb = h.value(b);
  return a + (b - a) * (va / (va - vb));
}

// Sutherland and Hodgman's clipping of a convex polygon by one line.
Outline clipped(const Outline& in, const HalfPlane& h) {
  Outline out;
  for (std::size_t n = 0; n < in.size(); ++n) {
    const glm::dvec2 a = in[n], b = in[(n + 1) % in.size()];
    const bool insideA = h.value(a) >= 0, insideB = h.value(b) >= 0;
    if (insideA) out.push_back(a);
    if (insideA != insideB) out.push_back(crossing(h, a, b));
  }
  return out.size() < 3 ? Outline{} : out;
}

Outline pictureOutline(int width_px, int height_px, double margin_px) {
  const double w = width_px + margin_px, h = height_px + margin_px, m = -margin_px;
  return {{m, m}, {w, m}, {w, h}, {m, h}};
}

// The box of all slices in the plane of k: slices of an uneven stack may be shifted against each other.
void slicesExtent(const GridGeometry& g, glm::dvec2& lower, glm::dvec2& upper) {
  lower = glm::dvec2(0), upper = glm::dvec2(0);
  for (std::size_t n = 0; n < g.sliceOrigin_vox.size(); ++n) {
    const glm::dvec2 o(g.sliceOrigin_vox[n]);
    lower = n == 0 ? o : glm::min(lower, o);
    upper = n == 0 ? o : glm::max(upper, o);
  }
  lower -= 0.5 + kBorderTolerance_vox;
  upper +=
      glm::dvec2(static_cast<double>(g.columns), static_cast<double>(g.rows)) - 0.5 + kBorderTolerance_vox;
}

struct Extent {
  double lower = 0, upper = 0;
};
Extent extentAlongK(const VoxelPlane& plane, const Outline& outline) {
  Extent e{plane.at(outline[0]).z, plane.at(outline[0]).z};
  for (const glm::dvec2& p : outline) {
    const double k = plane.at(p).z;
    e.lower = std::min(e.lower, k), e.upper = std::max(e.upper, k);
  }
  return e;
}

double positionOf(const GridGeometry& g, std::int64_t slice) {
  return g.even() ? static_cast<double>(slice) : g.sliceOrigin_vox[static_cast<std::size_t>(slice)].z;
}

// The slice that a plane lies in, -1 when it lies in none.
std::int64_t sliceOf(const GridGeometry& g, const Extent& e) {
  if (e.upper - e.lower > kInSlice_vox) return -1;
  const double k = (e.lower + e.upper) / 2;
  for (std::int64_t s = 0; s < g.slices; ++s)
    if (std::abs(positionOf(g, s) - k) <= kInSlice_vox) return s;
  return -1;
}

}  // namespace

double areaOf(const Outline& o) {
  double twice = 0;
  for (std::size_t n = 0; n < o.size(); ++n) {
    const glm::dvec2 a = o[n], b = o[(n + 1) % o.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

std::vector<StackPart> partsOf(const GridGeometry& g) {
  const double half = 0.5 + kBorderTolerance_vox;
  const std::int64_t last = g.slices - 1;
  if (last == 0) return {{0, 0, positionOf(g, 0) - half, positionOf(g, 0) + half}};
  std::vector<StackPart> parts{{0, 0, positionOf(g, 0) - half, positionOf(g, 0)}};
  for (std::int64_t s = 0; s < last; ++s) {
    const double below = positionOf(g, s), above = positionOf(g, s + 1);
    if (!std::binary_search(g.gapAfter.begin(), g.gapAfter.end(), s)) {
      parts.push_back({s, s + 1, below, above});
      continue;
    }
    const double held = std::min(half, (above - below) / 2);
    parts.push_back({s, s, below, below + held});
    parts.push_back({s + 1, s + 1, above - held, above});
  }
  parts.push_back({last, last, positionOf(g, last), positionOf(g, last) + half});
  return parts;
}

Outline crossSection(const VoxelPlane& plane, const GridGeometry& g, int width_px, int height_px,
                     Margin margin) {
  glm::dvec2 lower, upper;
  slicesExtent(g, lower, upper);
  const double half = 0.5 + kBorderTolerance_vox;
  Outline outline = pictureOutline(width_px, height_px, margin.px);
  for (int axis = 0; axis < 2; ++axis) {
    outline = clipped(outline, beyond(plane, axis, lower[axis], true, margin));
    outline = clipped(outline, beyond(plane, axis, upper[axis], false, margin));
  }
  outline = clipped(outline, beyond(plane, 2, g.firstPosition_vox() - half, true, margin));
  return clipped(outline, beyond(plane, 2, g.lastPosition_vox() + half, false, margin));
}

std::vector<Strip> cutIntoStrips(const VoxelPlane& plane, const GridGeometry& g, int width_px, int height_px,
                                 Margin margin) {
  const Outline whole = crossSection(plane, g, width_px, height_px, margin);
  if (whole.empty()) return {};
  const Extent extent = extentAlongK(plane, whole);
  if (const std::int64_t s = sliceOf(g, extent); s >= 0) {
    const double k = positionOf(g, s);
    return {{{s, s, k - 0.5, k + 0.5}, plane, whole}};
  }
  std::vector<Strip> strips;
  for (const StackPart& part : partsOf(g)) {
    if (part.upper < extent.lower - margin.vox || part.lower > extent.upper + margin.vox) continue;
    Outline outline = clipped(whole, beyond(plane, 2, part.lower, true, margin));
    outline = clipped(outline, beyond(plane, 2, part.upper, false, margin));
    if (!outline.empty()) strips.push_back({part, plane, std::move(outline)});
  }
  return strips;
}

}  // namespace vernier::mpr
