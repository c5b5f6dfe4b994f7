// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/MeshCut.h"

#include <utility>

namespace vernier {

std::vector<CutSegment> cutMesh(const Mesh& mesh, const PatientFromMesh& pose, PatientPoint onPlane,
                                PatientVec normal) {
  std::vector<double> height(mesh.vertices().size());
  for (std::size_t i = 0; i < height.size(); ++i)
    height[i] = dot(pose * mesh.vertices()[i] - onPlane, normal);
  const auto before = [&](std::uint32_t v) { return height[v] >= 0; };
  // From the vertex behind the plane to the one before it, whichever triangle asks.
  const auto cut = [&](std::uint32_t p, std::uint32_t q) {
    if (before(p)) std::swap(p, q);
    const PatientPoint a = pose * mesh.vertices()[p], b = pose * mesh.vertices()[q];
    return a + (b - a) * (height[p] / (height[p] - height[q]));
  };
  std::vector<CutSegment> segments;
  for (const Triangle& t : mesh.triangles()) {
    PatientPoint ends[2];
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t p = t[i], q = t[(i + 1) % 3];
      if (before(p) != before(q)) ends[n++] = cut(p, q);
    }
    if (n == 2) segments.push_back({ends[0], ends[1]});
  }
  return segments;
}

}  // namespace vernier
