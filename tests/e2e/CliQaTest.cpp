// SPDX-License-Identifier: GPL-3.0-or-later
// vernier qa: what must be caught, what must be kept, what a failure must look like.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "CliFixture.h"
#include "vernier/picture/Mutants.h"
#include "vernier/picture/Png.h"

namespace vernier::test {
namespace {
using Json = nlohmann::ordered_json;

Json sliceCase() {
  return {{"schema", "vernier-qa-case/1"},
          {"title", "Axial slice"},
          {"why", "Sides and values."},
          {"data", {{"recipe", "orientation"}}},
          {"view", "axial"},
          {"size", {96, 96}},
          {"guard", {{"least_levels", 4}}},
          {"tolerance", {{"max", 1}, {"why", "rounding"}}},
          {"checks", {{{"kind", "letters"}, {"left", "R"}, {"right", "L"}, {"top", "A"}, {"bottom", "P"}}}}};
}

class Qa : public Cli {
 protected:
  std::string suite() const { return path("suite"); }
  void writeCase(const std::string& name, const Json& j) {
    fs::create_directories(suite() + "/" + name);
    std::ofstream(suite() + "/" + name + "/case.json") << j.dump(2);
  }
  std::string file(const std::string& name) const { return suite() + "/" + name; }
  ProgramRun run(std::vector<std::string> more = {}) {
    std::vector<std::string> args = {"qa", "run", suite(), "--engine", "native"};
    args.insert(args.end(), more.begin(), more.end());
    return vernier(args, 120);
  }
  ProgramRun accept(const std::string& name, const std::string& reason = "looked at") {
    return vernier({"qa", "accept", suite(), name, "--reason", reason}, 60);
  }
  // A suite of one accepted case.
  void acceptedSlice() {
    writeCase("slice", sliceCase());
    const ProgramRun r = accept("slice");
    ASSERT_EQ(r.exitCode, 0) << show(r);
  }
};

TEST_F(Qa, AnAcceptedCasePassesOnBothEnginesAndTheReportStatesWhatWasTested) {
  acceptedSlice();
  const ProgramRun r =
      vernier({"qa", "run", suite(), "--out", path("report"), "--operator", "A. <Physicist>"}, 120);
  ASSERT_EQ(r.exitCode, 0) << show(r);
  EXPECT_EQ(r.err, "");
  const Json j = Json::parse(readFile(path("report/report.json")));
  EXPECT_EQ(j["schema"], "vernier-qa/1");
  EXPECT_EQ(j["verdict"], "pass");
  EXPECT_EQ(j["summary"].size(), 2u);
  for (const Json& s : j["summary"]) EXPECT_EQ(s["passed"], 1);
  for (const char* key : {"program", "plugins", "machine", "native", "gl", "operator"})
    EXPECT_TRUE(j["identity"].contains(key)) << key;
  EXPECT_EQ(j["identity"]["program"]["sha256"].get<std::string>().size(), 64u);
  EXPECT_TRUE(j["identity"]["gl"].is_object()) << j["identity"]["gl"];
  ASSERT_FALSE(j["identity"]["plugins"].empty());
  EXPECT_EQ(j["identity"]["plugins"][0]["sha256"].get<std::string>().size(), 64u);
  EXPECT_EQ(j["cases"][0]["data"]["sha256"].get<std::string>().size(), 64u);
  EXPECT_EQ(j["cases"][0]["mutants"]["caught"].size(), kMutants.size());
  EXPECT_EQ(j["started_utc"].get<std::string>().back(), 'Z');
  EXPECT_NE(j["scope"].get<std::string>().find("framebuffer"), std::string::npos);
  const std::string html = readFile(path("report/report.html"));
  EXPECT_EQ(html.find("http"), std::string::npos);  // nothing from the network
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<Physicist>"), std::string::npos);
  EXPECT_NE(html.find("A. &lt;Physicist&gt;"), std::string::npos);
  EXPECT_NE(html.find("photometer"), std::string::npos);
  EXPECT_NE(html.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(readFile(path("report/junit.xml")).find("tests=\"1\" failures=\"0\" errors=\"0\""),
            std::string::npos);
  for (const char* name : {"report.json", "report.html", "junit.xml"})
    EXPECT_EQ(readFile(path("report/") + name).find(dir_.path().string()), std::string::npos) << name;
}

TEST_F(Qa, MustFailMutantsAreCaughtAndTheCaseIsNamed) {
  acceptedSlice();
  const std::string expected = file("slice/expected.png");
  const Result<Picture> good = readPng(expected);
  ASSERT_TRUE(good.ok());
  for (const Mutant m : kMutants) {
    ASSERT_TRUE(writePng(expected, mutantOf(*good, m)).ok());
    const ProgramRun r = run();
    expectSentence(r, 4);
    EXPECT_NE(r.err.find("slice"), std::string::npos) << nameOf(m);
    EXPECT_NE(r.err.find("largest difference"), std::string::npos) << nameOf(m) << show(r);
  }
  ASSERT_TRUE(writePng(expected, *good).ok());
  EXPECT_EQ(run().exitCode, 0);
}

TEST_F(Qa, AWrongExpectedValueFails) {
  Json j = sliceCase();
  j["checks"][0]["left"] = "L";
  writeCase("slice", j);
  ASSERT_EQ(accept("slice").exitCode, 0);
  const ProgramRun r = run();
  expectSentence(r, 4);
  EXPECT_NE(r.err.find("letters on the left"), std::string::npos);
}

TEST_F(Qa, ATooWideToleranceIsRefused) {
  acceptedSlice();
  Json j = sliceCase();
  j["tolerance"] = {{"mean", 40}, {"why", "too wide"}};
  writeCase("slice", j);
  const ProgramRun r = run();
  expectSentence(r, 4);
  EXPECT_NE(r.err.find("would let pass"), std::string::npos) << r.err;
  j["guard"]["exempt"] = {{"mirrored", "not true"}};
  j["tolerance"] = {{"max", 1}, {"why", "rounding"}};
  writeCase("slice", j);
  EXPECT_NE(run().err.find("is not needed"), std::string::npos);
}

TEST_F(Qa, DamagedAndMissingCasesSayOneSentenceEachAndTheRestRuns) {
  acceptedSlice();
  fs::create_directories(file("damaged"));
  std::ofstream(file("damaged/case.json")) << "{\"schema\": \"vernier-qa-case/1\",";
  Json gone = sliceCase();
  gone["data"] = {{"path", "no-such.mha"}, {"sha256", "?"}};
  writeCase("gone", gone);
  Json unknown = sliceCase();
  unknown["tolerance"]["maximum"] = 3;
  writeCase("unknown", unknown);
  fs::create_directories(file("lost"));
  fs::copy_file(file("slice/expected.png"), file("lost/expected.png"));
  const ProgramRun r = run({"--out", path("report")});
  EXPECT_EQ(r.exitCode, 3) << show(r);
  EXPECT_EQ(r.lines(r.err), 4) << r.err;
  for (const char* name : {"damaged/case.json", "gone", "unknown/case.json#/tolerance/maximum", "lost"})
    EXPECT_NE(r.err.find(name), std::string::npos) << name << "\n" << r.err;
  const Json j = Json::parse(readFile(path("report/report.json")));
  EXPECT_EQ(j["verdict"], "fail");
  EXPECT_EQ(j["summary"][0]["cases"], 5);
  EXPECT_EQ(j["summary"][0]["passed"], 1);
  EXPECT_NE(readFile(path("report/junit.xml")).find("errors=\"4\""), std::string::npos);
  // Out of tolerance weighs more than damage.
  fs::remove(file("slice/expected.png"));
  EXPECT_EQ(run().exitCode, 4);
}

TEST_F(Qa, DataThatChangedIsToldByItsHash) {
  writeSmallStudy(file("data/study"));
  Json j = sliceCase();
  j["data"] = {{"path", "../data/study"}, {"sha256", "?"}};
  j.erase("checks");
  j["tolerance"] = {{"max", 0},
                    {"why", "drawn alike; the slopes are so gentle that a pixel's shift is one level"}};
  writeCase("own", j);
  const ProgramRun asks = run();
  expectSentence(asks, 3);
  const std::size_t at = asks.err.find("its hash is ");
  ASSERT_NE(at, std::string::npos) << asks.err;
  j["data"]["sha256"] = asks.err.substr(at + 12, 64);
  writeCase("own", j);
  const ProgramRun accepted = accept("own");
  ASSERT_EQ(accepted.exitCode, 0) << show(accepted);
  EXPECT_EQ(run().exitCode, 0);
  std::ofstream(file("data/study/s3.dcm"), std::ios::app) << "x";
  expectSentence(run(), 3);
}

TEST_F(Qa, AnEngineThatIsNotThereIsNotSkipped) {
  acceptedSlice();
  const ProgramRun r =
      runProgram({kProgram, "qa", "run", suite(), "--out", path("report")}, 60, {"VERNIER_GL=off"});
  expectSentence(r, 4);
  EXPECT_NE(r.err.find("gl: "), std::string::npos) << r.err;
  const Json j = Json::parse(readFile(path("report/report.json")));
  EXPECT_EQ(j["summary"][0]["verdict"], "pass");
  EXPECT_EQ(j["summary"][1]["verdict"], "fail");
  EXPECT_TRUE(j["identity"]["gl"].is_string());
  expectSentence(vernier({"qa", "run", suite(), "--out", ""}), 2);
}

TEST_F(Qa, AMissingBaselineFailsAndLeavesTheCandidate) {
  writeCase("slice", sliceCase());
  const ProgramRun r = run({"--out", path("report")});
  expectSentence(r, 4);
  EXPECT_TRUE(readPng(path("report/pictures/001-slice.native.png")).ok());
}

TEST_F(Qa, AcceptChangesOneCaseNeedsAReasonAndKeepsTheOld) {
  acceptedSlice();
  writeCase("other", sliceCase());
  ASSERT_EQ(accept("other").exitCode, 0);
  const std::string before = readFile(file("other/expected.png")), old = readFile(file("slice/expected.png"));
  expectSentence(accept("slice", " "), 2);
  expectSentence(accept("nothing"), 2);
  EXPECT_NE(accept("slice").out.find("nothing was changed"), std::string::npos);
  Json j = sliceCase();
  j["options"] = {"--window=60,300"};
  writeCase("slice", j);
  ASSERT_EQ(accept("slice", "another window").exitCode, 0);
  EXPECT_NE(readFile(file("slice/expected.png")), old);
  EXPECT_EQ(readFile(file("slice/history/expected-1.png")), old);
  EXPECT_EQ(readFile(file("other/expected.png")), before);
  const Json history = Json::parse(readFile(file("slice/history/accepted.json")));
  ASSERT_EQ(history["accepted"].size(), 2u);
  EXPECT_EQ(history["accepted"][1]["reason"], "another window");
  EXPECT_EQ(history["accepted"][1]["replaced"], "history/expected-1.png");
  EXPECT_EQ(history["accepted"][1]["replaced_sha256"], history["accepted"][0]["sha256"]);
  EXPECT_EQ(run().exitCode, 0);
  EXPECT_EQ(run({"--only", "nothing"}).exitCode, 2);
}

TEST_F(Qa, ABlankPictureIsNoBaseline) {
  Json j = sliceCase();
  j["options"] = {"--window=90000,1"};
  writeCase("slice", j);
  const ProgramRun r = accept("slice");
  expectSentence(r, 3);
  EXPECT_FALSE(fs::exists(file("slice/expected.png")));
}

TEST_F(Qa, ThePageIsMadeAgainFromTheReport) {
  acceptedSlice();
  ASSERT_EQ(run({"--out", path("report")}).exitCode, 0);
  const std::string page = readFile(path("report/report.html"));
  fs::remove(path("report/report.html"));
  ASSERT_EQ(vernier({"qa", "report", path("report")}).exitCode, 0);
  EXPECT_EQ(readFile(path("report/report.html")), page);
  std::ofstream(path("report/report.json")) << "{\"schema\": \"vernier-qa/1\"}";
  expectSentence(vernier({"qa", "report", path("report")}), 3);
  std::ofstream(path("report/report.json")) << "{";
  expectSentence(vernier({"qa", "report", path("report")}), 3);
  expectSentence(vernier({"qa", "report", path("nothing")}), 3);
}

TEST_F(Qa, AFullDiskOrAFileInTheWayIsOneSentence) {
  acceptedSlice();
  std::ofstream(path("taken")) << "a file";
  expectSentence(run({"--out", path("taken")}), 1);
  // Files of more than 4 KiB cannot be written here: as on a full disk.
  const ProgramRun full = runProgram({"/bin/bash", "-c",
                                      "trap '' XFSZ; ulimit -f 4; TMPDIR=/dev/shm exec " + kProgram +
                                          " qa accept " + suite() + " slice --reason full"},
                                     60);
  expectSentence(full, 1);
  const std::string old = readFile(file("slice/expected.png"));
  EXPECT_TRUE(readPng(file("slice/expected.png")).ok());
  EXPECT_EQ(readFile(file("slice/expected.png")), old);
  expectSentence(vernier({"qa", "run", path("no-such")}), 3);
  fs::create_directories(path("empty"));
  expectSentence(vernier({"qa", "run", path("empty")}), 3);
}

// Killed at any moment: the old baseline or the new one, never neither.
TEST_F(Qa, KilledWhileAcceptingTheOldOrTheNewBaselineIsThere) {
  acceptedSlice();
  const Result<Picture> first = readPng(file("slice/expected.png"));
  Json j = sliceCase();
  j["options"] = {"--window=60,300"};
  writeCase("slice", j);
  ASSERT_EQ(accept("slice").exitCode, 0);
  const Result<Picture> second = readPng(file("slice/expected.png"));
  ASSERT_TRUE(first.ok() && second.ok() && *first != *second);
  for (int round = 0; round < 24; ++round) {
    if (round % 2)
      writeCase("slice", j);
    else
      writeCase("slice", sliceCase());
    (void)vernier({"qa", "accept", suite(), "slice", "--reason", "killed"}, 0.01 + 0.01 * round);  // SIGKILL
    const Result<Picture> now = readPng(file("slice/expected.png"));
    ASSERT_TRUE(now.ok()) << round;
    EXPECT_TRUE(*now == *first || *now == *second) << round;
    EXPECT_FALSE(Json::parse(readFile(file("slice/history/accepted.json")), nullptr, false).is_discarded());
  }
}

TEST_F(Qa, GreenOnOneEngineAndRedOnTheOtherIsToldApart) {
  writeCase("mip", {{"schema", "vernier-qa-case/1"},
                    {"title", "Maximum"},
                    {"why", "Native maxima are exact, those of OpenGL are sampled."},
                    {"data", {{"recipe", "vessels"}, {"settings", {{"scale", "0.25"}}}}},
                    {"view", "mip"},
                    {"size", {128, 128}},
                    {"options", {"--camera=azimuth=30,elevation=20"}},
                    {"tolerance", {{"max", 0}, {"why", "exact"}}}});
  ASSERT_EQ(accept("mip").exitCode, 0);
  const ProgramRun r = vernier({"qa", "run", suite(), "--out", path("report")}, 120);
  expectSentence(r, 4);
  EXPECT_NE(r.err.find("gl: mip"), std::string::npos) << r.err;
  const Json j = Json::parse(readFile(path("report/report.json")));
  EXPECT_EQ(j["summary"][0]["verdict"], "pass");
  EXPECT_EQ(j["summary"][1]["verdict"], "fail");
  EXPECT_EQ(j["summary"][1]["not_passed"], Json({"mip"}));
}

}  // namespace
}  // namespace vernier::test
