// SPDX-License-Identifier: GPL-3.0-or-later
#include "ViewOptions.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "OptionChecks.h"
#include "TestData.h"

namespace vernier::app {
namespace {

TEST(ViewOptions, ReadsWhatTheHelpShows) {
  EXPECT_EQ(*parseSize("640x480"), glm::ivec2(640, 480));
  const Result<VoiWindow> w = parseWindow("40,400");
  EXPECT_EQ(w->center, 40);
  EXPECT_EQ(w->width, 400);
  const Result<Camera> c =
      parseCamera("azimuth=30,elevation=-20,projection=perspective,fov=40,zoom=2,roll=5");
  ASSERT_TRUE(c.ok());
  EXPECT_EQ(c->elevation_deg, -20);
  EXPECT_EQ(c->projection, Projection::Perspective);
  EXPECT_EQ(c->zoom, 2);
  const Result<Plane> p = parsePlane("point=1,2.5,-3,normal=0,0,1,up=0,-1,0");
  ASSERT_TRUE(p.ok());
  EXPECT_EQ(p->point, PatientPoint(1, 2.5, -3));
  EXPECT_EQ(p->normal, PatientVec(0, 0, 1));
  // Two points and an up vector: the plane that holds them, centred between them.
  const Result<Plane> q = parsePlane("from=0,0,10,to=8,6,10,up=0,0,1");
  ASSERT_TRUE(q.ok());
  EXPECT_EQ(q->point, PatientPoint(4, 3, 10));
  EXPECT_NEAR(q->normal.v.x, 0.6, 1e-15);
  EXPECT_NEAR(q->normal.v.y, -0.8, 1e-15);
  EXPECT_EQ(q->up, PatientVec(0, 0, 1));
}

TEST(ViewOptions, RefusesWithTheOptionsName) {
  for (const char* bad : {"", "512", "0x512", "512x99999", "a x b", "1e3x-1", "12.5x12", "512x512x512"})
    EXPECT_FALSE(parseSize(bad).ok()) << bad;
  for (const char* bad : {"", "40", "40,0", "40,-5", "40,nan", "40,400,1", "40,4OO"})
    EXPECT_FALSE(parseWindow(bad).ok()) << bad;
  for (const char* bad : {"azimuth", "azimut=3", "zoom=0", "zoom=-1", "fov=180", "projection=isometric",
                          "zoom=1,2", "zoom=inf", "zoom=1,zoom=2"})
    EXPECT_FALSE(parseCamera(bad).ok()) << bad;
  for (const char* bad :
       {"", "point=1,2,3", "point=1,2,normal=0,0,1,up=0,1,0", "point=1,2,3,normal=0,0,x,up=0,1,0",
        "from=0,0,0,to=1,0,0", "from=0,0,0,to=1,0,0,normal=0,0,1", "from=0,0,0,from=0,0,0,to=1,0,0,up=0,1,0",
        "from=0,0,0,to=1,0,0,up=0,1,0,normal=0,0,1"})
    EXPECT_FALSE(parsePlane(bad).ok()) << bad;
  for (const char* degenerate : {"from=1,2,3,to=1,2,3,up=0,0,1", "from=0,0,0,to=2,0,0,up=-1,0,0"}) {
    const Result<Plane> p = parsePlane(degenerate);
    ASSERT_FALSE(p.ok()) << degenerate;
    EXPECT_EQ(p.error().code, ErrorCode::PlaneDegenerate);
    EXPECT_EQ(p.error().where, "--plane");
  }
  EXPECT_EQ(parseWindow("x").error().where, "--window");
  EXPECT_EQ(exitCode(parseSize("0x0").error().code), 2);
}

TEST(OptionChecks, AnOutputIsNoneOfTheInputs) {
  const test::TempDir dir;
  const std::string a = (dir.path() / "a").string(), link = (dir.path() / "link").string();
  std::ofstream(a) << "a";
  std::filesystem::create_symlink(a, link);
  EXPECT_TRUE(keepSources(nullptr, {a}, (dir.path() / "new").string(), "--out").ok());
  EXPECT_TRUE(keepSources(nullptr, {a}, "", "--out").ok());
  for (const std::string& output : {a, link, (dir.path() / "." / "a").string()}) {
    const Result<void> r = keepSources(nullptr, {"not-there", a}, output, "--out");
    ASSERT_FALSE(r.ok()) << output;
    EXPECT_EQ(r.error().code, ErrorCode::WouldOverwriteSource);
    EXPECT_EQ(r.error().where, "--out");
  }
}

TEST(ViewOptions, PresetsAreForHounsfieldUnitsOnly) {
  EXPECT_EQ(windowPreset("lung", "HU")->center, -600);
  EXPECT_FALSE(windowPreset("lung", "stored value").ok());
  EXPECT_FALSE(windowPreset("tooth", "HU").ok());
}

}  // namespace
}  // namespace vernier::app
