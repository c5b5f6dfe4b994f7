// SPDX-License-Identifier: GPL-3.0-or-later
#include "VolumeOptions.h"

#include <algorithm>
#include <cmath>

#include "OptionChecks.h"
#include "OptionText.h"

namespace vernier::app {
namespace {

// "12" or "100,200,300".
Result<void> readLevels(const std::string& text, ShellsLayer& shells) {
  std::vector<std::string> parts = split(text, ',');
  const bool list = parts.size() > 1;
  if (list && parts.back().empty()) parts.pop_back();
  std::vector<double> values;
  for (const std::string& part : parts) {
    const std::optional<double> v = number(part);
    if (!v)
      return invalid("--levels",
                     "'" + text +
                         "' is neither a number of levels, such as 12, nor a list of values, such as "
                         "100,200,300.");
    values.push_back(*v);
  }
  if (list) {
    if (!std::is_sorted(values.begin(), values.end(), std::less_equal<>()))
      return invalid("--levels", "The levels must ascend, each above the one before.");
    if (values.size() > static_cast<std::size_t>(kMostLevels))
      return invalid("--levels", std::to_string(values.size()) + " levels were given; there may be 1 to " +
                                     std::to_string(kMostLevels) + ".");
    shells.levels = std::move(values);
    return {};
  }
  if (values[0] != std::floor(values[0]) || values[0] < 1 || values[0] > kMostLevels)
    return invalid("--levels", "'" + text + "' is no number of levels from 1 to " +
                                   std::to_string(kMostLevels) +
                                   "; a single level by value is written with a comma: " + text + ",");
  shells.count = static_cast<int>(values[0]);
  return {};
}

}  // namespace

void addVolumeFlags(CLI::App& sub, VolumeOptions& o) {
  sub.add_option("--levels", o.levels,
                 "Views shells..: how many levels, or their values v1,v2,.. (absent: 12, lit 3)");
  sub.add_option("--level-spread", o.spread, "Views shells..: even histogram (absent: even)")
      ->check(CLI::IsMember({"even", "histogram"}));
  sub.add_option("--beta0", o.beta0, "Views shells..: brightness of the background end of the depth ramp")
      ->check(finiteFrom(0, 1e6));
  sub.add_option("--beta-m", o.betaM, "Views shells..: slope of the depth ramp (absent: 1)")
      ->check(finiteAboveZero());
  sub.add_option("--a", o.a, "Views shells..: amount of depth cue (absent: 0)")->check(finiteFrom(0, 1e6));
  sub.add_option("--b", o.b, "Views shells..: contrast between levels (absent: 1, sum 1 / levels)")
      ->check(finiteFrom(0, 1e6));
  sub.add_option("--cue", o.cue, "View mip: depth cue, 0 none to 1 (absent: 0)")->check(finiteFrom(0, 1));
  sub.add_option("--gain", o.gain_perMm, "Views sum, attenuation: gain per mm (absent: 4 / diagonal)")
      ->check(finiteAboveZero());
}

std::string givenVolumeOption(const VolumeOptions& o) {
  const std::pair<const char*, bool> given[] = {
      {"--levels", !o.levels.empty()},  {"--level-spread", !o.spread.empty()},
      {"--beta0", o.beta0.has_value()}, {"--beta-m", o.betaM.has_value()},
      {"--a", o.a.has_value()},         {"--b", o.b.has_value()},
      {"--cue", o.cue.has_value()},     {"--gain", o.gain_perMm.has_value()}};
  for (const auto& [option, isGiven] : given)
    if (isGiven) return option;
  return "";
}

Result<void> volumeOptions(const VolumeOptions& o, const std::string& view, PresetOptions& preset) {
  if (o.cue || o.gain_perMm) {
    preset.projection.emplace();
    preset.projection->cue = o.cue.value_or(0);
    preset.projection->gain_perMm = o.gain_perMm;
  }
  const bool shells = !o.levels.empty() || !o.spread.empty() || o.beta0 || o.betaM || o.a || o.b;
  if (!shells) return {};
  ShellsLayer layer = shellsOfView(view);
  if (!o.levels.empty())
    if (const Result<void> ok = readLevels(o.levels, layer); !ok) return ok;
  if (o.spread == "histogram") layer.spread = LevelSpread::Histogram;
  layer.beta0 = o.beta0.value_or(layer.beta0);
  layer.betaM = o.betaM.value_or(layer.betaM);
  layer.a = o.a.value_or(layer.a);
  if (layer.mode == ShellsMode::Sum)
    layer.b = 1.0 / (layer.levels.empty() ? layer.count : static_cast<double>(layer.levels.size()));
  layer.b = o.b.value_or(layer.b);
  preset.shells = layer;
  return {};
}

}  // namespace vernier::app
