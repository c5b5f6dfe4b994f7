// SPDX-License-Identifier: GPL-3.0-or-later
// Bad transfer functions and bad combiners: one sentence that says where, exit code 2, no picture.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "CliFixture.h"

namespace vernier::test {
namespace {
using testing::HasSubstr;

class CliVolume : public Cli {
 protected:
  void SetUp() override { study_ = writeSmallStudy(dir_.path() / "study"); }
  // With a settings folder of its own.
  ProgramRun render(const std::string& view, std::vector<std::string> more) {
    std::vector<std::string> args{kProgram, "render", study_, "--view", view, "--out", path("o.png")};
    args.insert(args.end(), more.begin(), more.end());
    return runProgram(args, 60, {"XDG_CONFIG_HOME=" + path("config")});
  }
  void expectRefused(const ProgramRun& r, const std::string& where, const std::string& what) {
    expectSentence(r, 2);
    EXPECT_THAT(r.err, HasSubstr(where));
    EXPECT_THAT(r.err, HasSubstr(what));
    EXPECT_EQ(r.err.find(dir_.path().string()), std::string::npos) << "no folder of the user: " << r.err;
    EXPECT_FALSE(fs::exists(path("o.png")));
  }
  std::string study_;
};

std::string transfer(const std::string& colours, const std::string& opacities, const std::string& more = "") {
  return R"({"colours": [)" + colours + R"(], "opacities": [)" + opacities + "]" + more + "}";
}

TEST_F(CliVolume, TransferFunctionsThatCannotBeUsed) {
  const std::string grey = "[0, 0, 0, 0], [900, 1, 1, 1]", ramp = "[0, 0], [900, 0.5]";
  std::string many;
  for (int n = 0; n <= 65536; ++n) many += (n ? ", [" : "[") + std::to_string(n) + ", 0.5]";
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {transfer("[0, 0, 0, NaN]", ramp), "/colours/0/3", "not JSON"},
      {transfer(grey, "[0, 0], [NaN, 1]"), "/opacities/1/0", "not JSON"},
      {transfer(grey, "[0, 0], [1e999, 1]"), "/opacities/1", "too large"},
      {transfer(grey, "[900, 0], [0, 1]"), "/opacities/1", ""},
      {transfer("[900, 0, 0, 0], [0, 1, 1, 1]", ramp), "/colours/1", ""},
      {transfer("", ramp), "/colours", ""},
      {transfer(grey, ""), "/opacities", ""},
      {transfer(grey, "[0, 0], [900, 1.5]"), "/opacities/1", ""},
      {transfer(grey, "[0, 0], [900, -0.5]"), "/opacities/1", ""},
      {transfer("[0, 0, 0, 2]", ramp), "/colours/0", ""},
      {transfer(grey, "[0, 0, 0]"), "/opacities/0", "list of 2 numbers"},
      {transfer(grey, "[0, \"1\"]"), "/opacities/0/1", "number is expected"},
      {transfer(grey, ramp, ", \"opacity_length_mm\": 0"), "/opacity_length_mm", ""},
      {transfer(grey, ramp, ", \"opacity\": 1"), "/opacity", ""},
      {transfer(grey, many), "/opacities", "65537 points"},
      {"", "", "not JSON"},
      {"[]", "", ""},
  };
  for (const auto& [json, where, what] : cases) {
    SCOPED_TRACE(json.substr(0, 100));
    expectRefused(render("dvr", {"--transfer", write("tf.json", json)}), where, what);
  }
  expectSentence(render("dvr", {"--transfer", path("absent.json")}), 3);
}

TEST_F(CliVolume, TransferFunctionOfTenThousandPoints) {
  std::string colours, opacities;
  for (int n = 0; n < 10000; ++n) {
    const std::string value = (n ? ", [" : "[") + std::to_string(n * 0.1) + ", ";
    colours += value + (n % 2 ? "1, 0, 0]" : "0, 1, 0]");
    opacities += value + (n % 2 ? "0.5]" : "0]");
  }
  const ProgramRun r = render("dvr", {"--transfer", write("tf.json", transfer(colours, opacities))});
  EXPECT_EQ(r.exitCode, 0) << show(r);
  EXPECT_TRUE(fs::exists(path("o.png")));
}

TEST_F(CliVolume, CombinersThatCannotBeUsed) {
  fs::create_directories(dir_.path() / "config/vernier/combiners");
  const auto add = [&](const std::string& name, const std::string& json) {
    write("config/vernier/combiners/" + name + ".json", json);
  };
  const std::string head =
      R"({"schema": 1, "title": "t", "inputs": {"texture0": "colour"}, "stages": [{"rgb": )";
  const std::string tail = R"(}], "final": {"D": "spare0", "G": "texture0"}})";
  add("register", head + R"({"A": "texture99", "B": "one", "AB": "spare0"})" + tail);
  add("output", head + R"({"A": "texture0", "B": "one"})" + tail);
  add("round", R"({"schema": 1, "title": "t", "base": "about"})");
  add("about", R"({"schema": 1, "title": "t", "base": "round"})");
  add("cut", head);
  for (const char* view : {"dvr", "iso"}) {
    SCOPED_TRACE(view);
    expectRefused(render(view, {"--combiner", "register"}), "register.json#/stages/0/rgb/A", "no register");
    expectRefused(render(view, {"--combiner", "output"}), "output.json#/stages/0/rgb", "no output");
    expectRefused(render(view, {"--combiner", "round"}), "about.json#/base", "in a circle");
    expectRefused(render(view, {"--combiner", "cut"}), "cut.json#", "not JSON");
    expectRefused(render(view, {"--combiner", "no-such"}), "no-such", "; there are ");
    expectRefused(render(view, {"--combiner", "../iso"}), "", "; there are ");
  }
}

TEST_F(CliVolume, ShippedCombinersAreListed) {
  const auto all = nlohmann::json::parse(vernier({"plugins", "--json"}).out)["plugins"];
  nlohmann::json names;
  for (const auto& p : all)
    if (p["name"] == "dvr") names = p["data"]["combiners"];
  EXPECT_THAT(names.get<std::vector<std::string>>(),
              testing::IsSupersetOf({"intermediate-slice", "two-slices", "iso", "iso-two-lights",
                                     "shaded-global", "shaded-per-voxel", "strip"}));
}

}  // namespace
}  // namespace vernier::test
