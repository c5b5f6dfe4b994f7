// SPDX-License-Identifier: GPL-3.0-or-later
#include "ChooseClassification.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/base/Random.h"

namespace vernier::dvr {
namespace {

constexpr std::uint64_t kPlaces = 4096, kSeed = 20001;
constexpr int kParts = 8;  // of the way within a step

// Between a voxel and its next neighbours: value there, and its change per mm; NaN next to no-data.
struct Local {
  double value = 0, slope_perMm = 0;
};

Local localAt(const Volume& v, std::uint64_t place) {
  const GridGeometry& g = v.grid();
  const std::int64_t size[3] = {g.columns, g.rows, g.slices};
  std::int64_t at[3];
  for (int a = 0; a < 3; ++a) {
    const double unit = randomUnit(kSeed, 3 * place + static_cast<std::uint64_t>(a));
    at[a] = std::min(static_cast<std::int64_t>(unit * static_cast<double>(size[a])), size[a] - 1);
  }
  const glm::dvec3 spacing = g.spacing_mm();
  const auto value = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return v.isNoData(v.stored(i, j, k)) ? std::nan("") : v.modality(i, j, k);
  };
  Local out{value(at[0], at[1], at[2]), 0};
  double square = 0;
  for (int a = 0; a < 3; ++a) {
    if (size[a] < 2) continue;
    std::int64_t next[3] = {at[0], at[1], at[2]};
    next[a] += next[a] + 1 < size[a] ? 1 : -1;
    const double change = (value(next[0], next[1], next[2]) - out.value) / spacing[a];
    square += change * change;
  }
  out.slope_perMm = std::sqrt(square);
  return out;
}

double measured(const Volume& v, const TransferFunction& f, double step_mm) {
  const double lengths = step_mm / f.opacityLength_mm;
  const auto opacity = [&](double value) { return opacityOver(opacityAt(f, value), lengths); };
  double squares = 0, count = 0;
  for (std::uint64_t n = 0; n < kPlaces; ++n) {
    const Local local = localAt(v, n);
    const double way = local.slope_perMm * step_mm;
    if (!(way >= 0)) continue;
    const double middle = opacity(local.value);
    double mean = 0;
    for (int k = 0; k < kParts; ++k) mean += opacity(local.value + way * ((k + 0.5) / kParts - 0.5)) / kParts;
    if (!(middle > 0) && !(mean > 0)) continue;
    squares += (mean - middle) * (mean - middle), ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

struct Known {
  Revision volume = 0;
  TransferFunction function;
  double step_mm = 0, steepness = 0;
};
constexpr std::size_t kMostKnown = 16;

}  // namespace

double steepness(const Volume& v, const TransferFunction& f, double step_mm) {
  // A scene is planned anew for whatever moves in it, and its layers ask the same again.
  thread_local std::vector<Known> known;
  const auto found = std::find_if(known.begin(), known.end(), [&](const Known& k) {
    return k.volume == v.revision() && k.step_mm == step_mm && k.function == f;
  });
  if (found != known.end()) {
    std::rotate(known.begin(), found, found + 1);
    return known.front().steepness;
  }
  if (known.size() == kMostKnown) known.pop_back();
  known.insert(known.begin(), Known{v.revision(), f, step_mm, measured(v, f, step_mm)});
  return known.front().steepness;
}

}  // namespace vernier::dvr
