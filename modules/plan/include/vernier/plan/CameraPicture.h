// SPDX-License-Identifier: GPL-3.0-or-later
// The camera of a 3-D picture: from pixels to rays in the patient and back. One source for every technique
// that draws 3-D, so that their pixels mean the same; the reference has its own. All double; pure functions.
//
// c is the camera's target (camera.target, else the centre of the box of voxel centres, else that of the
// surfaces) and D the box's diagonal. For azimuth a and elevation e in patient axes (x left, y posterior, z
// superior): the eye lies in direction (sin a cos e, -cos a cos e, sin e) of c; right = (cos a, sin a, 0), up
// = (-sin a sin e, cos a sin e, cos e). Roll r then turns the camera clockwise as the viewer sees it: up goes
// to cos r up + sin r right. pan_mm moves the camera along right and up.
//   Orthographic: the picture's height is height_mm (absent: D) / zoom.
//   Perspective: the eye stands distance_mm from c; absent: (D/2) / sin(fov/2), from where the box's sphere
//   just fits; with height_mm: (height_mm/2) / tan(fov/2), where c's plane is as high as that. zoom magnifies
//   the picture without moving the eye.
// The lattice of samples starts at the eye point (perspective) or on the eye plane (orthographic), which lies
// distance_mm before c; absent: D, so that all of the box is behind it. Distances along rays are mm from
// there. What lies less than near_mm before the eye (along the view axis) is not seen; nothing behind the eye
// ever is.
#pragma once
#include "vernier/plan/PictureGeometry.h"

namespace vernier {

struct CameraBox {
  PatientPoint centre;
  double diagonal_mm = 0;
};
// The box of voxel centres.
VERNIER_API CameraBox cameraBox(const GridGeometry&);
// Of what the scene shows: the first layer with a volume, else the boxes of all surfaces in their poses
// together. SceneInvalid when there is neither.
VERNIER_API Result<CameraBox> cameraBox(const Scene&, const Sources&);

struct PatientRay {
  PatientPoint origin;   // of the lattice
  PatientVec direction;  // unit
  PatientPoint at(double t_mm) const { return origin + direction * t_mm; }
};

struct CameraPicture {
  Projection projection = Projection::Orthographic;
  int width_px = 0, height_px = 0;
  PatientPoint eye;               // orthographic: the picture's centre on the eye plane
  PatientVec right, up, forward;  // unit, orthogonal; forward points away from the viewer
  double near_mm = 0;
  double targetDistance_mm = 0;  // from the eye to c, along forward
  // Pixels are square. Orthographic: mm per pixel. Perspective: per mm of distance along forward.
  double pixelStep = 1;

  // A point per pixel step before the eye at depth 1 (perspective), or the offset on the eye plane
  // (orthographic).
  PatientVec across(double x, double y) const {
    return right * ((x - 0.5 * width_px) * pixelStep) + up * ((0.5 * height_px - y) * pixelStep);
  }
  PatientRay ray(double x, double y) const {
    if (projection == Projection::Orthographic) return {eye + across(x, y), forward};
    return {eye, normalize(forward + across(x, y))};
  }
  // Distance along the pixel's ray for one mm along forward: 1, or 1 / cos of the angle to the axis.
  double rayPerDepth(double x, double y) const {
    return projection == Projection::Orthographic ? 1.0 : length(forward + across(x, y));
  }
  // Of pixels in the plane through c: what a scale bar may use in an orthographic picture only.
  double mmPerPixel() const {
    return projection == Projection::Orthographic ? pixelStep : pixelStep * targetDistance_mm;
  }
  // Homogeneous: pixel = (x/w, y/w); z = depth in mm along forward, not divided; w = 1 (orthographic) or z.
  VERNIER_API glm::dmat4 pixelFromPatient() const;
};

// SceneInvalid, with the JSON path, for a camera that is not finite, a zoom, height, distance or field of
// view out of its range, a box without extent, or a picture without pixels.
VERNIER_API Result<CameraPicture> cameraPicture(const Camera&, const View&, const CameraBox&);

VERNIER_API EdgeLetters edgeLetters(const CameraPicture&);

}  // namespace vernier
