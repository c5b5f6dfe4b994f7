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
  const VolumeLook first = firstLook(f);
  std::optional<Scene> scene = sceneOfLook(first, f);
  if (!scene) return makeError(ErrorCode::GeometryRefused, "This volume cannot be looked through.");
  // A look that there is already comes along, wherever it is.
  Tile look{f.id, first.view, std::move(*scene)};
  for (const Tile& tile : now_.tiles)
    if (tile.source == f.id && lookOf(tile.scene)) look = tile;
  if (now_.layout == Layout::Pair) {
    if (!lookOf(tile(now_.active).scene)) edit(Gesture::Look, now_.active), at(now_.active) = std::move(look);
    return {};
  }
  // Slices that are shown already stay as they are.
  bool beside = now_.layout == Layout::Quad;
  for (int t = 0; t < kLookTile; ++t) beside = beside && tile(t).source == f.id && tile(t).view == kBeside[t];
  if (beside && tile(kLookTile) == look && !now_.maximised) {
    now_.active = kLookTile;  // where the eye is, is no edit
    return {};
  }
  if (!beside)
    if (const Result<void> mpr = openMpr(); !mpr) return mpr;
  Arrangement& a = beside ? edit(Gesture::Layout, -1) : now_;  // openMpr() has made the step
  a.maximised.reset();
  at(kLookTile) = std::move(look);
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
