// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the trilinear field, its gradient and the tables for a vector of rays, compiled once per instruction
// set.
#if defined(VERNIER_VOLUME_FAST_READ_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VERNIER_VOLUME_FAST_READ_INL_H
#undef VERNIER_VOLUME_FAST_READ_INL_H
#else
#define VERNIER_VOLUME_FAST_READ_INL_H
#endif
#include <hwy/highway.h>

#include "SliceFastRead-inl.h"
#include "VolumeFast.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

// A place in the field: cells from the block's whole voxels, and the fractions in them.
struct FieldPlace {
  VI cell[3];
  V fraction[3];
  const std::uint8_t* data;  // of the block's whole voxels
  VI offset;                 // bytes from there to the cell's first voxel
};

struct FieldSample {
  V value;
  V row[4];  // interpolated along x: y, z; y + 1, z; y, z + 1; y + 1, z + 1
};

// Positions are moved to the box of voxel centres, axis by axis; `inside`: none needs to be.
HWY_INLINE FieldPlace PlaceOf(const FastSlice& s, const std::int64_t (&whole)[3], const V (&x)[3],
                              bool inside) {
  const D d;
  const DI di;
  FieldPlace at;
  std::int64_t base = 0;
  for (int a = 0; a < 3; ++a) {
    const std::size_t n = static_cast<std::size_t>(a);
    VI c = hn::ConvertTo(di, hn::Floor(x[a]));
    if (!inside) c = hn::Min(hn::Max(c, Saturated(-whole[a])), Saturated(s.last[n] - 1 - whole[a]));
    V f = hn::Sub(x[a], hn::ConvertTo(d, c));
    if (!inside) f = hn::Min(hn::Max(f, hn::Zero(d)), hn::Set(d, 1.0f));
    at.cell[a] = c, at.fraction[a] = f;
    base += whole[a] * s.stride[n];
  }
  at.data = reinterpret_cast<const std::uint8_t*>(reinterpret_cast<std::uintptr_t>(s.data) +
                                                  static_cast<std::uintptr_t>(base));
  return at;
}

template <class T>
HWY_INLINE FieldSample FieldAt(const FastSlice& s, FieldPlace at) {
  at.offset = OffsetOf<T>(s, at.cell[0], at.cell[1], at.cell[2]);
  NoData unused;
  const auto row = [&](const std::uint8_t* from) {
    return AlongX<T, false, false>(s, from, at.offset, at.fraction[0], unused);
  };
  FieldSample out;
  const std::uint8_t* const up = at.data + s.stride[2];
  out.row[0] = row(at.data), out.row[1] = row(at.data + s.stride[1]);
  out.row[2] = row(up), out.row[3] = row(up + s.stride[1]);
  const V low = Lerp<false>(out.row[0], out.row[1], at.fraction[1]);
  const V high = Lerp<false>(out.row[2], out.row[3], at.fraction[1]);
  out.value = Lerp<false>(low, high, at.fraction[2]);
  return out;
}

struct Gradient {
  V x, y, z;  // of w, per voxel, doubled
};

// The difference of the values half a step to both sides along x, at one row.
template <class T>
HWY_INLINE V AcrossX(const std::uint8_t* row, VI before, VI after, V f) {
  const D d;
  const DI di;
  if constexpr (std::is_same_v<T, float>) {
    const auto* const p = reinterpret_cast<const float*>(row);
    const V a = hn::GatherOffset(d, p, before), b = hn::GatherOffset(d, p + 1, before);
    const V c = hn::GatherOffset(d, p, after), e = hn::GatherOffset(d, p + 1, after);
    return hn::MulAdd(f, hn::Sub(hn::Sub(e, b), hn::Sub(c, a)), hn::Sub(c, a));
  } else {
    VI a, b, c, e;
    const auto* const p = reinterpret_cast<const std::int32_t*>(row);
    const VI four = hn::GatherOffset(di, p, before);
    Unpack<T>(four, a, b);
    if constexpr (sizeof(T) == 1)  // all of them
      Unpack<T>(hn::ShiftRight<16>(four), c, e);
    else
      Unpack<T>(hn::GatherOffset(di, p, after), c, e);
    const VI low = hn::Sub(c, a), high = hn::Sub(e, b);
    return hn::MulAdd(f, hn::ConvertTo(d, hn::Sub(high, low)), hn::ConvertTo(d, low));
  }
}

// The same where some lanes are in the outermost cells: there the outer voxel stands for the one beyond.
template <class T>
HWY_INLINE V AcrossXAtFace(const std::uint8_t* row, VI offset, VI before, VI ahead, V f) {
  const DI di;
  // The voxel behind the second is the second of the pair that begins one voxel before it.
  const VI size = hn::Set(di, static_cast<std::int32_t>(sizeof(T)));
  const VI after = hn::Add(offset, hn::Sub(ahead, size));
  if constexpr (std::is_same_v<T, float>) {
    const D d;
    const auto* const p = reinterpret_cast<const float*>(row);
    const V a = hn::GatherOffset(d, p, before), b = hn::GatherOffset(d, p, offset);
    const V c = hn::GatherOffset(d, p + 1, offset), e = hn::GatherOffset(d, p + 1, after);
    return hn::MulAdd(f, hn::Sub(hn::Sub(e, b), hn::Sub(c, a)), hn::Sub(c, a));
  } else {
    const D d;
    VI a, b, c, e, unused;
    const auto* const p = reinterpret_cast<const std::int32_t*>(row);
    Unpack<T>(hn::GatherOffset(di, p, before), a, unused);
    Unpack<T>(hn::GatherOffset(di, p, offset), b, c);
    Unpack<T>(hn::GatherOffset(di, p, after), unused, e);
    const VI low = hn::Sub(c, a), high = hn::Sub(e, b);
    return hn::MulAdd(f, hn::ConvertTo(d, hn::Sub(high, low)), hn::ConvertTo(d, low));
  }
}

// Central differences of the field: voxels one further and one back; at the box's faces the positions are
// moved there, which the outer voxels repeated are the same as.
template <class T>
HWY_INLINE Gradient GradientAt(const FastSlice& s, const std::int64_t (&whole)[3], FieldPlace at,
                               const FieldSample& here, bool inner) {
  [[maybe_unused]] const D d;  // not used by the least instruction set
  const DI di;
  // Bytes to the voxel before the cell's first and behind its second.
  VI back[3], ahead[3];
  at.offset = OffsetOf<T>(s, at.cell[0], at.cell[1], at.cell[2]);
  for (int a = 0; a < 3; ++a) {
    const auto stride = static_cast<std::int32_t>(s.stride[static_cast<std::size_t>(a)]);
    back[a] = hn::Set(di, -stride), ahead[a] = hn::Set(di, 2 * stride);
    if (inner) continue;
    const VI first = Saturated(-whole[a]);
    const VI last = Saturated(s.last[static_cast<std::size_t>(a)] - 1 - whole[a]);
    back[a] = hn::IfThenElseZero(hn::Gt(at.cell[a], first), back[a]);
    ahead[a] = hn::IfThenElse(hn::Lt(at.cell[a], last), ahead[a], hn::Set(di, stride));
  }
  const std::uint8_t* const up = at.data + s.stride[2];
  const std::uint8_t* const rows[4] = {at.data, at.data + s.stride[1], up, up + s.stride[1]};
  Gradient g;
  {
    // Pairs: the one before with the cell's first, the cell's second with the one behind.
    const VI before = hn::Add(at.offset, back[0]);
    V across[4];
    if (inner) {
      const VI after = hn::Add(at.offset, hn::Set(di, static_cast<std::int32_t>(s.stride[0])));
      for (int n = 0; n < 4; ++n) across[n] = AcrossX<T>(rows[n], before, after, at.fraction[0]);
    } else {
      for (int n = 0; n < 4; ++n)
        across[n] = AcrossXAtFace<T>(rows[n], at.offset, before, ahead[0], at.fraction[0]);
    }
    g.x = Lerp<false>(Lerp<false>(across[0], across[1], at.fraction[1]),
                      Lerp<false>(across[2], across[3], at.fraction[1]), at.fraction[2]);
  }
  NoData unused;
  const auto row = [&](const std::uint8_t* from, VI more) {
    return AlongX<T, false, false>(s, from, hn::Add(at.offset, more), at.fraction[0], unused);
  };
  const auto acrossY = [&](const std::uint8_t* slice, V first, V second) {
    const V low = hn::Sub(second, row(slice, back[1])), high = hn::Sub(row(slice, ahead[1]), first);
    return Lerp<false>(low, high, at.fraction[1]);
  };
  g.y = Lerp<false>(acrossY(at.data, here.row[0], here.row[1]), acrossY(up, here.row[2], here.row[3]),
                    at.fraction[2]);
  const auto acrossZ = [&](const std::uint8_t* from, V first, V second) {
    const V low = hn::Sub(second, row(from, back[2])), high = hn::Sub(row(from, ahead[2]), first);
    return Lerp<false>(low, high, at.fraction[2]);
  };
  g.z = Lerp<false>(acrossZ(at.data, here.row[0], here.row[2]),
                    acrossZ(at.data + s.stride[1], here.row[1], here.row[3]), at.fraction[1]);
  return g;
}

HWY_INLINE V ColourOf(const std::uint32_t* table, VI entry, V rest) {
  const D d;
  const DI di;
  const VI word = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(table), entry);
  const V value =
      hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(hn::BitCast(hn::RebindToUnsigned<DI>(), word))));
  const V way = hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(word)));
  return hn::Mul(hn::MulAdd(hn::Add(rest, rest), way, value), hn::Set(d, 1 / 65535.0f));
}

// Where front and back stand in the pre-integrated table.
struct TablePair {
  VI index;
  V x, y;
};
HWY_INLINE TablePair PairOf(const FastVolume& v, V front, V back) {
  const D d;
  const DI di;
  const VI most = hn::Set(di, v.entries - 2);
  const VI i = hn::Min(hn::ConvertTo(di, front), most), j = hn::Min(hn::ConvertTo(di, back), most);
  return {hn::Add(i, hn::Mul(j, hn::Set(di, v.entries))), hn::Sub(front, hn::ConvertTo(d, i)),
          hn::Sub(back, hn::ConvertTo(d, j))};
}
HWY_INLINE V Bilinear(const float* table, const FastVolume& v, const TablePair& at) {
  const D d;
  const float* const next = table + v.entries;
  const V low =
      Lerp<false>(hn::GatherIndex(d, table, at.index), hn::GatherIndex(d, table + 1, at.index), at.x);
  const V high =
      Lerp<false>(hn::GatherIndex(d, next, at.index), hn::GatherIndex(d, next + 1, at.index), at.x);
  return Lerp<false>(low, high, at.y);
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#endif
