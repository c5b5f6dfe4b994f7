// SPDX-License-Identifier: GPL-3.0-or-later
// JPEG lossless, JPEG-LS, JPEG 2000: values that are known, coded here without loss, decoded by Vernier; and
// headers that do not agree with the attributes, cut data, many fragments.
#include <charls/charls.h>
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmjpeg/djcparam.h>
#include <dcmtk/dcmjpeg/djeijg12.h>
#include <dcmtk/dcmjpeg/djeijg16.h>
#include <dcmtk/dcmjpeg/djeijg8.h>
#include <gtest/gtest.h>
#include <openjpeg.h>
#include <zlib.h>

#include <random>

#include "DecodeSupport.h"

namespace vernier::test {
namespace {

constexpr const char* kJpegLossless = "1.2.840.10008.1.2.4.70";
constexpr const char* kJpegLs = "1.2.840.10008.1.2.4.80";
constexpr const char* kJpeg2000 = "1.2.840.10008.1.2.4.90";
constexpr unsigned kRows = 13, kColumns = 21;

// Smooth with noise and the two ends of the range, interleaved.
std::vector<std::int64_t> someValues(unsigned bits, bool isSigned, unsigned samples, unsigned seed) {
  std::mt19937 random(seed);
  const std::int64_t size = std::int64_t{1} << bits, low = isSigned ? -size / 2 : 0;
  std::vector<std::int64_t> v(kRows * kColumns * samples);
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] =
        low + static_cast<std::int64_t>(i * static_cast<std::size_t>(size) / v.size() + random() % 5) % size;
  v[5] = low;
  v[6] = low + size - 1;
  return v;
}

// Two's complement of `bits` bits in words of 1 or 2 bytes, as an encoder is fed.
Bytes wordsOf(const std::vector<std::int64_t>& values, unsigned bits, unsigned bytes) {
  Bytes b;
  for (std::int64_t v : values) {
    const auto w = static_cast<std::uint64_t>(v) & ((std::uint64_t{1} << bits) - 1);
    for (unsigned i = 0; i < bytes; ++i) b.push_back(static_cast<std::byte>(w >> 8 * i & 0xFF));
  }
  return b;
}

Bytes encodeJpegLossless(const std::vector<std::int64_t>& values, unsigned bits, unsigned samples) {
  const DJCodecParameter p(ECC_lossyYCbCr, EDC_never, EUC_never, EPC_default);
  std::unique_ptr<DJEncoder> e;
  if (bits <= 8) e = std::make_unique<DJCompressIJG8Bit>(p, EJM_lossless, 1, 0);
  if (bits > 8 && bits <= 12) e = std::make_unique<DJCompressIJG12Bit>(p, EJM_lossless, 1, 0);
  if (bits > 12) e = std::make_unique<DJCompressIJG16Bit>(p, EJM_lossless, 1, 0);
  Bytes in = wordsOf(values, bits, bits <= 8 ? 1 : 2);
  Uint8* out = nullptr;
  Uint32 length = 0;
  const EP_Interpretation colour = samples == 1 ? EPI_Monochrome2 : EPI_RGB;
  const OFCondition done = bits <= 8 ? e->encode(kColumns, kRows, colour, static_cast<Uint16>(samples),
                                                 reinterpret_cast<Uint8*>(in.data()), out, length)
                                     : e->encode(kColumns, kRows, colour, static_cast<Uint16>(samples),
                                                 reinterpret_cast<Uint16*>(in.data()), out, length);
  EXPECT_TRUE(done.good()) << done.text();
  Bytes coded(length);
  if (out) std::memcpy(coded.data(), out, length);
  delete[] out;
  return coded;
}

Bytes encodeJpegLs(const std::vector<std::int64_t>& values, unsigned bits, unsigned samples,
                   charls::interleave_mode mode = charls::interleave_mode::none) {
  const unsigned bytes = bits <= 8 ? 1 : 2;
  Bytes in = wordsOf(values, bits, bytes);
  if (samples > 1 && mode == charls::interleave_mode::none) {  // planes one after the other
    Bytes planes;
    for (unsigned s = 0; s < samples; ++s)
      for (std::size_t i = 0; i < kRows * kColumns; ++i)
        for (unsigned b = 0; b < bytes; ++b) planes.push_back(in[(i * samples + s) * bytes + b]);
    in = planes;
  }
  charls::jpegls_encoder e;
  e.frame_info({kColumns, kRows, static_cast<std::int32_t>(bits), static_cast<std::int32_t>(samples)});
  e.interleave_mode(mode);
  Bytes out(e.estimated_destination_size());
  e.destination(out.data(), out.size());
  out.resize(e.encode(in.data(), in.size()));
  return out;
}

// The encoder writes through a callback.
OPJ_SIZE_T appendBytes(void* from, OPJ_SIZE_T n, void* user) {
  auto& to = *static_cast<Bytes*>(user);
  for (OPJ_SIZE_T i = 0; i < n; ++i) to.push_back(static_cast<std::byte*>(from)[i]);
  return n;
}
// Only forward from the end, or back to a place already written (lengths are filled in later): not needed
// here.
OPJ_BOOL refuseSeek(OPJ_OFF_T, void*) { return OPJ_FALSE; }

Bytes encodeJpeg2000(const std::vector<std::int64_t>& values, unsigned bits, bool isSigned,
                     unsigned samples) {
  opj_cparameters_t p;
  opj_set_default_encoder_parameters(&p);
  p.numresolution = 2;
  p.tcp_numlayers = 1;
  p.cp_disto_alloc = 1;
  std::vector<opj_image_cmptparm_t> parts(samples);
  for (auto& c : parts) c = {1, 1, kColumns, kRows, 0, 0, bits, bits, isSigned ? 1u : 0u};
  opj_image_t* image =
      opj_image_create(samples, parts.data(), samples == 1 ? OPJ_CLRSPC_GRAY : OPJ_CLRSPC_SRGB);
  image->x1 = kColumns;
  image->y1 = kRows;
  for (std::size_t i = 0; i < values.size(); ++i)
    image->comps[i % samples].data[i / samples] = static_cast<OPJ_INT32>(values[i]);
  opj_codec_t* codec = opj_create_compress(OPJ_CODEC_J2K);
  opj_stream_t* stream = opj_stream_create(1 << 20, OPJ_FALSE);
  Bytes out;
  opj_stream_set_user_data(stream, &out, nullptr);
  opj_stream_set_write_function(stream, appendBytes);
  opj_stream_set_seek_function(stream, refuseSeek);
  EXPECT_TRUE(opj_setup_encoder(codec, &p, image) && opj_start_compress(codec, image, stream) &&
              opj_encode(codec, stream) && opj_end_compress(codec, stream));
  opj_stream_destroy(stream);
  opj_destroy_codec(codec);
  opj_image_destroy(image);
  return out;
}

FrameSpec specOf(const char* syntax, unsigned bits, bool isSigned, unsigned samples) {
  return makeSpec(syntax, kRows, kColumns, bits <= 8 ? 8 : 16, bits, isSigned, samples);
}

Result<std::vector<std::int64_t>> decoded(const std::vector<Bytes>& fragments, const FrameSpec& spec) {
  Bytes out(*spec.outputBytes(), std::byte{0xA5});
  const auto r = decode(DicomWriter().start().fragments(fragments).bytes(), spec, out);
  if (!r) {
    EXPECT_EQ(out, Bytes(out.size())) << "not zero after an error";
    return r.error();
  }
  return valuesOf(spec.sample, out);
}

void expectValues(const Bytes& frame, const FrameSpec& spec, const std::vector<std::int64_t>& wanted) {
  const auto v = decoded({frame}, spec);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ(*v, wanted);
}

TEST(DecodeCodec, EveryDepthAndSignWithoutLoss) {
  for (unsigned bits = 2; bits <= 16; ++bits)
    for (bool isSigned : {false, true}) {
      SCOPED_TRACE(std::to_string(bits) + (isSigned ? " signed" : ""));
      const auto v = someValues(bits, isSigned, 1, bits);
      expectValues(encodeJpegLs(v, bits, 1), specOf(kJpegLs, bits, isSigned, 1), v);
      expectValues(encodeJpeg2000(v, bits, isSigned, 1), specOf(kJpeg2000, bits, isSigned, 1), v);
      // The encoders of DCMTK take 8, 12 and 16 bits.
      if (bits == 8 || bits == 12 || bits == 16)
        expectValues(encodeJpegLossless(v, bits, 1), specOf(kJpegLossless, bits, isSigned, 1), v);
    }
}

TEST(DecodeCodec, SignedValuesInAnUnsignedCodestream) {
  const auto v = someValues(12, true, 1, 3);
  std::vector<std::int64_t> asUnsigned;
  for (auto x : v) asUnsigned.push_back(x < 0 ? x + 4096 : x);
  expectValues(encodeJpeg2000(asUnsigned, 12, false, 1), specOf(kJpeg2000, 12, true, 1), v);
}

TEST(DecodeCodec, WordsWithTheirValueOnTop) {
  // 16-bit words in the codestream, 12 bits stored at high bit 15, garbage below.
  const auto wanted = someValues(12, false, 1, 4);
  std::vector<std::int64_t> words;
  for (auto x : wanted) words.push_back(x * 16 + x % 16);
  FrameSpec spec = specOf(kJpegLs, 12, false, 1);
  spec.highBit = 15;
  expectValues(encodeJpegLs(words, 16, 1), spec, wanted);
  spec.transferSyntaxUid = kJpeg2000;
  expectValues(encodeJpeg2000(words, 16, false, 1), spec, wanted);
  spec.transferSyntaxUid = kJpegLossless;
  expectValues(encodeJpegLossless(words, 16, 1), spec, wanted);
}

TEST(DecodeCodec, EightBitsInWordsOf16) {
  const auto v = someValues(8, false, 1, 5);
  FrameSpec spec = makeSpec(kJpegLs, kRows, kColumns, 16, 8);
  expectValues(encodeJpegLs(v, 8, 1), spec, v);
  spec.transferSyntaxUid = kJpeg2000;
  expectValues(encodeJpeg2000(v, 8, false, 1), spec, v);
  spec.transferSyntaxUid = kJpegLossless;
  expectValues(encodeJpegLossless(v, 8, 1), spec, v);
}

TEST(DecodeCodec, ColourIsInterleaved) {
  const auto v = someValues(8, false, 3, 6);
  for (auto mode :
       {charls::interleave_mode::none, charls::interleave_mode::line, charls::interleave_mode::sample})
    expectValues(encodeJpegLs(v, 8, 3, mode), specOf(kJpegLs, 8, false, 3), v);
  expectValues(encodeJpeg2000(v, 8, false, 3), specOf(kJpeg2000, 8, false, 3), v);
  expectValues(encodeJpegLossless(v, 8, 3), specOf(kJpegLossless, 8, false, 3), v);
}

struct Coded {
  const char* syntax;
  Bytes frame;
};
std::vector<Coded> allCodecs(unsigned bits, unsigned samples) {
  const auto v = someValues(bits, false, samples, 7);
  return {{kJpegLossless, encodeJpegLossless(v, bits, samples)},
          {kJpegLs, encodeJpegLs(v, bits, samples)},
          {kJpeg2000, encodeJpeg2000(v, bits, false, samples)}};
}

TEST(DecodeCodec, HeaderMustAgreeWithTheAttributes) {
  for (const Coded& c : allCodecs(12, 1)) {
    SCOPED_TRACE(c.syntax);
    const auto codeWith = [&](auto change) {
      FrameSpec spec = specOf(c.syntax, 12, false, 1);
      change(spec);
      const auto r = decoded({c.frame}, spec);
      return r.ok() ? ErrorCode::OutOfTolerance : r.error().code;
    };
    EXPECT_EQ(codeWith([](FrameSpec&) {}), ErrorCode::OutOfTolerance);
    EXPECT_EQ(codeWith([](FrameSpec& s) { s.rows = 12; }), ErrorCode::CodecMismatch);
    EXPECT_EQ(codeWith([](FrameSpec& s) { s.rows = 14; }), ErrorCode::CodecMismatch);
    EXPECT_EQ(codeWith([](FrameSpec& s) { s.columns = 22; }), ErrorCode::CodecMismatch);
    EXPECT_EQ(codeWith([](FrameSpec& s) { std::swap(s.rows, s.columns); }), ErrorCode::CodecMismatch);
    EXPECT_EQ(codeWith([](FrameSpec& s) { s.samplesPerPixel = 3; }), ErrorCode::CodecMismatch);
    EXPECT_EQ(codeWith([](FrameSpec& s) {
                s.bitsAllocated = s.bitsStored = 8;
                s.highBit = 7;
                s.sample = SampleType::U8;
              }),
              ErrorCode::CodecMismatch);
  }
}

TEST(DecodeCodec, CutDataIsRefused) {
  for (const Coded& c : allCodecs(12, 1)) {
    SCOPED_TRACE(c.syntax);
    const FrameSpec spec = specOf(c.syntax, 12, false, 1);
    // Each of these is over at once: CharLS by itself takes seconds for each cut.
    for (std::size_t n = 0; n + 40 < c.frame.size(); ++n) {
      Bytes cut = c.frame;
      cut.resize(n);
      const auto r = decoded({cut}, spec);
      ASSERT_FALSE(r.ok()) << n << " of " << c.frame.size();
      EXPECT_TRUE(r.error().code == ErrorCode::CodecFailed || r.error().code == ErrorCode::CodecMismatch)
          << r.error().text();
    }
    EXPECT_FALSE(decoded({Bytes(500, std::byte{0xFF})}, spec).ok());
    EXPECT_FALSE(decoded({Bytes(500)}, spec).ok());
  }
}

TEST(DecodeCodec, FramesInManyFragmentsAreFoundByTheirMarkers) {
  for (const Coded& c : allCodecs(12, 1)) {
    SCOPED_TRACE(c.syntax);
    const auto first = c.frame.begin(), middle = first + static_cast<std::ptrdiff_t>(c.frame.size() / 2);
    const std::vector<Bytes> fragments{Bytes(first, middle), Bytes(middle, c.frame.end()), c.frame};
    FrameSpec spec = specOf(c.syntax, 12, false, 1);
    spec.framesDeclared = spec.frameCount = 2;
    auto wanted = someValues(12, false, 1, 7);
    wanted.insert(wanted.end(), wanted.begin(), wanted.begin() + kRows * kColumns);
    const auto r = decoded(fragments, spec);
    ASSERT_TRUE(r.ok()) << r.error().text();
    EXPECT_EQ(*r, wanted);
  }
}

// SIZ of a codestream (JPEG 2000) rewritten: rows, columns and tiles that need gigabytes.
TEST(DecodeCodec, FewBytesCannotAskForGigabytes) {
  Bytes frame = encodeJpeg2000(someValues(8, false, 1, 9), 8, false, 1);
  const auto set32 = [&](std::size_t at, std::uint32_t v) {
    for (std::size_t i = 0; i < 4; ++i) frame[at + i] = static_cast<std::byte>(v >> (24 - 8 * i) & 0xFF);
  };
  set32(8, 16384);   // width
  set32(12, 16384);  // height
  set32(24, 1);      // tiles of one pixel
  set32(28, 1);
  FrameSpec spec = makeSpec(kJpeg2000, 16384, 16384, 8, 8);
  EXPECT_EQ(decoded({frame}, spec).error().code, ErrorCode::LimitExceeded);
  // Below the size that is always granted, but more tiles than bytes.
  set32(8, 512);
  set32(12, 512);
  spec.rows = spec.columns = 512;
  EXPECT_EQ(decoded({frame}, spec).error().code, ErrorCode::CodecFailed);
}

TEST(DecodeCodec, JpegOfManyScansAndUnknownKindsIsRefused) {
  const Bytes frame = encodeJpegLossless(someValues(8, false, 1, 9), 8, 1);
  const FrameSpec spec = specOf(kJpegLossless, 8, false, 1);
  Bytes scans = frame;
  for (int i = 0; i < 101; ++i)
    for (int v : {0xFF, 0xDA}) scans.push_back(static_cast<std::byte>(v));
  EXPECT_EQ(decoded({scans}, spec).error().code, ErrorCode::LimitExceeded);
  for (std::size_t i = 0; i + 1 < frame.size(); ++i) {
    if (frame[i] != std::byte{0xFF} || frame[i + 1] != std::byte{0xC3}) continue;
    for (int kind : {0xC5, 0xC7, 0xC9, 0xCB, 0xCF}) {
      Bytes other = frame;
      other[i + 1] = static_cast<std::byte>(kind);
      EXPECT_EQ(decoded({other}, spec).error().code, ErrorCode::CodecFailed);
    }
    break;
  }
}

Bytes deflated(const Bytes& plain) {
  z_stream z{};
  EXPECT_EQ(deflateInit2(&z, 9, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY), Z_OK);
  Bytes out(deflateBound(&z, plain.size()));
  z.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(plain.data()));
  z.avail_in = static_cast<uInt>(plain.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

TEST(DecodeDeflated, DataSetAndItsLimits) {
  const auto v = someValues(16, true, 1, 8);
  const FrameSpec spec = specOf(kDeflated, 16, true, 1);
  const Bytes body = deflated(DicomWriter(true, false, false).start().pixels(wordsOf(v, 16, 2)).bytes());
  Bytes file = DicomWriter().raw(body).bytes(), out(*spec.outputBytes());
  ASSERT_TRUE(decode(file, spec, out).ok());
  EXPECT_EQ(valuesOf(spec.sample, out), v);
  file.resize(file.size() - body.size() / 2);
  EXPECT_EQ(decode(file, spec, out).error().code, ErrorCode::FileDamaged);
  for (std::size_t i = file.size() - 40; i < file.size(); ++i) file[i] = std::byte{0xFF};
  EXPECT_EQ(decode(file, spec, out).error().code, ErrorCode::FileDamaged);
  // A bomb: 64 MB of zeros in some 60 KB.
  FrameSpec large = makeSpec(kDeflated, 8192, 4096, 16, 16);
  const Bytes bomb =
      DicomWriter()
          .raw(deflated(DicomWriter(true, false, false).start().pixels(Bytes(64 << 20)).bytes()))
          .bytes();
  Bytes largeOut(*large.outputBytes());
  EXPECT_EQ(decode(bomb, large, largeOut).error().code, ErrorCode::LimitExceeded);
}

}  // namespace
}  // namespace vernier::test
