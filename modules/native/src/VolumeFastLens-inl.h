// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses on the rays of a packet: which appearance each lane has, and where in a step it changes. Compiled
// once per instruction set.
#if defined(VERNIER_VOLUME_FAST_LENS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VERNIER_VOLUME_FAST_LENS_INL_H
#undef VERNIER_VOLUME_FAST_LENS_INL_H
#else
#define VERNIER_VOLUME_FAST_LENS_INL_H
#endif
#include <hwy/highway.h>

#include "VolumeFastSteps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

// The tables of each lane's appearance.
struct Look {
  V scale, offset, last, seenFrom, seenTo;
  VI first, entries;  // in FastVolume's tables
  HWY_INLINE V place(V w) const {
    return hn::Min(hn::Max(hn::MulAdd(w, scale, offset), hn::Zero(D())), last);
  }
};

HWY_INLINE Look LookOf(const FastVolume& v, VI appearance) {
  const D d;
  const DI di;
  const FastLooks& t = v.looks;
  return {hn::GatherIndex(d, t.placeScale.data(), appearance),
          hn::GatherIndex(d, t.placeOffset.data(), appearance),
          hn::GatherIndex(d, t.lastPlace.data(), appearance),
          hn::GatherIndex(d, t.seenFrom.data(), appearance),
          hn::GatherIndex(d, t.seenTo.data(), appearance),
          hn::GatherIndex(di, t.first.data(), appearance),
          hn::GatherIndex(di, t.entries.data(), appearance)};
}

// Post: opacity and colour of a value; `active`: of what may be seen at all.
HWY_INLINE void ClassifyPost(const FastVolume& v, const Look& look, V value, M& active, V& opacity,
                             V (&colour)[3]) {
  const D d;
  const DI di;
  const V at = look.place(value);
  active = hn::And(active, hn::And(hn::Gt(at, look.seenFrom), hn::Lt(at, look.seenTo)));
  opacity = hn::Zero(d);
  if (hn::AllFalse(d, active)) return;
  const VI whole = hn::ConvertTo(di, at), entry = hn::Add(whole, look.first);
  const V rest = hn::Sub(at, hn::ConvertTo(d, whole));
  const V low = hn::GatherIndex(d, v.opacity.data(), entry),
          high = hn::GatherIndex(d, v.opacity.data() + 1, entry);
  opacity = hn::IfThenElseZero(active, hn::MulAdd(rest, hn::Sub(high, low), low));
  for (std::size_t c = 0; c < 3; ++c) colour[c] = ColourOf(v.colour[c].data(), entry, rest);
}

// PreIntegrated: the same of the values at the step's ends.
HWY_INLINE void ClassifyPair(const FastVolume& v, const Look& look, V front, V back, M& active, V& opacity,
                             V (&colour)[3]) {
  const D d;
  const DI di;
  const V x = look.place(front), y = look.place(back);
  const VI most = hn::Sub(look.entries, hn::Set(di, 2));
  const VI i = hn::Min(hn::ConvertTo(di, x), most), j = hn::Min(hn::ConvertTo(di, y), most);
  const VI low = hn::Add(look.first, hn::Add(i, hn::Mul(j, look.entries))), high = hn::Add(low, look.entries);
  const V u = hn::Sub(x, hn::ConvertTo(d, i)), w = hn::Sub(y, hn::ConvertTo(d, j));
  const auto read = [&](const float* table) {
    const V a = Lerp<false>(hn::GatherIndex(d, table, low), hn::GatherIndex(d, table + 1, low), u);
    const V b = Lerp<false>(hn::GatherIndex(d, table, high), hn::GatherIndex(d, table + 1, high), u);
    return Lerp<false>(a, b, w);
  };
  opacity = hn::IfThenElseZero(active, read(v.opacity.data()));
  active = hn::Gt(opacity, hn::Zero(d));
  if (hn::AllFalse(d, active)) return;
  const V inverse = hn::Div(hn::Set(d, 1.0f), hn::IfThenElse(active, opacity, hn::Set(d, 1.0f)));
  for (std::size_t c = 0; c < 3; ++c) colour[c] = hn::Mul(read(v.lit[c].data()), inverse);
}

// Where the lanes enter and leave each lens: steps from LaneSteps::base and the way into the step, 0..1. A
// face that is met exactly between two steps belongs to the later.
class LensLanes {
 public:
  HWY_INLINE void set(const RayPacket& p, double step, int lane0, const LaneSteps& s) {
    const PacketLenses& l = *p.lenses;
    count_ = l.count, steps_ = s.last - s.base + 1, shift_ = 0;
    while (((steps_ - 1) >> shift_) >= kMarks) ++shift_;
    for (std::int64_t w = 0; w <= ((steps_ - 1) >> shift_) / 64; ++w) cuts_[w] = 0;
    const int lanes = static_cast<int>(hn::Lanes(D()));
    for (int n = 0; n < lanes; ++n) {
      const double from = p.from_mm[lane0 + n], to = p.to_mm[lane0 + n];
      if (!(to > from)) {
        for (int k = 0; k < count_; ++k) step_[k][0][n] = kNever, step_[k][1][n] = -1;
        continue;
      }
      mark(static_cast<std::int64_t>(std::floor(from / step)) - s.base);
      mark(static_cast<std::int64_t>(std::ceil(to / step)) - 1 - s.base);
      for (int k = 0; k < count_; ++k) {
        const double in = l.entry_mm[k][lane0 + n], out = l.exit_mm[k][lane0 + n];
        if (in < out) {
          put(k, 0, n, in / step, s.base), put(k, 1, n, out / step, s.base);
        } else {
          step_[k][0][n] = kNever, step_[k][1][n] = -1;
          at_[k][0][n] = at_[k][1][n] = 0;
        }
      }
    }
  }
  // May a lane's appearance change within the step, or its part begin or end?
  HWY_INLINE bool cutAt(std::int64_t k) const {
    return cuts_[(k >> shift_) / 64] >> ((k >> shift_) % 64) & 1;
  }

  // Of a step without a cut.
  HWY_INLINE VI appearance(std::int64_t k) const {
    const DI di;
    const VI now = hn::Set(di, static_cast<std::int32_t>(k));
    VI out = hn::Zero(di);
    for (int n = 0; n < count_; ++n) {
      const auto inside =
          hn::And(hn::Lt(hn::Load(di, step_[n][0]), now), hn::Gt(hn::Load(di, step_[n][1]), now));
      out = hn::IfThenElse(inside, hn::Set(di, n + 1), out);
    }
    return out;
  }
  // Of step k behind `u`, as far as `next`.
  HWY_INLINE VI appearanceFrom(std::int64_t k, V u) const {
    const D d;
    const DI di;
    const VI now = hn::Set(di, static_cast<std::int32_t>(k));
    VI out = hn::Zero(di);
    for (int n = 0; n < count_; ++n) {
      const VI in = hn::Load(di, step_[n][0]), leave = hn::Load(di, step_[n][1]);
      const M entered =
          hn::Or(hn::RebindMask(d, hn::Lt(in, now)),
                 hn::And(hn::RebindMask(d, hn::Eq(in, now)), hn::Le(hn::Load(d, at_[n][0]), u)));
      const M stays =
          hn::Or(hn::RebindMask(d, hn::Gt(leave, now)),
                 hn::And(hn::RebindMask(d, hn::Eq(leave, now)), hn::Gt(hn::Load(d, at_[n][1]), u)));
      out = hn::IfThenElse(hn::RebindMask(di, hn::And(entered, stays)), hn::Set(di, n + 1), out);
    }
    return out;
  }
  // The next cut in step k behind `u`, `stop` at most.
  HWY_INLINE V next(std::int64_t k, V u, V stop) const {
    const D d;
    const DI di;
    const VI now = hn::Set(di, static_cast<std::int32_t>(k));
    V out = stop;
    for (int n = 0; n < count_; ++n)
      for (int side = 0; side < 2; ++side) {
        const V at = hn::Load(d, at_[n][side]);
        const M here = hn::And(hn::RebindMask(d, hn::Eq(hn::Load(di, step_[n][side]), now)), hn::Gt(at, u));
        out = hn::IfThenElse(here, hn::Min(out, at), out);
      }
    return out;
  }

 private:
  static constexpr std::int64_t kMarks = 2048;
  static constexpr std::int32_t kNever = 1 << 30;

  HWY_INLINE void mark(std::int64_t k) {
    if (k >= 0 && k < steps_) cuts_[(k >> shift_) / 64] |= std::uint64_t{1} << ((k >> shift_) % 64);
  }
  HWY_INLINE void put(int lens, int side, int lane, double place, std::int64_t base) {
    const double whole = std::floor(place);
    const double k = std::clamp(whole - static_cast<double>(base), -1.0, static_cast<double>(steps_));
    step_[lens][side][lane] = static_cast<std::int32_t>(k);
    at_[lens][side][lane] = static_cast<float>(place - whole);
    mark(static_cast<std::int64_t>(k));
  }

  int count_ = 0, shift_ = 0;
  std::int64_t steps_ = 0;
  std::uint64_t cuts_[kMarks / 64];
  alignas(64) std::int32_t step_[kMostInsides][2][kPacketRays];
  alignas(64) float at_[kMostInsides][2][kPacketRays];
};

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#endif
