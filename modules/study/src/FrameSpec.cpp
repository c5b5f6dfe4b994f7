// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/study/FrameSpec.h"

#include <algorithm>
#include <array>
#include <utility>

#include "vernier/base/Checked.h"
#include "vernier/study/Limits.h"

namespace vernier {

std::uint64_t bytesOf(SampleType t) {
  switch (t) {
    case SampleType::U8:
    case SampleType::I8:
      return 1;
    case SampleType::U16:
    case SampleType::I16:
      return 2;
    case SampleType::U32:
    case SampleType::I32:
    case SampleType::F32:
      return 4;
    case SampleType::F64:
      return 8;
  }
  return 0;
}

SyntaxKind syntaxKind(const std::string& uid) {
  static const std::array<std::pair<const char*, SyntaxKind>, 17> known{{
      {"1.2.840.10008.1.2", SyntaxKind::Native},
      {"1.2.840.10008.1.2.1", SyntaxKind::Native},
      {"1.2.840.10008.1.2.2", SyntaxKind::NativeBig},
      {"1.2.840.10008.1.2.1.99", SyntaxKind::Deflated},
      {"1.2.840.10008.1.2.5", SyntaxKind::Rle},
      {"1.2.840.10008.1.2.4.50", SyntaxKind::Jpeg},
      {"1.2.840.10008.1.2.4.51", SyntaxKind::Jpeg},
      {"1.2.840.10008.1.2.4.53", SyntaxKind::Jpeg},
      {"1.2.840.10008.1.2.4.55", SyntaxKind::Jpeg},
      {"1.2.840.10008.1.2.4.57", SyntaxKind::Jpeg},
      {"1.2.840.10008.1.2.4.70", SyntaxKind::Jpeg},
      {"1.2.840.10008.1.2.4.80", SyntaxKind::JpegLs},
      {"1.2.840.10008.1.2.4.81", SyntaxKind::JpegLs},
      {"1.2.840.10008.1.2.4.90", SyntaxKind::Jpeg2000},
      {"1.2.840.10008.1.2.4.91", SyntaxKind::Jpeg2000},
      {"1.2.840.10008.1.2.8.1", SyntaxKind::DeflatedFrames},
      {"", SyntaxKind::Native},  // no meta header: the encoding is seen from the data set itself
  }};
  for (const auto& [name, kind] : known)
    if (uid == name) return kind;
  return SyntaxKind::Unknown;
}

ColourSpace FrameSpec::colourSpace() const {
  if (samplesPerPixel == 1) return photometric == "PALETTE COLOR" ? ColourSpace::Palette : ColourSpace::Grey;
  if (photometric.starts_with("YBR_FULL")) return ColourSpace::YbrFull;
  if (photometric.starts_with("YBR_PARTIAL")) return ColourSpace::YbrPartial;
  return ColourSpace::Rgb;
}

Result<std::uint64_t> FrameSpec::frameBytes() const {
  const auto n = checkedProduct({rows, columns, samplesPerPixel, bytesOf(sample)});
  if (!n || *n > limits::kMaxDecodedFrameBytes)
    return makeError(ErrorCode::LimitExceeded, "One frame would need more memory than the limit of " +
                                                   std::to_string(limits::kMaxDecodedFrameBytes >> 20) +
                                                   " MiB.");
  return *n;
}

Result<std::uint64_t> FrameSpec::outputBytes() const {
  const Result<std::uint64_t> one = frameBytes();
  if (!one) return one;
  const auto n = checkedProduct({*one, frameCount});
  if (!n)
    return makeError(ErrorCode::LimitExceeded, "The frames asked for need more memory than can be counted.");
  return *n;
}

Result<std::uint64_t> FrameSpec::nativeFrameBytes() const {
  // YBR 4:2:2 keeps one pair of chroma samples for two pixels: two samples per pixel instead of three.
  const bool halved = samplesPerPixel == 3 && photometric.ends_with("_422");
  const auto bits = checkedProduct({rows, columns, halved ? 2 : samplesPerPixel, bitsAllocated});
  if (!bits || *bits / 8 > limits::kMaxDecodedFrameBytes)
    return makeError(ErrorCode::LimitExceeded, "One frame would take more than the limit of " +
                                                   std::to_string(limits::kMaxDecodedFrameBytes >> 20) +
                                                   " MiB.");
  return *bits / 8 + (*bits % 8 != 0 ? 1 : 0);
}

Result<void> FrameSpec::checkFileCanHold(std::uint64_t fileBytes) const {
  const Result<std::uint64_t> frame = nativeFrameBytes();
  if (!frame) return frame.error();
  const auto all = checkedProduct({rows, columns, samplesPerPixel, bitsAllocated, framesDeclared});
  if (!all)
    return makeError(ErrorCode::LimitExceeded, "The frames declared need more memory than can be counted.");
  const std::uint64_t allBytes = photometric.ends_with("_422") ? *all / 12 : *all / 8;
  std::uint64_t least = 0;
  const SyntaxKind kind = syntaxKind(transferSyntaxUid);
  switch (kind) {
    case SyntaxKind::Native:
    case SyntaxKind::NativeBig:
      least = allBytes;
      break;
    case SyntaxKind::Rle:
      least = allBytes / 64;
      break;  // a run of 128 bytes is packed in two
    case SyntaxKind::Deflated:
      least = allBytes > limits::kAlwaysInflatedBytes ? allBytes / limits::kMaxInflateRatio : 0;
      break;
    case SyntaxKind::DeflatedFrames:
      least = framesDeclared * 8;
      if (allBytes / framesDeclared > limits::kAlwaysInflatedBytes)
        least = std::max(least, allBytes / limits::kMaxInflateRatio);
      break;
    case SyntaxKind::Jpeg:
    case SyntaxKind::JpegLs:
    case SyntaxKind::Jpeg2000:
      least = framesDeclared * 16;
      break;  // fewer bytes than any of their headers
    case SyntaxKind::Unknown:
      break;
  }
  const bool image = kind == SyntaxKind::Jpeg || kind == SyntaxKind::JpegLs || kind == SyntaxKind::Jpeg2000;
  if (image && *frame > limits::kAlwaysDecodedBytes && *frame / limits::kMaxImageRatio > fileBytes)
    return makeError(ErrorCode::LimitExceeded, "The compressed image would grow to more than " +
                                                   std::to_string(limits::kMaxImageRatio) +
                                                   " times the size of its file; it is refused.");
  if (fileBytes < least)
    return makeError(
        ErrorCode::PixelDataShort,
        "The attributes declare " + std::to_string(framesDeclared) + " frame(s) that need at least " +
            std::to_string(least) + " bytes, but the whole file has " + std::to_string(fileBytes) +
            "; the file is cut short or its description is wrong, so fetch it again from its source.");
  return {};
}

}  // namespace vernier
