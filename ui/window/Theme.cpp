// SPDX-License-Identifier: GPL-3.0-or-later
#include "Theme.h"

#include <cmath>

namespace vernier {
extern const unsigned char kUiFontFile[];
extern const unsigned kUiFontFile_bytes;
extern const unsigned char kUiBoldFontFile[];
extern const unsigned kUiBoldFontFile_bytes;
}  // namespace vernier

namespace vernier::ui {
namespace {

ImVec4 vec(ImU32 c) { return ImGui::ColorConvertU32ToFloat4(c); }

ImFont* font(const unsigned char* data, unsigned bytes, float size_px, const ImWchar* ranges) {
  ImFontConfig config;
  config.FontDataOwnedByAtlas = false;
  config.OversampleH = 2;
  config.PixelSnapH = true;
  return ImGui::GetIO().Fonts->AddFontFromMemoryTTF(const_cast<unsigned char*>(data), static_cast<int>(bytes),
                                                    std::round(size_px), &config, ranges);
}

void colours(ImGuiStyle& s) {
  using namespace colour;
  ImVec4* c = s.Colors;
  c[ImGuiCol_Text] = vec(kText), c[ImGuiCol_TextDisabled] = vec(kDim);
  c[ImGuiCol_WindowBg] = vec(kPanel), c[ImGuiCol_ChildBg] = {0, 0, 0, 0}, c[ImGuiCol_PopupBg] = vec(kRaised);
  c[ImGuiCol_Border] = vec(kLine), c[ImGuiCol_BorderShadow] = {0, 0, 0, 0};
  c[ImGuiCol_FrameBg] = vec(IM_COL32(14, 16, 19, 255)), c[ImGuiCol_FrameBgHovered] = vec(kRaised);
  c[ImGuiCol_FrameBgActive] = vec(kRaised);
  c[ImGuiCol_Button] = vec(kRaised), c[ImGuiCol_ButtonHovered] = vec(IM_COL32(50, 57, 66, 255));
  c[ImGuiCol_ButtonActive] = vec(kAccentDark);
  c[ImGuiCol_Header] = vec(kAccentDark), c[ImGuiCol_HeaderHovered] = vec(IM_COL32(44, 50, 58, 255));
  c[ImGuiCol_HeaderActive] = vec(kAccentDark);
  c[ImGuiCol_ScrollbarBg] = {0, 0, 0, 0}, c[ImGuiCol_ScrollbarGrab] = vec(IM_COL32(58, 65, 74, 255));
  c[ImGuiCol_ScrollbarGrabHovered] = vec(IM_COL32(78, 87, 98, 255)),
  c[ImGuiCol_ScrollbarGrabActive] = vec(kAccent);
  c[ImGuiCol_CheckMark] = c[ImGuiCol_SliderGrab] = c[ImGuiCol_PlotHistogram] = vec(kAccent);
  c[ImGuiCol_Separator] = vec(kLine), c[ImGuiCol_DragDropTarget] = vec(kAccent);
  c[ImGuiCol_NavHighlight] = vec(kAccent), c[ImGuiCol_TextSelectedBg] = vec(kAccentDark);
  c[ImGuiCol_ModalWindowDimBg] = {0, 0, 0, 0.55f};
  c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = vec(kRaised);
}

}  // namespace

Theme makeTheme(float scale, const std::string& alsoShown) {
  Theme theme;
  theme.scale = scale;
  ImGuiStyle& s = ImGui::GetStyle();
  s = ImGuiStyle();
  s.WindowPadding = {10, 8}, s.FramePadding = {9, 4}, s.ItemSpacing = {8, 6}, s.ItemInnerSpacing = {6, 4};
  s.WindowRounding = 0, s.FrameRounding = 4, s.PopupRounding = 5, s.ScrollbarRounding = 6, s.GrabRounding = 4;
  s.ScrollbarSize = 11, s.WindowBorderSize = 0, s.ChildBorderSize = 0, s.FrameBorderSize = 0,
  s.PopupBorderSize = 1;
  s.ScaleAllSizes(scale);
  colours(s);

  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  ImFontGlyphRangesBuilder builder;
  builder.AddRanges(atlas.GetGlyphRangesDefault());
  static constexpr ImWchar kSymbols[] = {0x2010, 0x2027, 0x2190, 0x2193, 0x2212, 0x2212, 0x2264, 0x2265, 0};
  builder.AddRanges(kSymbols);
  builder.AddText(alsoShown.c_str());
  static ImVector<ImWchar> ranges;  // the atlas keeps the pointer until it is built
  ranges.clear();
  builder.BuildRanges(&ranges);
  theme.body = font(kUiFontFile, kUiFontFile_bytes, 15 * scale, ranges.Data);
  theme.small = font(kUiFontFile, kUiFontFile_bytes, 13 * scale, ranges.Data);
  theme.bold = font(kUiBoldFontFile, kUiBoldFontFile_bytes, 15 * scale, ranges.Data);
  atlas.Build();
  return theme;
}

ImU32 colourOfView(const std::string& view) {
  if (view == "axial") return IM_COL32(232, 184, 88, 255);
  if (view == "coronal") return IM_COL32(104, 196, 144, 255);
  if (view == "sagittal") return IM_COL32(116, 164, 240, 255);
  if (view == "oblique") return IM_COL32(204, 140, 226, 255);
  return IM_COL32(160, 170, 182, 255);
}

}  // namespace vernier::ui
