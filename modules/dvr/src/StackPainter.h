// SPDX-License-Identifier: GPL-3.0-or-later
// Draws one object-aligned stack (Rezk-Salama 2000, sections 4 to 8): the slices by their own rules, or by a
// combiner where the job has one. Render thread.
#pragma once
#include <stop_token>

#include "GlDrawing.h"

namespace vernier::dvr {

struct StackKind {
  const char* name = "";
  std::size_t perPolygon = 1;  // 1 to 4 slices
  bool corrected = true;       // each slice of a polygon at its own place
};
inline constexpr std::size_t kMostPerPolygon = 4;

std::int64_t sizeAlong(const GridGeometry&, int axis);
Result<void> drawStack(gpu::Device&, const GlVolumeJob&, const StackKind&, const RaysOfPass&, Images&,
                       std::stop_token);

// GlStacks.cpp. What a job of any stack needs of the machine, and its pass; job.summary is set.
Result<void> checkStack(const GlVolumeJob&, const Capabilities&);
Pass stackPass(const std::shared_ptr<GlVolumeJob>&, const StackKind&, std::size_t index, const PlanContext&);
// The technique around them.
Technique stackTechnique(
    Host&, StackKind, std::vector<std::string> kinds,
    std::function<Result<std::vector<Pass>>(const Layer&, std::size_t, const PlanContext&)>);

}  // namespace vernier::dvr
