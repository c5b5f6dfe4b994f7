// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements as they lie over a picture: lines, labels, handles, and the offer to go to an acquired slice.
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
  if (const auto* t = std::get_if<measure::Text>(&m.shape)) return t->text;
  if (!said) return "...";
  if (!*said) return "not measured";
  std::string text = m.label.empty() ? "" : m.label + "\n";
  if ((*said)->quantities.empty()) return text;
  text += measure::displayText((*said)->quantities.front());
  if (std::holds_alternative<measure::Bidirectional>(m.shape))
    text += "\n" + measure::displayText((*said)->quantities.at(1));
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
  if (ImGui::Selectable("Lens   G")) {
    const int t = desk_.workspace().now().active;
    const View& v = desk_.tileView(t).view;
    putLens(t, 0.5 * glm::dvec2(v.width_px, v.height_px));
  }
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("in the middle of the picture; the key places it at the pointer");
  ImGui::Separator();
  if (ImGui::Selectable("List   M", listShown_)) listShown_ = !listShown_;
  ImGui::EndCombo();
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
    for (const std::size_t n : gripsOf(d->what.shape)) {
      const glm::dvec2 px = pixelOf(*shown.place, d->what.on.space, handles[n]);
      if (glm::length(px - pixelUnderPointer(r)) <= theme_.px(kGrip)) return Grip{d->what.id, n, t};
    }
  }
  return std::nullopt;
}

bool Gui::gripHands(int t, Rect r, bool clicked) {
  if (grip_) return true;
  if (!clicked || drag_ || ImGui::GetIO().KeyCtrl) return false;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (offer_ && offer_->tile == t && mouse.x >= offer_->box.x && mouse.x < offer_->box.x + offer_->box.w &&
      mouse.y >= offer_->box.y && mouse.y < offer_->box.y + offer_->box.h) {
    desk_.workspace().setActive(t);
    desk_.workspace().snap(offer_->id, t);
    return true;
  }
  grip_ = gripAt(t, r);
  if (!grip_) return false;
  selected_ = grip_->id;
  desk_.workspace().setActive(t);
  desk_.workspace().beginDrag();
  return true;
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
    moveGrip(m.shape, grip_->handle, spotAt(*shown.place, m.on.space, px), *shown.place, m.on.space);
    w.changeMeasurement(m);
  }
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) return;
  if (d = w.measurement(grip_->id); d && shown.place) {
    measure::Measurement m = d->what;
    settleGrips(m.shape, *shown.place, m.on.space);
    w.changeMeasurement(m);
  }
  w.endDrag();
  grip_.reset();
}

// The first of the places that covers no label of this picture; the first one when all do.
Gui::Rect Gui::freeOfLabels(Rect below, Rect above, Rect left) const {
  for (const Rect& b : {below, above, left})
    if (std::none_of(labels_.begin(), labels_.end(), [&](const Rect& o) {
          return b.x < o.x + o.w && o.x < b.x + b.w && b.y < o.y + o.h && o.y < b.y + b.h;
        }))
      return b;
  return below;
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
  const std::vector<measure::Spot> handles = measure::handlesOf(m.shape);
  for (const std::size_t n : gripsOf(m.shape)) {
    const ImVec2 p = at(handles[n]);
    const float size = theme_.px(3);
    draw->AddRectFilled({p.x - size - 1, p.y - size - 1}, {p.x + size + 1, p.y + size + 1}, kShadow);
    draw->AddRect({p.x - size, p.y - size}, {p.x + size, p.y + size}, c);
  }
  if (label.empty()) return;
  const ImVec2 size = theme_.small->CalcTextSizeA(theme_.small->FontSize, 1e6f, 0, label.c_str());
  ImVec2 by = at(labelAt(m));
  if (std::holds_alternative<measure::PolygonRegion>(m.shape) ||
      std::holds_alternative<measure::FreehandRegion>(m.shape))
    for (const measure::Spot& s : handles)  // beside the outline, not upon it
      if (const ImVec2 p = at(s); p.x + p.y > by.x + by.y) by = p;
  const float pad = theme_.px(3), away = theme_.px(9);
  const auto inside = [&](float x, float y) {
    return Rect{std::clamp(x, r.x + pad, std::max(r.x + pad, r.x + r.w - size.x - pad)) - pad,
                std::clamp(y, r.y + pad, std::max(r.y + pad, r.y + r.h - size.y - pad)) - pad,
                size.x + 2 * pad, size.y + 2 * pad};
  };
  labelBox_ = freeOfLabels(inside(by.x + away, by.y + away), inside(by.x + away, by.y - away - size.y),
                           inside(by.x - away - size.x, by.y + away));
  labels_.push_back(labelBox_);
  const float x = labelBox_.x + pad, y = labelBox_.y + pad;
  draw->AddRectFilled({x - pad, y - pad}, {x + size.x + pad, y + size.y + pad}, IM_COL32(0, 0, 0, 150),
                      theme_.px(3));
  draw->AddText(theme_.small, theme_.small->FontSize, {x, y}, c, label.c_str());
}

// Below the label, above it where there is no room: a region on interpolated values may go to stored ones.
void Gui::offerSnap(const Drawn& d, int t, Rect r) {
  const char* words = "Snap to acquired slice";
  const ImVec2 size = theme_.small->CalcTextSizeA(theme_.small->FontSize, 1e6f, 0, words);
  const float pad = theme_.px(5), gap = theme_.px(3);
  Rect box{labelBox_.x, labelBox_.y + labelBox_.h + gap, size.x + 2 * pad, size.y + pad};
  if (box.y + box.h > r.y + r.h) box.y = labelBox_.y - gap - box.h;
  box.x = std::clamp(box.x, r.x, std::max(r.x, r.x + r.w - box.w));
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const bool under =
      mouse.x >= box.x && mouse.x < box.x + box.w && mouse.y >= box.y && mouse.y < box.y + box.h;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled({box.x, box.y}, {box.x + box.w, box.y + box.h},
                      under ? colour::kAccent : colour::kAccentDark, theme_.px(3));
  draw->AddText(theme_.small, theme_.small->FontSize, {box.x + pad, box.y + pad / 2}, colour::kText, words);
  offer_ = Offer{d.what.id, t, box};
}

void Gui::measurements(int t, Rect r) {
  tileArea_[static_cast<std::size_t>(t)] = r;
  if (offer_ && offer_->tile == t) offer_.reset();
  labels_.clear();
  const TileView& shown = desk_.tileView(t);
  const Workspace& w = desk_.workspace();
  const SourceFacts* facts = w.factsOfTile(t);
  if (!shown.place || !shown.picture || !facts) return;
  for (const Drawn& d : w.now().measurements) {
    const SourceFacts* own = w.facts({d.document, d.what.on.source});
    if (!shownOn(d, shown.picture->scene, w.tile(t).source, *shown.place, *facts, own)) continue;
    drawMeasurement(d.what, *shown.place, r, d.what.id == selected_, labelOf(d.what, desk_.said(d)));
    if (d.what.id == selected_ && !ruler_ && w.canSnap(selected_)) offerSnap(d, t, r);
  }
  sketch(t, r);
}

// What there is so far, and where the next point would be.
void Gui::sketch(int t, Rect r) {
  const TileView& shown = desk_.tileView(t);
  if (!ruler_ || !sketch_ || sketch_->tile != t || sketch_->spots.empty()) return;
  if (!standsOn(sketch_->on, sketch_->spots[0], shown.picture->scene, desk_.workspace().tile(t).source,
                *shown.place))
    return;
  measure::Measurement m;
  m.on = sketch_->on;
  std::vector<measure::Spot> spots = sketch_->spots;
  spots.push_back(spotAt(*shown.place, m.on.space, guided(*shown.place, pixelUnderPointer(r))));
  const std::size_t points = factsOf(*ruler_).points;
  if (points == 0 && spots.size() > 2)
    m.shape = shapeOf(*ruler_, spots);
  else if (spots.size() == points)
    m.shape = shapeOf(*ruler_, spots);
  else
    m.shape = measure::Length{{spots[0], spots[1]}};
  drawMeasurement(m, *shown.place, r, true, "");
}

}  // namespace vernier::ui
