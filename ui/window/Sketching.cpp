// SPDX-License-Identifier: GPL-3.0-or-later
// Measuring tools in the hand: used once, their points one after the other, outlines and words; then the left
// button does again what it did before.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "Gui.h"

namespace vernier::ui {
namespace {

constexpr float kFirstCorner = 8, kDragged = 4, kStep = 2;  // px

float distance(ImVec2 a, ImVec2 b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace

void Gui::takeRuler(std::optional<Ruler> r) {
  sketch_.reset();
  ruler_.reset();
  if (!r) return;
  writing_.reset();
  const Workspace& w = desk_.workspace();
  const Result<void> may = desk_.mayMeasure(w.tile(w.now().active).source.document);
  why_ = may ? "" : may.error().sentence;
  if (may) ruler_ = r;
}

void Gui::measureKeys() {
  Workspace& w = desk_.workspace();
  for (const RulerFacts& f : rulers())
    if (ImGui::IsKeyPressed(f.key[0], false))
      takeRuler(ruler_ == f.ruler ? std::nullopt : std::optional(f.ruler));
  if (ImGui::IsKeyPressed(GLFW_KEY_M, false)) listShown_ = !listShown_;
  const bool enter =
      ImGui::IsKeyPressed(GLFW_KEY_ENTER, false) || ImGui::IsKeyPressed(GLFW_KEY_KP_ENTER, false);
  if (enter && ruler_ == Ruler::Polygon && sketch_) closeSketch();
  if (ImGui::IsKeyPressed(GLFW_KEY_G, false)) lensKey();
  if (!ImGui::IsKeyPressed(GLFW_KEY_DELETE, false)) return;
  if (w.measurement(selected_)) {
    w.removeMeasurement(selected_);
    selected_.clear();
  } else {
    removeChosenLens();
  }
}

// Its centre, as the value in the status line has it.
glm::dvec2 Gui::pixelUnderPointer(Rect r) const {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  return {std::floor(mouse.x - r.x) + 0.5, std::floor(mouse.y - r.y) + 0.5};
}

// Where the next point goes: the last one of diameters is at right angles to the long axis.
glm::dvec2 Gui::guided(const Place& place, glm::dvec2 px) const {
  if (ruler_ != Ruler::Bidirectional || !sketch_ || sketch_->spots.size() != 3) return px;
  const auto at = [&](std::size_t n) { return pixelOf(place, sketch_->on.space, sketch_->spots[n]); };
  return acrossLongAxis(at(0), at(1), at(2), px);
}

void Gui::addSpot(const Place& place, glm::dvec2 px) {
  const glm::dvec2 to = guided(place, px);
  if (sketch_->spots.size() >= measure::kMostOutlinePoints) return;
  sketch_->spots.push_back(spotAt(place, sketch_->on.space, to));
  if (sketch_->spots.size() == factsOf(*ruler_).points) finishSketch(place);
}

// Of an outline that takes as many points as the hand makes.
void Gui::closeSketch() {
  const TileView& shown = desk_.tileView(sketch_->tile);
  if (sketch_->spots.size() >= 3 && shown.place) return finishSketch(*shown.place);
  why_ = ruler_ == Ruler::Polygon
             ? "A polygon needs three corners or more: click the next one, or give it up with Esc."
             : "Press the button, draw around the region and let go; Esc gives it up.";
  if (ruler_ == Ruler::Freehand) sketch_.reset();
}

void Gui::finishSketch(const Place& place) {
  Workspace& w = desk_.workspace();
  measure::Measurement m;
  m.on = sketch_->on;
  m.shape = shapeOf(*ruler_, sketch_->spots);
  settleGrips(m.shape, place, m.on.space);
  const int document = w.tile(sketch_->tile).source.document;
  if (ruler_ == Ruler::Text) {  // it stands when its words do
    writing_ = Writing{document, std::move(m), ImGui::GetIO().MousePos, true, ""};
  } else {
    selected_ = w.addMeasurement(document, std::move(m));
  }
  why_.clear();
  takeRuler({});  // used once
}

bool Gui::beginSketch(int t) {
  const TileView& shown = desk_.tileView(t);
  const auto on = placementOn(shown.picture->scene, desk_.workspace().tile(t).source, *shown.place);
  if (on) {
    sketch_ = Sketch{t, *on, {}, {}, false};
    return true;
  }
  takeRuler({});
  why_ = "This picture has no place that could be measured in.";
  return false;
}

bool Gui::sketchClick(int t, Rect r) {
  const TileView& shown = desk_.tileView(t);
  const Place& place = *shown.place;
  const glm::dvec2 px = pixelUnderPointer(r);
  desk_.workspace().setActive(t);
  // Points of one measurement stand on one picture: not on another tile, nor on one that was scrolled away.
  if (sketch_ && (sketch_->tile != t || !standsOn(sketch_->on, sketch_->spots[0], shown.picture->scene,
                                                  desk_.workspace().tile(t).source, place)))
    sketch_.reset();
  if (ruler_ == Ruler::Polygon && sketch_) {
    const double fromFirst = glm::length(pixelOf(place, sketch_->on.space, sketch_->spots[0]) - px);
    const bool first = sketch_->spots.size() >= 3 && fromFirst <= theme_.px(kFirstCorner);
    if (first || ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
      closeSketch();
      return true;
    }
  }
  if (!sketch_ && !beginSketch(t)) return true;
  sketch_->pressed = ImGui::GetIO().MousePos;
  sketch_->held = true;
  addSpot(place, px);
  return true;
}

// While the button is down and when it goes up.
void Gui::sketchMotion(int t, Rect r) {
  const Place& place = *desk_.tileView(t).place;
  const bool down = ImGui::IsMouseDown(ImGuiMouseButton_Left);
  if (ruler_ == Ruler::Freehand) {
    for (const auto& [x, y] : way_) {
      const glm::dvec2 px(std::floor(x - r.x) + 0.5, std::floor(y - r.y) + 0.5);
      if (glm::length(px - pixelOf(place, sketch_->on.space, sketch_->spots.back())) >= theme_.px(kStep))
        addSpot(place, px);
    }
    if (!down) closeSketch();
    return;
  }
  if (down) return;
  sketch_->held = false;  // press, drag and release give two points
  if (distance(ImGui::GetIO().MousePos, sketch_->pressed) > theme_.px(kDragged))
    addSpot(place, pixelUnderPointer(r));
}

bool Gui::measureHands(int t, Rect r, bool hovered) {
  const TileView& shown = desk_.tileView(t);
  const bool clicked = hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  if (!ruler_) return gripHands(t, r, clicked);
  if (!shown.picture || shown.picture->error || !shown.place) return false;
  if (clicked) return sketchClick(t, r);
  if (sketch_ && sketch_->tile == t && sketch_->held) sketchMotion(t, r);
  return !(ImGui::IsMouseClicked(ImGuiMouseButton_Right) || ImGui::IsMouseClicked(ImGuiMouseButton_Middle));
}

// The field for the words of a text, where it will stand.
void Gui::writing() {
  if (!writing_) return;
  Writing& text = *writing_;
  ImGui::SetNextWindowPos(text.at);
  ImGui::SetNextWindowSize({theme_.px(240), 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::Begin("##writing", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  if (text.fresh) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  const bool done = ImGui::InputTextWithHint("##words", "Words, then Enter", text.words, sizeof text.words,
                                             ImGuiInputTextFlags_EnterReturnsTrue);
  const bool left = !text.fresh && ImGui::IsItemDeactivated();
  const bool givenUp = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
  text.fresh = false;
  ImGui::End();
  if (!done && !left && !givenUp) return;
  if (!givenUp && text.words[0] != '\0') {
    std::get<measure::Text>(text.what.shape).text = text.words;
    selected_ = desk_.workspace().addMeasurement(text.document, std::move(text.what));
  }
  writing_.reset();
}

}  // namespace vernier::ui
