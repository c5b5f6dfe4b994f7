// SPDX-License-Identifier: GPL-3.0-or-later
// What the decoder must know of an object's pixels: computed once from the attributes, in checked arithmetic,
// and never trusted again from the codec's own header (which must agree). Plain data, no paths, no toolkit
// types, so that decoding can move into a limited child process. Source: DICOM PS3.3 C.7.6.3, PS3.5
// section 8.
#pragma once
#include <cstdint>
#include <string>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"

namespace vernier {

// Native-endian type of one decoded sample.
enum class SampleType { U8, I8, U16, I16, U32, I32, F32, F64 };
VERNIER_API std::uint64_t bytesOf(SampleType);

// What the numbers of a decoded pixel are: a grey value, an index into a palette, or three samples of a
// colour (PS3.3 C.7.6.3.1.2). YbrPartial has Y in 16..235 and chroma in 16..240 of 8 bits, YbrFull uses all
// of them.
enum class ColourSpace { Grey, Palette, Rgb, YbrFull, YbrPartial };
inline bool isColour(ColourSpace s) { return s != ColourSpace::Grey; }

struct FrameSpec {
  std::string transferSyntaxUid;
  std::uint64_t rows = 0, columns = 0;
  std::uint64_t framesDeclared = 1;  // NumberOfFrames of the object
  std::uint64_t samplesPerPixel = 1;
  std::uint32_t bitsAllocated = 0, bitsStored = 0, highBit = 0;
  bool isSigned = false;
  bool planar = false;  // PlanarConfiguration 1; decoded output is always interleaved by pixel
  std::string photometric;
  SampleType sample = SampleType::U16;  // container of a decoded sample: masked to BitsStored, sign-extended

  // Not empty where the attributes contradicted each other in a way that every reader settles alike
  // (BitsStored 0 or above BitsAllocated, HighBit out of range, NumberOfFrames 0): one sentence that says
  // what was taken instead. The object then carries a finding.
  std::string corrected;

  // The frames that a call to decode() shall deliver.
  std::uint64_t firstFrame = 0, frameCount = 1;

  // Bytes of one decoded frame and of the frames asked for; LimitExceeded on overflow or beyond limits.
  VERNIER_API Result<std::uint64_t> frameBytes() const;
  VERNIER_API Result<std::uint64_t> outputBytes() const;
  // Bytes that one frame takes in a native (not compressed) syntax, rounded up to whole bytes for 1-bit
  // pixels.
  VERNIER_API Result<std::uint64_t> nativeFrameBytes() const;
  // Whether a file of this many bytes can hold all frames declared: exact for native syntaxes, the codec's
  // densest packing for RLE and deflated, a least size per frame for the others. To be asked before memory is
  // set aside.
  VERNIER_API Result<void> checkFileCanHold(std::uint64_t fileBytes) const;

  // The colours that the photometric interpretation promises once the codec has done its part (JPEG 2000
  // undoes YBR_ICT and YBR_RCT itself). What a frame really holds, decodeSlice() says: a JPEG knows it
  // better.
  VERNIER_API ColourSpace colourSpace() const;

  bool isFloat() const { return sample == SampleType::F32 || sample == SampleType::F64; }
};

// The transfer syntaxes that decode() knows.
enum class SyntaxKind { Unknown, Native, NativeBig, Deflated, Rle, Jpeg, JpegLs, Jpeg2000, DeflatedFrames };
VERNIER_API SyntaxKind syntaxKind(const std::string& transferSyntaxUid);

}  // namespace vernier
