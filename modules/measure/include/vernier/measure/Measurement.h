// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement as it was drawn or written down: what kind, where, upon which picture. Plain data without
// results; Measure.h makes the numbers.
//
// Points stand in one of two spaces. Image: pixels of one stored frame, x along columns, y along rows, the
// corner of the first pixel at 0\0 and its centre at 0.5\0.5 (as SCOORD of DICOM PS3.3 C.18.6), z = 0.
// Patient: mm, LPS.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "vernier/base/Frames.h"
#include "vernier/base/HalfSpace.h"
#include "vernier/volume/Mesh.h"

namespace vernier::measure {

using Spot = glm::dvec3;  // in the space of the measurement that it belongs to

enum class Space { Image, Patient };

// What the picture showed that a measurement was drawn upon: it decides what may be said of values. Slice: a
// plane without thickness, acquired or interpolated (found from the volume). Slab: of some thickness.
// Projection: MIP, minIP or mean through the volume, shells. Rendering: volume rendering and surfaces.
enum class Shown { Slice, Slab, Projection, Rendering };

struct Placement {
  Space space = Space::Patient;
  std::string source;      // as in scenes; "" = the chosen one
  std::int64_t frame = 0;  // image space: which frame of the source, from 0
  Shown shown = Shown::Slice;
  // Patient space: the picture's plane; regions have their sides along right = up x normal and up. Needed for
  // regions and for the +/- of a hand's placement; nullopt: not drawn on a picture.
  struct Axes {
    PatientVec normal{0, 0, 1}, up{0, 1, 0};
    friend bool operator==(const Axes&, const Axes&) = default;
  };
  std::optional<Axes> axes;
  // Size of a pixel of the screen that it was placed on: mm in patient space, image pixels in image space.
  // Stays with the measurement, so that it says the same on every display. 0: not placed by hand.
  double screenPixel = 0;
  // Image space: what the user said of the size of pixels, row\column in mm, instead of what the file says.
  std::optional<glm::dvec2> userSpacing_mm;
  friend bool operator==(const Placement&, const Placement&) = default;
};

// A surface: a mesh by the name that scenes use, or the source's iso-surface at a level.
struct SurfaceRef {
  std::string name;                 // "" with a level
  std::optional<double> level_val;  // modality value
  PatientFromMesh pose;             // of a named mesh
  friend bool operator==(const SurfaceRef&, const SurfaceRef&) = default;
};

struct Length {
  std::array<Spot, 2> ends{};
  friend bool operator==(const Length&, const Length&) = default;
};
struct Bidirectional {
  std::array<Spot, 2> longAxis{}, shortAxis{};
  friend bool operator==(const Bidirectional&, const Bidirectional&) = default;
};
struct Angle {
  Spot vertex{};
  std::array<Spot, 2> arms{};
  friend bool operator==(const Angle&, const Angle&) = default;
};
// The angle between two lines, whichever way they were drawn: 0 to 90 degrees.
struct Cobb {
  std::array<Spot, 2> first{}, second{};
  friend bool operator==(const Cobb&, const Cobb&) = default;
};
// Two opposite corners, of an ellipse those of its box; sides along the picture's axes.
struct RectangleRegion {
  std::array<Spot, 2> corners{};
  friend bool operator==(const RectangleRegion&, const RectangleRegion&) = default;
};
struct EllipseRegion {
  std::array<Spot, 2> corners{};
  friend bool operator==(const EllipseRegion&, const EllipseRegion&) = default;
};
struct PolygonRegion {
  std::vector<Spot> corners;
  friend bool operator==(const PolygonRegion&, const PolygonRegion&) = default;
};
struct FreehandRegion {
  std::vector<Spot> outline;
  friend bool operator==(const FreehandRegion&, const FreehandRegion&) = default;
};
// What reaches the level and hangs together with the pixel at `seed`, on a stored frame or an acquired slice:
// the outline runs where the value, linear between pixel centres, passes the level.
struct ThresholdRegion {
  double level_val = 0;
  Spot seed{};
  friend bool operator==(const ThresholdRegion&, const ThresholdRegion&) = default;
};
struct Probe {
  Spot at{};
  friend bool operator==(const Probe&, const Probe&) = default;
};
// Patient space only, as all that follow but arrow and text.
struct PointToSurface {
  Spot point{};
  SurfaceRef surface;
  friend bool operator==(const PointToSurface&, const PointToSurface&) = default;
};
struct ToolToVessel {
  SurfaceRef tool, vessel;
  friend bool operator==(const ToolToVessel&, const ToolToVessel&) = default;
};
// What reaches the level: all of it, or only what hangs together with the voxel at `seed` (by faces).
struct IsoVolume {
  double level_val = 0;
  std::optional<Spot> seed;
  friend bool operator==(const IsoVolume&, const IsoVolume&) = default;
};
// The intersection of half-spaces, such as a lens.
struct ConvexVolume {
  std::vector<HalfSpace> planes;
  friend bool operator==(const ConvexVolume&, const ConvexVolume&) = default;
};
struct SurfaceVolume {
  SurfaceRef surface;
  friend bool operator==(const SurfaceVolume&, const SurfaceVolume&) = default;
};
struct Arrow {
  Spot tip{}, tail{};
  std::string text;
  friend bool operator==(const Arrow&, const Arrow&) = default;
};
struct Text {
  Spot at{};
  std::string text;
  friend bool operator==(const Text&, const Text&) = default;
};

using Shape = std::variant<Length, Bidirectional, Angle, Cobb, RectangleRegion, EllipseRegion, PolygonRegion,
                           FreehandRegion, ThresholdRegion, Probe, PointToSurface, ToolToVessel, IsoVolume,
                           ConvexVolume, SurfaceVolume, Arrow, Text>;
// "length", "bidirectional"... as in files.
VERNIER_API const char* kindOf(const Shape&);

inline constexpr std::size_t kMostOutlinePoints = 10'000;
inline constexpr std::size_t kMostPlanes = 256;

struct Measurement {
  std::string id;     // unique in its list; stays through edits
  std::string label;  // the user's, may be empty
  Placement on;
  Shape shape;
  friend bool operator==(const Measurement&, const Measurement&) = default;
};

// The points that can be taken hold of, in a fixed order; empty for what has none (volumes of the whole).
// setHandle moves point n; n in range.
VERNIER_API std::vector<Spot> handlesOf(const Shape&);
VERNIER_API void setHandle(Shape&, std::size_t n, Spot);

}  // namespace vernier::measure
