// SPDX-License-Identifier: GPL-3.0-or-later
// The SIMD kernels of nearest and linear interpolation.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "SliceFast.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "SliceFastDraw-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

template <class T>
std::uint64_t DrawType(const FastSlice& s, const SliceJob& job, const VoxelLattice& lattice,
                       const Display& display, const Target& target, const Tile& tile,
                       const std::stop_token& stop) {
  const Scene<T> scene{s, job, lattice, display, target, GeneralSampler<T>(*job.volume)};
  // Nearest reads are few and cheap: one kernel serves with and without a no-data range (which is then
  // empty).
  if (job.interpolation == Interpolation::Nearest)
    return DrawRows<T, Interpolation::Nearest, true>(scene, tile, stop);
  return s.hasRange ? DrawRows<T, Interpolation::Linear, true>(scene, tile, stop)
                    : DrawRows<T, Interpolation::Linear, false>(scene, tile, stop);
}

std::uint64_t DrawTile(const FastSlice& s, const SliceJob& job, const VoxelLattice& lattice,
                       const Display& display, const Target& target, const Tile& tile,
                       const std::stop_token& stop) {
  switch (job.volume->type()) {
    case VoxelType::U8:
      return DrawType<std::uint8_t>(s, job, lattice, display, target, tile, stop);
    case VoxelType::U16:
      return DrawType<std::uint16_t>(s, job, lattice, display, target, tile, stop);
    case VoxelType::I16:
      return DrawType<std::int16_t>(s, job, lattice, display, target, tile, stop);
    default:
      return DrawType<float>(s, job, lattice, display, target, tile, stop);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::native {

HWY_EXPORT(DrawTile);

std::uint64_t drawFast(const FastSlice& s, const SliceJob& job, const VoxelLattice& lattice,
                       const Display& display, const Target& target, const Tile& tile,
                       const std::stop_token& stop) {
  if (job.interpolation == Interpolation::Cubic)
    return drawFastCubic(s, job, lattice, display, target, tile, stop);
  return HWY_DYNAMIC_DISPATCH(DrawTile)(s, job, lattice, display, target, tile, stop);
}

}  // namespace vernier::native
#endif
