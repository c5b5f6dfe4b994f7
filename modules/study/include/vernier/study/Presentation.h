// SPDX-License-Identifier: GPL-3.0-or-later
// Softcopy presentation states: how somebody wanted images to be seen. Listed in StudySet::presentations,
// applied only on request, by an image layer that names one. Sources: DICOM PS3.3 A.33, C.7.6.11 (shutter),
// C.10.4 (displayed area), C.10.5 (annotations), C.10.6 (rotation and flip), C.11 (LUTs); PS3.4 N.2. Plain
// data.
//
// Places of pixels are (column, row) as the standard counts them there: shutters and displayed areas from 1
// at the first pixel's centre, graphics from 0 at its corner.
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"
#include "vernier/study/Values.h"

namespace vernier {

// Frames of an image, from 1; empty: all of them.
struct ReferencedImage {
  std::string sopInstanceUid;
  std::vector<std::int64_t> frames;
};

// What lies outside of any of the shapes is covered.
struct Shutter {
  struct Rectangle {
    double left = 0, right = 0, upper = 0, lower = 0;  // edges belong to what is seen
  };
  struct Circle {
    glm::dvec2 centre{0};
    double radius = 0;  // in columns
  };
  std::optional<Rectangle> rectangle;
  std::optional<Circle> circle;
  std::vector<glm::dvec2> polygon;
  double grey = 0;  // what covers, 0..1
};

enum class AreaMode { ScaleToFit, TrueSize, Magnify };
struct DisplayedArea {
  std::vector<ReferencedImage> images;    // empty: all
  glm::dvec2 topLeft{1}, bottomRight{1};  // pixels at two corners as displayed; may lie outside of the image
  AreaMode mode = AreaMode::ScaleToFit;
  double magnification = 1;
  std::optional<glm::dvec2> pixelSpacing_mm;  // row\column, as in (0028,0030)
  std::optional<glm::dvec2> pixelAspect;      // vertical\horizontal
};

enum class GraphicUnits { Pixel, Display };  // Display: 0..1 over the displayed area
enum class GraphicShape { Point, Polyline, Interpolated, Circle, Ellipse };
struct Graphic {
  GraphicShape shape = GraphicShape::Polyline;
  GraphicUnits units = GraphicUnits::Pixel;
  std::vector<glm::dvec2> points;
  bool filled = false;
};
struct GraphicText {
  std::string text;  // UTF-8, lines divided by \n
  GraphicUnits boxUnits = GraphicUnits::Pixel, anchorUnits = GraphicUnits::Pixel;
  std::optional<glm::dvec2> boxTopLeft, boxBottomRight, anchor;
  bool anchorVisible = false;
};
struct GraphicAnnotation {
  std::vector<ReferencedImage> images;  // empty: all
  std::int64_t order = 0;               // of its layer; higher lies over lower
  double grey = 1;                      // of its layer, 0..1
  std::vector<Graphic> graphics;
  std::vector<GraphicText> texts;
};

struct PresentationVoi {
  std::vector<ReferencedImage> images;  // empty: all
  std::optional<VoiWindow> window;
  std::optional<LutTable> lut;
};

struct PresentationState {
  std::size_t instance = 0;  // index into StudySet::instances
  std::string sopInstanceUid, label, description;
  std::string whyNot;  // why it can only be listed: "pseudo-colour presentation states are not applied";
                       // empty: can be
  std::vector<ReferencedImage> images;
  bool greyscale = true;  // false: a colour presentation state, which has no grey transformations
  ModalityRescale rescale;
  std::optional<LutTable> modalityLut;
  std::vector<PresentationVoi> vois;
  std::optional<LutTable> presentationLut;
  bool inverse = false;
  std::optional<Shutter> shutter;
  int rotation_deg = 0;  // clockwise: 0, 90, 180, 270; then the flip
  bool flipHorizontal = false;
  std::vector<DisplayedArea> areas;
  std::vector<GraphicAnnotation> annotations;
  std::vector<std::string> notApplied;  // parts that it has and that are not built: "overlays", "text styles"
};

// What of a presentation state is meant for one frame. It replaces all grey transformations of the image
// itself; what it does not say is the identity (PS3.4 N.2), and the image's photometric interpretation counts
// as MONOCHROME2 (PS3.4 N.2.1.4).
struct FramePresentation {
  std::string sopInstanceUid, label;
  bool greyscale = true;
  ModalityRescale rescale;
  std::optional<LutTable> modalityLut;
  std::optional<VoiWindow> window;  // neither window nor LUT: the whole range of the modality values
  std::optional<LutTable> voiLut;
  std::optional<LutTable> presentationLut;
  bool inverse = false;
  std::optional<Shutter> shutter;
  int rotation_deg = 0;
  bool flipHorizontal = false;
  std::optional<DisplayedArea> area;
  std::vector<GraphicAnnotation> annotations;  // in drawing order
  std::vector<std::string> notApplied;
};

VERNIER_API bool refersTo(const std::vector<ReferencedImage>&, const std::string& sopInstanceUid,
                          std::int64_t frame);

// `frame` from 1. SceneInvalid where the state does not refer to that frame, NotBuiltYet where it is of a
// kind that is only listed.
VERNIER_API Result<FramePresentation> presentationFor(const PresentationState&,
                                                      const std::string& sopInstanceUid, std::int64_t frame);

}  // namespace vernier
