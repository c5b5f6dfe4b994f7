// SPDX-License-Identifier: GPL-3.0-or-later
// Where each pixel of a curved planar reformat lies in the patient. All double; pure functions.
//
// The path: a smooth curve through all points of the layer, in order. Between two points it is the blend of
// two parabolas, each through three consecutive points (Overhauser, that is Catmull-Rom), over a parameter
// that grows by the square root of the distance between points (centripetal: C. Yuksel, S. Schaefer, J.
// Keyser, Parameterization and applications of Catmull-Rom curves, Computer-Aided Design 43, 2011), so that
// no loop or cusp arises between two points; in the first and last piece one parabola serves, between two
// points a straight line. Consecutive points less than 1e-6 mm apart count once.
//
// The picture (A. Kanitsar, D. Fleischmann, R. Wegenkittl, P. Felkel, E. Groeller, CPR - curved planar
// reformation, IEEE Visualization 2002): each column of pixels is a straight line in the patient; lengths
// along x and along y are true.
// - Straightened: column x stands on the path at arc length x, across it. Its up vector begins as `up`, made
//   perpendicular to the path, and follows the path without turning about it (rotation minimising frame, by
//   double reflection: W. Wang, B. Juettler, D. Zheng, Y. Liu, Computation of rotation minimizing frames, ACM
//   TOG 27, 2008). The path is the straight line through the middle; areas and angles off it are not true.
// - Stretched: all columns point along `up`; x is the arc length of the path as seen along `up`. The sheet is
//   rolled out without distortion: every length in the picture is true on the sheet. The path is a curve in
//   it.
// Right = along the path, up = `up` of the column; the viewer looks against right x up. A slab lies across
// the sheet, centred on it.
//
// Scale: pixels are square; the whole sheet fits at zoom 1, or camera.height_mm is the picture's height; zoom
// and pan_mm as for slices. Outside the sheet nothing is shown.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vernier/plan/PictureGeometry.h"

namespace vernier {

struct CurvedColumn {
  PatientPoint centre;  // where the column crosses the row CurvedPicture::centreRow_px
  PatientVec down;      // per pixel
  PatientVec normal;    // unit, towards the viewer
  bool shown = false;   // else it lies beyond the ends of the path
};

struct CurvedPicture {
  double mmPerPixel = 1;      // pixels are square
  double length_mm = 0;       // of the sheet along x: from the path's first point to its last
  double across_mm = 0;       // of the sheet along y
  double startColumn_px = 0;  // picture coordinates of the sheet's beginning and of its middle
  double centreRow_px = 0;
  std::vector<CurvedColumn> columns;  // one per column of pixels, at its centre
  std::vector<std::string> notes;     // what a reader must know: "overlaps itself: ..."
  // Pixel rows [first, end) whose centres lie on the sheet.
  VERNIER_API int firstRow(int height_px) const;
  VERNIER_API int endRow(int height_px) const;
};

inline constexpr std::size_t kMostPathPoints = 65536;

// PathDegenerate: less than two points that are apart, too many, not finite or further than 1e5 mm away; a
// path that turns back on itself at a point (sharper than the curve can follow); an up vector without length,
// along the path's beginning (straightened) or along the whole path (stretched). SceneInvalid: a width, zoom,
// height or view that is not above zero and finite.
// Notes, not errors: the sheet overlaps itself (the radius of the path is smaller than the sheet's reach to
// that side), the path crosses itself, coincident points were left out.
VERNIER_API Result<CurvedPicture> curvedPicture(const CurvedLayer&, const Camera&, const View&);

// Of the column of pixels that holds pixel.x; nullopt beyond the sheet.
VERNIER_API std::optional<PatientPoint> patientAt(const CurvedPicture&, glm::dvec2 pixel);

// Letters only where they hold for every column: top and bottom for most stretched pictures, left and right
// for straight paths.
VERNIER_API EdgeLetters edgeLetters(const CurvedPicture&);

}  // namespace vernier
