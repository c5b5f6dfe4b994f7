// SPDX-License-Identifier: GPL-3.0-or-later
#include "SurfaceCover.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "SurfaceCover.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vernier::native {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE M Positive(V a, V x, V row, M zeroIsPositive) {
  const V e = hn::Add(hn::Mul(a, x), row);
  const V zero = hn::Zero(D());
  return hn::Or(hn::Gt(e, zero), hn::And(hn::Eq(e, zero), zeroIsPositive));
}

void CoverRows(const EdgeLine (&edges)[3], int x0, int y0, int width, int height, std::uint64_t* rows) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V a[3];
  M zero[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = hn::Set(d, edges[i].a);
    zero[i] = hn::Eq(hn::Set(d, edges[i].zeroIsPositive ? 0.0 : 1.0), hn::Zero(d));
  }
  const std::uint64_t inside = width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
  for (int n = 0; n < height; ++n) {
    const double y = y0 + n + 0.5;
    V row[3];
    for (int i = 0; i < 3; ++i) row[i] = hn::Set(d, edges[i].b * y + edges[i].c);
    std::uint64_t covered = 0;
    for (int k = 0; k < width; k += lanes) {
      const V x = hn::Iota(d, x0 + k + 0.5);
      const M p = Positive(a[0], x, row[0], zero[0]), q = Positive(a[1], x, row[1], zero[1]),
              r = Positive(a[2], x, row[2], zero[2]);
      const M same = hn::Or(hn::And(p, hn::And(q, r)), hn::Not(hn::Or(p, hn::Or(q, r))));
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, same, bits);
      covered |= static_cast<std::uint64_t>(bits[0]) << k;
    }
    rows[n] = covered & inside;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace vernier::native
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vernier::native {

HWY_EXPORT(CoverRows);

void coverRows(const EdgeLine (&edges)[3], int x0, int y0, int width, int height, std::uint64_t* rows) {
  HWY_DYNAMIC_DISPATCH(CoverRows)(edges, x0, y0, width, height, rows);
}

}  // namespace vernier::native
#endif
