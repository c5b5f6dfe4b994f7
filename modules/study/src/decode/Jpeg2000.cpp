// SPDX-License-Identifier: GPL-3.0-or-later
// JPEG 2000 (ITU-T T.800) by OpenJPEG. The size marker is read here first: it decides how much the library
// sets aside.
#include <openjpeg.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>

#include "decode/Codecs.h"
#include "decode/Samples.h"

namespace vernier::study {
namespace {

Error failed(const std::string& what) {
  return makeError(ErrorCode::CodecFailed,
                   "The JPEG 2000 data of a frame " + what + "; fetch the file again from its source.");
}

std::uint64_t be(ByteSpan b, std::size_t at, std::size_t n) {
  std::uint64_t v = 0;
  for (std::size_t i = 0; i < n; ++i) v = v << 8 | std::to_integer<std::uint64_t>(b[at + i]);
  return v;
}

struct SizeMarker {
  CodedImage image;
  std::uint64_t tiles = 0;
};

// SIZ follows SOC at once; a JP2 box around the codestream is let pass.
std::optional<SizeMarker> findSize(ByteSpan b) {
  constexpr std::array<std::byte, 4> start{std::byte{0xFF}, std::byte{0x4F}, std::byte{0xFF},
                                           std::byte{0x51}};
  const auto found = std::search(b.begin(), b.end(), start.begin(), start.end());
  const auto at = static_cast<std::size_t>(found - b.begin());
  constexpr std::size_t kSizBytes = 43;  // SOC, SIZ with one component
  if (b.size() < kSizBytes || at > b.size() - kSizBytes) return std::nullopt;
  const std::uint64_t x1 = be(b, at + 8, 4), y1 = be(b, at + 12, 4), x0 = be(b, at + 16, 4),
                      y0 = be(b, at + 20, 4);
  const std::uint64_t tw = be(b, at + 24, 4), th = be(b, at + 28, 4), tx = be(b, at + 32, 4),
                      ty = be(b, at + 36, 4);
  if (x1 <= x0 || y1 <= y0 || tw == 0 || th == 0 || tx > x0 || ty > y0) return std::nullopt;
  SizeMarker s;
  s.image.columns = x1 - x0;
  s.image.rows = y1 - y0;
  s.image.components = be(b, at + 40, 2);
  s.image.precision = (std::to_integer<std::uint32_t>(b[at + 42]) & 0x7F) + 1;
  s.tiles = ((x1 - tx + tw - 1) / tw) * ((y1 - ty + th - 1) / th);
  return s;
}

// The library reads through callbacks.
struct Input {
  ByteSpan bytes;
  std::size_t at = 0;
};
OPJ_SIZE_T readInput(void* to, OPJ_SIZE_T n, void* user) {
  auto& in = *static_cast<Input*>(user);
  const std::size_t left = in.bytes.size() - in.at;
  if (left == 0) return static_cast<OPJ_SIZE_T>(-1);
  n = std::min<OPJ_SIZE_T>(n, left);
  std::memcpy(to, in.bytes.data() + in.at, n);
  in.at += n;
  return n;
}
OPJ_OFF_T skipInput(OPJ_OFF_T n, void* user) {
  auto& in = *static_cast<Input*>(user);
  if (n < 0) return -1;
  const auto left = static_cast<OPJ_OFF_T>(in.bytes.size() - in.at);
  if (left == 0) return -1;
  n = std::min(n, left);
  in.at += static_cast<std::size_t>(n);
  return n;
}
OPJ_BOOL seekInput(OPJ_OFF_T to, void* user) {
  auto& in = *static_cast<Input*>(user);
  if (to < 0 || static_cast<std::uint64_t>(to) > in.bytes.size()) return OPJ_FALSE;
  in.at = static_cast<std::size_t>(to);
  return OPJ_TRUE;
}

using Stream = std::unique_ptr<opj_stream_t, decltype(&opj_stream_destroy)>;
using Codec = std::unique_ptr<opj_codec_t, decltype(&opj_destroy_codec)>;
using Image = std::unique_ptr<opj_image_t, decltype(&opj_image_destroy)>;

Stream openStream(Input& in) {
  Stream s(opj_stream_create(std::min<std::size_t>(in.bytes.size(), 1 << 20), OPJ_TRUE), &opj_stream_destroy);
  if (!s) return s;
  opj_stream_set_read_function(s.get(), readInput);
  opj_stream_set_skip_function(s.get(), skipInput);
  opj_stream_set_seek_function(s.get(), seekInput);
  opj_stream_set_user_data(s.get(), &in, nullptr);
  opj_stream_set_user_data_length(s.get(), in.bytes.size());
  return s;
}

struct Decoded {
  Image image;
  bool transformed = false;  // the library has undone the colour transform of the codestream: RGB
};

bool transformsColours(opj_codec_t* codec) {
  opj_codestream_info_v2_t* info = opj_get_cstr_info(codec);
  const bool yes = info && info->m_default_tile_info.mct == 1;
  opj_destroy_cstr_info(&info);
  return yes;
}

Result<Decoded> decodeImage(ByteSpan frame, const FrameSpec& spec) {
  Input in{frame};
  const Stream stream = openStream(in);
  const bool boxed = frame[0] == std::byte{0};
  const Codec codec(opj_create_decompress(boxed ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K), &opj_destroy_codec);
  if (!stream || !codec) return makeError(ErrorCode::OutOfMemory, "There is no memory to decode JPEG 2000.");
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  if (!opj_setup_decoder(codec.get(), &parameters)) return failed("cannot be set up");
  opj_image_t* raw = nullptr;
  const OPJ_BOOL headerRead = opj_read_header(stream.get(), codec.get(), &raw);
  Image image(raw, &opj_image_destroy);
  if (!headerRead || !image) return failed("has a damaged header");
  const CodedImage coded{image->y1 - image->y0, image->x1 - image->x0, image->numcomps,
                         image->numcomps > 0 ? image->comps[0].prec : 0};
  if (auto r = checkCoded(coded, spec); !r) return r.error();
  if (!opj_decode(codec.get(), stream.get(), image.get())) return failed("is cut short or damaged");
  // A palette of a JP2 box changes the components.
  if (image->numcomps != spec.samplesPerPixel) return failed("turns into another number of components");
  return Decoded{std::move(image), transformsColours(codec.get())};
}

template <class T>
void copyComponent(const opj_image_comp_t& c, std::uint64_t pixels, std::uint64_t samples, std::byte* out) {
  for (std::uint64_t i = 0; i < pixels; ++i) {
    const auto v = static_cast<T>(c.data[i]);
    std::memcpy(out + i * samples * sizeof(T), &v, sizeof v);
  }
}

}  // namespace

Result<void> decodeJpeg2000(ByteSpan frame, const FrameSpec& spec, std::span<std::byte> out,
                            Scratch& scratch) {
  const auto size = findSize(frame);
  if (!size) return failed("has no readable header");
  if (auto r = checkCoded(size->image, spec); !r) return r;
  // Each tile needs at least its part header and start-of-data marker.
  if (size->tiles > frame.size() / 14) return failed("declares more tiles than it can hold");
  const auto decoded = decodeImage(frame, spec);
  if (!decoded) return decoded.error();
  const Image& image = decoded->image;
  const std::uint64_t pixels = spec.rows * spec.columns, bytes = bytesOf(spec.sample);
  for (std::uint32_t s = 0; s < spec.samplesPerPixel; ++s) {
    const opj_image_comp_t& c = image->comps[s];
    if (!c.data || c.w != spec.columns || c.h != spec.rows || c.prec > spec.bitsAllocated)
      return makeError(ErrorCode::CodecMismatch,
                       "A component of the JPEG 2000 image has another size than the image.");
    std::byte* to = out.data() + s * bytes;
    if (bytes == 1) copyComponent<std::uint8_t>(c, pixels, spec.samplesPerPixel, to);
    if (bytes == 2) copyComponent<std::uint16_t>(c, pixels, spec.samplesPerPixel, to);
    if (bytes == 4) copyComponent<std::uint32_t>(c, pixels, spec.samplesPerPixel, to);
  }
  const std::uint32_t precision = image->comps[0].prec;
  const std::uint32_t lowBit = precision > spec.bitsStored ? spec.highBit + 1 - spec.bitsStored : 0;
  maskSamples(spec, lowBit, spec.bitsStored, out);
  if (spec.samplesPerPixel == 3 && decoded->transformed) scratch.colours = ColourSpace::Rgb;
  return {};
}

}  // namespace vernier::study
