// SPDX-License-Identifier: GPL-3.0-or-later
// Native pixels and RLE, against pixels that are worked out by hand or by an independent formula here.
#include <gtest/gtest.h>

#include <random>

#include "DecodeSupport.h"

namespace vernier::test {
namespace {

// Decodes into a buffer of canaries, so that a byte that nobody wrote shows.
struct Outcome {
  Result<void> result;
  Bytes out;
};
Outcome run(const Bytes& file, const FrameSpec& spec) {
  Bytes out(*spec.outputBytes(), std::byte{0xA5});
  Result<void> r = decode(file, spec, out);
  return {std::move(r), std::move(out)};
}
std::vector<std::int64_t> decoded(const Bytes& file, const FrameSpec& spec) {
  const Outcome o = run(file, spec);
  EXPECT_TRUE(o.result.ok()) << (o.result.ok() ? "" : o.result.error().text());
  return valuesOf(spec.sample, o.out);
}
ErrorCode codeOf(const Bytes& file, const FrameSpec& spec) {
  const Outcome o = run(file, spec);
  if (o.result.ok()) {
    ADD_FAILURE() << "decoded what must be refused";
    return ErrorCode::Internal;
  }
  EXPECT_EQ(o.out, Bytes(o.out.size())) << "not zero after an error";
  EXPECT_FALSE(o.result.error().sentence.empty());
  return o.result.error().code;
}

// The definition of PS3.5 8.1.1, one value at a time.
std::int64_t storedValue(std::uint64_t word, unsigned stored, unsigned highBit, bool isSigned) {
  std::uint64_t v = word >> (highBit + 1 - stored);
  v %= std::uint64_t{1} << stored;
  if (isSigned && v >= std::uint64_t{1} << (stored - 1))
    return static_cast<std::int64_t>(v) - static_cast<std::int64_t>(std::uint64_t{1} << stored);
  return static_cast<std::int64_t>(v);
}

Bytes packed(const std::vector<std::uint64_t>& words, unsigned bytes, bool big) {
  Bytes b;
  for (std::uint64_t w : words)
    for (unsigned i = 0; i < bytes; ++i)
      b.push_back(static_cast<std::byte>(w >> 8 * (big ? bytes - 1 - i : i) & 0xFF));
  return b;
}

TEST(DecodeNative, EveryContainerSignBitsAndHighBit) {
  std::mt19937_64 random(7);
  for (unsigned allocated : {8u, 16u, 32u})
    for (unsigned stored = 1; stored <= allocated; ++stored)
      for (unsigned highBit : {stored - 1, allocated - 1})
        for (bool isSigned : {false, true})
          for (bool big : {false, true}) {
            std::vector<std::uint64_t> words(6 * 4);
            for (auto& w : words) w = random() % (std::uint64_t{1} << allocated);  // garbage above and below
            FrameSpec spec = makeSpec(big ? kBig : kExplicit, 6, 4, allocated, stored, isSigned);
            spec.highBit = highBit;
            std::vector<std::int64_t> wanted;
            for (auto w : words) wanted.push_back(storedValue(w, stored, highBit, isSigned));
            const Bytes pixels = packed(words, allocated / 8, big);
            // Bytes of a big endian OW come in pairs; OB does not.
            const Bytes file =
                DicomWriter(true, big).start().pixels(pixels, allocated == 8 ? "OB" : "OW").bytes();
            ASSERT_EQ(decoded(file, spec), wanted) << allocated << "/" << stored << "/" << highBit
                                                   << (isSigned ? " signed" : "") << (big ? " big" : "");
          }
}

TEST(DecodeNative, FullRangeOf16Bits) {
  std::vector<std::uint64_t> words(65536);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = i;
  for (bool isSigned : {false, true}) {
    const Bytes file = DicomWriter(false).start().pixels(packed(words, 2, false)).bytes();
    const auto v = decoded(file, makeSpec(kImplicit, 256, 256, 16, 16, isSigned));
    EXPECT_EQ(v[32767], 32767);
    EXPECT_EQ(v[32768], isSigned ? -32768 : 32768);
    EXPECT_EQ(v[65535], isSigned ? -1 : 65535);
  }
}

TEST(DecodeNative, GarbageInHighBitsIsMaskedAndSignExtended) {
  const Bytes file = DicomWriter().start().pixels(packed({0xF800, 0x07FF, 0xAFFF, 0x5800}, 2, false)).bytes();
  const std::vector<std::int64_t> asSigned{-2048, 2047, -1, -2048}, asUnsigned{2048, 2047, 4095, 2048};
  EXPECT_EQ(decoded(file, makeSpec(kExplicit, 2, 2, 16, 12, true)), asSigned);
  EXPECT_EQ(decoded(file, makeSpec(kExplicit, 2, 2, 16, 12, false)), asUnsigned);
}

TEST(DecodeNative, FramesOfAMultiFrameObject) {
  std::vector<std::uint64_t> words(5 * 6);
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = i * 37;
  const Bytes file = DicomWriter().start().pixels(packed(words, 2, false)).bytes();
  FrameSpec spec = makeSpec(kExplicit, 2, 3, 16, 16);
  spec.framesDeclared = 5;
  spec.firstFrame = 2;
  spec.frameCount = 2;
  const std::vector<std::int64_t> wanted(words.begin() + 12, words.begin() + 24);
  EXPECT_EQ(decoded(file, spec), wanted);
  spec.firstFrame = 4;  // one of the two is not there
  EXPECT_EQ(codeOf(file, spec), ErrorCode::PixelDataMissing);
}

TEST(DecodeNative, ColourPlanesAreInterleaved) {
  FrameSpec spec = makeSpec(kExplicit, 1, 3, 8, 8, false, 3);
  const Bytes pixels = bytesFrom({1, 2, 3, 11, 12, 13, 21, 22, 23, 0});
  const Bytes file = DicomWriter().start().pixels(pixels, "OB").bytes();
  const std::vector<std::int64_t> asStored{1, 2, 3, 11, 12, 13, 21, 22, 23},
      byPixel{1, 11, 21, 2, 12, 22, 3, 13, 23};
  EXPECT_EQ(decoded(file, spec), asStored);
  spec.planar = true;
  EXPECT_EQ(decoded(file, spec), byPixel);
}

TEST(DecodeNative, ChromaOf422IsSpread) {
  FrameSpec spec = makeSpec(kExplicit, 1, 4, 8, 8, false, 3);
  spec.photometric = "YBR_FULL_422";
  const Bytes file = DicomWriter().start().pixels(bytesFrom({10, 20, 1, 2, 30, 40, 3, 4}), "OB").bytes();
  const std::vector<std::int64_t> wanted{10, 1, 2, 20, 1, 2, 30, 3, 4, 40, 3, 4};
  EXPECT_EQ(decoded(file, spec), wanted);
}

TEST(DecodeNative, SingleBitsRunOnFromFrameToFrame) {
  // 3 x 3 bits per frame: frame 1 begins at bit 9. Bits: 1 at positions 0, 8, 9, 13, 17.
  const Bytes bits = bytesFrom({0x01, 0x23, 0x02, 0x00});
  FrameSpec spec = makeSpec(kExplicit, 3, 3, 1, 1);
  spec.framesDeclared = 2;
  spec.frameCount = 2;
  const std::vector<std::int64_t> wanted{1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_EQ(decoded(DicomWriter().start().pixels(bits, "OB").bytes(), spec), wanted);
  // Big endian words swap the bytes of each pair; OB does not.
  spec.transferSyntaxUid = kBig;
  EXPECT_EQ(decoded(DicomWriter(true, true).start().pixels(bits, "OB").bytes(), spec), wanted);
  const Bytes swapped = bytesFrom({0x23, 0x01, 0x00, 0x02});
  EXPECT_EQ(decoded(DicomWriter(true, true).start().pixels(swapped, "OW").bytes(), spec), wanted);
}

TEST(DecodeNative, BigEndianBytesInWords) {
  const FrameSpec spec = makeSpec(kBig, 1, 3, 8, 8);
  const Bytes file = DicomWriter(true, true).start().pixels(bytesFrom({2, 1, 0, 3}), "OW").bytes();
  const std::vector<std::int64_t> wanted{1, 2, 3};
  EXPECT_EQ(decoded(file, spec), wanted);
}

TEST(DecodeNative, FloatsKeepTheirBits) {
  const float values[2] = {1.5f, -0.0f};
  Bytes pixels(8);
  std::memcpy(pixels.data(), values, 8);
  FrameSpec spec = makeSpec(kExplicit, 1, 2, 32, 32, true);
  spec.sample = SampleType::F32;
  const Bytes file = DicomWriter().start().element(0x7FE0, 0x0008, "OF", pixels).bytes();
  EXPECT_EQ(run(file, spec).out, pixels);
  // Integer pixel data where floats are declared, and the other way round.
  EXPECT_EQ(codeOf(DicomWriter().start().pixels(pixels).bytes(), spec), ErrorCode::CodecMismatch);
  EXPECT_EQ(codeOf(file, makeSpec(kExplicit, 1, 2, 32, 32)), ErrorCode::CodecMismatch);
}

TEST(DecodeNative, ShortDataIsRefusedNeverPadded) {
  const FrameSpec spec = makeSpec(kExplicit, 4, 4, 16, 16);
  EXPECT_EQ(codeOf(DicomWriter().start().pixels(Bytes(30, std::byte{7})).bytes(), spec),
            ErrorCode::PixelDataShort);
  EXPECT_EQ(codeOf(DicomWriter().start().pixels({}).bytes(), spec), ErrorCode::PixelDataShort);
  // The length says enough, the file ends before.
  Bytes cut = DicomWriter().start().pixels(Bytes(32, std::byte{7})).bytes();
  cut.pop_back();
  EXPECT_EQ(codeOf(cut, spec), ErrorCode::PixelDataShort);
  EXPECT_EQ(codeOf(DicomWriter().start().bytes(), spec), ErrorCode::PixelDataMissing);
  FrameSpec bits = makeSpec(kExplicit, 3, 3, 1, 1);
  EXPECT_EQ(codeOf(DicomWriter().start().pixels(Bytes(1)).bytes(), bits), ErrorCode::PixelDataShort);
}

TEST(DecodeNative, ImpossibleSpecsAreRefused) {
  const Bytes file = DicomWriter().start().pixels(Bytes(32)).bytes();
  const auto refused = [&](auto change) {
    FrameSpec spec = makeSpec(kExplicit, 4, 4, 16, 12);
    change(spec);
    Bytes out(32);
    const auto r = decode(file, spec, out);
    return r.ok() ? ErrorCode::OutOfTolerance : r.error().code;
  };
  EXPECT_EQ(refused([](FrameSpec& s) { s.rows = 0; }), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refused([](FrameSpec& s) { s.bitsStored = 17; }), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refused([](FrameSpec& s) { s.highBit = 16; }), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refused([](FrameSpec& s) { s.highBit = 3; }), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refused([](FrameSpec& s) { s.sample = SampleType::U8; }), ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(refused([](FrameSpec& s) { s.rows = std::uint64_t{1} << 60; }), ErrorCode::LimitExceeded);
  EXPECT_EQ(refused([](FrameSpec& s) { s.frameCount = std::uint64_t{1} << 62; }), ErrorCode::LimitExceeded);
  EXPECT_EQ(refused([](FrameSpec& s) { s.framesDeclared = 0; }), ErrorCode::PixelDataMissing);
  EXPECT_EQ(refused([](FrameSpec& s) { s.transferSyntaxUid = kRle; }), ErrorCode::CodecMismatch);
}

TEST(DecodeNative, PixelDataIsTheTopLevelOne) {
  const FrameSpec spec = makeSpec(kExplicit, 1, 2, 8, 8);
  const std::vector<std::int64_t> wanted{5, 6};
  const Bytes icon = DicomWriter(true, false, false).pixels(bytesFrom({1, 2}), "OB").bytes();
  const auto length = static_cast<std::uint32_t>(icon.size());
  // Inside a sequence of known length, of unknown length, in an item of unknown length, and nested
  // encapsulated.
  const Bytes known = DicomWriter()
                          .start()
                          .header(0x0088, 0x0200, "SQ", length + 8)
                          .item(icon)
                          .pixels(bytesFrom({5, 6}), "OB")
                          .bytes();
  EXPECT_EQ(decoded(known, spec), wanted);
  const Bytes unknown = DicomWriter()
                            .start()
                            .header(0x0088, 0x0200, "SQ", 0xFFFFFFFF)
                            .item(icon)
                            .header(0xFFFE, 0xE000, "", 0xFFFFFFFF)
                            .raw(icon)
                            .fragments({bytesFrom({9, 9})})
                            .header(0xFFFE, 0xE00D, "", 0)
                            .sequenceEnd()
                            .pixels(bytesFrom({5, 6}), "OB")
                            .bytes();
  EXPECT_EQ(decoded(unknown, spec), wanted);
  // The first of two, as the toolkits do.
  const Bytes twice =
      DicomWriter().start().pixels(bytesFrom({5, 6}), "OB").pixels(bytesFrom({7, 8}), "OB").bytes();
  EXPECT_EQ(decoded(twice, spec), wanted);
}

TEST(DecodeNative, SequenceOfUnknownVrIsImplicit) {
  const Bytes inner =
      DicomWriter(false, false, false).element(0x0008, 0x0100, "", bytesFrom({'A', 'B'})).bytes();
  Bytes un = DicomWriter(true, false, true).start().header(0x0029, 0x1010, "UN", 0xFFFFFFFF).bytes();
  const Bytes tail = DicomWriter(false, false, false)
                         .header(0xFFFE, 0xE000, "", 0xFFFFFFFF)
                         .raw(inner)
                         .header(0xFFFE, 0xE00D, "", 0)
                         .sequenceEnd()
                         .bytes();
  un.insert(un.end(), tail.begin(), tail.end());
  const Bytes pixels = DicomWriter(true, false, false).pixels(bytesFrom({5, 6}), "OB").bytes();
  un.insert(un.end(), pixels.begin(), pixels.end());
  const std::vector<std::int64_t> wanted{5, 6};
  EXPECT_EQ(decoded(un, makeSpec(kExplicit, 1, 2, 8, 8)), wanted);
}

TEST(DecodeNative, StructureThatContradictsItselfIsRefused) {
  const FrameSpec spec = makeSpec(kExplicit, 1, 2, 8, 8);
  const Bytes pixels = bytesFrom({5, 6});
  // A length beyond the end, a sequence without end, nesting beyond the limit, an item at top level.
  EXPECT_EQ(
      codeOf(DicomWriter().start().header(0x0009, 0x1001, "OB", 1000).pixels(pixels, "OB").bytes(), spec),
      ErrorCode::FileDamaged);
  EXPECT_EQ(codeOf(DicomWriter().start().header(0x0088, 0x0200, "SQ", 0xFFFFFFFF).bytes(), spec),
            ErrorCode::FileDamaged);
  DicomWriter deep;
  deep.start();
  for (int i = 0; i < 100'000; ++i)
    deep.header(0x0088, 0x0200, "SQ", 0xFFFFFFFF).header(0xFFFE, 0xE000, "", 0xFFFFFFFF);
  EXPECT_EQ(codeOf(deep.bytes(), spec), ErrorCode::LimitExceeded);
  EXPECT_EQ(codeOf(DicomWriter().start().item(pixels).pixels(pixels, "OB").bytes(), spec),
            ErrorCode::FileDamaged);
  // What is no VR is passed over, as the scan does: here no pixels follow.
  EXPECT_EQ(codeOf(DicomWriter().start().element(0x0010, 0x0010, "??", pixels).bytes(), spec),
            ErrorCode::PixelDataMissing);
  EXPECT_EQ(codeOf({}, spec), ErrorCode::PixelDataMissing);
  EXPECT_EQ(codeOf(Bytes(1000), spec), ErrorCode::PixelDataMissing);
}

TEST(DecodeNative, FilesWithoutPreambleAndWithoutMeta) {
  const std::vector<std::int64_t> wanted{5, 6};
  for (bool isExplicit : {true, false})
    for (bool big : {true, false}) {
      const Bytes file = DicomWriter(isExplicit, big, false).start().pixels(bytesFrom({5, 6}), "OB").bytes();
      // An implicit header names no VR: 8-bit pixels in words cannot be told from bytes there, and are bytes.
      EXPECT_EQ(decoded(file, makeSpec("", 1, 2, 8, 8)), wanted) << isExplicit << big;
    }
}

}  // namespace
}  // namespace vernier::test
