// SPDX-License-Identifier: GPL-3.0-or-later
// Segmentations and real-world values.
#include "Segments.h"

#include <cmath>

#include "ScanSupport.h"

namespace vernier {
namespace {
using test::EnhancedObject;
using test::enhancedStack;
using test::number;
using test::Scan;
using test::scanOf;

// 5 x 3 pixels of one bit: frames begin in the middle of bytes. A pixel is set where (p * 7 + f) % 3 == 0.
bool bit(std::size_t frame, std::size_t pixel) { return (pixel * 7 + frame) % 3 == 0; }
EnhancedObject segmentation(const std::vector<double>& z, const std::vector<int>& segment) {
  EnhancedObject o = enhancedStack(z);
  o.sopClassUid = "1.2.840.10008.5.1.4.1.1.66.4";
  o.modality = "SEG";
  o.rows = 3;
  o.columns = 5;
  o.bitsAllocated = o.bitsStored = 1;
  o.isSigned = false;
  o.set.push_back({"0062,0001", "BINARY"});
  o.pixels.clear();
  for (std::size_t f = 0; f < z.size(); ++f) {
    for (std::size_t p = 0; p < 15; ++p) o.pixels.push_back(bit(f, p));
    o.perFrame[f].push_back({"0062,000A", {{"0062,000B", std::to_string(segment[f])}}});
  }
  o.sequences = {{"0062,0002",
                  {{"0062,0004", "1"},
                   {"0062,0005", "Liver"},
                   {"0062,0008", "MANUAL"},
                   {"0062,000D", "39321\\43176\\25186"}}},
                 {"0062,0002/0062,000F", {{"0008,0104", "Liver, whole"}}}};
  return o;
}

TEST(Segmentation, FramesOfSingleBitsDecodeAcrossByteBorders) {
  for (const char* syntax :
       {"1.2.840.10008.1.2", "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.2", "1.2.840.10008.1.2.1.99"}) {
    EnhancedObject o = segmentation({0, 1, 2}, {1, 1, 1});
    o.transferSyntaxUid = syntax;
    const Scan s = scanOf({o});
    SCOPED_TRACE(syntax);
    ASSERT_EQ(s.stack().slices.size(), 3u);
    std::vector<std::uint8_t> v(3 * 15);
    std::vector<SliceFailure> failed;
    ASSERT_TRUE(decodeStack(s.set, s.stack(), SampleType::U8, std::as_writable_bytes(std::span(v)), failed));
    EXPECT_TRUE(failed.empty());
    for (std::size_t f = 0; f < 3; ++f)
      for (std::size_t p = 0; p < 15; ++p) EXPECT_EQ(v[f * 15 + p], bit(f, p)) << f << " " << p;
  }
}

TEST(Segmentation, PixelDataThatEndsInTheLastByteIsMissed) {
  EnhancedObject o = segmentation({0, 1, 2}, {1, 1, 1});
  o.set[0].second = "4";  // frames: 60 bits need 8 bytes, the file has 6
  o.perFrame.resize(4, o.perFrame[0]);
  EXPECT_TRUE(scanOf({o}).instance().pixelError);
}

TEST(Segmentation, SegmentsAreNamedAndSplit) {
  const Scan s = scanOf({segmentation({0, 2, 2, 4}, {1, 1, 2, 2})});
  const Instance& i = s.instance();
  EXPECT_EQ(i.segmentation, SegmentationKind::Binary);
  ASSERT_EQ(i.segments.size(), 1u);
  EXPECT_EQ(i.segments[0].number, 1);
  EXPECT_EQ(i.segments[0].label, "Liver");
  EXPECT_EQ(i.segments[0].type, "Liver, whole");
  EXPECT_EQ(i.segments[0].algorithm, "MANUAL");
  ASSERT_TRUE(i.segments[0].colour);
  ASSERT_EQ(s.series().stacks.size(), 2u);
  EXPECT_EQ(s.stack(0).label, "segment 1 (Liver)");
  EXPECT_EQ(s.order(1), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(i.frame(2).segments, std::vector<std::uint16_t>{2});
}

TEST(Segmentation, FramesThatWereLeftOutAreEmpty) {
  const Scan s = scanOf({segmentation({0, 2, 8}, {1, 1, 1})});
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{0, 1, SliceRef::kEmptyFrame, SliceRef::kEmptyFrame, 2}));
  EXPECT_EQ(s.stack().shape, StackShape::Uniform);
  EXPECT_FALSE(s.finding("gap"));
  EXPECT_EQ(number(*s.finding("empty-frames-left-out"), "frames"), 2);
  std::vector<std::uint8_t> v(5 * 15, 9);
  std::vector<SliceFailure> failed;
  ASSERT_TRUE(decodeStack(s.set, s.stack(), SampleType::U8, std::as_writable_bytes(std::span(v)), failed));
  for (std::size_t p = 0; p < 15; ++p) {
    EXPECT_EQ(v[1 * 15 + p], bit(1, p));
    EXPECT_EQ(v[2 * 15 + p], 0);
    EXPECT_EQ(v[4 * 15 + p], bit(2, p));
  }
  // Steps that are no multiples of the smallest stay a gap.
  EXPECT_TRUE(scanOf({segmentation({0, 2, 4, 9}, {1, 1, 1, 1})}).finding("gap"));
}

TEST(Segmentation, FractionsAreParts) {
  EnhancedObject o = segmentation({0, 1}, {1, 1});
  o.bitsAllocated = o.bitsStored = 8;
  o.set.back().second = "FRACTIONAL";
  o.set.push_back({"0062,000E", "200"});
  const Scan s = scanOf({o});
  EXPECT_EQ(s.instance().segmentation, SegmentationKind::Fractional);
  EXPECT_DOUBLE_EQ(s.instance().frame(1).rescale.slope * 100, 0.5);
  EXPECT_EQ(s.instance().frame(1).unit, "fraction");
}

// Expected: LittleCMS 2 by way of PIL.ImageCms, LAB (D50) to its built-in sRGB, relative colorimetric; its
// path of 8 bits interpolates a table, which is 3 levels off in the dark.
TEST(Segmentation, ColoursAreThoseOfAColourManagementSystem) {
  struct Case {
    std::array<std::uint16_t, 3> lab;
    std::array<int, 3> rgb;
  };
  for (const Case& c :
       {Case{{39321, 43176, 25186}, {193, 117, 199}}, Case{{65535, 32896, 32896}, {254, 255, 254}},
        Case{{32896, 32896, 32896}, {119, 119, 119}}, Case{{52428, 23901, 45746}, {153, 215, 99}},
        Case{{26214, 48316, 44461}, {183, 22, 24}}, Case{{19789, 38036, 17476}, {32, 64, 167}},
        Case{{0, 32896, 32896}, {1, 0, 1}}}) {
    const auto rgb = srgbFromCieLab(c.lab);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(255 * rgb[k], c.rgb[k], 3) << c.lab[0] << " channel " << k;
  }
}

test::Macro realWorld(const std::string& slope, const std::string& intercept) {
  return {"0040,9096",
          {{"0040,9214", "0"},
           {"0040,9213", "4095"},
           {"0040,9225", slope},
           {"0040,9224", intercept},
           {"0040,9210", "ADC"}}};
}
test::Macro unit(const std::string& code) {
  return {"0040,9096/0040,08EA", {{"0008,0100", code}, {"0008,0104", "words"}}};
}

TEST(RealWorld, AMappingOfTheSameNumbersGivesTheUnit) {
  EnhancedObject o = enhancedStack({0, 2});
  o.modality = "MR";
  o.sopClassUid = "1.2.840.10008.5.1.4.1.1.4.1";
  o.shared->push_back({"0028,9145", {{"0028,1053", "0.5"}, {"0028,1052", "0"}, {"0028,1054", "US"}}});
  o.shared->push_back(realWorld("0.5", "0"));
  o.shared->push_back(unit("um2/s"));
  const Scan s = scanOf({o});
  EXPECT_EQ(s.instance().frame(1).unit, "um2/s");
  const auto& m = s.instance().frame(1).realWorld;
  ASSERT_TRUE(m);
  EXPECT_EQ((*m)[0].label, "ADC");
  EXPECT_EQ((*m)[0].last, 4095);
}

TEST(RealWorld, AnotherMappingStandsBesideTheModalityValue) {
  EnhancedObject o = enhancedStack({0, 2});
  o.modality = "MR";
  o.sopClassUid = "1.2.840.10008.5.1.4.1.1.4.1";
  o.perFrame[1].push_back(realWorld("0.25", "-3"));
  o.perFrame[1].push_back(unit("ms"));
  const Scan s = scanOf({o});
  EXPECT_FALSE(s.instance().frame(0).realWorld);
  EXPECT_EQ(s.instance().frame(1).unit, "stored value");
  EXPECT_EQ((*s.instance().frame(1).realWorld)[0].slope, 0.25);
  o.perFrame[1][1].set[2].second = "NaN";
  EXPECT_FALSE(scanOf({o}).instance().frame(1).realWorld);
}

TEST(RealWorld, AnObjectOfItsOwnNamesItsImages) {
  Scan s;
  test::DicomSlice image;
  image.modality = "PT";
  image.sopClassUid = "1.2.840.10008.5.1.4.1.1.128";
  s.add(image);
  EnhancedObject map;
  map.sopClassUid = "1.2.840.10008.5.1.4.1.1.67";
  map.modality = "RWV";
  map.seriesUid = "2.25.9";
  map.erase = {"7FE0,0010"};
  map.sequences = {{"0040,9094/0008,1140", {{"0008,1155", "2.25.1002.1"}}},
                   {"0040,9094/" + realWorld("1", "0").sequence, realWorld("1", "0").set},
                   {"0040,9094/" + unit("").sequence, unit("{SUVbw}g/ml").set}};
  s.add(map);
  s.run();
  EXPECT_EQ(s.instance(0).unit, "{SUVbw}g/ml");
  ASSERT_TRUE(s.finding("real-world-mapping"));
  EXPECT_EQ(number(*s.finding("real-world-mapping"), "images_present"), 1);
}

}  // namespace
}  // namespace vernier
