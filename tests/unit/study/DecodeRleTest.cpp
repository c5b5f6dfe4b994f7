// SPDX-License-Identifier: GPL-3.0-or-later
// RLE Lossless: planes packed by hand, an own packer for larger ones, and every way in which the header can
// lie.
#include <gtest/gtest.h>

#include <random>

#include "DecodeSupport.h"

namespace vernier::test {
namespace {

Bytes rleHeader(std::uint32_t count, const std::vector<std::uint32_t>& offsets) {
  Bytes b(64);
  std::memcpy(b.data(), &count, 4);
  if (!offsets.empty()) std::memcpy(b.data() + 4, offsets.data(), offsets.size() * 4);
  return b;
}

Bytes rleFrame(const std::vector<Bytes>& segments) {
  std::vector<std::uint32_t> offsets;
  std::uint32_t at = 64;
  for (const Bytes& s : segments) {
    offsets.push_back(at);
    at += static_cast<std::uint32_t>(s.size());
  }
  Bytes b = rleHeader(static_cast<std::uint32_t>(segments.size()), offsets);
  for (const Bytes& s : segments)
    for (std::byte v : s) b.push_back(v);
  return b;
}

// Literal runs of 1 to 128 bytes, replicated runs of 2 to 128, and a no-operation now and then.
Bytes pack(const Bytes& plane, std::mt19937& random) {
  Bytes out;
  std::size_t i = 0;
  while (i < plane.size()) {
    std::size_t run = 1;
    while (i + run < plane.size() && plane[i + run] == plane[i] && run < 128) ++run;
    if (random() % 5 == 0) out.push_back(std::byte{128});
    if (run >= 2) {
      out.push_back(static_cast<std::byte>(257 - run));
      out.push_back(plane[i]);
    } else {
      run = std::min<std::size_t>(1 + random() % 128, plane.size() - i);
      out.push_back(static_cast<std::byte>(run - 1));
      out.insert(out.end(), plane.begin() + static_cast<std::ptrdiff_t>(i),
                 plane.begin() + static_cast<std::ptrdiff_t>(i + run));
    }
    i += run;
  }
  if (out.size() % 2 != 0) out.push_back(std::byte{0});
  return out;
}

Bytes fileOf(const std::vector<Bytes>& frames) { return DicomWriter().start().fragments(frames).bytes(); }

Result<std::vector<std::int64_t>> decoded(const Bytes& file, const FrameSpec& spec) {
  Bytes out(*spec.outputBytes(), std::byte{0xA5});
  const auto r = decode(file, spec, out);
  if (!r) {
    EXPECT_EQ(out, Bytes(out.size())) << "not zero after an error";
    return r.error();
  }
  return valuesOf(spec.sample, out);
}
ErrorCode codeOf(const Bytes& frame, const FrameSpec& spec) {
  const auto r = decoded(fileOf({frame}), spec);
  return r.ok() ? ErrorCode::OutOfTolerance : r.error().code;
}

TEST(DecodeRle, PackedByHand) {
  // 2 x 3 pixels of 16 bits. High plane: 1 1 1 1 2 3 = run of 4, literals 2; low plane: 9 no-op literals.
  const Bytes high = bytesFrom({253, 1, 1, 2, 3, 0}), low = bytesFrom({128, 5, 10, 20, 30, 40, 50, 60});
  const auto v = decoded(fileOf({rleFrame({high, low})}), makeSpec(kRle, 2, 3, 16, 16));
  ASSERT_TRUE(v.ok()) << v.error().text();
  const std::vector<std::int64_t> wanted{266, 276, 286, 296, 562, 828};
  EXPECT_EQ(*v, wanted);
}

TEST(DecodeRle, EveryContainerAndSampleCount) {
  std::mt19937 random(11);
  for (unsigned allocated : {8u, 16u, 32u})
    for (std::uint64_t samples : {1u, 3u})
      for (bool isSigned : {false, true}) {
        FrameSpec spec = makeSpec(kRle, 17, 23, allocated, allocated - 3, isSigned, samples);
        spec.framesDeclared = spec.frameCount = 2;
        std::vector<Bytes> frames;
        std::vector<std::int64_t> wanted;
        for (int f = 0; f < 2; ++f) {
          // Few distinct bytes, so that runs happen. planes[s * bytes + b], most significant byte first.
          std::vector<Bytes> planes(samples * allocated / 8, Bytes(17 * 23));
          for (Bytes& p : planes)
            for (std::byte& b : p) b = static_cast<std::byte>(random() % 3 * 127);
          for (std::size_t i = 0; i < 17 * 23; ++i)
            for (std::size_t s = 0; s < samples; ++s) {
              std::uint64_t word = 0;
              for (std::size_t b = 0; b < allocated / 8; ++b)
                word = word << 8 | std::to_integer<std::uint64_t>(planes[s * allocated / 8 + b][i]);
              const std::int64_t size = std::int64_t{1} << (allocated - 3);
              std::int64_t v = static_cast<std::int64_t>(word) % size;
              if (isSigned && v >= size / 2) v -= size;
              wanted.push_back(v);
            }
          std::vector<Bytes> segments;
          for (const Bytes& p : planes) segments.push_back(pack(p, random));
          frames.push_back(rleFrame(segments));
        }
        const auto v = decoded(fileOf(frames), spec);
        ASSERT_TRUE(v.ok()) << v.error().text();
        EXPECT_EQ(*v, wanted) << allocated << " bits, " << samples << " samples";
      }
}

TEST(DecodeRle, SingleBits) {
  // 3 x 3 bits in two bytes: 1 0 0 0 1 0 0 0 | 1.
  const auto v = decoded(fileOf({rleFrame({bytesFrom({1, 0x11, 0x01})})}), makeSpec(kRle, 3, 3, 1, 1));
  ASSERT_TRUE(v.ok()) << v.error().text();
  const std::vector<std::int64_t> wanted{1, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_EQ(*v, wanted);
}

TEST(DecodeRle, LiesOfTheHeader) {
  const FrameSpec spec = makeSpec(kRle, 1, 4, 8, 8);
  const Bytes good = bytesFrom({3, 1, 2, 3, 4, 0});
  const auto with = [&](std::uint32_t count, const std::vector<std::uint32_t>& offsets) {
    Bytes b = rleHeader(count, offsets);
    for (std::byte v : good) b.push_back(v);
    return b;
  };
  EXPECT_EQ(codeOf(with(1, {64}), spec), ErrorCode::OutOfTolerance);  // decodes
  EXPECT_EQ(codeOf(with(0, {64}), spec), ErrorCode::CodecMismatch);
  EXPECT_EQ(codeOf(with(2, {64, 66}), spec), ErrorCode::CodecMismatch);
  EXPECT_EQ(codeOf(with(16, {64}), spec), ErrorCode::CodecFailed);
  EXPECT_EQ(codeOf(with(0xFFFFFFFF, {64}), spec), ErrorCode::CodecFailed);
  EXPECT_EQ(codeOf(with(1, {0}), spec), ErrorCode::CodecFailed);
  EXPECT_EQ(codeOf(with(1, {63}), spec), ErrorCode::CodecFailed);
  EXPECT_EQ(codeOf(with(1, {71}), spec), ErrorCode::CodecFailed);
  EXPECT_EQ(codeOf(with(1, {0xFFFFFFFF}), spec), ErrorCode::CodecFailed);
  EXPECT_EQ(codeOf(Bytes(63), spec), ErrorCode::CodecFailed);
  EXPECT_EQ(codeOf({}, spec), ErrorCode::CodecFailed);
  // Descending offsets of two planes.
  EXPECT_EQ(codeOf(with(2, {66, 64}), makeSpec(kRle, 1, 2, 16, 16)), ErrorCode::CodecFailed);
}

TEST(DecodeRle, DamagedRuns) {
  const FrameSpec spec = makeSpec(kRle, 1, 4, 8, 8);
  EXPECT_EQ(codeOf(rleFrame({bytesFrom({2, 1, 2, 3})}), spec), ErrorCode::CodecFailed);  // three of four
  EXPECT_EQ(codeOf(rleFrame({bytesFrom({3, 1, 2, 3})}), spec),
            ErrorCode::CodecFailed);                                              // literal run cut short
  EXPECT_EQ(codeOf(rleFrame({bytesFrom({253})}), spec), ErrorCode::CodecFailed);  // no byte to repeat
  EXPECT_EQ(codeOf(rleFrame({bytesFrom({128, 128})}), spec), ErrorCode::CodecFailed);  // nothing but no-ops
  EXPECT_EQ(codeOf(rleFrame({bytesFrom({129, 7})}), spec),
            ErrorCode::OutOfTolerance);  // too many: the rest is cut
}

TEST(DecodeFragments, FramesFromFragments) {
  const Bytes a = rleFrame({bytesFrom({1, 1, 2})}), b = rleFrame({bytesFrom({1, 3, 4})});
  const auto cut = [](const Bytes& x, std::size_t from, std::size_t to) {
    return Bytes(x.begin() + static_cast<std::ptrdiff_t>(from), x.begin() + static_cast<std::ptrdiff_t>(to));
  };
  const std::vector<std::int64_t> one{1, 2}, both{1, 2, 3, 4};
  FrameSpec spec = makeSpec(kRle, 1, 2, 8, 8);
  // One frame in three fragments.
  const auto split = decoded(fileOf({cut(a, 0, 10), cut(a, 10, 60), cut(a, 60, a.size())}), spec);
  ASSERT_TRUE(split.ok()) << split.error().text();
  EXPECT_EQ(*split, one);
  // Two frames in three fragments: RLE has no marker, only the offset table can say which.
  spec.framesDeclared = spec.frameCount = 2;
  EXPECT_FALSE(decoded(fileOf({cut(a, 0, 10), cut(a, 10, a.size()), b}), spec).ok());
  const auto second = static_cast<std::uint32_t>(8 + 10 + 8 + a.size() - 10);
  const auto withTable = [&](std::uint32_t first, std::uint32_t next) {
    Bytes table(8);
    std::memcpy(table.data(), &first, 4);
    std::memcpy(table.data() + 4, &next, 4);
    return DicomWriter()
        .start()
        .header(0x7FE0, 0x0010, "OB", 0xFFFFFFFF)
        .item(table)
        .item(cut(a, 0, 10))
        .item(cut(a, 10, a.size()))
        .item(b)
        .sequenceEnd()
        .bytes();
  };
  const auto table = decoded(withTable(0, second), spec);
  ASSERT_TRUE(table.ok()) << table.error().text();
  EXPECT_EQ(*table, both);
  for (const auto& [first, next] : {std::pair<std::uint32_t, std::uint32_t>{0, 0},
                                    {8, second},
                                    {0, second + 1},
                                    {second, 0},
                                    {0, 0xFFFFFFFF},
                                    {0, second + 8 + 66}})
    EXPECT_FALSE(decoded(withTable(first, next), spec).ok()) << first << " " << next;
  // A table that lies does no harm where each frame has one fragment; an empty fragment counts for nothing.
  const auto lies = decoded(DicomWriter()
                                .start()
                                .header(0x7FE0, 0x0010, "OB", 0xFFFFFFFF)
                                .item(Bytes(8, std::byte{0x77}))
                                .item(a)
                                .item({})
                                .item(b)
                                .sequenceEnd()
                                .bytes(),
                            spec);
  ASSERT_TRUE(lies.ok()) << lies.error().text();
  EXPECT_EQ(*lies, both);
}

TEST(DecodeFragments, TheEndMayLackItsDelimiterButNoByte) {
  const FrameSpec spec = makeSpec(kRle, 1, 2, 8, 8);
  Bytes file = fileOf({rleFrame({bytesFrom({1, 1, 2})})});
  file.resize(file.size() - 8);  // without the sequence delimiter
  EXPECT_TRUE(decoded(file, spec).ok());
  file.pop_back();
  const auto r = decoded(file, spec);
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::FileDamaged);
}

TEST(DecodeFragments, EncapsulationAndSyntaxMustAgree) {
  const Bytes frame = rleFrame({bytesFrom({1, 1, 2})});
  const auto native = decoded(fileOf({frame}), makeSpec(kExplicit, 1, 2, 8, 8));
  ASSERT_FALSE(native.ok());
  EXPECT_EQ(native.error().code, ErrorCode::CodecUnsupported);
  const auto unknown = decoded(fileOf({frame}), makeSpec("1.2.840.10008.1.2.4.999", 1, 2, 8, 8));
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::CodecUnsupported);
}

}  // namespace
}  // namespace vernier::test
