// SPDX-License-Identifier: GPL-3.0-or-later
// What all techniques that draw projections share: the layer made ready for drawing.
#pragma once
#include <memory>
#include <string>

#include "vernier/native/Projection.h"
#include "vernier/plan/Technique.h"

namespace vernier::angiography {

struct ProjectionParams final : PassParams {
  std::shared_ptr<const Volume> volume;
  native::ProjectionJob job;  // without bounds and tools
  std::vector<PlacedSurface> tools;
  View view;
  std::string dump() const override;
};

inline bool isExtreme(ProjectionMode m) { return m == ProjectionMode::Max || m == ProjectionMode::Min; }
double smallestSpacing_mm(const GridGeometry&);

// SceneInvalid with its place, GeometryRefused, NotBuiltYet for colour: with the sentence.
Result<std::shared_ptr<ProjectionParams>> projectionParams(const Layer&, std::size_t index,
                                                           const PlanContext&);
// How the layer joins with others on a ray. NoTechnique with the sentence where the layer cannot be cut at a
// lens: what is turned over does not add up from parts.
Result<Accumulator> accumulatorOf(const ProjectionParams&, const PlanContext&);
// Levels of 255 within which 99 % of the pixels lie: docs/error.md has the measured figures. Extrema miss
// peaks in proportion to the step, integrals what bends within it.
double predictedError(const ProjectionParams&, double step);

// One pass with what is alike for all techniques; its time and resources are the technique's to say.
Result<Pass> projectionPass(std::shared_ptr<const ProjectionParams>, std::size_t index, const PlanContext&);

// The tools as the picture's rays meet them; without hits where there are none.
Result<native::SurfaceHits> toolsOf(const ProjectionParams&, Images&, std::stop_token);

}  // namespace vernier::angiography
