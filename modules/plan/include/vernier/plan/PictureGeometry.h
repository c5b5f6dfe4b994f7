// SPDX-License-Identifier: GPL-3.0-or-later
// From pixels to the patient, and the letters at a picture's edges. All double; pure functions.
//
// For a slice layer: patient = origin + x * right + y * down, x and y in pixels (centres at half-integers,
// row 0 on top); right and down are the patient vectors of one pixel. The picture's centre is plane.point
// shifted by pan_mm. Its height is camera.height_mm / zoom; without height_mm the picture is fitted: the
// volume's box, with half a voxel of border, projected onto the plane is wholly inside the picture at zoom 1.
// The fit does not depend on where along the normal the plane lies, so that scrolling never changes the
// scale.
#pragma once
#include <string>

#include "vernier/plan/Technique.h"

namespace vernier {

struct SlicePicture {
  PatientPoint origin;     // of the picture's top left corner (pixel coordinate 0, 0)
  PatientVec right, down;  // per pixel
  PatientVec normal;       // unit, towards the viewer
  double mmPerPixel = 1;   // pixels are square
};

// PlaneDegenerate for a zero normal, up parallel to it (angle below 1e-6 rad), or anything not finite;
// SceneInvalid for a zoom or height that is not above zero or a picture without pixels.
VERNIER_API Result<SlicePicture> slicePicture(const SliceLayer&, const Camera&, const View&,
                                              const GridGeometry&);
inline Result<SlicePicture> slicePicture(const SliceLayer& layer, const Camera& camera, const View& view,
                                         const Volume& volume) {
  return slicePicture(layer, camera, view, volume.grid());
}

// Between picture coordinates (pixels, any fraction) and the patient. pixelAt() looks along the normal: the
// point need not lie on the plane. Both are exact inverses on the plane but for rounding.
VERNIER_API PatientPoint patientAt(const SlicePicture&, glm::dvec2 pixel);
VERNIER_API glm::dvec2 pixelAt(const SlicePicture&, PatientPoint);

// An image layer keeps the file's pixel aspect (pixel spacing row\column; 1:1 when unknown): at zoom 1 the
// frame, with its half-pixel border, just fits into the picture, or camera.height_mm is the picture's height
// where the spacing is known. pan_mm counts in mm, or in columns of the frame where the spacing is unknown.
// A presentation state turns and flips the frame first, and its displayed area takes the place of the frame.
// frame column = (x - x0) / pxPerColumn - 0.5, frame row = (y - y0) / pxPerRow - 0.5; with `transposed`
// (turned by 90 or 270 degrees) the other way round: columns run along y and rows along x.
struct ImagePicture {
  double x0 = 0, y0 = 0;  // picture coordinate of the frame's first corner (column -0.5, row -0.5)
  double pxPerColumn = 1, pxPerRow = 1;  // negative when flipped
  bool transposed = false;
  double mmPerPixel = 0;  // 0: unknown
};
VERNIER_API ImagePicture imagePicture(const ImageLayer&, const Camera&, const View&, const ImageFrameInfo&,
                                      const FramePresentation* = nullptr);
inline ImagePicture imagePicture(const ImageLayer& layer, const Camera& camera, const View& view,
                                 const ImageFrame& frame) {
  return imagePicture(layer, camera, view, frame.info());
}
// Between picture coordinates and (column, row) of the frame, pixel centres at integers.
VERNIER_API glm::dvec2 frameFromPicture(const ImagePicture&, glm::dvec2 pixel);
VERNIER_API glm::dvec2 pictureFromFrame(const ImagePicture&, glm::dvec2 columnRow);
// Whether left and right are exchanged, as turning alone cannot do.
VERNIER_API bool isMirrored(const ImagePicture&);

// What of the layer's presentation state is meant for the frame; nothing where the layer names none. Errors:
// SceneInvalid where it is not among the sources or not for this frame, NotBuiltYet as presentationFor().
VERNIER_API Result<std::optional<FramePresentation>> presentationOf(const ImageLayer&, const ImageFrameInfo&,
                                                                    const Sources&);

// Letters L R A P H F of a direction in the patient: components with |cos| > 0.1, largest first, at most
// three. Equal components come in the order x, y, z. "" for no direction.
VERNIER_API std::string lettersOf(PatientVec direction);

// What stands at the four edges of a picture. Empty: not known, nothing is shown.
struct EdgeLetters {
  std::string left, right, top, bottom;
  friend bool operator==(const EdgeLetters&, const EdgeLetters&) = default;
};
VERNIER_API EdgeLetters edgeLetters(const SlicePicture&);
// From the frame's plane, else from Patient Orientation; both as displayed, flips included. Codes that are
// not made of the six letters (QUADRUPED) give none.
VERNIER_API EdgeLetters edgeLetters(const ImagePicture&, const ImageFrameInfo&);
// Of a layer without a presentation state.
inline EdgeLetters edgeLetters(const ImageLayer& layer, const ImageFrameInfo& frame) {
  ImagePicture p;
  p.pxPerColumn = layer.flipHorizontal ? -1 : 1;
  p.pxPerRow = layer.flipVertical ? -1 : 1;
  return edgeLetters(p, frame);
}

}  // namespace vernier
