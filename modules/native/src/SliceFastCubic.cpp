// SPDX-License-Identifier: GPL-3.0-or-later
// The SIMD kernel of cubic interpolation: a source of its own, so that both compile side by side.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "SliceFastCubic.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "SliceFastDraw-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

template <class T>
std::uint64_t DrawCubicType(const FastSlice& s, const SliceJob& job, const VoxelLattice& lattice,
                            const Display& display, const Target& target, const Tile& tile,
                            const std::stop_token& stop) {
  const Scene<T> scene{s, job, lattice, display, target, GeneralSampler<T>(*job.volume)};
  return s.hasRange ? DrawRows<T, Interpolation::Cubic, true>(scene, tile, stop)
                    : DrawRows<T, Interpolation::Cubic, false>(scene, tile, stop);
}

std::uint64_t DrawCubicTile(const FastSlice& s, const SliceJob& job, const VoxelLattice& lattice,
                            const Display& display, const Target& target, const Tile& tile,
                            const std::stop_token& stop) {
  switch (job.volume->type()) {
    case VoxelType::U8:
      return DrawCubicType<std::uint8_t>(s, job, lattice, display, target, tile, stop);
    case VoxelType::U16:
      return DrawCubicType<std::uint16_t>(s, job, lattice, display, target, tile, stop);
    case VoxelType::I16:
      return DrawCubicType<std::int16_t>(s, job, lattice, display, target, tile, stop);
    default:
      return DrawCubicType<float>(s, job, lattice, display, target, tile, stop);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::native {

HWY_EXPORT(DrawCubicTile);

std::uint64_t drawFastCubic(const FastSlice& s, const SliceJob& job, const VoxelLattice& lattice,
                            const Display& display, const Target& target, const Tile& tile,
                            const std::stop_token& stop) {
  return HWY_DYNAMIC_DISPATCH(DrawCubicTile)(s, job, lattice, display, target, tile, stop);
}

}  // namespace vernier::native
#endif
