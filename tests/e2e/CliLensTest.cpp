// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses through the program: by option, by file, of a surface's hull, and where they show nothing.
#include "CliFixture.h"
#include "vernier/picture/Png.h"

namespace vernier::test {
namespace {

class CliLens : public Cli {
 protected:
  void SetUp() override { study_ = writeSmallStudy(dir_.path() / "study"); }
  // The picture alone, 96x96, drawn by the processor.
  Picture render(std::vector<std::string> extra) {
    std::vector<std::string> args{"render",   study_,   "--out",        path("o.png"), "--size",    "96x96",
                                  "--engine", "native", "--no-letters", "--no-error",  "--quality", "draft"};
    args.insert(args.end(), extra.begin(), extra.end());
    const ProgramRun r = vernier(args);
    EXPECT_EQ(r.exitCode, 0) << show(r);
    err_ = r.err;
    auto p = readPng(path("o.png"));
    EXPECT_TRUE(p.ok());
    return p.ok() ? *p : Picture{};
  }
  static std::size_t different(const Picture& a, const Picture& b) {
    std::size_t n = 0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x)
        n += a.at(x, y)[0] != b.at(x, y)[0] || a.at(x, y)[1] != b.at(x, y)[1] ||
             a.at(x, y)[2] != b.at(x, y)[2];
    return n;
  }
  std::string study_, err_;
};

// The study's box of voxel centres is x -12..11, y -10..13.75, z 0..22, so its middle is (-0.5, 1.9, 11).
TEST_F(CliLens, ACutOutLensTakesItsPartAway) {
  const Picture whole = render({"--view", "mip"});
  const Picture cut =
      render({"--view", "mip", "--lens", "box:-0.5,1.9,11,8,200,8", "--lens-inner", "cut-out"});
  // Seen from the front the box goes all through: its 8 mm x 8 mm are black, and nothing else changes.
  std::size_t black = 0;
  for (int y = 0; y < cut.height; ++y)
    for (int x = 0; x < cut.width; ++x) black += cut.at(x, y)[0] == 0 && whole.at(x, y)[0] > 0;
  EXPECT_EQ(black, different(whole, cut));
  // The picture is as high as the box's diagonal, 40 mm on 96 pixels: 8 mm are 19.
  EXPECT_NEAR(static_cast<double>(black), 19 * 19, 60);
}

TEST_F(CliLens, FilesAndSurfacesGiveTheSamePictureAsTheOption) {
  const Picture box = render({"--view", "mip", "--lens", "box:0,2,11,8,8,8", "--lens-inner", "cut-out"});
  const std::string lens = write("lens.json", R"({"kind": "lens", "inner": {"kind": "cut-out"},
    "shape": {"kind": "box", "centre": [0, 2, 11], "size_mm": [8, 8, 8]}})");
  EXPECT_EQ(different(box, render({"--view", "mip", "--lens", lens})), 0u);
  // Its corners as a surface file that is not even closed: the hull is taken.
  std::string obj;
  for (int n = 0; n < 8; ++n)
    obj += std::string("v ") + (n & 1 ? "4 " : "-4 ") + (n & 2 ? "6 " : "-2 ") + (n & 4 ? "15\n" : "7\n");
  const std::string file = write("box.obj", obj + "f 1 2 3\nf 2 4 8\nf 5 6 7\nf 6 8 7\n");
  EXPECT_EQ(different(box, render({"--view", "mip", "--lens", file, "--lens-inner", "cut-out"})), 0u);
  // By name in a lens file, beside it.
  const std::string mesh =
      write("mesh.json", R"({"kind": "lens", "shape": {"kind": "mesh", "source": "box.obj", "hull": true}})");
  EXPECT_EQ(different(box, render({"--view", "mip", "--lens", mesh})), 0u);
}

TEST_F(CliLens, SpheresAndConesLieWhereTheOptionSays) {
  const Picture whole = render({"--view", "dvr", "--preset", "ramp"});
  const auto ofFile = [&](const std::string& shape) {
    return render(
        {"--view", "dvr", "--preset", "ramp", "--lens",
         write("shape.json", R"({"kind": "lens", "inner": {"kind": "cut-out"}, "shape": )" + shape + "}")});
  };
  const Picture sphere =
      render({"--view", "dvr", "--preset", "ramp", "--lens", "sphere:2,3,9,7", "--lens-inner", "cut-out"});
  EXPECT_GT(different(whole, sphere), 30u);
  EXPECT_EQ(different(sphere, ofFile(R"({"kind": "sphere", "centre": [2, 3, 9], "radius_mm": 7})")), 0u);
  const Picture cone = render(
      {"--view", "dvr", "--preset", "ramp", "--lens", "cone:2,-9,9,3,13,12,2,6", "--lens-inner", "cut-out"});
  EXPECT_GT(different(whole, cone), 30u);
  EXPECT_EQ(different(cone, ofFile(R"({"kind": "cone", "from": [2, -9, 9], "to": [3, 13, 12],
    "from_radius_mm": 2, "to_radius_mm": 6})")),
            0u);
}

// A lens file says what it shows, unless the option does.
TEST_F(CliLens, TheInnerOptionGoesBeforeTheFile) {
  const std::string file = write("own.json", R"({"kind": "lens", "inner": {"kind": "cut-out"},
    "shape": {"kind": "box", "centre": [0, 2, 11], "size_mm": [8, 8, 8]}})");
  const Picture own = render({"--view", "mip", "--lens", file});
  const Picture bone = render({"--view", "mip", "--lens", file, "--lens-inner", "window:40,80"});
  EXPECT_GT(different(own, bone), 30u);
  const Picture box = render({"--view", "mip", "--lens", "box:0,2,11,8,8,8", "--lens-inner", "window:40,80"});
  EXPECT_EQ(different(bone, box), 0u);
  // What an option's lens shows where nothing says it, is what fits the view; a file's default is nothing.
  const std::string bare = write("bare.JSON", R"({"kind": "lens",
    "shape": {"kind": "box", "centre": [0, 2, 11], "size_mm": [8, 8, 8]}})");
  EXPECT_EQ(different(own, render({"--view", "mip", "--lens", bare})), 0u);
  EXPECT_GT(different(own, render({"--view", "mip", "--lens", "box:0,2,11,8,8,8"})), 30u);
}

TEST_F(CliLens, OutsideOfTheVolumeThePictureIsAsWithoutIt) {
  const Picture whole = render({"--view", "mip"});
  EXPECT_EQ(different(whole, render({"--view", "mip", "--lens", "sphere:500,0,0,20"})), 0u);
  EXPECT_NE(err_.find("as without it"), std::string::npos) << err_;
}

TEST_F(CliLens, TheViewLensShowsSomethingElseInTheMiddle) {
  const Picture plain = render({"--view", "dvr", "--preset", "ramp"});
  const Picture lens = render({"--view", "lens", "--preset", "ramp"});
  EXPECT_GT(different(plain, lens), 500u);
  for (int x : {0, 95}) EXPECT_EQ(lens.at(x, 0)[0], plain.at(x, 0)[0]);
  const Picture other = render({"--view", "lens", "--preset", "ramp", "--lens-inner", "mip"});
  EXPECT_GT(different(lens, other), 500u);
  // A lens that is given takes the place of the view's own.
  const Picture away = render({"--view", "lens", "--preset", "ramp", "--lens", "sphere:500,0,0,20"});
  EXPECT_EQ(different(plain, away), 0u);
}

TEST_F(CliLens, WhatIsNoLensIsSaidInOneSentence) {
  const auto refused = [&](std::vector<std::string> extra, int code, const char* why) {
    std::vector<std::string> args{"render", study_, "--out", path("no.png"), "--view", "mip"};
    args.insert(args.end(), extra.begin(), extra.end());
    const ProgramRun r = vernier(args);
    expectSentence(r, code);
    EXPECT_NE(r.err.find(why), std::string::npos) << r.err;
    EXPECT_FALSE(fs::exists(path("no.png")));
  };
  refused({"--lens", path("none.json")}, 3, "none.json");
  refused({"--lens", write("s.json", R"({"kind": "slice"})")}, 2, "");
  refused({"--lens", write("t.json", R"({"kind": "surface", "source": "x.stl"})")}, 2, "no lens");
  refused({"--lens", write("b.json", R"({"kind": "lens"}, {"kind": "lens"})")}, 2, "");
  refused({"--lens", write("f.json", R"({"kind": "lens", "shape": {"kind": "hull",
          "points": [[0,0,0],[1,0,0],[0,1,0],[5,5,0]]}})")},
          2, "in a plane");
  refused({"--lens", write("o.json", R"({"kind": "lens", "shape": {"kind": "mesh", "source": "open.obj"}})"),
           "--surface", write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")},
          2, "not closed");
}

}  // namespace
}  // namespace vernier::test
