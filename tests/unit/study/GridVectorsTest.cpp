// SPDX-License-Identifier: GPL-3.0-or-later
// Multi-frame objects without functional groups: dose grids, reconstructed slices of nuclear medicine, cine
// times.
#include <cmath>

#include "ScanSupport.h"

namespace vernier {
namespace {
using test::DicomSlice;
using test::Scan;

Scan scanOf(const DicomSlice& d) {
  Scan s;
  s.add(d);
  s.run();
  return s;
}

DicomSlice dose(const std::string& offsets, int frames = 3) {
  DicomSlice d;
  d.sopClassUid = "1.2.840.10008.5.1.4.1.1.481.2";
  d.modality = "RTDOSE";
  d.frames = frames;
  d.isSigned = false;
  d.bitsAllocated = d.bitsStored = 32;
  d.position = {10, 20, 30};
  d.erase = {"0028,1052", "0028,1053"};
  d.set = {
      {"3004,0002", "GY"}, {"3004,000C", offsets}, {"3004,000E", "0.0025"}, {"0028,0009", "(3004,000C)"}};
  for (int p = 0; p < 16 * frames; ++p) d.pixels.push_back(100000 * (p / 16) + p);
  return d;
}

TEST(Dose, RelativeOffsetsRunAlongTheNormal) {
  const Scan s = scanOf(dose("0\\2.5\\5"));
  EXPECT_EQ(s.stack().shape, StackShape::Uniform);
  EXPECT_TRUE(s.stack().volume3d);
  EXPECT_DOUBLE_EQ(s.stack().step_mm, 2.5);
  EXPECT_EQ(s.instance().frame(2).plane->origin, PatientPoint(10, 20, 35));
  EXPECT_EQ(s.instance().rescale, (ModalityRescale{0.0025, 0}));
  EXPECT_EQ(s.instance().unit, "Gy");
}

// Rows to the left, columns to the head: the normal points to the front (-y).
TEST(Dose, RelativeOffsetsOfAnyOrientationAndDirection) {
  DicomSlice d = dose("0\\-3\\-6");
  d.orientation = {1, 0, 0, 0, 0, 1};
  const Scan s = scanOf(d);
  EXPECT_EQ(s.instance().frame(2).plane->origin, PatientPoint(10, 26, 30));
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{2, 1, 0}));
  EXPECT_DOUBLE_EQ(s.stack().step_mm, 3);
}

TEST(Dose, AbsoluteOffsetsArePatientCoordinatesOfAnAxialGrid) {
  const Scan s = scanOf(dose("30\\28\\26"));
  EXPECT_EQ(s.instance().frame(2).plane->origin, PatientPoint(10, 20, 26));
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{2, 1, 0}));
}

TEST(Dose, OffsetsThatSayNothingAreRefused) {
  DicomSlice coronal = dose("30\\28\\26");
  coronal.orientation = {1, 0, 0, 0, 0, 1};  // absolute offsets are for axial grids only
  DicomSlice missing = dose("");
  for (const DicomSlice& d :
       {dose("7\\9\\11"), dose("0\\2"), dose("0\\2\\4\\6"), dose("0\\NaN\\4"), coronal, missing}) {
    const Scan s = scanOf(d);
    SCOPED_TRACE(d.set[1].second);
    ASSERT_TRUE(s.finding("grid-frame-offsets"));
    EXPECT_FALSE(s.stack().volume3d);
    EXPECT_FALSE(s.instance().plane);
    EXPECT_EQ(s.stack().slices.size(), 3u) << "browsed";
    EXPECT_EQ(s.instance().unit, "Gy") << "values stay right";
  }
}

TEST(Dose, OneFrameNeedsNoVector) {
  const Scan s = scanOf(dose("", 1));
  EXPECT_EQ(s.stack().shape, StackShape::Single);
  EXPECT_FALSE(s.finding("grid-frame-offsets"));
}

TEST(Dose, ScalingThatCannotBeShowsStoredValues) {
  for (const char* scaling : {"0", "NaN", ""}) {
    DicomSlice d = dose("0\\2\\4");
    d.set[2].second = scaling;
    const Scan s = scanOf(d);
    EXPECT_TRUE(s.instance().rescaleInvalid) << scaling;
    EXPECT_TRUE(s.instance().frame(1).rescaleInvalid) << scaling;
    EXPECT_EQ(s.instance().unit, "stored value");
  }
}

TEST(Dose, RelativeUnitsAreNoGray) {
  DicomSlice d = dose("0\\2\\4");
  d.set[0].second = "RELATIVE";
  EXPECT_EQ(scanOf(d).instance().frame(2).unit, "relative dose");
}

TEST(Dose, FramesDecodeToTheirValues) {
  for (const char* syntax :
       {"1.2.840.10008.1.2.1", "1.2.840.10008.1.2.2", "1.2.840.10008.1.2.5", "1.2.840.10008.1.2.1.99"}) {
    DicomSlice d = dose("0\\2.5\\5");
    d.transferSyntaxUid = syntax;
    const Scan s = scanOf(d);
    SCOPED_TRACE(syntax);
    if (std::string(syntax) == "1.2.840.10008.1.2.2") {
      // DCMTK writes 32-bit words as pairs of swapped 16-bit words; ours are what the standard says.
      EXPECT_TRUE(s.stack().volume3d);
      continue;
    }
    std::vector<std::uint32_t> v(3 * 16);
    std::vector<SliceFailure> failed;
    ASSERT_TRUE(decodeStack(s.set, s.stack(), SampleType::U32, std::as_writable_bytes(std::span(v)), failed));
    EXPECT_TRUE(failed.empty());
    EXPECT_EQ(v[2 * 16 + 3], 200000u + 35u);
  }
}

DicomSlice nuclear(int frames) {
  DicomSlice d;
  d.sopClassUid = "1.2.840.10008.5.1.4.1.1.20";
  d.modality = "NM";
  d.frames = frames;
  d.isSigned = false;
  d.set = {{"0018,0088", "-4"}};
  return d;
}

TEST(Nuclear, ReconstructedSlicesLieAlongTheNormal) {
  DicomSlice d = nuclear(3);
  d.set.push_back({"0028,0009", "(0054,0080)"});
  d.set.push_back({"0054,0080", "3\\1\\2"});
  const Scan s = scanOf(d);
  EXPECT_TRUE(s.stack().volume3d);
  EXPECT_DOUBLE_EQ(s.stack().step_mm, 4);
  EXPECT_EQ(s.instance().frame(0).plane->origin, PatientPoint(0, 0, -8));
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{0, 2, 1}));
}

TEST(Nuclear, GatesOfAVolumeAreStacksAndViewsOfADetectorACine) {
  DicomSlice d = nuclear(4);
  d.set.push_back({"0028,0009", "(0054,0070)\\(0054,0080)"});
  d.set.push_back({"0054,0070", "1\\1\\2\\2"});
  d.set.push_back({"0054,0080", "1\\2\\1\\2"});
  const Scan gated = scanOf(d);
  ASSERT_EQ(gated.series().stacks.size(), 2u);
  EXPECT_TRUE(gated.stack(1).volume3d);
  EXPECT_EQ(gated.stack(1).label, "grid vectors time slot 2");

  DicomSlice planar = nuclear(4);
  planar.set.push_back({"0028,0009", "(0054,0020)\\(0054,0100)"});
  planar.set.push_back({"0054,0020", "1\\1\\2\\2"});
  planar.set.push_back({"0054,0100", "1\\2\\1\\2"});
  const Scan dynamic = scanOf(planar);
  ASSERT_EQ(dynamic.series().stacks.size(), 2u);
  EXPECT_EQ(dynamic.order(1), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_FALSE(dynamic.stack(0).volume3d);
}

TEST(Nuclear, VectorsOfAnotherLengthOrNotPointedAtAreNotBelieved) {
  DicomSlice d = nuclear(3);
  d.set.push_back({"0054,0080", "1\\2\\3"});  // not in Frame Increment Pointer
  EXPECT_FALSE(scanOf(d).stack().volume3d);
  d.set.push_back({"0028,0009", "(0054,0080)"});
  d.set[1].second = "1\\2";
  const Scan s = scanOf(d);
  EXPECT_FALSE(s.stack().volume3d);
  EXPECT_EQ(s.stack().slices.size(), 3u);
}

TEST(Cine, FrameTimes) {
  DicomSlice d;
  d.sopClassUid = "1.2.840.10008.5.1.4.1.1.3.1";
  d.modality = "US";
  d.frames = 4;
  d.bitsAllocated = d.bitsStored = 8;
  d.isSigned = false;
  d.set = {{"0028,0009", "(0018,1063)"}, {"0018,1063", "40"}, {"0018,1065", "0\\10\\20\\30"}};
  EXPECT_EQ(scanOf(d).instance().frameTimes_ms, (std::vector<double>{0, 40, 80, 120}));
  d.set[0].second = "(0018,1065)";
  EXPECT_EQ(scanOf(d).instance().frameTimes_ms, (std::vector<double>{0, 10, 30, 60}));
  d.set[2].second = "0\\10\\-20\\30";
  EXPECT_TRUE(scanOf(d).instance().frameTimes_ms.empty());
}

}  // namespace
}  // namespace vernier
