// SPDX-License-Identifier: GPL-3.0-or-later
#include "Gui.h"

#include <GLFW/glfw3.h>

#include <cstdio>

namespace vernier::ui {
namespace {

constexpr float kTopBar = 46, kStatusBar = 28, kBrowser = 296, kOneRow = 1275, kList = 280;

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav;

bool pressed(int key) { return ImGui::IsKeyPressed(key, false); }

}  // namespace

void Gui::frame() {
  const ImGuiIO& io = ImGui::GetIO();
  const float w = io.DisplaySize.x, h = io.DisplaySize.y;
  const bool twoRows = w < theme_.px(kOneRow);
  const float top = theme_.px(twoRows ? 2 * kTopBar - 22 : kTopBar), bottom = theme_.px(kStatusBar);
  const float side = browserShown_ ? std::min(theme_.px(kBrowser), w * 0.4f) : 0;
  probe_ = {};
  keys();
  ImGui::PushFont(theme_.body);
  topBar({0, 0, w, top}, twoRows);
  const float list = listShown_ ? std::min(theme_.px(kList), w * 0.3f) : 0;
  if (browserShown_) browser({0, top, side, h - top - bottom});
  tiles({side, top, w - side - list, h - top - bottom});
  if (listShown_) measureList({w - list, top, list, h - top - bottom});
  writing();
  statusBar({0, h - bottom, w, bottom});
  messages({side, top, w - side, h - top - bottom});
  help();
  quality();
  notice();
  ImGui::PopFont();
  way_.clear();  // a frame that is laid out twice takes it once
}

void Gui::keys() {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.KeyCtrl && pressed(GLFW_KEY_Q)) quit_ = true;  // whatever is open
  if (io.WantTextInput) return;
  Workspace& w = desk_.workspace();
  const int active = w.now().active;
  if (pressed(GLFW_KEY_ESCAPE)) {
    if (help_)
      help_ = false;
    else if (qualityShown_ && desk_.quality().state().phase != QualityState::Phase::Running)
      qualityShown_ = false;
    else if (ruler_)
      takeRuler({});
    else if (desk_.progress())
      desk_.cancelLoading();
    why_.clear();
  }
  if (pressed(GLFW_KEY_F1)) help_ = !help_;
  // What is in the hand is a scene of before: nothing else changes it meanwhile.
  if (notice_ || drag_ || lensHold_ || grip_) return;
  if (io.KeyCtrl) {
    if (pressed(GLFW_KEY_Z) && !io.KeyShift) w.undo();
    if (pressed(GLFW_KEY_Y) || (pressed(GLFW_KEY_Z) && io.KeyShift)) w.redo();
    if (pressed(GLFW_KEY_B)) browserShown_ = !browserShown_;
    return;
  }
  if (pressed(GLFW_KEY_F2)) w.openStack();
  if (pressed(GLFW_KEY_F3)) w.setLayout(Layout::Pair);
  if (pressed(GLFW_KEY_F4))
    if (const Result<void> r = desk_.openMpr(); !r) why_ = r.error().sentence;
  if (pressed(GLFW_KEY_F5))
    if (const Result<void> r = w.open3d(); !r) why_ = r.error().sentence;
  const std::pair<int, Tool> tools[] = {{GLFW_KEY_W, Tool::Window},
                                        {GLFW_KEY_C, Tool::Crosshair},
                                        {GLFW_KEY_P, Tool::Pan},
                                        {GLFW_KEY_Z, Tool::Zoom},
                                        {GLFW_KEY_S, Tool::Scroll}};
  for (const auto& [key, tool] : tools)
    if (pressed(key)) tool_ = tool, takeRuler({});
  measureKeys();
  if (pressed(GLFW_KEY_T)) w.setTogether(!w.now().together);
  if (pressed(GLFW_KEY_K)) wipe_ = !wipe_ && mayLayOver();
  if (pressed(GLFW_KEY_F)) (void)mayLayOver();  // says why not; while it is down: TilePanel.cpp
  if (pressed(GLFW_KEY_I)) invert(active);
  if (pressed(GLFW_KEY_R)) w.resetView(active, aspectOf(active));
  if (lookKeys()) return;
  if (ImGui::IsKeyPressed(GLFW_KEY_DOWN) || ImGui::IsKeyPressed(GLFW_KEY_PAGE_DOWN)) w.scroll(active, 1);
  if (ImGui::IsKeyPressed(GLFW_KEY_UP) || ImGui::IsKeyPressed(GLFW_KEY_PAGE_UP)) w.scroll(active, -1);
  if (pressed(GLFW_KEY_HOME)) w.scroll(active, -1'000'000);
  if (pressed(GLFW_KEY_END)) w.scroll(active, 1'000'000);
  const auto& shown = desk_.tileView(active).picture;
  if (!shown || shown->error) return;
  if (pressed(GLFW_KEY_0)) w.choose(active, {});
  const std::vector<WindowChoice> choices = windowChoices(shown->windowFacts);
  for (std::size_t k = 0; k < 9 && k < choices.size(); ++k)
    if (pressed(GLFW_KEY_1 + static_cast<int>(k))) w.choose(active, choices[k]);
}

bool Gui::toggle(const char* label, bool on, const char* hint) {
  if (on) ImGui::PushStyleColor(ImGuiCol_Button, colour::kAccentDark);
  const bool clicked = ImGui::Button(label);
  if (on) ImGui::PopStyleColor();
  if (hint && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", hint);
  return clicked;
}

void Gui::layoutButtons() {
  Workspace& w = desk_.workspace();
  const Layout now = w.now().layout;
  const SourceFacts* f = w.factsOfTile(w.now().active);
  if (toggle("Stack", now == Layout::Single, "The acquired images, one at a time (F2)")) w.openStack();
  ImGui::SameLine();
  if (toggle("Pair", now == Layout::Pair, "Two pictures side by side (F3)")) w.setLayout(Layout::Pair);
  ImGui::SameLine();
  const bool can = f && f->grid;
  if (!can) ImGui::PushStyleColor(ImGuiCol_Text, colour::kDim);
  std::string hint = "Axial, coronal, sagittal and oblique of this stack (F4)";
  if (f && !can) hint = "Not for this stack: " + f->why2d;
  if (!f) hint = "Open a series first.";
  const bool through = lookOf(w.tile(kTiles - 1).scene) != nullptr;
  const bool mpr = toggle("MPR", now == Layout::Quad && !through, hint.c_str());
  ImGui::SameLine();
  if (can) hint = "Slices and a look through the volume: MIP, rendering, surface (F5)";
  const bool look = toggle("3-D", now == Layout::Quad && through, hint.c_str());
  if (!can) ImGui::PopStyleColor();
  if (!mpr && !look) return;
  const Result<void> r = mpr ? desk_.openMpr() : w.open3d();
  why_ = r ? "" : r.error().sentence;
}

void Gui::toolButtons() {
  const std::tuple<const char*, Tool, const char*> rows[] = {
      {"Window", Tool::Window, "Left drag: right wider, up brighter (W). In 3-D it turns; Shift: window"},
      {"Crosshair", Tool::Crosshair, "Left drag moves the crosshair (C); Ctrl+drag with any tool"},
      {"Pan", Tool::Pan, "Left drag moves the picture (P); middle drag with any tool"},
      {"Zoom", Tool::Zoom, "Left drag magnifies (Z); right drag with any tool"},
      {"Scroll", Tool::Scroll, "Left drag goes through the slices (S); the wheel with any tool"}};
  for (const auto& [label, tool, hint] : rows) {
    if (tool != Tool::Window) ImGui::SameLine(0, theme_.px(4));
    if (toggle(label, tool_ == tool && !ruler_, hint)) tool_ = tool, takeRuler({});
  }
}

void Gui::windowMenu() {
  Workspace& w = desk_.workspace();
  const int active = w.now().active;
  const auto& shown = desk_.tileView(active).picture;
  const bool can = shown && !shown->error;
  ImGui::SetNextItemWidth(theme_.px(132));
  if (lookMenu()) return;
  if (!ImGui::BeginCombo("##presets", "Presets", ImGuiComboFlags_HeightLarge)) return;
  if (can) {
    if (ImGui::Selectable("File default   0")) w.choose(active, {});
    int number = 0;
    for (const WindowChoice& c : windowChoices(shown->windowFacts)) {
      ++number;
      std::string label = c.name;
      if (number <= 9) label += "   " + std::to_string(number);
      if (ImGui::Selectable((label + "##" + std::to_string(number)).c_str())) w.choose(active, c);
      if (c.window && ImGui::IsItemHovered())
        ImGui::SetTooltip("C %g  W %g", c.window->center, c.window->width);
    }
  } else {
    ImGui::TextDisabled("No picture yet");
  }
  ImGui::EndCombo();
}

void Gui::viewButtons() {
  Workspace& w = desk_.workspace();
  windowMenu();
  const int active = w.now().active;
  ImGui::SameLine();
  if (toggle("Invert", false, "Dark and bright change places (I)")) invert(active);
  ImGui::SameLine(0, theme_.px(4));
  if (toggle("Fit", false, "Whole picture in sight again (R)")) w.resetView(active, aspectOf(active));
}

void Gui::historyButtons() {
  Workspace& w = desk_.workspace();
  ImGui::BeginDisabled(!w.canUndo());
  if (toggle("Undo", false, "Ctrl+Z")) w.undo();
  ImGui::EndDisabled();
  ImGui::SameLine(0, theme_.px(4));
  ImGui::BeginDisabled(!w.canRedo());
  if (toggle("Redo", false, "Ctrl+Y")) w.redo();
  ImGui::EndDisabled();
}

// One row where there is room, else two.
void Gui::topBar(Rect r, bool twoRows) {
  ImGui::SetNextWindowPos({r.x, r.y});
  ImGui::SetNextWindowSize({r.w, r.h});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme_.px(10), theme_.px(9)});
  ImGui::Begin("##top", nullptr, kFixed);
  ImGui::PopStyleVar();
  const float group = theme_.px(16);
  ImGui::PushFont(theme_.bold);
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("Vernier");
  ImGui::PopFont();
  ImGui::SameLine(0, group);
  if (toggle("Studies", browserShown_, "Shows or hides the list of studies (Ctrl+B)"))
    browserShown_ = !browserShown_;
  ImGui::SameLine(0, group);
  layoutButtons();
  ImGui::SameLine(0, group);
  if (!twoRows) {
    toolButtons();
    ImGui::SameLine(0, group);
    viewButtons();
    ImGui::SameLine(0, group);
  }
  historyButtons();
  ImGui::SameLine(0, group);
  measureMenu();
  const float help = ImGui::CalcTextSize("Help").x + 2 * ImGui::GetStyle().FramePadding.x;
  ImGui::SameLine(std::max(ImGui::GetCursorPosX(), r.w - help - theme_.px(10)));
  if (toggle("Help", help_ || qualityShown_, "Mouse and keys (F1); check of this installation"))
    ImGui::OpenPopup("##helpmenu");
  helpMenu(ImGui::GetItemRectMax());
  if (twoRows) {
    toolButtons();
    ImGui::SameLine(0, group);
    viewButtons();
  }
  ImGui::GetWindowDrawList()->AddLine({r.x, r.y + r.h - 1}, {r.x + r.w, r.y + r.h - 1}, colour::kLine);
  ImGui::End();
}

void Gui::statusBar(Rect r) {
  ImGui::SetNextWindowPos({r.x, r.y});
  ImGui::SetNextWindowSize({r.w, r.h});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme_.px(10), theme_.px(5)});
  ImGui::Begin("##status", nullptr, kFixed);
  ImGui::PopStyleVar();
  ImGui::GetWindowDrawList()->AddLine({r.x, r.y}, {r.x + r.w, r.y}, colour::kLine);
  float right = r.w - theme_.px(10);
  if (const auto p = desk_.progress()) {
    const float w = theme_.px(220), button = theme_.px(64);
    const float share = p->total > 0 ? static_cast<float>(p->done) / static_cast<float>(p->total) : 0;
    char text[160];
    std::snprintf(text, sizeof text, "%s %d %%", p->opening ? "Reading files" : "Loading volume",
                  static_cast<int>(100 * share));
    right -= w + button + theme_.px(6);
    ImGui::SetCursorPos({right, theme_.px(4)});
    ImGui::PushFont(theme_.small);
    ImGui::ProgressBar(share, {w, theme_.px(20)}, text);
    ImGui::SameLine(0, theme_.px(6));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {theme_.px(6), theme_.px(2)});
    if (ImGui::Button("Cancel", {button, theme_.px(20)})) desk_.cancelLoading();
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Esc");
    ImGui::PopStyleVar();
    ImGui::PopFont();
    right -= theme_.px(10);
  }
  ImGui::PushFont(theme_.small);
  const float place = ImGui::CalcTextSize(probe_.place.c_str()).x;
  ImGui::SetCursorPos({right - place, theme_.px(7)});
  ImGui::TextUnformatted(probe_.place.c_str());
  const float left = theme_.px(10);
  ImGui::PushClipRect({r.x, r.y}, {r.x + right - place - theme_.px(10), r.y + r.h}, true);
  ImGui::SetCursorPos({left, theme_.px(7)});
  if (!probe_.value.empty()) {
    ImGui::TextUnformatted(probe_.value.c_str());
    ImGui::SameLine(0, theme_.px(14));
    ImGui::TextDisabled("%s", probe_.origin.c_str());
  } else {
    ImGui::TextDisabled("Point at a picture for its value. F1 shows mouse and keys.");
  }
  ImGui::PopClipRect();
  ImGui::PopFont();
  ImGui::End();
}

}  // namespace vernier::ui
