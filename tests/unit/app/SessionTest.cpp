// SPDX-License-Identifier: GPL-3.0-or-later
#include "Session.h"
#include "TestPaths.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "MakeDicom.h"
#include "TestData.h"
#include "vernier/plan/Presets.h"

namespace vernier::app {
namespace {
namespace fs = std::filesystem;

class SessionTest : public ::testing::Test {
 protected:
  SessionTest() {
    test::DicomSlice big;
    big.rows = 8, big.columns = 10;
    test::writeSeries(dir_.path() / "big", 6, {0, 0, 2}, big);
    test::DicomSlice small = big;
    small.seriesUid = "2.25.2002";
    test::writeSeries(dir_.path() / "small", 3, {0, 0, 2}, small);
    options_.pluginFolders = {std::string(VERNIER_BUILD_DIR) + "/lib/vernier/plugins"};
  }
  Scene axial(Session& s) {
    Scene scene;
    SliceLayer layer;
    layer.plane.point = (*s.volume(""))->grid().centre();
    scene.layers = {layer};
    return scene;
  }
  test::TempDir dir_;
  SessionOptions options_;
};

TEST_F(SessionTest, ChoosesTheLargestOrWhatIsNamed) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  EXPECT_EQ(s.seriesOf(*s.choose(""))->seriesUid, "2.25.1002");
  EXPECT_EQ(s.seriesOf(*s.choose("2.25.2002"))->seriesUid, "2.25.2002");
  EXPECT_TRUE(s.choose("2").ok());
  EXPECT_TRUE(s.choose("1#1").ok());
  for (const char* bad : {"3", "0", "2.25.9", "1#2", "1#", "#1"})
    EXPECT_EQ(s.choose(bad).error().code, ErrorCode::SeriesNotFound) << bad;
}

TEST_F(SessionTest, AnInputWithoutImagesSaysSo) {
  fs::create_directory(dir_.path() / "none");
  std::ofstream(dir_.path() / "none/a.txt") << "text";
  std::ofstream(dir_.path() / "none/b.txt") << "text";
  Session s(options_);
  ASSERT_TRUE(s.open({(dir_.path() / "none").string()}).ok());
  EXPECT_EQ(s.choose("").error().code, ErrorCode::NothingToLoad);
  EXPECT_EQ(s.open({(dir_.path() / "gone").string()}).error().code, ErrorCode::FileNotFound);
}

TEST_F(SessionTest, ASceneOfAbsentPluginsIsRefusedWithItsName) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  Scene scene;
  scene.layers = {CustomLayer{"acme.flow", 1, "{}"}};
  const auto r = s.render(scene, {}, {}, {});
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::PluginMissing);
  EXPECT_NE(r.error().sentence.find("acme"), std::string::npos);
}

TEST_F(SessionTest, AnAxialNativeSliceIsOnePassAndLooksForNoGl) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  const auto r = s.render(axial(s), {}, {}, {});
  ASSERT_TRUE(r.ok()) << r.error().text();
  EXPECT_EQ(r->plan.passes.size(), 1u);
  EXPECT_EQ(r->frame.images.counters.passes, 1u);
  EXPECT_EQ(r->frame.engine, "native");
  EXPECT_NE(s.capabilities(false).glWhyNot.find("nothing needed it"), std::string::npos);
}

// NUMERICS C1: at voxel centres an axial preset shows the stored values themselves, whatever the rounding of
// spacings and positions; with a gap too, which the general kernel draws.
TEST_F(SessionTest, AnAxialPresetAtVoxelCentresShowsTheStoredValues) {
  for (const bool gap : {false, true}) {
    const fs::path folder = dir_.path() / (gap ? "gap" : "odd");
    for (int k = 0; k < 9; ++k) {
      test::DicomSlice slice;
      slice.rows = 24, slice.columns = 32;
      slice.spacing = {0.488281, 0.488281};
      slice.position = {-124.7559, -143.31, -887.3 + 0.7 * (k + (gap && k > 4 ? 3 : 0))};
      slice.instanceNumber = k + 1;
      slice.slope = 1.5, slice.intercept = -1024;
      for (int n = 0; n < 24 * 32; ++n) slice.pixels.push_back((n * 7919 + k * 104729) % 4096);
      fs::create_directories(folder);
      test::writeDicom(folder / (std::to_string(k) + ".dcm"), slice);
    }
    Session s(options_);
    ASSERT_TRUE(s.open({folder.string()}).ok());
    const auto volume = s.volume("");
    ASSERT_TRUE(volume.ok()) << volume.error().text();
    EXPECT_EQ((*volume)->grid().gapAfter.size(), gap ? 1u : 0u);
    for (std::int64_t k = 0; k < 9; ++k) {
      PresetOptions options;
      options.slice = k;
      options.camera.height_mm = 24 * 0.488281;
      const Scene scene = *presetScene("axial", "", **volume, options);
      RenderOptions plain;
      plain.measure = false;
      const auto r = s.render(scene, {32, 24, true}, {}, plain);
      ASSERT_TRUE(r.ok()) << r.error().text();
      for (std::int64_t y = 0; y < 24; ++y)
        for (std::int64_t x = 0; x < 32; ++x)
          ASSERT_EQ(r->frame.images.values[static_cast<std::size_t>(32 * y + x)],
                    static_cast<float>((*volume)->modality(x, y, k)))
              << "slice " << k << " at " << x << "," << y << (gap ? ", with a gap" : "");
    }
  }
}

TEST_F(SessionTest, ALayerOfAnAbsentPluginIsKeptSaidAndNoReasonToLookForGl) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  Scene scene = axial(s);
  scene.layers.push_back(CustomLayer{"acme.flow", 1, R"({"kind":"acme.flow"})"});
  const auto r = s.render(scene, {}, {}, {});
  ASSERT_TRUE(r.ok()) << r.error().text();
  EXPECT_FALSE(r->plan.showsWholeScene);
  ASSERT_EQ(r->plan.notes.size(), 1u);
  EXPECT_NE(r->plan.notes[0].find("needs plugin acme"), std::string::npos);
  EXPECT_EQ(r->frame.images.counters.passes, 1u);
  EXPECT_NE(s.capabilities(false).glWhyNot.find("nothing needed it"), std::string::npos);
  Quality named;
  named.technique = "mpr.native";
  ASSERT_TRUE(s.render(axial(s), {}, named, {}).ok());
  EXPECT_NE(s.capabilities(false).glWhyNot.find("nothing needed it"), std::string::npos);
}

TEST_F(SessionTest, TheAutomaticWindowIsFoundOnceAndIsThatOfThePicture) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  const auto volume = s.volume("");
  ASSERT_TRUE(volume.ok());
  const Scene scene = axial(s);
  EXPECT_EQ(s.derivedBytes(), 0u);
  const auto first = s.render(scene, {}, {}, {});
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(s.derivedBytes(), sizeof(VoiWindow)) << "kept";
  EXPECT_EQ(s.defaultWindowOf(**volume), defaultWindow(**volume));
  Scene stated = scene;
  std::get<SliceLayer>(stated.layers[0]).window = defaultWindow(**volume);
  EXPECT_EQ(s.render(stated, {}, {}, {})->frame.images.colour, first->frame.images.colour);
}

TEST_F(SessionTest, AnErrorThatWasAskedForIsJudgedInDraftsToo) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  Scene scene = axial(s);
  auto& layer = std::get<SliceLayer>(scene.layers[0]);
  layer.plane.normal = PatientVec(0.3, -0.8, 0.5), layer.plane.up = PatientVec(0, 0, 1);
  layer.slab = {9, SlabMode::Mean};
  Quality draft;
  draft.level = QualityLevel::Draft;
  RenderOptions options;
  const auto free = s.render(scene, {}, draft, options);
  ASSERT_TRUE(free.ok());
  EXPECT_TRUE(free->goalReached);
  ASSERT_GT(free->error->max, 1e-6);
  options.goal = 1e-7;
  const auto strict = s.render(scene, {}, draft, options);
  ASSERT_TRUE(strict.ok());
  EXPECT_FALSE(strict->goalReached);
  EXPECT_EQ(strict->rungs.size(), 1u) << "a draft is one picture";
  EXPECT_EQ(strict->frame.images.colour, free->frame.images.colour);
}

TEST_F(SessionTest, StripsUploadNo3dTexture) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  if (!s.capabilities(true).gl) {
    ASSERT_EQ(std::getenv("VERNIER_REQUIRE_GL"), nullptr) << s.capabilities(true).glWhyNot;
    std::cout << "[  NOTE    ] no OpenGL here: not checked\n";
    return;
  }
  Quality q;
  q.technique = "mpr.strips";
  const auto strips = s.render(axial(s), {}, q, {});
  ASSERT_TRUE(strips.ok()) << strips.error().text();
  EXPECT_EQ(strips->frame.images.counters.textures3dCreated, 0u);
  EXPECT_GT(strips->frame.images.counters.bytesUploaded, 0u);
  q.technique = "mpr.polygon";
  const auto polygon = s.render(axial(s), {}, q, {});
  ASSERT_TRUE(polygon.ok()) << polygon.error().text();
  EXPECT_EQ(polygon->frame.images.counters.textures3dCreated, 1u);
}

TEST_F(SessionTest, BuffersAreReusedAndThePictureIsTheSame) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  auto first = s.render(axial(s), {}, {}, {});
  ASSERT_TRUE(first.ok());
  const std::vector<float> colour = first->frame.images.colour;
  const float* address = first->frame.images.colour.data();
  std::fill(first->frame.images.colour.begin(), first->frame.images.colour.end(), 7.0f);
  RenderOptions plain;
  plain.measure = false;
  const auto second = s.render(axial(s), {}, {}, plain, {}, std::move(first->frame));
  ASSERT_TRUE(second.ok());
  EXPECT_EQ(second->frame.images.colour.data(), address);
  EXPECT_EQ(second->frame.images.colour, colour);
}

TEST_F(SessionTest, CancelledWorkSaysSo) {
  Session s(options_);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(s.open({dir_.path().string()}, {}, stop.get_token()).error().code, ErrorCode::Cancelled);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  EXPECT_EQ(s.render(axial(s), {}, {}, {}, stop.get_token()).error().code, ErrorCode::Cancelled);
}

TEST_F(SessionTest, APictureHasASize) {
  Session s(options_);
  ASSERT_TRUE(s.open({dir_.path().string()}).ok());
  View none;
  none.width_px = 0;
  EXPECT_EQ(s.render(axial(s), none, {}, {}).error().code, ErrorCode::OptionInvalid);
}

}  // namespace
}  // namespace vernier::app
