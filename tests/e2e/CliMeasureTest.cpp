// SPDX-License-Identifier: GPL-3.0-or-later
// `vernier measure` on phantoms whose answers are known, and what it says when it cannot.
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "CliFixture.h"

namespace vernier::test {
namespace {

using Json = nlohmann::json;

class Measure : public Cli {
 protected:
  ProgramRun measure(const std::string& input, const Json& list, std::vector<std::string> more = {"--json"}) {
    std::vector<std::string> args{"measure", input, "--spec",
                                  write("spec.json", Json{{"schema", 1}, {"measurements", list}}.dump())};
    args.insert(args.end(), more.begin(), more.end());
    return vernier(args, 60);
  }
  // The phantom and its answers.
  Json ruler(std::vector<std::string> settings) {
    std::vector<std::string> args{"phantom", "ruler", "--out", path("p")};
    for (const std::string& s : settings) args.insert(args.end(), {"--set", s});
    EXPECT_EQ(vernier(args, 60).exitCode, 0);
    return Json::parse(readFile(dir_.path() / "p/ruler.answers.json"));
  }
  std::string rulerPath() const { return path("p/ruler"); }
};

const Json& named(const Json& list, const std::string& name) {
  for (const Json& x : list)
    if (x["name"] == name) return x;
  throw std::runtime_error("no " + name);
}

TEST_F(Measure, TheRulerPhantomsAnswersAreMet) {
  for (const std::vector<std::string>& settings :
       {std::vector<std::string>{"scale=0.5"},
        {"scale=0.5", "oblique=25"},
        {"scale=0.5", "slice-aspect=5", "flip=5"},
        {"scale=1", "slice-aspect=50", "pixel-aspect=2", "plane=sagittal"}}) {
    SCOPED_TRACE(settings.back());
    const Json answers = ruler(settings);
    Json list = Json::array();
    std::vector<Json> asked;
    for (const Json& m : answers["measures"]) {
      if (m["kind"] != "length" && m["kind"] != "angle") continue;
      Json points = m["points_mm"];
      list.push_back({{"id", m["name"]}, {"kind", m["kind"]}, {"space", "patient"}, {"points", points}});
      asked.push_back(m);
    }
    ASSERT_GE(list.size(), 8u);
    const ProgramRun r = measure(rulerPath(), list);
    ASSERT_EQ(r.exitCode, 0) << show(r);
    const Json out = Json::parse(r.out);
    for (std::size_t n = 0; n < asked.size(); ++n) {
      const Json q = out["measurements"][n]["result"]["quantities"][0];
      const double truth = asked[n]["value"];
      EXPECT_NEAR(q["value"].get<double>(), truth, 1e-9 * truth) << asked[n];
      EXPECT_GT(q["expanded"].get<double>(), 0);
      EXPECT_EQ(out["measurements"][n]["result"]["origin"], "pixel_spacing");
    }
  }
}

TEST_F(Measure, AreasAndVolumesOfTheRulerPhantomLieWithinTheirUncertainty) {
  const Json answers = ruler({"scale=1"});
  const auto truth = [&](const char* name) {
    return named(answers["measures"], name)["value"].get<double>();
  };
  const Json axes = {{"space", "patient"}, {"normal", {0, 0, -1}}, {"up", {0, -1, 0}}};
  const auto region = [&](Json m) {
    m.update(axes);
    return m;
  };
  const ProgramRun r =
      measure(rulerPath(),
              {region({{"id", "disc"}, {"kind", "threshold"}, {"level", 250}, {"seed", {25, 25, 0.375}}}),
               region({{"id", "ellipse"}, {"kind", "threshold"}, {"level", 200}, {"seed", {-20, 30, 0.375}}}),
               region({{"id", "plate"}, {"kind", "threshold"}, {"level", 150}, {"seed", {25, -12, 0.375}}}),
               region({{"id", "drawn"}, {"kind", "ellipse"}, {"points", {{10, 10, 0.375}, {40, 40, 0.375}}}}),
               {{"id", "ball"},
                {"kind", "iso_volume"},
                {"space", "patient"},
                {"level", 350},
                {"seed", {-15, -10, 0.2}}}});
  ASSERT_EQ(r.exitCode, 0) << show(r);
  const Json out = Json::parse(r.out)["measurements"];
  for (const auto& [n, name] : {std::pair{0, "disc"}, {1, "ellipse"}, {2, "plate"}, {4, "ball"}}) {
    const Json q = out[static_cast<std::size_t>(n)]["result"]["quantities"][0];
    EXPECT_NEAR(q["value"].get<double>(), truth(name), q["expanded"].get<double>()) << name;
    EXPECT_LT(q["expanded"].get<double>(), 0.05 * truth(name)) << name;
  }
  EXPECT_NEAR(out[3]["result"]["quantities"][0]["value"].get<double>(), M_PI * 225, 1e-9 * 700);
  EXPECT_EQ(out[3]["result"]["statistics"]["median"], 500);
}

TEST_F(Measure, WhatIsWrittenReadsBackAndMeasuresTheSame) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const Json list = {{{"kind", "length"}, {"space", "image"}, {"frame", 3}, {"points", {{1, 1}, {9, 7}}}},
                     {{"kind", "ellipse"}, {"space", "image"}, {"frame", 3}, {"points", {{2, 2}, {12, 9}}}},
                     {{"kind", "text"}, {"space", "image"}, {"point", {2, 2}}, {"text", "note"}}};
  const ProgramRun first = measure(study, list, {"--out", path("a.json")});
  ASSERT_EQ(first.exitCode, 0) << show(first);
  EXPECT_NE(first.out.find("mm (Pixel Spacing)"), std::string::npos) << first.out;
  const ProgramRun again =
      vernier({"measure", study, "--spec", path("a.json"), "--out", path("b.json"), "--threads", "1"});
  ASSERT_EQ(again.exitCode, 0) << show(again);
  EXPECT_EQ(readFile(path("a.json")), readFile(path("b.json")));
  EXPECT_EQ(again.out, first.out);
  const Json a = Json::parse(readFile(path("a.json")));
  EXPECT_EQ(a["measurements"][0]["result"]["frame_number"], 1);
  EXPECT_FALSE(a["measurements"][0]["result"]["sop_instance_uid"].get<std::string>().empty());
  EXPECT_NEAR(a["measurements"][0]["result"]["quantities"][0]["value"].get<double>(),
              std::hypot(8.0, 6 * 1.25), 1e-12);
}

TEST_F(Measure, OneThatCannotBeMadeIsRefusedAndTheRestIsDone) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const Json good = {{"kind", "length"}, {"space", "image"}, {"points", {{1, 1}, {4, 5}}}};
  const Json bad = {
      {"id", "arm"}, {"kind", "angle"}, {"space", "image"}, {"points", {{1, 1}, {1, 1}, {4, 5}}}};
  const ProgramRun r = measure(study, {bad, good});
  expectSentence(r, 2);
  EXPECT_NE(r.err.find("arm"), std::string::npos) << r.err;
  const Json out = Json::parse(r.out)["measurements"];
  EXPECT_TRUE(out[0].contains("refused"));
  EXPECT_TRUE(out[1].contains("result"));
}

TEST_F(Measure, MistakesAreSentencesWithTheirPlace) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  ProgramRun r =
      measure(study, {{{"kind", "length"}, {"space", "image"}, {"points", {{1, 1}, {4, 5}}}, {"colour", 1}}});
  expectSentence(r, 2);
  EXPECT_NE(r.err.find("/measurements/0/colour"), std::string::npos) << r.err;
  expectSentence(vernier({"measure", study, "--spec", write("x.json", "{\"schema\": 1,")}), 2);
  expectSentence(vernier({"measure", study, "--spec", path("none.json")}), 3);
  expectSentence(vernier({"measure", study}), 2);
  r = measure(path("no-such-study"), Json::array());
  expectSentence(r, 3);
  r = measure(study, Json::array(), {"--sr", path("a.dcm")});
  expectSentence(r, 1);
  EXPECT_NE(r.err.find("not built yet"), std::string::npos);
  const std::string slice = study + "/s0.dcm", before = readFile(slice);
  expectSentence(measure(study, Json::array(), {"--out", slice}), 2);
  EXPECT_EQ(readFile(slice), before) << "a source is never overwritten";
  if (::geteuid() != 0) {
    fs::create_directory(path("locked"));
    fs::permissions(path("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    expectSentence(measure(study, Json::array(), {"--out", path("locked/a.json")}), 1);
  }
  expectSentence(measure(study, Json::array(), {"--out", path("no-such-folder/a.json")}), 1);
}

TEST_F(Measure, ADeathWhileWritingLeavesTheOldFileOrTheNew) {
  const std::string study = writeSmallStudy(dir_.path() / "s");
  Json list = Json::array();
  for (int n = 0; n < 3000; ++n)
    list.push_back(
        {{"kind", "arrow"}, {"space", "patient"}, {"points", {{n, 0.1, 0.2}, {1, 2, 3}}}, {"text", "here"}});
  const std::string out = path("out.json");
  ASSERT_EQ(measure(study, list, {"--out", out}).exitCode, 0);
  const std::string whole = readFile(out);
  std::mt19937 random(5);
  int killed = 0;
  for (int n = 0; n < 25; ++n) {
    write("out.json", "old");
    const ProgramRun r = vernier({"measure", study, "--spec", path("spec.json"), "--out", out},
                                 std::uniform_real_distribution<double>(0.005, 0.4)(random));
    killed += r.timedOut;
    const std::string found = readFile(out);
    EXPECT_TRUE(found == "old" || found == whole) << found.size();
  }
  EXPECT_GT(killed, 0) << "nothing was tried";
}

TEST_F(Measure, WithoutItsPluginNothingIsMeasured) {
  // The program with a library folder of its own, from which the plugin was taken.
  const fs::path bin = dir_.path() / "bin", lib = dir_.path() / "lib/vernier/plugins";
  fs::create_directories(bin);
  fs::create_directories(lib);
  fs::copy_file(kProgram, bin / "vernier");
  const fs::path built = fs::path(kProgram).parent_path().parent_path() / "lib";
  for (const auto& e : fs::directory_iterator(built))
    if (e.path().filename().string().starts_with("libvernier.so"))
      fs::copy(e.path(), dir_.path() / "lib" / e.path().filename(), fs::copy_options::copy_symlinks);
  const std::string study = writeSmallStudy(dir_.path() / "s");
  const std::string spec = write("spec.json", R"({"schema": 1, "measurements": []})");
  const ProgramRun without = runProgram({(bin / "vernier").string(), "measure", study, "--spec", spec}, 20);
  expectSentence(without, 1);
  EXPECT_NE(without.err.find("plugin"), std::string::npos) << without.err;
  fs::copy(built / "vernier/plugins/measure", lib / "measure", fs::copy_options::recursive);
  const ProgramRun with = runProgram({(bin / "vernier").string(), "measure", study, "--spec", spec}, 20);
  EXPECT_EQ(with.exitCode, 0) << show(with);
}

}  // namespace
}  // namespace vernier::test
