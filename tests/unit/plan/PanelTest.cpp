// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Panel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

using ::testing::HasSubstr;

const PanelSlider kLow{"low", "From", -1000, 3000, 1, 150, "HU"};
const PanelCheckbox kEdge{"edge", "Outline", true};
const PanelText kName{"name", "Name", "bone \"1\""};

Panel band() {
  Panel p;
  p.title = "Band";
  p.kind = "acme.band";
  p.version = 2;
  p.controls = {PanelLabel{"Values between two bounds."}, kLow, kEdge, kName};
  return p;
}

TEST(Panel, ANewLayerHasEveryControlAtItsInitialValue) {
  ASSERT_TRUE(checkPanel(band()).ok()) << checkPanel(band()).error().text();
  const auto layer = newLayer(band(), "1.2.3");
  ASSERT_TRUE(layer.ok()) << layer.error().text();
  EXPECT_EQ(layer->json,
            R"({"kind":"acme.band","version":2,"source":"1.2.3","low":150,"edge":true,"name":"bone \"1\""})");
  EXPECT_EQ(layer->kind, "acme.band");
  EXPECT_EQ(layer->version, 2);
  EXPECT_EQ(sourceOf(*layer), "1.2.3");
}

TEST(Panel, ReadsWhatTheLayerSaysAndElseTheInitialValue) {
  const auto layer = *customLayer(R"({"kind": "acme.band", "low": -12.5, "edge": false})");
  EXPECT_EQ(*panelValue(layer, kLow), PanelValue(-12.5));
  EXPECT_EQ(*panelValue(layer, kEdge), PanelValue(false));
  EXPECT_EQ(*panelValue(layer, kName), PanelValue(std::string("bone \"1\"")));
  EXPECT_EQ(*panelValue(layer, PanelLabel{"x"}), PanelValue());
  EXPECT_EQ(sourceOf(layer), std::nullopt);
}

TEST(Panel, WrongTypesAndRangesAreNamedWithTheirPath) {
  for (const char* json : {R"({"kind":"acme.band","low":"12"})", R"({"kind":"acme.band","low":3001})",
                           R"({"kind":"acme.band","low":true})"}) {
    const auto value = panelValue(*customLayer(json), kLow);
    ASSERT_FALSE(value.ok()) << json;
    EXPECT_EQ(value.error().code, ErrorCode::SceneInvalid);
    EXPECT_EQ(value.error().where, "/low");
  }
  EXPECT_FALSE(panelValue(*customLayer(R"({"kind":"a.b","edge":1})"), kEdge).ok());
  EXPECT_FALSE(panelValue(*customLayer(R"({"kind":"a.b","name":null})"), kName).ok());
}

TEST(Panel, AnEditChangesItsKeyAndNothingElse) {
  const std::string json = R"({"z":[0.10,1E+5],"low":1.50,"kind":"acme.band","n":{"low":7},"t":"\"low\":3"})";
  const auto edited = withPanelValue(*customLayer(json), kLow, 0.1);
  ASSERT_TRUE(edited.ok()) << edited.error().text();
  EXPECT_EQ(edited->json, R"({"z":[0.10,1E+5],"low":0.1,"kind":"acme.band","n":{"low":7},"t":"\"low\":3"})");
  const auto added = withPanelValue(*edited, kName, std::string("ä\n\""));
  ASSERT_TRUE(added.ok()) << added.error().text();
  EXPECT_EQ(added->json,
            R"({"z":[0.10,1E+5],"low":0.1,"kind":"acme.band","n":{"low":7},"t":"\"low\":3","name":"ä\n\""})");
  EXPECT_EQ(*panelValue(*added, kName), PanelValue(std::string("ä\n\"")));
  EXPECT_EQ(*withPanelValue(*added, PanelLabel{"x"}, {}), *added);
}

TEST(Panel, AnEditThatDoesNotFitIsRefused) {
  const auto layer = *newLayer(band(), "");
  EXPECT_FALSE(withPanelValue(layer, kLow, 3000.5).ok());
  EXPECT_FALSE(withPanelValue(layer, kLow, std::numeric_limits<double>::quiet_NaN()).ok());
  EXPECT_FALSE(withPanelValue(layer, kLow, true).ok());
  EXPECT_FALSE(withPanelValue(layer, kEdge, 1.0).ok());
  EXPECT_FALSE(withPanelValue(layer, kName, PanelValue()).ok());
}

TEST(Panel, FaultsOfThePluginAreRefusedByName) {
  const auto faultOf = [](const auto& change) {
    Panel p = band();
    change(p);
    const Result<void> r = checkPanel(p);
    if (r) return std::string("ok");
    EXPECT_EQ(r.error().code, ErrorCode::PluginFailed);
    return r.error().sentence;
  };
  EXPECT_THAT(faultOf([](Panel& p) { p.title.clear(); }), HasSubstr("title"));
  EXPECT_THAT(faultOf([](Panel& p) { p.kind = "slice"; }), HasSubstr("slice"));
  EXPECT_THAT(faultOf([](Panel& p) { p.controls.clear(); }), HasSubstr("0 controls"));
  EXPECT_THAT(faultOf([](Panel& p) { p.controls.assign(101, PanelLabel{}); }), HasSubstr("101 controls"));
  EXPECT_THAT(faultOf([](Panel& p) { p.controls.push_back(kEdge); }), HasSubstr("'edge'"));
  EXPECT_THAT(faultOf([](Panel& p) {
                p.controls.push_back(PanelText{"kind", "", ""});
              }),
              HasSubstr("'kind'"));
  EXPECT_THAT(faultOf([](Panel& p) {
                p.controls.push_back(PanelSlider{"x", "", 1, 1, 0, 1, ""});
              }),
              HasSubstr("'x' without a range"));
  EXPECT_THAT(faultOf([](Panel& p) {
                p.controls.push_back(PanelSlider{"x", "", 0, 1, 0, 2, ""});
              }),
              HasSubstr("is 2, outside 0 to 1"));
  EXPECT_THAT(
      faultOf([](Panel& p) {
        p.controls.push_back(PanelSlider{"x", "", 0, std::numeric_limits<double>::infinity(), 0, 0, ""});
      }),
      HasSubstr("not finite"));
}

}  // namespace
}  // namespace vernier
