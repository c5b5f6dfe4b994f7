// SPDX-License-Identifier: GPL-3.0-or-later
#include "TestPaths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

using ::testing::HasSubstr;

// The examples of the page are read as they stand, and together they show every key.
TEST(SceneJson, ExamplesOfTheDocumentation) {
  std::ifstream in(std::string(VERNIER_SOURCE_DIR) + "/docs/scene.md");
  ASSERT_TRUE(in.good());
  std::stringstream page;
  page << in.rdbuf();
  const std::string text = page.str();
  int examples = 0;
  std::string all;
  for (std::size_t at = text.find("```json\n"); at != std::string::npos; at = text.find("```json\n", at)) {
    at += 8;
    const std::string example = text.substr(at, text.find("```", at) - at);
    const auto scene = parseScene(example);
    EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().text()) << "\n" << example;
    if (!scene) continue;
    EXPECT_EQ(*parseScene(writeScene(*scene)), *scene);
    all += example;
    ++examples;
  }
  EXPECT_GE(examples, 2);
  for (const char* key :
       {"schema",        "camera",      "background", "layers",        "azimuth_deg", "elevation_deg",
        "roll_deg",      "projection",  "fov_deg",    "zoom",          "height_mm",   "pan_mm",
        "kind",          "source",      "index",      "window",        "center",      "width",
        "function",      "explanation", "voi_lut",    "interpolation", "invert",      "flip_horizontal",
        "flip_vertical", "plane",       "point",      "normal",        "up",          "slab",
        "thickness_mm",  "mode",        "version"}) {
    EXPECT_THAT(all, HasSubstr("\"" + std::string(key) + "\"")) << "shown in an example";
    EXPECT_THAT(text, HasSubstr("`" + std::string(key) + "`")) << "explained";
  }
}

}  // namespace
}  // namespace vernier
