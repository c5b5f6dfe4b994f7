// SPDX-License-Identifier: GPL-3.0-or-later
// The steps that the rays of a packet take, and the light that they gather, compiled once per instruction
// set.
#if defined(VERNIER_VOLUME_FAST_STEPS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef VERNIER_VOLUME_FAST_STEPS_INL_H
#undef VERNIER_VOLUME_FAST_STEPS_INL_H
#else
#define VERNIER_VOLUME_FAST_STEPS_INL_H
#endif
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <cmath>
#include <limits>

#include "VolumeFastRead-inl.h"

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {

// The steps that the lanes' parts meet, counted from `base`, and the shares of the first and the last.
struct LaneSteps {
  std::int64_t base = 0;                     // least first step
  std::int64_t last = -1;                    // greatest last step
  std::int64_t wholeFrom = 0, wholeTo = -1;  // between these all lanes have whole steps
  VI first, end;
  V firstShare, lastShare;
  V beginAt, endAt;  // where in the first and the last step the lane's part begins and ends, 0..1
};

HWY_INLINE LaneSteps StepsOf(const RayPacket& p, double step, int lane0) {
  const D d;
  const DI di;
  constexpr int kMost = kPacketRays;
  std::int64_t first[kMost], last[kMost];
  alignas(64) std::int32_t from[kMost], to[kMost];
  alignas(64) float share0[kMost], share1[kMost], begin0[kMost], end1[kMost];
  const int n = static_cast<int>(hn::Lanes(d));
  LaneSteps s;
  s.base = std::numeric_limits<std::int64_t>::max();
  s.wholeFrom = std::numeric_limits<std::int64_t>::min(),
  s.wholeTo = std::numeric_limits<std::int64_t>::max();
  for (int l = 0; l < n; ++l) {
    const double begin = p.from_mm[lane0 + l] / step, end = p.to_mm[lane0 + l] / step;
    first[l] = 0, last[l] = -1, share0[l] = share1[l] = begin0[l] = end1[l] = 0;
    if (!(end > begin)) continue;
    const double low = std::floor(begin), high = std::ceil(end) - 1;
    first[l] = static_cast<std::int64_t>(low), last[l] = std::max(static_cast<std::int64_t>(high), first[l]);
    const bool one = last[l] == first[l];
    share0[l] = static_cast<float>(one ? end - begin : low + 1 - begin);
    share1[l] = one ? share0[l] : static_cast<float>(end - high);
    begin0[l] = static_cast<float>(begin - low), end1[l] = static_cast<float>(end - high);
    s.base = std::min(s.base, first[l]), s.last = std::max(s.last, last[l]);
    s.wholeFrom = std::max(s.wholeFrom, first[l] + 1), s.wholeTo = std::min(s.wholeTo, last[l] - 1);
  }
  for (int l = 0; l < n; ++l) {
    const bool empty = last[l] < first[l];
    from[l] = empty ? 1 : static_cast<std::int32_t>(first[l] - s.base);
    to[l] = empty ? 0 : static_cast<std::int32_t>(last[l] - s.base);
    if (empty) s.wholeTo = -1;
  }
  s.first = hn::Load(di, from), s.end = hn::Load(di, to);
  s.firstShare = hn::Load(d, share0), s.lastShare = hn::Load(d, share1);
  s.beginAt = hn::Load(d, begin0), s.endAt = hn::Load(d, end1);
  return s;
}

// The state of the lanes: light so far, and where the accumulated opacity passed a half. kLens: steps may be
// added in parts.
struct Light {
  V colour[3];
  V through;
  V before, after;  // of the step, or the part of it, that passed the half
  V from, to;       // kLens: that part, 0..1
  VI halfStep;      // from LaneSteps::base; -1: not yet

  HWY_INLINE void Load(const RayLight* lights) {
    const D d;
    alignas(64) float f[4][kPacketRays];
    for (std::size_t l = 0; l < hn::Lanes(d); ++l) {
      for (int c = 0; c < 3; ++c) f[c][l] = static_cast<float>(lights[l].colour[c]);
      f[3][l] = static_cast<float>(lights[l].through);
    }
    for (int c = 0; c < 3; ++c) colour[c] = hn::Load(d, f[c]);
    through = hn::Load(d, f[3]);
    before = after = to = hn::Set(d, 1.0f);
    from = hn::Zero(d);
    halfStep = hn::Set(DI(), -1);
  }

  // `part`: where in step k, of LaneSteps::base, it begins and ends; with kLens alone.
  template <bool kLens>
  HWY_INLINE void Add(std::int64_t k, V opacity, const V (&shown)[3], V partFrom, V partTo) {
    const D d;
    const V weight = hn::Mul(through, opacity);
    for (int c = 0; c < 3; ++c) colour[c] = hn::MulAdd(weight, shown[c], colour[c]);
    const V left = hn::Sub(through, weight), half = hn::Set(d, 0.5f);
    const M passed = hn::And(hn::Gt(through, half), hn::Le(left, half));
    if (!hn::AllFalse(d, passed)) {
      before = hn::IfThenElse(passed, through, before);
      after = hn::IfThenElse(passed, left, after);
      if constexpr (kLens)
        from = hn::IfThenElse(passed, partFrom, from), to = hn::IfThenElse(passed, partTo, to);
      halfStep =
          hn::IfThenElse(hn::RebindMask(DI(), passed), hn::Set(DI(), static_cast<std::int32_t>(k)), halfStep);
    }
    through = left;
  }

  template <bool kLens>
  HWY_INLINE void Store(const RayPacket& p, std::int64_t base, double step, int lane0,
                        RayLight* lights) const {
    const D d;
    alignas(64) float f[6][kPacketRays], part[2][kPacketRays];
    alignas(64) std::int32_t half[kPacketRays];
    for (int c = 0; c < 3; ++c) hn::Store(colour[c], d, f[c]);
    hn::Store(through, d, f[3]), hn::Store(before, d, f[4]), hn::Store(after, d, f[5]);
    hn::Store(halfStep, DI(), half);
    if constexpr (kLens) hn::Store(from, d, part[0]), hn::Store(to, d, part[1]);
    for (std::size_t l = 0; l < hn::Lanes(d); ++l) {
      const std::size_t n = static_cast<std::size_t>(lane0) + l;
      RayLight& r = lights[n];
      for (int c = 0; c < 3; ++c) r.colour[c] = static_cast<double>(f[c][l]);
      r.through = static_cast<double>(f[3][l]);
      if (half[l] < 0) continue;
      StepShare s = shareOf(base + half[l], step, p.from_mm[n], p.to_mm[n]);
      if constexpr (kLens) {
        const double begin = static_cast<double>(base + half[l]);
        s.from_mm = step * (begin + static_cast<double>(part[0][l]));
        s.to_mm = step * (begin + static_cast<double>(part[1][l]));
      }
      r.half_mm =
          RayLight::halfPlace(static_cast<double>(f[4][l]), static_cast<double>(f[5][l]), s.from_mm, s.to_mm);
    }
  }
};

// Opacities of parts of steps: 1 - (1 - A)^share.
HWY_NOINLINE V PartOf(V opacity, V share) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const V most = hn::Set(d, 0.99999994f);  // of an opaque one any part is opaque
  const V log = hn::Log1p(d, hn::Neg(hn::Min(opacity, most)));
  const V part = hn::Neg(hn::Expm1(d, hn::Mul(share, log)));
  const V opaque = hn::IfThenElseZero(hn::Gt(share, hn::Zero(d)), opacity);
  return hn::IfThenElse(hn::Or(hn::Gt(opacity, most), hn::Ge(share, one)), opaque, part);
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#endif
