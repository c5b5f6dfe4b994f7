// SPDX-License-Identifier: GPL-3.0-or-later
// Finds the top-level pixel data of a DICOM file by walking its elements, and cuts it into frames. The walk
// is a loop, its depth bounded; every length is checked against the file; nothing but headers is read. It
// finds out for itself whether the data set is explicit or implicit, little or big endian, as files in the
// field contradict their own meta header. Sources: DICOM PS3.5 sections 7.1 to 7.5 and A.4, PS3.10 section 7.
#pragma once
#include <cstdint>
#include <vector>

#include "decode/Source.h"
#include "vernier/study/FrameSpec.h"

namespace vernier::study {

struct Extent {
  std::uint64_t offset = 0, length = 0;  // bytes in the source
};

struct PixelIndex {
  std::uint16_t element = 0;  // 0x0008 float, 0x0009 double float, 0x0010 pixel data, of group 7FE0
  bool bigEndian = false;     // byte order of the data set
  bool words = false;         // VR OW: bytes of a big endian data set come in swapped pairs
  bool encapsulated = false;
  Extent value;                   // native: the value, cut to what the file holds
  std::vector<Extent> fragments;  // encapsulated: without the offset table
  // Encapsulated: frame f is made of fragments [firstFragment[f], firstFragment[f + 1]).
  std::vector<std::uint32_t> firstFragment;
};

// Where the data set begins, behind preamble and file meta information. Error: FileDamaged.
Result<std::uint64_t> dataSetOffset(Source& file);

// The source is a whole file, or, with dataSetStart = 0, an inflated data set.
// Errors: FileDamaged, PixelDataMissing, CodecFailed (fragments that do not make up the frames),
// LimitExceeded.
Result<PixelIndex> indexPixels(Source& source, std::uint64_t dataSetStart, const FrameSpec& spec);

}  // namespace vernier::study
