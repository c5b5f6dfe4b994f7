// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged files: seeded flips, cuts, zeroed and repeated stretches of small real files of every coding.
// Whatever happens, decode() returns: values, or zeros with one sentence. Run under the sanitizers this is
// the decoder's fuzzer.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcistrmb.h>
#include <dcmtk/dcmdata/dctk.h>
#include <gtest/gtest.h>

#include <random>

#include "DecodeSupport.h"
#include "FrameSpecFrom.h"
#include "TestData.h"

namespace vernier::test {
namespace {

constexpr int kMutationsPerFile = 150;

// Header from memory, up to the pixels.
Result<FrameSpec> specOf(const Bytes& bytes) {
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  DcmInputBufferStream stream;
  stream.setBuffer(bytes.data(), static_cast<offile_off_t>(bytes.size()));
  stream.setEos();
  DcmFileFormat file;
  file.transferInit();
  const OFCondition read =
      file.readUntilTag(stream, EXS_Unknown, EGL_noChange, DCM_MaxReadLength, DCM_PixelData);
  file.transferEnd();
  if (read.bad()) return makeError(ErrorCode::NotDicom, read.text());
  return frameSpecFrom(*file.getDataset(), DcmXfer(file.getDataset()->getOriginalXfer()).getXferID());
}

Bytes mutated(Bytes b, std::mt19937& random) {
  const auto at = [&] { return static_cast<std::ptrdiff_t>(random() % b.size()); };
  switch (random() % 5) {
    case 0:
      b.resize(random() % b.size());
      break;
    case 1: {  // a stretch of one value
      const auto from = at();
      const auto n =
          std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(random() % 64), std::ssize(b) - from);
      std::fill_n(b.begin() + from, n, random() % 2 ? std::byte{0xFF} : std::byte{0});
      break;
    }
    case 2: {  // a stretch copied elsewhere
      const auto from = at(), to = at();
      const auto n = std::min({std::ssize(b) - from, std::ssize(b) - to, std::ptrdiff_t{40}});
      std::copy_n(Bytes(b).begin() + from, n, b.begin() + to);
      break;
    }
    default:  // single bytes, most of them in the last two thirds, where the pixels are
      for (unsigned i = 0; i <= random() % 8; ++i) {
        auto p = static_cast<std::size_t>(at());
        if (random() % 2) p = b.size() / 3 + p * 2 / 3;
        b[p] = static_cast<std::byte>(random());
      }
  }
  return b;
}

// Decodes frame 1 (and the last) and looks at what came out.
void mustReturn(const Bytes& file, FrameSpec spec, std::size_t& good) {
  for (std::uint64_t frame : {std::uint64_t{0}, spec.framesDeclared - 1}) {
    spec.firstFrame = frame;
    spec.frameCount = 1;
    const auto bytes = spec.outputBytes();
    if (!bytes || *bytes > (std::uint64_t{8} << 20)) return;
    Bytes out(*bytes, std::byte{0xA5});
    const auto r = decode(file, spec, out);
    if (r) {
      ++good;
      continue;
    }
    EXPECT_FALSE(r.error().sentence.empty());
    EXPECT_NE(r.error().code, ErrorCode::Internal) << r.error().text();
    EXPECT_EQ(out, Bytes(out.size())) << "not zero after an error";
  }
}

TEST(DecodeMutation, SmallFilesOfEveryCoding) {
  VERNIER_NEEDS_DATA("codec_small_singles");
  const char* const files[] = {"MR_small.dcm",
                               "MR_small_implicit.dcm",
                               "MR_small_bigendian.dcm",
                               "MR_small_RLE.dcm",
                               "MR_small_jp2klossless.dcm",
                               "MR_small_jpeg_ls_lossless.dcm",
                               "JPEG-lossy.dcm",
                               "JPEGLSNearLossless_16.dcm",
                               "JPEG2000.dcm",
                               "SC_rgb_jpeg_gdcm.dcm",
                               "SC_rgb_small_odd_jpeg.dcm",
                               "SC_rgb_jls_lossy_sample.dcm",
                               "SC_rgb_rle_2frame.dcm",
                               "image_dfl.dcm",
                               "rtdose_expb.dcm"};
  std::size_t good = 0, all = 0;
  for (const char* name : files) {
    SCOPED_TRACE(name);
    const Bytes original = bytesOfFile(dataDir() / "codec_small_singles" / name);
    const auto spec = specOf(original);
    ASSERT_TRUE(spec.ok()) << spec.error().text();
    std::mt19937 random(static_cast<unsigned>(original.size()));
    for (int i = 0; i < kMutationsPerFile; ++i) {
      SCOPED_TRACE(i);
      const Bytes file = mutated(original, random);
      mustReturn(file, *spec, good);
      ++all;
      // The description may be damaged too.
      if (const auto own = specOf(file); own.ok()) mustReturn(file, *own, good);
    }
  }
  std::cout << "[  NOTE    ] " << all << " damaged files, " << good << " frames decoded all the same\n";
}

}  // namespace
}  // namespace vernier::test
