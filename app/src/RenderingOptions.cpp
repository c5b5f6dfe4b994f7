// SPDX-License-Identifier: GPL-3.0-or-later
#include "RenderingOptions.h"

#include <algorithm>

#include "OptionChecks.h"
#include "OptionText.h"
#include "vernier/plan/SceneJson.h"

namespace vernier::app {
namespace {

Result<std::vector<double>> numbers(const std::string& option, const std::string& text,
                                    std::initializer_list<std::size_t> counts, const char* example) {
  std::vector<double> out;
  for (const std::string& part : split(text, ',')) {
    const std::optional<double> x = number(part);
    if (!x) return invalid(option, "'" + text + "' is no list of numbers; write it as " + example + ".");
    out.push_back(*x);
  }
  if (std::find(counts.begin(), counts.end(), out.size()) == counts.end())
    return invalid(option, "'" + text + "' has " + std::to_string(out.size()) + " numbers; write it as " +
                               example + ".");
  return out;
}

Result<Light> lightFrom(const std::string& text) {
  const Result<std::vector<double>> v = numbers("--light", text, {3, 6}, "x,y,z or x,y,z,r,g,b");
  if (!v) return v.error();
  Light light;
  const std::vector<double>& x = *v;
  light.towards = PatientVec(x[0], x[1], x[2]);
  if (!(length(*light.towards) > 0)) return invalid("--light", "A light needs a direction other than 0,0,0.");
  if (x.size() == 6) {
    for (std::size_t n = 3; n < 6; ++n)
      if (!(x[n] >= 0 && x[n] <= 1)) return invalid("--light", "The parts of a colour lie between 0 and 1.");
    light.colour = {x[3], x[4], x[5]};
  }
  return light;
}

Result<TransferFunction> transferFrom(const std::string& file) {
  const Result<std::string> text = textOf(file, "The transfer function");
  if (!text) return text.error();
  return parseTransfer(*text);
}

Result<VolumeLayer> layerFrom(const RenderingOptions& o, const std::string& preset) {
  VolumeLayer layer;
  layer.preset = preset;
  if (!o.transfer.empty()) {
    Result<TransferFunction> f = transferFrom(o.transfer);
    if (!f) return f.error();
    layer.transfer = *std::move(f);
  }
  if (!o.gains.empty()) {
    const Result<std::vector<double>> g = numbers("--gains", o.gains, {4}, "1,1,1,0.5");
    if (!g) return g.error();
    if (std::any_of(g->begin(), g->end(), [](double x) { return !(x >= 0 && x <= 1000); }))
      return invalid("--gains", "A gain lies between 0 and 1000.");
    std::copy(g->begin(), g->end(), layer.gains.begin());
  }
  if (o.mode == "max") layer.mode = VolumeMode::Max;
  if (o.mode == "min") layer.mode = VolumeMode::Min;
  if (o.classification == "post") layer.classification = Classification::Post;
  if (o.classification == "pre") layer.classification = Classification::Pre;
  if (o.classification == "pre-integrated") layer.classification = Classification::PreIntegrated;
  if (o.opacity == "linear") layer.opacity = OpacityRule::Linear;
  if (o.shading == "global-ambient") layer.shading = ShadingModel::GlobalAmbient;
  if (o.shading == "colour-per-voxel") layer.shading = ShadingModel::ColourPerVoxel;
  layer.combiner = o.combiner;
  return layer;
}

}  // namespace

void addRenderingFlags(CLI::App& sub, RenderingOptions& o) {
  sub.add_option("--transfer", o.transfer, "Views dvr..: a transfer function as JSON (docs/scene.md)");
  sub.add_option("--volume-mode", o.mode, "Views dvr..: blend max min (absent: blend)")
      ->check(CLI::IsMember({"blend", "max", "min"}));
  sub.add_option("--classification", o.classification,
                 "Views dvr..: post pre pre-integrated (absent: chosen by how steep the function is)")
      ->check(CLI::IsMember({"post", "pre", "pre-integrated"}));
  sub.add_option("--opacity", o.opacity, "Views dvr..: exact linear; linear is the papers' approximation")
      ->check(CLI::IsMember({"exact", "linear"}));
  sub.add_option("--gains", o.gains, "Views dvr.. of colour volumes: r,g,b,a (absent: 1,1,1,1)");
  sub.add_option("--shading", o.shading,
                 "View dvr-shaded: global-ambient colour-per-voxel (absent: colour-per-voxel)")
      ->check(CLI::IsMember({"global-ambient", "colour-per-voxel"}));
  sub.add_option("--combiner", o.combiner, "Views dvr.., iso: a shading mode by its file's name");
  sub.add_option("--iso", o.iso, "View iso: the level, a modality value (absent: 300 HU, or mid-range)");
  sub.add_option("--light", o.lights,
                 "Views dvr-shaded, iso: x,y,z[,r,g,b] towards a light, in the patient (repeatable; absent: "
                 "at the eye)")
      ->take_all();
}

std::string givenRenderingOption(const RenderingOptions& o) {
  const std::pair<const char*, bool> given[] = {{"--transfer", !o.transfer.empty()},
                                                {"--volume-mode", !o.mode.empty()},
                                                {"--classification", !o.classification.empty()},
                                                {"--opacity", !o.opacity.empty()},
                                                {"--gains", !o.gains.empty()},
                                                {"--shading", !o.shading.empty()},
                                                {"--combiner", !o.combiner.empty()},
                                                {"--iso", o.iso.has_value()},
                                                {"--light", !o.lights.empty()}};
  for (const auto& [option, isGiven] : given)
    if (isGiven) return option;
  return "";
}

Result<void> renderingOptions(const RenderingOptions& o, const std::string& view, const std::string& preset,
                              PresetOptions& out) {
  for (const std::string& text : o.lights) {
    Result<Light> light = lightFrom(text);
    if (!light) return light.error();
    out.lights.push_back(*light);
  }
  if (out.lights.size() > kMostLights)
    return invalid("--light", "There may be at most " + std::to_string(kMostLights) + " lights.");
  const bool iso = view == "iso";
  if (o.iso || (iso && !o.combiner.empty())) {
    out.iso.emplace();
    out.iso->level = o.iso;
    out.iso->combiner = o.combiner;
  }
  const bool volume = !o.transfer.empty() || !o.mode.empty() || !o.classification.empty() ||
                      !o.opacity.empty() || !o.gains.empty() || !o.shading.empty() ||
                      (!iso && !o.combiner.empty());
  const bool named = !preset.empty() && (view == "dvr" || view == "dvr-shaded" || view == "lens");
  if (!volume && !named) return {};
  if (named && !o.transfer.empty())
    return invalid("--preset", "A transfer function was given by name and by file; give one of them.");
  Result<VolumeLayer> layer = layerFrom(o, named ? preset : "");
  if (!layer) return layer.error();
  out.volume = *std::move(layer);
  return {};
}

}  // namespace vernier::app
