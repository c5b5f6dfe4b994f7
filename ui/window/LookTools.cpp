// SPDX-License-Identifier: GPL-3.0-or-later
// Looks through a volume under the hand: what is shown, from where, and the point that is seen.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

#include "Gui.h"
#include "Looks.h"

namespace vernier::ui {
namespace {

constexpr double kNotch_px = 10, kArrow_px = 30;  // a notch of the wheel, an arrow key, as ways of the hand

}  // namespace

double Gui::aspectOf(int t) const {
  const View& v = desk_.tileView(t).view;
  return v.height_px > 0 ? static_cast<double>(v.width_px) / v.height_px : 1;
}

void Gui::invert(int t) {
  Workspace& w = desk_.workspace();
  why_.clear();
  const Layer* look = lookOf(w.tile(t).scene);
  const bool lensed = w.sceneOf(t).layers.size() > w.tile(t).scene.layers.size();
  if (look && std::holds_alternative<ProjectionLayer>(*look) && lensed)
    why_ = "A projection with a lens is not inverted; take the lens away (Del) first.";
  else
    w.invert(t);
}

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
    if (ImGui::Selectable(d.name)) w.setScene(t, Gesture::Look, seenFrom(tile.scene, d));
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
      if (auto* iso = std::get_if<IsosurfaceLayer>(&layer)) iso->level.reset();
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
// renderings and the level of surfaces.
bool Gui::beginLookDrag(int t, Drag& d) {
  const View& view = desk_.tileView(t).view;
  const glm::dvec2 px = d.fromCentre_px + 0.5 * glm::dvec2(view.width_px, view.height_px);
  if (d.tool == Tool::Crosshair && !desk_.pick(t, px))
    why_ = "Nothing is seen there that has a place: click on what the picture shows.";
  if (d.tool != Tool::Window && d.tool != Tool::Scroll) return true;
  d.tool = ImGui::GetIO().KeyShift ? Tool::Window : Tool::Turn;
  if (d.tool == Tool::Turn) return true;
  const auto& shown = desk_.tileView(t).picture;
  if (!shown || shown->error || !shown->volume) return false;
  Layer layer = *lookOf(d.scene);
  if (windowOf(layer)) {
    d.window = shown->window, d.inverted = shown->inverted;
    return true;
  }
  if (const auto* iso = std::get_if<IsosurfaceLayer>(&layer); iso && !shown->volume->isColour()) {
    const auto range = shown->volume->modalityRange();
    const double level = iso->level.value_or(defaultIsoLevel(*shown->volume));
    d.window =
        VoiWindow{level, range ? std::max(range->max - range->min, 1e-30) : 1, VoiFunction::LinearExact, ""};
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
  for (Layer& any : scene.layers) {
    if (auto* volume = std::get_if<VolumeLayer>(&any))
      volume->transfer = draggedTransfer(d.transfer, way, theme_.scale);
    if (auto* iso = std::get_if<IsosurfaceLayer>(&any))  // up: lower, as of windows
      iso->level = draggedWindow(d.window, {0, way.y}, false, theme_.scale).center;
  }
  w.setScene(d.tile, Gesture::Window, std::move(scene));
}

// To the point under the hand; in a look through a volume to the one that is seen there.
void Gui::moveCrosshairTo(int t, glm::dvec2 px) {
  Workspace& w = desk_.workspace();
  if (lookOf(w.tile(t).scene)) {
    if (const auto seen = desk_.pick(t, px)) w.moveCrosshair(t, *seen);
    return;
  }
  const auto place = desk_.placeOfTile(t);
  if (place && place->inPatient) w.moveCrosshair(t, place->patientAt(px));
}

void Gui::probeLook(int t, glm::dvec2 px) {
  const SourceFacts* f = desk_.workspace().factsOfTile(t);
  const FinishedPicture& shown = *desk_.tileView(t).picture;
  const auto seen = desk_.pick(t, px);
  if (!f || !shown.volume) return;
  const auto* projection = std::get_if<ProjectionLayer>(lookOf(shown.scene));
  if (!seen) {
    if (projection && projection->mode == ProjectionMode::Mean)
      probe_.value = "mean along the ray",
      probe_.origin = "it has no single value and no place in the patient";
    return;
  }
  probe_ = probePoint(*shown.volume, *f, *seen);
  probe_.value = (projection ? "projected: " : "seen here: ") + probe_.value;
}

// Where the crosshair is, whatever lies before it.
void Gui::crosshairInLook(int t, Rect r) {
  const TileView& shown = desk_.tileView(t);
  const auto cross = desk_.workspace().crosshair(t);
  if (!shown.camera || !shown.picture || shown.picture->error || !cross) return;
  const glm::dvec4 at = shown.camera->pixelFromPatient() * glm::dvec4(cross->p, 1);
  if (!(at.w > 0)) return;
  // Whole pixels, so that thin lines keep their colour.
  const ImVec2 c(r.x + std::floor(static_cast<float>(at.x / at.w)),
                 r.y + std::floor(static_cast<float>(at.y / at.w)));
  const float arm = theme_.px(14), inner = theme_.px(5), line = std::max(1.0f, theme_.px(1));
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
