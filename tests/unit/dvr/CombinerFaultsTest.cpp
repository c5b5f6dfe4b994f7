// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with a combiner file is said in a sentence, with the place in the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "CombinerForTest.h"
#include "vernier/base/Random.h"

namespace vernier::dvr {
namespace {
using testing::HasSubstr;

constexpr const char* kGood = R"({"schema": 1, "title": "t",
  "inputs": {"texture0": "colour[0]", "texture1": "colour", "constant0.alpha": "interpolation", "primary": [1, 0, 0.5, -1]},
  "stages": [{"rgb": {"A": "texture0", "B": "inverted constant0.alpha", "C": "texture1", "D": "constant0.alpha", "AB+CD": "spare0"},
              "alpha": {"A": "texture0", "B": "one", "AB": "spare0"}}],
  "final": {"D": "spare0", "G": "spare0"}, "blend": "over", "test": "none"})";

struct Fault {
  std::string from, to;  // what is replaced in kGood, once
  std::string where, sentence;
};

void expectFault(const std::string& json, const std::string& where, const std::string& sentence) {
  const Result<Combiner> c = parseCombiner(json, "mine");
  ASSERT_FALSE(c.ok()) << json;
  EXPECT_EQ(c.error().code, ErrorCode::SceneInvalid);
  EXPECT_EQ(c.error().where, "mine.json#" + where) << c.error().sentence;
  EXPECT_THAT(c.error().sentence, HasSubstr(sentence));
}

void expectFaults(const std::vector<Fault>& faults) {
  for (const Fault& f : faults) {
    std::string json = kGood;
    const std::size_t at = json.find(f.from);
    ASSERT_NE(at, std::string::npos) << f.from;
    json.replace(at, f.from.size(), f.to);
    SCOPED_TRACE(f.to);
    expectFault(json, f.where, f.sentence);
  }
}

TEST(CombinerFaults, TheGoodFileIsGood) {
  const Result<Combiner> c = parseCombiner(kGood, "mine");
  ASSERT_TRUE(c.ok()) << c.error().text();
  EXPECT_EQ(c->name, "mine");
  EXPECT_EQ(c->title, "t");
  ASSERT_EQ(c->inputs.size(), 4u);
  EXPECT_TRUE(parseCombiner(std::string("\xEF\xBB\xBF") + kGood, "mine").ok());
}

TEST(CombinerFaults, RegistersPartsAndMappings) {
  expectFaults({
      {"\"A\": \"texture0\"", "\"A\": \"texture8\"", "/stages/0/rgb/A",
       "'texture8' is no register; there are texture0 to texture7"},
      {"\"A\": \"texture0\"", "\"A\": \"Texture0\"", "/stages/0/rgb/A", "no register"},
      {"\"A\": \"texture0\"", "\"A\": \"\"", "/stages/0/rgb/A", "no register"},
      {"\"A\": \"texture0\"", "\"A\": \"one.alpha\"", "/stages/0/rgb/A", "no register"},
      {"\"A\": \"texture0\"", "\"A\": \"E*F\"", "/stages/0/rgb/A",
       "E*F is for A, B, C and D of the final stage"},
      {"\"A\": \"texture0\"", "\"A\": 3", "/stages/0/rgb/A", "A text is expected"},
      {"inverted constant0.alpha", "invert constant0.alpha", "/stages/0/rgb/B",
       "'invert' is no mapping; there are unsigned, inverted, expand, signed, negate"},
      {"inverted constant0.alpha", "inverted one", "/stages/0/rgb/B", "'one' takes no mapping"},
      {"inverted constant0.alpha", "inverted constant0.a", "/stages/0/rgb/B", "'a' is no part"},
      {"inverted constant0.alpha", "constant0.blue", "/stages/0/rgb/B", "blue is for the alpha portion"},
      {"\"A\": \"texture0\", \"B\": \"one\"", "\"A\": \"texture0.rgb\", \"B\": \"one\"", "/stages/0/alpha/A",
       "reads alpha or blue, not rgb"},
      {"\"G\": \"spare0\"", "\"G\": \"spare0.rgb\"", "/final/G", "reads alpha or blue, not rgb"},
      {"\"D\": \"spare0\"", "\"D\": \"signed spare0\"", "/final/D",
       "The final stage does not know the mapping 'signed'; it has unsigned, inverted"},
      {"\"AB+CD\": \"spare0\"", "\"AB+CD\": \"constant1\"", "/stages/0/rgb/AB+CD",
       "'constant1' cannot be written"},
      {"\"AB+CD\": \"spare0\"", "\"AB+CD\": \"zero\"", "/stages/0/rgb/AB+CD", "cannot be written"},
      {"\"AB+CD\": \"spare0\"", "\"AB+CD\": \"spare0.rgb\"", "/stages/0/rgb/AB+CD", "without part"},
  });
}

TEST(CombinerFaults, OutputsAndOperands) {
  expectFaults({
      {", \"AB+CD\": \"spare0\"", "", "/stages/0/rgb", "The portion has no output"},
      {", \"AB\": \"spare0\"", ", \"A.B\": \"spare0\"", "/stages/0/alpha/A.B",
       "A dot product is of the RGB portion"},
      {"\"AB+CD\": \"spare0\"", "\"AB+CD\": \"spare0\", \"A.B\": \"spare1\"", "/stages/0/rgb/AB+CD",
       "With a dot product there is no sum"},
      {"\"AB+CD\": \"spare0\"", "\"AB\": \"spare0\", \"A.B\": \"spare1\"", "/stages/0/rgb/A.B",
       "AB or A.B, not both"},
      {"\"AB+CD\": \"spare0\"", "\"AB\": \"spare0\", \"CD\": \"spare0\"", "/stages/0/rgb",
       "the same register"},
      {"\"AB+CD\": \"spare0\"", "\"AB\": \"spare0\"", "/stages/0/rgb/C", "C is in no output"},
      {"\"A\": \"texture0\", ", "", "/stages/0/rgb", "An output needs A, which is missing"},
      {"\"AB+CD\": \"spare0\"", "\"AB+CD\": \"spare0\", \"scale\": 3", "/stages/0/rgb/scale",
       "0.5, 1, 2 or 4"},
      {"\"AB+CD\": \"spare0\"", "\"AB+CD\": \"spare0\", \"bias\": 0.5", "/stages/0/rgb/bias", "0 or -0.5"},
      {"\"AB+CD\": \"spare0\"", "\"AB+CD\": \"spare0\", \"mux\": 1", "/stages/0/rgb/mux",
       "The key 'mux' is not known here; there are A, B"},
      {", \"G\": \"spare0\"", "", "/final", "The alpha is missing"},
      {"\"D\": \"spare0\", ", "", "/final", "The colour is missing"},
      {"\"D\": \"spare0\", ", "\"D\": \"E*F\", \"E\": \"spare0\", ", "/final", "needs F"},
      {"\"D\": \"spare0\", ", "\"D\": \"spare0\", \"E\": \"spare0\", ", "/final/E", "E is in no output"},
  });
}

TEST(CombinerFaults, WhatIsReadBeforeItHoldsAnything) {
  expectFaults({
      {"\"A\": \"texture0\"", "\"A\": \"spare0\"", "/stages/0/rgb/A",
       "spare0.rgb is read before it holds anything; stage 0 writes it"},
      {"\"A\": \"texture0\"", "\"A\": \"spare1\"", "/stages/0/rgb/A",
       "spare1.rgb is read, but no stage writes it"},
      {"\"A\": \"texture0\"", "\"A\": \"texture2\"", "/stages/0/rgb/A",
       "texture2.rgb is read, but neither 'inputs' nor a stage before fills it"},
      {"\"A\": \"texture0\"", "\"A\": \"constant0\"", "/stages/0/rgb/A", "constant0.rgb is read"},
      {"\"B\": \"one\"", "\"B\": \"constant0.blue\"", "/stages/0/alpha/B", "constant0.rgb is read"},
      {"\"D\": \"spare0\"", "\"D\": \"spare1\"", "/final/D", "no stage writes it"},
      {"\"G\": \"spare0\"", "\"G\": \"secondary\"", "/final/G", "secondary.alpha is read"},
  });
}

TEST(CombinerFaults, Inputs) {
  expectFaults({
      {"\"texture1\": \"colour\"", "\"texture1\": \"color\"", "/inputs/texture1",
       "'color' is no quantity; there are colour[n]"},
      {"\"texture1\": \"colour\"", "\"texture1\": \"colour[8]\"", "/inputs/texture1",
       "the number of a slice, 0 to 7"},
      {"\"texture1\": \"colour\"", "\"texture1\": \"colour[1\"", "/inputs/texture1", "the number of a slice"},
      {"\"texture1\": \"colour\"", "\"texture1\": \"colour[]\"", "/inputs/texture1", "the number of a slice"},
      {"\"texture1\": \"colour\"", "\"texture1\": \"colour[-1]\"", "/inputs/texture1",
       "the number of a slice"},
      {"\"texture1\": \"colour\"", "\"texture1\": \"interpolation\"", "/inputs/texture1", "not a texture"},
      {"\"texture1\": \"colour\"", "\"texture1.rgb\": \"colour\"", "/inputs/texture1.rgb",
       "a whole register: write 'texture1'"},
      {"\"texture1\": \"colour\"", "\"texture1\": \"normal[1]\"", "/inputs/texture1",
       "one part: write 'texture1.rgb'"},
      {"\"texture1\": \"colour\"", "\"texture1\": [0, 0, 0, 1]", "/inputs/texture1",
       "cannot be filled with numbers"},
      {"\"texture1\": \"colour\"", "\"texture1\": null", "/inputs/texture1", "A quantity or numbers"},
      {"\"texture1\": \"colour\"", "\"texture9\": \"colour\"", "/inputs/texture9",
       "'texture9' is no register that can be filled"},
      {"\"texture1\": \"colour\"", "\"spare0\": \"colour\"", "/inputs/spare0",
       "no register that can be filled"},
      {"\"texture1\": \"colour\"", "\"a/b~c\": \"colour\"", "/inputs/a~1b~0c",
       "no register that can be filled"},
      {"\"constant0.alpha\"", "\"constant0.rgb\"", "/inputs/constant0.rgb",
       "'interpolation' has no rgb part"},
      {"\"constant0.alpha\"", "\"constant0.red\"", "/inputs/constant0.red", "'red' is no part"},
      {"\"constant0.alpha\": \"interpolation\"", "\"constant0.alpha\": \"interpolation[0]\"",
       "/inputs/constant0.alpha", "takes no number"},
      {"\"constant0.alpha\": \"interpolation\"", "\"constant0.rgb\": \"light-direction[4]\"",
       "/inputs/constant0.rgb", "the number of a light, 0 to 3"},
      {"\"constant0.alpha\": \"interpolation\"", "\"primary.alpha\": \"interpolation\"",
       "/inputs/primary.alpha", "primary is filled twice"},
      {"[1, 0, 0.5, -1]", "[1, 0, 0.5]", "/inputs/primary", "A list of 4 numbers"},
      {"[1, 0, 0.5, -1]", "[1, 0, 0.5, -1.5]", "/inputs/primary/3", "-1 to 1"},
      {"[1, 0, 0.5, -1]", "[1, 0, null, 1]", "/inputs/primary/2", "A number is expected"},
      {"\"primary\": [1, 0, 0.5, -1]", "\"primary.alpha\": [1]", "/inputs/primary.alpha",
       "One number is expected"},
  });
}

TEST(CombinerFaults, TheFileAsAWhole) {
  expectFaults({
      {"\"schema\": 1", "\"schema\": 2", "/schema", "Only schema 1"},
      {"\"schema\": 1, ", "", "", "The key 'schema' is missing"},
      {"\"title\": \"t\",", "", "", "The key 'title' is missing"},
      {"\"blend\": \"over\"", "\"blend\": \"multiply\"", "/blend",
       "none of: off, over, weighted, transmission"},
      {"\"test\": \"none\"", "\"test\": 1", "/test", "A text is expected"},
      {"\"test\": \"none\"", "\"tests\": \"none\"", "/tests", "The key 'tests' is not known here"},
      {"\"test\": \"none\"", "\"blend\": \"off\"", "", "The key 'blend' stands twice"},
      {"\"test\": \"none\"", "\"base\": \"iso\"", "/base", "only where the others are known"},
      {"\"stages\": [{", "\"stages\": [{}, {", "/stages/0", "The stage has no output"},
      {"\"stages\": [{", "\"stages\": [7, {", "/stages/0", "An object is expected"},
      {"\"final\": {", "\"final\": [{", "", "is not JSON from byte"},
      {"\"final\": {\"D\": \"spare0\", \"G\": \"spare0\"}", "\"final\": []", "/final",
       "An object is expected"},
      {"\"final\": {\"D\": \"spare0\", \"G\": \"spare0\"}, ", "", "", "The key 'final' is missing"},
      {"[1, 0, 0.5, -1]", "[1, 0, 0.5, 1e999]", "", "too large for a double"},
      {"[1, 0, 0.5, -1]", "[1, 0, 0.5, NaN]", "", "is not JSON from byte"},
  });
  expectFault("", "", "is not JSON from byte");
  expectFault("[]", "", "An object is expected");
  expectFault(std::string(70000, ' '), "", "70000 bytes; at most 65536");
  expectFault(std::string(30000, '['), "", "is not JSON");
  expectFault("{\"schema\": 1, \"title\": \"\xff\"}", "", "is not JSON");
}

std::string withStages(std::size_t count) {
  std::string stages;
  for (std::size_t n = 0; n < count; ++n)
    stages += std::string(n ? ", " : "") + R"({"rgb": {"A": "texture0", "B": "one", "AB": "spare0"}})";
  return R"({"schema": 1, "title": "t", "inputs": {"texture0": "colour"}, "stages": [)" + stages +
         R"(], "final": {"D": "spare0", "G": "texture0"}})";
}

TEST(CombinerFaults, NumberOfStages) {
  expectFault(withStages(0), "/stages", "There are 0 stages; a combiner has 1 to 8");
  EXPECT_TRUE(parseCombiner(withStages(8), "mine").ok());
  expectFault(withStages(9), "/stages", "There are 9 stages; a combiner has 1 to 8");
}

TEST(CombinerFaults, ALaterStageWritesIt) {
  expectFault(R"({"schema": 1, "title": "t", "inputs": {"texture0": "colour"}, "stages": [
    {"rgb": {"A": "spare1", "B": "one", "AB": "spare0"}},
    {"rgb": {"A": "spare0", "B": "one", "AB": "spare1"}}], "final": {"D": "spare0", "G": "texture0"}})",
              "/stages/0/rgb/A", "stage 1 writes it, and stages run in order");
}

Result<Combiner> based(const std::map<std::string, std::string>& files, const std::string& name) {
  const BaseText text = [&](const std::string& n) -> Result<std::string> {
    if (files.count(n)) return files.at(n);
    return makeError(ErrorCode::SceneInvalid, "There is no combiner '" + n + "'.", n);
  };
  return parseCombiner(files.at(name), name, text);
}
std::string onlyBase(const std::string& base) {
  return R"({"schema": 1, "title": "t", "base": ")" + base + "\"}";
}

TEST(CombinerFaults, CirclesAndMissingBases) {
  const auto circle = based({{"a", onlyBase("b")}, {"b", onlyBase("c")}, {"c", onlyBase("a")}}, "a");
  ASSERT_FALSE(circle.ok());
  EXPECT_EQ(circle.error().code, ErrorCode::SceneInvalid);
  EXPECT_EQ(circle.error().where, "c.json#/base");
  EXPECT_THAT(circle.error().sentence, HasSubstr("in a circle: a, based on b, based on c, based on a."));
  const auto self = based({{"a", onlyBase("a")}}, "a");
  ASSERT_FALSE(self.ok());
  EXPECT_THAT(self.error().sentence, HasSubstr("circle: a, based on a."));
  const auto missing = based({{"a", onlyBase("z")}}, "a");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().where, "a.json#/base");
  EXPECT_THAT(missing.error().sentence, HasSubstr("no combiner 'z'"));
}

TEST(CombinerFaults, WhatIsTakenFromABaseMustStillFit) {
  const std::string other =
      R"({"schema": 1, "title": "t", "base": "good", "final": {"D": "spare1", "G": "spare0"}})";
  auto c = based({{"good", kGood}, {"a", other}}, "a");
  ASSERT_FALSE(c.ok());
  EXPECT_EQ(c.error().where, "a.json#/final/D");
  // The base's stages read a part that the own inputs no longer fill.
  const std::string inputs =
      R"({"schema": 1, "title": "t", "base": "good", "inputs": {"texture1.rgb": "normal"}})";
  c = based({{"good", kGood}, {"a", inputs}}, "a");
  ASSERT_TRUE(c.ok()) << c.error().text();
  const std::string narrow =
      R"({"schema": 1, "title": "t", "base": "good", "inputs": {"texture0.rgb": "normal"}})";
  c = based({{"good", kGood}, {"a", narrow}}, "a");
  ASSERT_FALSE(c.ok());
  EXPECT_EQ(c.error().where, "a.json#/base/0/alpha/A");
  EXPECT_THAT(c.error().sentence, HasSubstr("texture0.alpha is read"));
}

// Files damaged at random are refused as SceneInvalid, or are combiners whose values are colours.
TEST(CombinerFaults, DamagedFilesAreRefusedOrGood) {
  const std::string whole = kGood, signs = "{}[]\",:.0123456789-ABCDEFGaeghilnoprstuxy* \n\xc3";
  int good = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    std::string json = whole;
    const std::uint64_t edits = 1 + randomBits(seed, 0) % 3;
    for (std::uint64_t e = 1; e <= edits; ++e) {
      const std::size_t at = randomBits(seed, 10 * e) % json.size();
      const char sign = signs[randomBits(seed, 10 * e + 1) % signs.size()];
      switch (randomBits(seed, 10 * e + 2) % 3) {
        case 0:
          json[at] = sign;
          break;
        case 1:
          json.erase(at, 1 + randomBits(seed, 10 * e + 3) % 12);
          break;
        default:
          json.insert(at, 1, sign);
      }
    }
    const Result<Combiner> c = parseCombiner(json, "mine");
    if (!c) {
      ASSERT_EQ(c.error().code, ErrorCode::SceneInvalid) << c.error().text() << json;
      ASSERT_EQ(c.error().where.rfind("mine.json#", 0), 0u) << json;
      continue;
    }
    ++good;
    const glm::dvec4 x = combine(*c, filledRegisters(*c, [](const Input&) { return glm::dvec4(0.5); }));
    for (glm::length_t n = 0; n < 4; ++n) ASSERT_TRUE(x[n] >= 0 && x[n] <= 1) << json;
  }
  EXPECT_GT(good, 10);  // some damage does no harm: a space more, another title
}

}  // namespace
}  // namespace vernier::dvr
