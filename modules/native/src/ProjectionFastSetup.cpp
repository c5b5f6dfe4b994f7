// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "ProjectionFast.h"

namespace vernier::native {
namespace {

bool typeFits(VoxelType t) {
  return t == VoxelType::U8 || t == VoxelType::U16 || t == VoxelType::I16 || t == VoxelType::F32;
}

// Sixteen steps and their cells must stay within 32 bits of an address.
bool stridesFit(const GridGeometry& g, VoxelType type) {
  const double slice =
      static_cast<double>(g.columns) * static_cast<double>(g.rows) * static_cast<double>(bytesOf(type));
  return slice * 64 < 2147483647.0;
}

// Stored values near the middle of what there is, so that float keeps its digits.
std::int32_t biasOf(const Volume& v) {
  if (v.type() == VoxelType::F32) return 0;
  const auto range = v.modalityRange();
  if (!range) return 0;
  const ModalityRescale& r = v.rescaleOf(0);
  return static_cast<std::int32_t>(std::lround((0.5 * (range->min + range->max) - r.intercept) / r.slope));
}

void setBounds(FastProjection& p, const ProjectionBounds& bounds, bool greatest) {
  p.fine = (greatest ? bounds.fine.greatest : bounds.fine.least).data();
  p.coarse = (greatest ? bounds.coarse.greatest : bounds.coarse.least).data();
  for (std::size_t a = 0; a < 3; ++a)
    p.fineSize[a] = bounds.fine.size[a], p.coarseSize[a] = bounds.coarse.size[a];
  if (!bounds.holes.empty()) p.holes = bounds.holes.data();
}

}  // namespace

std::optional<FastProjection> fastProjectionOf(const ProjectionJob& job) {
  const Volume& v = *job.volume;
  const GridGeometry& g = v.grid();
  if (!g.even() || v.info().rescale.size() > 1 || !typeFits(v.type()) || !stridesFit(g, v.type()) ||
      job.interpolation != Interpolation::Linear)
    return std::nullopt;
  const bool mayHoldNoData = v.info().noData || v.type() == VoxelType::F32;
  if (mayHoldNoData && !job.bounds) return std::nullopt;  // they say where no-data lies
  FastProjection p;
  p.job = &job;
  const ModalityRescale& r = v.rescaleOf(0);
  p.slope = r.slope, p.intercept = r.intercept;
  p.read.data = reinterpret_cast<const std::uint8_t*>(v.data());
  const auto size = static_cast<std::int64_t>(bytesOf(v.type()));
  p.read.stride = {size, size * g.columns, size * g.columns * g.rows};
  p.read.last = {g.columns - 1, g.rows - 1, g.slices - 1};
  p.read.neighbour = p.read.stride;
  p.read.bias = biasOf(v);

  const bool greatest = job.mode != ProjectionMode::Min;
  p.sign = greatest == (r.slope > 0) ? 1.0f : -1.0f;
  const double perModality = (greatest ? 1 : -1) / std::abs(r.slope);
  const double zero = r.slope * p.read.bias + r.intercept;
  const auto range = v.modalityRange();
  const double largest = range ? std::max(std::abs(range->min), std::abs(range->max)) : 0;
  const double slack = 4e-7 * (largest + std::abs(zero)) / std::abs(r.slope);
  p.boundScale = static_cast<float>(perModality);
  p.boundOffset = static_cast<float>(-perModality * zero + slack);
  if (job.bounds) setBounds(p, *job.bounds, greatest);

  if (const Gather gather = gatherOf(job); gather == Gather::Cued || gather == Gather::Emission) {
    if (job.window.function == VoiFunction::Sigmoid) return std::nullopt;
    const VoiRamp ramp = rampOf(job.window);
    if (!(ramp.hi > ramp.lo)) return std::nullopt;
    p.greyScale = static_cast<float>(std::abs(r.slope) / (ramp.hi - ramp.lo));
    p.greyOffset = static_cast<float>((zero - ramp.lo) / (ramp.hi - ramp.lo));
  }
  return p;
}

bool samplesFast(const ProjectionJob& job) { return fastProjectionOf(job).has_value(); }

}  // namespace vernier::native
