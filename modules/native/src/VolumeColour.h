// SPDX-License-Identifier: GPL-3.0-or-later
// Colour volumes in double: channels times gains, clamped; alpha is an opacity per smallest spacing.
#pragma once
#include <array>
#include <memory>

#include "GeneralSampler.h"
#include "VolumeRay.h"

namespace vernier::native {

class ColourBlend {
 public:
  explicit ColourBlend(const VolumeRenderJob&);
  void along(const VoxelRay&, double from_mm, double to_mm, RayLight&, ProjectionWork&) const;

 private:
  const VolumeRenderJob& job_;
  std::vector<GeneralSampler<std::uint8_t>> channels_;
  double lengths_ = 1;  // a step in smallest spacings
  glm::dvec3 first_{0}, last_{0};
};

}  // namespace vernier::native
