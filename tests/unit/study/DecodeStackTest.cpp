// SPDX-License-Identifier: GPL-3.0-or-later
// decodeSlice and decodeStack over files written here.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "DecodeSupport.h"
#include "TestData.h"
#include "vernier/base/Threads.h"
#include "vernier/study/Load.h"

namespace vernier::test {
namespace {

// One study in a folder of its own; each add() is a file with one object.
struct StackMaker {
  TempDir dir;
  StudySet set;
  Stack stack;

  std::size_t add(const Bytes& file, const FrameSpec& spec) {
    FileRecord f;
    f.shown = "slice" + std::to_string(set.files.size()) + ".dcm";
    f.path = (dir.path() / f.shown).string();
    std::ofstream(f.path, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
    set.files.push_back(f);
    Instance i;
    i.file = set.files.size() - 1;
    i.isImage = true;
    i.pixels = spec;
    set.instances.push_back(i);
    for (std::uint64_t n = 0; n < spec.framesDeclared; ++n)
      stack.slices.push_back({set.instances.size() - 1, n});
    return set.instances.size() - 1;
  }
};

Bytes words(std::initializer_list<int> values) {
  Bytes b;
  for (int v : values) {
    b.push_back(static_cast<std::byte>(v & 0xFF));
    b.push_back(static_cast<std::byte>(v >> 8 & 0xFF));
  }
  return b;
}
Bytes nativeFile(const Bytes& pixels) { return DicomWriter().start().pixels(pixels).bytes(); }

// 40 slices of all kinds of coding; slice s holds s * 100 + pixel number.
void fillMixed(StackMaker& m, std::vector<std::int64_t>& wanted) {
  for (int s = 0; s < 40; ++s) {
    const int v = s * 100;
    for (int p = 0; p < 4; ++p) wanted.push_back(v + p);
    const Bytes pixels = words({v, v + 1, v + 2, v + 3});
    if (s % 4 == 0) m.add(nativeFile(pixels), makeSpec(kExplicit, 2, 2, 16, 16));
    if (s % 4 == 1)
      m.add(DicomWriter(false).start().pixels(pixels).bytes(), makeSpec(kImplicit, 2, 2, 16, 13, true));
    if (s % 4 == 2) {
      Bytes rle(64);
      const std::uint32_t head[3] = {2, 64, 69};
      std::memcpy(rle.data(), head, sizeof head);
      rle.push_back(std::byte{3});
      for (std::size_t i = 0; i < 4; ++i) rle.push_back(pixels[i * 2 + 1]);
      rle.push_back(std::byte{3});
      for (std::size_t i = 0; i < 4; ++i) rle.push_back(pixels[i * 2]);
      m.add(DicomWriter().start().fragments({rle}).bytes(), makeSpec(kRle, 2, 2, 16, 16));
    }
    if (s % 4 == 3) {
      Bytes swapped = pixels;
      for (std::size_t i = 0; i + 1 < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
      m.add(DicomWriter(true, true).start().pixels(swapped).bytes(), makeSpec(kBig, 2, 2, 16, 16));
    }
  }
}

TEST(DecodeStack, MixedCodingsGiveOneVolumeForAnyNumberOfThreads) {
  StackMaker m;
  std::vector<std::int64_t> wanted;
  fillMixed(m, wanted);
  for (int n : {1, 2, 3, 0}) {
    setThreads(n);
    for (SampleType type : {SampleType::U16, SampleType::I16, SampleType::I32, SampleType::F32}) {
      Bytes out(40 * 4 * bytesOf(type), std::byte{0xA5});
      std::vector<SliceFailure> failed;
      std::uint64_t calls = 0, last = 0;
      const auto r = decodeStack(m.set, m.stack, type, out, failed,
                                 [&](std::string_view, std::uint64_t done, std::uint64_t total) {
                                   ++calls;
                                   EXPECT_EQ(total, 40u);
                                   EXPECT_EQ(done, last + 1);
                                   last = done;
                                 });
      ASSERT_TRUE(r.ok()) << r.error().text();
      EXPECT_TRUE(failed.empty());
      EXPECT_EQ(calls, 40u);
      if (type != SampleType::F32) {
        EXPECT_EQ(valuesOf(type, out), wanted);
        continue;
      }
      std::vector<float> floats(160);
      std::memcpy(floats.data(), out.data(), out.size());
      EXPECT_EQ(std::vector<std::int64_t>(floats.begin(), floats.end()), wanted);
    }
  }
}

TEST(DecodeStack, SlicesThatFailAreNamedAndLeftZero) {
  StackMaker m;
  const FrameSpec spec = makeSpec(kExplicit, 2, 2, 16, 16);
  m.add(nativeFile(words({1, 2, 3, 4})), spec);
  m.add(nativeFile(words({1, 2, 3})), spec);         // 1: short
  m.add(nativeFile(words({1, 2, 3, 4})), spec);      // 2: the file goes away
  m.add(nativeFile(words({1, 40000, 3, 4})), spec);  // 3: does not fit int16
  FrameSpec other = spec;
  other.rows = 1;
  other.columns = 4;
  m.add(nativeFile(words({1, 2, 3, 4})), other);  // 4: as many bytes, other shape
  m.add(nativeFile(words({1, 2, 3, 4})), spec);   // 5: known before as bad
  m.set.instances[5].pixelError = makeError(ErrorCode::PixelDescriptionInvalid, "Rows is missing.");
  m.add(nativeFile(words({5, 6, 7, 8})), spec);
  std::filesystem::remove(m.set.files[2].path);
  Bytes out(7 * 8, std::byte{0xA5});
  std::vector<SliceFailure> failed;
  const auto r = decodeStack(m.set, m.stack, SampleType::I16, out, failed);
  ASSERT_TRUE(r.ok()) << r.error().text();
  const std::vector<std::int64_t> wanted{1, 2, 3, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
                                         0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 6, 7, 8};
  EXPECT_EQ(valuesOf(SampleType::I16, out), wanted);
  ASSERT_EQ(failed.size(), 5u);
  const ErrorCode codes[] = {ErrorCode::PixelDataShort, ErrorCode::FileNotFound, ErrorCode::CodecMismatch,
                             ErrorCode::CodecMismatch, ErrorCode::PixelDescriptionInvalid};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(failed[i].slice, i + 1);
    EXPECT_EQ(failed[i].error.code, codes[i]) << failed[i].error.text();
    EXPECT_EQ(failed[i].error.where, m.set.files[i + 1].shown);
    EXPECT_EQ(failed[i].error.text().find(m.dir.path().string()), std::string::npos) << "names the folder";
  }
  // All fail: so does the call.
  m.stack.slices = {{1, 0}, {2, 0}};
  Bytes none(2 * 8);
  EXPECT_EQ(decodeStack(m.set, m.stack, SampleType::U16, none, failed).error().code,
            ErrorCode::PixelDataShort);
  EXPECT_EQ(failed.size(), 2u);
}

TEST(DecodeStack, FramesOfOneObject) {
  StackMaker m;
  FrameSpec spec = makeSpec(kExplicit, 1, 2, 16, 16);
  spec.framesDeclared = 50;
  Bytes pixels;
  std::vector<std::int64_t> wanted;
  for (int v = 0; v < 100; ++v) {
    const Bytes w = words({v * 3});
    pixels.push_back(w[0]);
    pixels.push_back(w[1]);
    wanted.push_back(v * 3);
  }
  m.add(nativeFile(pixels), spec);
  Bytes out(200);
  std::vector<SliceFailure> failed;
  ASSERT_TRUE(decodeStack(m.set, m.stack, SampleType::U16, out, failed).ok());
  EXPECT_EQ(valuesOf(SampleType::U16, out), wanted);
  Bytes one(4);
  ASSERT_TRUE(decodeSlice(m.set, {0, 49}, one).ok());
  EXPECT_EQ(valuesOf(SampleType::U16, one), (std::vector<std::int64_t>{294, 297}));
  EXPECT_EQ(decodeSlice(m.set, {0, 50}, one).error().code, ErrorCode::PixelDataMissing);
  EXPECT_EQ(decodeSlice(m.set, {1, 0}, one).error().code, ErrorCode::Internal);
}

TEST(DecodeStack, CanBeCancelled) {
  StackMaker m;
  std::vector<std::int64_t> wanted;
  fillMixed(m, wanted);
  Bytes out(40 * 8);
  std::vector<SliceFailure> failed;
  std::stop_source stop;
  std::uint64_t seen = 0;
  const auto r = decodeStack(
      m.set, m.stack, SampleType::U16, out, failed,
      [&](std::string_view, std::uint64_t done, std::uint64_t) {
        seen = done;
        stop.request_stop();
      },
      stop.get_token());
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::Cancelled);
  EXPECT_LE(seen, 4u);  // one per thread at most
}

TEST(DecodeStack, DevicesPipesAndFoldersAreNoFiles) {
  StackMaker m;
  const FrameSpec spec = makeSpec(kExplicit, 2, 2, 16, 16);
  m.add(nativeFile(words({1, 2, 3, 4})), spec);
  Bytes out(8);
  const std::string pipe = (m.dir.path() / "pipe").string();
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {std::string("/dev/zero"), m.dir.path().string(), pipe}) {
    m.set.files[0].path = path;
    EXPECT_EQ(decodeSlice(m.set, {0, 0}, out).error().code, ErrorCode::NotAFile) << path;
  }
}

}  // namespace
}  // namespace vernier::test
