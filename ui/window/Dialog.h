// SPDX-License-Identifier: GPL-3.0-or-later
// A box in the middle of the window, with a title, as long as it lives; drawn between frames as all of ImGui.
#pragma once
#include "Theme.h"

namespace vernier::ui {

inline constexpr ImGuiWindowFlags kDialog = ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                                            ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                                            ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar;

class Dialog {
 public:
  Dialog(const Theme& theme, const char* id, const char* title, ImVec2 padding = {22, 18}) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::kRaised);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme.px(padding.x), theme.px(padding.y)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
    ImGui::Begin(id, nullptr, kDialog);
    ImGui::PushFont(theme.bold);
    ImGui::TextUnformatted(title);
    ImGui::PopFont();
  }
  ~Dialog() {
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::PopStyleColor();
  }
  Dialog(const Dialog&) = delete;
  Dialog& operator=(const Dialog&) = delete;
};

// On a dialog's ground, which is of the colour of the other buttons.
inline bool dialogButton(const char* label, float width) {
  ImGui::PushStyleColor(ImGuiCol_Button, colour::kAccentDark);
  const bool clicked = ImGui::Button(label, {width, 0});
  ImGui::PopStyleColor();
  return clicked;
}

}  // namespace vernier::ui
