// SPDX-License-Identifier: GPL-3.0-or-later
// What a stack's headers say about its values, in the form that volumes and frames need: container, padding,
// windows, inversion. Pure functions over the study model; CLINICAL rules on values stand in docs/studies.md.
#pragma once
#include <optional>
#include <vector>

#include "vernier/study/Load.h"
#include "vernier/volume/Volume.h"

namespace vernier {

// Whether the pixels can be shown: the instance's own pixelError, or PixelDataMissing.
Result<void> checkImage(const Instance&);
// The same for volumes of grey values; NotBuiltYet for colour, with a sentence.
Result<void> checkSingleSample(const Instance&);

SampleType sampleOf(VoxelType);
// F64 is shown as F32.
VoxelType voxelTypeOf(SampleType);

// The smallest container that holds the samples of all these instances; those with a pixelError don't count.
SampleType commonSample(const std::vector<const Instance*>&);

// What holds for one slice: its object and its frame's attributes.
struct SliceFacts {
  const Instance* object = nullptr;
  const FrameAttributes* frame = nullptr;
};
SliceFacts factsOf(const StudySet&, SliceRef);

// PixelPaddingValue and range limit in stored values, with the pixel's sign: a value that was written with
// the other sign (0xF830 for -2000) is read back as the pixels are.
std::optional<NoDataRange> paddingOf(const SliceFacts&);

// MR padding of 0 lies among the tissue values: it is left out of the automatic window only.
bool liesInTissueRange(const Instance&, const NoDataRange&);

// One inversion, whichever of MONOCHROME1 and PresentationLUTShape INVERSE asks for it: an object that has
// both says the same thing twice (the DX Image module asks for both).
bool isInverted(const Instance&);

// The finding "slices-not-decoded": which slices of a stack are missing from its volume, and why.
Finding lostSlices(const Stack&, const std::vector<SliceFailure>&);
// VolumeInfo::patientKey of a stack.
std::string patientKey(const StudySet&, const Stack&);

// The frame's usable windows, widths below 1 under LINEAR taken as LINEAR_EXACT with a notice.
std::vector<VoiWindow> windowsOf(const FrameAttributes&, std::vector<Finding>& findings);

}  // namespace vernier
