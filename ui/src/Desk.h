// SPDX-License-Identifier: GPL-3.0-or-later
// Desk: the workspace with what feeds it, still without a window: opens inputs, posts scenes when they
// change, takes finished pictures. The window and its tests drive the same Desk.
//
// Threads: everything on one thread (the window's); `wake` is called from others when update() has work.
#pragma once
#include <set>

#include "LoadService.h"
#include "QualityCheck.h"
#include "RenderService.h"
#include "Workspace.h"
#include "vernier/measure/Measure.h"
#include "vernier/plan/CameraPicture.h"

namespace vernier::ui {

struct Document {
  int number = 0;
  std::string title;  // last part of what was opened
  std::shared_ptr<app::Session> session;
  std::map<SourceId, Picture> thumbnails;
};

// What the tile shows now.
struct TileView {
  View view;                               // size wanted, px; 0 x 0 while the tile is not on screen
  std::optional<FinishedPicture> picture;  // the newest; may be of an older scene
  std::uint64_t pictureNumber = 0;         // counts pictures, for textures
  std::optional<Place> place;              // of `picture`
  std::optional<CameraPicture> camera;     // the same of a look through a volume
};

class Desk {
 public:
  Desk(app::SessionOptions, std::function<void()> wake);

  Workspace& workspace() { return workspace_; }
  const Workspace& workspace() const { return workspace_; }

  void open(std::vector<std::string> paths);
  void close(int document);
  void openSource(const SourceId&, int tile);
  Result<void> openMpr() { return workspace_.openMpr(); }
  // The next or previous stack of the same series with as many images: time points, echoes.
  void stepTime(int tile, int notches);
  void cancelLoading() { load_.cancel(); }

  // Sizes of the tiles in framebuffer pixels; `scale` of letters, 1..3.
  void setTileSize(int tile, int width_px, int height_px);
  void setScale(double scale) { scale_ = scale; }
  // Takes what is ready and posts what changed. True when something on the screen has changed.
  bool update();
  bool idle() const;
  // Scenes handed to the renderer so far, and a wait for their drafts.
  std::uint64_t posted() const { return generation_; }
  bool waitForDrafts(std::chrono::milliseconds limit) const { return render_.waitForDrafts(limit); }
  std::uint64_t changes() const { return changes_; }  // counts updates that changed something

  const std::vector<std::unique_ptr<Document>>& documents() const { return documents_; }
  Document* document(int number);
  const Document* document(int number) const { return const_cast<Desk*>(this)->document(number); }
  const TileView& tileView(int t) const { return tiles_[static_cast<std::size_t>(t)]; }
  std::optional<LoadProgress> progress() const { return load_.progress(); }
  // Why a source's volume could not be built; nullptr while it loads or when it is there.
  const Error* volumeError(const SourceId&) const;
  bool volumeReady(const SourceId&) const;
  void retryVolume(const SourceId&);
  // Sentences for the reader, the newest last: what could not be opened and why.
  const std::vector<std::string>& messages() const { return messages_; }
  void dismissMessages() { messages_.clear(); }
  std::optional<Place> placeOfTile(int t) const;  // of the scene as it is now
  std::optional<CameraPicture> cameraOfTile(int t) const;
  // The point that is seen there: of a maximum or minimum where it lies, of renderings where half of the
  // light is gone, of surfaces the first hit. nullopt: nothing is there, or it has no depth (means and sums).
  std::optional<PatientPoint> pick(int t, glm::dvec2 px) const;
  // DeskMeasure.cpp. What a measurement says, found once for each change of it; nullptr while its volume is
  // not there.
  const Result<measure::Measured>* said(const Drawn&);
  // Of a document: why not, where measuring is switched off (no plugin); empty: it may.
  Result<void> mayMeasure(int document) const;
  // The same of lenses.
  Result<void> mayLens(int document) const;
  // All measurements of a document with what they say, as docs/measurements.md has it; whole or not at all,
  // never over what was opened. load() adds those of a file.
  Result<void> saveMeasurements(int document, const std::string& path);
  Result<void> loadMeasurements(int document, const std::string& path);
  QualityCheck& quality() { return quality_; }
  std::uint64_t picturesDrawn() const { return render_.drawn(); }

 private:
  struct Posted {
    std::uint64_t generation = 0;
    std::uint64_t since = 0;  // first generation of this source in this tile
    Scene scene;
    View view;
    SourceId source;
    double scale = 0;
  };
  bool takeReady();
  void opened(Opened);
  void postTile(int t, bool onScreen);
  void ensureKnown(const SourceId&);
  std::vector<SourceId> timePoints(const SourceId&) const;

  std::function<void()> wake_;
  Workspace workspace_;
  std::vector<std::unique_ptr<Document>> documents_;
  std::array<TileView, kTiles> tiles_;
  std::array<std::optional<Posted>, kTiles> posted_;
  std::map<SourceId, Error> volumeErrors_;
  std::set<SourceId> volumesAsked_;
  std::vector<std::string> messages_;
  std::uint64_t generation_ = 0, changes_ = 0;
  double scale_ = 1;
  struct Said {
    Drawn of;
    Result<measure::Measured> result;
  };
  std::map<std::string, Said> said_;  // by id
  std::atomic<bool> qualityChanged_ = false;
  QualityCheck quality_;
  RenderService render_;
  LoadService load_;
};

}  // namespace vernier::ui
