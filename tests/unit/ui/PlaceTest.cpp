// SPDX-License-Identifier: GPL-3.0-or-later
#include "Place.h"

#include <gtest/gtest.h>

#include "Facts.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

const View kView{400, 300, false};

TEST(Place, StackAndAxialSliceAgreeOnThePatient) {
  const GridGeometry g = test::axialGrid();
  const SourceFacts facts = test::axialFacts(0, "a");
  const Place stack = *placeOf(stackScene("a", 10, {}), facts, &g, kView);
  const Place axial = *placeOf(*presetScene("axial", "a", g, {}), facts, &g, kView);
  ASSERT_TRUE(stack.inPatient);
  for (const glm::dvec2 px : {glm::dvec2(0, 0), glm::dvec2(123, 45), glm::dvec2(400, 300)}) {
    EXPECT_NEAR(length(stack.patientAt(px) - axial.patientAt(px)), 0, 1e-6);
    EXPECT_NEAR(glm::length(stack.pixelOf(stack.patientAt(px)) - px), 0, 1e-9);
  }
  EXPECT_NEAR(dot(stack.normal, axial.normal), 1, 1e-12);  // both seen from the feet
}

TEST(Place, ACoronalPlaneCutsTheAxialPictureWhereItLies) {
  const GridGeometry g = test::axialGrid();
  const SourceFacts facts = test::axialFacts(0, "a");
  const Place axial = *placeOf(*presetScene("axial", "a", g, {}), facts, &g, kView);
  PresetOptions at;
  at.slice = 13;
  const Place coronal = *placeOf(*presetScene("coronal", "a", g, at), facts, &g, kView);
  const auto line = crossing(axial, coronal, kView);
  ASSERT_TRUE(line);
  EXPECT_NEAR(axial.patientAt(line->a).p.y, -12 + 0.5 * 13, 1e-9);
  EXPECT_NEAR(axial.patientAt(line->b).p.y, -12 + 0.5 * 13, 1e-9);
  EXPECT_NEAR(std::abs(line->a.x - line->b.x), 400, 1e-9);  // from edge to edge
  EXPECT_FALSE(crossing(axial, axial, kView));
}

TEST(Place, WithoutSpacingThereIsNoPatient) {
  SourceFacts facts = test::axialFacts(0, "a");
  for (ImageFrameInfo& f : facts.frames) f.pixelSpacing_mm = {0, 0};
  const Place p = *placeOf(stackScene("a", 0, {}), facts, nullptr, kView);
  EXPECT_FALSE(p.inPatient);
  EXPECT_FALSE(crossing(p, p, kView));
}

std::shared_ptr<const ImageFrame> ramp() {
  ImageFrameInfo info = test::axialFacts(0, "a").frames[3];
  info.type = VoxelType::I16;
  info.rescale = {2, -1024};
  info.unit = "HU";
  info.noData = NoDataRange{7, 7};
  Buffer pixels = std::move(*Buffer::make(64 * 48 * 2));
  auto* v = reinterpret_cast<std::int16_t*>(pixels.data());
  for (int n = 0; n < 64 * 48; ++n) v[n] = static_cast<std::int16_t>(n);
  return *ImageFrame::make(info, std::move(pixels));
}

TEST(Place, ProbeOfAnImageIsTheStoredPixel) {
  const SourceFacts facts = test::axialFacts(0, "a");
  const auto frame = ramp();
  const Place p = *placeOf(stackScene("a", 3, {}), facts, nullptr, kView);
  // Column 20, row 5: stored 5 * 64 + 20 = 340, 2 * 340 - 1024 = -344 HU.
  const glm::dvec2 px(p.image->x0 + 20.5 * p.image->pxPerColumn, p.image->y0 + 5.5 * p.image->pxPerRow);
  const Probe probe = probeImage(p, *frame, facts, px);
  EXPECT_EQ(probe.value, "-344 HU");
  EXPECT_EQ(probe.origin, "stored 340 \xC3\x97 2 \xE2\x88\x92 1024, slice3.dcm, row 5, column 20");
  EXPECT_EQ(probe.place, "R 6.0  A 9.5  H 16.0 mm");
  const glm::dvec2 padded(p.image->x0 + 7.5 * p.image->pxPerColumn, p.image->y0 + 0.5 * p.image->pxPerRow);
  EXPECT_EQ(probeImage(p, *frame, facts, padded).value, "no data (padding)");
  EXPECT_EQ(probeImage(p, *frame, facts, {-1000, 0}).value, "");
}

}  // namespace
}  // namespace vernier::ui
