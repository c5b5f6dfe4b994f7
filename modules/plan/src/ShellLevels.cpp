// SPDX-License-Identifier: GPL-3.0-or-later
// Which levels a set of shells has.
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "vernier/base/Threads.h"
#include "vernier/plan/Volumetric.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {

constexpr std::size_t kBins = 4096;
using Histogram = std::array<std::uint64_t, kBins>;

// Of the values strictly inside the window, in equal bins.
Histogram histogramOf(const Volume& volume, VoiRamp inside) {
  Histogram all{};
  std::mutex merging;
  const GridGeometry& g = volume.grid();
  const double perValue = static_cast<double>(kBins) / (inside.hi - inside.lo);
  parallelFor(static_cast<std::size_t>(g.slices), 1, [&](std::size_t begin, std::size_t end) {
    Histogram mine{};
    for (auto k = static_cast<std::int64_t>(begin); k < static_cast<std::int64_t>(end); ++k)
      for (std::int64_t j = 0; j < g.rows; ++j)
        for (std::int64_t i = 0; i < g.columns; ++i) {
          if (volume.isNoData(volume.stored(i, j, k))) continue;
          const double v = volume.modality(i, j, k);
          if (v > inside.lo && v < inside.hi)
            ++mine[std::min(kBins - 1, static_cast<std::size_t>((v - inside.lo) * perValue))];
        }
    const std::lock_guard lock(merging);
    for (std::size_t b = 0; b < kBins; ++b) all[b] += mine[b];
  });
  return all;
}

// Where n / (count + 1) of the counted values lie below, linear within a bin. Equal neighbours (all values in
// one bin's middle) are left out.
std::vector<double> quantiles(const Histogram& histogram, VoiRamp inside, int count) {
  std::uint64_t total = 0;
  for (std::uint64_t n : histogram) total += n;
  std::vector<double> out;
  if (total == 0) return out;
  std::uint64_t below = 0;
  std::size_t bin = 0;
  for (int n = 1; n <= count; ++n) {
    const double wanted = static_cast<double>(total) * n / (count + 1);
    while (bin + 1 < kBins && static_cast<double>(below + histogram[bin]) < wanted) below += histogram[bin++];
    const double within =
        histogram[bin] ? (wanted - static_cast<double>(below)) / static_cast<double>(histogram[bin]) : 0;
    const double level = inside.lo + (inside.hi - inside.lo) * (static_cast<double>(bin) + within) /
                                         static_cast<double>(kBins);
    if (out.empty() || level > out.back()) out.push_back(level);
  }
  return out;
}

Error invalid(const std::string& sentence) { return makeError(ErrorCode::SceneInvalid, sentence, "levels"); }

}  // namespace

Result<std::vector<double>> shellLevels(const ShellsLayer& layer, const Volume& volume) {
  const std::string most = std::to_string(kMostLevels);
  if (!layer.levels.empty()) {
    if (layer.levels.size() > static_cast<std::size_t>(kMostLevels))
      return invalid(std::to_string(layer.levels.size()) + " levels were given; there may be 1 to " + most +
                     ".");
    for (std::size_t i = 0; i < layer.levels.size(); ++i) {
      if (!std::isfinite(layer.levels[i])) return invalid("Every level must be a finite number.");
      if (i > 0 && !(layer.levels[i] > layer.levels[i - 1]))
        return invalid("The levels must ascend, each above the one before.");
    }
    return layer.levels;
  }
  if (layer.count < 1 || layer.count > kMostLevels)
    return invalid(std::to_string(layer.count) + " levels were asked for; there may be 1 to " + most + ".");
  if (!layer.window || !usableWindow(*layer.window) || layer.window->function == VoiFunction::Sigmoid)
    return invalid("Shells need a linear window with a width above 0 to take their levels from.");
  const VoiRamp ramp = rampOf(*layer.window);
  if (!(ramp.hi > ramp.lo)) return invalid("The window has no width between which levels could lie.");
  if (layer.spread == LevelSpread::Histogram) {
    std::vector<double> levels = quantiles(histogramOf(volume, ramp), ramp, layer.count);
    if (levels.empty())
      return invalid("No voxel lies inside the window, so there is nothing to take levels from.");
    return levels;
  }
  std::vector<double> levels;
  for (int n = 1; n <= layer.count; ++n)
    levels.push_back(ramp.lo + (ramp.hi - ramp.lo) * n / (layer.count + 1));
  return levels;
}

}  // namespace vernier
