// SPDX-License-Identifier: GPL-3.0-or-later
// A volume or iso-surface layer made ready for OpenGL: what all GL techniques of this module share of
// planning. Plain data, pure functions.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "vernier/gpu/VolumePlanes.h"
#include "vernier/native/VolumeRender.h"
#include "vernier/plan/Volumetric.h"
#include "vernier/volume/TransferTable.h"

namespace vernier::dvr {

struct Combiner;  // Combiner.h

struct GlVolumeJob final : PassParams {
  std::shared_ptr<const Volume> volume;  // even slices
  gpu::TexelCode code;                   // of grey volumes
  CameraPicture camera;
  std::vector<HalfSpace> region;  // keptRegion
  std::vector<PlacedSurface> tools;
  glm::dvec3 background{0};
  double step_mm = 1;                             // of the sampling lattice
  double leastLight = native::kReviewLeastLight;  // rays end where less is left
  bool wantValues = false;
  bool walksCells = false;  // rays find levels and extremes cell by cell

  bool iso = false;
  double level = 0;  // of the iso-surface
  VolumeMode mode = VolumeMode::Blend;
  TransferFunction transfer;
  std::array<double, 4> gains{1, 1, 1, 1};
  Classification classification = Classification::Post;
  bool classificationOpen = false;  // the layer leaves it to the technique
  OpacityRule opacity = OpacityRule::Exact;
  Interpolation interpolation = Interpolation::Linear;
  ShadingModel shading = ShadingModel::None;
  Material material;
  std::vector<Light> lights;  // at least one
  std::string combiner;       // its name; `shading` is None then
  std::shared_ptr<const Combiner> combination;
  bool combinationNeedsNormals = false;
  bool outlines = false;
  bool fixedFunction = false;   // the card's filter instead of float interpolation
  std::int64_t slabSlices = 0;  // of techniques that draw slab by slab
  std::string summary;          // what the technique says of its way, for the dump

  bool shaded() const { return iso || shading != ShadingModel::None; }
  bool extreme() const { return !iso && mode != VolumeMode::Blend; }
  bool perspective() const { return camera.projection == Projection::Perspective; }
  double smallestSpacing_mm() const;
  std::string dump() const override;
};

// SceneInvalid, with the JSON path, for what no technique could draw; NoTechnique or NotBuiltYet with the
// sentence for what OpenGL does not.
Result<std::shared_ptr<GlVolumeJob>> glVolumeJob(const Layer&, std::size_t index, const PlanContext&);

// What is refused beyond that: pictures and volumes larger than GL's textures.
Result<void> checkPicture(const GlVolumeJob&, const Capabilities&);
Result<void> checkWhole3dTexture(const GlVolumeJob&, const Capabilities&);
// Translucent tools with accumulators that cannot take them.
bool hasTranslucentTools(const GlVolumeJob&);

// What chooseClassification says, where the layer leaves it open; for techniques that can integrate steps.
void chooseOpenClassification(GlVolumeJob&);

// The table of one step of step_mm over the values of the volume.
Result<TransferTable> tableOf(const GlVolumeJob&, double step_mm);

// Levels of 255 within which 99 % of the pixels lie, from the step in smallest spacings.
double predictedError(const GlVolumeJob&, double step);
// Interpolated reads of the volume for one sample of this job.
double readsPerSample(const GlVolumeJob&);
// Of all rays together, mm inside the kept region; a quick estimate for costs.
double raysLength_mm(const GlVolumeJob&);

}  // namespace vernier::dvr
