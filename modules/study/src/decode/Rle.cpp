// SPDX-License-Identifier: GPL-3.0-or-later
// RLE Lossless, DICOM PS3.5 annex G: up to 15 byte planes (most significant byte first, sample by sample),
// each packed on its own.
#include <array>

#include "decode/Codecs.h"
#include "decode/Samples.h"

namespace vernier::study {
namespace {

constexpr std::size_t kHeaderBytes = 64;
constexpr std::uint32_t kMaxSegments = 15;

Error failed(const char* what) {
  return makeError(ErrorCode::CodecFailed, std::string("The RLE data of a frame ") + what +
                                               "; fetch the file again from its source.");
}

std::uint32_t le32(const std::byte* p) {
  std::uint32_t v = 0;
  for (int i = 3; i >= 0; --i) v = v << 8 | std::to_integer<std::uint32_t>(p[i]);
  return v;
}

// Writes `count` bytes to out[0], out[step], ...; false when the segment ends before.
bool unpackSegment(ByteSpan in, std::byte* out, std::uint64_t count, std::uint64_t step) {
  std::size_t at = 0;
  std::uint64_t done = 0;
  while (done < count) {
    if (at >= in.size()) return false;
    const unsigned code = std::to_integer<unsigned>(in[at++]);
    if (code == 128) continue;
    const bool literal = code < 128;
    const std::uint64_t n = std::min<std::uint64_t>(literal ? code + 1 : 257 - code, count - done);
    if (at + (literal ? n : 1) > in.size()) return false;
    for (std::uint64_t i = 0; i < n; ++i) out[(done + i) * step] = in[at + (literal ? i : 0)];
    at += literal ? n : 1;
    done += n;
  }
  return true;
}

// The segments' bounds, checked against the frame.
Result<std::array<ByteSpan, kMaxSegments>> cutSegments(ByteSpan frame, std::uint64_t wanted) {
  std::array<ByteSpan, kMaxSegments> segments;
  if (frame.size() < kHeaderBytes) return failed("is shorter than its header");
  const std::uint32_t n = le32(&frame[0]);
  if (n > kMaxSegments) return failed("names more than 15 segments");
  if (n != wanted)
    return makeError(ErrorCode::CodecMismatch, "The RLE data has " + std::to_string(n) +
                                                   " byte planes, but the " + "attributes need " +
                                                   std::to_string(wanted) + ".");
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint64_t begin = le32(&frame[4 + 4 * i]);
    const std::uint64_t end = i + 1 < n ? le32(&frame[8 + 4 * i]) : frame.size();
    if (begin < kHeaderBytes || begin > end || end > frame.size())
      return failed("has segments outside its bounds");
    segments[i] = frame.subspan(begin, end - begin);
  }
  return segments;
}

}  // namespace

Result<void> decodeRle(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out, Scratch& scratch) {
  const bool bits = spec.bitsAllocated == 1;
  const std::uint64_t bytes = bits ? 1 : bytesOf(spec.sample);
  const std::uint64_t planes = spec.samplesPerPixel * bytes;
  const auto segments = cutSegments(frame, planes);
  if (!segments) return segments.error();
  if (bits) {
    // Bits are packed into bytes before they are run-length coded; each frame begins with a new byte.
    scratch.pixels.resize((out.size() + 7) / 8);
    if (!unpackSegment((*segments)[0], scratch.pixels.data(), scratch.pixels.size(), 1))
      return failed("is cut short");
    return unpackNative(scratch.pixels, 0, spec, out);
  }
  const std::uint64_t pixels = out.size() / planes;
  for (std::uint64_t s = 0; s < spec.samplesPerPixel; ++s)
    for (std::uint64_t b = 0; b < bytes; ++b) {
      // Most significant byte first in the file, last in memory.
      std::byte* const to = out.data() + s * bytes + (bytes - 1 - b);
      if (!unpackSegment((*segments)[s * bytes + b], to, pixels, planes)) return failed("is cut short");
    }
  maskSamples(spec, spec.highBit + 1 - spec.bitsStored, spec.bitsStored, out);
  return {};
}

}  // namespace vernier::study
