// SPDX-License-Identifier: GPL-3.0-or-later
// Broken series are broken in the stated way and in no other; every file is a valid object by dciodvfy.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include "Files.h"
#include "TestData.h"

namespace vernier::test {
namespace {

std::vector<ReadFile> byPosition(std::vector<ReadFile> files) {
  std::stable_sort(files.begin(), files.end(), [](const ReadFile& a, const ReadFile& b) {
    return a.positionAlongNormal() < b.positionAlongNormal();
  });
  return files;
}

TEST(BrokenSeries, TiltIsInThePositionsOnly) {
  for (const char* deg : {"14", "-20"}) {
    TempDir dir;
    const auto files = byPosition(writeAndRead(dir.path(), "tilt", {{"tilt", deg}}).files);
    for (std::size_t k = 1; k < files.size(); ++k) {
      const double dy = files[k].origin[1] - files[k - 1].origin[1],
                   dz = files[k].origin[2] - files[k - 1].origin[2];
      EXPECT_NEAR(dz, 1.5, 1e-12);
      EXPECT_NEAR(std::atan2(dy, dz) * 180 / M_PI, std::stod(deg), 1e-9);
      EXPECT_EQ(files[k].origin[0], files[0].origin[0]);
      EXPECT_EQ(files[k].orientation[0], 1);
      EXPECT_EQ(files[k].orientation[4], 1);
    }
  }
}

// The spine is upright in the patient: in the sheared pictures it wanders, at its true place it stays.
TEST(BrokenSeries, TiltedPixelsShowThePatientWhereThePositionsSay) {
  TempDir dir;
  for (const ReadFile& f : writeAndRead(dir.path(), "tilt").files) {
    const int row = static_cast<int>(std::lround(18 - f.origin[1])),
              column = static_cast<int>(std::lround(-f.origin[0]));
    if (row < 0 || row >= f.rows) continue;
    EXPECT_NEAR(f.at(column, row) + f.intercept, 600, 60) << f.name;
  }
}

TEST(BrokenSeries, GapMissesTheStatedSlices) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "gap");
  const auto files = byPosition(w.files);
  int gaps = 0;
  for (std::size_t k = 1; k < files.size(); ++k) {
    const double step = files[k].origin[2] - files[k - 1].origin[2];
    if (std::fabs(step - 1.5) < 1e-9) continue;
    ++gaps;
    EXPECT_NEAR(step, 4.5, 1e-9);
    EXPECT_NEAR(files[k - 1].origin[2], w.answers["findings"][0]["from_mm"].get<double>(), 1e-9);
    EXPECT_NEAR(files[k].origin[2], w.answers["findings"][0]["to_mm"].get<double>(), 1e-9);
  }
  EXPECT_EQ(gaps, 1);
  EXPECT_EQ(files.size(), 30u);
}

TEST(BrokenSeries, DuplicatesAreOfTheStatedKind) {
  for (const std::string kind : {"identical", "conflict", "position"}) {
    TempDir dir;
    const Written w = writeAndRead(dir.path(), "duplicate", {{"kind", kind}});
    ASSERT_EQ(w.files.size(), 33u);
    std::map<std::string, std::vector<const ReadFile*>> byUid;
    std::map<double, std::vector<const ReadFile*>> byPlace;
    for (const ReadFile& f : w.files) {
      byUid[f.sopUid].push_back(&f);
      byPlace[f.origin[2]].push_back(&f);
    }
    EXPECT_EQ(byUid.size(), kind == "position" ? 33u : 32u);
    EXPECT_EQ(byPlace.size(), 32u);
    for (const auto& [z, pair] : byPlace) {
      if (pair.size() < 2) continue;
      EXPECT_EQ(pair[0]->sopUid == pair[1]->sopUid, kind != "position");
      EXPECT_EQ(pair[0]->stored == pair[1]->stored, kind == "identical");
    }
  }
}

TEST(BrokenSeries, UnevenPositionsAreOffByTheStatedOffsets) {
  TempDir dir;
  const auto files = byPosition(writeAndRead(dir.path(), "uneven").files);
  const double offsets[] = {0, 0.004, -0.3, 0.02, 0.45, 0, -0.01, 0.15};
  for (std::size_t k = 0; k < files.size(); ++k)
    EXPECT_NEAR(files[k].origin[2], -23.25 + 1.5 * static_cast<double>(k) + offsets[k % 8], 1e-9);
}

TEST(BrokenSeries, TwoOrientationsShareOneSeries) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "two-orientations");
  std::set<std::string> series;
  int axial = 0, coronal = 0;
  for (const ReadFile& f : w.files) {
    series.insert(f.seriesUid);
    axial += std::fabs(f.normal(2)) > 0.99;
    coronal += std::fabs(f.normal(1)) > 0.99;
  }
  EXPECT_EQ(series.size(), 1u);
  EXPECT_EQ(axial, 32);
  EXPECT_EQ(coronal, 32);
}

TEST(BrokenSeries, ShuffledNamesAndNumbersContradictThePositions) {
  TempDir plainDir, dir;
  const auto plain = byPosition(writeAndRead(plainDir.path(), "small-ct").files);
  const Written w = writeAndRead(dir.path(), "shuffled");
  const auto files = byPosition(w.files);
  ASSERT_EQ(files.size(), plain.size());
  int rising = 0, named = 0;
  std::set<int> numbers;
  for (std::size_t k = 0; k < files.size(); ++k) {
    EXPECT_EQ(files[k].origin[2], plain[k].origin[2]);
    numbers.insert(files[k].instanceNumber);
    if (k > 0) rising += files[k].instanceNumber > files[k - 1].instanceNumber;
    if (k > 0) named += files[k].name > files[k - 1].name;
  }
  EXPECT_EQ(numbers.size(), files.size());
  EXPECT_GT(rising, 5);
  EXPECT_LT(rising, 26);
  EXPECT_GT(named, 5);
  EXPECT_LT(named, 26);
}

TEST(BrokenSeries, PaddingFillsEverythingOutsideTheCircleAndNothingInside) {
  TempDir dir;
  for (const ReadFile& f : writeAndRead(dir.path(), "padding").files) {
    ASSERT_TRUE(f.hasPadding);
    EXPECT_EQ(f.padding, -2000);
    for (int row = 0; row < f.rows; ++row)
      for (int column = 0; column < f.columns; ++column) {
        const double r = std::hypot(column - 31.5, row - 31.5);
        ASSERT_EQ(f.at(column, row) == -2000, r > 30) << column << ' ' << row;
      }
  }
}

TEST(BrokenSeries, WindowsAreOddAsStated) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "window-odd");
  const std::vector<std::array<std::string, 3>> expected{{"40\\-600", "400\\1500", ""},
                                                         {"40\\50", "0\\350", ""},
                                                         {"40", "-400", ""},
                                                         {"40.25", "0.5", ""},
                                                         {"40", "1", ""},
                                                         {"40", "400", "LINEAR_EXACT"},
                                                         {"40", "400", "SIGMOID"},
                                                         {"1000000", "1000000000", ""}};
  for (std::size_t k = 0; k < w.files.size(); ++k) {
    EXPECT_EQ(w.files[k].windowCenter, expected[k % 8][0]);
    EXPECT_EQ(w.files[k].windowWidth, expected[k % 8][1]);
    EXPECT_EQ(w.files[k].windowFunction, expected[k % 8][2]);
  }
}

struct Ran {
  int code = 0;
  std::vector<std::string> lines;
};
Ran run(const std::string& command) {
  Ran ran;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  char line[4096];
  while (pipe && std::fgets(line, sizeof line, pipe)) ran.lines.emplace_back(line);
  ran.code = pipe ? ::pclose(pipe) : -1;
  return ran;
}

// dciodvfy inflates nothing: a deflated file is checked as dcmconv's explicit little endian copy.
TEST(PhantomObjects, PassDciodvfyWithoutError) {
  if (run("command -v dciodvfy").lines.empty()) {
    std::cout << "[  NOTE    ] dciodvfy (package dicom3tools) is not here: objects not checked\n";
    return;
  }
  int checked = 0;
  for (const PhantomRecipe& recipe : phantomRecipes()) {
    if (recipe.isSurface || isMultiFrame(recipe.name)) continue;
    TempDir dir;
    if (hasColoursOrStates(recipe.name)) {
      const auto info = writeOnly(dir.path(), recipe.name, {});
      ASSERT_TRUE(info.ok());
      for (const auto& entry : std::filesystem::directory_iterator(info->data)) {
        for (const std::string& line : run("dciodvfy " + entry.path().string()).lines)
          EXPECT_EQ(line.find("Error"), std::string::npos) << entry.path().filename() << ": " << line;
        ++checked;
      }
      continue;
    }
    std::map<std::string, std::string> settings;
    for (const PhantomSetting& s : recipe.settings)
      if (s.name == "scale") settings["scale"] = "0.125";
    const Written w = writeAndRead(dir.path(), recipe.name, settings);
    std::set<std::string> seen;
    for (const ReadFile& f : w.files) {
      // One of each series; of the odd windows, each.
      const bool odd = recipe.name == "window-odd";
      if (!seen.insert(f.seriesUid + (odd ? f.windowWidth + f.windowFunction : "")).second) continue;
      std::string file = (w.folder / f.name).string();
      if (f.transferSyntax == "1.2.840.10008.1.2.1.99") {
        const std::string plain = (dir.path() / "plain.dcm").string();
        if (run("dcmconv +te " + file + " " + plain).code != 0) {
          std::cout << "[  NOTE    ] dcmconv (package dcmtk) is not here: the deflated file is not checked\n";
          continue;
        }
        file = plain;
      }
      const Ran ran = run("dciodvfy " + file);
      ++checked;
      EXPECT_FALSE(ran.lines.empty());
      for (const std::string& line : ran.lines) {
        const bool error = line.find("Error") != std::string::npos;
        // What this recipe is for: widths that the standard forbids.
        const bool wanted = odd && line.find("Window") != std::string::npos;
        EXPECT_FALSE(error && !wanted) << recipe.name << ' ' << f.name << ": " << line;
      }
    }
  }
  EXPECT_GT(checked, 30);
}

}  // namespace
}  // namespace vernier::test
