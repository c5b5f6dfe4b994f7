// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of the window open: synthetic studies and small volume files, written anew by each test.
#pragma once
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "RunProgram.h"
#include "TestData.h"
#include "WindowDriver.h"

namespace vernier::ui::test {

inline std::string study(const vernier::test::TempDir& dir, const std::string& name,
                         const std::vector<std::string>& options = {}) {
  std::vector<std::string> words{VERNIER_PROGRAM, "phantom", name, "--out", (dir.path() / "study").string()};
  words.insert(words.end(), options.begin(), options.end());
  const auto run = vernier::test::runProgram(words, 60);
  EXPECT_EQ(run.exitCode, 0) << run.err;
  return (dir.path() / "study" / name).string();
}

inline std::string smallStudy(const vernier::test::TempDir& dir) { return study(dir, "small-ct"); }

// A head of 128 x 128 x 64 voxels: large enough for pictures that somebody looks at.
inline std::string headStudy(const vernier::test::TempDir& dir) {
  return study(dir, "ct-head", {"--set", "scale=0.25"});
}

// The window with the head's study; false where there is no window to be had.
inline bool openHead(const vernier::test::TempDir& dir, WindowDriver& w) {
  if (!w.here()) return false;
  w.open(headStudy(dir));
  return true;
}

// NRRD, 24 x 20 x 16 voxels of 1 mm, rising along the columns.
inline std::string volumeFile(const vernier::test::TempDir& dir, const std::string& name) {
  const std::string path = (dir.path() / (name + ".nrrd")).string();
  std::ofstream out(path, std::ios::binary);
  out << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 24 20 16\n"
         "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n";
  for (int k = 0; k < 24 * 20 * 16; ++k) out.put(static_cast<char>(10 * (k % 24)));
  return path;
}

}  // namespace vernier::ui::test
