// SPDX-License-Identifier: GPL-3.0-or-later
// Palettes of 8 and 16 bits, segmented ones, and those that lie about their size. What the segments mean is
// typed here from PS3.3 C.7.9.2.
#include <gtest/gtest.h>

#include "Luts.h"
#include "MakeDicom.h"
#include "TestData.h"
#include "vernier/study/Load.h"

namespace vernier {
namespace {

using test::DicomSlice;
using test::TempDir;
using Words = std::vector<std::uint16_t>;

DicomSlice paletteSlice(Words descriptor, Words red, Words green, Words blue, bool segmented = false) {
  DicomSlice s;
  s.rows = 1;
  s.columns = 4;
  s.bitsAllocated = s.bitsStored = 8;
  s.isSigned = false;
  s.photometric = "PALETTE COLOR";
  const std::string data = segmented ? "0028,122" : "0028,120";
  const Words* const tables[] = {&red, &green, &blue};
  for (int c = 0; c < 3; ++c) {
    s.words.push_back({"0028,110" + std::to_string(c + 1), descriptor});
    s.words.push_back({data + std::to_string(c + 1), *tables[c]});
  }
  return s;
}

Instance only(const DicomSlice& s) {
  const TempDir dir;
  writeDicom(dir.path() / "a.dcm", s);
  const auto set = scanStudy({dir.path().string()});
  EXPECT_TRUE(set.ok());
  return set->instances.at(0);
}

TEST(Palette, SixteenBitsAndEightBits) {
  const Instance i = only(paletteSlice({3, 10, 16}, {0, 1000, 65535}, {5, 6, 700}, {9, 8, 7}));
  ASSERT_TRUE(i.palette) << i.pixelError->text();
  EXPECT_EQ(i.palette->bits, 16u);
  EXPECT_EQ(i.palette->firstMapped, 10);
  EXPECT_EQ(i.palette->at(11), (std::array<std::uint16_t, 3>{1000, 6, 8}));
  // Below the first and past the last index the ends hold.
  EXPECT_EQ(i.palette->at(0), i.palette->at(10));
  EXPECT_EQ(i.palette->at(255), i.palette->at(12));
  EXPECT_EQ(i.notShown, "");
  EXPECT_EQ(i.palette->fullScale, 65535);

  // Two entries in each word, low byte first; and one in each.
  const Instance packed = only(paletteSlice({4, 0, 8}, {0x0201, 0xFF03}, {0, 0}, {0x0100, 0}));
  ASSERT_TRUE(packed.palette);
  EXPECT_EQ(packed.palette->at(3)[0], 255);
  EXPECT_EQ(packed.palette->at(1), (std::array<std::uint16_t, 3>{2, 0, 1}));
  const Instance loose = only(paletteSlice({2, 0, 8}, {7, 255}, {1, 2}, {3, 4}));
  ASSERT_TRUE(loose.palette);
  EXPECT_EQ(loose.palette->at(1), (std::array<std::uint16_t, 3>{255, 2, 4}));
}

TEST(Palette, EightBitValuesThatAreCalledSixteenBitOnesAreFlagged) {
  const Instance i = only(paletteSlice({2, 0, 16}, {0, 255}, {0, 128}, {0, 1}));
  ASSERT_TRUE(i.palette);
  EXPECT_EQ(i.palette->bits, 8u);
  EXPECT_NE(i.pixels.corrected.find("8 bits are taken"), std::string::npos);
}

TEST(Palette, EightBitValuesInHighBytesReachFullIntensity) {
  EXPECT_EQ(only(paletteSlice({2, 0, 16}, {0, 0xFF00}, {0, 0x8000}, {0, 0x0100})).palette->fullScale, 0xFF00);
  EXPECT_EQ(only(paletteSlice({2, 0, 16}, {0, 0xFF00}, {0, 0x8001}, {0, 0x0100})).palette->fullScale, 0xFFFF);
}

TEST(Palette, ASignedIndexIsReadWithItsSign) {
  DicomSlice s = paletteSlice({2, 0xFFFE, 16}, {1, 60000}, {2, 5}, {3, 6});
  s.isSigned = true;
  // The descriptor's own VR (US here) rules over the pixel's sign.
  EXPECT_EQ(only(s).palette->firstMapped, 65534);
}

TEST(Palette, SegmentsAreWrittenOut) {
  // Two values, a line to 100 in four steps, then the first two segments once more.
  const Words data{0, 2, 10, 20, 1, 4, 100, 2, 2, 0, 0};
  EXPECT_EQ(expandSegments(data, 12, false), (Words{10, 20, 40, 60, 80, 100, 10, 20, 40, 60, 80, 100}));
  // A line rounds each of its values; it may go down.
  EXPECT_EQ(expandSegments({0, 1, 0, 1, 3, 10}, 4, false), (Words{0, 3, 7, 10}));
  EXPECT_EQ(expandSegments({0, 1, 9, 1, 3, 0}, 4, false), (Words{9, 6, 3, 0}));
  // A line first in what is pointed at starts from the value before it.
  EXPECT_EQ(expandSegments({0, 1, 4, 1, 2, 8, 2, 1, 6, 0}, 5, false), (Words{4, 6, 8, 8, 8}));
  // Of 8-bit tables the offset has four bytes.
  EXPECT_EQ(expandSegments({0, 2, 1, 2, 2, 1, 0, 0, 0, 0}, 4, true), (Words{1, 2, 1, 2}));
}

TEST(Palette, SegmentsThatLieAreRefused) {
  EXPECT_FALSE(expandSegments({}, 4, false));
  EXPECT_FALSE(expandSegments({0, 9, 1, 2}, 4, false));             // more than there is
  EXPECT_FALSE(expandSegments({0, 2, 1, 2}, 4, false));             // fewer entries than declared
  EXPECT_FALSE(expandSegments({0, 4, 1, 2, 3, 4}, 3, false));       // more entries than declared
  EXPECT_FALSE(expandSegments({1, 4, 9}, 4, false));                // a line from nowhere
  EXPECT_FALSE(expandSegments({0, 1, 5, 1, 0, 9}, 1 + 1, false));   // a line without length
  EXPECT_FALSE(expandSegments({3, 1, 1}, 1, false));                // no such segment
  EXPECT_FALSE(expandSegments({0, 1, 5, 2, 1, 400, 0}, 4, false));  // points behind the data
  EXPECT_FALSE(expandSegments({0, 1, 5, 2, 1, 6, 0}, 4, false));    // points at itself
  EXPECT_FALSE(expandSegments({0, 1, 5, 1, 60000, 9}, 256, false));
}

TEST(Palette, SegmentedInAFile) {
  const Words segments{0, 1, 0, 1, 255, 65535};
  const Instance i = only(paletteSlice({256, 0, 16}, segments, segments, segments, true));
  ASSERT_TRUE(i.palette) << i.pixelError->text();
  for (int n = 0; n < 256; ++n) EXPECT_EQ(i.palette->at(n)[1], 257 * n);
  EXPECT_EQ(only(paletteSlice({255, 0, 16}, segments, segments, segments, true)).pixelError->code,
            ErrorCode::PixelDescriptionInvalid);
}

TEST(Palette, RefusedWithASentence) {
  const auto refused = [](const DicomSlice& s, const char* part) {
    const Instance i = only(s);
    ASSERT_TRUE(i.pixelError) << part;
    EXPECT_EQ(i.pixelError->code, ErrorCode::PixelDescriptionInvalid);
    EXPECT_NE(i.pixelError->sentence.find(part), std::string::npos) << i.pixelError->sentence;
    EXPECT_FALSE(i.palette);
  };
  refused(paletteSlice({4, 0, 16}, {1, 2, 3, 4}, {1, 2, 3, 4}, {1, 2}), "blue palette declares 4 entries");
  refused(paletteSlice({4, 0, 12}, {1, 2, 3, 4}, {1, 2, 3, 4}, {1, 2, 3, 4}), "12 bits");
  refused(paletteSlice({0, 0, 16}, {1, 2, 3, 4}, {1, 2, 3, 4}, {1, 2, 3, 4}), "65536 entries");
  refused(paletteSlice({2, 0, 8}, {1, 2}, {1, 300}, {1, 2}), "above 255");
  DicomSlice missing = paletteSlice({2, 0, 16}, {1, 2}, {1, 3}, {1, 2});
  missing.erase = {"0028,1202"};
  refused(missing, "green palette is missing");
  missing.erase = {"0028,1103"};
  refused(missing, "blue palette has no descriptor");
  DicomSlice uneven = paletteSlice({2, 0, 16}, {1, 2}, {1, 3}, {1, 2});
  uneven.words[2].second = {2, 1, 16};
  refused(uneven, "differ");
}

TEST(Palette, ADescriptorOfZeroIs65536Entries) {
  Words ramp(65536);
  for (std::size_t n = 0; n < ramp.size(); ++n) ramp[n] = static_cast<std::uint16_t>(n);
  const Instance i = only(paletteSlice({0, 0, 16}, ramp, ramp, ramp));
  ASSERT_TRUE(i.palette) << i.pixelError->text();
  EXPECT_EQ(i.palette->entries.size(), 65536u);
  EXPECT_EQ(i.palette->at(65535)[2], 65535);
}

}  // namespace
}  // namespace vernier
