// SPDX-License-Identifier: GPL-3.0-or-later
// The example plugin, built outside of the tree against what is installed (ExampleBuild.cmake), used through
// the installed program as its author would.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "RunProgram.h"
#include "TestData.h"
#include "vernier/picture/Png.h"

namespace vernier::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

const std::string kProgram = std::string(VERNIER_INSTALLED) + "/bin/vernier";
const fs::path kNewcomer = VERNIER_NEWCOMER;
constexpr int kSide = 64;

class Example : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (dir_.path() / name).string(); }
  // A copy of a built plugin in a folder of its own, so that a test may take it away.
  std::string plugins(const std::string& build) {
    const fs::path folder = dir_.path() / "plugins";
    fs::create_directory(folder);
    fs::copy(kNewcomer / build / "lib/vernier/plugins/example", folder / "example",
             fs::copy_options::recursive);
    return folder.string();
  }
  ProgramRun run(std::vector<std::string> arguments, const std::string& folder) {
    arguments.insert(arguments.begin(), kProgram);
    if (!folder.empty()) arguments.insert(arguments.end(), {"--plugins", folder});
    return runProgram(arguments, 60);
  }
  json pluginNamed(const std::string& name, const std::string& folder) {
    const ProgramRun r = run({"plugins", "--json"}, folder);
    EXPECT_EQ(r.exitCode, 0) << r.err;
    const json all = json::parse(r.out);
    for (const json& p : all["plugins"])
      if (p["name"] == name) return p;
    return {};
  }
  // 64 x 64 x 4 voxels of 1 mm whose value is ten times their column.
  std::string ramp() {
    std::ofstream f(path("ramp.mha"), std::ios::binary);
    f << "ObjectType = Image\nNDims = 3\nDimSize = 64 64 4\nElementSpacing = 1 1 1\nOffset = 0 0 0\n"
         "ElementType = MET_SHORT\nElementByteOrderMSB = False\nElementDataFile = LOCAL\n";
    for (int n = 0; n < kSide * kSide * 4; ++n) {
      const auto value = static_cast<std::int16_t>(10 * (n % kSide));
      f.write(reinterpret_cast<const char*>(&value), 2);
    }
    return path("ramp.mha");
  }
  // The slice z = 1, one pixel per voxel, black at 0 and white at 640, under a layer.
  std::string scene(const std::string& layer, double slab_mm = 0) {
    std::ofstream(path("scene.json"))
        << R"({"schema": 1, "camera": {"height_mm": 64}, "layers": [{"kind": "slice", "source": "",
               "plane": {"point": [31.5, 31.5, 1], "normal": [0, 0, -1], "up": [0, -1, 0]},
               "slab": {"thickness_mm": )"
        << slab_mm << R"(}, "window": {"center": 320, "width": 640, "function": "linear_exact"}})"
        << (layer.empty() ? "" : ", " + layer) << "]}";
    return path("scene.json");
  }
  ProgramRun render(const std::string& scenePath, const std::string& out, const std::string& folder) {
    return run({"render", ramp(), "--scene", scenePath, "--size", "64x64", "--no-letters", "--out",
                path(out + ".png"), "--report", path(out + ".json")},
               folder);
  }
  json report(const std::string& out) const { return json::parse(std::ifstream(path(out + ".json"))); }
  Picture picture(const std::string& out) const {
    auto p = readPng(path(out + ".png"));
    EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
    return p.ok() ? *p : Picture{};
  }
  TempDir dir_;
};

// Grey of a column of the ramp, with half of the band's orange over it or without.
std::array<int, 3> expected(int column, bool marked) {
  const double grey = 10.0 * column / 640;
  std::array<int, 3> rgb{};
  const double orange[3] = {1.0, 0.55, 0.1};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = static_cast<int>(std::floor(255 * (marked ? 0.5 * grey + 0.5 * orange[c] : grey) + 0.5));
  return rgb;
}

template <class Marked>
void expectPixels(const Picture& p, const Marked& marked) {
  ASSERT_EQ(p.pixels.size(), static_cast<std::size_t>(3 * kSide * kSide));
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const std::array<int, 3> want = expected(x, marked(x, y));
      for (std::size_t c = 0; c < 3; ++c) {
        const int got = p.pixels[3 * static_cast<std::size_t>(x + kSide * y) + c];
        ASSERT_LE(std::abs(got - want[c]), 1)
            << x << "," << y << " channel " << c << ": " << got << " for " << want[c];
      }
    }
}

TEST_F(Example, LoadsWithItsTechniqueAndItsPanel) {
  const json p = pluginNamed("example", plugins("same"));
  ASSERT_EQ(p["state"], "loaded") << p.dump();
  EXPECT_EQ(p["techniques"], json::array({"example.band.native"}));
  ASSERT_EQ(p["panels"].size(), 1u);
  EXPECT_EQ(p["panels"][0]["kind"], "example.band");
  const json& controls = p["panels"][0]["controls"];
  ASSERT_EQ(controls.size(), 5u);
  EXPECT_EQ(controls[1],
            json::parse(R"({"type": "slider", "key": "low", "label": "From", "unit": "HU", "least": -1024.0,
                                          "most": 4096.0, "step": 1.0, "initial": 300.0})"));
}

TEST_F(Example, AnotherBuildTypeIsRefusedByName) {
  const std::string folder = plugins("other");
  const json p = pluginNamed("example", folder);
  EXPECT_EQ(p["state"], "other ABI") << p.dump();
  EXPECT_FALSE(p["reason"].get<std::string>().empty());
  EXPECT_EQ(pluginNamed("mpr", folder)["state"], "loaded");
}

TEST_F(Example, ColoursTheBandAndNothingElse) {
  const std::string folder = plugins("same");
  const ProgramRun r =
      render(scene(R"({"kind": "example.band", "low": 101, "high": 305, "opacity": 0.5})"), "band", folder);
  ASSERT_EQ(r.exitCode, 0) << r.err;
  expectPixels(picture("band"), [](int x, int) { return x >= 11 && x <= 30; });
  const json said = report("band");
  EXPECT_EQ(said["plan"]["passes"].size(), 2u);
  EXPECT_EQ(said["plan"]["passes"][1]["technique"], "example.band.native");
  EXPECT_LE(said["error"]["max"].get<double>(), 1e-3) << "measured against the plugin's own truth";
  EXPECT_EQ(said["error"]["n"], kSide * kSide);
}

TEST_F(Example, TheOutlineIsOnePixelWide) {
  const ProgramRun r =
      render(scene(R"({"kind": "example.band", "low": 101, "high": 305, "opacity": 0.5, "outline": true})"),
             "line", plugins("same"));
  ASSERT_EQ(r.exitCode, 0) << r.err;
  expectPixels(picture("line"), [](int x, int y) {
    return x >= 11 && x <= 30 && (x == 11 || x == 30 || y == 0 || y == kSide - 1);
  });
}

TEST_F(Example, WhatCannotBeDrawnIsSaidWithItsPlace) {
  const std::string folder = plugins("same");
  const auto refused = [&](const std::string& scenePath, const std::string& says) {
    const ProgramRun r = render(scenePath, "refused", folder);
    EXPECT_EQ(r.exitCode, 2) << r.err;
    EXPECT_NE(r.err.find(says), std::string::npos) << r.err;
    EXPECT_FALSE(fs::exists(path("refused.png")));
  };
  refused(scene(R"({"kind": "example.band", "low": 5000})"), "/layers/1/low");
  refused(scene(R"({"kind": "example.band", "outline": 1})"), "/layers/1/outline");
  refused(scene(R"({"kind": "example.band"})", 10), "slab");
  std::ofstream(path("alone.json")) << R"({"schema": 1, "layers": [{"kind": "example.band"}]})";
  refused(path("alone.json"), "needs a slice layer below it");
}

TEST_F(Example, RemovingItsFolderRemovesItsLayerAndNothingElse) {
  const std::string folder = plugins("same");
  const std::string withBand = scene(R"({"kind": "example.band", "low": 101, "high": 305})");
  fs::remove_all(fs::path(folder) / "example");
  EXPECT_TRUE(pluginNamed("example", folder).is_null());
  EXPECT_EQ(pluginNamed("mpr", folder)["state"], "loaded");
  const ProgramRun r = render(withBand, "without", folder);
  ASSERT_EQ(r.exitCode, 0) << r.err;
  EXPECT_NE(r.err.find("layer 1 (example.band) needs plugin example"), std::string::npos) << r.err;
  expectPixels(picture("without"), [](int, int) { return false; });
  EXPECT_LE(report("without")["error"]["max"].get<double>(), 1e-2);
  std::ofstream(path("alone.json")) << R"({"schema": 1, "layers": [{"kind": "example.band"}]})";
  const ProgramRun alone = render(path("alone.json"), "alone", folder);
  EXPECT_EQ(alone.exitCode, 1);
  EXPECT_NE(alone.err.find("needs plugin example, which is not loaded"), std::string::npos) << alone.err;
}

}  // namespace
}  // namespace vernier::test
