// SPDX-License-Identifier: GPL-3.0-or-later
// Gui: what the window shows, drawn from the Desk each frame, and what hands do to it. Knows ImGui, not GLFW:
// the Host feeds input and shows the result.
#pragma once
#include <string>

#include "Desk.h"
#include "Handles.h"
#include "Lenses.h"
#include "Textures.h"
#include "Theme.h"

namespace vernier::ui {

enum class Tool { Window, Crosshair, Pan, Zoom, Scroll, Turn };  // Turn: of looks through a volume only

class Gui {
 public:
  Gui(Desk& desk, Textures& textures) : desk_(desk), textures_(textures) {}
  void setTheme(Theme theme) { theme_ = theme; }

  // Between ImGui::NewFrame() and ImGui::Render().
  void frame();

  // Where the pointer went since the last frame (Input.h).
  void setWay(std::vector<std::pair<double, double>> way) { way_ = std::move(way); }

  void showNotice(std::function<std::string()> accepted) {
    noticeAccepted_ = std::move(accepted), notice_ = true;
  }
  bool wantsToQuit() const { return quit_; }
  Tool tool() const { return tool_; }
  std::optional<Ruler> ruler() const { return ruler_; }  // a measuring tool that waits for its points
  // Why the last thing asked for could not be had; "" when it could.
  const std::string& why() const { return why_; }

 private:
  struct Rect {
    float x = 0, y = 0, w = 0, h = 0;
  };
  struct Drag {
    int tile = -1;
    int button = 0;
    Tool tool = Tool::Window;
    ImVec2 begin{};
    Scene scene;
    VoiWindow window;
    bool inverted = false;
    double unit_mm = 1;
    glm::dvec2 fromCentre_px{0, 0};
    int scrolled = 0;
    TransferFunction transfer;  // of a rendering that is dragged like a window
  };

  // Gui.cpp
  void keys();
  void topBar(Rect, bool twoRows);
  void layoutButtons();
  void toolButtons();
  void windowMenu();
  void viewButtons();
  void historyButtons();
  bool toggle(const char* label, bool on, const char* hint);
  void statusBar(Rect);
  // TilePanel.cpp
  void tiles(Rect);
  void tile(int t, Rect);
  void tileHeader(int t, Rect);
  void picture(int t, Rect);
  void compared(int t, Rect);
  bool mayLayOver();
  void references(int t, Rect);
  void emptyTile(Rect);
  void volumeState(int t, Rect);
  void sentence(Rect, const char* headline, const std::string& text, ImU32 headlineColour);
  void hands(int t, Rect, bool hovered);
  void beginDrag(int t, int button, Rect);
  void drag();
  void hoverDetails(int t, Rect);
  void probe(int t, Rect);
  // LookTools.cpp
  double aspectOf(int t) const;
  void invert(int t);
  bool lookMenu();  // false: the active tile is no look through a volume
  bool lookKeys();
  void lookWheel(int t, Rect, float notches);
  bool beginLookDrag(int t, Drag&);  // false: there is nothing to drag
  void dragLook(const Drag&, glm::dvec2 way);
  void moveCrosshairTo(int t, glm::dvec2 px);
  void probeLook(int t, glm::dvec2 px);
  void crosshairInLook(int t, Rect);
  // Sketching.cpp
  void takeRuler(std::optional<Ruler>);
  void measureKeys();
  bool measureHands(int t, Rect, bool hovered);  // true: the click is theirs
  bool sketchClick(int t, Rect);
  void sketchMotion(int t, Rect);
  bool beginSketch(int t);
  glm::dvec2 guided(const Place&, glm::dvec2 px) const;
  void addSpot(const Place&, glm::dvec2 px);
  void closeSketch();
  void finishSketch(const Place&);
  void writing();
  // MeasureTools.cpp
  struct Grip {  // a handle in the hand
    std::string id;
    std::size_t handle = 0;
    int tile = -1;
  };
  void measureMenu();
  bool gripHands(int t, Rect, bool clicked);
  void dragHandle();
  void measurements(int t, Rect);
  void sketch(int t, Rect);
  void offerSnap(const Drawn&, int t, Rect);
  void drawMeasurement(const measure::Measurement&, const Place&, Rect, bool selected,
                       const std::string& label);
  Rect freeOfLabels(Rect below, Rect above, Rect left) const;
  std::optional<Grip> gripAt(int t, Rect) const;
  glm::dvec2 pixelUnderPointer(Rect) const;
  // LensTools.cpp
  struct LensHold {  // a lens in the hand
    std::size_t lens = 0;
    int tile = -1;
    LensPart part = LensPart::Inside;
    ImVec2 begin{};
    LensLayer before;
    double radius_px = 0;
  };
  std::optional<int> tileUnderPointer() const;
  std::optional<Place> placeOfLens(int t, const LensLayer&) const;
  std::optional<LensHold> lensAt(int t, glm::dvec2 px) const;
  void lensKey();
  void putLens(int t, glm::dvec2 px);
  bool removeChosenLens();
  bool lensWheel(int t, Rect, int notches);
  bool lensHands(int t, Rect, bool hovered);
  void dragLens();
  void lenses(int t, Rect);
  // MeasurePanel.cpp
  void measureList(Rect);
  void measureRow(const Drawn&, int number);
  void measureWords(const Drawn&);
  void measureFile();
  // BrowserPanel.cpp
  void browser(Rect);
  void openField();
  void document(Document&);
  void objects(const StudySet&, const Series&);
  void volumeFiles(Document&);
  void stackRow(Document&, const Series&, const Stack&, const SourceId&, const std::string& title,
                const std::string& about);
  void badge(const std::vector<const Finding*>&, ImVec2 at);
  // Dialogs.cpp
  void help();
  void notice();
  void messages(Rect);
  // QualityPanel.cpp
  void helpMenu(ImVec2 corner);  // its upper right one
  void quality();
  void qualityResult(const QualityState&);

  Desk& desk_;
  Textures& textures_;
  Theme theme_;
  Tool tool_ = Tool::Window;
  std::optional<Drag> drag_;
  bool clickMadeStep_ = false;  // the last click, without a move, was a step of undo
  bool wipe_ = false;           // of the two pictures side by side
  float wipeAt_ = 0.5f;         // share of the width
  float wheel_ = 0;             // parts of a notch
  Probe probe_;
  std::string why_;
  std::optional<Ruler> ruler_;
  struct Sketch {  // what the ruler has taken
    int tile = -1;
    measure::Placement on;
    std::vector<measure::Spot> spots;
    ImVec2 pressed{};
    bool held = false;
  };
  std::optional<Sketch> sketch_;
  struct Writing {  // the words of a text, while they are typed
    int document = -1;
    measure::Measurement what;
    ImVec2 at{};
    bool fresh = true;
    char words[200] = "";
  };
  std::optional<Writing> writing_;
  struct Offer {  // to go to the nearest acquired slice, as drawn last
    std::string id;
    int tile = -1;
    Rect box;
  };
  std::optional<Offer> offer_;
  Rect labelBox_;             // of the measurement drawn last
  std::vector<Rect> labels_;  // of the picture that is being drawn
  std::vector<std::pair<double, double>> way_;
  std::optional<Grip> grip_;
  std::array<Rect, kTiles> tileArea_{};  // of the pictures, as drawn last
  // Chosen, for Del: a measurement by its id, or else a lens.
  std::string selected_;
  std::optional<std::size_t> lens_;
  std::optional<LensHold> lensHold_;
  bool listShown_ = false;
  std::string wordsOf_;  // the measurement whose words stand in words_
  char words_[200] = "";
  char listPath_[4096] = "";
  char path_[4096] = "";
  bool help_ = false, qualityShown_ = false, quit_ = false, notice_ = false, browserShown_ = true;
  std::function<std::string()> noticeAccepted_;
};

}  // namespace vernier::ui
