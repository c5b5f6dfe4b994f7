// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a vector of samples, compiled once per instruction set: nearest, linear (8 voxels), cubic (64).
// Included after highway.h; the guard lets each instruction set in once.
#if defined(VERNIER_SLICE_FAST_READ_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VERNIER_SLICE_FAST_READ_INL_H
#undef VERNIER_SLICE_FAST_READ_INL_H
#else
#define VERNIER_SLICE_FAST_READ_INL_H
#endif
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "GeneralSampler.h"
#include "SliceFast.h"

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

// The voxels that a lane reads: is any, are all of them no-data?
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

template <bool kNearest, bool kClamp>
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
  if constexpr (kNearest)
    return {hn::ShiftRight<kLaneBits>(hn::Add(p, hn::Set(di, kHalfVoxel))), hn::Zero(d)};
  VI i = hn::ShiftRight<kLaneBits>(p);
  // The last cell also ends at its own upper end, so that no voxel beyond is read.
  if constexpr (kClamp)
    i = hn::Min(i, hn::Set(di, static_cast<std::int32_t>(std::clamp<std::int64_t>(
                                   std::max<std::int64_t>(last - 1, 0) - whole, -127, 127))));
  const VI part = kClamp ? hn::Sub(p, hn::ShiftLeft<kLaneBits>(i)) : hn::And(p, hn::Set(di, kOneVoxel - 1));
  return {i, hn::Mul(hn::ConvertTo(d, part), hn::Set(d, static_cast<float>(kPositionUnit)))};
}

// Bases of the rows and slices of voxels that a read begins at.
template <class T>
HWY_INLINE VI OffsetOf(const FastSlice& s, VI x, VI y, VI z) {
  const DI di;
  return hn::Add(hn::ShiftLeft<hwy::CeilLog2(sizeof(T))>(x),
                 hn::Add(hn::Mul(y, hn::Set(di, static_cast<std::int32_t>(s.stride[1]))),
                         hn::Mul(z, hn::Set(di, static_cast<std::int32_t>(s.stride[2])))));
}

template <class T, bool kRange, bool kClamp>
HWY_INLINE V ReadNearest(const FastSlice& s, const Base& b, const VI (&lanes)[3], M& inside, NoData& noData) {
  const D d;
  const DI di;
  const Cell x = CellAlong<true, kClamp>(s, b, 0, lanes[0], inside);
  const Cell y = CellAlong<true, kClamp>(s, b, 1, lanes[1], inside);
  const Cell z = CellAlong<true, kClamp>(s, b, 2, lanes[2], inside);
  const VI offset = OffsetOf<T>(s, x.index, y.index, z.index);
  const std::uint8_t* const at = AddressOf(s, b);
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
}

template <class T, bool kRange, bool kClamp>
HWY_INLINE V ReadLinear(const FastSlice& s, const Base& b, const VI (&lanes)[3], M& inside, NoData& noData) {
  const Cell x = CellAlong<false, kClamp>(s, b, 0, lanes[0], inside);
  const Cell y = CellAlong<false, kClamp>(s, b, 1, lanes[1], inside);
  const Cell z = CellAlong<false, kClamp>(s, b, 2, lanes[2], inside);
  const VI offset = OffsetOf<T>(s, x.index, y.index, z.index);
  const std::uint8_t* const at = AddressOf(s, b);
  constexpr bool kEnd = kClamp && std::is_same_v<T, float>;
  const std::uint8_t* const up = at + s.neighbour[2];
  const V a = AlongX<T, kRange, kClamp>(s, at, offset, x.fraction, noData);
  const V c = AlongX<T, kRange, kClamp>(s, at + s.neighbour[1], offset, x.fraction, noData);
  const V e = AlongX<T, kRange, kClamp>(s, up, offset, x.fraction, noData);
  const V g = AlongX<T, kRange, kClamp>(s, up + s.neighbour[1], offset, x.fraction, noData);
  return Lerp<kEnd>(Lerp<kEnd>(a, c, y.fraction), Lerp<kEnd>(e, g, y.fraction), z.fraction);
}

// One axis of a cubic read: the first of its four voxels, and the weights of the first, third and fourth (the
// second has the rest of 1). Cubic.h says what they are.
struct CubicCell {
  VI first;
  V w0, w2, w3;
};

template <bool kClamp>
HWY_INLINE CubicCell CubicAlong(const FastSlice& s, const Base& b, int axis, VI lanes, M& inside) {
  const D d;
  const DI di;
  const Cell cell = CellAlong<false, kClamp>(s, b, axis, lanes, inside);
  const V t = cell.fraction, one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const V u = hn::Sub(one, t);
  const V side = hn::Mul(hn::Mul(half, t), hn::Neg(u));  // -t u / 2
  CubicCell c{
      hn::Sub(cell.index, hn::Set(di, 1)), hn::Mul(side, u),
      hn::Mul(hn::Mul(half, t), hn::MulAdd(t, hn::NegMulAdd(hn::Set(d, 3.0f), t, hn::Set(d, 4.0f)), one)),
      hn::Mul(side, t)};
  if constexpr (kClamp) {
    // In the first and the last cell of an axis: the parabola through the three voxels that there are.
    constexpr std::int64_t far = 1 << 20;
    const std::int64_t whole = b.whole[axis], last = s.last[static_cast<std::size_t>(axis)];
    const VI beginIndex = hn::Set(di, static_cast<std::int32_t>(std::clamp(-whole, -far, far)));
    const VI endIndex = hn::Set(di, static_cast<std::int32_t>(std::clamp(last - 1 - whole, -far, far)));
    const M begin = hn::RebindMask(d, hn::Eq(cell.index, beginIndex));
    const M end = hn::RebindMask(d, hn::Eq(cell.index, endIndex));
    c.first = hn::Min(hn::Max(c.first, beginIndex), hn::Sub(endIndex, hn::Set(di, 2)));
    c.w0 = hn::IfThenElse(begin, hn::Mul(hn::Mul(half, u), hn::Add(one, u)), hn::IfThenZeroElse(end, c.w0));
    c.w2 = hn::IfThenElse(begin, side, hn::IfThenElse(end, hn::Mul(u, hn::Add(one, t)), c.w2));
    c.w3 = hn::IfThenZeroElse(begin, hn::IfThenElse(end, hn::Mul(hn::Mul(half, t), hn::Add(one, t)), c.w3));
  }
  return c;
}

// Differences from the second value, so that rounding counts against the local range only.
template <bool kExactEnd>
HWY_INLINE V Blend(V a, V b, V c, V e, const CubicCell& w) {
  const V v = hn::Add(
      b, hn::MulAdd(w.w3, hn::Sub(e, b), hn::MulAdd(w.w2, hn::Sub(c, b), hn::Mul(w.w0, hn::Sub(a, b)))));
  if constexpr (!kExactEnd) return v;
  const V one = hn::Set(D(), 1.0f);
  return hn::IfThenElse(hn::Eq(w.w0, one), a,
                        hn::IfThenElse(hn::Eq(w.w2, one), c, hn::IfThenElse(hn::Eq(w.w3, one), e, v)));
}

// Four neighbours along x from one read of bytes, two of 16 bits, four of floats.
template <class T, bool kRange, bool kClamp>
HWY_INLINE V CubicAlongX(const FastSlice& s, const std::uint8_t* row, VI offset, const CubicCell& w,
                         NoData& noData) {
  const D d;
  const DI di;
  if constexpr (std::is_same_v<T, float>) {
    const float* const p = reinterpret_cast<const float*>(row);
    const V a = hn::GatherOffset(d, p, offset), b = hn::GatherOffset(d, p + 1, offset);
    const V c = hn::GatherOffset(d, p + 2, offset), e = hn::GatherOffset(d, p + 3, offset);
    if constexpr (kRange) Tally(s, a, b, noData), Tally(s, c, e, noData);
    return Blend<kClamp>(a, b, c, e, w);
  } else {
    VI a, b, c, e;
    const VI low = hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(row), offset);
    Unpack<T>(low, a, b);
    if constexpr (sizeof(T) == 1)
      Unpack<T>(hn::ShiftRight<16>(low), c, e);
    else
      Unpack<T>(hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(row + 4), offset), c, e);
    if constexpr (kRange) Tally(s, a, b, noData), Tally(s, c, e, noData);
    const V sum = hn::MulAdd(
        w.w3, hn::ConvertTo(d, hn::Sub(e, b)),
        hn::MulAdd(w.w2, hn::ConvertTo(d, hn::Sub(c, b)), hn::Mul(w.w0, hn::ConvertTo(d, hn::Sub(a, b)))));
    return hn::Add(hn::ConvertTo(d, hn::Sub(b, hn::Set(di, s.bias))), sum);
  }
}

// Needs four voxels along each axis.
template <class T, bool kRange, bool kClamp>
HWY_INLINE V ReadCubic(const FastSlice& s, const Base& b, const VI (&lanes)[3], M& inside, NoData& noData) {
  const D d;
  const CubicCell x = CubicAlong<kClamp>(s, b, 0, lanes[0], inside);
  const CubicCell y = CubicAlong<kClamp>(s, b, 1, lanes[1], inside);
  const CubicCell z = CubicAlong<kClamp>(s, b, 2, lanes[2], inside);
  const VI offset = OffsetOf<T>(s, x.first, y.first, z.first);
  const std::uint8_t* const at = AddressOf(s, b);
  constexpr bool kEnd = kClamp && std::is_same_v<T, float>;
  const auto plane = [&](const std::uint8_t* slice) {
    V rows[4];
    for (int n = 0; n < 4; ++n)
      rows[n] = CubicAlongX<T, kRange, kClamp>(s, slice + n * s.stride[1], offset, x, noData);
    return Blend<kEnd>(rows[0], rows[1], rows[2], rows[3], y);
  };
  // A picture along the slices, through their centres, needs one slice of the four.
  const V weight = hn::Add(hn::Abs(z.w0), hn::Add(hn::Abs(z.w2), hn::Abs(z.w3)));
  if (hn::AllTrue(d, hn::Eq(weight, hn::Zero(d)))) return plane(at + s.stride[2]);
  V slices[4];
  for (int n = 0; n < 4; ++n) slices[n] = plane(at + n * s.stride[2]);
  return Blend<kEnd>(slices[0], slices[1], slices[2], slices[3], z);
}

// w of one vector of lanes. `inside` (clamped only) loses the lanes that lie outside the volume.
template <class T, Interpolation kI, bool kRange, bool kClamp>
HWY_INLINE V Read(const FastSlice& s, const Base& b, const VI (&lanes)[3], M& inside, NoData& noData) {
  if constexpr (kI == Interpolation::Nearest)
    return ReadNearest<T, kRange, kClamp>(s, b, lanes, inside, noData);
  if constexpr (kI == Interpolation::Linear)
    return ReadLinear<T, kRange, kClamp>(s, b, lanes, inside, noData);
  return ReadCubic<T, kRange, kClamp>(s, b, lanes, inside, noData);
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#endif
