// SPDX-License-Identifier: GPL-3.0-or-later
// A volume file of colours through the program: its slices against the bytes that were written, pixel by
// pixel.
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>

#include "CliFixture.h"
#include "vernier/picture/Png.h"

namespace vernier::test {
namespace {

// A NIfTI-1 file of 6x5x4 colours, 1x1x1 mm, axes L, P and S; `voxel` gives the bytes of each.
std::string colourNifti(int channels, const std::function<std::array<int, 4>(int, int, int)>& voxel) {
  std::string s(352, '\0');
  const auto put = [&](std::size_t at, auto x) { std::memcpy(s.data() + at, &x, sizeof x); };
  put(0, std::int32_t{348});
  const std::int16_t dim[] = {3, 6, 5, 4, 1, 1, 1, 1};
  for (std::size_t i = 0; i < 8; ++i) put(40 + 2 * i, dim[i]);
  put(70, static_cast<std::int16_t>(channels == 3 ? 128 : 2304));
  put(72, static_cast<std::int16_t>(8 * channels));
  put(108, 352.0f), put(280, -1.0f), put(300, -1.0f), put(320, 1.0f);
  s[123] = 2;
  put(254, std::int16_t{1});
  std::memcpy(s.data() + 344, "n+1", 3);
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 6; ++i)
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c)
          s.push_back(static_cast<char>(voxel(i, j, k)[c]));
  return s;
}

std::array<int, 4> colourAt(int i, int j, int k) {
  return {40 * i + k, 50 * j + 3 * k, 60 * k + 5 * i, i < 3 ? 255 : 50 * j};
}

class CliColours : public Cli {
 protected:
  // Every voxel of the picture as a square of 8x8 pixels; at(x, y): the voxel that stands there.
  void expectPicture(const std::vector<std::string>& view, int columns, int rows, bool opacity,
                     const std::function<std::array<int, 4>(int, int)>& at) {
    std::vector<std::string> args{"render",
                                  path("c.nii"),
                                  "--interpolation",
                                  "nearest",
                                  "--no-letters",
                                  "--size",
                                  std::to_string(8 * columns) + "x" + std::to_string(8 * rows),
                                  "--out",
                                  path("c.png")};
    args.insert(args.end(), view.begin(), view.end());
    const ProgramRun r = vernier(args);
    ASSERT_EQ(r.exitCode, 0) << show(r);
    const Result<Picture> picture = readPng(path("c.png"));
    ASSERT_TRUE(picture.ok());
    for (int y = 0; y < 8 * rows; ++y)
      for (int x = 0; x < 8 * columns; ++x) {
        const std::array<int, 4> want = at(x / 8, y / 8);
        for (std::size_t c = 0; c < 3; ++c) {
          const double level = opacity ? want[c] * want[3] / 255.0 : want[c];
          ASSERT_NEAR(picture->at(x, y)[c], level, opacity ? 0.501 : 0) << x << "," << y << " " << c;
        }
      }
  }
};

TEST_F(CliColours, SlicesAreTheColoursOfTheFile) {
  write("c.nii", colourNifti(3, colourAt));
  for (const int k : {0, 2})
    expectPicture({"--view", "axial", "--slice", std::to_string(k)}, 6, 5, false,
                  [&](int x, int y) { return colourAt(x, y, k); });
  expectPicture({"--view", "coronal", "--slice", "1"}, 6, 4, false,
                [](int x, int y) { return colourAt(x, 1, 3 - y); });
  expectPicture({"--view", "stack", "--slice", "3"}, 6, 5, false,
                [](int x, int y) { return colourAt(x, y, 3); });
}

// Slices lay the colours over the background, here black; a stored image is what is stored, and says so.
TEST_F(CliColours, OpacityIsShownOnSlices) {
  write("c.nii", colourNifti(4, colourAt));
  expectPicture({"--view", "axial", "--slice", "2", "--report", path("r.json")}, 6, 5, true,
                [](int x, int y) { return colourAt(x, y, 2); });
  const auto findings = [&] { return nlohmann::json::parse(readFile(path("r.json")))["input"]["findings"]; };
  ASSERT_EQ(findings().size(), 1u);
  EXPECT_EQ(findings()[0]["code"], "alpha-channel");
  EXPECT_NE(findings()[0]["sentence"].get<std::string>().find("12 voxels are not seen, 48 in part"),
            std::string::npos);
  expectPicture({"--view", "stack", "--slice", "2", "--report", path("r.json")}, 6, 5, false,
                [](int x, int y) { return colourAt(x, y, 2); });
  EXPECT_EQ(findings().back()["code"], "alpha-not-shown");
}

TEST_F(CliColours, InfoSaysWhatTheyAre) {
  const std::string file = write("c.nii", colourNifti(4, colourAt));
  const ProgramRun r = vernier({"info", file, "--json", "--pixels"});
  ASSERT_EQ(r.exitCode, 0) << show(r);
  const auto j = nlohmann::json::parse(r.out)["volume_files"][0];
  EXPECT_EQ(j["channels"], 4);
  EXPECT_EQ(j["stored_type"], "uint8");
  EXPECT_EQ(j["unit"], "colour");
  EXPECT_FALSE(j.contains("rescale"));
  EXPECT_EQ(j["voxels"]["stored_min"], nlohmann::json({0, 0, 0, 0}));
  EXPECT_EQ(j["voxels"]["stored_max"], nlohmann::json({203, 209, 205, 255}));
  const int slice = 30;  // voxels
  EXPECT_EQ(j["voxels"]["stored_sum"],
            nlohmann::json({4 * slice * 100 + slice * 6, 4 * slice * 100 + slice * 18,
                            slice * 360 + 4 * slice * 12.5, 4 * (15 * 255 + 3 * 500)}));
  const std::string all = readFile(file);
  EXPECT_EQ(j["findings"][0]["code"], "alpha-channel");
  EXPECT_EQ(j["findings"][0]["translucent_voxels"], 48);
  const std::string text = vernier({"info", file}).out;
  EXPECT_NE(text.find("6x5x4 voxels of uint8 red, green, blue and alpha, 1x1x1 mm\n"), std::string::npos)
      << text;
  const std::string cut = write("cut.nii", all.substr(0, all.size() - 1));
  expectSentence(vernier({"render", cut, "--view", "axial", "--out", path("o.png")}), 3);
}

}  // namespace
}  // namespace vernier::test
