// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that is full: a write that fails in its middle leaves the old file as it was, nothing beside it, and
// one sentence. The limit on the size of files stands for the disk: write() then fails as it does there.
#include <algorithm>
#include <random>
#include <set>

#include "CliFixture.h"
#include "vernier/picture/Png.h"

namespace vernier::test {
namespace {

class DiskFull : public Cli {
 protected:
  // Files of more than `blocks` x 512 bytes cannot be written.
  ProgramRun limited(int blocks, std::vector<std::string> args) {
    std::vector<std::string> all = {
        "/bin/sh", "-c", "trap '' XFSZ; ulimit -f " + std::to_string(blocks) + "; exec \"$0\" \"$@\"",
        kProgram};
    all.insert(all.end(), args.begin(), args.end());
    return runProgram(all, 120);
  }
  std::set<std::string> files(const std::string& folder) const {
    std::set<std::string> names;
    for (const auto& e : fs::recursive_directory_iterator(folder))
      names.insert(e.path().lexically_relative(folder));
    return names;
  }
  // Does it once with room, once without: the same file as before stands there, and nothing else.
  void expectKept(const std::vector<std::string>& args, const std::string& file, int blocks = 1) {
    const ProgramRun good = vernier(args, 60);
    ASSERT_EQ(good.exitCode, 0) << show(good);
    const std::string before = readFile(path(file));
    ASSERT_GT(before.size(), 512u * static_cast<std::size_t>(blocks));
    const auto names = files(dir_.path().string());
    const ProgramRun full = limited(blocks, args);
    expectSentence(full, 1);
    EXPECT_NE(full.err.find("cannot be written"), std::string::npos) << full.err;
    EXPECT_EQ(readFile(path(file)), before);
    EXPECT_EQ(files(dir_.path().string()), names);
    // And where there was none before there is none.
    fs::remove(path(file));
    expectSentence(limited(blocks, args), 1);
    EXPECT_FALSE(fs::exists(path(file)));
  }
  std::string study() { return writeSmallStudy(dir_.path() / "study"); }
};

TEST_F(DiskFull, PicturesAndTheirReports) {
  const std::string s = study();
  expectKept({"render", s, "--view", "axial", "--size", "200x200", "--out", path("a.png")}, "a.png");
  expectKept({"render", s, "--view", "axial", "--size", "64x64", "--report", path("a.json")}, "a.json");
}

TEST_F(DiskFull, Measurements) {
  const std::string spec =
      write("list.json",
            R"({"schema": 1, "measurements": [{"kind": "ellipse", "space": "image", "frame": 3,
                                   "points": [[2, 2], [20, 18]]}]})");
  expectKept({"measure", study(), "--spec", spec, "--out", path("m.json")}, "m.json");
}

TEST_F(DiskFull, Comparisons) {
  Picture noise(100, 100);
  std::mt19937 random(1);
  for (std::uint8_t& b : noise.pixels) b = static_cast<std::uint8_t>(random());
  ASSERT_TRUE(writePng(path("n.png"), noise).ok());
  std::reverse(noise.pixels.begin(), noise.pixels.end());
  ASSERT_TRUE(writePng(path("r.png"), noise).ok());
  expectKept({"compare", path("n.png"), path("r.png"), "--heatmap", path("h.png")}, "h.png");
}

// The old report stays whole; the sentence is of the file that found no room.
TEST_F(DiskFull, QualityReports) {
  fs::create_directories(path("suite/a"));
  write("suite/a/case.json",
        R"({"schema": "vernier-qa-case/1", "title": "t", "why": "w", "data": {"recipe": "grey-scale"},
            "view": "axial", "size": [512, 512], "checks": [{"kind": "letters", "left": "R"}]})");
  const std::vector<std::string> args = {"qa",     "run",   path("suite"), "--engine",
                                         "native", "--out", path("report")};
  const ProgramRun good = vernier(args, 60);
  ASSERT_EQ(good.exitCode, 0) << show(good);
  // Room for the phantom's slices (11 kB each), none for the page.
  ASSERT_GT(fs::file_size(path("report/report.html")), 24u * 512);
  const std::string before = readFile(path("report/report.html"));
  const auto names = files(path("report"));
  const ProgramRun full = limited(24, args);
  expectSentence(full, 1);
  EXPECT_NE(full.err.find("report.html"), std::string::npos) << full.err;
  EXPECT_EQ(readFile(path("report/report.html")), before);
  EXPECT_EQ(files(path("report")), names);
  // None for the phantom either: the case is an error, the rest of the report is there.
  const ProgramRun phantom = limited(8, args);
  EXPECT_NE(phantom.exitCode, 0);
  EXPECT_EQ(phantom.signal, 0) << show(phantom);
}

}  // namespace
}  // namespace vernier::test
