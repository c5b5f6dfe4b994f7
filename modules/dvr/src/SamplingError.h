// SPDX-License-Identifier: GPL-3.0-or-later
// What rays on the lattice are expected to miss, the same on both engines: levels of 255 within which 99 % of
// the pixels lie, measured (docs/performance.md). The engine with more rounding adds its own to it.
#pragma once
#include "vernier/plan/Scene.h"

namespace vernier::dvr {

// Measured on vessels, engine and head with their presets; it falls with the square of the step. Faces of a
// lit surface turn within a voxel. `step` in smallest voxel spacings; `exact`: extremes taken cell by cell.
inline double samplingError(VolumeMode mode, ShadingModel shading, OpacityRule rule, bool exact,
                            double step) {
  if (mode != VolumeMode::Blend) return exact ? 0.5 : 16 * step;
  if (rule == OpacityRule::Linear) return 8;
  return (shading != ShadingModel::None ? 22 : 8) * step * step;
}

}  // namespace vernier::dvr
