// SPDX-License-Identifier: GPL-3.0-or-later
#include "Workspace.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "Looks.h"
#include "vernier/plan/Presets.h"
#include "vernier/volume/Voi.h"

namespace vernier::ui {
namespace {

constexpr std::size_t kMostSteps = 500;

// How grey is shown, whatever shows it: a window and an inversion that somebody chose outlive a change of
// view.
Scene withGreyOf(Scene scene, const Scene& shown) {
  const ImageLayer* image = imageOf(shown);
  const SliceLayer* slice = sliceOf(shown);
  if (const auto window = image ? image->window : slice ? slice->window : std::nullopt)
    scene = withWindow(std::move(scene), *window);
  return withInversion(std::move(scene), image ? image->invert : slice && slice->invert);
}

// Slices and images of a source are windowed alike, and so are looks through its volume.
bool sharesGrey(const Tile& a, const Tile& b) {
  return a.source == b.source && (lookOf(a.scene) != nullptr) == (lookOf(b.scene) != nullptr);
}

constexpr const char* kMprViews[] = {"axial", "coronal", "sagittal", "oblique"};

}  // namespace

std::vector<int> Workspace::shown() const {
  if (now_.maximised) return {*now_.maximised};
  if (now_.layout == Layout::Single) return {now_.active};
  std::vector<int> all;
  for (int t = 0; t < tilesOf(now_.layout); ++t) all.push_back(t);
  return all;
}

void Workspace::know(SourceFacts f) {
  const SourceId id = f.id;
  facts_[id] = std::make_shared<SourceFacts>(std::move(f));
}
const SourceFacts* Workspace::facts(const SourceId& id) const {
  const auto it = facts_.find(id);
  return it == facts_.end() ? nullptr : it->second.get();
}
void Workspace::knowGrid(const SourceId& id, const GridGeometry& grid) {
  if (const auto it = facts_.find(id); it != facts_.end()) it->second->grid = grid;
}

void Workspace::forget(int document) {
  std::erase_if(facts_, [&](const auto& f) { return f.first.document == document; });
  for (Tile& tile : now_.tiles)
    if (tile.source.document == document) tile = {};
  std::erase_if(now_.measurements, [&](const Drawn& d) { return d.document == document; });
  std::erase_if(now_.lenses, [&](const PlacedLens& l) {
    return std::none_of(facts_.begin(), facts_.end(),
                        [&](const auto& f) { return f.second->linkKey == l.linkKey; });
  });
  past_.clear();
  future_.clear();
  last_.reset();
}

Arrangement& Workspace::edit(Gesture kind, int t) {
  const bool gathers = dragging_ || kind == Gesture::Scroll || kind == Gesture::LensSize ||
                       kind == Gesture::WheelZoom || kind == Gesture::WheelTurn;
  const GestureKey key{dragging_ ? Gesture::Open : kind, dragging_ ? 0 : t, dragging_ ? drags_ : -1};
  if (!gathers || !last_ || *last_ != key) {
    past_.push_back(now_);
    if (past_.size() > kMostSteps) past_.erase(past_.begin());
  }
  last_ = key;
  future_.clear();
  return now_;
}

void Workspace::beginDrag() { dragging_ = true, ++drags_; }
bool Workspace::endDrag() {
  dragging_ = false;
  if (!last_ || last_->drag != drags_ || past_.empty()) return false;
  // A drag that came back to where it began is no step.
  if (!(past_.back() == now_)) return true;
  past_.pop_back();
  return false;
}

void Workspace::undo() {
  if (past_.empty()) return;
  future_.push_back(std::exchange(now_, past_.back()));
  past_.pop_back();
  last_.reset();
}
void Workspace::redo() {
  if (future_.empty()) return;
  past_.push_back(std::exchange(now_, future_.back()));
  future_.pop_back();
  last_.reset();
}

// Where the eye is, is no edit: it makes no step of undo.
void Workspace::setActive(int t) {
  if (now_.layout != Layout::Single && t >= 0 && t < tilesOf(now_.layout)) now_.active = t;
}

std::optional<Scene> Workspace::sceneFor(const SourceFacts& f, const std::string& view) const {
  if (view == "stack") return stackScene(f.id.name, f.count() / 2, {});
  if (!f.grid) return std::nullopt;
  Result<Scene> scene = presetScene(view, f.id.name, *f.grid, {});
  if (!scene) return std::nullopt;
  return std::move(*scene);
}

void Workspace::open(const SourceId& source, int t) {
  const SourceFacts* f = facts(source);
  if (!f) return;
  const std::string view = f->isVolumeFile ? "axial" : "stack";
  std::optional<Scene> scene = sceneFor(*f, view);
  if (!scene) return;
  // On an empty desk there is nothing to go back to: undo never takes away the first series.
  const bool first =
      std::all_of(now_.tiles.begin(), now_.tiles.end(), [](const Tile& x) { return x.empty(); });
  Arrangement& a = edit(Gesture::Open, t);
  if (first) past_.clear(), last_.reset();
  at(t) = {source, view, std::move(*scene)};
  a.active = t;
  if (const SliceLayer* slice = sliceOf(at(t).scene))
    a.crosshairs.try_emplace(f->linkKey, slice->plane.point);
}

void Workspace::setLayout(Layout layout) {
  if (now_.layout == layout && !now_.maximised) return;
  Arrangement& a = edit(Gesture::Layout, -1);
  a.layout = layout;
  a.maximised.reset();
  // The active tile stays in sight, with its neighbours as they are.
  if (layout != Layout::Single && a.active >= tilesOf(layout)) {
    std::swap(a.tiles[0], a.tiles[static_cast<std::size_t>(a.active)]);
    a.active = 0;
  }
}

void Workspace::openStack() {
  const SourceFacts* f = factsOfTile(now_.active);
  if (!f || f->isVolumeFile || tile(now_.active).view == "stack") return setLayout(Layout::Single);
  Scene scene = stackScene(f->id.name, f->count() / 2, {});
  if (const auto p = crosshair(now_.active))
    std::get<ImageLayer>(scene.layers[0]).index = nearestImage(*f, *p).value_or(f->count() / 2);
  scene = withGreyOf(std::move(scene), tile(now_.active).scene);
  Arrangement& a = edit(Gesture::Layout, -1);
  a.layout = Layout::Single;
  a.maximised.reset();
  at(a.active) = {f->id, "stack", std::move(scene)};
}

// Where the middle slices meet, or the crosshair as it was; in the image that is shown.
PatientPoint Workspace::firstCrosshair(const SourceFacts& f, const Scene& shown) const {
  PatientPoint p = f.grid->centre();
  if (const auto it = now_.crosshairs.find(f.linkKey); it != now_.crosshairs.end()) {
    p = it->second;
  } else {
    for (const char* view : {"axial", "coronal", "sagittal"})
      if (const std::optional<Scene> scene = sceneFor(f, view)) {
        const Plane& plane = sliceOf(*scene)->plane;
        const PatientVec n = normalize(plane.normal);
        p = p + dot(plane.point - p, n) * n;
      }
  }
  const ImageLayer* image = imageOf(shown);
  if (!image || image->index < 0 || image->index >= f.count()) return p;
  const auto& plane = f.frames[static_cast<std::size_t>(image->index)].plane;
  if (!plane) return p;
  const PatientVec n = normalize(cross(plane->rowDirection, plane->columnDirection));
  return p + dot(plane->origin - p, n) * n;
}

Result<void> Workspace::openMpr() {
  const Result<const SourceFacts*> fit = fitFor3d();
  if (!fit) return fit.error();
  const SourceFacts* f = *fit;
  const Scene shown = shownGrey();
  const PatientPoint p = firstCrosshair(*f, shown);
  Arrangement& a = edit(Gesture::Layout, -1);
  a.layout = Layout::Quad;
  a.maximised.reset();
  a.active = 0;
  for (int t = 0; t < kTiles; ++t) {
    std::optional<Scene> scene = sceneFor(*f, kMprViews[t]);
    if (!scene) continue;
    at(t) = {f->id, kMprViews[t], withGreyOf(std::move(*scene), shown)};
  }
  placeThrough(a, f->linkKey, p);
  return {};
}

void Workspace::replaceSource(int t, const SourceId& source) {
  const SourceFacts* f = facts(source);
  if (!f || tile(t).empty() || tile(t).source == source) return;
  edit(Gesture::Scroll, t);
  at(t).source = source;
  at(t).scene = withSource(std::move(at(t).scene), source.name);
  for (Layer& layer : at(t).scene.layers)
    if (auto* image = std::get_if<ImageLayer>(&layer))
      image->index = std::clamp<std::int64_t>(image->index, 0, std::max<std::int64_t>(0, f->count() - 1));
}

void Workspace::toggleMaximised(int t) {
  if (now_.layout == Layout::Single) return;
  Arrangement& a = edit(Gesture::Layout, -1);
  if (a.maximised)
    a.maximised.reset();
  else
    a.maximised = t, a.active = t;
}

void Workspace::scroll(int t, int notches) {
  const SourceFacts* f = factsOfTile(t);
  if (!f || notches == 0) return;
  Scene scene = tile(t).scene;
  if (imageOf(scene)) {
    scene = scrolledImage(std::move(scene), notches, f->count());
    if (scene == tile(t).scene) return;
    edit(Gesture::Scroll, t), at(t).scene = std::move(scene);
    return follow(t, notches);
  }
  const SliceLayer* before = sliceOf(scene);
  if (!before || !f->grid) return;
  scene = scrolledSlice(std::move(scene), notches, *f->grid);
  if (scene == tile(t).scene) return;
  const PatientVec moved = sliceOf(scene)->plane.point - sliceOf(tile(t).scene)->plane.point;
  Arrangement& a = edit(Gesture::Scroll, t);
  at(t).scene = std::move(scene);
  if (const auto it = a.crosshairs.find(f->linkKey); it != a.crosshairs.end())
    placeThrough(a, f->linkKey, it->second + moved);
  follow(t, notches);
}

void Workspace::setImage(int t, std::int64_t index) {
  if (const ImageLayer* image = imageOf(tile(t).scene)) scroll(t, static_cast<int>(index - image->index));
}

void Workspace::setWindow(int t, const VoiWindow& window) { choose(t, {"", window, {}}); }

void Workspace::choose(int t, const WindowChoice& choice) {
  if (tile(t).empty()) return;
  edit(Gesture::Window, t);
  for (Tile& tile : now_.tiles) {
    if (!sharesGrey(tile, this->tile(t))) continue;
    for (Layer& layer : tile.scene.layers) {
      if (auto* window = windowOf(layer)) *window = choice.window;
      if (auto* image = std::get_if<ImageLayer>(&layer)) image->voiLut = choice.voiLut;
    }
  }
}

void Workspace::invert(int t) {
  const auto inverts = [](Layer layer) { return inversionOf(layer) != nullptr; };
  const auto& layers = tile(t).scene.layers;
  if (std::none_of(layers.begin(), layers.end(), inverts)) return;
  edit(Gesture::Invert, t);
  for (Tile& tile : now_.tiles) {
    if (!sharesGrey(tile, this->tile(t))) continue;
    for (Layer& layer : tile.scene.layers)
      if (bool* inverted = inversionOf(layer)) *inverted = !*inverted;
  }
}

void Workspace::resetView(int t, double aspect) {
  const SourceFacts* f = factsOfTile(t);
  if (!f) return;
  Scene scene = tile(t).scene;
  const std::optional<Scene> fresh =
      lookOf(scene) ? sceneOfLook({"", tile(t).view, ""}, *f) : sceneFor(*f, tile(t).view);
  scene.camera = fresh ? fresh->camera : Camera{};
  if (lookOf(scene)) scene.camera.zoom = std::clamp(aspect, 0.1, 1.0);
  if (scene == tile(t).scene) return;
  edit(Gesture::Reset, t);
  at(t).scene = std::move(scene);
}

void Workspace::setScene(int t, Gesture kind, Scene scene) {
  if (scene == tile(t).scene) return;
  edit(kind, t);
  at(t).scene = std::move(scene);
  if (kind == Gesture::Pan || kind == Gesture::Zoom || kind == Gesture::Turn || kind == Gesture::WheelZoom ||
      kind == Gesture::WheelTurn)
    for (const int other : shown())
      if (follows(other, t)) at(other).scene.camera = tile(t).scene.camera;
}

void Workspace::placeThrough(Arrangement& a, const std::string& key, PatientPoint p) {
  a.crosshairs[key] = p;
  for (Tile& tile : a.tiles) {
    const SourceFacts* f = facts(tile.source);
    if (!f || f->linkKey != key) continue;
    for (Layer& layer : tile.scene.layers)
      if (auto* slice = std::get_if<SliceLayer>(&layer)) slice->plane = through(slice->plane, p);
  }
}

void Workspace::moveCrosshair(int t, PatientPoint p) {
  const SourceFacts* f = factsOfTile(t);
  if (!f) return;
  Arrangement& a = edit(Gesture::Crosshair, t);
  placeThrough(a, f->linkKey, p);
  for (int other = 0; other < kTiles; ++other) {
    const SourceFacts* g = factsOfTile(other);
    if (other == t || !g || g->linkKey != f->linkKey) continue;
    for (Layer& layer : at(other).scene.layers) {
      auto* image = std::get_if<ImageLayer>(&layer);
      if (!image) continue;
      image->index = nearestImage(*g, p).value_or(image->index);
    }
  }
}

std::optional<PatientPoint> Workspace::crosshair(int t) const {
  const SourceFacts* f = factsOfTile(t);
  const auto it = f ? now_.crosshairs.find(f->linkKey) : now_.crosshairs.end();
  if (it == now_.crosshairs.end()) return std::nullopt;
  return it->second;
}

bool Workspace::linked(int a, int b) const {
  const SourceFacts* f = factsOfTile(a);
  const SourceFacts* g = factsOfTile(b);
  return f && g && f->linkKey == g->linkKey;
}

bool Workspace::differentPeople() const {
  const SourceFacts* first = nullptr;
  for (int t : shown()) {
    const SourceFacts* f = factsOfTile(t);
    if (!f) continue;
    if (first && first->personKey != f->personKey) return true;
    first = f;
  }
  return false;
}

bool Workspace::differentPeopleOfOneId() const {
  std::set<std::string> ids;
  for (int t : shown())
    if (const SourceFacts* f = factsOfTile(t)) ids.insert(f->idKey);
  return differentPeople() && ids.size() == 1 && !ids.begin()->empty();
}

std::vector<WindowChoice> windowChoices(const WindowFacts& f) {
  std::vector<WindowChoice> out;
  const auto preset = [&](const char* name, double center, double width) {
    out.push_back({name, VoiWindow{center, width, VoiFunction::Linear, name}, {}});
  };
  if (f.unit == "HU") {
    preset("Brain", 40, 80);
    preset("Subdural", 75, 215);
    preset("Lung", -600, 1500);
    preset("Bone", 400, 1800);
    preset("Abdomen", 50, 400);
    preset("Mediastinum", 50, 350);
    preset("Liver", 100, 150);
    preset("Stroke", 35, 40);
  }
  int number = 0;
  for (const VoiWindow& w : f.windows) {
    ++number;
    out.push_back({w.explanation.empty() ? "File window " + std::to_string(number) : w.explanation, w, {}});
  }
  number = 0;
  for (const LutTable& lut : f.voiLuts) {
    out.push_back(
        {lut.explanation.empty() ? "File LUT " + std::to_string(number + 1) : lut.explanation, {}, number});
    ++number;
  }
  if (usableWindow(f.automatic)) out.push_back({"Automatic", f.automatic, {}});
  if (f.range && f.range->second > f.range->first)
    out.push_back({"Full range",
                   VoiWindow{0.5 * (f.range->first + f.range->second), f.range->second - f.range->first,
                             VoiFunction::LinearExact, "full range"},
                   {}});
  return out;
}

}  // namespace vernier::ui
