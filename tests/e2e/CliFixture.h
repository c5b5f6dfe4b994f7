// SPDX-License-Identifier: GPL-3.0-or-later
// The program as scripts run it, and what a failure of it must look like.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "MakeDicom.h"
#include "RunProgram.h"
#include "TestData.h"

namespace vernier::test {
namespace fs = std::filesystem;

inline const std::string kProgram = VERNIER_PROGRAM;

inline ProgramRun vernier(std::vector<std::string> args, double limit_s = 20) {
  args.insert(args.begin(), kProgram);
  return runProgram(args, limit_s);
}

inline std::string show(const ProgramRun& r) {
  return "exit " + std::to_string(r.exitCode) + " signal " + std::to_string(r.signal) +
         (r.timedOut ? " TIMEOUT" : "") + "\nstderr: " + r.err.substr(0, 2000);
}

// A failure as it must look: the exit code, exactly one line on stderr, nothing of a crash.
inline void expectSentence(const ProgramRun& r, int exitCode) {
  EXPECT_EQ(r.exitCode, exitCode) << show(r);
  EXPECT_EQ(r.lines(r.err), 1) << show(r);
  EXPECT_EQ(r.err.rfind("vernier: ", 0), 0u) << show(r);
  EXPECT_GT(r.err.size(), 30u) << show(r);
}

class Cli : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (dir_.path() / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  TempDir dir_;
};

// 12 slices of 24x20 of a smooth pattern with a hard edge; returns the folder.
inline std::string writeSmallStudy(const fs::path& folder, DicomSlice slice = {}) {
  fs::create_directories(folder);
  slice.rows = 20, slice.columns = 24;
  slice.spacing = {1.25, 1.0};
  for (int k = 0; k < 12; ++k) {
    slice.pixels.clear();
    for (int j = 0; j < slice.rows; ++j)
      for (int i = 0; i < slice.columns; ++i)
        slice.pixels.push_back(i * i + 7 * j + 11 * k + (i > 12 ? 400 : 0));
    slice.position = {-12, -10, 2.0 * k};
    slice.instanceNumber = k + 1;
    writeDicom(folder / ("s" + std::to_string(k) + ".dcm"), slice);
  }
  return folder.string();
}

inline std::string readFile(const fs::path& p) {
  std::ifstream f(p, std::ios::binary);
  std::stringstream s;
  s << f.rdbuf();
  return s.str();
}

}  // namespace vernier::test
