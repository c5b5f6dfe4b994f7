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

// The state of the lanes: light so far, and where the accumulated opacity passed a half.
struct Light {
  V colour[3];
  V through;
  V before, after;  // of the step, or the part of it, that passed the half
  V from, to;       // with lenses: that part, 0..1
  VI halfStep;      // from LaneSteps::base; -1: not yet
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
