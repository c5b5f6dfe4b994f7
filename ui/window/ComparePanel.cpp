// SPDX-License-Identifier: GPL-3.0-or-later
// Two pictures side by side laid on each other: wipe and flicker.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

#include "Gui.h"

namespace vernier::ui {

// Pictures of two people are never laid on each other.
bool Gui::mayLayOver() {
  const Workspace& w = desk_.workspace();
  if (w.shown().size() != 2 || w.tile(0).empty() || w.tile(1).empty())
    why_ = "Wipe and flicker need two pictures side by side (F3).";
  else if (w.differentPeople())
    why_ = w.differentPeopleOfOneId()
               ? "These pictures have one Patient ID but another birth date or sex, so they are not laid on "
                 "each "
                 "other; check whose they are."
               : "These pictures are not of one person, so they are not laid on each other.";
  else
    return true;
  return false;
}

// Wipe: tile 0 left of the line, tile 1 right of it, in both. Flicker: the other tile's picture instead.
void Gui::compared(int t, Rect r) {
  const Workspace& w = desk_.workspace();
  const bool flicker =
      ImGui::IsKeyDown(GLFW_KEY_F) && !ImGui::GetIO().WantTextInput && !ImGui::GetIO().KeyCtrl;
  if ((!wipe_ && !flicker) || w.shown().size() != 2 || w.differentPeople()) return;
  const TileView& other = desk_.tileView(1 - t);
  if (!other.picture || other.picture->error) return;
  const Picture& p = other.picture->rgba;
  const float pw = static_cast<float>(p.width), ph = static_cast<float>(p.height);
  if (pw != r.w || ph != r.h) return;  // of another size: not yet drawn anew
  const auto texture = textures_.get("tile" + std::to_string(1 - t), other.pictureNumber, p);
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float line = std::round(r.x + (flicker ? (t == 0 ? 0.0f : 1.0f) : wipeAt_) * r.w);
  const bool right = t == 0;  // which part the other picture takes
  draw->PushClipRect({right ? line : r.x, r.y}, {right ? r.x + r.w : line, r.y + r.h}, true);
  draw->AddImage(reinterpret_cast<ImTextureID>(texture), {r.x, r.y}, {r.x + r.w, r.y + r.h});
  draw->PopClipRect();
  if (!flicker) draw->AddLine({line, r.y}, {line, r.y + r.h}, colour::kAmber, std::max(1.0f, theme_.px(1)));
}

}  // namespace vernier::ui
