// SPDX-License-Identifier: GPL-3.0-or-later
#include "LensOptions.h"

#include <gtest/gtest.h>

namespace vernier::app {
namespace {

TEST(LensOptions, ShapesAreReadInMillimetres) {
  EXPECT_EQ(*parseLensShape("sphere:1,-2,3.5,20"), LensShape(SphereShape{MeshPoint(1, -2, 3.5), 20, 3}));
  EXPECT_EQ(*parseLensShape("box:1,2,3,10,20,30"), LensShape(BoxShape{MeshPoint(1, 2, 3), {10, 20, 30}}));
  EXPECT_EQ(*parseLensShape("cone:0,0,0,1,2,30,8"),
            LensShape(ConeShape{MeshPoint(0, 0, 0), MeshPoint(1, 2, 30), 8, 8, 48}));
  EXPECT_EQ(*parseLensShape("cone:0,0,0,1,2,30,8,0"),
            LensShape(ConeShape{MeshPoint(0, 0, 0), MeshPoint(1, 2, 30), 8, 0, 48}));
}

TEST(LensOptions, WhatIsNoShapeIsRefusedWithTheForms) {
  for (const char* bad :
       {"", "sphere", "sphere:", "sphere:1,2,3", "sphere:1,2,3,4,5", "sphere:1,2,x,4", "sphere:1,2,3,0",
        "sphere:1,2,3,-4", "sphere:nan,0,0,1", "box:1,2,3,4,5", "box:0,0,0,1,1,0", "cone:0,0,0,0,0,1",
        "cone:0,0,0,0,0,1,-1", "ball:0,0,0,1", "Sphere:0,0,0,1", "sphere:1;2;3;4", "none.txt"}) {
    const Result<LensShape> r = parseLensShape(bad);
    ASSERT_FALSE(r.ok()) << bad;
    EXPECT_EQ(r.error().code, ErrorCode::OptionInvalid);
    EXPECT_EQ(r.error().where, "--lens");
  }
}

TEST(LensOptions, InnersBelongToWhatIsBehind) {
  VolumeLayer volume;
  volume.source = "v";
  const Layer through = volume, slice = SliceLayer{};
  EXPECT_TRUE(std::holds_alternative<CutOut>(*parseLensInner("cut-out", through, "HU")));
  EXPECT_TRUE(std::holds_alternative<CutOut>(*parseLensInner("cut-out", slice, "HU")));
  EXPECT_EQ(std::get<ProjectionLayer>(*parseLensInner("mip", through, "HU")).source, "v");
  EXPECT_EQ(std::get<ProjectionLayer>(*parseLensInner("window:40,400", through, "HU")).window->width, 400);
  EXPECT_FALSE(std::get<IsosurfaceLayer>(*parseLensInner("iso", through, "HU")).level);
  EXPECT_EQ(std::get<IsosurfaceLayer>(*parseLensInner("iso:250.5", through, "HU")).level, 250.5);
  EXPECT_EQ(std::get<VolumeLayer>(*parseLensInner("ct-bone", through, "HU")).preset, "ct-bone");
  EXPECT_EQ(std::get<SliceLook>(*parseLensInner("bone", slice, "HU")).window->center, 400);
  EXPECT_EQ(std::get<SliceLook>(*parseLensInner("window:10,20", slice, "")).window->center, 10);
  EXPECT_TRUE(std::get<SliceLook>(*parseLensInner("invert", slice, "")).invert);
  for (const char* bad : {"", "bone", "invert", "iso:", "iso:x", "isosurface", "window:1", "ct_bone"}) {
    const Result<LensInner> r = parseLensInner(bad, through, "HU");
    ASSERT_FALSE(r.ok()) << bad;
    EXPECT_EQ(r.error().where, "--lens-inner");
  }
  for (const char* bad : {"mip", "iso", "ct-bone", "window:1,0"})
    EXPECT_FALSE(parseLensInner(bad, slice, "HU").ok()) << bad;
  EXPECT_FALSE(parseLensInner("bone", slice, "MR").ok());  // a window for HU only
}

}  // namespace
}  // namespace vernier::app
