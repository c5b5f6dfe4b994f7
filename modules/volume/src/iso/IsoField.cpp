// SPDX-License-Identifier: GPL-3.0-or-later
#include "IsoField.h"

#include <algorithm>
#include <cmath>

#include "../VoxelAccess.h"

namespace vernier::iso {
namespace {

constexpr float kMost = 1e37f;  // of a voxel: differences to the outside stay finite

// One row of voxels; widens least and most.
template <class T>
void fillRow(const Volume& volume, const ModalityRescale& r, const T* from, std::int64_t n, float* out,
             IsoField::Block& block) {
  const std::optional<NoDataRange>& noData = volume.info().noData;
  for (std::int64_t i = 0; i < n; ++i) {
    const double stored = static_cast<double>(from[i]);
    if (inRange(noData, stored)) {
      out[i] = kOutside;
      continue;
    }
    out[i] = asField(r.slope * stored + r.intercept);
    block.least = std::min(block.least, out[i]), block.most = std::max(block.most, out[i]);
  }
}

}  // namespace

float asField(double modality) {
  return static_cast<float>(std::clamp(modality, -static_cast<double>(kMost), static_cast<double>(kMost)));
}

IsoField::IsoField(const Volume& volume)
    : volume_(volume),
      columns_(static_cast<int>(volume.grid().columns + 2)),
      rows_(static_cast<int>(volume.grid().rows + 2)) {
  const GridGeometry& g = volume.grid();
  slices_.push_back(-1);
  for (std::int64_t k = 0; k < g.slices; ++k) {
    slices_.push_back(k);
    if (std::binary_search(g.gapAfter.begin(), g.gapAfter.end(), k)) slices_.push_back(-1);
  }
  slices_.push_back(-1);
}

void IsoField::fill(int firstLayer, int count, Block& block) const {
  const std::size_t across = static_cast<std::size_t>(columns_), down = static_cast<std::size_t>(rows_);
  block.values.assign(across * down * static_cast<std::size_t>(count), kOutside);
  block.least = kMost, block.most = -kMost;
  const GridGeometry& g = volume_.grid();
  for (int n = 0; n < count; ++n) {
    const std::int64_t k = slices_[static_cast<std::size_t>(firstLayer + n)];
    if (k < 0) continue;
    const ModalityRescale& rescale = volume_.rescaleOf(k);
    withVoxels(volume_.type(), volume_.data(), [&](const auto* voxels) {
      for (std::int64_t j = 0; j < g.rows; ++j) {
        float* const out = block.values.data() + 1 +
                           across * (static_cast<std::size_t>(j + 1) + down * static_cast<std::size_t>(n));
        fillRow(volume_, rescale, voxels + g.columns * (j + g.rows * k), g.columns, out, block);
      }
    });
  }
}

glm::dvec3 IsoField::originOf(std::int64_t slice) const {
  const GridGeometry& g = volume_.grid();
  return g.even() ? glm::dvec3(0, 0, static_cast<double>(slice))
                  : g.sliceOrigin_vox[static_cast<std::size_t>(slice)];
}

PatientPoint IsoField::place(double column, double row, double layer) const {
  const int last = layers() - 1, below = std::clamp(static_cast<int>(std::floor(layer)), 0, last - 1);
  std::int64_t a = slices_[static_cast<std::size_t>(below)], b = slices_[static_cast<std::size_t>(below) + 1];
  if (a < 0) a = b;
  if (b < 0) b = a;
  const double t = layer - below;
  const glm::dvec3 origin = a == b ? originOf(a) : originOf(a) * (1 - t) + originOf(b) * t;
  const glm::dvec3 inPlane(std::clamp(column - 1, 0.0, columns_ - 3.0), std::clamp(row - 1, 0.0, rows_ - 3.0),
                           0);
  return volume_.grid().patientFromVoxel * VoxelPoint(inPlane + origin);
}

}  // namespace vernier::iso
