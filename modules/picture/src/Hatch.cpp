// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Hatch.h"

#include <algorithm>
#include <atomic>

#include "vernier/base/Threads.h"

namespace vernier {
namespace {

constexpr Rgb8 kLine{120, 120, 120};
constexpr int kPeriod_px = 8, kLine_px = 2;

// The point lies between slices s and s + 1, after s slices are missing, and within the columns and rows of
// both.
bool inGap(const GridGeometry& grid, const glm::dvec3& p) {
  const auto& origins = grid.sliceOrigin_vox;
  const auto above = std::upper_bound(origins.begin(), origins.end(), p.z,
                                      [](double z, const glm::dvec3& o) { return z < o.z; });
  if (above == origins.begin() || above == origins.end()) return false;
  const glm::dvec3 &a = *(above - 1), &b = *above;
  if (!std::binary_search(grid.gapAfter.begin(), grid.gapAfter.end(), above - origins.begin() - 1))
    return false;
  if (p.z <= a.z + 0.5 || p.z >= b.z - 0.5) return false;  // a slice is held for half a step
  const glm::dvec3 origin = a + (b - a) * ((p.z - a.z) / (b.z - a.z));
  const double column = p.x - origin.x, row = p.y - origin.y;
  return column >= -0.5 && column <= static_cast<double>(grid.columns) - 0.5 && row >= -0.5 &&
         row <= static_cast<double>(grid.rows) - 0.5;
}

// `pointAt` gives the patient point of a pixel's centre, if it has one.
template <class PointAt>
std::size_t hatch(Picture& picture, const Images& images, const GridGeometry& grid, const PointAt& pointAt) {
  if (grid.gapAfter.empty() || grid.even()) return 0;
  const VoxelFromPatient voxelFromPatient = grid.patientFromVoxel.inverse();
  std::atomic<std::size_t> count = 0;
  const auto row = [&](int y) {
    std::size_t n = 0;
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
      if (images.depth[at] != kNothing_mm) continue;
      const std::optional<PatientPoint> p = pointAt(glm::dvec2(x + 0.5, y + 0.5));
      if (!p || !inGap(grid, (voxelFromPatient * *p).p)) continue;
      ++n;
      if ((x + y) % kPeriod_px >= kLine_px) continue;
      std::uint8_t* rgb = picture.at(x, y);
      rgb[0] = kLine.r, rgb[1] = kLine.g, rgb[2] = kLine.b;
    }
    count += n;
  };
  parallelFor(static_cast<std::size_t>(picture.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) row(static_cast<int>(y));
  });
  return count;
}

}  // namespace

std::size_t hatchGaps(Picture& picture, const Images& images, const SlicePicture& slice,
                      const GridGeometry& grid) {
  return hatch(picture, images, grid,
               [&](glm::dvec2 pixel) { return std::optional(patientAt(slice, pixel)); });
}

std::size_t hatchGaps(Picture& picture, const Images& images, const CurvedPicture& curved,
                      const GridGeometry& grid) {
  return hatch(picture, images, grid, [&](glm::dvec2 pixel) { return patientAt(curved, pixel); });
}

}  // namespace vernier
