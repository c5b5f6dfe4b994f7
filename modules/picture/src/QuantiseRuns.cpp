// SPDX-License-Identifier: GPL-3.0-or-later
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "QuantiseRuns.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "QuantiseRuns.h"
#include "vernier/picture/Quantise.h"

HWY_BEFORE_NAMESPACE();
namespace vernier {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using DHalf = hn::Half<D>;
using DDouble = hn::RepartitionToWide<D>;
using DLevel = hn::Rebind<std::int32_t, DDouble>;
using DByte = hn::Rebind<std::uint8_t, D>;
using V = hn::VFromD<D>;

HWY_INLINE hn::VFromD<DLevel> LevelsOfHalf(hn::VFromD<DHalf> x) {
  const DDouble dd;
  // The product is exact in double and the conversion cuts: floor, as nothing is negative.
  return hn::DemoteTo(DLevel(), hn::Add(hn::Mul(hn::PromoteTo(dd, x), hn::Set(dd, 255.0)), hn::Set(dd, 0.5)));
}

HWY_INLINE hn::VFromD<DByte> Levels(V x) {
  const D d;
  const V clamped = hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, 1.0f));
  const auto low = LevelsOfHalf(hn::LowerHalf(DHalf(), clamped));
  const auto high = LevelsOfHalf(hn::UpperHalf(DHalf(), clamped));
  return hn::DemoteTo(DByte(), hn::Combine(hn::RebindToSigned<D>(), high, low));
}

HWY_INLINE void MarkNotANumber(hn::Mask<D> bad, std::size_t n, std::uint8_t* to) {
  float marked[hn::MaxLanes(D())];
  hn::StoreU(hn::IfThenElseZero(bad, hn::Set(D(), 1.0f)), D(), marked);
  for (std::size_t i = 0; i < n; ++i)
    if (marked[i] > 0) to[3 * i] = kMarker.r, to[3 * i + 1] = kMarker.g, to[3 * i + 2] = kMarker.b;
}

HWY_INLINE void QuantiseVector(const float* in, std::uint8_t* to) {
  const D d;
  V r, g, b, a;
  hn::LoadInterleaved4(d, in, r, g, b, a);
  // Slices consist of grey, which is converted once. A NaN is not equal to itself, so it is not grey.
  if (HWY_LIKELY(hn::AllTrue(d, hn::And(hn::Eq(r, g), hn::Eq(r, b))))) {
    const auto grey = Levels(r);
    hn::StoreInterleaved3(grey, grey, grey, DByte(), to);
    return;
  }
  const auto bad = hn::Or(hn::IsNaN(r), hn::Or(hn::IsNaN(g), hn::IsNaN(b)));
  hn::StoreInterleaved3(Levels(r), Levels(g), Levels(b), DByte(), to);
  if (HWY_UNLIKELY(!hn::AllFalse(d, bad))) MarkNotANumber(bad, hn::Lanes(d), to);
}

void QuantiseRuns(const float* rgba, std::size_t n, std::uint8_t* rgb) {
  const std::size_t lanes = hn::Lanes(D());
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) QuantiseVector(rgba + 4 * i, rgb + 3 * i);
  for (; i < n; ++i) {
    const float* const in = rgba + 4 * i;
    const bool bad = std::isnan(in[0]) || std::isnan(in[1]) || std::isnan(in[2]);
    const Rgb8 out = bad ? kMarker : Rgb8{quantise(in[0]), quantise(in[1]), quantise(in[2])};
    rgb[3 * i] = out.r, rgb[3 * i + 1] = out.g, rgb[3 * i + 2] = out.b;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier {

HWY_EXPORT(QuantiseRuns);

void quantiseRuns(const float* rgba, std::size_t n, std::uint8_t* rgb) {
  HWY_DYNAMIC_DISPATCH(QuantiseRuns)(rgba, n, rgb);
}

}  // namespace vernier
#endif
