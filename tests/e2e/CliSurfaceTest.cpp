// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces through the program: alone, as outlines on slices, in a scene, and everything that can be wrong
// with them.
#include <cmath>
#include <nlohmann/json.hpp>

#include "CliFixture.h"
#include "vernier/picture/Png.h"

namespace vernier::test {
namespace {
using Json = nlohmann::json;

class CliSurface : public Cli {
 protected:
  std::string phantom(const std::string& name) {
    EXPECT_EQ(vernier({"phantom", name, "--out", dir_.path().string()}).exitCode, 0);
    return path(name + ".stl");
  }
  Json report(const std::vector<std::string>& args) {
    std::vector<std::string> all = args;
    all.insert(all.end(), {"--out", path("o.png"), "--report", path("r.json"), "--error-samples", "100000"});
    const ProgramRun r = vernier(all);
    EXPECT_EQ(r.exitCode, 0) << show(r);
    return Json::parse(readFile(path("r.json")));
  }
  Picture picture() { return *readPng(path("o.png")); }
};

std::size_t brighterThan(const Picture& p, int level) {
  std::size_t n = 0;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) n += p.at(x, y)[0] > level;
  return n;
}

TEST_F(CliSurface, ATorusAloneHasTheSizeThatItsAnswersSay) {
  const std::string torus = phantom("torus");
  const Json answers = Json::parse(readFile(path("torus.answers.json")));
  for (const std::string projection : {"orthographic", "perspective"}) {
    const Json r = report({"render", torus, "--camera", "elevation=90,projection=" + projection, "--size",
                           "200x200", "--no-letters"});
    EXPECT_EQ(r["engine"]["technique"], "surface.native");
    EXPECT_EQ(r["counters"]["triangles"], answers["triangles"]);
    EXPECT_EQ(r["counters"]["passes"], 1);
    EXPECT_TRUE(r["error"]["exhaustive"].get<bool>());
    EXPECT_LT(r["error"]["max"].get<double>(), 1e-3);
    EXPECT_EQ(r["scene"]["layers"][0]["source"], "torus.stl");  // no path
    EXPECT_EQ(readFile(path("r.json")).find(dir_.path().string()), std::string::npos);
    if (projection == "perspective") continue;
    // Seen along its axis: a ring of radii 14 and 26 mm in a picture as high as the box's diagonal.
    const double diagonal = std::sqrt(2 * 52.0 * 52 + 12 * 12), mm = diagonal / 200;
    const double expected = 3.14159265 * (26 * 26 - 14 * 14) / (mm * mm);
    EXPECT_NEAR(static_cast<double>(brighterThan(picture(), 20)), expected, 0.01 * expected);
  }
}

TEST_F(CliSurface, OutlinesLieOnTheSliceAndCostNoError) {
  const std::string study = writeSmallStudy(dir_.path() / "s"), plane = phantom("cutting-plane");
  // The plane z = 0 of the file, turned to x = 0 of the patient.
  write("scene.json", R"({"schema": 1, "layers": [
    {"kind": "slice", "source": "", "plane": {"point": [0,0,11], "normal": [0,0,-1], "up": [0,-1,0]},
     "window": {"center": 10000, "width": 1}},
    {"kind": "surface", "source": "cutting-plane.stl", "colour": [1, 0, 0],
     "pose": [0,0,1,0, 1,0,0,0, 0,1,0,0, 0,0,0,1]}]})");
  const Json r = report({"render", study, "--scene", path("scene.json"), "--size", "240x200"});
  EXPECT_EQ(r["plan"]["passes"].size(), 1u);
  EXPECT_EQ(r["plan"]["afterwards"].size(), 1u);
  EXPECT_EQ(r["error"]["max"], 0.0);
  // One straight red line from top to bottom, within a pixel of x = 0.
  const Picture p = picture();
  int line = 0;
  while (line < p.width && (p.at(line, 100)[0] <= 150 || p.at(line, 100)[1] > 60)) ++line;
  const auto& place = r["plan"]["passes"][0];
  ASSERT_LT(line, p.width) << place.dump();
  EXPECT_NEAR(line, 120, 5);
  for (int y = 40; y < 150; ++y) {
    EXPECT_GT(p.at(line, y)[0], 150) << y;
    EXPECT_LT(p.at(line, y)[1], 60) << y;
    EXPECT_LT(p.at(line - 8, y)[0], 10) << y;
    EXPECT_LT(p.at(line + 8, y)[0], 10) << y;
  }
  // The same file by option, as it lies: z = 0 is not on this slice, so nothing is drawn.
  report({"render", study, "--view", "axial", "--slice", "5", "--surface", plane, "--no-letters"});
  // Coronal it is a line across.
  const Json coronal =
      report({"render", study, "--view", "coronal", "--surface", plane, "--size", "200x200"});
  EXPECT_EQ(coronal["plan"]["afterwards"][0], "outline of layer 1 (surface) on the slice");
}

TEST_F(CliSurface, InfoSaysWhatAFileHoldsAndWhatIsWrong) {
  const std::string screw = phantom("screw");
  const ProgramRun good = vernier({"info", screw});
  EXPECT_EQ(good.exitCode, 0) << show(good);
  EXPECT_NE(good.out.find("closed, volume"), std::string::npos) << good.out;
  EXPECT_NE(good.out.find("mm is assumed"), std::string::npos) << good.out;
  const ProgramRun json = vernier({"info", screw, "--json"});
  const Json facts = Json::parse(json.out), answers = Json::parse(readFile(path("screw.answers.json")));
  EXPECT_NEAR(facts["surfaces"][0]["signed_volume_mm3"], answers["volume_mm3"].get<double>(), 1e-6);
  EXPECT_EQ(facts["files"][0]["kind"], "surface");

  expectSentence(vernier({"info", write("letter.stl", "Dear colleague,\nplease find attached.\n")}), 3);
  std::string cut = readFile(screw);
  cut.resize(cut.size() / 2);
  expectSentence(vernier({"info", write("cut.stl", cut)}), 3);
  expectSentence(vernier({"render", path("cut.stl"), "--out", path("o.png")}), 3);
}

TEST_F(CliSurface, WrongUseIsSaid) {
  const std::string torus = phantom("torus"), study = writeSmallStudy(dir_.path() / "s");
  expectSentence(vernier({"render", torus, "--view", "axial", "--out", path("o.png")}), 2);
  expectSentence(vernier({"render", torus, "--slice", "3", "--out", path("o.png")}), 2);
  expectSentence(vernier({"render", study, "--view", "stack", "--surface", torus, "--out", path("o.png")}),
                 2);
  expectSentence(vernier({"render", torus, "--camera", "near=-1", "--out", path("o.png")}), 2);
  expectSentence(vernier({"render", study, "--surface", path("absent.stl"), "--out", path("o.png")}), 3);
  expectSentence(vernier({"render", torus, "--out", torus}), 2);
  const std::string before = readFile(torus);
  write("scene.json", R"({"schema": 1, "layers": [{"kind": "surface", "source": "torus.stl"}]})");
  expectSentence(vernier({"render", study, "--scene", path("scene.json"), "--out", torus}), 2);
  EXPECT_EQ(readFile(torus), before);
  for (const std::string source : {"../torus.stl", "/etc/passwd", "nothing.stl", ""}) {
    write("bad.json", R"({"schema": 1, "layers": [{"kind": "surface", "source": ")" + source + "\"}]}");
    const ProgramRun r = vernier({"render", study, "--scene", path("bad.json"), "--out", path("o.png")});
    EXPECT_NE(r.exitCode, 0) << source;
    EXPECT_EQ(r.lines(r.err), 1) << show(r);
  }
}

}  // namespace
}  // namespace vernier::test
