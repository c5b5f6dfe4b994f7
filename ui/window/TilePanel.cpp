// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures: tiles, what lies over them, and the hands on them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "Gui.h"
#include "Looks.h"

namespace vernier::ui {
namespace {

constexpr float kHeader = 26, kGap = 2, kRedBand = 24;
constexpr ImGuiWindowFlags kFlags =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoScrollWithMouse;

std::string viewTitle(const std::string& view) {
  if (view.empty()) return "";
  std::string s = view;
  s[0] = static_cast<char>(s[0] - 32);
  return s;
}

ImU32 faded(ImU32 c, int alpha) {
  return (c & ~IM_COL32_A_MASK) | (static_cast<ImU32>(alpha) << IM_COL32_A_SHIFT);
}

}  // namespace

void Gui::tiles(Rect r) {
  ImGui::SetNextWindowPos({r.x, r.y});
  ImGui::SetNextWindowSize({r.w, r.h});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::kBack);
  ImGui::Begin("##tiles", nullptr, kFlags);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  const Workspace& w = desk_.workspace();
  if (w.differentPeople()) {  // and each of their headers is red
    const float band = theme_.px(kRedBand);
    ImDrawList* draw = ImGui::GetWindowDrawList();
    draw->AddRectFilled({r.x, r.y}, {r.x + r.w, r.y + band}, colour::kRedBand);
    const char* text = w.differentPeopleOfOneId()
                           ? "ONE PATIENT ID, BUT NOT ONE BIRTH DATE AND SEX: take these for two people"
                           : "DIFFERENT PATIENTS: these pictures are not of one person";
    const ImVec2 size = ImGui::CalcTextSize(text);
    draw->AddText({r.x + (r.w - size.x) / 2, r.y + (band - size.y) / 2}, IM_COL32_WHITE, text);
    r.y += band, r.h -= band;
  }
  const std::vector<int> shown = w.shown();
  for (int t = 0; t < kTiles; ++t)
    if (std::find(shown.begin(), shown.end(), t) == shown.end()) desk_.setTileSize(t, 0, 0);
  const int columns = shown.size() > 1 ? 2 : 1, rows = shown.size() > 2 ? 2 : 1;
  const float gap = std::max(1.0f, std::round(theme_.px(kGap)));
  const float tw = std::floor((r.w - gap * static_cast<float>(columns - 1)) / static_cast<float>(columns));
  const float th = std::floor((r.h - gap * static_cast<float>(rows - 1)) / static_cast<float>(rows));
  for (std::size_t n = 0; n < shown.size(); ++n) {
    const float x = r.x + static_cast<float>(static_cast<int>(n) % columns) * (tw + gap);
    const float y = r.y + static_cast<float>(static_cast<int>(n) / columns) * (th + gap);
    ImGui::PushID(shown[n]);
    tile(shown[n], {x, y, tw, th});
    ImGui::PopID();
  }
  drag();
  dragHandle();
  dragLens();
  ImGui::End();
}

void Gui::tile(int t, Rect r) {
  const float header = std::round(theme_.px(kHeader));
  tileHeader(t, {r.x, r.y, r.w, header});
  const Rect area{r.x, r.y + header, r.w, std::max(0.0f, r.h - header)};
  desk_.setTileSize(t, static_cast<int>(area.w), static_cast<int>(area.h));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  draw->AddRectFilled({area.x, area.y}, {area.x + area.w, area.y + area.h}, colour::kImage);
  ImGui::SetCursorScreenPos({area.x, area.y});
  ImGui::InvisibleButton("##picture", {std::max(1.0f, area.w), std::max(1.0f, area.h)},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  const bool hovered = ImGui::IsItemHovered();
  if (ImGui::BeginDragDropTarget()) {
    if (const ImGuiPayload* payload = ImGui::AcceptDragDropPayload("vernier.source")) {
      const auto* text = static_cast<const char*>(payload->Data);
      int document = 0;
      std::memcpy(&document, text, sizeof document);
      desk_.openSource({document, std::string(text + sizeof document)}, t);
    }
    ImGui::EndDragDropTarget();
  }
  draw->PushClipRect({area.x, area.y}, {area.x + area.w, area.y + area.h}, true);
  const Workspace& w = desk_.workspace();
  if (w.tile(t).empty()) {
    emptyTile(area);
    if (hovered && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) desk_.workspace().setActive(t);
  } else {
    picture(t, area);
    hands(t, area, hovered);
    if (hovered) probe(t, area), hoverDetails(t, area);
    if (hovered && wipe_ && !drag_ && area.w > 0)
      wipeAt_ = std::clamp((ImGui::GetIO().MousePos.x - area.x) / area.w, 0.0f, 1.0f);
  }
  draw->PopClipRect();
  if (w.now().active == t && w.now().layout != Layout::Single)
    draw->AddRect({r.x, r.y}, {r.x + r.w, r.y + r.h}, colour::kAccent, 0, 0, std::max(1.0f, theme_.px(1)));
}

void Gui::tileHeader(int t, Rect r) {
  const Workspace& w = desk_.workspace();
  const Tile& tile = w.tile(t);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const bool alarm = !tile.empty() && w.differentPeople();
  draw->AddRectFilled({r.x, r.y}, {r.x + r.w, r.y + r.h}, alarm ? colour::kRedBand : colour::kPanel);
  if (tile.empty()) return;
  const SourceFacts* f = w.factsOfTile(t);
  const float pad = theme_.px(8), chip = theme_.px(8), middle = r.y + r.h / 2;
  draw->AddRectFilled({r.x + pad, middle - chip / 2}, {r.x + pad + chip, middle + chip / 2},
                      colourOfView(tile.view), theme_.px(2));
  ImFont* bold = theme_.small;
  std::string title = viewTitle(tile.view);
  if (f && lookOf(tile.scene)) title = "3-D, " + nameOfLook(tile.scene, tile.view, *f);
  if (w.now().together && w.shown().size() > 1)
    title += w.togetherIsManual() ? ", together (manual)" : ", together";
  float x = r.x + pad + chip + theme_.px(7);
  const float y = middle - bold->FontSize / 2;
  draw->AddText(bold, bold->FontSize, {x, y}, colour::kText, title.c_str());
  x += bold->CalcTextSizeA(bold->FontSize, 1e6f, 0, title.c_str()).x + theme_.px(12);
  if (!f) return;
  // The person on the right is never cut; the series gives way.
  const float person = theme_.small->CalcTextSizeA(theme_.small->FontSize, 1e6f, 0, f->patient.c_str()).x;
  const float personX = std::max(x, r.x + r.w - pad - person);
  draw->AddText(theme_.small, theme_.small->FontSize, {personX, y}, colour::kText, f->patient.c_str());
  draw->PushClipRect({x, r.y}, {std::max(x, personX - theme_.px(12)), r.y + r.h}, true);
  const std::string series = (f->modality.empty() ? "" : f->modality + "  ") + f->title;
  draw->AddText(theme_.small, theme_.small->FontSize, {x, y}, alarm ? colour::kText : colour::kDim,
                series.c_str());
  draw->PopClipRect();
}

void Gui::sentence(Rect r, const char* headline, const std::string& text, ImU32 headlineColour) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float width = std::min(r.w - theme_.px(32), theme_.px(460));
  if (width < theme_.px(40)) return;
  const ImVec2 a = theme_.bold->CalcTextSizeA(theme_.bold->FontSize, 1e6f, width, headline);
  const ImVec2 b = theme_.body->CalcTextSizeA(theme_.body->FontSize, 1e6f, width, text.c_str());
  float y = r.y + std::max(theme_.px(8), (r.h - a.y - b.y - theme_.px(10)) / 2);
  draw->AddText(theme_.bold, theme_.bold->FontSize, {r.x + (r.w - a.x) / 2, y}, headlineColour, headline,
                nullptr, width);
  y += a.y + theme_.px(10);
  draw->AddText(theme_.body, theme_.body->FontSize, {r.x + (r.w - b.x) / 2, y}, colour::kDim, text.c_str(),
                nullptr, width);
}

void Gui::emptyTile(Rect r) {
  const auto p = desk_.progress();
  if (p && p->opening)
    return sentence(r, "Reading files", "The first series opens when its headers are known. Esc cancels.",
                    colour::kText);
  if (desk_.documents().empty())
    return sentence(r, "Nothing is open",
                    "Drop a folder or files on this window, or type a path in the field on the left.",
                    colour::kText);
  sentence(r, "Empty", "Drag a series here from the list on the left.", colour::kText);
}

void Gui::volumeState(int t, Rect r) {
  const Workspace& w = desk_.workspace();
  const SourceId& source = w.tile(t).source;
  const SourceFacts* f = w.factsOfTile(t);
  const bool stack = f && !f->isVolumeFile;  // its images can be seen without the volume
  if (const Error* e = desk_.volumeError(source)) {
    const bool cancelled = e->code == ErrorCode::Cancelled;
    sentence(r, cancelled ? "Loading was cancelled" : "This volume cannot be shown",
             cancelled
                 ? (stack ? "The stack view needs no volume: choose Stack." : "It can be started again.")
                 : e->sentence + (stack ? " The stack view still works." : ""),
             cancelled ? colour::kText : colour::kAmber);
    ImGui::SetCursorScreenPos({r.x + (r.w - theme_.px(96)) / 2, r.y + r.h / 2 + theme_.px(44)});
    if (ImGui::Button("Try again", {theme_.px(96), 0})) desk_.retryVolume(source);
    return;
  }
  const auto p = desk_.progress();
  std::string text = stack ? "The stack can be scrolled meanwhile. Esc cancels." : "Esc cancels.";
  if (p && p->source == source && p->total > 0)
    text = std::to_string(p->done) + " of " + std::to_string(p->total) + " slices. " + text;
  sentence(r, "Loading the volume", text, colour::kText);
}

void Gui::picture(int t, Rect r) {
  const TileView& shown = desk_.tileView(t);
  const Tile& tile = desk_.workspace().tile(t);
  if (needsVolume(tile.scene) && !desk_.volumeReady(tile.source)) return volumeState(t, r);
  if (!shown.picture)
    return sentence(r, lookOf(tile.scene) ? "Drawing the volume" : "Reading the slice",
                    "It comes in a moment.", colour::kDim);
  const FinishedPicture& p = *shown.picture;
  if (p.error) {
    sentence(r, "This picture cannot be shown", p.error->sentence, colour::kAmber);
    return;
  }
  const auto texture = textures_.get("tile" + std::to_string(t), shown.pictureNumber, p.rgba);
  const float w = static_cast<float>(p.rgba.width), h = static_cast<float>(p.rgba.height);
  // While the window is resized the picture of the old size stays in the middle, never stretched.
  const float x = r.x + std::round((r.w - w) / 2), y = r.y + std::round((r.h - h) / 2);
  ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(texture), {x, y}, {x + w, y + h});
  compared(t, {x, y, w, h});
  references(t, {x, y, w, h});
  crosshairInLook(t, {x, y, w, h});
  lenses(t, {x, y, w, h});
  measurements(t, {x, y, w, h});
}

void Gui::references(int t, Rect r) {
  const Workspace& w = desk_.workspace();
  const TileView& shown = desk_.tileView(t);
  if (!shown.place || !shown.picture || !shown.place->inPatient) return;
  const Place& place = *shown.place;
  const View& view = shown.picture->view;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float line = std::max(1.0f, theme_.px(1));
  const auto at = [&](glm::dvec2 p) {
    return ImVec2(r.x + static_cast<float>(p.x), r.y + static_cast<float>(p.y));
  };
  const auto cross = w.crosshair(t);
  const bool crossHere = cross && std::abs(place.distance_mm(*cross)) < 0.51 * std::max(1.0, place.unit_mm);
  const glm::dvec2 centre = cross ? place.pixelOf(*cross) : glm::dvec2(0, 0);
  const double gap = theme_.px(12);
  const int n = tilesOf(w.now().layout);
  for (int other = 0; other < n && n > 1; ++other) {
    if (other == t || w.tile(other).empty() || !w.linked(t, other)) continue;
    const View asShown = desk_.tileView(other).view.width_px > 0 ? desk_.tileView(other).view : view;
    const SourceFacts* f = w.factsOfTile(other);
    const auto plane = placeOf(w.tile(other).scene, *f, f->grid ? &*f->grid : nullptr, asShown);
    const auto cut = plane ? crossing(place, *plane, view) : std::nullopt;
    if (!cut) continue;
    const ImU32 c = faded(colourOfView(w.tile(other).view), 190);
    // Open around the crosshair, so that what lies there can be seen.
    const glm::dvec2 d = glm::normalize(cut->b - cut->a);
    const double along = glm::dot(centre - cut->a, d), length = glm::length(cut->b - cut->a);
    const double off = glm::length(centre - cut->a - along * d);
    if (!cross || off > gap) {
      draw->AddLine(at(cut->a), at(cut->b), c, line);
      continue;
    }
    if (along - gap > 0) draw->AddLine(at(cut->a), at(cut->a + (along - gap) * d), c, line);
    if (along + gap < length) draw->AddLine(at(cut->a + (along + gap) * d), at(cut->b), c, line);
  }
  if (crossHere && (n == 1 || w.tile(t).view == "stack")) {
    const float arm = theme_.px(10), inner = theme_.px(4);
    const ImVec2 c = at(centre);
    const ImU32 shade = colour::kAccent;
    draw->AddLine({c.x - arm, c.y}, {c.x - inner, c.y}, shade, line);
    draw->AddLine({c.x + inner, c.y}, {c.x + arm, c.y}, shade, line);
    draw->AddLine({c.x, c.y - arm}, {c.x, c.y - inner}, shade, line);
    draw->AddLine({c.x, c.y + inner}, {c.x, c.y + arm}, shade, line);
  }
}

void Gui::hands(int t, Rect r, bool hovered) {
  if (notice_) return;
  Workspace& w = desk_.workspace();
  const ImGuiIO& io = ImGui::GetIO();
  if (hovered && io.MouseWheel != 0 && !drag_) {
    w.setActive(t);
    const bool look = lookOf(w.tile(t).scene) != nullptr;
    if (look && !io.KeyShift && !io.KeyCtrl) return lookWheel(t, r, io.MouseWheel);
    wheel_ += io.MouseWheel;
    const int notches = static_cast<int>(wheel_);  // touch pads send parts of a notch
    wheel_ -= static_cast<float>(notches);
    if (io.KeyCtrl && lensWheel(t, r, notches)) return;
    if (look && !io.KeyShift) return lookWheel(t, r, io.MouseWheel);
    if (io.KeyShift)
      desk_.stepTime(t, -notches);
    else
      w.scroll(t, -notches);
  }
  if (measureHands(t, r, hovered)) return;
  if (!hovered || drag_ || lensHold_) return;
  if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
    // The first of the two clicks may have moved the crosshair, which was not meant.
    if (std::exchange(clickMadeStep_, false)) w.undo();
    w.setActive(t);
    w.toggleMaximised(t);
    return;
  }
  if (lensHands(t, r, hovered)) return;
  for (int button : {ImGuiMouseButton_Left, ImGuiMouseButton_Right, ImGuiMouseButton_Middle})
    if (ImGui::IsMouseClicked(button)) return beginDrag(t, button, r);
}

void Gui::beginDrag(int t, int button, Rect r) {
  Workspace& w = desk_.workspace();
  w.setActive(t);
  clickMadeStep_ = false;
  const auto place = desk_.placeOfTile(t);
  const auto camera = desk_.cameraOfTile(t);
  if (!place && !camera) return;
  const ImGuiIO& io = ImGui::GetIO();
  Drag d;
  d.tile = t, d.button = button, d.begin = io.MousePos;
  d.tool = button == ImGuiMouseButton_Right    ? Tool::Zoom
           : button == ImGuiMouseButton_Middle ? Tool::Pan
           : io.KeyCtrl                        ? Tool::Crosshair
                                               : tool_;
  d.scene = w.tile(t).scene;
  d.unit_mm = place ? place->unit_mm : camera->mmPerPixel();
  d.fromCentre_px = {io.MousePos.x - (r.x + r.w / 2), io.MousePos.y - (r.y + r.h / 2)};
  const auto& shown = desk_.tileView(t).picture;
  if (camera && !beginLookDrag(t, d)) return;
  if (d.tool == Tool::Window && !camera) {
    if (!shown || shown->error || (imageOf(d.scene) != nullptr) != (shown->frame != nullptr)) return;
    d.window = shown->window;
    d.inverted = shown->inverted;
  }
  drag_ = std::move(d);
  w.beginDrag();
}

void Gui::drag() {
  if (!drag_) return;
  Workspace& w = desk_.workspace();
  const ImGuiIO& io = ImGui::GetIO();
  Drag& d = *drag_;
  const glm::dvec2 way(io.MousePos.x - d.begin.x, io.MousePos.y - d.begin.y);
  const double scale = theme_.scale;
  switch (d.tool) {
    case Tool::Turn:
      dragLook(d, way);
      break;
    case Tool::Window:
      if (lookOf(d.scene)) {
        dragLook(d, way);
        break;
      }
      if (way != glm::dvec2(0, 0)) w.setWindow(d.tile, draggedWindow(d.window, way, d.inverted, scale));
      break;
    case Tool::Pan:
      w.setScene(d.tile, Gesture::Pan, panned(d.scene, way, d.unit_mm));
      break;
    case Tool::Zoom:
      w.setScene(d.tile, Gesture::Zoom, zoomed(d.scene, way, d.fromCentre_px, d.unit_mm, scale));
      break;
    case Tool::Scroll: {
      const int notches = static_cast<int>(way.y / (6 * scale));
      w.scroll(d.tile, notches - d.scrolled);
      d.scrolled = notches;
      break;
    }
    case Tool::Crosshair: {
      const View& view = desk_.tileView(d.tile).view;
      moveCrosshairTo(d.tile, d.fromCentre_px + way + 0.5 * glm::dvec2(view.width_px, view.height_px));
      break;
    }
  }
  if (ImGui::IsMouseDown(d.button)) return;
  clickMadeStep_ = w.endDrag() && way == glm::dvec2(0, 0);
  drag_.reset();
}

void Gui::probe(int t, Rect r) {
  const TileView& shown = desk_.tileView(t);
  if (!shown.picture || shown.picture->error) return;
  const SourceFacts* f = desk_.workspace().factsOfTile(t);
  if (f && shown.camera) return probeLook(t, pixelUnderPointer(r));
  if (!f || !shown.place) return;
  const FinishedPicture& p = *shown.picture;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const glm::dvec2 px(std::floor(mouse.x - r.x) + 0.5, std::floor(mouse.y - r.y) + 0.5);
  if (p.frame)
    probe_ = probeImage(*shown.place, *p.frame, *f, px);
  else if (p.volume)
    probe_ = probeVolume(*shown.place, *p.volume, *f, px, sliceOf(p.scene)->slab.thickness_mm > 0);
}

void Gui::hoverDetails(int t, Rect r) {
  const TileView& shown = desk_.tileView(t);
  if (!shown.picture || shown.picture->error || drag_) return;
  const FinishedPicture& p = *shown.picture;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const int x = static_cast<int>(mouse.x - r.x), y = static_cast<int>(mouse.y - r.y);
  for (const LaidText& text : p.layout.texts) {
    const Box& b = text.box;
    if (text.text != p.errorLine || x < b.x || y < b.y || x >= b.x + b.width || y >= b.y + b.height) continue;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(theme_.px(420));
    if (p.measured)
      ImGui::TextUnformatted(p.errorText.c_str());
    else
      ImGui::TextUnformatted("A draft: its error is measured as soon as nothing moves.");
    ImGui::TextDisabled("Drawn in %.1f ms by %s", p.render_ms, p.engine.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
}

}  // namespace vernier::ui
