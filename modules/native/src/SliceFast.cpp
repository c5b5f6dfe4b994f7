// SPDX-License-Identifier: GPL-3.0-or-later
// The SIMD kernel, compiled once per instruction set. A block is 16 pixels of a row; its samples along a
// slab's normal are split into those at which the whole block lies between voxel centres (no tests at all)
// and the others, which are clamped and masked lane by lane.
#include "SliceFast.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "GeneralSampler.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "SliceFast.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kBlock_px>;
using DI = hn::RebindToSigned<D>;
using V = hn::VFromD<D>;
using VI = hn::VFromD<DI>;
using M = hn::MFromD<D>;

constexpr std::int64_t kHalfVoxel = std::int64_t{1} << (kLaneBits - 1);
constexpr std::int64_t kOneVoxel = std::int64_t{1} << kLaneBits;
constexpr int kDrop = kFineBits - kLaneBits;
// A few units of 2^-24 for rounding: where it is that close to a face, each lane is tested.
constexpr std::int64_t kMargin = std::int64_t{4} << kDrop;

// Where a block stands at one sample: the voxel of its first pixel and the fractions there.
struct Base {
  std::int64_t whole[3];
  std::int32_t part[3];  // 2^-24
};

HWY_INLINE Base BaseAt(const std::int64_t (&fine)[3]) {
  Base b;
  for (int a = 0; a < 3; ++a) {
    const std::int64_t q = (fine[a] + (std::int64_t{1} << (kDrop - 1))) >> kDrop;
    b.whole[a] = q >> kLaneBits;
    b.part[a] = static_cast<std::int32_t>(q & (kOneVoxel - 1));
  }
  return b;
}

HWY_INLINE const std::uint8_t* AddressOf(const FastSlice& s, const Base& b) {
  const std::int64_t offset = b.whole[0] * s.stride[0] + b.whole[1] * s.stride[1] + b.whole[2] * s.stride[2];
  return reinterpret_cast<const std::uint8_t*>(reinterpret_cast<std::uintptr_t>(s.data) +
                                               static_cast<std::uintptr_t>(offset));
}

// Eight corners of each lane: is any, are all of them no-data?
struct NoData {
  M any, all;
};

// Two neighbours along x from one 32-bit read at the first of them.
template <class T>
HWY_INLINE void Unpack(VI pair, VI& first, VI& second) {
  const DI di;
  if constexpr (std::is_same_v<T, std::uint8_t>) {
    first = hn::And(pair, hn::Set(di, 0xff));
    second = hn::And(hn::ShiftRight<8>(pair), hn::Set(di, 0xff));
  } else if constexpr (std::is_same_v<T, std::uint16_t>) {
    const hn::RebindToUnsigned<DI> du;
    first = hn::And(pair, hn::Set(di, 0xffff));
    second = hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(du, pair)));
  } else {
    first = hn::ShiftRight<16>(hn::ShiftLeft<16>(pair));
    second = hn::ShiftRight<16>(pair);
  }
}

HWY_INLINE M InRange(const FastSlice& s, VI v) {
  const DI di;
  return hn::RebindMask(D(),
                        hn::Not(hn::Or(hn::Lt(v, hn::Set(di, s.noFirst)), hn::Gt(v, hn::Set(di, s.noLast)))));
}
HWY_INLINE M InRange(const FastSlice& s, V v) {
  const D d;
  return hn::And(hn::Ge(v, hn::Set(d, s.noFirstFloat)), hn::Le(v, hn::Set(d, s.noLastFloat)));
}

template <class X>
HWY_INLINE void Tally(const FastSlice& s, X first, X second, NoData& noData) {
  const M a = InRange(s, first), b = InRange(s, second);
  noData.any = hn::Or(noData.any, hn::Or(a, b));
  noData.all = hn::And(noData.all, hn::And(a, b));
}

template <bool kExactEnd>
HWY_INLINE V Lerp(V a, V b, V f) {
  const V v = hn::MulAdd(f, hn::Sub(b, a), a);
  if constexpr (!kExactEnd) return v;
  return hn::IfThenElse(hn::Eq(f, hn::Set(D(), 1.0f)), b, v);
}

// Interpolates along x at one of the four rows of cells. Integers: of w = stored - bias.
template <class T, bool kRange, bool kClamp>
HWY_INLINE V AlongX(const FastSlice& s, const std::uint8_t* row, VI offset, V f, NoData& noData) {
  const D d;
  const DI di;
  if constexpr (std::is_same_v<T, float>) {
    const V a = hn::GatherOffset(d, reinterpret_cast<const float*>(row), offset);
    const V b = hn::GatherOffset(d, reinterpret_cast<const float*>(row + s.neighbour[0]), offset);
    if constexpr (kRange) Tally(s, a, b, noData);
    return Lerp<kClamp>(a, b, f);
  } else {
    VI a, b;
    Unpack<T>(hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(row), offset), a, b);
    if constexpr (kRange) Tally(s, a, b, noData);
    // Differences of integers are exact, so nothing is lost before the product.
    return hn::MulAdd(f, hn::ConvertTo(d, hn::Sub(b, a)), hn::ConvertTo(d, hn::Sub(a, hn::Set(di, s.bias))));
  }
}

// One axis: cell index relative to the base's voxel, fraction in it, and, when clamped, which lanes are
// inside.
struct Cell {
  VI index;
  V fraction;
};

HWY_INLINE VI Saturated(std::int64_t v) {
  constexpr std::int64_t low = std::numeric_limits<std::int32_t>::min(),
                         high = std::numeric_limits<std::int32_t>::max();
  return hn::Set(DI(), static_cast<std::int32_t>(std::clamp(v, low, high)));
}

template <bool kLinear, bool kClamp>
HWY_INLINE Cell CellAlong(const FastSlice& s, const Base& b, int axis, VI lanes, M& inside) {
  const D d;
  const DI di;
  VI p = hn::Add(lanes, hn::Set(di, b.part[axis]));
  const std::int64_t whole = b.whole[axis], last = s.last[static_cast<std::size_t>(axis)];
  if constexpr (kClamp) {
    const VI low = Saturated(-kHalfVoxel - whole * kOneVoxel);
    const VI high = Saturated((last - whole) * kOneVoxel + kHalfVoxel);
    inside = hn::And(inside, hn::RebindMask(d, hn::Not(hn::Or(hn::Lt(p, low), hn::Gt(p, high)))));
    p = hn::Min(hn::Max(p, Saturated(-whole * kOneVoxel)), Saturated((last - whole) * kOneVoxel));
  }
  if constexpr (!kLinear)
    return {hn::ShiftRight<kLaneBits>(hn::Add(p, hn::Set(di, kHalfVoxel))), hn::Zero(d)};
  VI i = hn::ShiftRight<kLaneBits>(p);
  // The last cell also ends at its own upper end, so that no voxel beyond is read.
  if constexpr (kClamp)
    i = hn::Min(i, hn::Set(di, static_cast<std::int32_t>(std::clamp<std::int64_t>(
                                   std::max<std::int64_t>(last - 1, 0) - whole, -127, 127))));
  const VI part = kClamp ? hn::Sub(p, hn::ShiftLeft<kLaneBits>(i)) : hn::And(p, hn::Set(di, kOneVoxel - 1));
  return {i, hn::Mul(hn::ConvertTo(d, part), hn::Set(d, static_cast<float>(kPositionUnit)))};
}

// w of one vector of lanes. `inside` (clamped only) loses the lanes that lie outside the volume.
template <class T, bool kLinear, bool kRange, bool kClamp>
HWY_INLINE V Read(const FastSlice& s, const Base& b, const VI (&lanes)[3], M& inside, NoData& noData) {
  const D d;
  const DI di;
  const Cell x = CellAlong<kLinear, kClamp>(s, b, 0, lanes[0], inside);
  const Cell y = CellAlong<kLinear, kClamp>(s, b, 1, lanes[1], inside);
  const Cell z = CellAlong<kLinear, kClamp>(s, b, 2, lanes[2], inside);
  const VI offset = hn::Add(hn::ShiftLeft<hwy::CeilLog2(sizeof(T))>(x.index),
                            hn::Add(hn::Mul(y.index, hn::Set(di, static_cast<std::int32_t>(s.stride[1]))),
                                    hn::Mul(z.index, hn::Set(di, static_cast<std::int32_t>(s.stride[2])))));
  const std::uint8_t* const at = AddressOf(s, b);
  if constexpr (!kLinear) {
    if constexpr (std::is_same_v<T, float>) {
      const V v = hn::GatherOffset(d, reinterpret_cast<const float*>(at), offset);
      if constexpr (kRange) Tally(s, v, v, noData);
      return v;
    } else {
      VI v, unused;
      Unpack<T>(hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(at), offset), v, unused);
      if constexpr (kRange) Tally(s, v, v, noData);
      return hn::ConvertTo(d, hn::Sub(v, hn::Set(di, s.bias)));
    }
  } else {
    constexpr bool kEnd = kClamp && std::is_same_v<T, float>;
    const std::uint8_t* const up = at + s.neighbour[2];
    const V a = AlongX<T, kRange, kClamp>(s, at, offset, x.fraction, noData);
    const V c = AlongX<T, kRange, kClamp>(s, at + s.neighbour[1], offset, x.fraction, noData);
    const V e = AlongX<T, kRange, kClamp>(s, up, offset, x.fraction, noData);
    const V g = AlongX<T, kRange, kClamp>(s, up + s.neighbour[1], offset, x.fraction, noData);
    return Lerp<kEnd>(Lerp<kEnd>(a, c, y.fraction), Lerp<kEnd>(e, g, y.fraction), z.fraction);
  }
}

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
// at which all of them lie between voxel centres.
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
    KeepAtLeast(low, s.step[a], kMargin, r.inBegin, r.inEnd);
    KeepAtLeast(-high, -s.step[a], kMargin - last, r.inBegin, r.inEnd);
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
template <class T, bool kLinear>
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
    const double m = kLinear ? scene.sampler.linear(p, counted) : scene.sampler.nearest(p, counted);
    if (std::isnan(m))
      good[n] = 0;
    else
      values[n] = static_cast<float>((m - s.intercept) / s.slope - s.bias);
  }
  valid = hn::Gt(hn::LoadU(d, good), hn::Zero(d));
  return hn::LoadU(d, values);
}

// All samples of one vector of pixels at (x, y); lanes beyond `active` are not drawn. kInner: every sample of
// the block is known to lie between voxel centres.
template <class T, bool kLinear, bool kRange, bool kInner>
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
      w = Read<T, kLinear, kRange, false>(s, base, lanes, valid, noData);
      samples += hn::Lanes(d);
    } else {
      w = Read<T, kLinear, kRange, true>(s, base, lanes, valid, noData);
      samples += hn::CountTrue(d, valid);
    }
    if constexpr (kCareful) {
      M redo = hn::Not(hn::Eq(hn::Sub(w, w), hn::Zero(d)));
      if constexpr (kRange) {
        redo = hn::Or(redo, hn::AndNot(noData.all, noData.any));
        valid = hn::AndNot(noData.all, valid);
      }
      redo = hn::And(redo, valid);
      if (HWY_UNLIKELY(!hn::AllFalse(d, redo))) w = Redo<T, kLinear>(scene, x, y, k, w, redo, valid);
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

template <class T, bool kLinear, bool kRange, bool kInner>
HWY_INLINE void DrawLanes(const Scene<T>& scene, const std::int64_t (&fine)[3], const Span& span, int x,
                          int n, int y, const Out& out, std::uint64_t& samples) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kBlock_px; lane += lanes) {
    const M active = hn::FirstN(d, static_cast<std::size_t>(std::max(0, n - lane)));
    const Gathered g =
        GatherSamples<T, kLinear, kRange, kInner>(scene, fine, span, lane, x + lane, y, active, samples);
    Show(scene, g, out.rgba + 4 * lane, out.depth + lane, out.values ? out.values + lane : nullptr);
  }
}

// Pixels x .. x + n - 1 of row y, anywhere.
template <class T, bool kLinear, bool kRange>
HWY_NOINLINE void DrawEdgeBlock(const Scene<T>& scene, const std::int64_t (&fine)[3], int x, int n, int y,
                                std::uint64_t& samples) {
  const Out out = OutAt(scene, x, y);
  Span span = SpanOf(scene.s, fine);
  if (n == kBlock_px) {
    DrawLanes<T, kLinear, kRange, false>(scene, fine, span, x, n, y, out, samples);
    return;
  }
  // A block that the picture's edge cuts goes through buffers of its own, and is masked all along.
  span.inBegin = span.inEnd = span.anyEnd;
  float rgba[4 * kBlock_px], depth[kBlock_px], values[kBlock_px];
  DrawLanes<T, kLinear, kRange, false>(scene, fine, span, x, n, y,
                                       {rgba, depth, out.values ? values : nullptr}, samples);
  std::copy(rgba, rgba + 4 * n, out.rgba);
  std::copy(depth, depth + n, out.depth);
  if (out.values) std::copy(values, values + n, out.values);
}

// Every sample of every block of the tile lies between voxel centres: true for most tiles of most pictures.
inline bool InnerTile(const FastSlice& s, const Tile& tile) {
  if ((tile.x1 - tile.x0) % kBlock_px != 0) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t at = s.origin[a] + tile.x0 * s.right[a] + tile.y0 * s.down[a];
    const std::int64_t spans[3] = {(tile.x1 - tile.x0 - kBlock_px) * s.right[a],
                                   (tile.y1 - tile.y0 - 1) * s.down[a], (s.samples - 1) * s.step[a]};
    std::int64_t low = at + (static_cast<std::int64_t>(s.laneMin[a]) << kDrop);
    std::int64_t high = at + (static_cast<std::int64_t>(s.laneMax[a]) << kDrop);
    for (const std::int64_t span : spans) (span < 0 ? low : high) += span;
    if (low < kMargin || high > (s.last[a] << kFineBits) - kMargin) return false;
  }
  return true;
}

// Oblique planes meet new cache lines that the processor cannot foresee: asks for those of the same pixels
// some rows further down, every fourth pixel, shifted by two on odd rows, on the side to which the rows move.
HWY_INLINE void FetchAhead(const FastSlice& s, const std::int64_t (&fine)[3], int y) {
  constexpr int kRowsAhead = 6;
  const std::int64_t side = (s.down[1] > 0 ? s.stride[1] : 0) + (s.down[2] > 0 ? s.stride[2] : 0);
  std::int64_t at[3];
  for (std::size_t a = 0; a < 3; ++a) at[a] = fine[a] + kRowsAhead * s.down[a] + 2 * (y & 1) * s.right[a];
  for (int n = 0; n < kBlock_px; n += 4) {
    std::int64_t offset = side;
    for (std::size_t a = 0; a < 3; ++a) offset += (at[a] >> kFineBits) * s.stride[a], at[a] += 4 * s.right[a];
    hwy::Prefetch(reinterpret_cast<const std::uint8_t*>(reinterpret_cast<std::uintptr_t>(s.data) +
                                                        static_cast<std::uintptr_t>(offset)));
  }
}

template <class T, bool kLinear, bool kRange>
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
      if (inner && s.samples == 1) FetchAhead(s, fine, y);
      if (inner)
        DrawLanes<T, kLinear, kRange, true>(scene, fine, all, x, kBlock_px, y, OutAt(scene, x, y), samples);
      else
        DrawEdgeBlock<T, kLinear, kRange>(scene, fine, x, std::min(kBlock_px, tile.x1 - x), y, samples);
      for (std::size_t a = 0; a < 3; ++a) fine[a] += kBlock_px * s.right[a];
    }
  }
  return samples;
}

template <class T>
std::uint64_t DrawType(const FastSlice& s, const SliceJob& job, const VoxelLattice& lattice,
                       const Display& display, const Target& target, const Tile& tile,
                       const std::stop_token& stop) {
  const Scene<T> scene{s, job, lattice, display, target, GeneralSampler<T>(*job.volume)};
  // Nearest reads are few and cheap: one kernel serves with and without a no-data range (which is then
  // empty).
  if (job.interpolation == Interpolation::Nearest) return DrawRows<T, false, true>(scene, tile, stop);
  return s.hasRange ? DrawRows<T, true, true>(scene, tile, stop)
                    : DrawRows<T, true, false>(scene, tile, stop);
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
  return HWY_DYNAMIC_DISPATCH(DrawTile)(s, job, lattice, display, target, tile, stop);
}

}  // namespace vernier::native
#endif
