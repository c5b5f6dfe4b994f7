// SPDX-License-Identifier: GPL-3.0-or-later
// From a stack of a study to a Volume or an ImageFrame. Volume files: VolumeFile.h.
#pragma once
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "vernier/base/Budget.h"
#include "vernier/base/Progress.h"
#include "vernier/study/Load.h"
#include "vernier/volume/ImageFrame.h"
#include "vernier/volume/Volume.h"

namespace vernier {

struct BuildOptions {
  bool bridgeGaps = false;
  // Reserved before anything is allocated, released when the last holder of the volume lets go; outlives the
  // volume.
  MemoryBudget* budget = nullptr;
  // Of a volume file that holds several volumes (4-D): the one to read, counted from 0.
  std::optional<std::int64_t> frame;
  // Of a list of images: the length that all slices span together, in the unit of the pixel size (mm).
  std::optional<double> zSpan;
};

// Decodes a stack that passed 3-D validation; GeometryRefused with the stack's reason otherwise. Voxels keep
// their type; where slopes differ from slice to slice (or a modality LUT stands) they become float modality
// values and the stored ones stay beside them (Volume::original). A slice that cannot be decoded counts as
// missing: a gap and the finding "slices-not-decoded", never zeros. Lossy CT: "padding-blurred". Peak memory:
// at most 1.3 x the volume + 100 MB. A stack of colour images of 8 bits (palettes of 8 or 16) becomes a
// colour volume of red, green and blue.
VERNIER_API Result<std::shared_ptr<const Volume>> buildVolume(const StudySet&, const Series&, const Stack&,
                                                              const BuildOptions& = {},
                                                              const ProgressFn& = {}, std::stop_token = {});

// Decodes one slice of any image stack, grey or colour (which has no window). `slice` in [0,
// stack.slices.size()). A stack shows one window, its middle slice's; NM, XA, CR, DX, MG and stacks without
// geometry have one per image. autoWindow: 1st.. 99th percentile of the stack (of at most 32 slices spread
// over it) where the file has no window, else of this image. Pass the autoWindow of an earlier frame of the
// same stack to save that work.
VERNIER_API Result<std::shared_ptr<const ImageFrame>> buildImageFrame(
    const StudySet&, const Series&, const Stack&, std::size_t slice,
    std::optional<VoiWindow> autoWindow = {});

// Whether each image of the stack has a window of its own.
VERNIER_API bool windowPerImage(const Stack&, const std::string& modality);

// The window to show first: the file's first valid one (normalised), else the automatic one.
VERNIER_API VoiWindow defaultWindow(const Volume&);

// 1st..99th percentile of the modality values (nearest rank) without padding, as LINEAR_EXACT; at least one
// stored step wide, so a constant volume shows as mid grey; 0..1 when all is no-data. Reads all voxels: cache
// it by revision.
VERNIER_API VoiWindow automaticWindow(const Volume&);

}  // namespace vernier
