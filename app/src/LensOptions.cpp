// SPDX-License-Identifier: GPL-3.0-or-later
#include "LensOptions.h"

#include <algorithm>
#include <filesystem>

#include "OptionText.h"
#include "SurfaceOptions.h"
#include "vernier/plan/LensEdits.h"
#include "vernier/plan/SceneJson.h"
#include "vernier/volume/SurfaceFile.h"

namespace vernier::app {
namespace {

constexpr const char* kForms =
    "write it as sphere:x,y,z,r or box:x,y,z,sx,sy,sz or cone:x,y,z,x,y,z,r in patient mm, or name a file";

bool isJson(const std::string& path) {
  const std::string end = std::filesystem::path(path).extension().string();
  return end == ".json" || end == ".JSON";
}

// The file's text stands where a scene has its layers, so one reader reads both.
Result<LensLayer> lensFromJson(const std::string& path) {
  const Result<std::string> text = textOf(path, "The lens");
  if (!text) return text.error();
  const Result<Scene> scene =
      parseScene("{\"schema\": " + std::to_string(kSceneSchema) + ", \"layers\": [" + *text + "]}");
  if (!scene) return scene.error();
  if (scene->layers.size() != 1 || !std::holds_alternative<LensLayer>(scene->layers[0]))
    return invalid("--lens", "The file holds no lens: one object of \"kind\": \"lens\" is expected.");
  return std::get<LensLayer>(scene->layers[0]);
}

struct Given {
  LensLayer lens;
  bool hasInner = false;  // its file says what it shows
};

Result<Given> lensOf(Session& session, const std::string& text, std::stop_token stop) {
  Given g;
  if (looksLikeSurface(text)) {
    const Result<std::string> name = session.addSurface(text, stop);
    if (!name) return name.error();
    g.lens.shape = MeshShape{*name, true};
    return g;
  }
  if (isJson(text)) {
    Result<LensLayer> lens = lensFromJson(text);
    if (!lens) return lens.error();
    Scene alone;
    alone.layers.emplace_back(*lens);
    if (const Result<void> found = findSurfaces(session, alone, text, stop); !found) return found.error();
    return Given{*std::move(lens), true};
  }
  Result<LensShape> shape = parseLensShape(text);
  if (!shape) return shape.error();
  // Shapes lie about the origin of the lens's frame, so that a pose can turn and move them.
  g.lens.shape = *std::move(shape);
  const PatientPoint middle = middleOf(g.lens);
  if (auto* box = std::get_if<BoxShape>(&g.lens.shape)) box->centre = {};
  if (auto* sphere = std::get_if<SphereShape>(&g.lens.shape)) sphere->centre = {};
  if (auto* cone = std::get_if<ConeShape>(&g.lens.shape))
    cone->from = MeshPoint(cone->from.p - middle.p), cone->to = MeshPoint(cone->to.p - middle.p);
  g.lens.pose.translation = middle.p;
  return g;
}

bool isTransferPreset(const std::string& name) {
  const std::vector<std::string>& names = transferPresets();
  return std::find(names.begin(), names.end(), name) != names.end();
}

Result<LensInner> sliceInner(const std::string& text, const std::string& unit) {
  SliceLook look;
  if (text == "invert") {
    look.invert = true;
    return LensInner(look);
  }
  const bool window = text.starts_with("window:");
  const Result<VoiWindow> w = window ? parseWindow(text.substr(7)) : windowPreset(text, unit);
  if (!w)
    return invalid("--lens-inner", w.error().sentence +
                                       " On slices a lens shows cut-out, invert, window:C,W or "
                                       "the name of a window.");
  look.window = *w;
  return LensInner(look);
}

}  // namespace

void addLensFlags(CLI::App& sub, LensOptions& o) {
  sub.add_option("--lens", o.lenses,
                 "A lens: sphere:x,y,z,r box:x,y,z,sx,sy,sz cone:x,y,z,x,y,z,r[,r] in patient mm, a lens as "
                 ".json (docs/scene.md), or the hull of a surface file (repeatable, the last one wins)")
      ->take_all();
  sub.add_option("--lens-inner", o.inner,
                 "What lenses show: cut-out; through a volume mip, iso[:LEVEL] or a transfer function by "
                 "name; on slices invert, window:C,W or a window by name (absent: what fits the view)");
}

Result<LensShape> parseLensShape(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  if (colon == std::string::npos || (kind != "sphere" && kind != "box" && kind != "cone"))
    return invalid("--lens", "'" + text + "' is no lens; " + kForms + ".");
  std::vector<double> v;
  for (const std::string& part : split(text.substr(colon + 1), ',')) {
    const std::optional<double> x = number(part);
    if (!x)
      return invalid("--lens", "'" + text + "' has '" + part + "' where a number belongs; " + kForms + ".");
    v.push_back(*x);
  }
  const std::size_t least = kind == "sphere" ? 4 : kind == "box" ? 6 : 7, most = kind == "cone" ? 8 : least;
  if (v.size() < least || v.size() > most)
    return invalid("--lens", "'" + text + "' has " + std::to_string(v.size()) + " numbers; " + kForms + ".");
  const auto point = [&](std::size_t n) { return MeshPoint(v[n], v[n + 1], v[n + 2]); };
  if (std::any_of(v.begin() + (kind == "cone" ? 6 : 3), v.end(),
                  [&](double x) { return kind == "cone" ? x < 0 : x <= 0; }))
    return invalid("--lens",
                   "'" + text + "' has a size that is not above 0; sizes and radii are millimetres.");
  if (kind == "sphere") return LensShape(SphereShape{point(0), v[3], 3});
  if (kind == "box") return LensShape(BoxShape{point(0), {v[3], v[4], v[5]}});
  return LensShape(ConeShape{point(0), point(3), v[6], v.size() > 7 ? v[7] : v[6], 48});
}

Result<LensInner> parseLensInner(const std::string& text, const Layer& behind, const std::string& unit) {
  if (text == "cut-out") return LensInner(CutOut{});
  if (std::holds_alternative<SliceLayer>(behind)) return sliceInner(text, unit);
  const std::string source = volumeOf(behind) ? *volumeOf(behind) : "";
  if (text == "mip" || text.starts_with("window:")) {
    ProjectionLayer l;
    l.source = source;
    if (text != "mip") {
      const Result<VoiWindow> w = parseWindow(text.substr(7));
      if (!w) return invalid("--lens-inner", w.error().sentence);
      l.window = *w;
    }
    return LensInner(l);
  }
  if (text == "iso" || text.starts_with("iso:")) {
    IsosurfaceLayer l;
    l.source = source;
    if (text.size() > 3) l.level = number(text.substr(4));
    if (text.size() > 3 && !l.level)
      return invalid("--lens-inner", "'" + text + "' has no number for a level; write it as iso:300.");
    return LensInner(l);
  }
  if (isTransferPreset(text)) {
    VolumeLayer l;
    l.source = source;
    l.preset = text;
    return LensInner(l);
  }
  std::string names;
  for (const std::string& n : transferPresets()) names += " " + n;
  return invalid("--lens-inner", "'" + text +
                                     "' is nothing that a lens shows in a volume; there are cut-out mip "
                                     "window:C,W iso iso:LEVEL" +
                                     names + ".");
}

Result<void> addLenses(Session& session, Scene& scene, const ViewOptions& o, const ProgressFn& progress,
                       std::stop_token stop) {
  const LensOptions& given = o.lens;
  if (given.lenses.empty() && given.inner.empty()) return {};
  const Layer* found = layerBehindLens(scene);
  if (!found)
    return invalid("--lens",
                   "A lens looks into slices and through volumes, and this picture shows neither; use "
                   "axial, coronal, sagittal, oblique, mip, dvr or iso.");
  const Layer behind = *found;
  const auto volume = session.volume(*volumeOf(behind), progress, stop);
  if (!volume) return volume.error();
  const std::string& unit = (*volume)->info().unit;
  Result<LensInner> inner = given.inner.empty() ? Result<LensInner>(defaultLensInner(behind, unit == "HU"))
                                                : parseLensInner(given.inner, behind, unit);
  if (!inner) return inner.error();
  const auto isLens = [](const Layer& l) { return std::holds_alternative<LensLayer>(l); };
  if (given.lenses.empty()) {
    if (std::none_of(scene.layers.begin(), scene.layers.end(), isLens))
      return invalid("--lens-inner",
                     "It says what a lens shows, and there is none; add --lens, or use --view lens.");
    for (Layer& l : scene.layers)
      if (auto* lens = std::get_if<LensLayer>(&l)) lens->inner = *inner;
    return {};
  }
  if (o.view == "lens") std::erase_if(scene.layers, isLens);
  for (const std::string& text : given.lenses) {
    Result<Given> one = lensOf(session, text, stop);
    if (!one) return one.error();
    if (!one->hasInner || !given.inner.empty()) one->lens.inner = *inner;
    Result<Scene> with = addLens(std::move(scene), std::move(one->lens));
    if (!with) return with.error();
    scene = *std::move(with);
  }
  return {};
}

}  // namespace vernier::app
