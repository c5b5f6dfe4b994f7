// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/TransferTable.h"

#include <algorithm>
#include <cmath>

namespace vernier {
namespace {

Error internal(const std::string& sentence) {
  return makeError(ErrorCode::Internal, sentence, "transfer table");
}

Volume::Range knotRange(const TransferFunction& f) {
  return {std::min(f.colours.front().value, f.opacities.front().value),
          std::max(f.colours.back().value, f.opacities.back().value)};
}

Volume::Range within(const Volume::Range& values, double first, double last, double margin) {
  Volume::Range r{std::max(values.min, first - margin), std::min(values.max, last + margin)};
  // All values lie beyond the knots: one colour, any range tells it.
  if (!(r.min < r.max)) r = {values.min, std::max(values.max, values.min)};
  if (!(r.min < r.max)) {
    const double half = std::max(0.5, 1e-6 * std::abs(r.min));
    r = {r.min - half, r.min + half};
  }
  return r;
}

}  // namespace

Volume::Range transferTableRange(const TransferFunction& f, const Volume::Range& values) {
  const auto [first, last] = knotRange(f);
  return within(values, first, last, last > first ? 1e-3 * (last - first) : 0.5);
}

Volume::Range preIntegratedRange(const TransferFunction& f, const Volume::Range& values) {
  const auto [first, last] = knotRange(f);
  return within(values, first, last, std::max({last - first, 0.25 * (values.max - values.min), 0.5}));
}

Result<TransferTable> makeTransferTable(const TransferFunction& f, const Volume::Range& range, double step_mm,
                                        bool linear, int entries) {
  if (Result<void> ok = checkTransferFunction(f); !ok) return ok.error();
  if (!(range.min < range.max)) return internal("The range of values is empty.");
  if (!(step_mm > 0) || !std::isfinite(step_mm)) return internal("The step is no length.");
  if (entries < 2 || entries > kMostTransferEntries)
    return internal("The number of entries is out of range.");
  TransferTable t{range.min, range.max, step_mm, entries, {}};
  t.rgba.resize(4 * static_cast<std::size_t>(entries));
  const double lengths = step_mm / f.opacityLength_mm;
  for (int n = 0; n < entries; ++n) {
    const double value = t.valueOf(n), opacity = opacityAt(f, value);
    const glm::dvec3 colour = colourAt(f, value);
    float* const out = t.rgba.data() + 4 * static_cast<std::size_t>(n);
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(colour[c]);
    out[3] = static_cast<float>(linear ? opacityOverLinear(opacity, lengths) : opacityOver(opacity, lengths));
  }
  return t;
}

}  // namespace vernier
