// SPDX-License-Identifier: GPL-3.0-or-later
#include "SlabGeometry.h"

#include <algorithm>
#include <cmath>

namespace vernier::dvr {
namespace {

// Points nearer to the eye than this are as good as beside it.
constexpr double kBesideEye_mm = 0.01;

double cross(glm::dvec2 o, glm::dvec2 a, glm::dvec2 b) {
  return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

// Andrew's monotone chain (1979).
Outline hullOf(std::vector<glm::dvec2> points) {
  std::sort(points.begin(), points.end(),
            [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  Outline hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = hull.size();
    for (const glm::dvec2& p : points) {
      while (hull.size() >= begin + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

glm::dvec3 cornerOf(glm::dvec3 least, glm::dvec3 greatest, int n) {
  return {n & 1 ? greatest.x : least.x, n & 2 ? greatest.y : least.y, n & 4 ? greatest.z : least.z};
}

double depthOf(glm::dvec3 voxel, const CameraPicture& camera, const PatientFromVoxel& toPatient) {
  return dot(toPatient * VoxelPoint(voxel) - camera.eye, camera.forward);
}

}  // namespace

std::optional<std::int64_t> slabSize(std::int64_t slices, std::uint64_t bytesOfSlice, std::uint64_t budget,
                                     std::int64_t most) {
  const auto fit = static_cast<std::int64_t>(
      std::min<std::uint64_t>(budget / std::max<std::uint64_t>(1, bytesOfSlice), 1u << 30));
  const std::int64_t size = std::min({slices, fit, most});
  if (size < 2) return std::nullopt;
  return size;
}

std::vector<Slab> slabsOf(std::int64_t slices, std::int64_t size, const CameraPicture& camera,
                          const VoxelFromPatient& toVoxel) {
  constexpr double kBeyond = 1e9;
  std::vector<Slab> out;
  for (std::int64_t first = 0; first == 0 || first + 1 < slices; first += size - 1) {
    const std::int64_t count = std::min(size, slices - first);
    const bool last = first + count == slices;
    out.push_back({first, count, first == 0 ? -kBeyond : static_cast<double>(first),
                   last ? kBeyond : static_cast<double>(first + count - 1)});
  }
  const bool perspective = camera.projection == Projection::Perspective;
  const double eye = (toVoxel * camera.eye).p.z, along = (toVoxel * camera.forward).v.z;
  const auto depth = [&](const Slab& s) {
    if (perspective) return std::max({s.from - eye, eye - s.below, 0.0});
    return along >= 0 ? static_cast<double>(s.first) : -static_cast<double>(s.first);
  };
  std::stable_sort(out.begin(), out.end(), [&](const Slab& a, const Slab& b) { return depth(a) < depth(b); });
  return out;
}

std::vector<glm::dvec3> bodyBetween(glm::dvec3 least, glm::dvec3 greatest, double from_mm, double to_mm,
                                    const CameraPicture& camera, const PatientFromVoxel& toPatient) {
  std::vector<glm::dvec3> out;
  for (int n = 0; n < 8; ++n) {
    const glm::dvec3 a = cornerOf(least, greatest, n);
    const double depth = depthOf(a, camera, toPatient);
    if (depth >= from_mm && depth <= to_mm) out.push_back(a);
    for (const int bit : {1, 2, 4}) {
      if (n & bit) continue;
      const glm::dvec3 b = cornerOf(least, greatest, n | bit);
      const double other = depthOf(b, camera, toPatient);
      for (const double at : {from_mm, to_mm})
        if ((depth < at) != (other < at)) out.push_back(glm::mix(a, b, (at - depth) / (other - depth)));
    }
  }
  return out;
}

glm::dvec2 depthsOf(glm::dvec3 least, glm::dvec3 greatest, const CameraPicture& camera,
                    const PatientFromVoxel& toPatient) {
  glm::dvec2 out(1e300, -1e300);
  for (int n = 0; n < 8; ++n) {
    const double depth = depthOf(cornerOf(least, greatest, n), camera, toPatient);
    out = {std::min(out.x, depth), std::max(out.y, depth)};
  }
  return out;
}

Outline outlineOf(const std::vector<glm::dvec3>& voxels, const CameraPicture& camera,
                  const PatientFromVoxel& toPatient, double margin_px) {
  const glm::dmat4 pixelFromVoxel = camera.pixelFromPatient() * toPatient.matrix();
  std::vector<glm::dvec2> points;
  for (const glm::dvec3& v : voxels) {
    const glm::dvec4 p = pixelFromVoxel * glm::dvec4(v, 1);
    if (camera.projection == Projection::Perspective && !(p.w > kBesideEye_mm)) {
      const double w = camera.width_px, h = camera.height_px;
      return {{0, 0}, {w, 0}, {w, h}, {0, h}};
    }
    for (int side = 0; side < 4; ++side)
      points.push_back(glm::dvec2(p) / p.w + margin_px * glm::dvec2(side & 1 ? 1 : -1, side & 2 ? 1 : -1));
  }
  return points.size() < 3 ? Outline{} : hullOf(std::move(points));
}

}  // namespace vernier::dvr
