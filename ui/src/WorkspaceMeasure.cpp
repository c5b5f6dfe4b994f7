// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements on the desktop: edits like all others, with the same undo.
#include <algorithm>
#include <cmath>

#include "Snap.h"

namespace vernier::ui {

using measure::Spot;

const Drawn* Workspace::measurement(const std::string& id) const {
  const auto& all = now_.measurements;
  const auto it = std::find_if(all.begin(), all.end(), [&](const Drawn& d) { return d.what.id == id; });
  return it == all.end() ? nullptr : &*it;
}

std::string Workspace::addMeasurement(int document, measure::Measurement m) {
  for (int n = 1; m.id.empty() || measurement(m.id); ++n) m.id = "m" + std::to_string(n);
  Arrangement& a = edit(Gesture::Measure, -1);
  a.measurements.push_back({document, m});
  return m.id;
}

void Workspace::changeMeasurement(const measure::Measurement& m) {
  const Drawn* before = measurement(m.id);
  if (!before || before->what == m) return;
  const auto n = static_cast<std::size_t>(before - now_.measurements.data());
  edit(Gesture::Measure, -1).measurements[n].what = m;
}

void Workspace::removeMeasurement(const std::string& id) {
  if (!measurement(id)) return;
  std::erase_if(edit(Gesture::Measure, -1).measurements, [&](const Drawn& d) { return d.what.id == id; });
}

bool Workspace::canSnap(const std::string& id) const {
  const Drawn* d = measurement(id);
  const SourceFacts* f = d ? facts({d->document, d->what.on.source}) : nullptr;
  return f && f->grid && snapToAcquired(d->what, Plane{}, *f->grid);
}

void Workspace::snap(const std::string& id, int t) {
  const Drawn* d = measurement(id);
  const SourceFacts* f = d ? facts({d->document, d->what.on.source}) : nullptr;
  if (!f || !f->grid) return;
  const std::vector<Spot> points = measure::handlesOf(d->what.shape);
  const auto shows = [&](int tile) {
    const SliceLayer* slice = sliceOf(this->tile(tile).scene);
    const SourceFacts* g = factsOfTile(tile);
    return slice && g && g->linkKey == f->linkKey && std::all_of(points.begin(), points.end(), [&](auto& p) {
             return std::abs(dot(PatientPoint(p) - slice->plane.point, normalize(slice->plane.normal))) <=
                    1e-3;
           });
  };
  if (t < 0) {
    const std::vector<int> tiles = shown();
    const auto at = std::find_if(tiles.begin(), tiles.end(), shows);
    t = at == tiles.end() ? -1 : *at;
  }
  const SliceLayer* slice = t < 0 ? nullptr : sliceOf(tile(t).scene);
  const auto to = snapToAcquired(d->what, slice ? slice->plane : Plane{}, *f->grid);
  if (!to) return;
  const auto n = static_cast<std::size_t>(d - now_.measurements.data());
  PatientPoint cross = to->middle;
  if (const auto before = slice ? crosshair(t) : std::nullopt; before && to->view.empty())
    cross = *before + (to->plane.point - slice->plane.point);  // as a scroll carries it
  Arrangement& a = edit(Gesture::Measure, -1);
  a.measurements[n].what = to->moved;
  if (slice) {
    Tile& tile = at(t);
    if (!to->view.empty()) tile.view = to->view;
    for (Layer& layer : tile.scene.layers)
      if (auto* s = std::get_if<SliceLayer>(&layer)) s->plane = to->plane;
  }
  placeThrough(a, f->linkKey, cross);
}

}  // namespace vernier::ui
