// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes as JSON: volumes, iso-surfaces, lights, transfer functions.
#include <gtest/gtest.h>

#include <limits>

#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

std::string whereOf(const std::string& json) {
  const auto scene = parseScene(json);
  if (scene) return "ok";
  EXPECT_EQ(scene.error().code, ErrorCode::SceneInvalid) << scene.error().text();
  EXPECT_FALSE(scene.error().sentence.empty());
  return scene.error().where;
}
std::string withLayer(const std::string& layer) { return R"({"schema": 1, "layers": [)" + layer + "]}"; }
std::string withTransfer(const std::string& f) {
  return withLayer(R"({"kind": "volume", "source": "v", "transfer": )" + f + "}");
}

Scene full() {
  VolumeLayer volume;
  volume.source = "a";
  volume.mode = VolumeMode::Min;
  volume.preset = "ct-bone";
  volume.transfer = TransferFunction{
      {{-1000.5, {0.1, 1.0 / 3, 1}}, {40, {0, 0, 0}}}, {{0.1 + 0.2, 0}, {40, 1e-7}, {40, 1}}, 0.7};
  volume.gains = {1, 0.5, 0, 1000};
  volume.classification = Classification::PreIntegrated;
  volume.opacity = OpacityRule::Linear;
  volume.interpolation = Interpolation::Nearest;
  volume.shading = ShadingModel::GlobalAmbient;
  volume.material = {0.1, 0.25, 1, 33.3, {0.5, 0.25, 0}, {0, 1, 0.1}};
  volume.combiner = "two \"lights\"";
  volume.outlines = true;
  IsosurfaceLayer iso;
  iso.source = "b";
  iso.level = -1.0 / 7;
  iso.material.power = 2;
  iso.combiner = "x";
  Scene s;
  s.lights = {Light{}, Light{PatientVec(1, -2, 1e-3), {0.5, 0.25, 1}}};
  s.layers = {volume, iso, VolumeLayer{}, IsosurfaceLayer{}};
  return s;
}

TEST(SceneRendering, ParseOfWriteIsTheSame) {
  const Scene s = full();
  const auto back = parseScene(writeScene(s));
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(*back, s);
  EXPECT_EQ(writeScene(*back), writeScene(s));
}

TEST(SceneRendering, TransferFunctionAloneReadsBack) {
  const TransferFunction f = *std::get<VolumeLayer>(full().layers[0]).transfer;
  const auto back = parseTransfer(writeTransfer(f));
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(*back, f);
}

TEST(SceneRendering, FaultsHaveTheirPlace) {
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "volume", "source": "v"})")), "ok");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "volume", "source": "v", "mode": "sum"})")), "/layers/0/mode");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "volume", "source": "v", "gains": [1, 1, 1]})")),
            "/layers/0/gains");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "volume", "source": "v", "gains": [1, 1, 1, -1]})")),
            "/layers/0/gains");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "volume", "source": "v", "opacities": []})")),
            "/layers/0/opacities");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "isosurface", "source": "v", "material": {"ambient": 2}})")),
            "/layers/0/material/ambient");
  EXPECT_EQ(whereOf(withLayer(R"({"kind": "volume", "source": "v", "interpolation": "cubic"})")),
            "/layers/0/interpolation");
  EXPECT_EQ(whereOf(R"({"schema": 1, "lights": [{"towards": [0, 0, 0]}], "layers": []})"),
            "/lights/0/towards");
  EXPECT_EQ(whereOf(R"({"schema": 1, "lights": [{}, {}, {}, {}, {}], "layers": []})"), "/lights");
}

TEST(SceneRendering, TransferFunctionsAreChecked) {
  const std::string colours = R"("colours": [[0, 1, 1, 1]], )";
  EXPECT_EQ(whereOf(withTransfer("{" + colours + R"("opacities": [[0, 0], [1, 1]]})")), "ok");
  EXPECT_EQ(whereOf(withTransfer("{" + colours + R"("opacities": []})")), "/layers/0/transfer/opacities");
  EXPECT_EQ(whereOf(withTransfer("{" + colours + R"("opacities": [[1, 0], [0, 1]]})")),
            "/layers/0/transfer/opacities/1");
  EXPECT_EQ(whereOf(withTransfer("{" + colours + R"("opacities": [[1, 0, 3]]})")),
            "/layers/0/transfer/opacities/0");
  EXPECT_EQ(whereOf(withTransfer("{" + colours + R"("opacities": [[1, null]]})")),
            "/layers/0/transfer/opacities/0/1");
  EXPECT_EQ(whereOf(withTransfer("{" + colours + R"("opacities": [[1, 1]], "opacity_length_mm": 0})")),
            "/layers/0/transfer/opacity_length_mm");
  EXPECT_EQ(parseTransfer("[]").error().code, ErrorCode::SceneInvalid);
  EXPECT_EQ(parseTransfer("{\"colours\": [[NaN, 1, 1, 1]]}").error().code, ErrorCode::SceneInvalid);
}

TEST(SceneRendering, NumbersThatAreNotFiniteDoNotReadBack) {
  Scene s = full();
  std::get<VolumeLayer>(s.layers[0]).transfer->opacities[0].value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(parseScene(writeScene(s)));
}

}  // namespace
}  // namespace vernier
