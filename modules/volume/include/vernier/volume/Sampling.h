// SPDX-License-Identifier: GPL-3.0-or-later
// Probes in double from stored voxels: the truth for what stands on the screen as a number. Never a texture.
// Interpolates modality values as base/GridGeometry.h says. Each slice has its own half-voxel border in the
// plane; a corner that is no-data or of a slice whose border the point has left gets no weight, and the
// weights of the others are renormalised; no weight left = no data. Points up to 1e-9 voxel outside a border
// count as on it. Thread-safe.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "vernier/base/Api.h"
#include "vernier/volume/Volume.h"

namespace vernier {

// Cubic: Cubic.h. It takes 64 voxels; where one of those that count (weight not 0) is no-data, or one of the
// slices does not reach there, that sample is interpolated linearly.
enum class Interpolation { Nearest, Linear, Cubic };

// Modality value at a patient point, interpolated as GridGeometry.h says (true slice positions, gaps, border
// held for half a voxel, no-data renormalised over valid corners). nullopt: no data there;
// a colour volume.
VERNIER_API std::optional<double> sampleModality(const Volume&, PatientPoint,
                                                 Interpolation = Interpolation::Linear);

// Red, green, blue and alpha (255 where there is none) of a colour volume, each interpolated by itself,
// 0..255. nullopt outside, in a gap, and for grey volumes.
VERNIER_API std::optional<std::array<double, 4>> sampleColour(const Volume&, PatientPoint,
                                                              Interpolation = Interpolation::Linear);

// The voxel with the greatest weight (ties go to the higher index) and its value as stored, for the readout
// under a patient point. nullopt outside the acquired slices, in a gap too; a padding voxel is told by
// noData.
struct StoredProbe {
  std::int64_t i = 0, j = 0, k = 0;
  double stored = 0, modality = 0;
  bool noData = false;
  std::optional<std::array<std::uint8_t, 4>>
      rgba;  // of colour volumes, which have no `stored` and no `modality`
};
VERNIER_API std::optional<StoredProbe> probeStored(const Volume&, PatientPoint);

}  // namespace vernier
