// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Outline.h"

#include <algorithm>
#include <cmath>

#include "vernier/volume/MeshCut.h"

namespace vernier {
namespace {

constexpr double kSeam_px = 1;

double distance(glm::dvec2 p, const LineSegment& s) {
  const glm::dvec2 along = s.b - s.a;
  const double size2 = glm::dot(along, along);
  const double t = size2 > 0 ? std::clamp(glm::dot(p - s.a, along) / size2, 0.0, 1.0) : 0;
  return glm::length(p - s.a - t * along);
}

// The part within `reach` of the picture, so that a line to far away costs nothing.
bool clip(LineSegment& s, const Picture& picture, double reach) {
  const glm::dvec2 low(-reach), high(picture.width + reach, picture.height + reach);
  double from = 0, to = 1;
  const glm::dvec2 along = s.b - s.a;
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0) {
      if (s.a[axis] < low[axis] || s.a[axis] > high[axis]) return false;
      continue;
    }
    const double t0 = (low[axis] - s.a[axis]) / along[axis], t1 = (high[axis] - s.a[axis]) / along[axis];
    from = std::max(from, std::min(t0, t1)), to = std::min(to, std::max(t0, t1));
  }
  if (!(from <= to)) return false;
  s = {s.a + from * along, s.a + to * along};
  return true;
}

std::uint8_t blended(std::uint8_t under, double over, double share) {
  return static_cast<std::uint8_t>(
      std::floor(under + share * (255 * std::clamp(over, 0.0, 1.0) - under) + 0.5));
}

}  // namespace

void drawLines(Picture& picture, std::span<const LineSegment> segments, Rgb colour, double width_px,
               double opacity) {
  const double reach = 0.5 * width_px + kSeam_px + 1;
  // Distance of each pixel to the nearest line, as far as it matters.
  std::vector<float> nearest(
      static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height),
      static_cast<float>(reach));
  for (LineSegment s : segments) {
    if (!std::isfinite(s.a.x + s.a.y + s.b.x + s.b.y) || !clip(s, picture, reach)) continue;
    const glm::dvec2 low = glm::min(s.a, s.b) - reach, high = glm::max(s.a, s.b) + reach;
    const int x1 = std::min(picture.width - 1, static_cast<int>(high.x)),
              y1 = std::min(picture.height - 1, static_cast<int>(high.y));
    for (int y = std::max(0, static_cast<int>(low.y)); y <= y1; ++y)
      for (int x = std::max(0, static_cast<int>(low.x)); x <= x1; ++x) {
        float& d = nearest[static_cast<std::size_t>(x) +
                           static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(y)];
        d = std::min(d, static_cast<float>(distance({x + 0.5, y + 0.5}, s)));
      }
  }
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double d = nearest[static_cast<std::size_t>(x) +
                               static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(y)];
      const double line = std::clamp(0.5 * width_px + 0.5 - d, 0.0, 1.0);
      const double seam = std::clamp(0.5 * width_px + kSeam_px + 0.5 - d, 0.0, 1.0);
      if (seam <= 0) continue;
      std::uint8_t* p = picture.at(x, y);
      const double rgb[3] = {colour.r, colour.g, colour.b};
      for (int c = 0; c < 3; ++c)
        p[c] = blended(blended(p[c], 0, 0.6 * opacity * seam), rgb[c], opacity * line);
    }
}

std::vector<LineSegment> outlineOf(const SurfaceLayer& layer, const Mesh& mesh, const SliceLayer& slice,
                                   const SlicePicture& picture) {
  const double perPixel2 = dot(picture.right, picture.right);
  const auto pixel = [&](PatientPoint p) {
    return glm::dvec2(dot(p - picture.origin, picture.right), dot(p - picture.origin, picture.down)) /
           perPixel2;
  };
  std::vector<LineSegment> lines;
  for (const CutSegment& s : cutMesh(mesh, layer.pose, slice.plane.point, picture.normal))
    lines.push_back({pixel(s.a), pixel(s.b)});
  return lines;
}

}  // namespace vernier
