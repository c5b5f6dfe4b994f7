// SPDX-License-Identifier: GPL-3.0-or-later
// What all techniques that cut and join rays share: the two passes of a picture with lenses made ready.
#pragma once
#include <string>
#include <vector>

#include "vernier/native/LensRays.h"
#include "vernier/plan/Technique.h"

namespace vernier::lens {

struct CutParams final : PassParams {
  native::LensRaysJob job;
  std::vector<PlacedSurface> tools;
  std::vector<std::size_t> facets;
  bool onGl = false;
  bool together = false;  // RayIntervals::lenses, no parts
  std::string dump() const override;
};

struct JoinParams final : PassParams {
  native::JoinJob job;
  std::string dump() const override;
};

// The pass that cuts rays and the one that joins their parts, as native draws them; the first alone where all
// is drawn together. SceneInvalid,
// GeometryRefused with the sentence.
Result<std::vector<Pass>> lensPasses(const PlanContext&);
// Cuts rays at lenses and tools; joins parts.
Result<void> cutLensRays(const CutParams&, const std::vector<native::LensSpans>& known, Images&,
                         std::stop_token);

}  // namespace vernier::lens
