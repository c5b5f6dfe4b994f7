// SPDX-License-Identifier: GPL-3.0-or-later
// What the passes of slices and curved reformats share: made by SlicePlanning.cpp, read by the executors.
#pragma once
#include <memory>

#include "vernier/plan/CurvedGeometry.h"
#include "vernier/plan/Technique.h"

namespace vernier::mpr {

// What a pass reads from its volume and how it shows it.
struct SampledParams : PassParams {
  std::shared_ptr<const Volume> volume;
  View view;
  Slab slab;
  // 0: the whole line; else on midpoints: offset (k + 0.5) * thickness / n - thickness / 2 along the normal
  int slabSamples = 1;
  Interpolation interpolation = Interpolation::Linear;
  VoiWindow window;
  bool invert = false;  // of the display, after the window
  Rgb background;
  std::string dumpSampling() const;
};

// What a lens shows where the slice cuts it.
struct SliceInside {
  std::shared_ptr<const ConvexRegion> region;
  bool cutOut = true;
  Interpolation interpolation = Interpolation::Linear;
  VoiWindow window;
  bool invert = false;
};

struct SliceParams final : SampledParams {
  SlicePicture picture;
  std::vector<SliceInside> lenses;  // the later wins
  std::string dump() const override;
};

struct CurvedParams final : SampledParams {
  CurvedForm form = CurvedForm::Straightened;
  CurvedPicture picture;
  std::string dump() const override;
};

// Resolve volume, place, window and slab of a layer. Number of slab samples: ceil(thickness / (step *
// smallest spacing)), at least 1; thickness 0 is a single slice. `Colours::Refused` turns colour volumes
// away, for techniques that draw grey ones only.
enum class Colours { Refused, Drawn };
Result<std::shared_ptr<const SliceParams>> sliceParams(const Layer&, const PlanContext&,
                                                       Colours = Colours::Refused);
Result<std::shared_ptr<const CurvedParams>> curvedParams(const Layer&, const PlanContext&);
// What the lenses of the scene show on the slice. NoTechnique for colour volumes; SceneInvalid for a window
// that cannot be used.
Result<std::vector<SliceInside>> lensesOnSlice(const SliceParams&, const PlanContext&);
// Draws it into a finished picture of the slice: a pixel belongs to a lens when its point of the plane does.
Result<void> drawLenses(const SliceParams&, Images&, std::stop_token);
// What the layer asks for and cannot be had.
std::vector<std::string> notesOf(const SliceLayer&, const SliceParams&);

// Gives the images the view's size. Native techniques write every pixel, so buffers of the right size are
// taken as they are: a caller that hands in the last frame's images again saves the time of fresh memory.
void fitImages(Images&, const View&);

Technique nativeSliceTechnique();
Technique slabExactTechnique();
Technique curvedTechnique();
Technique nativeImageTechnique();
Result<void> executeImage(const Pass&, Images&, std::stop_token);
Technique stripsTechnique(Host&);
Technique polygonTechnique(Host&);

}  // namespace vernier::mpr
