// SPDX-License-Identifier: GPL-3.0-or-later
// What linked views share: planes through one crosshair point, and where one plane cuts another's picture.
// All double; pure functions. Patient mm (LPS); pixels as in PictureGeometry.h (centres at half-integers, row
// 0 on top).
#pragma once
#include <array>
#include <optional>

#include "vernier/plan/PictureGeometry.h"

namespace vernier {

// The plane that contains both points and the direction `up`, for a picture with `from` on its left, `to` on
// its right and `up` up; its point is the middle between them. PlaneDegenerate for points that are less than
// 1e-6 mm apart, an up vector without length or along the line between them (angle below 1e-6 rad), or
// anything not finite.
VERNIER_API Result<Plane> planeThrough(PatientPoint from, PatientPoint to, PatientVec up);

enum class PatientPlane { Axial, Coronal, Sagittal };
// The patient's own plane through a point, seen as CLINICAL practice wants it: axial from the feet, coronal
// from the front, sagittal from the patient's left.
VERNIER_API Plane patientPlane(PatientPlane, PatientPoint);

// The same plane moved along its normal until it contains the point: what the picture shows in its own
// directions does not move. A plane whose normal has no length or is not finite is given back as it is.
VERNIER_API Plane movedThrough(const Plane&, PatientPoint);

// Axial, coronal and sagittal planes through a crosshair, each centred on the line along its normal through
// the volume's centre, as the presets are; any oblique plane follows by movedThrough().
struct LinkedPlanes {
  Plane axial, coronal, sagittal;
};
VERNIER_API LinkedPlanes linkedPlanes(const GridGeometry&, PatientPoint crosshair);

// The line in which `other` (taken as unbounded) cuts the plane of a picture, as its two ends in pixels on
// the picture's border, the left one first (of a vertical line: the upper one). nullopt: the planes are
// parallel within 1e-6 rad, the line misses the picture or only touches a corner, or a plane is degenerate.
VERNIER_API std::optional<std::array<glm::dvec2, 2>> referenceLine(const SlicePicture&, const View&,
                                                                   const Plane& other);

}  // namespace vernier
