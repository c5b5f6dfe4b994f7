// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses on the desktop: they stand in the patient, and every picture of slices of that place shows them.
#include <algorithm>

#include "Lenses.h"
#include "vernier/plan/LensEdits.h"

namespace vernier::ui {
namespace {

// What is inside reads the volume that the tile shows.
LensLayer lensInto(LensLayer lens, const std::string& source) {
  std::visit(
      [&](auto& inner) {
        if constexpr (requires { inner.source; }) inner.source = source;
      },
      lens.inner);
  return lens;
}

}  // namespace

bool Workspace::showsLens(int t, std::size_t n) const {
  const SourceFacts* f = factsOfTile(t);
  const PlacedLens& lens = now_.lenses[n];
  const Scene& scene = tile(t).scene;
  const bool looksIn = lens.through ? lookOf(scene) != nullptr : sliceOf(scene) != nullptr;
  return f && !f->colour && looksIn && lens.linkKey == f->linkKey && lens.modality == f->modality;
}

Scene Workspace::sceneOf(int t) const {
  Scene scene = tile(t).scene;
  const SliceLayer* slice = sliceOf(scene);
  if (!slice && lookOf(scene)) {
    for (std::size_t n = 0; n < now_.lenses.size(); ++n)
      if (showsLens(t, n)) scene.layers.emplace_back(lensInto(now_.lenses[n].layer, tile(t).source.name));
  }
  if (!slice) return scene;
  const SliceLayer around = *slice;
  for (std::size_t n = 0; n < now_.lenses.size(); ++n) {
    if (!showsLens(t, n) || !cuts(around.plane, now_.lenses[n].layer)) continue;
    LensLayer lens = now_.lenses[n].layer;
    if (auto* look = std::get_if<SliceLook>(&lens.inner)) {
      look->interpolation = around.interpolation;
      if (!look->window) look->window = around.window;
      look->invert = look->invert != around.invert;
    }
    scene.layers.emplace_back(std::move(lens));
  }
  return scene;
}

std::optional<std::size_t> Workspace::addLens(int t, PatientPoint middle, double radius_mm,
                                              const LensLook& look) {
  const SourceFacts* f = factsOfTile(t);
  const Layer* behind = layerBehindLens(tile(t).scene);
  if (!f || f->colour || !behind || !(radius_mm > 0)) return std::nullopt;
  LensLayer lens = lensAt(LensPreset::CutOut, *behind, middle, radius_mm);
  lens.inner = look.inner;
  Arrangement& a = edit(Gesture::Lens, -1);
  a.lenses.push_back({f->linkKey, f->modality, lookOf(tile(t).scene) != nullptr, look.name, std::move(lens)});
  return a.lenses.size() - 1;
}

void Workspace::changeLens(std::size_t n, const LensLayer& lens) {
  if (n >= now_.lenses.size() || now_.lenses[n].layer == lens) return;
  edit(Gesture::Lens, static_cast<int>(n)).lenses[n].layer = lens;
}

void Workspace::sizeLens(std::size_t n, double factor) {
  if (n >= now_.lenses.size()) return;
  const LensLayer lens = scaledLens(now_.lenses[n].layer, factor);
  if (lens == now_.lenses[n].layer) return;
  edit(Gesture::LensSize, static_cast<int>(n)).lenses[n].layer = lens;
}

void Workspace::setLensLook(std::size_t n, const LensLook& look) {
  if (n >= now_.lenses.size()) return;
  PlacedLens& lens = edit(Gesture::Lens, static_cast<int>(n)).lenses[n];
  lens.look = look.name, lens.layer.inner = look.inner;
}

void Workspace::removeLens(std::size_t n) {
  if (n >= now_.lenses.size()) return;
  auto& all = edit(Gesture::Lens, -1).lenses;
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(n));
}

}  // namespace vernier::ui
