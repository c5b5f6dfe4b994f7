// SPDX-License-Identifier: GPL-3.0-or-later
// The SIMD kernel, compiled once per instruction set. A block is 16 pixels of a row; its samples along a
// slab's normal are split into those at which the whole block lies between voxel centres (for cubic: a voxel
// further inside), which need no tests at all, and the others, which are clamped and masked lane by lane.
#if defined(VERNIER_SLICE_FAST_DRAW_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VERNIER_SLICE_FAST_DRAW_INL_H
#undef VERNIER_SLICE_FAST_DRAW_INL_H
#else
#define VERNIER_SLICE_FAST_DRAW_INL_H
#endif
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "SliceFastRead-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

// A few units of 2^-24 for rounding: where it is that close to a face, each lane is tested.
constexpr std::int64_t kMargin = std::int64_t{4} << kDrop;

// Maximum, minimum or compensated sum of the samples of a vector of pixels.
struct Gathered {
  V value, lost, count;
};

HWY_INLINE Gathered Start(SlabMode mode) {
  const D d;
  constexpr float inf = std::numeric_limits<float>::infinity();
  const V first = hn::Set(d, mode == SlabMode::Max ? -inf : mode == SlabMode::Min ? inf : 0.0f);
  return {first, hn::Zero(d), hn::Zero(d)};
}

HWY_INLINE void AddSum(Gathered& g, V w) {
  const V y = hn::Sub(w, g.lost);
  const V t = hn::Add(g.value, y);
  g.lost = hn::Sub(hn::Sub(t, g.value), y);
  g.value = t;
}

HWY_INLINE void Add(Gathered& g, SlabMode mode, V w, M valid) {
  const D d;
  g.count = hn::Add(g.count, hn::IfThenElseZero(valid, hn::Set(d, 1.0f)));
  if (mode == SlabMode::Max)
    g.value = hn::IfThenElse(valid, hn::Max(g.value, w), g.value);
  else if (mode == SlabMode::Min)
    g.value = hn::IfThenElse(valid, hn::Min(g.value, w), g.value);
  else
    AddSum(g, hn::IfThenElseZero(valid, w));
}

HWY_INLINE void AddWhole(Gathered& g, SlabMode mode, V w) {
  if (mode == SlabMode::Max)
    g.value = hn::Max(g.value, w);
  else if (mode == SlabMode::Min)
    g.value = hn::Min(g.value, w);
  else
    AddSum(g, w);
}

// The samples [anyBegin, anyEnd) at which some pixel of a block may lie in the volume, and among them those
// at which all of them lie inside as far as reads without tests need.
struct Span {
  std::int64_t anyBegin = 0, inBegin = 0, inEnd = 0, anyEnd = 0;
};

// Narrows [begin, end) to the k with from + k * step >= least.
HWY_INLINE void KeepAtLeast(std::int64_t from, std::int64_t step, std::int64_t least, std::int64_t& begin,
                            std::int64_t& end) {
  const std::int64_t need = least - from;
  if (begin >= end) return;
  if (begin + 1 == end || step == 0) {
    if (step * begin < need) end = begin;
  } else if (step > 0) {
    if (need > step * begin) begin = (need + step - 1) / step;
  } else if (need > step * (end - 1)) {
    // k <= need / step, both at most zero or the range is empty.
    end = need > 0 ? begin : std::min(end, need / step + 1);
  }
}

HWY_INLINE Span SpanOf(const FastSlice& s, const std::int64_t (&fine)[3]) {
  constexpr std::int64_t kHalf = std::int64_t{1} << (kFineBits - 1);
  Span r{0, 0, s.samples, s.samples};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t low = fine[a] + (static_cast<std::int64_t>(s.laneMin[a]) << kDrop);
    const std::int64_t high = fine[a] + (static_cast<std::int64_t>(s.laneMax[a]) << kDrop);
    const std::int64_t last = s.last[a] << kFineBits;
    KeepAtLeast(low, s.step[a], s.inset + kMargin, r.inBegin, r.inEnd);
    KeepAtLeast(-high, -s.step[a], s.inset + kMargin - last, r.inBegin, r.inEnd);
    KeepAtLeast(high, s.step[a], -kHalf - kMargin, r.anyBegin, r.anyEnd);
    KeepAtLeast(-low, -s.step[a], -last - kHalf - kMargin, r.anyBegin, r.anyEnd);
  }
  if (r.anyBegin >= r.anyEnd) return {0, 0, 0, 0};
  if (r.inBegin >= r.inEnd) r.inBegin = r.inEnd = r.anyEnd;
  return r;
}

// What a tile needs at hand.
template <class T>
struct Scene {
  const FastSlice& s;
  const SliceJob& job;
  const VoxelLattice& lattice;
  const Display& display;
  const Target& target;
  GeneralSampler<T> sampler;
};

// Lanes next to no-data, or not finite, are done again in double. Removes those without data from `valid`.
template <class T, Interpolation kI>
HWY_NOINLINE V Redo(const Scene<T>& scene, int x, int y, std::int64_t k, V w, M redo, M& valid) {
  const D d;
  float values[kBlock_px], wanted[kBlock_px], good[kBlock_px];
  hn::StoreU(w, d, values);
  hn::StoreU(hn::IfThenElseZero(redo, hn::Set(d, 1.0f)), d, wanted);
  hn::StoreU(hn::IfThenElseZero(valid, hn::Set(d, 1.0f)), d, good);
  const FastSlice& s = scene.s;
  for (int n = 0; n < static_cast<int>(hn::Lanes(d)); ++n) {
    if (wanted[n] == 0 || good[n] == 0) continue;
    std::uint64_t counted = 0;  // the caller has counted it
    const glm::dvec3 p = scene.lattice.at(x + n, y, static_cast<int>(k));
    const double m = scene.sampler.value(kI, p, counted);
    if (std::isnan(m))
      good[n] = 0;
    else
      values[n] = static_cast<float>((m - s.intercept) / s.slope - s.bias);
  }
  valid = hn::Gt(hn::LoadU(d, good), hn::Zero(d));
  return hn::LoadU(d, values);
}

// All samples of one vector of pixels at (x, y); lanes beyond `active` are not drawn. kInner: every sample of
// the block is known to need no tests.
template <class T, Interpolation kI, bool kRange, bool kInner>
HWY_INLINE Gathered GatherSamples(const Scene<T>& scene, const std::int64_t (&start)[3], const Span& span,
                                  int lane0, int x, int y, M active, std::uint64_t& samples) {
  const D d;
  const DI di;
  const FastSlice& s = scene.s;
  constexpr bool kCareful = kRange || std::is_same_v<T, float>;
  const VI lanes[3] = {hn::LoadU(di, s.lane[0] + lane0), hn::LoadU(di, s.lane[1] + lane0),
                       hn::LoadU(di, s.lane[2] + lane0)};
  Gathered g = Start(s.mode);
  std::int64_t fine[3];
  for (std::size_t a = 0; a < 3; ++a) fine[a] = start[a] + span.anyBegin * s.step[a];
  for (std::int64_t k = span.anyBegin; k < span.anyEnd; ++k) {
    const Base base = BaseAt(fine);
    for (std::size_t a = 0; a < 3; ++a) fine[a] += s.step[a];
    NoData noData{hn::MaskFromVec(hn::Zero(d)), hn::Eq(hn::Zero(d), hn::Zero(d))};
    const bool inner = kInner || (k >= span.inBegin && k < span.inEnd);
    M valid = active;
    V w;
    if (inner) {
      w = Read<T, kI, kRange, false>(s, base, lanes, valid, noData);
      samples += hn::Lanes(d);
    } else {
      w = Read<T, kI, kRange, true>(s, base, lanes, valid, noData);
      samples += hn::CountTrue(d, valid);
    }
    if constexpr (kCareful) {
      M redo = hn::Not(hn::Eq(hn::Sub(w, w), hn::Zero(d)));
      if constexpr (kRange) {
        redo = hn::Or(redo, hn::AndNot(noData.all, noData.any));
        valid = hn::AndNot(noData.all, valid);
      }
      redo = hn::And(redo, valid);
      if (HWY_UNLIKELY(!hn::AllFalse(d, redo))) w = Redo<T, kI>(scene, x, y, k, w, redo, valid);
      Add(g, s.mode, w, valid);
    } else if (inner) {
      AddWhole(g, s.mode, w);
      g.count = hn::Add(g.count, hn::Set(d, 1.0f));
    } else {
      Add(g, s.mode, w, valid);
    }
  }
  return g;
}

// Display of one vector into RGBA, depth and values, which have room for a whole block.
template <class T>
HWY_INLINE void Show(const Scene<T>& scene, const Gathered& g, float* rgba, float* depth, float* values) {
  const D d;
  const FastSlice& s = scene.s;
  const M data = hn::Gt(g.count, hn::Zero(d));
  const V w = s.mode == SlabMode::Mean && s.samples > 1 ? hn::Div(g.value, g.count) : g.value;
  V grey = hn::Min(hn::Max(hn::MulAdd(w, hn::Set(d, s.scale), hn::Set(d, s.offset)), hn::Zero(d)),
                   hn::Set(d, 1.0f));
  if (HWY_UNLIKELY(!scene.display.ramp || values != nullptr)) {
    float lanes[kBlock_px], shown[kBlock_px];
    hn::StoreU(w, d, lanes);
    hn::StoreU(hn::IfThenElseZero(data, hn::Set(d, 1.0f)), d, shown);
    for (std::size_t n = 0; n < hn::Lanes(d); ++n) {
      const double m = s.slope * (static_cast<double>(lanes[n]) + s.bias) + s.intercept;
      if (values) values[n] = shown[n] > 0 ? static_cast<float>(m) : std::numeric_limits<float>::quiet_NaN();
      if (!scene.display.ramp) lanes[n] = shown[n] > 0 ? static_cast<float>(scene.display.grey(m)) : 0.0f;
    }
    if (!scene.display.ramp) grey = hn::LoadU(d, lanes);
  }
  const V one = hn::Set(d, 1.0f);
  const float* const b = scene.display.background;
  if (HWY_LIKELY(hn::AllTrue(d, data))) {
    hn::StoreInterleaved4(grey, grey, grey, one, d, rgba);
  } else {
    hn::StoreInterleaved4(hn::IfThenElse(data, grey, hn::Set(d, b[0])),
                          hn::IfThenElse(data, grey, hn::Set(d, b[1])),
                          hn::IfThenElse(data, grey, hn::Set(d, b[2])), one, d, rgba);
  }
  hn::StoreU(hn::IfThenElse(data, hn::Zero(d), hn::Set(d, kNothing_mm)), d, depth);
}

struct Out {
  float *rgba, *depth, *values;
};

template <class T>
HWY_INLINE Out OutAt(const Scene<T>& scene, int x, int y) {
  const Target& t = scene.target;
  const std::size_t at =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(t.width) + static_cast<std::size_t>(x);
  return {t.colour + 4 * at, t.depth + at, t.values ? t.values + at : nullptr};
}

template <class T, Interpolation kI, bool kRange, bool kInner>
HWY_INLINE void DrawLanes(const Scene<T>& scene, const std::int64_t (&fine)[3], const Span& span, int x,
                          int n, int y, const Out& out, std::uint64_t& samples) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kBlock_px; lane += lanes) {
    const M active = hn::FirstN(d, static_cast<std::size_t>(std::max(0, n - lane)));
    const Gathered g =
        GatherSamples<T, kI, kRange, kInner>(scene, fine, span, lane, x + lane, y, active, samples);
    Show(scene, g, out.rgba + 4 * lane, out.depth + lane, out.values ? out.values + lane : nullptr);
  }
}

// Pixels x .. x + n - 1 of row y, anywhere.
template <class T, Interpolation kI, bool kRange>
HWY_NOINLINE void DrawEdgeBlock(const Scene<T>& scene, const std::int64_t (&fine)[3], int x, int n, int y,
                                std::uint64_t& samples) {
  const Out out = OutAt(scene, x, y);
  Span span = SpanOf(scene.s, fine);
  if (n == kBlock_px) {
    DrawLanes<T, kI, kRange, false>(scene, fine, span, x, n, y, out, samples);
    return;
  }
  // A block that the picture's edge cuts goes through buffers of its own, and is masked all along.
  span.inBegin = span.inEnd = span.anyEnd;
  float rgba[4 * kBlock_px], depth[kBlock_px], values[kBlock_px];
  DrawLanes<T, kI, kRange, false>(scene, fine, span, x, n, y, {rgba, depth, out.values ? values : nullptr},
                                  samples);
  std::copy(rgba, rgba + 4 * n, out.rgba);
  std::copy(depth, depth + n, out.depth);
  if (out.values) std::copy(values, values + n, out.values);
}

// Every sample of every block of the tile lies that far inside: true for most tiles of most pictures.
inline bool InnerTile(const FastSlice& s, const Tile& tile) {
  if ((tile.x1 - tile.x0) % kBlock_px != 0) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t at = s.origin[a] + tile.x0 * s.right[a] + tile.y0 * s.down[a];
    const std::int64_t spans[3] = {(tile.x1 - tile.x0 - kBlock_px) * s.right[a],
                                   (tile.y1 - tile.y0 - 1) * s.down[a], (s.samples - 1) * s.step[a]};
    std::int64_t low = at + (static_cast<std::int64_t>(s.laneMin[a]) << kDrop);
    std::int64_t high = at + (static_cast<std::int64_t>(s.laneMax[a]) << kDrop);
    for (const std::int64_t span : spans) (span < 0 ? low : high) += span;
    const std::int64_t inset = s.inset + kMargin;
    if (low < inset || high > (s.last[a] << kFineBits) - inset) return false;
  }
  return true;
}

// Oblique planes through large volumes meet new cache lines that the processor cannot foresee: asks for those
// of the same pixels some rows further down.
HWY_INLINE void FetchAhead(const FastSlice& s, const std::int64_t (&fine)[3], int y) {
  const hn::CappedTag<std::int32_t, 4> d4;
  const Base base = BaseAt(fine);
  alignas(16) std::int32_t offset[kBlock_px / 4];
  auto at = hn::Zero(d4);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto lanes = hn::LoadU(d4, s.ahead[y & 1][a]);
    const auto index = hn::ShiftRight<kLaneBits>(hn::Add(lanes, hn::Set(d4, base.part[a])));
    at = hn::Add(at, hn::Mul(index, hn::Set(d4, static_cast<std::int32_t>(s.stride[a]))));
  }
  hn::Store(at, d4, offset);
  const std::uint8_t* const from = AddressOf(s, base);
  for (const std::int32_t o : offset) hwy::Prefetch(from + o);
}

template <class T, Interpolation kI, bool kRange>
std::uint64_t DrawRows(const Scene<T>& scene, const Tile& tile, const std::stop_token& stop) {
  const FastSlice& s = scene.s;
  std::uint64_t samples = 0;
  const bool inner = InnerTile(s, tile);
  const Span all{0, 0, s.samples, s.samples};
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (stop.stop_requested()) return samples;
    std::int64_t fine[3];
    for (std::size_t a = 0; a < 3; ++a) fine[a] = s.origin[a] + tile.x0 * s.right[a] + y * s.down[a];
    for (int x = tile.x0; x < tile.x1; x += kBlock_px) {
      if (inner && s.fetchAhead) FetchAhead(s, fine, y);
      if (inner)
        DrawLanes<T, kI, kRange, true>(scene, fine, all, x, kBlock_px, y, OutAt(scene, x, y), samples);
      else
        DrawEdgeBlock<T, kI, kRange>(scene, fine, x, std::min(kBlock_px, tile.x1 - x), y, samples);
      for (std::size_t a = 0; a < 3; ++a) fine[a] += kBlock_px * s.right[a];
    }
  }
  return samples;
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#endif
