// SPDX-License-Identifier: GPL-3.0-or-later
#include "decode/FrameDecode.h"

#include <algorithm>

#include "decode/Samples.h"
#include "vernier/base/Guarded.h"
#include "vernier/study/Limits.h"

namespace vernier::study {
namespace {

Error tooShort(std::uint64_t frame, std::uint64_t wanted, std::uint64_t got) {
  return makeError(ErrorCode::PixelDataShort, "Frame " + std::to_string(frame + 1) +
                                                  " needs pixel data up to byte " + std::to_string(wanted) +
                                                  ", but there are " + std::to_string(got) +
                                                  "; fetch the file again from its source.");
}

Result<void> decodeBits(Source& source, const PixelIndex& index, const FrameSpec& spec, std::uint64_t frame,
                        std::span<std::byte> out, Scratch& scratch) {
  // Frames follow each other bit by bit (PS3.5 8.1.1). frame < 100'000 and out.size() < 2^31: no overflow.
  const std::uint64_t firstBit = frame * out.size(), endBit = firstBit + out.size();
  std::uint64_t begin = firstBit / 8, end = (endBit + 7) / 8;
  if (end > index.value.length) return tooShort(frame, end, index.value.length);
  const bool pairs = index.bigEndian && index.words;
  if (pairs) {
    begin -= begin % 2;
    end = std::min(end + end % 2, index.value.length);
  }
  scratch.frame.resize(end - begin);
  if (!source.read(index.value.offset + begin, scratch.frame))
    return tooShort(frame, end, index.value.length);
  if (pairs) swapBytes(scratch.frame, 2);
  return unpackNative(scratch.frame, firstBit - begin * 8, spec, out);
}

Result<void> decodeNative(Source& source, const PixelIndex& index, const FrameSpec& spec, std::uint64_t frame,
                          std::span<std::byte> out, Scratch& scratch) {
  if (spec.bitsAllocated == 1) return decodeBits(source, index, spec, frame, out, scratch);
  const Result<std::uint64_t> bytes = spec.nativeFrameBytes();
  if (!bytes) return bytes.error();
  std::uint64_t begin = frame * *bytes, end = begin + *bytes;
  if (end > index.value.length) return tooShort(frame, end, index.value.length);
  const std::uint64_t sample = bytesOf(spec.sample);
  const bool pairs = index.bigEndian && index.words && sample == 1;
  std::uint64_t skip = 0;
  if (pairs) {
    skip = begin % 2;
    begin -= skip;
    end = std::min(end + end % 2, index.value.length);
  }
  const bool straight = *bytes == out.size() && !pairs && !spec.planar;
  if (!straight) scratch.frame.resize(end - begin);
  const std::span<std::byte> to = straight ? out : std::span(scratch.frame);
  if (!source.read(index.value.offset + begin, to)) return tooShort(frame, end, index.value.length);
  if (index.bigEndian) swapBytes(to, pairs ? 2 : sample);
  return unpackNative(to.subspan(skip), 0, spec, out);
}

// Codecs set aside a multiple of the decoded size before they meet the data.
Result<void> checkRatio(ByteSpan coded, const FrameSpec& spec, std::uint64_t decoded) {
  const SyntaxKind kind = syntaxKind(spec.transferSyntaxUid);
  const bool image = kind == SyntaxKind::Jpeg || kind == SyntaxKind::JpegLs || kind == SyntaxKind::Jpeg2000;
  if (!image || decoded <= limits::kAlwaysDecodedBytes || decoded / limits::kMaxImageRatio <= coded.size())
    return {};
  return makeError(ErrorCode::LimitExceeded, "A compressed frame would grow to more than " +
                                                 std::to_string(limits::kMaxImageRatio) +
                                                 " times its size; it is refused.");
}

Result<void> decodeEncapsulated(Source& source, const PixelIndex& index, const FrameSpec& spec,
                                std::uint64_t frame, std::span<std::byte> out, Scratch& scratch) {
  const std::size_t first = index.firstFragment[frame], last = index.firstFragment[frame + 1];
  ByteSpan bytes;
  if (last == first + 1) {
    bytes = source.view(index.fragments[first].offset, index.fragments[first].length, scratch.frame);
  } else {
    scratch.frame.clear();
    for (std::size_t i = first; i < last; ++i) {
      const std::size_t at = scratch.frame.size();
      scratch.frame.resize(at + index.fragments[i].length);
      if (!source.read(index.fragments[i].offset, std::span(scratch.frame).subspan(at)))
        return makeError(ErrorCode::FileDamaged, "The compressed pixel data cannot be read to its end.");
    }
    bytes = scratch.frame;
  }
  if (bytes.empty())
    return makeError(ErrorCode::CodecFailed, "The compressed data of frame " + std::to_string(frame + 1) +
                                                 " is empty; fetch the file again from its source.");
  if (auto r = checkRatio(bytes, spec, out.size()); !r) return r;
  switch (syntaxKind(spec.transferSyntaxUid)) {
    case SyntaxKind::Rle:
      return decodeRle(bytes, spec, out, scratch);
    case SyntaxKind::Jpeg:
      return decodeJpeg(bytes, spec, out, scratch);
    case SyntaxKind::JpegLs:
      return decodeJpegLs(bytes, spec, out, scratch);
    case SyntaxKind::Jpeg2000:
      return decodeJpeg2000(bytes, spec, out, scratch);
    case SyntaxKind::DeflatedFrames: {
      const auto plain = inflateAll(bytes);
      if (!plain) return plain.error();
      return unpackNative(*plain, 0, spec, out);
    }
    default:
      return makeError(
          ErrorCode::CodecUnsupported,
          "The pixel data is compressed, but its transfer syntax names no compression that is known.");
  }
}

Result<void> decodeAny(Source& source, const PixelIndex& index, const FrameSpec& spec, std::uint64_t frame,
                       std::span<std::byte> out, Scratch& scratch) {
  const std::uint16_t element = spec.sample == SampleType::F32   ? 0x0008
                                : spec.sample == SampleType::F64 ? 0x0009
                                                                 : 0x0010;
  if (index.element != element)
    return makeError(ErrorCode::CodecMismatch,
                     "The object holds integer pixels where its attributes declare "
                     "floating-point ones, or the other way round.");
  if (index.encapsulated) return decodeEncapsulated(source, index, spec, frame, out, scratch);
  const SyntaxKind kind = syntaxKind(spec.transferSyntaxUid);
  if (kind == SyntaxKind::Native || kind == SyntaxKind::NativeBig || kind == SyntaxKind::Deflated)
    return decodeNative(source, index, spec, frame, out, scratch);
  return makeError(
      ErrorCode::CodecMismatch,
      "The transfer syntax names a compression, but the pixel data is not cut into compressed frames.");
}

}  // namespace

Result<void> checkSpec(const FrameSpec& spec) {
  const bool sizes = spec.rows > 0 && spec.columns > 0 &&
                     (spec.samplesPerPixel == 1 || spec.samplesPerPixel == 3 || spec.samplesPerPixel == 4);
  const bool bits = spec.bitsStored >= 1 && spec.bitsStored <= spec.bitsAllocated &&
                    spec.highBit < spec.bitsAllocated && spec.highBit + 1 >= spec.bitsStored;
  const bool container = spec.bitsAllocated == 1 ? spec.sample == SampleType::U8 && spec.samplesPerPixel == 1
                                                 : spec.bitsAllocated == 8 * bytesOf(spec.sample);
  if (!sizes || !bits || !container)
    return makeError(ErrorCode::PixelDescriptionInvalid, "The description of the pixels contradicts itself.");
  return {};
}

Result<void> decodeFrame(Source& source, const PixelIndex& index, const FrameSpec& spec, std::uint64_t frame,
                         std::span<std::byte> out, Scratch& scratch) {
  scratch.colours = spec.colourSpace();
  Result<void> done = guarded("decode", [&] { return decodeAny(source, index, spec, frame, out, scratch); });
  if (!done) std::ranges::fill(out, std::byte{0});
  return done;
}

}  // namespace vernier::study
