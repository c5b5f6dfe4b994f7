// SPDX-License-Identifier: GPL-3.0-or-later
// Where a tile's picture lies in the patient: from pixels to patient mm and back, reference lines, probes.
// Pure, double; pixels with centres at half-integers, row 0 on top.
#pragma once
#include <optional>
#include <string>

#include "SceneEdits.h"
#include "SourceFacts.h"

namespace vernier::ui {

struct Place {
  double unit_mm = 1;  // a pixel in the camera's unit: mm, or columns where the spacing is not known
  bool inPatient = false;
  // patient = origin + x * right + y * down; valid when inPatient.
  PatientPoint origin;
  PatientVec right, down, normal;
  std::optional<ImagePicture> image;  // of an image layer: from pixels to columns and rows

  PatientPoint patientAt(glm::dvec2 px) const { return origin + px.x * right + px.y * down; }
  // The point's foot on the picture plane, and its distance from it.
  glm::dvec2 pixelOf(PatientPoint) const;
  double distance_mm(PatientPoint p) const { return dot(p - origin, normal); }
};

// nullopt for scenes without an image or slice layer, or whose plane is degenerate.
std::optional<Place> placeOf(const Scene&, const SourceFacts&, const GridGeometry*, const View&);

struct PixelLine {
  glm::dvec2 a, b;
};
// Where the plane of `other` cuts the picture, cut to width x height; nullopt when they are parallel (within
// 0.1 degree) or the line is outside.
std::optional<PixelLine> crossing(const Place& picture, const Place& other, const View&);

// What stands in the status line for the pixel under the pointer, from stored values in double.
struct Probe {
  std::string value;   // "-12 HU", "no data", "outside the image"
  std::string origin;  // "stored 1012 x 1 - 1024, slice3.dcm, row 120, column 230"
  std::string place;   // "L 12.3  P 4.5  S 100.0 mm"
};
Probe probeImage(const Place&, const ImageFrame&, const SourceFacts&, glm::dvec2 px);
Probe probeVolume(const Place&, const Volume&, const SourceFacts&, glm::dvec2 px, bool slab);

// Of a point that a look through the volume shows.
Probe probePoint(const Volume&, const SourceFacts&, PatientPoint);

std::string placeText(PatientPoint);

}  // namespace vernier::ui
