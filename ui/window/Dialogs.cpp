// SPDX-License-Identifier: GPL-3.0-or-later
// Help, the notice at first start, and messages.
#include "Dialog.h"
#include "Gui.h"

namespace vernier::ui {
namespace {

struct Binding {
  const char *what, *how;
};
constexpr Binding kBindings[] = {
    {"Left drag", "the tool chosen above; Window at first: right wider, up brighter"},
    {"Ctrl + left drag", "moves the crosshair"},
    {"Middle drag", "moves the picture"},
    {"Right drag", "magnifies: up larger"},
    {"Wheel", "one slice a notch; 3-D: larger and smaller"},
    {"Shift + wheel", "next time point or echo, where the series has them"},
    {"Up, Down, Home, End", "one slice; first and last slice"},
    {"Double click", "one picture alone, and back"},
    {"0, 1 .. 9", "the file's own window; window presets, as numbered in the menu"},
    {"W  C  P  Z  S", "tools: Window, Crosshair, Pan, Zoom, Scroll"},
    {"L  A  Y  D", "measure once: length, angle, Cobb angle, diameters (long and short axis)"},
    {"E  B  O  H", "ellipse, box, polygon (double click or Enter closes it), outline by hand"},
    {"V  N  X", "value, arrow, text"},
    {"M", "list of measurements"},
    {"G", "a lens on reformats and in 3-D, at the pointer; in a lens: what it shows next"},
    {"Ctrl + wheel on a lens", "scales it, as dragging its outline does; dragging its inside moves it"},
    {"Del", "takes the chosen measurement or lens away"},
    {"I, R", "inverts; whole picture in sight again"},
    {"F2  F3  F4  F5", "stack, two side by side, MPR, 3-D"},
    {"3-D: left drag, arrows", "turn; with Shift the window, or what a rendering shows"},
    {"3-D: 1 .. 9", "looks, as numbered in the menu; 0 as they were"},
    {"T", "scrolls, moves and magnifies pictures of one view together"},
    {"K, hold F", "two side by side: wipe under the pointer; the other one instead"},
    {"Ctrl+Z, Ctrl+Y", "undo, redo"},
    {"Ctrl+B, Ctrl+Q", "shows or hides the list of studies; quits"},
    {"Esc", "cancels measuring or loading, closes this"},
};

}  // namespace

void Gui::help() {
  if (!help_) return;
  const Dialog dialog(theme_, "##help", "Mouse and keys");
  ImGui::Dummy({0, theme_.px(4)});
  if (ImGui::BeginTable("##bindings", 2, ImGuiTableFlags_SizingFixedFit)) {
    for (const Binding& b : kBindings) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(b.what);
      ImGui::SameLine(0, theme_.px(24));
      ImGui::Dummy({0, 0});
      ImGui::TableNextColumn();
      ImGui::TextDisabled("%s", b.how);
    }
    ImGui::EndTable();
  }
  ImGui::Dummy({0, theme_.px(6)});
  if (dialogButton("Close", theme_.px(96))) help_ = false;
}

void Gui::notice() {
  if (!notice_) return;
  ImGui::SetNextWindowFocus();
  const Dialog dialog(theme_, "##notice", "Vernier is not a medical device", {24, 20});
  ImGui::Dummy({0, theme_.px(2)});
  ImGui::PushTextWrapPos(theme_.px(440));
  ImGui::TextUnformatted(
      "It is made for review, for planning and for checking images. It is not for primary diagnosis.");
  ImGui::PopTextWrapPos();
  ImGui::Dummy({0, theme_.px(8)});
  if (dialogButton("Understood", theme_.px(120)) ||
      ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false)) {
    notice_ = false;
    if (noticeAccepted_) why_ = noticeAccepted_();
  }
}

void Gui::messages(Rect r) {
  std::vector<std::string> all = desk_.messages();
  if (!why_.empty()) all.push_back(why_);
  if (all.empty()) return;
  const float width = std::min(r.w - theme_.px(40), theme_.px(560));
  ImGui::SetNextWindowPos({r.x + r.w / 2, r.y + r.h - theme_.px(18)}, ImGuiCond_Always, {0.5f, 1});
  ImGui::SetNextWindowSize({width, 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::kRaised);
  ImGui::PushStyleColor(ImGuiCol_Border, colour::kAmber);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, theme_.px(5));
  ImGui::Begin("##messages", nullptr, kDialog | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushTextWrapPos(width - theme_.px(90));
  const std::size_t first = all.size() > 3 ? all.size() - 3 : 0;
  for (std::size_t k = first; k < all.size(); ++k) ImGui::TextUnformatted(all[k].c_str());
  ImGui::PopTextWrapPos();
  ImGui::SetCursorPos({width - theme_.px(78), theme_.px(7)});
  if (dialogButton("Close", theme_.px(68))) {
    why_.clear();
    desk_.dismissMessages();
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor(2);
}

}  // namespace vernier::ui
