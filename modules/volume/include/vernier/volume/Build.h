// SPDX-License-Identifier: GPL-3.0-or-later
// From a stack of a study, or from a MetaImage file, to a Volume or an ImageFrame.
#pragma once
#include <memory>
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
  MemoryBudget* budget = nullptr;  // checked before anything is allocated
};

// Decodes a stack that passed 3-D validation. GeometryRefused with the stack's reason otherwise. Peak memory:
// at most 1.3 x the volume + 100 MB.
VERNIER_API Result<std::shared_ptr<const Volume>> buildVolume(const StudySet&, const Series&, const Stack&,
                                                              const BuildOptions& = {},
                                                              const ProgressFn& = {}, std::stop_token = {});

// Decodes one slice of any image stack. `slice` in [0, stack.slices.size()).
VERNIER_API Result<std::shared_ptr<const ImageFrame>> buildImageFrame(const StudySet&, const Series&,
                                                                      const Stack&, std::size_t slice);

// MetaImage (.mhd + raw, .mha), 1 channel. Offset and TransformMatrix are taken as LPS mm (ITK's convention).
VERNIER_API Result<std::shared_ptr<const Volume>> readMetaImage(const std::string& path,
                                                                const BuildOptions& = {});

// The window to show first: the file's first valid one (normalised), else the automatic one.
VERNIER_API VoiWindow defaultWindow(const Volume&);

// 1st..99th percentile of the modality values (nearest rank) without padding, as LINEAR_EXACT; at least one
// stored step wide, so a constant volume shows as mid grey; 0..1 when all is no-data. Reads all voxels: cache
// it by revision.
VERNIER_API VoiWindow automaticWindow(const Volume&);

}  // namespace vernier
