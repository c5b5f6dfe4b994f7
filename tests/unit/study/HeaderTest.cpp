// SPDX-License-Identifier: GPL-3.0-or-later
// The header reader on hand-made bytes: every encoding, and every way in which a file may lie.
#include "Header.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <array>

#include "Attributes.h"
#include "HeaderBytes.h"
#include "Text.h"
#include "vernier/base/Random.h"
#include "vernier/study/Decode.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {
using test::Bytes;
using test::kUndefinedLength;

Header read(const Bytes& b) {
  const auto source = memorySource(b.span());
  auto h = readHeader(*source);
  EXPECT_TRUE(h) << h.error().text();
  return h ? std::move(*h) : Header();
}
std::string text(const Header& h, Tag t) {
  const Element* e = h.find(t);
  return e ? std::string(rawText(h, *e)) : "(absent)";
}

TEST(Header, ExplicitLittleEndianUpToThePixels) {
  Bytes b;
  b.part10().ctObject().element(0x10, 0x10, "PN", "Doe^J");
  b.longHead(0x7FE0, 0x10, "OW", 4).raw("abcd");
  const Header h = read(b);
  EXPECT_TRUE(h.part10);
  EXPECT_FALSE(h.damage);
  EXPECT_EQ(text(h, 0x00100010), "Doe^J");
  ASSERT_TRUE(h.pixels);
  EXPECT_FALSE(h.pixels->encapsulated);
  EXPECT_EQ(h.pixels->bytesThere, 4u);
}

TEST(Header, ImplicitLittleEndian) {
  Bytes b;
  b.part10("1.2.840.10008.1.2").tag(8, 0x60).u32(2).raw("MR").tag(0x28, 0x10).u32(2).u16(512);
  const Header h = read(b);
  EXPECT_EQ(text(h, 0x00080060), "MR");
  EXPECT_EQ(word(h, *h.find(0x00280010)), 512);
}

TEST(Header, BigEndian) {
  Bytes b;
  b.part10("1.2.840.10008.1.2.2");
  b.raw({0, 8, 0, 0x60, 'C', 'S', 0, 2, 'M', 'R', 0, 0x28, 0, 0x10, 'U', 'S', 0, 2, 2, 0});
  const Header h = read(b);
  EXPECT_TRUE(h.encoding.bigEndian);
  EXPECT_EQ(text(h, 0x00080060), "MR");
  EXPECT_EQ(word(h, *h.find(0x00280010)), 512);
}

TEST(Header, DeclaredExplicitButWrittenImplicitIsReadAndTold) {
  Bytes b;
  b.part10().tag(8, 0x60).u32(2).raw("MR");
  const Header h = read(b);
  EXPECT_TRUE(h.contradictsSyntax);
  EXPECT_EQ(text(h, 0x00080060), "MR");
}

std::string deflated(const std::string& in) {
  std::string out(in.size() + 1024, '\0');
  z_stream z{};
  EXPECT_EQ(deflateInit2(&z, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data()));
  z.avail_in = static_cast<uInt>(in.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

TEST(Header, Deflated) {
  Bytes inner;
  inner.ctObject().longHead(0x7FE0, 0x10, "OW", 6).raw("abcdef");
  Bytes b;
  b.part10("1.2.840.10008.1.2.1.99").raw(deflated(inner.data));
  const Header h = read(b);
  EXPECT_EQ(text(h, 0x00080060), "CT");
  ASSERT_TRUE(h.pixels);
  EXPECT_EQ(h.pixels->bytesThere, 6u);
}

TEST(Header, DeflatedBombIsRefused) {
  Bytes inner;
  inner.ctObject().longHead(9, 0x1001, "OB", 32 << 20).raw(std::string(32 << 20, '\0'));
  Bytes b;
  b.part10("1.2.840.10008.1.2.1.99").raw(deflated(inner.data));
  const auto source = memorySource(b.span());
  const auto h = readHeader(*source);
  ASSERT_TRUE(h);
  ASSERT_TRUE(h->damage);
  EXPECT_EQ(h->damage->code, ErrorCode::LimitExceeded);
  EXPECT_LT(h->bytes.size(), limits::kAlwaysInflatedBytes + (1 << 20));
}

TEST(Header, NestedSequencesAreSkippedAndTheRestIsRead) {
  Bytes b;
  b.part10().ctObject();
  b.longHead(8, 0x1140, "SQ", kUndefinedLength).item(kUndefinedLength).element(8, 0x1155, "UI", "1.2");
  b.longHead(8, 0x1199, "SQ", kUndefinedLength)
      .item(14)
      .element(8, 0x1150, "UI", "1.2.3 ")
      .itemEnd()
      .sequenceEnd();
  b.itemEnd().sequenceEnd().element(0x10, 0x20, "LO", "ID");
  const Header h = read(b);
  EXPECT_FALSE(h.damage);
  EXPECT_EQ(text(h, 0x00100020), "ID");
  const auto items = itemsOf(h, *h.find(0x00081140));
  ASSERT_EQ(items.size(), 1u);
  ASSERT_EQ(items[0].size(), 2u);
  EXPECT_EQ(rawText(h, items[0][0]), "1.2");
  const auto inner = itemsOf(h, items[0][1]);
  ASSERT_EQ(inner.size(), 1u);
  EXPECT_EQ(rawText(h, inner[0].at(0)), "1.2.3");
}

TEST(Header, UnknownVrOfUndefinedLengthIsImplicitInside) {
  Bytes b;
  b.part10().ctObject().longHead(9, 0x1002, "UN", kUndefinedLength).item(kUndefinedLength);
  b.tag(8, 0x1150).u32(4).raw("1.2 ").itemEnd().sequenceEnd().element(0x10, 0x20, "LO", "ID");
  const Header h = read(b);
  EXPECT_EQ(text(h, 0x00100020), "ID");
  const auto items = itemsOf(h, *h.find(0x00091002));
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(rawText(h, items[0].at(0)), "1.2");
}

Bytes nested(int depth) {
  Bytes b;
  b.part10().ctObject();
  for (int i = 0; i < depth; ++i) b.longHead(8, 0x1140, "SQ", kUndefinedLength).item(kUndefinedLength);
  for (int i = 0; i < depth; ++i) b.itemEnd().sequenceEnd();
  b.element(0x10, 0x20, "LO", "ID");
  return b;
}

TEST(Header, DepthAtAndOverTheLimit) {
  EXPECT_FALSE(read(nested(limits::kMaxSequenceDepth)).damage);
  EXPECT_EQ(text(read(nested(limits::kMaxSequenceDepth)), 0x00100020), "ID");
  for (const int depth : {limits::kMaxSequenceDepth + 1, 15000}) {
    const Header h = read(nested(depth));
    ASSERT_TRUE(h.damage) << depth;
    EXPECT_EQ(h.damage->code, ErrorCode::LimitExceeded);
    EXPECT_EQ(text(h, 0x00080060), "CT");  // what came before stands
  }
}

TEST(Header, LengthsThatTheFileDoesNotHold) {
  for (const std::uint32_t length : {0xFFFFFFFEu, 0x7FFFFFFFu, 1000u}) {
    Bytes b;
    b.part10().ctObject().longHead(9, 0x1001, "OB", length).raw("abcd");
    const Header h = read(b);
    ASSERT_TRUE(h.damage) << length;
    EXPECT_EQ(h.damage->code, ErrorCode::FileDamaged);
    EXPECT_EQ(text(h, 0x00080060), "CT");
  }
  Bytes inside;
  inside.part10().ctObject().longHead(8, 0x1140, "SQ", kUndefinedLength).item(kUndefinedLength);
  inside.longHead(8, 0x1199, "OB", 0xFFFFFFF0).raw("ab");
  EXPECT_TRUE(read(inside).damage);
}

TEST(Header, PixelDataCutShortSaysHowManyBytesAreThere) {
  Bytes b;
  b.part10().ctObject().longHead(0x7FE0, 0x10, "OW", 100).raw("abcd");
  const Header h = read(b);
  ASSERT_TRUE(h.pixels);
  EXPECT_EQ(h.pixels->bytesThere, 4u);
}

TEST(Header, CutAnywhereNeverFails) {
  Bytes b = nested(5);
  b.longHead(0x7FE0, 0x10, "OW", 4).raw("abcd");
  for (std::size_t n = 0; n <= b.data.size(); ++n) {
    Bytes part;
    part.raw(b.data.substr(0, n));
    const auto source = memorySource(part.span());
    const auto h = readHeader(*source);
    if (h)
      (void)recordFrom(*h);
    else
      EXPECT_FALSE(h.error().sentence.empty());
  }
}

TEST(Header, ElementsAtAndOverTheLimit) {
  const auto many = [](std::size_t n) {
    Bytes b;
    b.part10();
    for (std::size_t i = 0; i < n; ++i) b.element(9, 0x1001, "LO", "");
    return b;
  };
  EXPECT_FALSE(read(many(limits::kMaxElements - 1)).damage);
  const Header over = read(many(limits::kMaxElements + 1));
  ASSERT_TRUE(over.damage);
  EXPECT_EQ(over.damage->code, ErrorCode::LimitExceeded);
}

TEST(Header, ElementAtAndOverTheSizeLimit) {
  for (const std::uint64_t over : {0, 2}) {
    Bytes b;
    b.part10().ctObject();
    const auto n = static_cast<std::uint32_t>(limits::kMaxNonPixelElementBytes + over);
    b.longHead(9, 0x1001, "OB", n).raw(std::string(n, 'x')).element(0x10, 0x20, "LO", "ID");
    const Header h = read(b);
    EXPECT_EQ(h.damage.has_value(), over > 0);
    EXPECT_EQ(text(h, 0x00100020), over > 0 ? "(absent)" : "ID");
  }
}

TEST(Header, MetaElementAtAndOverTheSizeLimit) {
  for (const std::uint64_t over : {0, 2}) {
    Bytes b;
    const auto n = static_cast<std::uint32_t>(limits::kMaxNonPixelElementBytes + over);
    b.part10().longHead(2, 0x0102, "OB", n).raw(std::string(n, 'x')).ctObject();
    const Header h = read(b);
    ASSERT_EQ(h.damage.has_value(), over > 0);
    if (h.damage) {
      EXPECT_EQ(h.damage->code, ErrorCode::LimitExceeded);
    }
  }
}

TEST(Header, DamagedBytesNeverDoHarm) {
  Bytes good = nested(4);
  good.element(0x28, 2, "US", std::string("\1\0", 2)).element(0x28, 0x10, "US", std::string("\4\0", 2));
  good.longHead(0x28, 0x3010, "SQ", kUndefinedLength).item(kUndefinedLength);
  good.element(0x28, 0x3002, "US", std::string("\2\0\0\0\10\0", 6)).element(0x28, 0x3006, "US", "abcd");
  good.itemEnd().sequenceEnd().longHead(0x7FE0, 0x10, "OW", 4).raw("abcd");
  ::testing::internal::CaptureStderr();
  for (std::uint64_t n = 0; n < 20000; ++n) {
    Bytes bad = good;
    for (std::uint64_t k = 0; k <= n % 4; ++k) {
      const auto at = static_cast<std::size_t>(randomBits(n, 2 * k) % (bad.data.size() - 132)) + 132;
      bad.data[at] = static_cast<char>(randomBits(n, 2 * k + 1));
    }
    const auto source = memorySource(bad.span());
    const auto h = readHeader(*source);
    if (!h) continue;
    const Record r = recordFrom(*h);
    for (const Element& e : h->elements) EXPECT_LE(e.offset + e.length, h->bytes.size());
    EXPECT_LE(r.instance.voiLuts.size(), 1000u);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");  // no library may speak
}

TEST(Header, WithoutPreambleOnlyAPlausibleStart) {
  Bytes plain;
  plain.ctObject();
  EXPECT_EQ(text(read(plain), 0x00080060), "CT");
  EXPECT_FALSE(read(plain).part10);
  Bytes meta;
  meta.element(2, 2, "UI", "1.2.3")
      .element(2, 3, "UI", "1.2.4")
      .element(2, 0x10, "UI", "1.2.840.10008.1.2.1")
      .ctObject();
  EXPECT_EQ(text(read(meta), 0x00080060), "CT");
  const std::string elf = std::string(
                              "\x7f"
                              "ELF\x02\x01\x01",
                              7) +
                          std::string(200, '\0');
  const std::string zeros(500, '\0'),
      prose = "Dear reader, this is text and nothing else. " + std::string(200, 'x');
  for (const std::string& no :
       {std::string(), std::string("a"), elf, "MZ" + std::string(300, '\x90'), zeros, prose}) {
    Bytes b;
    b.raw(no);
    const auto source = memorySource(b.span());
    const auto h = readHeader(*source);
    ASSERT_FALSE(h);
    EXPECT_EQ(h.error().code, ErrorCode::NotDicom);
  }
}

TEST(Header, RowsOfAnotherVrAreALie) {
  Bytes b;
  b.part10().ctObject().element(0x28, 2, "US", std::string("\1\0", 2)).element(0x28, 4, "CS", "MONOCHROME2");
  b.element(0x28, 0x10, "UL", std::string("\4\0\0\0", 4)).element(0x28, 0x11, "US", std::string("\4\0", 2));
  b.element(0x28, 0x100, "US", std::string("\x10\0", 2)).element(0x28, 0x101, "US", std::string("\x10\0", 2));
  b.element(0x28, 0x102, "US", std::string("\xf\0", 2)).element(0x28, 0x103, "US", std::string("\0\0", 2));
  b.longHead(0x7FE0, 0x10, "OW", 32).raw(std::string(32, '\0'));
  const Record r = recordFrom(read(b));
  ASSERT_TRUE(r.instance.pixelError);
  EXPECT_EQ(r.instance.pixelError->code, ErrorCode::PixelDescriptionInvalid);
  EXPECT_NE(r.instance.pixelError->sentence.find("UL"), std::string::npos);
}

// Two readers walk a file: the scan, and the decoder on its way to the pixels. What the one accepts the other
// must find.
TEST(Header, TheDecoderFindsWhatTheScanAccepts) {
  Bytes unknownVr, noVr, strayItem, noItemEnd, twoItemEnds;
  unknownVr.longHead(9, 0x1001, "ZZ", 4).raw("abcd");
  noVr.element(9, 0x1001, "\x01\x02", "abcd");
  strayItem.item(4).itemEnd();
  noItemEnd.longHead(9, 0x1001, "SQ", kUndefinedLength).item(kUndefinedLength);
  noItemEnd.element(9, 0x1002, "LO", "x").sequenceEnd();
  twoItemEnds.longHead(9, 0x1001, "SQ", kUndefinedLength).item(kUndefinedLength).itemEnd().itemEnd();
  twoItemEnds.sequenceEnd();
  const auto us = [](int v) { return std::string{static_cast<char>(v), '\0'}; };
  for (const Bytes* odd : {&unknownVr, &noVr, &strayItem, &noItemEnd, &twoItemEnds})
    for (const bool inFront : {false, true}) {
      if (inFront && odd != &strayItem) continue;
      SCOPED_TRACE(odd->data);
      Bytes b;
      b.part10();
      if (inFront) b.raw(odd->data);
      b.ctObject();
      if (!inFront) b.raw(odd->data);
      b.element(0x28, 2, "US", us(1)).element(0x28, 4, "CS", "MONOCHROME2");
      b.element(0x28, 0x10, "US", us(2)).element(0x28, 0x11, "US", us(2)).element(0x28, 0x100, "US", us(8));
      b.longHead(0x7FE0, 0x10, "OB", 4).raw("1234");
      const Header h = read(b);
      ASSERT_FALSE(h.damage);
      const Record r = recordFrom(h);
      ASSERT_TRUE(r.instance.isImage && !r.instance.pixelError);
      std::array<std::byte, 4> out{};
      const auto decoded = decode(b.span(), r.instance.pixels, out);
      EXPECT_TRUE(decoded) << decoded.error().text();
      EXPECT_EQ(std::to_integer<char>(out[3]), '4');
    }
}

TEST(Attributes, QuadrupedIsSeen) {
  for (const char* type : {"BIPED", "QUADRUPED"}) {
    Bytes b;
    b.part10().ctObject().element(0x10, 0x2210, "CS", type);
    const auto source = memorySource(b.span());
    const auto h = readHeader(*source);
    ASSERT_TRUE(h);
    EXPECT_EQ(recordFrom(*h).quadruped, std::string(type) == "QUADRUPED");
  }
}

// Three frames: one with a window of its own, two with the shared one; then all three with their own.
TEST(Attributes, DifferentWindowsOfFrames) {
  const auto group = [](const char* width) {
    Bytes window, voi;
    window.element(0x28, 0x1050, "DS", "40").element(0x28, 0x1051, "DS", width);
    voi.longHead(0x28, 0x9132, "SQ", kUndefinedLength)
        .item(static_cast<std::uint32_t>(window.data.size()))
        .raw(window.data)
        .sequenceEnd();
    return voi.data;
  };
  const auto windowsOf = [&](const char* shared, const std::vector<const char*>& frames) {
    Bytes b;
    b.part10().ctObject().element(0x28, 0x0008, "IS", std::to_string(frames.size()));
    b.element(0x28, 0x1050, "DS", "1").element(0x28, 0x1051, "DS", "2");
    b.longHead(0x5200, 0x9229, "SQ", kUndefinedLength).item(kUndefinedLength);
    if (shared) b.raw(group(shared));
    b.itemEnd().sequenceEnd();
    b.longHead(0x5200, 0x9230, "SQ", kUndefinedLength);
    for (const char* f : frames) {
      b.item(kUndefinedLength);
      if (f) b.raw(group(f));
      b.itemEnd();
    }
    b.sequenceEnd();
    const auto source = memorySource(b.span());
    const auto h = readHeader(*source);
    EXPECT_TRUE(h && !h->damage);
    return h ? recordFrom(*h).frameWindows : 0;
  };
  EXPECT_EQ(windowsOf("400", {"350", nullptr, nullptr}), 2u);
  EXPECT_EQ(windowsOf("400", {"350", "300", "250"}), 3u);
  EXPECT_EQ(windowsOf("400", {"350", "350"}), 1u);
  EXPECT_EQ(windowsOf("400", {nullptr, nullptr}), 1u);
  EXPECT_EQ(windowsOf(nullptr, {nullptr, nullptr}), 0u) << "the root does not count";
}

TEST(Attributes, DecimalStrings) {
  EXPECT_EQ(parseDecimal("1.5"), 1.5);
  EXPECT_EQ(parseDecimal("+1.5e-3"), 1.5e-3);
  EXPECT_EQ(parseDecimal("-0"), 0);
  EXPECT_FALSE(parseDecimal(""));
  EXPECT_FALSE(parseDecimal("1,5"));
  EXPECT_FALSE(parseDecimal("1.5mm"));
  EXPECT_EQ(parseInteger("+12"), 12);
  EXPECT_FALSE(parseInteger("12.0"));
}

}  // namespace
}  // namespace vernier
