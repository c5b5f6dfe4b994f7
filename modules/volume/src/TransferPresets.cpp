// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions by name. `ct` and `ramp` are those of the benchmark programs that Vernier is compared
// with.
#include <algorithm>
#include <array>
#include <span>

#include "vernier/volume/TransferFunction.h"

namespace vernier {
namespace {

struct Preset {
  const char* name;
  bool ofRange;  // values are fractions of the volume's range, opacities per step of the smallest spacing
  std::span<const ColourPoint> colours;
  std::span<const OpacityPoint> opacities;
};

const ColourPoint kCtColours[] = {
    {-400, {.62, .36, .22}}, {60, {.85, .45, .35}}, {300, {1, .85, .70}}, {1200, {1, 1, .95}}};
const OpacityPoint kCtOpacities[] = {{-400, 0}, {-100, .015}, {60, .03}, {200, .06}, {400, .3}, {1200, .8}};

const ColourPoint kBoneColours[] = {{150, {.72, .36, .24}}, {300, {.94, .80, .62}}, {1200, {1, .98, .92}}};
const OpacityPoint kBoneOpacities[] = {{150, 0}, {300, .25}, {1200, .85}};

const ColourPoint kSoftColours[] = {
    {-150, {.85, .70, .45}}, {0, {.80, .45, .38}}, {80, {.90, .55, .48}}, {250, {1, .90, .80}}};
const OpacityPoint kSoftOpacities[] = {{-150, 0}, {-60, .02}, {20, .08}, {80, .15}, {300, .35}, {1200, .7}};

const ColourPoint kLungColours[] = {
    {-1000, {.20, .35, .60}}, {-700, {.55, .70, .85}}, {-400, {.90, .60, .50}}, {50, {1, .88, .80}}};
const OpacityPoint kLungOpacities[] = {{-920, 0},   {-800, .008}, {-600, .02},
                                       {-400, .06}, {-100, .02},  {200, .3}};

const ColourPoint kAngioColours[] = {
    {100, {.55, .08, .06}}, {250, {.90, .25, .18}}, {450, {1, .75, .55}}, {900, {1, .98, .94}}};
const OpacityPoint kAngioOpacities[] = {{120, 0}, {200, .08}, {350, .45}, {900, .7}};

const ColourPoint kMrColours[] = {
    {0, {.15, .12, .12}}, {.15, {.55, .35, .30}}, {.40, {.85, .70, .60}}, {1, {1, 1, 1}}};
const OpacityPoint kMrOpacities[] = {{.08, 0}, {.18, .02}, {.40, .08}, {.70, .20}, {1, .30}};

const ColourPoint kMrAngioColours[] = {{.20, {.55, .10, .08}}, {.45, {.95, .45, .30}}, {1, {1, .95, .90}}};
const OpacityPoint kMrAngioOpacities[] = {{.25, 0}, {.40, .10}, {.60, .40}, {1, .70}};

const ColourPoint kRampColours[] = {{.25, {.6, .1, .05}}, {.5, {.9, .5, .2}}, {1, {1, 1, .9}}};
const OpacityPoint kRampOpacities[] = {{.25, 0}, {.5, .15}, {1, .8}};

const Preset kPresets[] = {{"ct", false, kCtColours, kCtOpacities},
                           {"ct-bone", false, kBoneColours, kBoneOpacities},
                           {"ct-soft", false, kSoftColours, kSoftOpacities},
                           {"ct-lung", false, kLungColours, kLungOpacities},
                           {"ct-angio", false, kAngioColours, kAngioOpacities},
                           {"mr", true, kMrColours, kMrOpacities},
                           {"mr-angio", true, kMrAngioColours, kMrAngioOpacities},
                           {"ramp", true, kRampColours, kRampOpacities}};

Volume::Range rangeOf(const Volume& volume) { return volume.modalityRange().value_or(Volume::Range{0, 1}); }

}  // namespace

const std::vector<std::string>& transferPresets() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> v;
    for (const Preset& p : kPresets) v.emplace_back(p.name);
    return v;
  }();
  return names;
}

std::string defaultTransferPreset(const Volume& volume) {
  const Volume::Range r = rangeOf(volume);
  return r.min < -500 && r.max > 700 ? "ct" : "ramp";
}

Result<TransferFunction> transferPreset(const std::string& name, const Volume& volume) {
  const auto* p = std::find_if(std::begin(kPresets), std::end(kPresets),
                               [&](const Preset& preset) { return name == preset.name; });
  if (p == std::end(kPresets)) {
    std::string known;
    for (const std::string& n : transferPresets()) known += (known.empty() ? "" : ", ") + n;
    return makeError(ErrorCode::OptionInvalid,
                     "No transfer function is called '" + name + "'; there are " + known + ".", "transfer");
  }
  TransferFunction f{{p->colours.begin(), p->colours.end()}, {p->opacities.begin(), p->opacities.end()}, 1};
  if (!p->ofRange) return f;
  const Volume::Range r = rangeOf(volume);
  // A volume of one value has it at the middle of the ramp.
  const double width = r.max > r.min ? r.max - r.min : 1, least = r.max > r.min ? r.min : r.min - 0.5;
  for (ColourPoint& c : f.colours) c.value = least + c.value * width;
  for (OpacityPoint& o : f.opacities) o.value = least + o.value * width;
  const glm::dvec3 s = volume.grid().spacing_mm();
  f.opacityLength_mm = std::min({s.x, s.y, s.z});
  return f;
}

double defaultIsoLevel(const Volume& volume) {
  if (defaultTransferPreset(volume) == "ct") return 300;
  const Volume::Range r = rangeOf(volume);
  return 0.5 * (r.min + r.max);
}

}  // namespace vernier
