// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses by hand, on slices and in looks through a volume: what they may show, where they stand in a picture,
// edits of one. Pure; edits are those of LensEdits.h. Pixels are those of the picture, centres at
// half-integers.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "Workspace.h"
#include "vernier/plan/CameraPicture.h"

namespace vernier::ui {

struct LensLook {
  std::string name;  // for the screen
  LensInner inner;
};
// What makes sense on slices, the usual first: in HU the windows of bone, lung, brain and abdomen; else
// inverted and the windows that the file and the volume offer; then inverted, cut out.
std::vector<LensLook> lensLooks(const WindowFacts&);
// The same in looks through a volume, of which `around` is the one that is shown: cut out, then the other
// renderings and the surface.
std::vector<LensLook> lensLooksThrough(const SourceFacts&, const Scene& around, const std::string& view);

// In a look through a volume: the plane through the lens's middle that faces the eye. What is said of places
// and discs below then holds there, of perspective pictures nearly.
std::optional<Place> facing(const CameraPicture&, const LensLayer&);

// Whether a plane cuts a lens that is a sphere.
bool cuts(const Plane&, const LensLayer&);

// The circle in which a picture's plane cuts a sphere; nullopt: it does not, or the lens is no sphere.
struct LensDisc {
  glm::dvec2 centre_px{0, 0};
  double radius_px = 0;
  double away_mm = 0;    // of the sphere's middle from the plane
  double sphere_mm = 0;  // its radius
};
std::optional<LensDisc> discOf(const LensLayer&, const Place&);

// What of it the hand at `px` takes: the outline within `grip_px` of it, else the inside; of a small disc all
// that lies within is inside.
enum class LensPart { Inside, Outline };
std::optional<LensPart> partOf(const LensDisc&, glm::dvec2 px, double grip_px);

// Moved across the picture by pixels.
LensLayer movedLens(const LensLayer&, const Place&, glm::dvec2 way_px);
// Scaled so that the circle on the picture has this radius, or by a factor; the circle keeps 4 px at least
// and the sphere at most 500 mm.
LensLayer lensWithRadius(const LensLayer&, const Place&, double radius_px);
LensLayer scaledLens(const LensLayer&, double factor);

}  // namespace vernier::ui
