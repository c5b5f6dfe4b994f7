// SPDX-License-Identifier: GPL-3.0-or-later
#include "StackGeometry.h"

#include <algorithm>
#include <cmath>

namespace vernier::dvr {
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

}  // namespace vernier::dvr
