// SPDX-License-Identifier: GPL-3.0-or-later
// What all slice passes share: made by slicePassFor (SlicePlanning.cpp), read by the executors.
#pragma once
#include <memory>

#include "vernier/plan/PictureGeometry.h"
#include "vernier/plan/Technique.h"

namespace vernier::mpr {

struct SliceParams final : PassParams {
  std::shared_ptr<const Volume> volume;
  SlicePicture picture;
  View view;
  Slab slab;
  int slabSamples = 1;          // 0: the whole line; else on midpoints: offset (k + 0.5) * thickness / n - thickness / 2 along the normal
  Interpolation interpolation = Interpolation::Linear;
  VoiWindow window;
  bool invert = false;          // of the display, after the window
  Rgb background;
  std::string dump() const override;
};

// Resolves volume, plane, window and slab of a slice layer. Number of slab samples: ceil(thickness / (step * smallest
// spacing)), at least 1; thickness 0 is a single slice.
Result<std::shared_ptr<const SliceParams>> sliceParams(const Layer&, const PlanContext&);

// Gives the images the view's size. Native techniques write every pixel, so buffers of the right size are taken as they
// are: a caller that hands in the last frame's images again saves the time of fresh memory.
void fitImages(Images&, const View&);

Technique nativeSliceTechnique();
Technique slabExactTechnique();
Technique nativeImageTechnique();
Technique stripsTechnique(Host&);
Technique polygonTechnique(Host&);

}  // namespace vernier::mpr
