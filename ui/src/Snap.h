// SPDX-License-Identifier: GPL-3.0-or-later
// From a region on a reformat to the nearest acquired slice, so that its statistics are of stored pixels and
// not of interpolated values. Pure.
#pragma once
#include "Measuring.h"

namespace vernier::ui {

struct Snap {
  measure::Measurement moved;
  Plane plane;          // of the acquired slice, for the picture
  std::string view;     // what the picture becomes when it must turn: "axial", "coronal", "sagittal", else
                        // "oblique"; "": it only moves along its normal
  PatientPoint middle;  // of the region where it is now
};

// nullopt: not a region on a single plane in the patient, it lies on an acquired slice already (as the
// measure module finds it, to a thousandth of a step), or there is no grid. A region on a plane along the
// slices moves along the normal. One that cuts across them is turned about its middle into the slice that is
// nearest to it: the same size and outline, on another plane.
std::optional<Snap> snapToAcquired(const measure::Measurement&, const Plane& shown, const GridGeometry&);

}  // namespace vernier::ui
