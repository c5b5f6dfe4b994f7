// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "HandMadeStudy.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {
using test::countingSlices;
using test::HandMadeStudy;

Result<std::shared_ptr<const ImageFrame>> build(HandMadeStudy& s, std::size_t n) {
  return buildImageFrame(s.set, s.series(), s.stack(), n);
}

TEST(BuildFrame, StoredPixelsInTheFilesOwnDirections) {
  HandMadeStudy s;
  auto slices = countingSlices(3);
  for (auto& d : slices) d.slope = 2, d.intercept = -10, d.spacing = {0.75, 0.5};
  makeStudy(s, slices);
  s.instance(1).patientOrientation = "L\\P";
  const auto f = build(s, 1);
  ASSERT_TRUE(f.ok()) << f.error().text();
  const ImageFrameInfo& i = (*f)->info();
  for (int p = 0; p < 6; ++p) {
    EXPECT_EQ((*f)->stored(p % 3, p / 3), 100 + p);
    EXPECT_EQ((*f)->modality(p % 3, p / 3), 2 * (100 + p) - 10);
  }
  EXPECT_EQ(i.index, 1);
  EXPECT_EQ(i.count, 3);
  EXPECT_EQ(i.pixelSpacing_mm, glm::dvec2(0.75, 0.5));
  EXPECT_EQ(i.plane->origin, PatientPoint(0, 0, 2));
  EXPECT_EQ(i.patientOrientation, "L\\P");
  EXPECT_EQ(i.unit, "HU");
  EXPECT_EQ(i.type, VoxelType::I16);
}

TEST(BuildFrame, NeedsNoGeometry) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  s.stack().shape = StackShape::NoGeometry;
  s.stack().volume3d = false;
  s.stack().grid = GridGeometry{};
  s.instance(1).plane.reset();
  const auto f = build(s, 1);
  ASSERT_TRUE(f.ok()) << f.error().text();
  EXPECT_FALSE((*f)->info().plane);
  EXPECT_EQ((*f)->stored(0, 0), 100);
}

TEST(BuildFrame, OneWindowForAStackButOneEachForRadiographs) {
  for (const char* modality : {"CT", "DX"}) {
    HandMadeStudy s;
    auto slices = countingSlices(3);
    for (auto& d : slices) d.modality = modality;
    makeStudy(s, slices);
    for (std::size_t n = 0; n < 3; ++n) s.instance(n).windows = {{double(n), 10, VoiFunction::Linear, ""}};
    EXPECT_EQ((*build(s, 0))->info().windows[0].center, modality == std::string("CT") ? 1 : 0);
  }
}

TEST(BuildFrame, AutomaticWindowIsTheStacksWhenTheFileHasNone) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(4));
  for (std::size_t n = 0; n < 4; ++n) s.instance(n).paddingFirst = s.instance(n).paddingLast = 0;
  const VoiWindow a = (*build(s, 0))->info().autoWindow, b = (*build(s, 3))->info().autoWindow;
  EXPECT_EQ(a, b);
  EXPECT_EQ(a.center - a.width / 2, 1);
  EXPECT_EQ(a.center + a.width / 2, 305);
  const auto given =
      buildImageFrame(s.set, s.series(), s.stack(), 2, VoiWindow{7, 8, VoiFunction::Sigmoid, ""});
  EXPECT_EQ((*given)->info().autoWindow.center, 7);
  for (std::size_t n = 0; n < 4; ++n) s.instance(n).windows = {{1, 10, VoiFunction::Linear, ""}};
  const VoiWindow own = (*build(s, 3))->info().autoWindow;
  EXPECT_EQ(own.center - own.width / 2, 300);
}

TEST(BuildFrame, ModalityLutAndItsWindow) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(1));
  s.instance(0).modalityLut = LutTable{0, 16, {9, 8, 7, 6, 5, 4}, ""};
  const auto f = build(s, 0);
  ASSERT_TRUE(f.ok());
  EXPECT_EQ((*f)->modality(1, 0), 8);
  const VoiWindow w = (*f)->info().autoWindow;
  EXPECT_EQ(w.center - w.width / 2, 4);
  EXPECT_EQ(w.center + w.width / 2, 9);
}

TEST(BuildFrame, FramesOfOneObject) {
  HandMadeStudy s;
  test::DicomSlice d;
  d.rows = d.columns = 2;
  d.frames = 3;
  d.pixels = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  makeStudy(s, {d});
  s.stack().slices = {{0, 0}, {0, 1}, {0, 2}};
  s.stack().grid.slices = 3;
  const auto f = build(s, 2);
  ASSERT_TRUE(f.ok()) << f.error().text();
  EXPECT_EQ((*f)->stored(0, 0), 9);
  EXPECT_EQ((*f)->info().plane->origin, PatientPoint(0, 0, 4));
}

// Blurred padding around a lossy CT: out of the automatic window, but the frame shows the pixels of the file.
TEST(BuildFrame, BlurredPaddingIsOutOfTheWindowOnly) {
  HandMadeStudy s;
  test::DicomSlice d;
  d.rows = d.columns = 3;
  d.pixels = {-2000, -1990, -2000, -1500, 40, -1300, -2001, -2000, -1999};
  makeStudy(s, {d});
  s.instance(0).lossy = true;
  s.instance(0).windows = {{1, 10, VoiFunction::Linear, ""}};
  const auto f = build(s, 0);
  ASSERT_TRUE(f.ok());
  EXPECT_EQ((*f)->stored(1, 0), -1990);
  EXPECT_EQ((*f)->info().autoWindow.center, 40);
  s.instance(0).lossy = false;
  EXPECT_LT((*build(s, 0))->info().autoWindow.center, 0);
}

// The window of the whole stack leaves it out too.
TEST(BuildFrame, BlurredPaddingIsOutOfTheWindowOfAStack) {
  HandMadeStudy s;
  test::DicomSlice d;
  d.rows = d.columns = 3;
  d.pixels = {-2000, -1990, -2000, -1500, 40, -1300, -2001, -2000, -1999};
  makeStudy(s, {d, d});
  for (std::size_t n = 0; n < 2; ++n) s.instance(n).lossy = true;
  EXPECT_EQ((*build(s, 0))->info().autoWindow.center, 40);
  for (std::size_t n = 0; n < 2; ++n) s.instance(n).lossy = false;
  EXPECT_LT((*build(s, 0))->info().autoWindow.center, 0);
}

// Unsigned pixels with intercept -1024: the lowest value is air of -1024 HU, which is no padding as long as
// nothing was blurred.
TEST(BuildFrame, AirOfALossyCtIsNoPadding) {
  HandMadeStudy s;
  test::DicomSlice d;
  d.rows = d.columns = 2;
  d.isSigned = false;
  d.intercept = -1024;
  d.pixels = {0, 0, 0, 1064};
  makeStudy(s, {d});
  s.instance(0).lossy = true;
  s.instance(0).windows = {{1, 10, VoiFunction::Linear, ""}};
  const VoiWindow w = (*build(s, 0))->info().autoWindow;
  EXPECT_EQ(w.center, -492);
  EXPECT_EQ(w.width, 1064);
}

TEST(BuildFrame, RefusesWithASentence) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  EXPECT_EQ(build(s, 2).error().code, ErrorCode::OptionInvalid);
  s.instance(1).pixelError = makeError(ErrorCode::CodecUnsupported, "No.");
  EXPECT_EQ(build(s, 1).error().code, ErrorCode::CodecUnsupported);
  std::filesystem::resize_file(s.file(0), s.set.files[0].bytes - 6);
  EXPECT_EQ(build(s, 0).error().code, ErrorCode::PixelDataShort);
}

}  // namespace
}  // namespace vernier
