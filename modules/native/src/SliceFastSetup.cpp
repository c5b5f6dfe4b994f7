// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "SliceFast.h"

namespace vernier::native {
namespace {

// Positions must stay below this, so that 40 fractional bits fit into 64 with room to add.
constexpr double kFarthest_vox = 1 << 21;
// Offsets within a block must fit into 8 whole bits.
constexpr double kWidestBlock_vox = 120.0;
constexpr std::int64_t kReach_vox = 128;

std::int64_t fine(double v_vox) { return std::llround(std::ldexp(v_vox, kFineBits)); }

bool typeFits(VoxelType t) {
  return t == VoxelType::U8 || t == VoxelType::U16 || t == VoxelType::I16 || t == VoxelType::F32;
}

// The corners of the lattice, in voxels, are all near enough.
bool nearEnough(const SliceJob& job, const VoxelLattice& l) {
  for (int c = 0; c < 8; ++c) {
    // One block more than the width: the last block is computed whole.
    const glm::dvec3 p =
        l.at(c & 1 ? job.width_px + kBlock_px : 0, c & 2 ? job.height_px : 0, c & 4 ? l.samples : 0);
    for (int a = 0; a < 3; ++a)
      if (!(std::abs(p[a]) < kFarthest_vox)) return false;
  }
  return true;
}

void setStrides(FastSlice& s, const GridGeometry& g, std::int64_t bytes) {
  s.last = {g.columns - 1, g.rows - 1, g.slices - 1};
  s.stride = {bytes, bytes * g.columns, bytes * g.columns * g.rows};
  for (std::size_t a = 0; a < 3; ++a) s.neighbour[a] = s.last[a] > 0 ? s.stride[a] : 0;
}

void setLattice(FastSlice& s, const VoxelLattice& l) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto i = static_cast<glm::length_t>(a);
    s.origin[a] = fine(l.origin[i]);
    s.right[a] = fine(l.right[i]);
    s.down[a] = fine(l.down[i]);
    s.step[a] = fine(l.step[i]);
    constexpr int drop = kFineBits - kLaneBits;
    for (int n = 0; n < kBlock_px; ++n)
      s.lane[a][n] = static_cast<std::int32_t>((n * s.right[a] + (std::int64_t{1} << (drop - 1))) >> drop);
    s.laneMin[a] = std::min(s.lane[a][0], s.lane[a][kBlock_px - 1]);
    s.laneMax[a] = std::max(s.lane[a][0], s.lane[a][kBlock_px - 1]);
  }
  s.samples = l.samples;
}

std::pair<double, double> limitsOf(VoxelType t) {
  switch (t) {
    case VoxelType::U8:
      return {0, 255};
    case VoxelType::U16:
      return {0, 65535};
    default:
      return {-32768, 32767};
  }
}

void setValues(FastSlice& s, const SliceJob& job, const Display& display) {
  const VoxelType type = job.volume->type();
  const ModalityRescale& r = job.volume->rescaleOf(0);
  s.slope = r.slope;
  s.intercept = r.intercept;
  if (type != VoxelType::F32) {
    const auto [low, high] = limitsOf(type);
    s.bias = static_cast<std::int32_t>(
        std::clamp(std::nearbyint((job.window.center - r.intercept) / r.slope), low, high));
  }
  s.scale = static_cast<float>(display.scale * r.slope);
  s.offset = static_cast<float>(display.offset + display.scale * (r.slope * s.bias + r.intercept));
  s.mode = job.slab.mode;
  if (r.slope < 0 && s.mode != SlabMode::Mean)
    s.mode = s.mode == SlabMode::Max ? SlabMode::Min : SlabMode::Max;
}

void setNoData(FastSlice& s, const SliceJob& job) {
  const auto& range = job.volume->info().noData;
  if (!range) return;
  if (job.volume->type() != VoxelType::F32) {
    const auto [low, high] = limitsOf(job.volume->type());
    s.noFirst = static_cast<std::int32_t>(std::clamp(std::ceil(range->first), low, high + 1));
    s.noLast = static_cast<std::int32_t>(std::clamp(std::floor(range->last), low - 1, high));
    s.hasRange = s.noFirst <= s.noLast;
    return;
  }
  constexpr float inf = std::numeric_limits<float>::infinity();
  // The floats that lie in the range of doubles.
  s.noFirstFloat = static_cast<float>(range->first);
  if (s.noFirstFloat < range->first) s.noFirstFloat = std::nextafter(s.noFirstFloat, inf);
  s.noLastFloat = static_cast<float>(range->last);
  if (s.noLastFloat > range->last) s.noLastFloat = std::nextafter(s.noLastFloat, -inf);
  s.hasRange = s.noFirstFloat <= s.noLastFloat;
}

// Single planes through volumes that the nearer caches do not hold. Not for wide steps, whose lanes would not
// fit.
void setFetchAhead(FastSlice& s, std::int64_t volumeBytes) {
  constexpr std::int64_t kLargeVolume_bytes = std::int64_t{32} << 20;
  constexpr int kRowsAhead = 6, drop = kFineBits - kLaneBits;
  s.fetchAhead = s.samples == 1 && volumeBytes > kLargeVolume_bytes;
  for (std::size_t a = 0; a < 3; ++a) {
    // Of the two voxels that a sample lies between, the one to which the rows move: the other was read for
    // them.
    const std::int64_t further = a > 0 && s.down[a] > 0 ? std::int64_t{1} << kLaneBits : 0;
    const std::int64_t down = kRowsAhead * (s.down[a] >> drop) + further;
    for (int odd = 0; odd < 2; ++odd)
      for (int n = 0; n < kBlock_px / 4; ++n) {
        const std::int64_t at = down + (4 * n + 2 * odd) * (s.right[a] >> drop);
        s.fetchAhead = s.fetchAhead && std::abs(at) < kReach_vox << kLaneBits >> 1;
        s.ahead[odd][a][n] = static_cast<std::int32_t>(at);
      }
  }
}

}  // namespace

std::optional<FastSlice> fastSliceOf(const SliceJob& job, const VoxelLattice& lattice,
                                     const Display& display) {
  const Volume& v = *job.volume;
  const GridGeometry& g = v.grid();
  if (!g.even() || v.info().rescale.size() != 1 || !typeFits(v.type())) return std::nullopt;
  if (!nearEnough(job, lattice)) return std::nullopt;
  for (int a = 0; a < 3; ++a)
    if (!(std::abs(lattice.right[a]) * (kBlock_px - 1) < kWidestBlock_vox)) return std::nullopt;
  const bool cubic = job.interpolation == Interpolation::Cubic;
  if (cubic && (g.columns < 4 || g.rows < 4 || g.slices < 4)) return std::nullopt;
  FastSlice s;
  s.inset = cubic ? std::int64_t{1} << kFineBits : 0;
  setStrides(s, g, static_cast<std::int64_t>(bytesOf(v.type())));
  const auto farthest = static_cast<std::int64_t>(kFarthest_vox);
  if (s.last[0] >= farthest || s.last[1] >= farthest || s.last[2] >= farthest) return std::nullopt;
  if (kReach_vox * (s.stride[0] + s.stride[1] + s.stride[2]) > std::numeric_limits<std::int32_t>::max())
    return std::nullopt;
  s.data = reinterpret_cast<const std::uint8_t*>(v.data());
  setLattice(s, lattice);
  setFetchAhead(s, s.stride[2] * g.slices);
  setValues(s, job, display);
  setNoData(s, job);
  return s;
}

}  // namespace vernier::native
