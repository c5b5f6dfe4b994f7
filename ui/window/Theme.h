// SPDX-License-Identifier: GPL-3.0-or-later
// Colours, fonts and spacing of the window, for one scale. Lengths in px at 100 %; px(x) gives screen pixels.
#pragma once
#include <imgui.h>

#include <string>

namespace vernier::ui {

namespace colour {
inline constexpr ImU32 kBack = IM_COL32(17, 19, 22, 255), kPanel = IM_COL32(24, 27, 31, 255),
                       kRaised = IM_COL32(35, 40, 46, 255), kLine = IM_COL32(46, 52, 60, 255),
                       kText = IM_COL32(218, 223, 229, 255), kDim = IM_COL32(142, 151, 161, 255),
                       kAccent = IM_COL32(84, 164, 214, 255), kAccentDark = IM_COL32(38, 78, 105, 255),
                       kGood = IM_COL32(112, 190, 122, 255), kAmber = IM_COL32(240, 180, 70, 255),
                       kRed = IM_COL32(226, 84, 78, 255), kRedBand = IM_COL32(150, 32, 30, 255),
                       kImage = IM_COL32(0, 0, 0, 255);
}  // namespace colour

struct Theme {
  float scale = 1;
  ImFont *body = nullptr, *small = nullptr, *bold = nullptr;
  float px(float x) const { return x * scale; }
};

// Fills ImGui's style and font atlas; `alsoShown` is text whose characters the fonts should have.
Theme makeTheme(float scale, const std::string& alsoShown);

// Colour of the planes of a view: chips, reference lines.
ImU32 colourOfView(const std::string& view);

}  // namespace vernier::ui
