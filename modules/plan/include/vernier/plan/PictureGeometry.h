// SPDX-License-Identifier: GPL-3.0-or-later
// From pixels to the patient. For a slice layer: patient = origin + x * right + y * down, x and y in pixels (centres
// at half-integers, row 0 on top); right and down are the patient vectors of one pixel.
#pragma once
#include <string>

#include "vernier/plan/Technique.h"

namespace vernier {

struct SlicePicture {
  PatientPoint origin;      // of the picture's top left corner (pixel coordinate 0, 0)
  PatientVec right, down;   // per pixel
  PatientVec normal;        // unit, towards the viewer
  double mmPerPixel = 1;    // pixels are square
};

// PlaneDegenerate for a zero normal, up parallel to it (angle below 1e-6 rad), or anything not finite.
VERNIER_API Result<SlicePicture> slicePicture(const SliceLayer&, const Camera&, const View&, const Volume&);

// An image layer keeps the file's pixel aspect: the frame is fitted into the picture. frame column = (x - x0) * sx - 0.5
struct ImagePicture {
  double x0 = 0, y0 = 0;              // picture coordinate of the frame's top left corner
  double pxPerColumn = 1, pxPerRow = 1;   // negative when flipped
  double mmPerPixel = 0;              // 0: unknown
};
VERNIER_API ImagePicture imagePicture(const ImageLayer&, const Camera&, const View&, const ImageFrame&);

// Letters L R A P H F of a direction in the patient: components with |cos| > 0.1, largest first, at most three.
VERNIER_API std::string lettersOf(PatientVec direction);

}  // namespace vernier
