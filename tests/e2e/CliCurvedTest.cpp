// SPDX-License-Identifier: GPL-3.0-or-later
// Curved reformats and cubic interpolation from the command line: pictures, reports, what they say of
// themselves.
#include <nlohmann/json.hpp>

#include "CliFixture.h"

namespace vernier::test {
namespace {

using Json = nlohmann::json;

TEST_F(Cli, ACurvedReformatIsDrawnMeasuredAndReported) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const std::string points = write("path.json", "[[-8, -6, 4], [0, 4, 10], [7, 6, 18]]");
  for (const std::string& given : {std::string("-8,-6,4;0,4,10;7,6,18"), points}) {
    const ProgramRun r = vernier({"render", study, "--view", "curved", "--path", given, "--width", "8",
                                  "--size", "90x60", "--interpolation", "cubic", "--out", path("c.png"),
                                  "--report", path("c.json"), "--explain"});
    ASSERT_EQ(r.exitCode, 0) << show(r);
    const Json j = Json::parse(readFile(path("c.json")));
    EXPECT_EQ(j["engine"]["technique"], "mpr.curved");
    EXPECT_EQ(j["scene"]["layers"][0]["kind"], "curved");
    EXPECT_EQ(j["scene"]["layers"][0]["path"].size(), 3u);
    EXPECT_EQ(j["scene"]["layers"][0]["width_mm"], 8);
    EXPECT_LT(j["error"]["bound"].get<double>(), 0.01);
    EXPECT_GT(j["error"]["population"].get<int>(), 500);
    EXPECT_EQ(j["counters"]["passes"], 1);
    EXPECT_NE(r.out.find("straightened"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find(" cubic "), std::string::npos) << r.out;
    // The scene of the report draws the same picture.
    write("scene.json", j["scene"].dump());
    const ProgramRun again =
        vernier({"render", study, "--scene", path("scene.json"), "--size", "90x60", "--out", path("d.png")});
    ASSERT_EQ(again.exitCode, 0) << show(again);
    EXPECT_EQ(readFile(path("c.png")), readFile(path("d.png")));
  }
}

TEST_F(Cli, ASheetWiderThanThePathsBendSaysSo) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const ProgramRun r =
      vernier({"render", study, "--view", "curved", "--path", "-6,0,10;0,5,10;6,0,10", "--path-up", "0,1,0",
               "--width", "30", "--size", "90x60", "--out", path("c.png")});
  ASSERT_EQ(r.exitCode, 0) << show(r);
  EXPECT_NE(r.err.find("vernier: note: overlaps itself: radius"), std::string::npos) << show(r);
}

TEST_F(Cli, APathFileThatCannotBeReadIsSaid) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const auto with = [&](const std::string& file) {
    return vernier({"render", study, "--view", "curved", "--path", file, "--out", path("c.png")});
  };
  expectSentence(with(path("absent.json")), 3);
  expectSentence(with(write("a.json", "[[1, 2]]")), 2);
  expectSentence(with(write("b.json", "{\"path\": []}")), 2);
  expectSentence(with(write("c.json", "[[1, 2, 3], ")), 2);
  EXPECT_FALSE(fs::exists(path("c.png")));
}

TEST_F(Cli, SheetsShowCubicAndCurvedPictures) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const ProgramRun r =
      vernier({"sheet", study, "--size", "96x96", "--views", "stack,axial,oblique,oblique:cubic,curved",
               "--path", "-8,-6,4;0,4,10;7,6,18", "--slice", "5", "--out", path("s.png")},
              60);
  ASSERT_EQ(r.exitCode, 0) << show(r);
  for (const char* line : {"stack  ", "oblique:cubic  ", "curved  ", "mpr.curved"})
    EXPECT_NE(r.out.find(line), std::string::npos) << line << "\n" << r.out;
  expectSentence(vernier({"sheet", study, "--views", "oblique:quintic", "--out", path("t.png")}), 2);
}

}  // namespace
}  // namespace vernier::test
