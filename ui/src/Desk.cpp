// SPDX-License-Identifier: GPL-3.0-or-later
#include "Desk.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace vernier::ui {
namespace {

std::string lastPart(const std::string& path) {
  std::filesystem::path p = std::filesystem::path(path).lexically_normal();
  if (p.filename().empty()) p = p.parent_path();
  const std::string name = p.filename().string();
  return name.empty() ? path : name;
}

}  // namespace

Desk::Desk(app::SessionOptions options, std::function<void()> wake)
    : wake_(std::move(wake)),
      quality_([this] {
        qualityChanged_ = true;
        wake_();
      }),
      render_(wake_),
      load_(std::move(options), wake_) {}

void Desk::open(std::vector<std::string> paths) {
  if (!paths.empty()) load_.open(std::move(paths));
}

Document* Desk::document(int number) {
  for (const auto& d : documents_)
    if (d->number == number) return d.get();
  return nullptr;
}

void Desk::close(int number) {
  load_.forget(number);
  workspace_.forget(number);
  std::erase_if(documents_, [&](const auto& d) { return d->number == number; });
  std::erase_if(volumesAsked_, [&](const SourceId& s) { return s.document == number; });
  std::erase_if(volumeErrors_, [&](const auto& e) { return e.first.document == number; });
}

void Desk::ensureKnown(const SourceId& id) {
  Document* d = document(id.document);
  if (!d || workspace_.facts(id)) return;
  const auto choice = d->session->choose(id.name);
  if (!choice) return;
  if (choice->volumeFile)
    workspace_.know(factsOfVolumeFile(*d->session, *choice, id.document));
  else
    workspace_.know(factsOf(*d->session, *choice, id.document));
}

void Desk::openSource(const SourceId& id, int tile) {
  ensureKnown(id);
  workspace_.open(id, tile);
  const SourceFacts* f = workspace_.facts(id);
  if (f && f->grid && !volumeReady(id)) retryVolume(id);  // so that MPR is there when it is asked for
}

std::vector<SourceId> Desk::timePoints(const SourceId& id) const {
  const Document* d = document(id.document);
  const auto choice =
      d ? d->session->choose(id.name) : Result<app::StackChoice>(makeError(ErrorCode::SeriesNotFound, ""));
  if (!choice || choice->volumeFile) return {};
  const Series& series = *d->session->seriesOf(*choice);
  const std::size_t count = series.stacks[choice->stack].slices.size();
  std::vector<SourceId> all;
  for (std::size_t k = 0; k < series.stacks.size(); ++k)
    if (series.stacks[k].slices.size() == count)
      all.push_back({id.document, d->session->sourceName({choice->series, k})});
  return all;
}

void Desk::stepTime(int tile, int notches) {
  const SourceId now = workspace_.tile(tile).source;
  const std::vector<SourceId> all = timePoints(now);
  const auto at = std::find(all.begin(), all.end(), now);
  if (at == all.end()) return;
  const auto last = static_cast<std::ptrdiff_t>(all.size()) - 1;
  const SourceId& next =
      all[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at - all.begin() + notches, 0, last))];
  ensureKnown(next);
  workspace_.replaceSource(tile, next);
}

void Desk::retryVolume(const SourceId& id) {
  Document* d = document(id.document);
  if (!d) return;
  volumeErrors_.erase(id);
  volumesAsked_.insert(id);
  load_.build(id, d->session);
}

bool Desk::volumeReady(const SourceId& id) const {
  for (const auto& d : documents_)
    if (d->number == id.document) return d->session->readyVolume(id.name) != nullptr;
  return false;
}
const Error* Desk::volumeError(const SourceId& id) const {
  const auto it = volumeErrors_.find(id);
  return it == volumeErrors_.end() ? nullptr : &it->second;
}

void Desk::setTileSize(int tile, int width, int height) {
  View& v = tiles_[static_cast<std::size_t>(tile)].view;
  v.width_px = std::max(0, width), v.height_px = std::max(0, height);
}

std::optional<Place> Desk::placeOfTile(int t) const {
  const SourceFacts* f = workspace_.factsOfTile(t);
  const View& view = tileView(t).view;
  if (!f || view.width_px < 1 || view.height_px < 1) return std::nullopt;
  return placeOf(workspace_.tile(t).scene, *f, f->grid ? &*f->grid : nullptr, view);
}

namespace {

std::optional<CameraPicture> cameraOf(const Scene& scene, const SourceFacts& facts, const View& view) {
  if (!lookOf(scene) || !facts.grid || view.width_px < 1 || view.height_px < 1) return std::nullopt;
  const Result<CameraPicture> camera = cameraPicture(scene.camera, view, cameraBox(*facts.grid));
  if (!camera) return std::nullopt;
  return *camera;
}

}  // namespace

std::optional<CameraPicture> Desk::cameraOfTile(int t) const {
  const SourceFacts* f = workspace_.factsOfTile(t);
  return f ? cameraOf(workspace_.tile(t).scene, *f, tileView(t).view) : std::nullopt;
}

std::optional<PatientPoint> Desk::pick(int t, glm::dvec2 px) const {
  const TileView& shown = tileView(t);
  if (!shown.picture || !shown.camera) return std::nullopt;
  const Layer* look = lookOf(shown.picture->scene);
  const auto* projection = look ? std::get_if<ProjectionLayer>(look) : nullptr;
  if (projection && projection->mode != ProjectionMode::Max && projection->mode != ProjectionMode::Min)
    return std::nullopt;
  const Depths& d = shown.picture->depths;
  const View& view = shown.picture->view;
  const glm::dvec2 middle(0.5 * view.width_px, 0.5 * view.height_px), small(0.5 * d.width, 0.5 * d.height);
  const glm::dvec2 at = glm::floor((px - middle) / d.perPixel + small);
  if (!(at.x >= 0 && at.y >= 0 && at.x < d.width && at.y < d.height)) return std::nullopt;
  const std::size_t n =
      static_cast<std::size_t>(at.y) * static_cast<std::size_t>(d.width) + static_cast<std::size_t>(at.x);
  const double depth = d.depth_mm[n];
  if (!std::isfinite(depth)) return std::nullopt;
  const glm::dvec2 centre = (at + 0.5 - small) * d.perPixel + middle;
  return shown.camera->ray(centre.x, centre.y).at(depth);
}

void Desk::opened(Opened o) {
  const std::string title =
      o.paths.size() == 1 ? lastPart(o.paths[0])
                          : lastPart(o.paths[0]) + " and " + std::to_string(o.paths.size() - 1) + " more";
  if (o.error) {
    if (o.error->code != ErrorCode::Cancelled) messages_.push_back(title + ": " + o.error->sentence);
    return;
  }
  auto d = std::make_unique<Document>(Document{o.document, title, o.session, {}});
  documents_.push_back(std::move(d));
  const auto& series = o.session->study().series;
  for (std::size_t s = 0; s < series.size(); ++s)
    for (std::size_t k = 0; k < series[s].stacks.size(); ++k)
      load_.thumbnail({o.document, o.session->sourceName({s, k})}, o.session);
  const auto best = o.session->choose("");
  if (!best) {
    messages_.push_back(title + ": " + best.error().sentence);
    return;
  }
  openSource({o.document, o.session->sourceName(*best)}, workspace_.now().active);
}

bool Desk::takeReady() {
  bool changed = false;
  LoadService::Ready ready = load_.take();
  for (Opened& o : ready.opened) opened(std::move(o)), changed = true;
  for (BuiltVolume& b : ready.volumes) {
    changed = true;
    volumesAsked_.erase(b.source);
    if (b.error)
      volumeErrors_[b.source] = *b.error;
    else
      workspace_.knowGrid(b.source, b.volume->grid());
    // Of a volume file the thumbnail waits for the volume: it is never read for the thumbnail alone.
    Document* d = document(b.source.document);
    const SourceFacts* f = workspace_.facts(b.source);
    if (d && f && f->isVolumeFile && !b.error && !d->thumbnails.contains(b.source))
      load_.thumbnail(b.source, d->session);
  }
  for (Thumbnail& t : ready.thumbnails) {
    changed = true;
    if (Document* d = document(t.source.document)) d->thumbnails[t.source] = std::move(t.rgba);
  }
  for (FinishedPicture& p : render_.take()) {
    changed = true;
    TileView& tile = tiles_[static_cast<std::size_t>(p.tile)];
    const auto& posted = posted_[static_cast<std::size_t>(p.tile)];
    if (!posted || p.generation < posted->since) continue;  // of what the tile showed before
    const SourceFacts* f = workspace_.facts(posted->source);
    tile.place.reset();
    tile.camera.reset();
    if (f) tile.place = placeOf(p.scene, *f, f->grid ? &*f->grid : nullptr, p.view);
    if (f) tile.camera = cameraOf(p.scene, *f, p.view);
    tile.picture = std::move(p);
    ++tile.pictureNumber;
  }
  return changed;
}

void Desk::postTile(int t, bool onScreen) {
  const Tile& tile = workspace_.tile(t);
  TileView& shown = tiles_[static_cast<std::size_t>(t)];
  auto& posted = posted_[static_cast<std::size_t>(t)];
  Document* d = document(tile.source.document);
  const bool changedSource = posted && !(posted->source == tile.source);
  if (tile.empty() || !d || changedSource) {
    if (posted) {
      render_.forget(t);
      posted.reset();
      shown.picture.reset();
      shown.place.reset();
      shown.camera.reset();
    }
    if (tile.empty() || !d) return;
  }
  if (!onScreen || shown.view.width_px < 1 || shown.view.height_px < 1) return;
  if (needsVolume(tile.scene) && !d->session->readyVolume(tile.source.name)) {
    if (!volumeError(tile.source) && !volumesAsked_.contains(tile.source)) retryVolume(tile.source);
    if (posted && !needsVolume(posted->scene)) render_.forget(t), posted.reset(), shown.picture.reset();
    return;
  }
  Scene scene = workspace_.sceneOf(t);
  const bool same = posted && posted->scene == scene && posted->scale == scale_ &&
                    posted->view.width_px == shown.view.width_px &&
                    posted->view.height_px == shown.view.height_px;
  if (same) return;
  const std::uint64_t since = posted ? posted->since : generation_ + 1;
  posted = Posted{++generation_, since, scene, shown.view, tile.source, scale_};
  render_.post({t, posted->generation, d->session, std::move(scene), shown.view, scale_});
}

bool Desk::update() {
  const bool changed = takeReady() | qualityChanged_.exchange(false);
  changes_ += changed ? 1 : 0;
  const std::vector<int> shown = workspace_.shown();
  // The tile under the hand first.
  std::vector<int> order{workspace_.now().active};
  for (int t = 0; t < kTiles; ++t)
    if (t != order.front()) order.push_back(t);
  for (int t : order) postTile(t, std::find(shown.begin(), shown.end(), t) != shown.end());
  return changed;
}

bool Desk::idle() const { return load_.idle() && render_.idle(); }

}  // namespace vernier::ui
