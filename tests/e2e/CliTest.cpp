// SPDX-License-Identifier: GPL-3.0-or-later
// The program as scripts see it: exit codes, one sentence on stderr, nothing lost, nothing said that
// identifies.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "MakeDicom.h"
#include "RunProgram.h"
#include "TestData.h"

namespace vernier::test {
namespace {
namespace fs = std::filesystem;

const std::string kProgram = VERNIER_PROGRAM;

ProgramRun vernier(std::vector<std::string> args, double limit_s = 20) {
  args.insert(args.begin(), kProgram);
  return runProgram(args, limit_s);
}

std::string show(const ProgramRun& r) {
  return "exit " + std::to_string(r.exitCode) + " signal " + std::to_string(r.signal) +
         (r.timedOut ? " TIMEOUT" : "") + "\nstderr: " + r.err.substr(0, 2000);
}

// A failure as it must look: the exit code, exactly one line on stderr, nothing of a crash.
void expectSentence(const ProgramRun& r, int exitCode) {
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
std::string writeSmallStudy(const fs::path& folder, DicomSlice slice = {}) {
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

std::string readFile(const fs::path& p) {
  std::ifstream f(p, std::ios::binary);
  std::stringstream s;
  s << f.rdbuf();
  return s.str();
}

TEST_F(Cli, HelpOfEveryCommandHasAnExample) {
  for (const char* c : {"info", "render", "bench", "sheet", "compare", "phantom", "doctor", "plugins"}) {
    const ProgramRun r = vernier({c, "--help"});
    EXPECT_EQ(r.exitCode, 0) << show(r);
    EXPECT_NE(r.out.find("Example"), std::string::npos) << c;
    EXPECT_NE(r.out.find(std::string("vernier ") + c), std::string::npos) << c;
  }
  const ProgramRun version = vernier({"--version"});
  EXPECT_EQ(version.exitCode, 0);
  EXPECT_NE(version.out.find("not for primary diagnosis"), std::string::npos);
}

TEST_F(Cli, CommandsOfLaterReleasesSayThatTheyAreNotBuilt) {
  for (const char* c : {"view", "tradeoff", "measure", "qa", "export", "anonymise"}) {
    const ProgramRun r = vernier({c, "whatever", "--option"});
    expectSentence(r, 1);
    EXPECT_NE(r.err.find("not built yet"), std::string::npos) << show(r);
  }
}

TEST_F(Cli, WrongOptionsAreUsageErrors) {
  const std::string nowhere = path("a.png");
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"rendr"},
      {"render"},
      {"render", path("x"), "--view"},
      {"render", path("x"), "--view", "axial", "--scene", "s.json", "--out", nowhere},
      {"render", path("x"), "--view", "axial", "--quality", "best", "--out", nowhere},
      {"render", path("x"), "--view", "axial", "--slab", "-3", "--out", nowhere},
      {"render", path("x"), "--view", "axial", "--threads", "-1", "--out", nowhere},
      {"render", path("x"), "--frobnicate"},
      {"phantom", "no-such-recipe", "--out", path("p")},
      {"phantom", "ruler"},
      {"compare", path("a.png")},
  };
  for (const auto& args : wrong) {
    SCOPED_TRACE(args.empty() ? "(none)" : args.back());
    expectSentence(vernier(args), 2);
  }
}

TEST_F(Cli, OptionsThatNeedAStudyAreCheckedToo) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const std::vector<std::vector<std::string>> wrong = {
      {"--view", "axial", "--size", "0x10"},
      {"--view", "axial", "--size", "axb"},
      {"--view", "axial", "--window", "40"},
      {"--view", "axial", "--window", "40,0"},
      {"--view", "nonsense"},
      {"--view", "axial", "--camera", "zoom=0"},
      {"--view", "axial", "--series", "77"},
      {"--view", "axial", "--technique", "none.such"},
      {"--view", "oblique", "--plane", "point=0,0,0,normal=0,0,0,up=0,1,0"},
      {"--view", "oblique", "--plane", "point=0,0,0,normal=0,0,1,up=0,0,2"},
      {"--view", "stack", "--slice", "999"},
      {"--view", "axial", "--preset", "tooth"},
      {"--view", "axial", "--slab-mode", "min"},  // what would be ignored is refused
      {"--view", "stack", "--slab", "5"},
      {"--view", "stack", "--plane", "point=0,0,0,normal=0,0,1,up=0,1,0"},
      {"--scene", "s.json", "--slice", "3"},
      {"--scene", "s.json", "--window", "40,400"},
      {"--view", "axial", "--no-error", "--max-error", "1"},
  };
  for (const auto& extra : wrong) {
    std::vector<std::string> args{"render", study, "--out", path("o.png")};
    args.insert(args.end(), extra.begin(), extra.end());
    SCOPED_TRACE(extra.back());
    const ProgramRun r = vernier(args);
    EXPECT_TRUE(r.exitCode == 2 || r.exitCode == 1) << show(r);
    expectSentence(r, r.exitCode);
    EXPECT_FALSE(fs::exists(path("o.png")));
  }
  const ProgramRun later = vernier({"render", study, "--view", "mip", "--out", path("o.png")});
  expectSentence(later, 1);
  EXPECT_NE(later.err.find("angiography"), std::string::npos) << show(later);
}

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

TEST_F(Cli, RenderWritesAPictureAReportAndAPlan) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const ProgramRun r = vernier({"render", study, "--view", "oblique", "--size", "200x160", "--out",
                                path("o.png"), "--report", path("r.json"), "--explain"});
  ASSERT_EQ(r.exitCode, 0) << show(r);
  EXPECT_NE(r.out.find("mpr.native"), std::string::npos) << "the plan goes to stdout";
  const auto report = nlohmann::json::parse(readFile(path("r.json")));
  EXPECT_EQ(report["schema"], "vernier-report/1");
  EXPECT_EQ(report["image"]["width"], 200);
  EXPECT_EQ(report["image"]["sha256"].get<std::string>().size(), 64u);
  EXPECT_EQ(report["counters"]["passes"], 1);
  EXPECT_EQ(report["error"]["unit"], "level/255");
  EXPECT_LT(report["error"]["max"].get<double>(), 0.05);
  EXPECT_EQ(report["engine"]["name"], "native");
  EXPECT_FALSE(report["engine"]["simd"].get<std::string>().empty());
  EXPECT_NE(readFile(path("o.png")).find("levels of 255"), std::string::npos) << "the error as PNG text";
  EXPECT_EQ(report["input"]["dims"].size(), 3u);
  // The scene of the report draws the same picture again.
  std::ofstream(path("scene.json")) << report["scene"].dump();
  const ProgramRun again = vernier({"render", study, "--scene", path("scene.json"), "--size", "200x160",
                                    "--out", path("p.png"), "--report", path("r2.json")});
  ASSERT_EQ(again.exitCode, 0) << show(again);
  EXPECT_EQ(nlohmann::json::parse(readFile(path("r2.json")))["image"]["sha256"], report["image"]["sha256"]);
}

TEST_F(Cli, ASceneThatNeedsAnAbsentPluginIsKeptAndSaysSo) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  write(
      "scene.json",
      R"({"schema": 1, "layers": [{"kind": "slice", "source": "", "plane": {"point": [0,0,0], "normal": [0,0,-1], "up": [0,-1,0]}},
            {"kind": "shells", "levels": [100, 200], "source": ""}]})");
  const ProgramRun r = vernier(
      {"render", study, "--scene", path("scene.json"), "--out", path("o.png"), "--report", path("r.json")});
  EXPECT_EQ(r.exitCode, 0) << show(r);
  EXPECT_NE(r.err.find("needs plugin angiography"), std::string::npos) << show(r);
  EXPECT_NE(readFile(path("r.json")).find("\"levels\""), std::string::npos) << "the layer is kept verbatim";
}

TEST_F(Cli, MaxErrorThatCannotBeMetExitsFour) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const ProgramRun r = vernier(
      {"render", study, "--view", "slab", "--slab", "6", "--max-error", "1e-9", "--out", path("o.png")});
  EXPECT_EQ(r.exitCode, 4) << show(r);
  EXPECT_TRUE(fs::exists(path("o.png"))) << "the picture is written all the same";
  EXPECT_NE(r.err.find("goal not reached"), std::string::npos) << show(r);
}

TEST_F(Cli, OutputNeverOverwritesTheInput) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  std::string first;
  for (const auto& e : fs::directory_iterator(study)) first = e.path().string();
  const std::string before = readFile(first);
  const ProgramRun r = vernier({"render", study, "--view", "axial", "--out", first});
  expectSentence(r, 2);  // ErrorCode::WouldOverwriteSource
  EXPECT_NE(r.err.find("overwrite"), std::string::npos);
  EXPECT_EQ(readFile(first), before);
  expectSentence(vernier({"render", study, "--view", "axial", "--out", path("no/such/folder/o.png")}), 1);
}

TEST_F(Cli, NothingIdentifyingLeavesTheStudy) {
  DicomSlice who;
  who.patientName = "ZZPHI^CANARY";
  who.patientId = "ZZPHI-4711";
  const std::string study = writeSmallStudy(dir_.path() / "s", who);
  const ProgramRun r = runProgram({kProgram, "render", study, "--view", "axial", "--out", path("o.png"),
                                   "--report", path("r.json"), "--trace", path("t.json")},
                                  20, {"VERNIER_LOG=debug"});
  ASSERT_EQ(r.exitCode, 0) << show(r);
  for (const std::string& text :
       {r.out, r.err, readFile(path("o.png")), readFile(path("r.json")), readFile(path("t.json"))}) {
    EXPECT_EQ(text.find("ZZPHI"), std::string::npos);
    EXPECT_EQ(text.find(study), std::string::npos) << "paths of patients are identifying too";
  }
  const ProgramRun info = vernier({"info", study});
  EXPECT_NE(info.out.find("ZZPHI"), std::string::npos) << "info shows the name: that is what it is for";
}

TEST_F(Cli, RemovingThePluginRemovesItsFeatureAndNothingElse) {
  const fs::path copy = dir_.path() / "install";
  fs::create_directories(copy / "bin");
  fs::copy_file(kProgram, copy / "bin/vernier");
  // The copy finds libvernier by the run path of the build, and its plugins beside itself: none.
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const ProgramRun info = runProgram({(copy / "bin/vernier").string(), "info", study}, 20);
  EXPECT_EQ(info.exitCode, 0) << show(info);
  const ProgramRun r = runProgram(
      {(copy / "bin/vernier").string(), "render", study, "--view", "axial", "--out", path("o.png")}, 20);
  EXPECT_EQ(r.exitCode, 1) << show(r);
  EXPECT_NE(r.err.find("plugin mpr"), std::string::npos) << show(r);
}

TEST_F(Cli, DoctorAndPluginsSpeakJson) {
  const auto doctor = nlohmann::json::parse(vernier({"doctor", "--json"}).out);
  EXPECT_TRUE(doctor["native"]["available"].get<bool>());
  EXPECT_EQ(doctor["limits"]["sequence_depth"], 64);
  EXPECT_EQ(doctor["settings"]["threads"]["source"], "default");
  EXPECT_TRUE(doctor["window"]["available"].is_boolean());
  EXPECT_NE(doctor["window"]["available"].get<bool>(),
            !doctor["window"]["why_not"].get<std::string>().empty());
  const auto plugins = nlohmann::json::parse(vernier({"plugins", "--json"}).out);
  EXPECT_EQ(plugins["plugins"][0]["name"], "mpr");
  EXPECT_EQ(plugins["plugins"][0]["state"], "loaded");
}

TEST_F(Cli, DoctorNamesEveryLimit) {
  const auto said = nlohmann::json::parse(vernier({"doctor", "--json"}).out)["limits"];
  std::ifstream header(std::string(VERNIER_SOURCE_DIR) + "/modules/study/include/vernier/study/Limits.h");
  std::size_t constants = 0;
  for (std::string line; std::getline(header, line);)
    for (std::size_t at = line.find(" k"); at != std::string::npos; at = line.find(" k", at + 1))
      if (line.starts_with("inline constexpr") && line.find('=', at) != std::string::npos) ++constants;
  EXPECT_GT(constants, 10u);
  EXPECT_EQ(said.size(), constants - 1)
      << "a limit is missing in limits::kAll, which itself is the one left out";
}

// A virtual display with OpenGL, and the same whose OpenGL is too old.
TEST_F(Cli, DoctorTellsOfTheWindowOnADisplay) {
  const auto onDisplay = [&](const std::vector<std::string>& environment) {
    const ProgramRun r =
        runProgram({"/usr/bin/xvfb-run", "-a", kProgram, "doctor", "--json"}, 60, environment);
    EXPECT_EQ(r.exitCode, 0) << show(r);
    return nlohmann::json::parse(r.out)["window"];
  };
  const auto good = onDisplay({});
  EXPECT_TRUE(good["available"].get<bool>()) << good.dump();
  EXPECT_TRUE(good["display"].get<std::string>().starts_with("X11 :"));
  EXPECT_TRUE(good["software"].get<bool>());
  EXPECT_GE(good["version"].get<std::string>(), "3.3");
  const auto old = onDisplay({"MESA_GL_VERSION_OVERRIDE=2.1"});
  EXPECT_FALSE(old["available"].get<bool>());
  EXPECT_NE(old["why_not"].get<std::string>().find("offers no OpenGL 3.3"), std::string::npos) << old.dump();
}

TEST_F(Cli, WithoutOpenGlSlicesStillWorkAndGlIsRefusedWithAReason) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const std::vector<std::string> base{kProgram, "render", study, "--view", "axial", "--out", path("o.png")};
  EXPECT_EQ(runProgram(base, 20, {"VERNIER_GL=off"}).exitCode, 0);
  std::vector<std::string> gl = base;
  gl.insert(gl.end(), {"--engine", "gl"});
  const ProgramRun r = runProgram(gl, 20, {"VERNIER_GL=off"});
  expectSentence(r, 1);
}

}  // namespace
}  // namespace vernier::test
