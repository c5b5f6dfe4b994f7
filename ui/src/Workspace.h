// SPDX-License-Identifier: GPL-3.0-or-later
// Workspace: what is on the desktop, and every edit of it. Tiles show scenes of sources; edits change the
// scenes and nothing else. Pure state: no window, no thread, no pixels. For one thread.
//
// Undo: each edit that is not of the same gesture as the one before it begins a step; a drag is one gesture,
// notches one after the other on one tile are one gesture.
#pragma once
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Place.h"
#include "vernier/measure/Measurement.h"

namespace vernier::ui {

inline constexpr int kTiles = 4;
enum class Layout { Single, Pair, Quad };
constexpr int tilesOf(Layout l) { return l == Layout::Single ? 1 : l == Layout::Pair ? 2 : 4; }

struct Tile {
  SourceId source;   // document -1: empty
  std::string view;  // "stack", "axial", "coronal", "sagittal", "oblique"; through a volume: Looks.h
  Scene scene;
  bool empty() const { return source.document < 0; }
  friend bool operator==(const Tile&, const Tile&) = default;
};

// A measurement upon what a document has open.
struct Drawn {
  int document = -1;
  measure::Measurement what;
  friend bool operator==(const Drawn&, const Drawn&) = default;
};

// A lens in the patient, shown in all slices of this frame of reference and modality, or in all looks through
// such a volume. Its inner look as it was chosen; on slices a window that is absent is that of the slice, and
// `invert` means: other than the slice.
struct PlacedLens {
  std::string linkKey, modality;
  bool through = false;  // a volume
  std::string look;      // for the screen
  LensLayer layer;
  friend bool operator==(const PlacedLens&, const PlacedLens&) = default;
};
struct LensLook;    // Lenses.h
struct VolumeLook;  // Looks.h

// All that undo brings back.
struct Arrangement {
  Layout layout = Layout::Single;
  std::array<Tile, kTiles> tiles;
  int active = 0;
  std::optional<int> maximised;
  // Where the linked planes cross, one for each link key.
  std::map<std::string, PatientPoint> crosshairs;
  bool together = false;  // pictures of one view are scrolled, moved and magnified together
  // The image that each tile showed when that began: the offset between stacks that share no coordinates.
  std::array<std::int64_t, kTiles> togetherFrom{};
  std::vector<Drawn> measurements;  // in the order of their making; ids are unique
  std::vector<PlacedLens> lenses;   // the later one wins where they overlap
  friend bool operator==(const Arrangement&, const Arrangement&) = default;
};

enum class Gesture {
  Together,
  Open,
  Layout,
  Scroll,
  Window,
  Pan,
  Zoom,
  Turn,
  WheelZoom,  // and by keys: one after the other they are one step of undo
  WheelTurn,
  Look,
  Crosshair,
  Reset,
  Invert,
  Measure,
  Lens,
  LensSize
};

// A window to choose: of the file, of the list of CT presets, automatic.
struct WindowChoice {
  std::string name;
  std::optional<VoiWindow> window;  // absent: the file's default
  std::optional<int> voiLut;
};

class Workspace {
 public:
  const Arrangement& now() const { return now_; }
  const Tile& tile(int t) const { return now_.tiles[static_cast<std::size_t>(t)]; }
  // Tiles on the screen, in reading order.
  std::vector<int> shown() const;

  // What is known of sources; facts come before the first tile that shows them.
  void know(SourceFacts);
  const SourceFacts* facts(const SourceId&) const;
  const SourceFacts* factsOfTile(int t) const { return facts(tile(t).source); }
  // The grid of a built volume (slices that could not be decoded are not in it) replaces the stack's.
  void knowGrid(const SourceId&, const GridGeometry&);
  // Forgets what was opened from a document: its tiles become empty and the steps of undo are gone.
  void forget(int document);

  void setActive(int t);
  // The stack view of a source at its middle slice; a volume file opens as axial. On an empty desk this is no
  // step of undo.
  void open(const SourceId&, int t);
  void setLayout(Layout);
  // One tile with the stack of the active tile's source, at the image nearest to the crosshair when it showed
  // reformats.
  void openStack();
  // 2x2 with axial, coronal, sagittal and oblique of the active tile's source, through the crosshair and the
  // image that was shown. A refusal says why not.
  Result<void> openMpr();
  // WorkspaceLooks.cpp. 2x2 with axial, coronal, sagittal (as they are, where they are shown already) and a
  // look through the volume, which becomes active; of two pictures side by side the active one becomes such a
  // look. A refusal says why not.
  Result<void> open3d();
  // A tile of a volume shows this look; the camera stays, and window and inversion where both looks have
  // them.
  void setLook(int t, const VolumeLook&);
  // Another stack of the same layout (the next time point) in place of the tile's, all else as it is.
  void replaceSource(int t, const SourceId&);
  void toggleMaximised(int t);

  void scroll(int t, int notches);
  void setImage(int t, std::int64_t index);
  // To all tiles of the same source: slices and images, or looks through its volume, as this tile is.
  void setWindow(int t, const VoiWindow&);
  void choose(int t, const WindowChoice&);
  void invert(int t);
  void resetView(int t, double aspect = 1);  // of the tile, width / height: looks fit narrow ones, too
  // Scenes made from the one at the drag's begin.
  void setScene(int t, Gesture, Scene);
  // Moves the planes of all tiles that share the frame of reference through the point; stacks go to the
  // nearest of their images.
  void moveCrosshair(int t, PatientPoint);
  std::optional<PatientPoint> crosshair(int t) const;
  bool linked(int a, int b) const;

  // What is done to one of the shown pictures is done to the others of the same view: images follow by their
  // place where both lie in one frame of reference, else by the offset that they have now, which is the
  // user's act ("manual").
  void setTogether(bool);
  bool togetherIsManual() const;

  // Gives it an id of its own where it has none or one that is taken; returns the id. WorkspaceMeasure.cpp.
  std::string addMeasurement(int document, measure::Measurement);
  void changeMeasurement(const measure::Measurement&);  // the one of this id
  void removeMeasurement(const std::string& id);
  const Drawn* measurement(const std::string& id) const;  // nullptr: none
  // Of a region that lies on no acquired slice, where the nearest one is (Snap.h): whether there is one, and
  // the move: the region goes there, and tile t's picture with it (-1: that of the tile that shows it); one
  // step of undo. Linked pictures follow.
  bool canSnap(const std::string& id) const;
  void snap(const std::string& id, int t = -1);

  // WorkspaceLens.cpp. The tile's scene with the lenses that show in it, as it is drawn.
  Scene sceneOf(int t) const;
  bool showsLens(int t, std::size_t lens) const;
  // A sphere about the point; nullopt where the tile shows single images, or colours. Its place in
  // Arrangement::lenses.
  std::optional<std::size_t> addLens(int t, PatientPoint middle, double radius_mm, const LensLook&);
  void changeLens(std::size_t lens, const LensLayer&);
  void sizeLens(std::size_t lens, double factor);  // notches one after the other are one step of undo
  void setLensLook(std::size_t lens, const LensLook&);
  void removeLens(std::size_t lens);

  // Everything until endDrag() is one step of undo; false when it made none.
  void beginDrag();
  bool endDrag();
  bool canUndo() const { return !past_.empty(); }
  bool canRedo() const { return !future_.empty(); }
  void undo();
  void redo();

  // True while two shown tiles are of different people.
  bool differentPeople() const;
  // ... and all of them have one Patient ID: birth date or sex tell them apart.
  bool differentPeopleOfOneId() const;

 private:
  Arrangement& edit(Gesture, int t);
  Tile& at(int t) { return now_.tiles[static_cast<std::size_t>(t)]; }
  Result<const SourceFacts*> fitFor3d() const;
  Scene shownGrey() const;
  void placeThrough(Arrangement&, const std::string& linkKey, PatientPoint);
  bool follows(int other, int t) const;
  void follow(int t, int notches);
  std::optional<Scene> sceneFor(const SourceFacts&, const std::string& view) const;
  PatientPoint firstCrosshair(const SourceFacts&, const Scene& shown) const;

  struct GestureKey {
    Gesture kind;
    int tile;
    int drag;
    friend bool operator==(const GestureKey&, const GestureKey&) = default;
  };
  Arrangement now_;
  std::vector<Arrangement> past_, future_;
  std::optional<GestureKey> last_;
  int drags_ = 0;
  bool dragging_ = false;
  std::map<SourceId, std::shared_ptr<SourceFacts>> facts_;
};

// The keys 1..9 and the menu: CT presets for HU, else the file's windows and LUTs, automatic, full range.
struct WindowFacts {
  std::string unit;
  std::vector<VoiWindow> windows;
  std::vector<LutTable> voiLuts;
  VoiWindow automatic;
  std::optional<std::pair<double, double>> range;  // least and greatest modality value
};
std::vector<WindowChoice> windowChoices(const WindowFacts&);

}  // namespace vernier::ui
