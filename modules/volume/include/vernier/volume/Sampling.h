// SPDX-License-Identifier: GPL-3.0-or-later
// Probes in double from stored voxels: the truth for what stands on the screen as a number. Never a texture.
#pragma once
#include <cstdint>
#include <optional>

#include "vernier/base/Api.h"
#include "vernier/volume/Volume.h"

namespace vernier {

enum class Interpolation { Nearest, Linear };

// Modality value at a patient point, interpolated as GridGeometry.h says (true slice positions, gaps, border held for
// half a voxel, no-data renormalised over valid corners). nullopt: no data there.
VERNIER_API std::optional<double> sampleModality(const Volume&, PatientPoint, Interpolation = Interpolation::Linear);

// The nearest stored voxel under a patient point, for the value readout.
struct StoredProbe {
  std::int64_t i = 0, j = 0, k = 0;
  double stored = 0, modality = 0;
  bool noData = false;
};
VERNIER_API std::optional<StoredProbe> probeStored(const Volume&, PatientPoint);

}  // namespace vernier
