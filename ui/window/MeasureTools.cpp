// SPDX-License-Identifier: GPL-3.0-or-later
// Measuring by hand: tools that are used once, their points, handles, and how measurements lie over a
// picture.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

#include "Gui.h"

namespace vernier::ui {
namespace {

constexpr ImU32 kLine = IM_COL32(255, 214, 92, 255), kChosen = IM_COL32(120, 230, 255, 255),
                kShadow = IM_COL32(0, 0, 0, 190);
constexpr float kGrip = 8, kDragged = 4;  // px

// What stands beside it; a second line for the spread of values.
std::string labelOf(const measure::Measurement& m, const Result<measure::Measured>* said) {
  if (const auto* a = std::get_if<measure::Arrow>(&m.shape)) return a->text.empty() ? m.label : a->text;
  if (!said) return "...";
  if (!*said) return "not measured";
  std::string text = m.label.empty() ? "" : m.label + "\n";
  if ((*said)->quantities.empty()) return text;
  text += measure::displayText((*said)->quantities.front());
  for (const measure::Quantity& q : (*said)->quantities)
    if (q.name == "mean") {
      text += "\nmean " + measure::displayText(q);
      const auto& sd = (*said)->values->sd;
      if (sd) text += ", SD " + measure::displayLike(*sd, q);
    }
  if ((*said)->quantities.front().name.starts_with("projected")) text += "\nprojected";
  return text;
}

}  // namespace

void Gui::takeRuler(std::optional<Ruler> r) {
  sketch_.reset();
  ruler_.reset();
  if (!r) return;
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
  if (ImGui::IsKeyPressed(GLFW_KEY_DELETE, false) && w.measurement(selected_)) {
    w.removeMeasurement(selected_);
    selected_.clear();
  }
}

void Gui::measureMenu() {
  ImGui::SetNextItemWidth(theme_.px(112));
  const std::string now = ruler_ ? factsOf(*ruler_).name : "Measure";
  if (ruler_) ImGui::PushStyleColor(ImGuiCol_FrameBg, colour::kAccentDark);
  const bool open = ImGui::BeginCombo("##measure", now.c_str(), ImGuiComboFlags_HeightLarge);
  if (ruler_) ImGui::PopStyleColor();
  if (!open) return;
  for (const RulerFacts& f : rulers()) {
    if (ImGui::Selectable((std::string(f.name) + "   " + f.key).c_str(), ruler_ == f.ruler))
      takeRuler(f.ruler);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", f.how);
  }
  ImGui::Separator();
  if (ImGui::Selectable("List   M", listShown_)) listShown_ = !listShown_;
  ImGui::EndCombo();
}

// Its centre, as the value in the status line has it.
glm::dvec2 Gui::pixelUnderPointer(Rect r) const {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  return {std::floor(mouse.x - r.x) + 0.5, std::floor(mouse.y - r.y) + 0.5};
}

// Of the measurement that lies on top.
std::optional<Gui::Grip> Gui::gripAt(int t, Rect r) const {
  const TileView& shown = desk_.tileView(t);
  const Workspace& w = desk_.workspace();
  const SourceFacts* facts = w.factsOfTile(t);
  if (!shown.picture || shown.picture->error || !shown.place || !facts) return std::nullopt;
  const auto& all = w.now().measurements;
  for (auto d = all.rbegin(); d != all.rend(); ++d) {
    const SourceFacts* own = w.facts({d->document, d->what.on.source});
    if (!shownOn(*d, shown.picture->scene, w.tile(t).source, *shown.place, *facts, own)) continue;
    const std::vector<measure::Spot> handles = measure::handlesOf(d->what.shape);
    for (std::size_t n = 0; n < handles.size(); ++n) {
      const glm::dvec2 px = pixelOf(*shown.place, d->what.on.space, handles[n]);
      if (glm::length(px - pixelUnderPointer(r)) <= theme_.px(kGrip)) return Grip{d->what.id, n, t};
    }
  }
  return std::nullopt;
}

void Gui::addSpot(const Place& place, glm::dvec2 px) {
  sketch_->spots.push_back(spotAt(place, sketch_->on.space, px));
  if (sketch_->spots.size() < factsOf(*ruler_).points) return;
  Workspace& w = desk_.workspace();
  measure::Measurement m;
  m.on = sketch_->on;
  m.shape = shapeOf(*ruler_, sketch_->spots);
  selected_ = w.addMeasurement(w.tile(sketch_->tile).source.document, std::move(m));
  takeRuler({});  // used once
}

bool Gui::measureHands(int t, Rect r, bool hovered) {
  const TileView& shown = desk_.tileView(t);
  const bool clicked = hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left);
  if (!ruler_) {
    if (grip_) return true;
    if (!clicked || drag_ || ImGui::GetIO().KeyCtrl) return false;
    grip_ = gripAt(t, r);
    if (!grip_) return false;
    selected_ = grip_->id;
    desk_.workspace().setActive(t);
    desk_.workspace().beginDrag();
    return true;
  }
  if (!shown.picture || shown.picture->error || !shown.place) return false;
  if (sketch_ && sketch_->tile != t) {  // points of one measurement stand on one picture
    if (clicked) sketch_.reset();
  }
  if (clicked) {
    desk_.workspace().setActive(t);
    if (sketch_ && sketch_->on.space == measure::Space::Image &&
        sketch_->on.frame !=
            placementOn(shown.picture->scene, desk_.workspace().tile(t).source, *shown.place)->frame)
      sketch_.reset();  // another image was scrolled to
    if (!sketch_) {
      const auto on = placementOn(shown.picture->scene, desk_.workspace().tile(t).source, *shown.place);
      if (!on) {
        why_ = "This picture has no place that could be measured in.";
        takeRuler({});
        return true;
      }
      sketch_ = Sketch{t, *on, {}, {}, false};
    }
    sketch_->pressed = ImGui::GetIO().MousePos;
    sketch_->held = true;
    addSpot(*shown.place, pixelUnderPointer(r));
    return true;
  }
  if (sketch_ && sketch_->tile == t && sketch_->held && !ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    sketch_->held = false;  // press, drag and release give two points
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const double way = std::hypot(mouse.x - sketch_->pressed.x, mouse.y - sketch_->pressed.y);
    if (way > theme_.px(kDragged)) addSpot(*shown.place, pixelUnderPointer(r));
  }
  return !(ImGui::IsMouseClicked(ImGuiMouseButton_Right) || ImGui::IsMouseClicked(ImGuiMouseButton_Middle));
}

void Gui::dragHandle() {
  if (!grip_) return;
  Workspace& w = desk_.workspace();
  const TileView& shown = desk_.tileView(grip_->tile);
  const Drawn* d = w.measurement(grip_->id);
  if (d && shown.place && shown.picture &&
      ImGui::GetIO().MouseDelta.x * ImGui::GetIO().MouseDelta.x +
              ImGui::GetIO().MouseDelta.y * ImGui::GetIO().MouseDelta.y >
          0) {
    measure::Measurement m = d->what;
    const glm::dvec2 px = pixelUnderPointer(tileArea_[static_cast<std::size_t>(grip_->tile)]);
    measure::Spot to = spotAt(*shown.place, m.on.space, px);
    measure::setHandle(m.shape, grip_->handle, to);
    w.changeMeasurement(m);
  }
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) return;
  w.endDrag();
  grip_.reset();
}

void Gui::drawMeasurement(const measure::Measurement& m, const Place& place, Rect r, bool selected,
                          const std::string& label) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const auto at = [&](const measure::Spot& s) {
    const glm::dvec2 p = pixelOf(place, m.on.space, s);
    return ImVec2(r.x + static_cast<float>(p.x), r.y + static_cast<float>(p.y));
  };
  const ImU32 c = selected ? kChosen : kLine;
  const float thin = std::max(1.0f, theme_.px(1.25f));
  for (const ImU32 shade : {kShadow, c})  // readable on bright and on dark
    for (const auto& line : linesOf(m)) {
      std::vector<ImVec2> points;
      for (const measure::Spot& s : line) points.push_back(at(s));
      draw->AddPolyline(points.data(), static_cast<int>(points.size()), shade, 0,
                        shade == kShadow ? thin + theme_.px(2) : thin);
    }
  for (const measure::Spot& s : measure::handlesOf(m.shape)) {
    const ImVec2 p = at(s);
    const float size = theme_.px(3);
    draw->AddRectFilled({p.x - size - 1, p.y - size - 1}, {p.x + size + 1, p.y + size + 1}, kShadow);
    draw->AddRect({p.x - size, p.y - size}, {p.x + size, p.y + size}, c);
  }
  if (label.empty()) return;
  const ImVec2 size = theme_.small->CalcTextSizeA(theme_.small->FontSize, 1e6f, 0, label.c_str());
  const ImVec2 by = at(labelAt(m));
  const float pad = theme_.px(3), away = theme_.px(9);
  const float x = std::clamp(by.x + away, r.x + pad, std::max(r.x + pad, r.x + r.w - size.x - pad));
  const float y = std::clamp(by.y + away, r.y + pad, std::max(r.y + pad, r.y + r.h - size.y - pad));
  draw->AddRectFilled({x - pad, y - pad}, {x + size.x + pad, y + size.y + pad}, IM_COL32(0, 0, 0, 150),
                      theme_.px(3));
  draw->AddText(theme_.small, theme_.small->FontSize, {x, y}, c, label.c_str());
}

void Gui::measurements(int t, Rect r) {
  tileArea_[static_cast<std::size_t>(t)] = r;
  const TileView& shown = desk_.tileView(t);
  const Workspace& w = desk_.workspace();
  const SourceFacts* facts = w.factsOfTile(t);
  if (!shown.place || !shown.picture || !facts) return;
  for (const Drawn& d : w.now().measurements) {
    const SourceFacts* own = w.facts({d.document, d.what.on.source});
    if (shownOn(d, shown.picture->scene, w.tile(t).source, *shown.place, *facts, own))
      drawMeasurement(d.what, *shown.place, r, d.what.id == selected_, labelOf(d.what, desk_.said(d)));
  }
  if (!sketch_ || sketch_->tile != t || sketch_->spots.empty()) return;
  // What there is so far, and where the next point would be.
  measure::Measurement m;
  m.on = sketch_->on;
  std::vector<measure::Spot> spots = sketch_->spots;
  spots.push_back(spotAt(*shown.place, m.on.space, pixelUnderPointer(r)));
  if (spots.size() == factsOf(*ruler_).points)
    m.shape = shapeOf(*ruler_, spots);
  else
    m.shape = measure::Length{{spots[0], spots[1]}};
  drawMeasurement(m, *shown.place, r, true, "");
}

}  // namespace vernier::ui
