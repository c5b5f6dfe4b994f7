// SPDX-License-Identifier: GPL-3.0-or-later
// Reading a case strictly, and judging pictures by its bounds.
#include "QaCase.h"

#include <gtest/gtest.h>

#include "QaDocument.h"
#include "QaRun.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;

Json good() {
  return {{"schema", "vernier-qa-case/1"},
          {"title", "t"},
          {"why", "w"},
          {"data", {{"recipe", "ruler"}, {"settings", {{"plane", "axial"}}}}},
          {"view", "axial"},
          {"options", {"--window=40,80"}},
          {"size", {64, 48}},
          {"tolerance", {{"max", 1}, {"above", {{"level", 0}, {"share", 0.5}}}, {"why", "y"}}},
          {"guard", {{"least_levels", 3}, {"exempt", {{"mirrored", "symmetric"}}}}},
          {"checks", {{{"kind", "pixel"}}}}};
}

TEST(QaCase, EveryKeyIsRead) {
  const auto c = parseQaCase(good().dump(), "/f", "n");
  ASSERT_TRUE(c.ok()) << c.error().text();
  EXPECT_EQ(c->data->recipe, "ruler");
  EXPECT_EQ(c->data->settings.at("plane"), "axial");
  EXPECT_EQ(c->width_px, 64);
  EXPECT_EQ(c->height_px, 48);
  EXPECT_EQ(c->options, std::vector<std::string>{"--window=40,80"});
  EXPECT_EQ(*c->tolerance->max, 1);
  EXPECT_EQ(c->tolerance->above->share, 0.5);
  EXPECT_EQ(c->leastLevels, 3);
  EXPECT_EQ(c->exempt.at(Mutant::Mirrored), "symmetric");
  EXPECT_EQ(c->checks.size(), 1u);
  EXPECT_EQ(c->expectedFile(), "/f/expected.png");
}

TEST(QaCase, WhatIsWrongIsRefusedWithItsPlace) {
  struct Wrong {
    const char* where;  // end of Error::where
    void (*spoil)(Json&);
  };
  const Wrong wrong[] = {
      {"/schema", [](Json& j) { j["schema"] = "vernier-qa-case/2"; }},
      {"/title", [](Json& j) { j.erase("title"); }},
      {"/why", [](Json& j) { j["why"] = ""; }},
      {"/surprise", [](Json& j) { j["surprise"] = 1; }},
      {"/data/recipe", [](Json& j) { j["data"] = Json::object(); }},
      {"/data/recipe", [](Json& j) { j["data"]["path"] = "x"; }},
      {"/data/sha256",
       [](Json& j) {
         j["data"] = {{"path", "x.mha"}};
       }},
      {"/data/settings/plane", [](Json& j) { j["data"]["settings"]["plane"] = 3; }},
      {"/scene", [](Json& j) { j["scene"] = Json::object(); }},
      {"/options", [](Json& j) { j["options"] = {"--engine=gl"}; }},
      {"/options", [](Json& j) { j["options"] = {"/etc/passwd"}; }},
      {"/options", [](Json& j) { j["options"] = {3}; }},
      {"/size",
       [](Json& j) {
         j["size"] = {64, 4096};
       }},
      {"/size",
       [](Json& j) {
         j["size"] = {64.5, 64};
       }},
      {"/size", [](Json& j) { j["size"] = {64}; }},
      {"/tolerance/why", [](Json& j) { j["tolerance"].erase("why"); }},
      {"/tolerance/max",
       [](Json& j) {
         j["tolerance"] = {{"why", "y"}};
       }},
      {"/tolerance/max", [](Json& j) { j["tolerance"]["max"] = -1; }},
      {"/tolerance/max", [](Json& j) { j["tolerance"]["max"] = "1"; }},
      {"/tolerance/above/share", [](Json& j) { j["tolerance"]["above"].erase("share"); }},
      {"/tolerance", [](Json& j) { j.erase("view"), j.erase("options"); }},
      {"/tolerance", [](Json& j) { j.erase("tolerance"), j.erase("checks"); }},
      {"/guard/exempt/blank",
       [](Json& j) {
         j["guard"]["exempt"] = {{"blank", "x"}};
       }},
      {"/guard/exempt/turned",
       [](Json& j) {
         j["guard"]["exempt"] = {{"turned", "x"}};
       }},
      {"/guard/exempt/gamma",
       [](Json& j) {
         j["guard"]["exempt"] = {{"gamma", ""}};
       }},
      {"/engines", [](Json& j) { j["engines"] = {"vulkan"}; }},
      {"/engines", [](Json& j) { j["engines"] = Json::array(); }},
      {"/checks/0", [](Json& j) { j["checks"] = {1}; }},
      {"/data", [](Json& j) { j.erase("data"); }},
  };
  for (const Wrong& w : wrong) {
    Json j = good();
    w.spoil(j);
    const auto c = parseQaCase(j.dump(), "/f", "n");
    ASSERT_FALSE(c.ok()) << w.where << j.dump();
    EXPECT_EQ(c.error().code, ErrorCode::FileDamaged);
    EXPECT_EQ(c.error().where, std::string("n/case.json#") + w.where) << c.error().sentence;
  }
  for (const char* text : {"", "[]", "{", "null", "\"x\""})
    EXPECT_FALSE(parseQaCase(text, "/f", "n").ok()) << text;
  EXPECT_FALSE(parseQaCase(std::string(100'000, '['), "/f", "n").ok());
}

Picture ramp(int brighter = 0, int from = 0) {
  Picture p(32, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      for (int c = 0; c < 3; ++c)
        p.at(x, y)[c] = static_cast<std::uint8_t>(4 * x + y + (x >= from ? brighter : 0));
  return p;
}
bool passes(const QaTolerance& t, const Picture& actual) {
  for (const QaRow& row : judgePicture(ramp(), actual, t))
    if (!row.pass) return false;
  return true;
}

TEST(QaJudge, EachBoundHolds) {
  QaTolerance t;
  t.max = 2;
  EXPECT_TRUE(passes(t, ramp(2)));
  EXPECT_FALSE(passes(t, ramp(3)));
  t = {};
  t.mean = 1;
  EXPECT_TRUE(passes(t, ramp(2, 16)));  // half of the pixels by 2
  EXPECT_FALSE(passes(t, ramp(2, 15)));
  t = {};
  t.rmse = 2;
  EXPECT_TRUE(passes(t, ramp(2)));
  EXPECT_FALSE(passes(t, ramp(3)));
  t = {};
  t.above = QaTolerance::Above{2, 0.25};
  EXPECT_TRUE(passes(t, ramp(2)));
  EXPECT_TRUE(passes(t, ramp(3, 24)));
  EXPECT_FALSE(passes(t, ramp(3, 23)));
  t = {};
  t.ssim = 0.999;
  EXPECT_TRUE(passes(t, ramp()));
  EXPECT_FALSE(passes(t, ramp(60, 16)));
  EXPECT_FALSE(passes(t, Picture(31, 32)));  // another size is never a pass
}

TEST(QaJudge, NanIsNeverWithin) {
  EXPECT_FALSE(within("q", "u", std::nan(""), 0, 1e9, "").pass);
  EXPECT_FALSE(within("q", "u", 0, 0, std::nan(""), "").pass);
  EXPECT_TRUE(within("q", "u", 1, 0, 1, "").pass);
  EXPECT_FALSE(equalText("q", "L", "R").pass);
}

TEST(QaDocument, ExitCodes) {
  QaCaseResult pass, fail, damaged, device;
  pass.engines.resize(1), fail.engines.resize(1), damaged.engines.resize(1), device.engines.resize(1);
  pass.engines[0].verdict = QaVerdict::Pass;
  fail.engines[0].verdict = QaVerdict::Fail;
  damaged.engines[0].error = makeError(ErrorCode::FileDamaged, "x");
  device.engines[0].error = makeError(ErrorCode::GlUnavailable, "x");
  EXPECT_EQ(qaExitCode({pass}), 0);
  EXPECT_EQ(qaExitCode({pass, fail}), 4);
  EXPECT_EQ(qaExitCode({pass, damaged}), 3);
  EXPECT_EQ(qaExitCode({fail, damaged}), 4);
  EXPECT_EQ(qaExitCode({damaged, fail}), 4);
  EXPECT_EQ(qaExitCode({device}), 4);
  EXPECT_EQ(qaExitCode({}), 3);
}

TEST(QaDocument, AStrangeDocumentIsDamaged) {
  const auto none = [](const std::string&) { return std::vector<std::byte>(); };
  for (const Json& j : {Json(), Json::object(), Json::array(), Json{{"schema", "vernier-qa/1"}},
                        Json{{"schema", 3}}, Json{{"schema", "vernier-qa/1"}, {"summary", {1}}}})
    EXPECT_FALSE(qaHtml(j, "", none).ok()) << j.dump();
  EXPECT_FALSE(qaJunit(Json::object()).ok());
}

}  // namespace
}  // namespace vernier::app
