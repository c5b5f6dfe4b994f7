// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Describe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "vernier/plan/Presets.h"

namespace vernier {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Not;

VolumeInfo headOf(std::int64_t slices, double step_mm) {
  VolumeInfo info;
  info.grid.columns = info.grid.rows = 64;
  info.grid.slices = slices;
  info.grid.patientFromVoxel.linear[2] = {0, 0, step_mm};
  info.unit = "HU";
  return info;
}
std::vector<std::string> texts(const std::vector<TextLine>& lines) {
  std::vector<std::string> out;
  for (const TextLine& l : lines) out.push_back(l.text);
  return out;
}
Annotations described(const VolumeInfo& info, const std::string& view, PresetOptions options = {}) {
  const Scene scene = *presetScene(view, "v", info.grid, options);
  const auto& layer = std::get<SliceLayer>(scene.layers[0]);
  const auto picture = slicePicture(layer, scene.camera, {256, 256, false}, info.grid);
  return describeSlice(layer, *picture, info, {40, 400, VoiFunction::Linear, ""});
}

TEST(Describe, SaysPlaneNumberWindowAndLetters) {
  const Annotations a = described(headOf(28, 1), "axial");
  EXPECT_THAT(texts(a.what), ElementsAre("MPR axial 15/28"));
  EXPECT_THAT(texts(a.status), ElementsAre("C 40 W 400 HU"));
  EXPECT_EQ(a.letters, (EdgeLetters{"R", "L", "A", "P"}));
  EXPECT_DOUBLE_EQ(a.mmPerPixel, 0.25);
  VolumeInfo mr = headOf(28, 1);
  mr.unit = "SIGNAL INTENSITY (UNITLESS)";
  EXPECT_THAT(texts(described(mr, "axial").status), ElementsAre("C 40 W 400")) << "too long for a picture";
  PresetOptions options;
  options.slice = 0;
  EXPECT_EQ(described(headOf(28, 1), "coronal", options).what[0].text, "MPR coronal 1/64");
  EXPECT_EQ(described(headOf(28, 1), "oblique").what[0].text, "MPR");
}

TEST(Describe, SlabsSayTheirModeAndThickness) {
  PresetOptions options;
  for (auto [mode, name] : {std::pair{SlabMode::Max, "MIP 7.5 mm axial 15/28"},
                            {SlabMode::Min, "minIP 7.5 mm axial 15/28"},
                            {SlabMode::Mean, "mean 7.5 mm axial 15/28"}}) {
    options.slab = Slab{7.5, mode};
    EXPECT_EQ(described(headOf(28, 1), "axial", options).what[0].text, name);
  }
  EXPECT_EQ(described(headOf(28, 1), "slab").what[0].text, "MIP 10 mm");
}

TEST(Describe, CoarseInZOnlyAcrossTheSlices) {
  EXPECT_THAT(texts(described(headOf(28, 5), "axial").what), Not(Contains("coarse in z")));
  EXPECT_THAT(texts(described(headOf(28, 5), "coronal").what), Contains("coarse in z"));
  EXPECT_THAT(texts(described(headOf(28, 5), "oblique").what), Contains("coarse in z"));
  EXPECT_THAT(texts(described(headOf(28, 3), "coronal").what), Not(Contains("coarse in z")));
  PresetOptions slab;
  slab.slab = Slab{10, SlabMode::Mean};
  EXPECT_THAT(texts(described(headOf(28, 5), "axial", slab).what), Contains("coarse in z"));
}

TEST(Describe, GapsTiltAndUnevenSlices) {
  VolumeInfo gap = headOf(4, 5);
  gap.grid.patientFromVoxel.translation = {0, 0, 23.1};
  gap.grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}, {0, 0, 4}};
  gap.grid.gapAfter = {1};
  EXPECT_THAT(texts(described(gap, "coronal").what), Contains("slice missing at 28.1..38.1 mm"));
  gap.bridged = true;
  EXPECT_THAT(texts(described(gap, "coronal").what), Contains("bridged"));
  EXPECT_THAT(texts(described(gap, "coronal").what), Not(Contains("slice missing at 28.1..38.1 mm")));

  VolumeInfo tilted = headOf(28, 1);
  tilted.grid.patientFromVoxel.linear[2] = {0, std::tan(14 * 3.14159265358979 / 180), 1};
  tilted.modality = "CT";
  EXPECT_THAT(texts(described(tilted, "coronal").what), Contains("gantry tilt 14.0 deg"));
  tilted.modality = "MR";
  EXPECT_THAT(texts(described(tilted, "coronal").what), Contains("slices sheared 14.0 deg"));
  EXPECT_THAT(texts(described(headOf(28, 1), "coronal").what), ElementsAre("MPR coronal 33/64"));

  VolumeInfo uneven = headOf(3, 1);
  uneven.grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1.2}, {0, 0, 2}};
  EXPECT_THAT(texts(described(uneven, "coronal").what), Contains("uneven slices, up to 0.20 mm"));
  uneven.grid.sliceOrigin_vox[1] = {0, 0, 1.01};
  EXPECT_THAT(texts(described(uneven, "coronal").what), ElementsAre("MPR coronal 33/64")) << "harmless";

  gap.bridged = false;
  EXPECT_EQ(texts(described(gap, "axial").what).size(), 2u) << "a gap alone is not uneven";
  gap.grid.sliceOrigin_vox[3].z += 0.2;
  EXPECT_THAT(texts(described(gap, "axial").what), Contains("uneven slices, up to 1.00 mm"));
}

TEST(Describe, ImageFrames) {
  ImageFrameInfo info;
  info.columns = info.rows = 16;
  info.index = 11, info.count = 28;
  info.plane = FramePlane{{}, PatientVec(1, 0, 0), PatientVec(0, 1, 0)};
  info.voiLuts = {{0, 8, {}, "BONE"}};
  ImageLayer layer;
  const VoiWindow window{0.5, 2.25e-3, VoiFunction::Linear, ""};
  Annotations a = describeImage(layer, imagePicture(layer, {}, {64, 64, false}, info), info, window);
  EXPECT_EQ(a.what[0].text, "12/28");
  EXPECT_EQ(a.mmPerPixel, 0) << "no spacing, no millimetres";
  EXPECT_FALSE(a.flipped);
  EXPECT_EQ(a.status[0].text, "C 0.5 W 0.00225");
  layer.flipVertical = true;
  layer.voiLut = 0;
  a = describeImage(layer, imagePicture(layer, {}, {64, 64, false}, info), info, window);
  EXPECT_TRUE(a.flipped);
  EXPECT_EQ(a.letters, (EdgeLetters{"R", "L", "P", "A"}));
  EXPECT_EQ(a.status[0].text, "LUT BONE");
  layer.flipHorizontal = true;
  a = describeImage(layer, imagePicture(layer, {}, {64, 64, false}, info), info, window);
  EXPECT_FALSE(a.flipped) << "turned by 180 degrees, not mirrored";
  EXPECT_EQ(a.letters, (EdgeLetters{"L", "R", "P", "A"}));
  info.unscaled = true;
  EXPECT_EQ(describeImage(layer, {}, info, window).what[1].text, "unscaled: stored values");
}

TEST(Describe, QuadrupedsHaveNoLettersAndSaySo) {
  VolumeInfo dog = headOf(28, 1);
  dog.findings = {{"quadruped", Severity::Warning, "", {}}};
  const Annotations slice = described(dog, "axial");
  EXPECT_EQ(slice.letters, EdgeLetters{});
  EXPECT_THAT(texts(slice.what), Contains("quadruped: no letters"));

  ImageFrameInfo frame;
  frame.columns = frame.rows = 4;
  frame.plane = FramePlane{{}, PatientVec(1, 0, 0), PatientVec(0, 1, 0)};
  const VoiWindow window{40, 400, VoiFunction::Linear, ""};
  EXPECT_EQ(describeImage({}, {}, frame, window).letters, (EdgeLetters{"R", "L", "A", "P"}));
  frame.findings = dog.findings;
  const Annotations image = describeImage({}, {}, frame, window);
  EXPECT_EQ(image.letters, EdgeLetters{});
  EXPECT_THAT(texts(image.what), Contains("quadruped: no letters"));
}

TEST(Describe, ErrorsAreRoundedUp) {
  EXPECT_EQ(errorLine(0.3101, 99).text, "error <= 0.32 of 255 (99 %)");
  EXPECT_EQ(errorLine(0.31, 99).text, "error <= 0.31 of 255 (99 %)");
  EXPECT_EQ(errorLine(0, 99).text, "error <= 0 of 255 (99 %)");
  EXPECT_EQ(errorLine(9.91, 99).shortText, "<= 10/255");
  EXPECT_EQ(errorLine(123.4, 95).text, "error <= 130 of 255 (95 %)");
  EXPECT_EQ(errorLine(1e-5, 99).text, "error < 0.01 of 255 (99 %)");
  EXPECT_EQ(errorLine(0.6, 99, 0.5).tone, Tone::Amber);
  EXPECT_EQ(errorLine(0.5, 99, 0.5).tone, Tone::Normal);
}

}  // namespace
}  // namespace vernier
