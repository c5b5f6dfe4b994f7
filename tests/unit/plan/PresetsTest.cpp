// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Presets.h"

#include <gtest/gtest.h>

#include <cmath>

#include "Grids.h"
#include "vernier/plan/PictureGeometry.h"

namespace vernier {
namespace {

Scene sceneOf(const std::string& view, const GridGeometry& grid, const PresetOptions& options = {}) {
  Result<Scene> scene = presetScene(view, "v", grid, options);
  EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().text());
  return scene.ok() ? *scene : Scene{};
}
const SliceLayer& sliceOf(const Scene& scene) { return std::get<SliceLayer>(scene.layers.at(0)); }
SlicePicture pictureOf(const Scene& scene, const GridGeometry& grid, View view) {
  return *slicePicture(sliceOf(scene), scene.camera, view, grid);
}
PatientPoint at(const SlicePicture& p, double x, double y) { return p.origin + x * p.right + y * p.down; }

struct Expected {
  const char* view;
  EdgeLetters letters;
  glm::dvec3 right, down, normal;
  int across, downwards, through;  // patient axes
};
const Expected kExpected[] = {
    {"axial", {"R", "L", "A", "P"}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 0, 1, 2},
    {"coronal", {"R", "L", "H", "F"}, {1, 0, 0}, {0, 0, -1}, {0, -1, 0}, 0, 2, 1},
    {"sagittal", {"A", "P", "H", "F"}, {0, 1, 0}, {0, 0, -1}, {1, 0, 0}, 1, 2, 0},
};

// The same patient, whichever way he was scanned: 3 acquisition planes, 8 flips, half of them left-handed.
TEST(Presets, EveryFlipAndPlaneShowsTheSamePicture) {
  const glm::dvec3 size_mm{40, 60, 30}, centre{5, -7, 11};
  int leftHanded = 0;
  for (const auto& [name, grid] : test::orthogonalGrids()) {
    leftHanded += glm::determinant(grid.patientFromVoxel.linear) < 0;
    for (const Expected& e : kExpected) {
      SCOPED_TRACE(name + ", view " + e.view);
      const SlicePicture p = pictureOf(sceneOf(e.view, grid), grid, {120, 120, false});
      EXPECT_EQ(edgeLetters(p), e.letters);
      EXPECT_LT(glm::length(p.right.v / p.mmPerPixel - e.right), 1e-12);
      EXPECT_LT(glm::length(p.down.v / p.mmPerPixel - e.down), 1e-12);
      EXPECT_LT(glm::length(p.normal.v - e.normal), 1e-12);
      EXPECT_NEAR(p.mmPerPixel, std::max(size_mm[e.across], size_mm[e.downwards]) / 120, 1e-12)
          << "whole box";
      const PatientPoint middle = at(p, 60, 60);
      EXPECT_NEAR(middle.p[e.across], centre[e.across], 1e-12);
      EXPECT_NEAR(middle.p[e.downwards], centre[e.downwards], 1e-12);
      // The plane passes through voxel centres, at most half a step from the middle.
      const glm::dvec3 v = (grid.patientFromVoxel.inverse() * middle).p;
      const int axis = sliceAxis(grid, p.normal).axis;
      EXPECT_NEAR(v[axis], std::round(v[axis]), 1e-12);
      EXPECT_LE(std::abs(middle.p[e.through] - centre[e.through]), 2.5 + 1e-12);
    }
  }
  EXPECT_EQ(leftHanded, 12);
}

TEST(Presets, SliceNumbersCountAlongTheVoxelAxisOfTheView) {
  for (const auto& [name, grid] : test::orthogonalGrids())
    for (const Expected& e : kExpected) {
      SCOPED_TRACE(name + ", view " + e.view);
      const SliceAxis axis = sliceAxis(grid, PatientVec(e.normal));
      EXPECT_GT(std::abs(grid.patientFromVoxel.linear[axis.axis][e.through]), 1);
      for (std::int64_t index : {std::int64_t{0}, axis.count - 1}) {
        PresetOptions options;
        options.slice = index;
        const PatientPoint p = sliceOf(sceneOf(e.view, grid, options)).plane.point;
        EXPECT_NEAR((grid.patientFromVoxel.inverse() * p).p[axis.axis], static_cast<double>(index), 1e-12);
      }
      PresetOptions options;
      for (std::int64_t index : {std::int64_t{-1}, axis.count}) {
        options.slice = index;
        const auto refused = presetScene(e.view, "v", grid, options);
        ASSERT_FALSE(refused.ok());
        EXPECT_EQ(refused.error().code, ErrorCode::OptionInvalid);
      }
    }
}

// A picture as large as the slice has its pixel centres on voxel centres, to rounding.
TEST(Presets, PixelsMeetVoxels) {
  GridGeometry g;
  g.columns = g.rows = 512;
  g.slices = 28;
  g.patientFromVoxel.linear = glm::dmat3({0.48828125, 0, 0}, {0, 0.48828125, 0}, {0, 0, 5});
  g.patientFromVoxel.translation = {-125, -130.5, 40};
  PresetOptions options;
  options.slice = 7;
  const SlicePicture p = pictureOf(sceneOf("axial", g, options), g, {512, 512, false});
  for (int k : {0, 1, 200, 511}) {
    const glm::dvec3 v = (g.patientFromVoxel.inverse() * at(p, k + 0.5, k + 0.5)).p;
    EXPECT_LT(glm::length(v - glm::dvec3(k, k, 7)), 1e-12);
  }
}

TEST(Presets, ObliqueAcquisitionIsSeenInPatientPlanes) {
  // Slices tilted by 20 degrees about x.
  const double c = std::cos(20 * 3.14159265358979 / 180), s = std::sin(20 * 3.14159265358979 / 180);
  GridGeometry g;
  g.columns = 30, g.rows = 40, g.slices = 21;
  g.patientFromVoxel.linear = glm::dmat3({1, 0, 0}, {0, c, s}, {0, -2 * s, 2 * c});
  g.patientFromVoxel.translation = {1, 2, 3};
  PresetOptions options;
  for (std::int64_t slice : {0, 10, 20}) {
    options.slice = slice;
    const Scene scene = sceneOf("axial", g, options);
    const SlicePicture p = pictureOf(scene, g, {64, 64, false});
    EXPECT_EQ(edgeLetters(p), (EdgeLetters{"R", "L", "A", "P"}))
        << "the patient's axial plane, not the scanner's";
    const PatientPoint point = sliceOf(scene).plane.point;
    EXPECT_NEAR(point.p.x, g.centre().p.x, 1e-9) << "scrolling does not wander";
    EXPECT_NEAR(point.p.y, g.centre().p.y, 1e-9);
    EXPECT_NEAR(point.p.z, (g.patientFromVoxel * VoxelPoint(14.5, 19.5, static_cast<double>(slice))).p.z,
                1e-9);
    // Every corner of the box lies inside the picture.
    for (int n = 0; n < 8; ++n) {
      const glm::dvec3 d = g.corner(n).p - p.origin.p;
      const double x = glm::dot(d, p.right.v) / (p.mmPerPixel * p.mmPerPixel);
      EXPECT_GT(x, 0);
      EXPECT_LT(x, 64);
    }
  }
}

TEST(Presets, UnevenStacksUseTheTruePositions) {
  GridGeometry g;
  g.columns = g.rows = 4;
  g.slices = 3;
  g.sliceOrigin_vox = {{0, 0, 0}, {0.25, 0, 1.5}, {0, 0, 2}};
  PresetOptions options;
  options.slice = 1;
  EXPECT_DOUBLE_EQ(sliceOf(sceneOf("axial", g, options)).plane.point.p.z, 1.5);
}

TEST(Presets, ObliqueAndSlabFollowThePeers) {
  GridGeometry g;
  g.columns = 11, g.rows = 21, g.slices = 31;
  const Scene scene = sceneOf("oblique", g);
  const SliceLayer& layer = sliceOf(scene);
  EXPECT_DOUBLE_EQ(scene.camera.height_mm.value_or(0), 30);
  EXPECT_EQ(layer.plane.point, PatientPoint(5, 10, 15));
  const SlicePicture p = pictureOf(scene, g, {60, 60, false});
  const double a = 30 * 3.14159265358979323846 / 180;
  EXPECT_LT(glm::length(p.right.v / p.mmPerPixel - glm::dvec3(std::cos(a), std::sin(a), 0)), 1e-12);
  EXPECT_EQ(layer.slab.thickness_mm, 0);
  EXPECT_EQ(sliceOf(sceneOf("slab", g)).slab, (Slab{10, SlabMode::Max}));
  PresetOptions options;
  options.slab = Slab{4, SlabMode::Mean};
  EXPECT_EQ(sliceOf(sceneOf("slab", g, options)).slab, *options.slab);
  EXPECT_EQ(sliceOf(sceneOf("axial", g, options)).slab, *options.slab);
}

TEST(Presets, OptionsArePassedOn) {
  GridGeometry g;
  g.columns = g.rows = g.slices = 4;
  PresetOptions options;
  options.plane = Plane{{1, 2, 3}, PatientVec(1, 1, 0), PatientVec(0, 0, 1)};
  options.window = VoiWindow{40, 400, VoiFunction::Linear, ""};
  options.interpolation = Interpolation::Nearest;
  options.camera.zoom = 3;
  const Scene scene = sceneOf("axial", g, options);
  EXPECT_EQ(sliceOf(scene).plane, *options.plane);
  EXPECT_EQ(sliceOf(scene).window, options.window);
  EXPECT_EQ(sliceOf(scene).interpolation, Interpolation::Nearest);
  EXPECT_EQ(scene.camera.zoom, 3);
  options.slice = 1;
  EXPECT_EQ(presetScene("axial", "v", g, options).error().code, ErrorCode::OptionInvalid);
}

TEST(Presets, NamesAndTheirPlugins) {
  GridGeometry g;
  g.columns = g.rows = g.slices = 4;
  EXPECT_EQ(viewNames().size(), 19u);
  for (const std::string& name : viewNames()) {
    EXPECT_NE(pluginOfView(name), "") << name;
    const auto scene = presetScene(name, "v", g, {});
    if (pluginOfView(name) == "angiography") {
      ASSERT_TRUE(scene.ok()) << name << ": " << scene.error().text();
      const std::string kind = name.rfind("shells", 0) == 0 ? "shells" : "projection";
      EXPECT_EQ(kindOf(scene->layers.at(0)), kind) << name;
    } else if (pluginOfView(name) == "dvr") {
      ASSERT_TRUE(scene.ok()) << name << ": " << scene.error().text();
      EXPECT_EQ(kindOf(scene->layers.at(0)), name == "iso" ? "isosurface" : "volume") << name;
    } else if (name == "lens") {
      ASSERT_TRUE(scene.ok()) << scene.error().text();
      ASSERT_EQ(scene->layers.size(), 2u);
      EXPECT_EQ(kindOf(scene->layers[0]), "volume");
      const auto& lens = std::get<LensLayer>(scene->layers[1]);
      EXPECT_DOUBLE_EQ(std::get<SphereShape>(lens.shape).radius_mm, 0.25 * std::sqrt(27.0));
      EXPECT_EQ(lens.pose * MeshPoint(0, 0, 0), g.centre());
      EXPECT_EQ(std::get<IsosurfaceLayer>(lens.inner).source, "v");
    } else {
      EXPECT_EQ(scene.ok(), name != "stack" && name != "curved");
    }
  }
  EXPECT_EQ(presetScene("axila", "v", g, {}).error().code, ErrorCode::SceneInvalid);
}

TEST(Presets, ShellsOfTheViews) {
  GridGeometry g;
  g.columns = g.rows = g.slices = 4;
  const auto shells = [&](const std::string& view, const PresetOptions& o = {}) {
    return std::get<ShellsLayer>(presetScene(view, "v", g, o)->layers.at(0));
  };
  EXPECT_EQ(shells("shells").mode, ShellsMode::Max);
  EXPECT_EQ(shells("shells").count, 12);
  EXPECT_EQ(shells("shells").b, 1);
  EXPECT_EQ(shells("shells-sum").mode, ShellsMode::Sum);
  EXPECT_EQ(shells("shells-sum").b, 1.0 / 12);
  EXPECT_EQ(shells("shells-lit").mode, ShellsMode::Lit);
  EXPECT_EQ(shells("shells-lit").count, 3);
  PresetOptions given;
  given.shells.emplace();
  given.shells->count = 7, given.shells->b = 0.5;
  EXPECT_EQ(shells("shells-sum", given).mode, ShellsMode::Sum);
  EXPECT_EQ(shells("shells-sum", given).count, 7);
  EXPECT_EQ(shells("shells-sum", given).b, 0.5);
}

TEST(Presets, RenderingsOfTheViews) {
  GridGeometry g;
  g.columns = g.rows = g.slices = 4;
  PresetOptions o;
  o.volume.emplace();
  o.volume->preset = "ct-bone";
  const Scene plain = *presetScene("dvr", "v", g, o);
  EXPECT_EQ(std::get<VolumeLayer>(plain.layers.at(0)).shading, ShadingModel::None);
  EXPECT_EQ(std::get<VolumeLayer>(plain.layers.at(0)).preset, "ct-bone");
  EXPECT_EQ(std::get<VolumeLayer>(plain.layers.at(0)).source, "v");
  o.lights = {Light{PatientVec(0, -1, 0), {1, 0, 0}}};
  EXPECT_EQ(presetScene("dvr", "v", g, o).error().code, ErrorCode::OptionInvalid) << "lights light nothing";
  const Scene shaded = *presetScene("dvr-shaded", "v", g, o);
  EXPECT_EQ(std::get<VolumeLayer>(shaded.layers.at(0)).shading, ShadingModel::ColourPerVoxel);
  EXPECT_EQ(shaded.lights, o.lights);
  o.volume->shading = ShadingModel::GlobalAmbient;
  EXPECT_EQ(std::get<VolumeLayer>(presetScene("dvr-shaded", "v", g, o)->layers.at(0)).shading,
            ShadingModel::GlobalAmbient);
  for (const char* view : {"iso", "mip", "axial"})
    EXPECT_EQ(presetScene(view, "v", g, o).error().code, ErrorCode::OptionInvalid) << view;
  PresetOptions iso;
  iso.iso.emplace();
  iso.iso->level = 117;
  EXPECT_EQ(std::get<IsosurfaceLayer>(presetScene("iso", "v", g, iso)->layers.at(0)).level, 117);
  EXPECT_EQ(presetScene("dvr", "v", g, iso).error().code, ErrorCode::OptionInvalid);
  PresetOptions windowed;
  windowed.window = VoiWindow{40, 400, VoiFunction::Linear, ""};
  EXPECT_EQ(presetScene("dvr", "v", g, windowed).error().where, "window");
}

TEST(Presets, StackIsOneStoredFrame) {
  const Scene scene = stackScene("s", 12, {});
  const auto& layer = std::get<ImageLayer>(scene.layers.at(0));
  EXPECT_EQ(layer.source, "s");
  EXPECT_EQ(layer.index, 12);
  EXPECT_FALSE(layer.window.has_value());
}

TEST(Presets, OneSliceOneVoxel) {  // NUMERICS A11, A12
  GridGeometry g;
  g.columns = g.rows = g.slices = 1;
  for (const char* view : {"axial", "coronal", "sagittal", "oblique"}) {
    const Scene scene = sceneOf(view, g);
    EXPECT_TRUE(slicePicture(sliceOf(scene), scene.camera, {16, 16, false}, g).ok()) << view;
  }
}

}  // namespace
}  // namespace vernier
