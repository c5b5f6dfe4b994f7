// SPDX-License-Identifier: GPL-3.0-or-later
#include "Encode.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmjpeg/djcparam.h>
#include <dcmtk/dcmjpeg/djeijg12.h>
#include <dcmtk/dcmjpeg/djeijg16.h>
#include <dcmtk/dcmjpeg/djeijg8.h>

#include <charls/charls.h>
#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>

namespace vernier::phantoms {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr const char* kRle = "1.2.840.10008.1.2.5";
constexpr const char* kJpegBaseline = "1.2.840.10008.1.2.4.50";
constexpr const char* kJpegExtended = "1.2.840.10008.1.2.4.51";
constexpr const char* kJpegLossless = "1.2.840.10008.1.2.4.57";
constexpr const char* kJpegLosslessSv1 = "1.2.840.10008.1.2.4.70";
constexpr const char* kJpegLs = "1.2.840.10008.1.2.4.80";
constexpr const char* kJpegLsNear = "1.2.840.10008.1.2.4.81";
constexpr const char* kJpeg2000Lossless = "1.2.840.10008.1.2.4.90";

std::vector<std::uint16_t> words(const SeriesPlan& s, const std::vector<std::int32_t>& stored) {
  std::vector<std::uint16_t> out(stored.size());
  const std::uint32_t mask = (1u << s.bitsStored) - 1;
  for (std::size_t n = 0; n < stored.size(); ++n)
    out[n] = static_cast<std::uint16_t>(static_cast<std::uint32_t>(stored[n]) & mask);
  return out;
}

// PackBits (PS3.5 G.3.1), each row by itself.
void packRow(const std::uint8_t* p, std::size_t n, Bytes& out) {
  std::size_t i = 0;
  while (i < n) {
    std::size_t run = 1;
    while (i + run < n && run < 128 && p[i + run] == p[i]) ++run;
    if (run >= 2) {
      out.push_back(static_cast<std::uint8_t>(257 - run));
      out.push_back(p[i]);
      i += run;
      continue;
    }
    std::size_t literal = 1;
    while (i + literal < n && literal < 128 && (i + literal + 1 >= n || p[i + literal] != p[i + literal + 1]))
      ++literal;
    out.push_back(static_cast<std::uint8_t>(literal - 1));
    out.insert(out.end(), p + i, p + i + literal);
    i += literal;
  }
}

Bytes encodeRle(const SeriesPlan& s, const std::vector<std::uint16_t>& v) {
  const int segments = s.bitsAllocated / 8;  // most significant byte first
  Bytes out(64, 0);
  const auto put32 = [&out](std::size_t at, std::uint32_t x) {
    for (int n = 0; n < 4; ++n)
      out[at + static_cast<std::size_t>(n)] = static_cast<std::uint8_t>(x >> (8 * n));
  };
  put32(0, static_cast<std::uint32_t>(segments));
  const auto columns = static_cast<std::size_t>(s.columns);
  Bytes row(columns);
  for (int segment = 0; segment < segments; ++segment) {
    put32(4 + 4 * static_cast<std::size_t>(segment), static_cast<std::uint32_t>(out.size()));
    const int shift = 8 * (segments - 1 - segment);
    for (std::size_t j = 0; j < static_cast<std::size_t>(s.rows); ++j) {
      for (std::size_t i = 0; i < columns; ++i)
        row[i] = static_cast<std::uint8_t>(v[j * columns + i] >> shift);
      packRow(row.data(), columns, out);
    }
    if (out.size() % 2) out.push_back(0);
  }
  return out;
}

Bytes taken(OFCondition condition, Uint8* to, Uint32 length) {
  const std::unique_ptr<Uint8[]> owner(to);
  if (condition.bad() || !to) throw std::runtime_error(std::string("JPEG encoder: ") + condition.text());
  return Bytes(to, to + length);
}

Bytes encodeJpeg(const SeriesPlan& s, std::vector<std::uint16_t> v) {
  const DJCodecParameter parameter(ECC_lossyYCbCr, EDC_never, EUC_never, EPC_colorByPixel);
  const auto columns = static_cast<Uint16>(s.columns), rows = static_cast<Uint16>(s.rows);
  Uint8* to = nullptr;
  Uint32 length = 0;
  if (s.transferSyntaxUid == kJpegBaseline) {
    Bytes narrow(v.size());
    std::transform(v.begin(), v.end(), narrow.begin(),
                   [](std::uint16_t x) { return static_cast<std::uint8_t>(x); });
    DJCompressIJG8Bit encoder(parameter, EJM_baseline, static_cast<Uint8>(s.quality));
    const OFCondition done = encoder.encode(columns, rows, EPI_Monochrome2, 1, narrow.data(), to, length);
    return taken(done, to, length);
  }
  if (s.transferSyntaxUid == kJpegExtended) {
    DJCompressIJG12Bit encoder(parameter, EJM_sequential, static_cast<Uint8>(s.quality));
    const OFCondition done = encoder.encode(columns, rows, EPI_Monochrome2, 1, v.data(), to, length);
    return taken(done, to, length);
  }
  // Process 14: predictor 1 for selection value 1, predictor 6 shows that the other one is not always 1.
  const int predictor = s.transferSyntaxUid == kJpegLosslessSv1 ? 1 : 6;
  if (s.bitsStored <= 12) {
    DJCompressIJG12Bit encoder(parameter, EJM_lossless, predictor, 0);
    const OFCondition done = encoder.encode(columns, rows, EPI_Monochrome2, 1, v.data(), to, length);
    return taken(done, to, length);
  }
  DJCompressIJG16Bit encoder(parameter, EJM_lossless, predictor, 0);
  const OFCondition done = encoder.encode(columns, rows, EPI_Monochrome2, 1, v.data(), to, length);
  return taken(done, to, length);
}

Bytes encodeJpegLs(const SeriesPlan& s, const std::vector<std::uint16_t>& v) {
  charls::jpegls_encoder encoder;
  encoder.frame_info(
      {static_cast<std::uint32_t>(s.columns), static_cast<std::uint32_t>(s.rows), s.bitsStored, 1});
  encoder.near_lossless(s.transferSyntaxUid == kJpegLsNear ? s.quality : 0);
  Bytes out(encoder.estimated_destination_size() + 1024);
  encoder.destination(out);
  out.resize(encoder.encode(v.data(), v.size() * sizeof(v[0])));
  return out;
}

OPJ_SIZE_T appendBytes(void* buffer, OPJ_SIZE_T count, void* sink) {
  auto& out = *static_cast<Bytes*>(sink);
  const auto* bytes = static_cast<const std::uint8_t*>(buffer);
  out.insert(out.end(), bytes, bytes + count);
  return count;
}

Bytes encodeJpeg2000(const SeriesPlan& s, const std::vector<std::uint16_t>& v) {
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = static_cast<OPJ_UINT32>(s.columns);
  component.h = static_cast<OPJ_UINT32>(s.rows);
  component.prec = static_cast<OPJ_UINT32>(s.bitsStored);
  const std::unique_ptr<opj_image_t, void (*)(opj_image_t*)> image(
      opj_image_create(1, &component, OPJ_CLRSPC_GRAY), opj_image_destroy);
  if (!image) throw std::runtime_error("OpenJPEG: no image");
  image->x1 = component.w;
  image->y1 = component.h;
  std::copy(v.begin(), v.end(), image->comps[0].data);

  opj_cparameters_t parameters{};
  opj_set_default_encoder_parameters(&parameters);
  char comment[] = "Vernier phantom";  // else OpenJPEG writes its version there
  parameters.cp_comment = comment;
  parameters.cp_disto_alloc = 1;
  parameters.tcp_numlayers = 1;
  parameters.tcp_rates[0] = 0;  // lossless
  parameters.irreversible = 0;
  while ((1 << (parameters.numresolution - 1)) > std::min(s.columns, s.rows)) --parameters.numresolution;
  const std::unique_ptr<opj_codec_t, void (*)(opj_codec_t*)> codec(
      opj_create_compress(OPJ_CODEC_J2K), [](opj_codec_t* c) { opj_destroy_codec(c); });
  const std::unique_ptr<opj_stream_t, void (*)(opj_stream_t*)> stream(
      opj_stream_default_create(OPJ_FALSE), [](opj_stream_t* t) { opj_stream_destroy(t); });
  // The encoder writes forwards only; a tile's length is known before its header is written.
  Bytes out;
  opj_stream_set_user_data(stream.get(), &out, nullptr);
  opj_stream_set_write_function(stream.get(), appendBytes);
  if (!opj_setup_encoder(codec.get(), &parameters, image.get()) ||
      !opj_start_compress(codec.get(), image.get(), stream.get()) || !opj_encode(codec.get(), stream.get()) ||
      !opj_end_compress(codec.get(), stream.get()))
    throw std::runtime_error("OpenJPEG: the encoder failed");
  return out;
}

}  // namespace

bool isEncapsulated(const std::string& uid) { return uid == kRle || uid.starts_with("1.2.840.10008.1.2.4."); }

std::vector<std::uint8_t> encodeFrame(const SeriesPlan& s, const std::vector<std::int32_t>& stored) {
  const std::vector<std::uint16_t> v = words(s, stored);
  const std::string& uid = s.transferSyntaxUid;
  Bytes out;
  if (uid == kRle)
    out = encodeRle(s, v);
  else if (uid == kJpegLs || uid == kJpegLsNear)
    out = encodeJpegLs(s, v);
  else if (uid == kJpeg2000Lossless)
    out = encodeJpeg2000(s, v);
  else if (uid == kJpegBaseline || uid == kJpegExtended || uid == kJpegLossless || uid == kJpegLosslessSv1)
    out = encodeJpeg(s, v);
  else
    throw std::runtime_error("no encoder for " + uid);
  if (out.size() % 2) out.push_back(0);
  return out;
}

}  // namespace vernier::phantoms
