// SPDX-License-Identifier: GPL-3.0-or-later
#include "StackGeometry.h"

#include <algorithm>
#include <cmath>

namespace vernier::dvr {
namespace {

constexpr double kMargin_px = 1;
// Points nearer to the eye than this part of the volume's size are as good as beside it.
constexpr double kBesideEye = 1e-3;

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

}  // namespace

int stackAxis(const CameraPicture& camera, const GridGeometry& grid) {
  const glm::dmat3 inverse = glm::inverse(grid.patientFromVoxel.linear);
  int best = 2;
  double most = -1;
  for (const int axis : {2, 1, 0}) {
    const glm::dvec3 across(inverse[0][axis], inverse[1][axis], inverse[2][axis]);
    const double cosine = std::abs(glm::dot(glm::normalize(across), camera.forward.v));
    if (cosine > most + 1e-12) most = cosine, best = axis;
  }
  return best;
}

int slicesPerVoxel(double step) { return step > 0.75 ? 1 : step > 0.375 ? 2 : step > 0.1875 ? 4 : 8; }

std::vector<StackSlice> stackSlices(std::int64_t count, int perVoxel) {
  std::vector<StackSlice> out;
  for (std::int64_t n = 0; n <= (count - 1) * perVoxel; ++n) {
    const double alpha = static_cast<double>(n % perVoxel) / perVoxel;
    out.push_back({static_cast<double>(n / perVoxel) + alpha, n / perVoxel, alpha});
  }
  return out;
}

std::vector<StackPolygon> stackPolygons(const std::vector<StackSlice>& slices, std::size_t perPolygon,
                                        int axis, const CameraPicture& camera,
                                        const VoxelFromPatient& toVoxel) {
  std::vector<StackPolygon> out;
  for (std::size_t first = 0; first < slices.size(); first += perPolygon)
    out.push_back({first, std::min(perPolygon, slices.size() - first)});
  const bool perspective = camera.projection == Projection::Perspective;
  const double eye = (toVoxel * camera.eye).p[axis], along = (toVoxel * camera.forward).v[axis];
  const auto depth = [&](const StackPolygon& p) {
    const double middle = 0.5 * (slices[p.first].place + slices[p.first + p.count - 1].place);
    return perspective ? std::abs(middle - eye) : middle * along;
  };
  std::stable_sort(out.begin(), out.end(),
                   [&](const StackPolygon& a, const StackPolygon& b) { return depth(a) < depth(b); });
  return out;
}

Outline outlineOf(glm::dvec3 least, glm::dvec3 greatest, const CameraPicture& camera,
                  const PatientFromVoxel& toPatient) {
  const glm::dmat4 pixelFromVoxel = camera.pixelFromPatient() * toPatient.matrix();
  const double beside = kBesideEye * glm::length((toPatient * VoxelVec(greatest - least)).v);
  std::vector<glm::dvec2> points;
  for (int n = 0; n < 8; ++n) {
    const glm::dvec3 corner(n & 1 ? greatest.x : least.x, n & 2 ? greatest.y : least.y,
                            n & 4 ? greatest.z : least.z);
    const glm::dvec4 p = pixelFromVoxel * glm::dvec4(corner, 1);
    if (camera.projection == Projection::Perspective && !(p.w > beside)) {
      const double w = camera.width_px, h = camera.height_px;
      return {{0, 0}, {w, 0}, {w, h}, {0, h}};
    }
    for (int side = 0; side < 4; ++side)
      points.push_back(glm::dvec2(p) / p.w + kMargin_px * glm::dvec2(side & 1 ? 1 : -1, side & 2 ? 1 : -1));
  }
  return hullOf(std::move(points));
}

double areaOf(const Outline& o) {
  double twice = 0;
  for (std::size_t n = 0; n < o.size(); ++n) {
    const glm::dvec2 a = o[n], b = o[(n + 1) % o.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

}  // namespace vernier::dvr
