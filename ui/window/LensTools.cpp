// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses under the hand: a key places one where the pointer is, its inside moves it, its outline scales it.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

#include "Gui.h"
#include "Lenses.h"

namespace vernier::ui {
namespace {

constexpr float kGrip = 6, kNotch = 1.1f;
constexpr double kFirst = 0.15;  // radius at first, of the picture's smaller side
constexpr ImU32 kOutline = IM_COL32(150, 226, 255, 255), kChosen = IM_COL32(255, 255, 255, 255),
                kShadow = IM_COL32(0, 0, 0, 190);

}  // namespace

std::optional<int> Gui::tileUnderPointer() const {
  const ImVec2 m = ImGui::GetIO().MousePos;
  for (const int t : desk_.workspace().shown()) {
    const Rect& r = tileArea_[static_cast<std::size_t>(t)];
    if (m.x >= r.x && m.y >= r.y && m.x < r.x + r.w && m.y < r.y + r.h) return t;
  }
  return std::nullopt;
}

// The plane of a picture on which a lens is a disc.
std::optional<Place> Gui::placeOfLens(int t, const LensLayer& lens) const {
  const TileView& shown = desk_.tileView(t);
  return shown.camera ? facing(*shown.camera, lens) : shown.place;
}

// The one on top that the hand would take, and which part of it.
std::optional<Gui::LensHold> Gui::lensAt(int t, glm::dvec2 px) const {
  const Workspace& w = desk_.workspace();
  const TileView& shown = desk_.tileView(t);
  if (!shown.picture || shown.picture->error) return std::nullopt;
  for (std::size_t n = w.now().lenses.size(); n-- > 0;) {
    if (!w.showsLens(t, n)) continue;
    const auto place = placeOfLens(t, w.now().lenses[n].layer);
    const auto disc = place ? discOf(w.now().lenses[n].layer, *place) : std::nullopt;
    const auto part = disc ? partOf(*disc, px, theme_.px(kGrip)) : std::nullopt;
    if (part) return LensHold{n, t, *part, ImGui::GetIO().MousePos, w.now().lenses[n].layer, disc->radius_px};
  }
  return std::nullopt;
}

void Gui::lensKey() {
  const std::optional<int> t = tileUnderPointer();
  if (t && !desk_.workspace().tile(*t).empty())
    return putLens(*t, pixelUnderPointer(tileArea_[static_cast<std::size_t>(*t)]));
  why_ = "Point at a reformat or a 3-D picture and press G: a lens is placed there.";
}

// A lens where there is none, the next appearance where there is one.
void Gui::putLens(int t, glm::dvec2 px) {
  Workspace& w = desk_.workspace();
  why_.clear();
  w.setActive(t);
  const TileView& shown = desk_.tileView(t);
  const bool through = lookOf(w.tile(t).scene) != nullptr;
  if (!needsVolume(w.tile(t).scene) || !shown.picture || shown.picture->error || !shown.picture->volume ||
      (through ? !shown.camera : !shown.place)) {
    why_ = "A lens looks into reformats and volumes; MPR (F4) and 3-D (F5) show them.";
    return;
  }
  if (w.factsOfTile(t)->colour) {
    why_ = "This picture has colours, and lenses are drawn in grey values only.";
    return;
  }
  if (const Result<void> may = desk_.mayLens(w.tile(t).source.document); !may) {
    why_ = may.error().sentence;
    return;
  }
  if (through && std::holds_alternative<ProjectionLayer>(*lookOf(w.tile(t).scene)) &&
      shown.picture->inverted) {
    why_ = "An inverted projection takes no lens; take the inversion back (I) first.";
    return;
  }
  const std::vector<LensLook> looks =
      through ? lensLooksThrough(*w.factsOfTile(t), w.tile(t).scene, w.tile(t).view)
              : lensLooks(shown.picture->windowFacts);
  selected_.clear();
  if (const auto under = lensAt(t, px)) {
    const auto now = std::find_if(looks.begin(), looks.end(), [&](const LensLook& l) {
      return l.name == w.now().lenses[under->lens].look;
    });
    w.setLensLook(under->lens, now == looks.end() || now + 1 == looks.end() ? looks.front() : now[1]);
    lens_ = under->lens;
    return;
  }
  const double side_px = std::min(shown.picture->view.width_px, shown.picture->view.height_px);
  if (!through) {
    lens_ = w.addLens(t, shown.place->patientAt(px), kFirst * side_px * shown.place->unit_mm, looks.front());
    return;
  }
  // About the point that is seen; where nothing is, as deep as the middle of the picture.
  const CameraPicture& camera = *shown.camera;
  const auto picked = desk_.pick(t, px);
  const PatientPoint at =
      picked ? *picked : camera.ray(px.x, px.y).at(camera.targetDistance_mm * camera.rayPerDepth(px.x, px.y));
  lens_ = w.addLens(t, at, kFirst * side_px * camera.mmPerPixel(), looks.front());
}

bool Gui::removeChosenLens() {
  Workspace& w = desk_.workspace();
  if (!lens_ || *lens_ >= w.now().lenses.size()) return false;
  w.removeLens(*lens_);
  lens_.reset();
  return true;
}

// Ctrl + wheel over a lens; false: there is none.
bool Gui::lensWheel(int t, Rect r, int notches) {
  const auto under = lensAt(t, pixelUnderPointer(r));
  if (!under) return false;
  if (notches != 0) desk_.workspace().sizeLens(under->lens, std::pow(kNotch, notches));
  lens_ = under->lens;
  return true;
}

bool Gui::lensHands(int t, Rect r, bool hovered) {
  if (lensHold_) return true;
  if (!hovered || drag_ || ImGui::GetIO().KeyCtrl || !ImGui::IsMouseClicked(ImGuiMouseButton_Left))
    return false;
  lensHold_ = lensAt(t, pixelUnderPointer(r));
  if (!lensHold_) return false;
  lens_ = lensHold_->lens;
  selected_.clear();
  clickMadeStep_ = false;
  desk_.workspace().setActive(t);
  desk_.workspace().beginDrag();
  return true;
}

// The whole way since the button went down, applied to the lens of that moment.
void Gui::dragLens() {
  if (!lensHold_) return;
  Workspace& w = desk_.workspace();
  const LensHold& h = *lensHold_;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (const auto place = placeOfLens(h.tile, h.before)) {
    if (h.part == LensPart::Inside) {
      w.changeLens(h.lens, movedLens(h.before, *place, {mouse.x - h.begin.x, mouse.y - h.begin.y}));
    } else if (const auto disc = discOf(h.before, *place)) {
      const Rect& r = tileArea_[static_cast<std::size_t>(h.tile)];
      const auto from = [&](ImVec2 p) {
        return glm::length(glm::dvec2(p.x - r.x + 0.5, p.y - r.y + 0.5) - disc->centre_px);
      };
      w.changeLens(h.lens, lensWithRadius(h.before, *place, h.radius_px + from(mouse) - from(h.begin)));
    }
  }
  if (ImGui::IsMouseDown(ImGuiMouseButton_Left)) return;
  w.endDrag();
  lensHold_.reset();
}

// Outlines, with what is seen inside.
void Gui::lenses(int t, Rect r) {
  const Workspace& w = desk_.workspace();
  const TileView& shown = desk_.tileView(t);
  if (!shown.picture || shown.picture->error) return;
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const float line = std::max(1.0f, theme_.px(1.25f));
  for (std::size_t n = 0; n < w.now().lenses.size(); ++n) {
    const PlacedLens& lens = w.now().lenses[n];
    const auto place = w.showsLens(t, n) ? placeOfLens(t, lens.layer) : std::nullopt;
    const auto disc = place ? discOf(lens.layer, *place) : std::nullopt;
    if (!disc) continue;
    const ImVec2 c(r.x + static_cast<float>(disc->centre_px.x), r.y + static_cast<float>(disc->centre_px.y));
    const float radius = static_cast<float>(disc->radius_px);
    const int sides = std::clamp(static_cast<int>(radius), 32, 180);
    const ImU32 shade = lens_ == n && !w.measurement(selected_) ? kChosen : kOutline;
    draw->AddCircle(c, radius, kShadow, sides, line + theme_.px(2));
    draw->AddCircle(c, radius, shade, sides, line);
    const ImVec2 size = theme_.small->CalcTextSizeA(theme_.small->FontSize, 1e6f, 0, lens.look.c_str());
    const float pad = theme_.px(3), low = c.y + radius + theme_.px(5);
    const float x = std::clamp(c.x - size.x / 2, r.x + pad, std::max(r.x + pad, r.x + r.w - size.x - pad));
    const float y = low + size.y + pad > r.y + r.h ? c.y + radius - size.y - theme_.px(8) : low;
    draw->AddRectFilled({x - pad, y - pad / 2}, {x + size.x + pad, y + size.y + pad / 2},
                        IM_COL32(0, 0, 0, 150), theme_.px(3));
    draw->AddText(theme_.small, theme_.small->FontSize, {x, y}, shade, lens.look.c_str());
  }
}

}  // namespace vernier::ui
