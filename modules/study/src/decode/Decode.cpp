// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/study/Decode.h"

#include <algorithm>

#include "decode/FrameDecode.h"
#include "vernier/base/Guarded.h"

namespace vernier {
namespace {

// Frames decoded so far; the first error ends the work.
Result<void> decodeFrames(study::Source& source, std::uint64_t dataSet, const FrameSpec& spec,
                          std::span<std::byte> out, std::uint64_t& done, ColourSpace* colours) {
  const auto index = study::indexPixels(source, dataSet, spec);
  if (!index) return index.error();
  const std::uint64_t bytes = out.size() / spec.frameCount;
  study::Scratch scratch;
  for (; done < spec.frameCount; ++done) {
    const auto r = study::decodeFrame(source, *index, spec, spec.firstFrame + done,
                                      out.subspan(done * bytes, bytes), scratch);
    if (!r) return r;
    if (colours) *colours = scratch.colours;
  }
  return {};
}

Result<void> decodeFile(std::span<const std::byte> file, const FrameSpec& spec, std::span<std::byte> out,
                        std::uint64_t& done, ColourSpace* colours) {
  if (auto r = study::checkSpec(spec); !r) return r;
  const auto bytes = spec.outputBytes();
  if (!bytes) return bytes.error();
  if (spec.frameCount == 0 || spec.firstFrame > spec.framesDeclared ||
      spec.frameCount > spec.framesDeclared - spec.firstFrame)
    return makeError(ErrorCode::PixelDataMissing, "The frames asked for are not all among the " +
                                                      std::to_string(spec.framesDeclared) + " declared.");
  if (out.size() != *bytes)
    return makeError(ErrorCode::Internal, "decode() was given a buffer of the wrong size.", "decode");
  study::SpanSource source(file);
  const auto dataSet = study::dataSetOffset(source);
  if (!dataSet) return dataSet.error();
  if (syntaxKind(spec.transferSyntaxUid) != SyntaxKind::Deflated)
    return decodeFrames(source, *dataSet, spec, out, done, colours);
  const auto plain = study::inflateAll(file.subspan(*dataSet));
  if (!plain) return plain.error();
  study::SpanSource inflated(*plain);
  return decodeFrames(inflated, 0, spec, out, done, colours);
}

}  // namespace

Result<void> decode(std::span<const std::byte> file, const FrameSpec& spec, std::span<std::byte> out,
                    ColourSpace* colours) {
  std::uint64_t done = 0;
  Result<void> r = guarded("decode", [&] { return decodeFile(file, spec, out, done, colours); });
  if (!r) {
    const std::uint64_t kept = spec.frameCount > 0 ? done * (out.size() / spec.frameCount) : 0;
    std::ranges::fill(out.subspan(kept), std::byte{0});
  }
  return r;
}

}  // namespace vernier
