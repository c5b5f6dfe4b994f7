// SPDX-License-Identifier: GPL-3.0-or-later
#include "Annotations.h"

#include <algorithm>

#include "Version.h"
#include "vernier/picture/Hatch.h"
#include "vernier/picture/Outline.h"
#include "vernier/picture/Quantise.h"
#include "vernier/plan/Volumetric.h"
#include "vernier/volume/Voi.h"

namespace vernier::app {
namespace {

Result<Annotations> describeLayer(Session& session, const SliceLayer& layer, const Scene& scene,
                                  const View& view) {
  const auto volume = session.volume(layer.source);
  if (!volume) return volume.error();
  const Result<SlicePicture> picture = slicePicture(layer, scene.camera, view, **volume);
  if (!picture) return picture.error();
  const VoiWindow window =
      layer.window && usableWindow(*layer.window) ? *layer.window : session.defaultWindowOf(**volume);
  return describeSlice(layer, *picture, (*volume)->info(), window);
}

Result<Annotations> describeLayer(Session& session, const CurvedLayer& layer, const Scene& scene,
                                  const View& view) {
  const auto volume = session.volume(layer.source);
  if (!volume) return volume.error();
  const Result<CurvedPicture> picture = curvedPicture(layer, scene.camera, view);
  if (!picture) return picture.error();
  const VoiWindow window =
      layer.window && usableWindow(*layer.window) ? *layer.window : session.defaultWindowOf(**volume);
  return describeCurved(layer, *picture, (*volume)->info(), window);
}

Result<Annotations> describeLayer(Session& session, const ImageLayer& layer, const Scene& scene,
                                  const View& view) {
  const auto image = session.image(layer.source, layer.index);
  if (!image) return image.error();
  const ImageFrameInfo& info = (*image)->info();
  const VoiWindow window = layer.window && usableWindow(*layer.window) ? *layer.window
                           : !info.windows.empty()                     ? info.windows.front()
                                                                       : info.autoWindow;
  Sources sources;
  if (const auto state = session.presentation(layer.presentation))
    sources.presentations[layer.presentation] = state;
  const auto state = presentationOf(layer, info, sources);
  if (!state) return state.error();
  const FramePresentation* const applied = *state ? &**state : nullptr;
  return describeImage(layer, imagePicture(layer, scene.camera, view, info, applied), info, window, applied);
}

// Projections and shells: told alike, by a function of their own.
template <class Look, class Describe>
Result<Annotations> describeLook(Session& session, const Look& layer, const Scene& scene, const View& view,
                                 Describe&& describe) {
  const auto volume = session.volume(layer.source);
  if (!volume) return volume.error();
  const Result<CameraPicture> camera = cameraPicture(scene.camera, view, cameraBox((*volume)->grid()));
  if (!camera) return camera.error();
  const VoiWindow window = layer.window && usableWindow(*layer.window) ? *layer.window : wholeRange(**volume);
  return describe(layer, *camera, (*volume)->info(), window, scene.crop || !scene.clip.empty());
}

Annotations describe(const VolumeLayer& l, const CameraPicture& c, const Volume& v, bool cut) {
  VolumeLayer named = l;
  if (!l.transfer && l.preset.empty() && !v.isColour()) named.preset = defaultTransferPreset(v);
  return describeRendering(named, c, v.info(), cut);
}
Annotations describe(const IsosurfaceLayer& l, const CameraPicture& c, const Volume& v, bool cut) {
  IsosurfaceLayer levelled = l;
  if (!l.level && !v.isColour()) levelled.level = defaultIsoLevel(v);
  return describeIsosurface(levelled, c, v.info(), cut);
}

// Looks through a volume that have no window.
template <class Look>
Result<Annotations> describeRendered(Session& session, const Look& layer, const Scene& scene,
                                     const View& view) {
  const auto volume = session.volume(layer.source);
  if (!volume) return volume.error();
  const Result<CameraPicture> camera = cameraPicture(scene.camera, view, cameraBox((*volume)->grid()));
  if (!camera) return camera.error();
  return describe(layer, *camera, **volume, scene.crop || !scene.clip.empty());
}

Result<void> hatchLayer(Session& session, const Layer& layer, const Scene& scene, const View& view,
                        const Images& images, Picture& picture) {
  const auto hatch = [&](const std::string& source, const auto& placed) -> Result<void> {
    const auto volume = session.volume(source);
    if (!volume) return volume.error();
    const auto place = placed(**volume);
    if (!place) return place.error();
    hatchGaps(picture, images, *place, (*volume)->grid());
    return {};
  };
  if (const auto* slice = std::get_if<SliceLayer>(&layer))
    return hatch(slice->source, [&](const Volume& v) { return slicePicture(*slice, scene.camera, view, v); });
  if (const auto* curved = std::get_if<CurvedLayer>(&layer))
    return hatch(curved->source, [&](const Volume&) { return curvedPicture(*curved, scene.camera, view); });
  return {};
}

// All surfaces of a 3-D picture together.
Result<Annotations> describeSurfaces(Session& session, const Scene& scene, const View& view) {
  std::vector<const SurfaceFile*> files;
  Sources sources;
  for (const Layer& layer : scene.layers)
    if (const auto* surface = std::get_if<SurfaceLayer>(&layer)) {
      const auto file = session.surface(surface->source);
      if (!file)
        return makeError(ErrorCode::SceneInvalid, "The surface '" + surface->source + "' was not given.");
      sources.meshes[surface->source] = file->mesh;
      files.push_back(file.get());
    }
  const Result<CameraBox> box = cameraBox(scene, sources);
  if (!box) return box.error();
  const Result<CameraPicture> camera = cameraPicture(scene.camera, view, *box);
  if (!camera) return camera.error();
  return vernier::describeSurfaces(*camera, files, session.chosenSeries() != nullptr);
}

bool isSlice(const Scene& scene) {
  return std::any_of(scene.layers.begin(), scene.layers.end(),
                     [](const Layer& l) { return std::holds_alternative<SliceLayer>(l); });
}

bool looksThrough(const Scene& scene) {
  return std::any_of(scene.layers.begin(), scene.layers.end(), looksThroughVolume);
}

constexpr double kOutline_px = 1.6;

Result<void> drawOutlines(Picture& picture, Session& session, const Scene& scene, const View& view,
                          double scale) {
  const auto it = std::find_if(scene.layers.begin(), scene.layers.end(),
                               [](const Layer& l) { return std::holds_alternative<SliceLayer>(l); });
  if (it == scene.layers.end()) return {};
  const SliceLayer& slice = std::get<SliceLayer>(*it);
  const auto volume = session.volume(slice.source);
  if (!volume) return volume.error();
  const Result<SlicePicture> place = slicePicture(slice, scene.camera, view, **volume);
  if (!place) return place.error();
  for (const Layer& layer : scene.layers)
    if (const auto* surface = std::get_if<SurfaceLayer>(&layer))
      if (const auto file = session.surface(surface->source))
        drawLines(picture, outlineOf(*surface, *file->mesh, slice, *place), surface->colour,
                  kOutline_px * scale, surface->opacity);
  return {};
}

}  // namespace

Result<Annotations> annotationsFor(Session& session, const Scene& scene, const View& view, const Rendered& r,
                                   std::optional<double> limit) {
  Annotations a;
  for (auto layer = scene.layers.rbegin(); layer != scene.layers.rend();
       ++layer) {  // the topmost that is drawn
    std::optional<Result<Annotations>> said;
    if (const auto* slice = std::get_if<SliceLayer>(&*layer))
      said = describeLayer(session, *slice, scene, view);
    if (const auto* curved = std::get_if<CurvedLayer>(&*layer))
      said = describeLayer(session, *curved, scene, view);
    if (const auto* image = std::get_if<ImageLayer>(&*layer))
      said = describeLayer(session, *image, scene, view);
    if (const auto* projection = std::get_if<ProjectionLayer>(&*layer))
      said = describeLook(session, *projection, scene, view, describeProjection);
    if (const auto* shells = std::get_if<ShellsLayer>(&*layer))
      said = describeLook(session, *shells, scene, view, describeShells);
    if (const auto* volume = std::get_if<VolumeLayer>(&*layer))
      said = describeRendered(session, *volume, scene, view);
    if (const auto* iso = std::get_if<IsosurfaceLayer>(&*layer))
      said = describeRendered(session, *iso, scene, view);
    if (std::holds_alternative<SurfaceLayer>(*layer) && !isSlice(scene) && !looksThrough(scene))
      said = describeSurfaces(session, scene, view);
    if (!said) continue;
    if (!*said) return said->error();
    a = std::move(**said);
    break;
  }
  if (const auto tools =
          std::count_if(scene.layers.begin(), scene.layers.end(),
                        [](const Layer& l) { return std::holds_alternative<SurfaceLayer>(l); });
      tools > 0 && looksThrough(scene))
    a.what.push_back({std::to_string(tools) + (tools == 1 ? " surface" : " surfaces") + ", mm assumed",
                      std::to_string(tools) + " surfaces", Tone::Normal});
  if (!r.plan.afterwards.empty())
    a.what.push_back({"surface outlines, mm assumed", "outlines", Tone::Normal});
  if (showsNothing(r.frame.images)) a.what.push_back({kNoDataHere, "no data", Tone::Amber});
  for (const Layer& layer : scene.layers)  // what a plugin has drawn over the picture is said too
    if (const auto* custom = std::get_if<CustomLayer>(&layer); custom && session.draws(custom->kind)) {
      const Panel* panel = session.panelOf(custom->kind);
      a.what.push_back({"+ " + (panel ? panel->title : custom->kind), "", Tone::Normal});
    }
  for (const std::string& note : r.plan.notes) a.what.push_back({note, "", Tone::Amber});
  if (r.error && r.error->bound) {
    TextLine line = errorLine(*r.error->bound, static_cast<int>(100 * r.error->share), limit);
    if (!r.goalNote.empty()) line.text += ", " + r.goalNote, line.tone = Tone::Amber;
    a.status.insert(a.status.begin(), line);
  }
  return a;
}

bool showsNothing(const Images& images) {
  return !images.depth.empty() && std::all_of(images.depth.begin(), images.depth.end(),
                                              [](float depth) { return depth == kNothing_mm; });
}

std::vector<PngText> pngTexts(const Scene& scene, const Rendered& r) {
  std::vector<PngText> texts{{"Software", std::string("vernier ") + kVersion + ", not for primary diagnosis"},
                             {"Engine", r.frame.technique + ", " + r.frame.renderer}};
  for (const Layer& layer : scene.layers)
    if (const auto* image = std::get_if<ImageLayer>(&layer); image && !image->presentation.empty())
      texts.push_back({"Presentation", "presentation state " + image->presentation + " applied"});
  if (r.error) texts.push_back({"Error", quality::errorSentence(*r.error)});
  if (!r.goalNote.empty()) texts.push_back({"Goal", r.goalNote});
  return texts;
}

Result<Picture> finishedPicture(Session& session, const Scene& scene, const View& view, const Rendered& r,
                                std::optional<double> limit, double scale) {
  Picture picture = quantise(r.frame.images);
  for (const Layer& layer : scene.layers)
    if (const Result<void> hatched = hatchLayer(session, layer, scene, view, r.frame.images, picture);
        !hatched)
      return hatched.error();
  if (const Result<void> drawn = drawOutlines(picture, session, scene, view, scale); !drawn)
    return drawn.error();
  const Result<Annotations> a = annotationsFor(session, scene, view, r, limit);
  if (!a) return a.error();
  annotate(picture, *a, scale);
  return picture;
}

}  // namespace vernier::app
