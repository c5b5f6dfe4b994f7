// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are no images, or damaged ones: one sentence, exit code 3, no crash, no memory beyond reason.
#include <sys/stat.h>

#include "CliFixture.h"

namespace vernier::test {
namespace {

TEST_F(Cli, BadFilesGetOneSentenceAndExitThree) {
  const std::string empty = write("empty.dcm", "");
  const std::string text = write("text.dcm", "This is a letter, not an image.\n");
  const std::string elf = write("elf.dcm", readFile("/proc/self/exe").substr(0, 200'000));
  const std::string pe = write("pe.dcm", "MZ" + std::string(300, '\0'));
  const std::string zeros = write("zeros.dcm", std::string(4096, '\0'));
  const std::string study = writeSmallStudy(dir_.path() / "whole");
  std::string whole;
  for (const auto& e : fs::directory_iterator(study)) whole = readFile(e.path());
  const std::string cut = write("cut.dcm", whole.substr(0, whole.size() / 2));
  const std::string head = write("head.dcm", whole.substr(0, 140));
  fs::create_directory(path("folder"));
  ::mkfifo(path("fifo").c_str(), 0600);
  for (const std::string& p : {empty, text, elf, pe, zeros, cut, head, path("folder"), path("fifo"),
                               std::string("/dev/zero"), std::string("/dev/null"), path("not-there")}) {
    SCOPED_TRACE(fs::path(p).filename().string());
    const ProgramRun render = vernier({"render", p, "--view", "stack", "--out", path("o.png")});
    expectSentence(render, 3);
    EXPECT_FALSE(render.timedOut);
    EXPECT_LT(render.peakRss_mb, 150);
    EXPECT_FALSE(fs::exists(path("o.png")));
    const ProgramRun info = vernier({"info", p});
    EXPECT_TRUE(info.exitCode == 3 || p == cut) << show(info);
    EXPECT_LE(info.lines(info.err), 1) << show(info);
    expectSentence(vernier({"sheet", p, "--out", path("o.png")}), 3);
    const ProgramRun compare = vernier({"compare", p, p});
    expectSentence(compare, 3);
    EXPECT_EQ(compare.err.find(dir_.path().string()), std::string::npos) << "no folder of the user";
  }
}

TEST_F(Cli, FilesCutAnywhereEndWell) {
  VERNIER_NEEDS_DATA("codec_small_singles");
  for (const char* name : {"CT_small.dcm", "JPEG-lossy.dcm", "JPEG2000.dcm", "JPEGLSNearLossless_16.dcm",
                           "MR_small_RLE.dcm", "MR_small_bigendian.dcm", "image_dfl.dcm"}) {
    const std::string whole = readFile(dataDir() / "codec_small_singles" / name);
    for (std::size_t part = 1; part < 16; ++part) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(part) + "/16");
      const std::string cut = write("cut.dcm", whole.substr(0, whole.size() * part / 16));
      const ProgramRun r =
          vernier({"render", cut, "--view", "stack", "--no-error", "--out", path("o.png")}, 10);
      expectSentence(r, 3);
      EXPECT_LT(r.peakRss_mb, 100);
    }
  }
}

TEST_F(Cli, EveryMalformedFileEndsWell) {
  for (const char* folder : {"malformed_small", "fuzz_cat02_07"}) {
    VERNIER_NEEDS_DATA(folder);
    for (const auto& entry : fs::recursive_directory_iterator(dataDir() / folder)) {
      if (!entry.is_regular_file()) continue;
      SCOPED_TRACE(entry.path().filename().string());
      const ProgramRun r = vernier(
          {"render", entry.path().string(), "--view", "stack", "--size", "64x64", "--out", path("o.png")},
          10);
      EXPECT_TRUE(r.exitCode == 0 || r.exitCode == 3 || r.exitCode == 1) << show(r);
      EXPECT_FALSE(r.timedOut);
      EXPECT_LE(r.lines(r.err), 1) << show(r);
      EXPECT_EQ(r.exitCode != 0, r.err.rfind("vernier: ", 0) == 0) << show(r);
      EXPECT_LT(r.peakRss_mb, 200) << "memory beyond what a small file justifies";
    }
  }
}

TEST_F(Cli, AFolderWithOneBadFileLoadsTheRestAndListsTheBadOne) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  std::ofstream(fs::path(study) / "broken.dcm", std::ios::binary)
      << std::string(128, '\0') + "DICM" + std::string(40, '\x7f');
  const ProgramRun info = vernier({"info", study, "--json"});
  ASSERT_EQ(info.exitCode, 0) << show(info);
  EXPECT_NE(info.out.find("broken.dcm"), std::string::npos);
  const ProgramRun r = vernier({"render", study, "--view", "axial", "--out", path("o.png")});
  EXPECT_EQ(r.exitCode, 0) << show(r);
  EXPECT_TRUE(fs::exists(path("o.png")));
}

}  // namespace
}  // namespace vernier::test
