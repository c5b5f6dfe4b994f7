// SPDX-License-Identifier: GPL-3.0-or-later
// Looks through a volume under the hand: what is shown, from where, and the point that is seen.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "Gui.h"
#include "Looks.h"

namespace vernier::ui {
namespace {

constexpr double kNotch_px = 10, kArrow_px = 30;  // a notch of the wheel, an arrow key, as ways of the hand

}  // namespace

// In place of the window presets: looks, windows where the look has one, directions.
bool Gui::lookMenu() {
  Workspace& w = desk_.workspace();
  const int t = w.now().active;
  const SourceFacts* f = w.factsOfTile(t);
  const Tile tile = w.tile(t);
  if (!f || !lookOf(tile.scene)) return false;
  const std::string name = nameOfLook(tile.scene, tile.view, *f);
  if (!ImGui::BeginCombo("##presets", name.c_str(), ImGuiComboFlags_HeightLargest)) return true;
  int number = 0;
  for (const VolumeLook& look : volumeLooks(*f)) {
    ++number;
    std::string label = look.name;
    if (number <= 9) label += "   " + std::to_string(number);
    if (ImGui::Selectable((label + "##look" + std::to_string(number)).c_str(), look.name == name))
      w.setLook(t, look);
  }
  const auto& shown = desk_.tileView(t).picture;
  Layer layer = *lookOf(tile.scene);
  if (windowOf(layer) && shown && !shown->error) {
    ImGui::Separator();
    if (ImGui::Selectable("All values   0")) w.choose(t, {});
    for (const WindowChoice& c : windowChoices(shown->windowFacts))
      if (c.window && ImGui::Selectable((c.name + "##window").c_str())) w.choose(t, c);
  }
  ImGui::Separator();
  ImGui::TextDisabled("Seen from");
  for (const Direction& d : directions())
    if (ImGui::Selectable(d.name)) w.setScene(t, Gesture::WheelTurn, seenFrom(tile.scene, d));
  ImGui::EndCombo();
  return true;
}

// 1 .. 9 choose looks, 0 all values or the transfer function as it was, arrows turn; true: the tile is one.
bool Gui::lookKeys() {
  Workspace& w = desk_.workspace();
  const int t = w.now().active;
  const SourceFacts* f = w.factsOfTile(t);
  if (!f || !lookOf(w.tile(t).scene)) return false;
  const std::vector<VolumeLook> looks = volumeLooks(*f);
  for (std::size_t k = 0; k < 9 && k < looks.size(); ++k)
    if (ImGui::IsKeyPressed(GLFW_KEY_1 + static_cast<int>(k), false)) w.setLook(t, looks[k]);
  if (ImGui::IsKeyPressed(GLFW_KEY_0, false)) {
    Scene scene = w.tile(t).scene;
    for (Layer& layer : scene.layers) {
      if (auto* volume = std::get_if<VolumeLayer>(&layer)) volume->transfer.reset();
      if (auto* window = windowOf(layer)) window->reset();
    }
    w.setScene(t, Gesture::Window, std::move(scene));
  }
  const std::pair<int, glm::dvec2> arrows[] = {{GLFW_KEY_LEFT, {-kArrow_px, 0}},
                                               {GLFW_KEY_RIGHT, {kArrow_px, 0}},
                                               {GLFW_KEY_UP, {0, -kArrow_px}},
                                               {GLFW_KEY_DOWN, {0, kArrow_px}}};
  for (const auto& [key, way] : arrows)
    if (ImGui::IsKeyPressed(key)) w.setScene(t, Gesture::WheelTurn, turned(w.tile(t).scene, way));
  return true;
}

// Towards the point under the pointer, and away from it.
void Gui::lookWheel(int t, Rect r, float notches) {
  Workspace& w = desk_.workspace();
  const auto camera = desk_.cameraOfTile(t);
  if (!camera) return;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const glm::dvec2 fromCentre(mouse.x - (r.x + r.w / 2), mouse.y - (r.y + r.h / 2));
  w.setScene(t, Gesture::WheelZoom,
             zoomed(w.tile(t).scene, {0, -kNotch_px * notches}, fromCentre, camera->mmPerPixel()));
}

// The left button turns; with Shift it windows what has a window, and drags the transfer function of
// renderings.
bool Gui::beginLookDrag(int t, Drag& d) {
  const bool windowing = d.tool == Tool::Window && ImGui::GetIO().KeyShift;
  if (!windowing) {
    if (d.tool == Tool::Window || d.tool == Tool::Scroll) d.tool = Tool::Turn;
    return true;
  }
  const auto& shown = desk_.tileView(t).picture;
  if (!shown || shown->error || !shown->volume) return false;
  Layer layer = *lookOf(d.scene);
  if (windowOf(layer)) {
    d.window = shown->window, d.inverted = shown->inverted;
    return true;
  }
  const auto* volume = std::get_if<VolumeLayer>(&layer);
  if (!volume || shown->volume->isColour()) return false;
  if (volume->transfer) {
    d.transfer = *volume->transfer;
    return true;
  }
  const std::string name = volume->preset.empty() ? defaultTransferPreset(*shown->volume) : volume->preset;
  Result<TransferFunction> transfer = transferPreset(name, *shown->volume);
  if (transfer) d.transfer = *std::move(transfer);
  return transfer.ok();
}

void Gui::dragLook(const Drag& d, glm::dvec2 way) {
  Workspace& w = desk_.workspace();
  if (d.tool == Tool::Turn) {
    w.setScene(d.tile, Gesture::Turn, turned(d.scene, way, theme_.scale));
    return;
  }
  if (way == glm::dvec2(0, 0)) return;
  Layer layer = *lookOf(d.scene);
  if (windowOf(layer)) {
    w.setWindow(d.tile, draggedWindow(d.window, way, d.inverted, theme_.scale));
    return;
  }
  Scene scene = d.scene;
  for (Layer& any : scene.layers)
    if (auto* volume = std::get_if<VolumeLayer>(&any))
      volume->transfer = draggedTransfer(d.transfer, way, theme_.scale);
  w.setScene(d.tile, Gesture::Window, std::move(scene));
}

// To the point under the hand; in a look through a volume to the one that is seen there.
bool Gui::moveCrosshairTo(int t, glm::dvec2 px) {
  Workspace& w = desk_.workspace();
  if (lookOf(w.tile(t).scene)) {
    const auto picked = desk_.pick(t, px);
    if (picked) w.moveCrosshair(t, picked->point);
    return picked.has_value();
  }
  const auto place = desk_.placeOfTile(t);
  if (!place || !place->inPatient) return false;
  w.moveCrosshair(t, place->patientAt(px));
  return true;
}

void Gui::probeLook(int t, glm::dvec2 px) {
  const SourceFacts* f = desk_.workspace().factsOfTile(t);
  const FinishedPicture& shown = *desk_.tileView(t).picture;
  const auto picked = desk_.pick(t, px);
  if (!f || !picked || !shown.volume) return;
  probe_ = probePoint(*shown.volume, *f, picked->point);
  if (!picked->value) {
    probe_.value = "seen here: " + probe_.value;
    return;
  }
  char text[64];
  std::snprintf(text, sizeof text, "%.6g", std::round(*picked->value * 100) / 100);
  probe_.value = std::string("projected: ") + text +
                 (shown.windowFacts.unit.empty() ? "" : " " + shown.windowFacts.unit);
}

// Where the crosshair is, whatever lies before it.
void Gui::crosshairInLook(int t, Rect r) {
  const TileView& shown = desk_.tileView(t);
  const auto cross = desk_.workspace().crosshair(t);
  if (!shown.camera || !shown.picture || shown.picture->error || !cross) return;
  const glm::dvec4 at = shown.camera->pixelFromPatient() * glm::dvec4(cross->p, 1);
  if (!(at.w > 0)) return;
  const ImVec2 c(r.x + static_cast<float>(at.x / at.w), r.y + static_cast<float>(at.y / at.w));
  const float arm = theme_.px(10), inner = theme_.px(4), line = std::max(1.0f, theme_.px(1));
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const auto mark = [&](ImU32 shade, float thick) {
    for (const ImVec2 way : {ImVec2(1, 0), ImVec2(-1, 0), ImVec2(0, 1), ImVec2(0, -1)})
      draw->AddLine({c.x + inner * way.x, c.y + inner * way.y}, {c.x + arm * way.x, c.y + arm * way.y}, shade,
                    thick);
  };
  mark(IM_COL32(0, 0, 0, 190), line + theme_.px(2));
  mark(colour::kAccent, line);
}

}  // namespace vernier::ui
