// SPDX-License-Identifier: GPL-3.0-or-later
// From hands to measurements and back: which points a tool takes, where a measurement stands on a tile's
// picture. Pure; pixels are those of the picture, centres at half-integers.
#pragma once
#include "Workspace.h"

namespace vernier::ui {

// Tools that are used once: they take their points one after the other. Polygon and Freehand take as many as
// the hand makes.
enum class Ruler {
  Length,
  Angle,
  Cobb,
  Bidirectional,
  Ellipse,
  Rectangle,
  Polygon,
  Freehand,
  Probe,
  Arrow,
  Text
};
struct RulerFacts {
  Ruler ruler;
  const char *name, *key, *how;
  std::size_t points;  // 0: as many as the hand makes, three at least
};
const std::vector<RulerFacts>& rulers();
const RulerFacts& factsOf(Ruler);
// points.size() as the ruler takes them. Angle: end, vertex, end. Arrow: tip, tail. Cobb and Bidirectional:
// both ends of one line, then of the other.
measure::Shape shapeOf(Ruler, const std::vector<measure::Spot>&);

// What a measurement on this picture stands upon: the stored frame of an image layer, else the patient.
// nullopt where neither is there (pictures without a place).
std::optional<measure::Placement> placementOn(const Scene&, const SourceId&, const Place&);
measure::Spot spotAt(const Place&, measure::Space, glm::dvec2 px);
glm::dvec2 pixelOf(const Place&, measure::Space, const measure::Spot&);
// Whether a point placed there lies on what the picture shows now: the same frame, the same plane.
bool standsOn(const measure::Placement&, const measure::Spot&, const Scene&, const SourceId&, const Place&);

// Whether the picture shows it: the same stored frame; or the same frame of reference, all points within half
// a slice of the picture's plane.
bool shownOn(const Drawn&, const Scene&, const SourceId&, const Place&, const SourceFacts& ofPicture,
             const SourceFacts* ofMeasurement);

// Its lines as they are drawn, in its own space; `closed` ones end where they begin.
std::vector<std::vector<measure::Spot>> linesOf(const measure::Measurement&);
// Where its label stands.
measure::Spot labelAt(const measure::Measurement&);

}  // namespace vernier::ui
