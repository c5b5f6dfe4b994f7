// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of stored pixels, colour frames and colour volumes. The equations of PS3.3 C.7.6.3.1.2 are typed
// here once more, in the direction in which the standard has them.
#include "vernier/volume/Colour.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "HandMadeStudy.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {

using test::DicomSlice;
using test::TempDir;

std::array<double, 3> ybrFull(glm::dvec3 c) {  // of 0..255
  return {.2990 * c.x + .5870 * c.y + .1140 * c.z, -.1687 * c.x - .3313 * c.y + .5 * c.z + 128,
          .5 * c.x - .4187 * c.y - .0813 * c.z + 128};
}
std::array<double, 3> ybrPartial(glm::dvec3 c) {
  return {.2568 * c.x + .5041 * c.y + .0979 * c.z + 16, -.1482 * c.x - .2910 * c.y + .4392 * c.z + 128,
          .4392 * c.x - .3678 * c.y - .0714 * c.z + 128};
}

TEST(Colour, YbrIsUndone) {
  std::mt19937 random(4);
  for (int n = 0; n < 1000; ++n) {
    const glm::dvec3 c(random() % 256, random() % 256, random() % 256);
    const glm::dvec3 full = 255.0 * rgbOf(ColourSpace::YbrFull, ybrFull(c), 8);
    const glm::dvec3 partial = 255.0 * rgbOf(ColourSpace::YbrPartial, ybrPartial(c), 8);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(full[k], c[k], 0.06);  // the standard's coefficients have four digits
      EXPECT_NEAR(partial[k], c[k], 0.15);
    }
  }
  EXPECT_EQ(rgbOf(ColourSpace::YbrFull, {255, 255, 255}, 8),
            glm::dvec3(1, rgbOf(ColourSpace::YbrFull, {255, 255, 255}, 8).y, 1));
  EXPECT_EQ(rgbOf(ColourSpace::YbrPartial, {0, 128, 128}, 8), glm::dvec3(0));  // below black
}

TEST(Colour, FullScaleIsThatOfTheStoredBits) {
  EXPECT_EQ(rgbOf(ColourSpace::Rgb, {65535, 0, 32768}, 16).x, 1);
  EXPECT_DOUBLE_EQ(rgbOf(ColourSpace::Rgb, {65535, 0, 32768}, 16).z, 32768 / 65535.0);
  EXPECT_DOUBLE_EQ(rgbOf(ColourSpace::Rgb, {1023, 511, 0}, 10).y, 511 / 1023.0);
  // Grey of 16 bits stays grey.
  const glm::dvec3 grey = rgbOf(ColourSpace::YbrFull, {40000, 32768, 32768}, 16);
  EXPECT_DOUBLE_EQ(grey.x, 40000 / 65535.0);
  EXPECT_EQ(grey.x, grey.z);
}

TEST(Colour, PalettesHoldTheirEnds) {
  Palette p;
  p.firstMapped = 3;
  p.fullScale = 255;
  p.entries = {{1, 2, 3}, {255, 0, 51}};
  EXPECT_EQ(rgbOf(ColourSpace::Palette, {0, 0, 0}, 8, &p), rgbOf(ColourSpace::Palette, {3, 0, 0}, 8, &p));
  EXPECT_EQ(rgbOf(ColourSpace::Palette, {200, 0, 0}, 8, &p), glm::dvec3(1, 0, 0.2));
}

DicomSlice colourSlice(const std::string& photometric, std::vector<std::int64_t> pixels, int bits = 8) {
  DicomSlice s;
  s.rows = 2;
  s.columns = 2;
  s.samplesPerPixel = 3;
  s.bitsAllocated = s.bitsStored = bits;
  s.isSigned = false;
  s.photometric = photometric;
  s.sopClassUid = "1.2.840.10008.5.1.4.1.1.7";
  s.modality = "OT";
  s.pixels = std::move(pixels);
  return s;
}

std::shared_ptr<const ImageFrame> frameOf(const DicomSlice& s) {
  const TempDir dir;
  writeDicom(dir.path() / "a.dcm", s);
  const auto set = scanStudy({dir.path().string()});
  if (!set || set->series.empty() || set->series[0].stacks.empty()) {
    ADD_FAILURE() << "no stack";
    return nullptr;
  }
  const auto frame = buildImageFrame(*set, set->series[0], set->series[0].stacks[0], 0);
  EXPECT_TRUE(frame.ok()) << (frame.ok() ? "" : frame.error().text());
  return frame ? *frame : nullptr;
}

bool contradicted(const ImageFrame& f) {
  for (const Finding& finding : f.info().findings)
    if (finding.code == "photometric-contradicted") return true;
  return false;
}

TEST(ColourFrame, StoredSamplesAreExactAndColoursFollow) {
  const auto f = frameOf(colourSlice("RGB", {255, 0, 0, 0, 255, 0, 0, 0, 255, 1, 2, 3}));
  ASSERT_TRUE(f);
  EXPECT_TRUE(f->isColour());
  EXPECT_EQ(f->stored(1, 1, 0), 1);
  EXPECT_EQ(f->stored(1, 1, 1), 2);
  EXPECT_EQ(f->stored(1, 1, 2), 3);
  EXPECT_EQ(f->rgb(0, 1), glm::dvec3(0, 0, 1));
  EXPECT_FALSE(contradicted(*f));
  const auto deep = frameOf(colourSlice("RGB", {65535, 0, 300, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 16));
  ASSERT_TRUE(deep);
  EXPECT_EQ(deep->stored(0, 0, 2), 300);
  EXPECT_DOUBLE_EQ(deep->rgb(0, 0).z, 300 / 65535.0);
  const auto ybr = frameOf(colourSlice("YBR_FULL", {76, 85, 255, 0, 128, 128, 255, 128, 128, 128, 128, 128}));
  ASSERT_TRUE(ybr);
  EXPECT_NEAR(ybr->rgb(0, 0).x, (76 + 1.402 * 127) / 255, 1e-9);
  EXPECT_NEAR(ybr->rgb(0, 0).y, 0, 0.003);
  EXPECT_EQ(ybr->stored(0, 0, 0), 76);
}

TEST(ColourFrame, UncompressedPixelsOfAJpeg2000NameAreRgb) {
  const auto f = frameOf(colourSlice("YBR_RCT", {255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(f);
  EXPECT_EQ(f->rgb(0, 0), glm::dvec3(1, 0, 0));
  EXPECT_TRUE(contradicted(*f));
}

TEST(ColourFrame, MakeChecksItsSize) {
  ImageFrameInfo info;
  info.columns = 2;
  info.rows = 2;
  info.type = VoxelType::U8;
  info.colour = ColourSpace::Rgb;
  EXPECT_EQ(ImageFrame::make(info, *Buffer::make(4)).error().code, ErrorCode::PixelDataShort);
  EXPECT_TRUE(ImageFrame::make(info, *Buffer::make(12)).ok());
  info.colour = ColourSpace::Palette;
  EXPECT_EQ(ImageFrame::make(info, *Buffer::make(4)).error().code, ErrorCode::PixelDescriptionInvalid);
}

VolumeInfo grid(std::int64_t columns, std::int64_t rows, std::int64_t slices) {
  VolumeInfo info;
  info.grid.columns = columns;
  info.grid.rows = rows;
  info.grid.slices = slices;
  return info;
}

// Red rises along columns, green along rows, blue along slices, alpha falls along columns.
std::vector<std::byte> ramps(std::int64_t n, int samples) {
  std::vector<std::byte> bytes;
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i) {
        const std::int64_t v[4] = {10 * i, 20 * j, 30 * k, 255 - 5 * i};
        for (int s = 0; s < samples; ++s) bytes.push_back(static_cast<std::byte>(v[s]));
      }
  return bytes;
}

TEST(ColourVolume, HoldsItsChannelsExactly) {
  for (const int samples : {3, 4}) {
    const auto v = Volume::makeColour(grid(5, 5, 5), samples, ramps(5, samples));
    ASSERT_TRUE(v.ok()) << v.error().text();
    EXPECT_TRUE((*v)->isColour());
    EXPECT_EQ((*v)->info().channels, samples);
    EXPECT_EQ((*v)->bytes(), static_cast<std::size_t>(125 * samples));
    EXPECT_EQ((*v)->rgba(1, 2, 3),
              (std::array<std::uint8_t, 4>{10, 40, 90, static_cast<std::uint8_t>(samples == 4 ? 250 : 255)}));
    EXPECT_EQ((*v)->channel(1).stored(1, 2, 3), 40);
  }
}

TEST(ColourVolume, RefusesWhatDoesNotFit) {
  EXPECT_EQ(Volume::makeColour(grid(5, 5, 5), 2, ramps(5, 2)).error().code,
            ErrorCode::PixelDescriptionInvalid);
  EXPECT_EQ(Volume::makeColour(grid(5, 5, 6), 3, ramps(5, 3)).error().code, ErrorCode::PixelDataShort);
  auto short1 = ramps(5, 3);
  short1.push_back(std::byte{0});
  EXPECT_EQ(Volume::makeColour(grid(5, 5, 5), 3, short1).error().code, ErrorCode::PixelDataShort);
  VolumeInfo flat = grid(5, 5, 5);
  flat.grid.patientFromVoxel.linear[2] = {1, 0, 0};
  EXPECT_EQ(Volume::makeColour(flat, 3, ramps(5, 3)).error().code, ErrorCode::GeometryRefused);
}

TEST(ColourVolume, IsSampledChannelByChannel) {
  const auto v = *Volume::makeColour(grid(5, 5, 5), 4, ramps(5, 4));
  const auto c = sampleColour(*v, PatientPoint(1.25, 2.5, 3.75));
  ASSERT_TRUE(c);
  const double want[4] = {12.5, 50, 112.5, 255 - 6.25};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR((*c)[k], want[k], 1e-9);
  EXPECT_FALSE(sampleColour(*v, PatientPoint(7, 0, 0)));
  EXPECT_FALSE(sampleModality(*v, PatientPoint(1, 1, 1)));
  const auto probe = probeStored(*v, PatientPoint(1.2, 1.9, 3));
  ASSERT_TRUE(probe && probe->rgba);
  EXPECT_EQ(*probe->rgba, (std::array<std::uint8_t, 4>{10, 40, 90, 250}));
  EXPECT_TRUE(usableWindow(defaultWindow(*v)));
}

// n RGB slices; slice k is of colour (10 k, 20, 200 - k).
void colourSeries(const TempDir& dir, int n, const std::string& photometric = "RGB", int bits = 8) {
  for (int k = 0; k < n; ++k) {
    DicomSlice s = colourSlice(photometric, {}, bits);
    s.instanceNumber = k + 1;
    s.position = {0, 0, 2.0 * k};
    for (int p = 0; p < 4; ++p)
      for (const int v : {10 * k, 20, 200 - k}) s.pixels.push_back(v);
    writeDicom(dir.path() / (std::to_string(k) + ".dcm"), s);
  }
}

TEST(ColourVolume, IsBuiltFromAStack) {
  const TempDir dir;
  colourSeries(dir, 5);
  const auto set = scanStudy({dir.path().string()});
  ASSERT_TRUE(set.ok());
  const auto v = buildVolume(*set, set->series[0], set->series[0].stacks[0]);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->info().channels, 3);
  EXPECT_EQ((*v)->rgba(1, 0, 3), (std::array<std::uint8_t, 4>{30, 20, 197, 255}));
  EXPECT_EQ((*v)->info().unit, "colour");
}

TEST(ColourVolume, ADamagedSliceIsAGap) {
  const TempDir dir;
  colourSeries(dir, 5);
  auto set = scanStudy({dir.path().string()});
  ASSERT_TRUE(set.ok());
  const Stack& stack = set->series[0].stacks[0];
  const std::string path = set->files[set->instances[stack.slices[2].instance].file].path;
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 6);
  const auto v = buildVolume(*set, set->series[0], stack);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->grid().slices, 4);
  EXPECT_EQ((*v)->grid().gapAfter, (std::vector<std::int64_t>{1}));
  EXPECT_EQ((*v)->rgba(0, 0, 2)[0], 30);
  EXPECT_EQ((*v)->info().findings.back().code, "slices-not-decoded");
  EXPECT_FALSE(sampleColour(**v, PatientPoint(0, 0, 4)));
}

TEST(ColourVolume, ColoursOfSixteenBitsAreRefused) {
  const TempDir dir;
  colourSeries(dir, 3, "RGB", 16);
  const auto set = scanStudy({dir.path().string()});
  ASSERT_TRUE(set.ok());
  EXPECT_EQ(buildVolume(*set, set->series[0], set->series[0].stacks[0]).error().code, ErrorCode::NotBuiltYet);
}

}  // namespace
}  // namespace vernier
