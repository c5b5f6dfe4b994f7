// SPDX-License-Identifier: GPL-3.0-or-later
// Workspace: looks through a volume, beside its slices.
#include "Looks.h"
#include "SceneEdits.h"
#include "Workspace.h"

namespace vernier::ui {
namespace {

constexpr const char* kBeside[] = {"axial", "coronal", "sagittal"};
constexpr int kLookTile = 3;

}  // namespace

Result<const SourceFacts*> Workspace::fitFor3d() const {
  const SourceFacts* f = factsOfTile(now_.active);
  if (!f) return makeError(ErrorCode::NothingToLoad, "Open a series first.");
  if (!f->grid)
    return makeError(ErrorCode::GeometryRefused,
                     f->why2d.empty() ? "This stack was not found fit for 3-D." : f->why2d);
  return f;
}

// The picture whose grey others take over: the active tile's, else that of a slice of the same source.
Scene Workspace::shownGrey() const {
  const Tile& active = tile(now_.active);
  if (!lookOf(active.scene)) return active.scene;
  for (const Tile& other : now_.tiles)
    if (other.source == active.source && sliceOf(other.scene)) return other.scene;
  return active.scene;
}

Result<void> Workspace::open3d() {
  const Result<const SourceFacts*> fit = fitFor3d();
  if (!fit) return fit.error();
  const SourceFacts f = **fit;
  const VolumeLook look = firstLook(f);
  std::optional<Scene> through = sceneOfLook(look, f);
  if (!through) return makeError(ErrorCode::GeometryRefused, "This volume cannot be looked through.");
  // Slices that are shown already stay as they are.
  bool beside = now_.layout == Layout::Quad;
  for (int t = 0; t < kLookTile; ++t) beside = beside && tile(t).source == f.id && tile(t).view == kBeside[t];
  if (!beside)
    if (const Result<void> mpr = openMpr(); !mpr) return mpr;
  const bool stepMade = !beside;  // by openMpr(): both are one step of undo
  Arrangement& a = stepMade ? now_ : edit(Gesture::Layout, -1);
  a.maximised.reset();
  if (!(at(kLookTile).source == f.id && lookOf(at(kLookTile).scene)))
    at(kLookTile) = {f.id, look.view, std::move(*through)};
  a.active = kLookTile;
  return {};
}

void Workspace::setLook(int t, const VolumeLook& look) {
  const SourceFacts* f = factsOfTile(t);
  std::optional<Scene> scene = f ? sceneOfLook(look, *f) : std::nullopt;
  const Layer* before = lookOf(tile(t).scene);
  if (!scene || !before) return;
  scene->camera = tile(t).scene.camera;
  Layer was = *before;
  for (Layer& layer : scene->layers) {
    if (auto* window = windowOf(layer), *chosen = windowOf(was); window && chosen) *window = *chosen;
    if (auto* inverted = inversionOf(layer), *chosen = inversionOf(was); inverted && chosen)
      *inverted = *chosen;
  }
  if (tile(t).view == look.view && *scene == tile(t).scene) return;
  edit(Gesture::Look, t);
  at(t).view = look.view;
  at(t).scene = std::move(*scene);
}

}  // namespace vernier::ui
