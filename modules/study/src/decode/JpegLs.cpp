// SPDX-License-Identifier: GPL-3.0-or-later
// JPEG-LS lossless and near-lossless (ITU-T T.87) by CharLS. DCMTK's own decoder is an older copy of it,
// which refuses some precisions (7 bits) that this one reads.
#include <charls/charls.h>

#include <algorithm>
#include <array>

#include "decode/Codecs.h"
#include "decode/Samples.h"

namespace vernier::study {

Result<void> decodeJpegLs(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out, Scratch& scratch) {
  // CharLS 2.4 counts through 2^31 bits that are not there when the data ends early, but stops at a marker:
  // so every frame gets an end marker of its own. Behind the end of sound data nothing is read.
  constexpr std::array<std::byte, 2> kEndOfImage{std::byte{0xFF}, std::byte{0xD9}};
  std::vector<std::byte> ended(frame.size() + kEndOfImage.size());
  std::ranges::copy(kEndOfImage, std::ranges::copy(frame, ended.begin()).out);
  try {
    charls::jpegls_decoder decoder;
    decoder.source(ended.data(), ended.size());
    decoder.read_header();
    const charls::frame_info info = decoder.frame_info();
    const CodedImage coded{info.height, info.width, static_cast<std::uint64_t>(info.component_count),
                           static_cast<std::uint32_t>(info.bits_per_sample)};
    if (auto r = checkCoded(coded, spec); !r) return r;
    const std::uint64_t bytes = info.bits_per_sample > 8 ? 2 : 1;
    scratch.pixels.resize(out.size() / bytesOf(spec.sample) * bytes);
    if (decoder.destination_size() != scratch.pixels.size())
      return makeError(ErrorCode::CodecMismatch,
                       "The JPEG-LS image has another size than its attributes declare.");
    decoder.decode(scratch.pixels.data(), scratch.pixels.size());
    // Without interleaving the components come one after the other.
    if (info.component_count > 1 && decoder.interleave_mode() == charls::interleave_mode::none) {
      std::vector<std::byte> mixed(scratch.pixels.size());
      interleave(scratch.pixels, spec.samplesPerPixel, bytes, mixed);
      scratch.pixels.swap(mixed);
    }
    widenSamples(spec, coded.precision, scratch.pixels, bytes, out);
    return {};
  } catch (const charls::jpegls_error& e) {
    return makeError(ErrorCode::CodecFailed, std::string("The JPEG-LS data of a frame is damaged (") +
                                                 e.what() + "); fetch the file again from its source.");
  }
}

}  // namespace vernier::study
