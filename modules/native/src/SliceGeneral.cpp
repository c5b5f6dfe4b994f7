// SPDX-License-Identifier: GPL-3.0-or-later
// The general kernel: every voxel type and every grid, one sample at a time, in double.
#include "GeneralSampler.h"
#include "SliceKernel.h"

namespace vernier::native {
namespace {

// Maximum, minimum or mean of the samples of one pixel that have data.
struct Accumulator {
  SlabMode mode;
  double value = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t n = 0;
  void add(double v) {
    if (std::isnan(v)) return;
    if (n++ == 0) {
      value = v;
    } else {
      value = mode == SlabMode::Max   ? std::max(value, v)
              : mode == SlabMode::Min ? std::min(value, v)
                                      : value + v;
    }
  }
  double result() const { return mode == SlabMode::Mean && n > 1 ? value / static_cast<double>(n) : value; }
};

template <class T>
std::uint64_t drawGeneral(const SliceJob& job, const VoxelLattice& lattice, const Display& display,
                          const Target& target, const Tile& tile, const std::stop_token& stop) {
  const GeneralSampler<T> sampler(*job.volume);
  std::uint64_t samples = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (stop.stop_requested()) return samples;
    for (int x = tile.x0; x < tile.x1; ++x) {
      Accumulator pixel{job.slab.mode};
      for (int k = 0; k < lattice.samples; ++k) {
        pixel.add(sampler.value(job.interpolation, lattice.at(x, y, k), samples));
      }
      putPixel(display, target, x, y, pixel.result());
    }
  }
  return samples;
}

}  // namespace

TileKernel generalKernel(VoxelType type) {
  switch (type) {
    case VoxelType::U8:
      return drawGeneral<std::uint8_t>;
    case VoxelType::I8:
      return drawGeneral<std::int8_t>;
    case VoxelType::U16:
      return drawGeneral<std::uint16_t>;
    case VoxelType::I16:
      return drawGeneral<std::int16_t>;
    case VoxelType::U32:
      return drawGeneral<std::uint32_t>;
    case VoxelType::I32:
      return drawGeneral<std::int32_t>;
    case VoxelType::F32:
      return drawGeneral<float>;
  }
  return drawGeneral<float>;
}

}  // namespace vernier::native
