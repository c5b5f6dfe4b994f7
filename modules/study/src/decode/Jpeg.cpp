// SPDX-License-Identifier: GPL-3.0-or-later
// JPEG baseline, extended, progressive and lossless (ITU-T T.81) by the IJG libraries that DCMTK brings for
// 8, 12 and 16 bits: their arithmetic is what other DICOM readers agree with. The image's header is read here
// first, so that the library never meets a size that the attributes do not declare. Colour is left as coded.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmjpeg/djcparam.h>
#include <dcmtk/dcmjpeg/djdijg12.h>
#include <dcmtk/dcmjpeg/djdijg16.h>
#include <dcmtk/dcmjpeg/djdijg8.h>
#include <dcmtk/oflog/oflog.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>

#include "decode/Codecs.h"
#include "vernier/study/Limits.h"

namespace vernier::study {
namespace {

Error failed(const std::string& what) {
  return makeError(ErrorCode::CodecFailed,
                   "The JPEG data of a frame " + what + "; fetch the file again from its source.");
}

struct JpegHeader {
  CodedImage image;
  bool lossless = false;
  std::optional<bool> ybr;  // what the image says of its colours; absent: nothing
};

std::uint32_t be16(ByteSpan b, std::size_t at) {
  return std::to_integer<std::uint32_t>(b[at]) << 8 | std::to_integer<std::uint32_t>(b[at + 1]);
}

bool startsWith(ByteSpan b, std::string_view text) {
  return b.size() >= text.size() && std::equal(text.begin(), text.end(), b.begin(), [](char c, std::byte x) {
           return std::byte(static_cast<unsigned char>(c)) == x;
         });
}

// The colour transform that an Adobe APP14 segment names (T.872 6.5.3): 0 none, 1 YCbCr.
std::optional<bool> adobeYbr(ByteSpan segment) {
  if (!startsWith(segment, "Adobe") || segment.size() < 12) return std::nullopt;
  if (segment[11] == std::byte{0}) return false;
  if (segment[11] == std::byte{1}) return true;
  return std::nullopt;
}

// `components`: identifier, sampling factors, table of each, from the frame header.
std::optional<bool> ybrOf(ByteSpan components, std::optional<bool> adobe, bool jfif) {
  if (components.size() != 9) return std::nullopt;
  if (adobe) return adobe;
  if (jfif) return true;  // JFIF knows grey and YCbCr only
  if (components[0] == std::byte{'R'} && components[3] == std::byte{'G'} && components[6] == std::byte{'B'})
    return false;
  // Only chroma is ever kept at half the resolution.
  if (components[1] != components[4] || components[1] != components[7]) return true;
  return std::nullopt;
}

// Walks the marker segments up to the first frame header (SOF).
std::optional<JpegHeader> findFrameHeader(ByteSpan b) {
  if (b.size() < 4 || be16(b, 0) != 0xFFD8) return std::nullopt;
  std::size_t at = 2;
  std::optional<bool> adobe;
  bool jfif = false;
  while (at + 4 <= b.size()) {
    if (b[at] != std::byte{0xFF}) return std::nullopt;
    const auto marker = std::to_integer<unsigned>(b[at + 1]);
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    if (marker == 0x01 || (marker >= 0xD0 && marker <= 0xD8)) {  // no length
      at += 2;
      continue;
    }
    const std::size_t length = be16(b, at + 2);
    if (length < 2 || at + 2 + length > b.size() || marker == 0xD9 || marker == 0xDA) return std::nullopt;
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) {
      // Baseline, extended, progressive, lossless; the hierarchical and arithmetic ones were never DICOM's.
      if (length < 8 || marker > 0xC3) return std::nullopt;
      JpegHeader h;
      h.image.precision = std::to_integer<std::uint32_t>(b[at + 4]);
      h.image.rows = be16(b, at + 5);
      h.image.columns = be16(b, at + 7);
      h.image.components = std::to_integer<std::uint64_t>(b[at + 9]);
      h.lossless = marker == 0xC3;
      h.ybr = ybrOf(b.subspan(at + 10, length - 8), adobe, jfif);
      return h;
    }
    const ByteSpan segment = b.subspan(at + 4, length - 2);
    if (marker == 0xE0 && startsWith(segment, "JFIF")) jfif = true;
    if (marker == 0xEE) adobe = adobeYbr(segment);
    at += 2 + length;
  }
  return std::nullopt;
}

// Inside coded data FF is always followed by 00 or a restart marker, so that FFDA is a scan header.
std::uint64_t countScans(ByteSpan b) {
  std::uint64_t n = 0;
  for (std::size_t i = 0; i + 1 < b.size(); ++i) n += b[i] == std::byte{0xFF} && b[i + 1] == std::byte{0xDA};
  return n;
}

// The library tells warnings to its log; what matters comes back as an error.
void silenceLog() {
  static std::once_flag once;
  std::call_once(once, [] { OFLog::getLogger("dcmtk.dcmjpeg").setLogLevel(OFLogger::OFF_LOG_LEVEL); });
}

std::unique_ptr<DJDecoder> decoderFor(const JpegHeader& h, const DJCodecParameter& p, bool isYbr) {
  if (h.image.precision <= 8) return std::make_unique<DJDecompressIJG8Bit>(p, isYbr);
  if (h.image.precision <= 12) return std::make_unique<DJDecompressIJG12Bit>(p, isYbr);
  if (h.lossless) return std::make_unique<DJDecompressIJG16Bit>(p, isYbr);
  return nullptr;
}

}  // namespace

Result<void> decodeJpeg(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out, Scratch& scratch) {
  silenceLog();
  const auto header = findFrameHeader(frame);
  if (!header) return failed("has no readable header");
  if (auto r = checkCoded(header->image, spec); !r) return r;
  if (countScans(frame) > limits::kMaxJpegScans)
    return makeError(ErrorCode::LimitExceeded, "The JPEG data of a frame has more than " +
                                                   std::to_string(limits::kMaxJpegScans) +
                                                   " scans; it is refused.");
  const DJCodecParameter parameters(ECC_lossyYCbCr, EDC_never, EUC_never, EPC_default);
  const auto decoder = decoderFor(*header, parameters, spec.photometric.starts_with("YBR"));
  if (!decoder) return failed("is lossy with more than 12 bits, which JPEG does not have");
  const std::uint64_t bytes = decoder->bytesPerSample();
  const std::uint64_t size = out.size() / bytesOf(spec.sample) * bytes;
  if (size > std::numeric_limits<Uint32>::max() || frame.size() > std::numeric_limits<Uint32>::max())
    return makeError(ErrorCode::LimitExceeded, "A JPEG frame is larger than 4 GiB.");
  scratch.pixels.resize(size);
  if (decoder->init().bad()) return failed("cannot be read");
  // The library takes its input as writable but only reads it.
  auto* in = reinterpret_cast<Uint8*>(const_cast<std::byte*>(frame.data()));
  const OFCondition done =
      decoder->decode(in, static_cast<Uint32>(frame.size()), reinterpret_cast<Uint8*>(scratch.pixels.data()),
                      static_cast<Uint32>(size), spec.isSigned);
  if (done.bad()) return failed(std::string("is cut short or damaged (") + done.text() + ")");
  widenSamples(spec, header->image.precision, scratch.pixels, bytes, out);
  // Lossless coders never transform colours, whatever markers they write; else the image itself knows best.
  if (!header->lossless && header->ybr) {
    if (!*header->ybr) scratch.colours = ColourSpace::Rgb;
    if (*header->ybr && scratch.colours == ColourSpace::Rgb) scratch.colours = ColourSpace::YbrFull;
  }
  return {};
}

}  // namespace vernier::study
