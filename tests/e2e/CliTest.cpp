// SPDX-License-Identifier: GPL-3.0-or-later
// The program as scripts see it: what it writes, nothing lost, nothing said that identifies.
#include <nlohmann/json.hpp>

#include "CliFixture.h"
#include "TestPaths.h"

namespace vernier::test {
namespace {

// What would count as not given, wrap, or compare with nothing, is no value.
// Lost output must not look like success; a pipe that nobody reads ends as pipes do.
TEST_F(Cli, OutputThatIsLostIsAFailure) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  for (const std::string& command :
       {"info " + study, "info --json " + study, std::string("doctor"), std::string("plugins --json"),
        "bench --view axial --frames 1 --no-error " + study, "render --view axial --explain " + study}) {
    SCOPED_TRACE(command.substr(0, 12));
    const ProgramRun r = runProgram({"/bin/sh", "-c", kProgram + " " + command + " > /dev/full"}, 20);
    expectSentence(r, 1);
  }
}

// A plane beside the volume gives no black picture without a word.
TEST_F(Cli, APictureWithoutDataSaysSo) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const ProgramRun r = vernier({"render", study, "--view", "oblique", "--plane",
                                "point=9000,0,0,normal=0,0,1,up=0,1,0", "--out", path("o.png")});
  EXPECT_EQ(r.exitCode, 0) << show(r);
  EXPECT_NE(r.err.find("no data here"), std::string::npos) << show(r);
  const ProgramRun seen = vernier({"render", study, "--view", "oblique", "--out", path("o.png")});
  EXPECT_EQ(seen.err, "") << show(seen);
}

// Each coding of pixels, cut at every sixteenth of its length: a sentence and an exit code, nothing else.
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

// Picture and measured error, bit by bit, whatever the number of threads.
TEST_F(Cli, PicturesAreBitEqualForOneTwoAndThreeThreads) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const std::vector<std::vector<std::string>> pictures = {
      {"--view", "stack"},
      {"--view", "stack", "--interpolation", "nearest"},
      {"--view", "axial"},
      {"--view", "oblique"},
      {"--view", "slab", "--slab", "7", "--quality", "draft"},
      {"--view", "slab", "--slab", "7", "--slab-mode", "mean"},
      {"--view", "slab", "--slab", "7", "--slab-mode", "min", "--quality", "reference"}};
  for (const auto& picture : pictures) {
    SCOPED_TRACE(picture.back());
    nlohmann::json first;
    for (const char* threads : {"1", "2", "3"}) {
      std::vector<std::string> args{"render", study,       "--size", "333x257",  "--engine",
                                    "native", "--threads", threads,  "--report", path("r.json")};
      args.insert(args.end(), picture.begin(), picture.end());
      const ProgramRun r = vernier(args);
      ASSERT_EQ(r.exitCode, 0) << show(r);
      const auto report = nlohmann::json::parse(readFile(path("r.json")));
      EXPECT_EQ(report["engine"]["threads"], std::stoi(threads));
      if (first.is_null()) first = report;
      for (const char* part : {"image", "error", "counters"}) EXPECT_EQ(report[part], first[part]) << part;
    }
  }
}

TEST_F(Cli, ASceneThatNeedsAnAbsentPluginIsKeptAndSaysSo) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  write(
      "scene.json",
      R"({"schema": 1, "layers": [{"kind": "slice", "source": "", "plane": {"point": [0,0,0], "normal": [0,0,-1], "up": [0,-1,0]}},
            {"kind": "acme.flow", "opacities": [100, 200], "source": ""}]})");
  const ProgramRun r = vernier(
      {"render", study, "--scene", path("scene.json"), "--out", path("o.png"), "--report", path("r.json")});
  EXPECT_EQ(r.exitCode, 0) << show(r);
  EXPECT_NE(r.err.find("needs plugin acme"), std::string::npos) << show(r);
  EXPECT_NE(readFile(path("r.json")).find("\"opacities\""), std::string::npos)
      << "the layer is kept verbatim";
}

TEST_F(Cli, ATraceIsNotWrittenOverWhatIsNone) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  write("notes.txt", "mine");
  const ProgramRun kept = vernier({"info", study, "--trace", path("notes.txt")});
  EXPECT_EQ(kept.exitCode, 2) << show(kept);
  EXPECT_NE(kept.err.find("--trace"), std::string::npos) << show(kept);
  EXPECT_EQ(readFile(path("notes.txt")), "mine");
  for (int n = 0; n < 2; ++n)  // anew, and over an earlier trace
    EXPECT_EQ(vernier({"info", study, "--trace", path("t.json")}).exitCode, 0);
  EXPECT_EQ(readFile(path("t.json")).rfind("{\"traceEvents\"", 0), 0u);
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
  expectSentence(vernier({"sheet", study, "--out", first}), 2);
  EXPECT_EQ(readFile(first), before);
  ASSERT_EQ(vernier({"render", study, "--view", "axial", "--out", path("a.png")}).exitCode, 0);
  const std::string picture = readFile(path("a.png"));
  expectSentence(vernier({"compare", path("a.png"), path("a.png"), "--heatmap", path("a.png")}), 2);
  EXPECT_EQ(readFile(path("a.png")), picture);
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
  const auto plugins = nlohmann::json::parse(vernier({"plugins", "--json"}).out)["plugins"];
  bool mpr = false;
  for (const auto& p : plugins) {
    EXPECT_EQ(p["state"], "loaded") << p;
    mpr = mpr || p["name"] == "mpr";
  }
  EXPECT_TRUE(mpr) << plugins;
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
