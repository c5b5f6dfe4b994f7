// SPDX-License-Identifier: GPL-3.0-or-later
// Workspace: pictures side by side that are scrolled, moved and magnified together.
#include <algorithm>

#include "SceneEdits.h"
#include "Workspace.h"

namespace vernier::ui {

void Workspace::setTogether(bool on) {
  if (now_.together == on) return;
  Arrangement& a = edit(Gesture::Together, -1);
  a.together = on;
  for (int t = 0; t < kTiles; ++t) {
    const ImageLayer* image = imageOf(tile(t).scene);
    a.togetherFrom[static_cast<std::size_t>(t)] = image ? image->index : 0;
  }
}

bool Workspace::follows(int other, int t) const {
  return now_.together && other != t && !tile(other).empty() && tile(other).view == tile(t).view;
}

bool Workspace::togetherIsManual() const {
  const std::vector<int> tiles = shown();
  return std::any_of(tiles.begin(), tiles.end(),
                     [&](int t) { return follows(t, now_.active) && !linked(t, now_.active); });
}

void Workspace::follow(int t, int notches) {
  const SourceFacts* f = factsOfTile(t);
  for (const int other : shown()) {
    const SourceFacts* g = factsOfTile(other);
    if (!f || !g || !follows(other, t)) continue;
    Tile& o = at(other);
    const ImageLayer* image = imageOf(tile(t).scene);
    if (image && imageOf(o.scene)) {
      const auto& plane = f->frames[static_cast<std::size_t>(image->index)].plane;
      std::optional<std::int64_t> index;
      if (linked(other, t) && plane) index = nearestImage(*g, plane->origin);
      const auto& from = now_.togetherFrom;
      const std::int64_t offset = from[static_cast<std::size_t>(other)] - from[static_cast<std::size_t>(t)];
      std::get<ImageLayer>(o.scene.layers[0]).index = std::clamp<std::int64_t>(
          index.value_or(image->index + offset), 0, std::max<std::int64_t>(0, g->count() - 1));
    } else if (sliceOf(o.scene) && g->grid && !linked(other, t)) {  // linked planes have moved already
      o.scene = scrolledSlice(std::move(o.scene), notches, *g->grid);
    }
  }
}

}  // namespace vernier::ui
