// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes and iso-surfaces: where they are measured, which pixels count as edges, and that the badge sees
// what is wrong.
#include "VolumeMeasure.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

double ball(glm::dvec3 p, glm::dvec3 centre, double radius) {  // 0.5 at the radius, falling 0.1 per mm
  return std::clamp(0.5 + 0.1 * (radius - glm::length(p - centre)), 0.0, 1.0);
}

template <class LayerKind>
VolumeScene balls(LayerKind layer) {
  VolumeScene s =
      volumeScene(floatVolume(gridOf(41, 33, 25, {1, 1, 1.5}),
                              [&](auto i, auto j, auto k) {
                                const glm::dvec3 p(i, j, 1.5 * static_cast<double>(k));
                                return std::max(ball(p, {10, 10, 14}, 6), 0.9 * ball(p, {18, 22, 18}, 7));
                              }),
                  layer);
  s.view = {80, 60};
  s.scene.camera.azimuth_deg = 30, s.scene.camera.elevation_deg = 20;
  return s;
}
VolumeLayer softLayer() {
  VolumeLayer layer;
  layer.transfer = TransferFunction{{{0.4, {1, 0.4, 0.1}}, {0.8, {1, 1, 0.8}}}, {{0.4, 0}, {0.8, 0.5}}, 1};
  return layer;
}
VolumeLayer stepLayer(double opacity) {
  VolumeLayer layer = softLayer();
  layer.transfer->opacities = {{0.5, 0}, {0.5, opacity}};
  return layer;
}
IsosurfaceLayer isoLayer() {
  IsosurfaceLayer layer;
  layer.level = 0.5;
  return layer;
}
int edges(const VolumeScene& s) {
  const ErrorReport r = measured(frameOf(s), s);
  return static_cast<int>(std::lround(r.edge.share * static_cast<double>(r.n)));
}

TEST(VolumeLooks, ThePopulationHoldsAllThatShowsAndNotTheClearRest) {
  std::vector<VolumeScene> scenes = {balls(softLayer()), balls(stepLayer(1)), balls(isoLayer())};
  VolumeLayer max = softLayer();
  max.mode = VolumeMode::Max;
  scenes.push_back(balls(max));
  for (VolumeScene& s : scenes)
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
      for (const bool cut : {false, true}) {
        s.scene.camera.projection = projection;
        s.scene.background = {0.1, 0.2, 0.3};  // is no part of what the layer shows
        s.scene.crop.reset();
        if (cut) s.scene.crop = CropBox{VoxelPoint(0, 0, 0), VoxelPoint(13, 40, 40)};
        const std::vector<char> mask = maskOf(s);
        const Frame frame = frameOf(s);
        std::size_t shown = 0;
        for (std::size_t n = 0; n < mask.size(); ++n) {
          if (std::abs(frame.images.colour[4 * n] - 0.1) < 1e-6) continue;
          ++shown;
          EXPECT_TRUE(mask[n]) << n;
        }
        EXPECT_GT(shown, 40u);
        EXPECT_LT(countOf(mask), mask.size() / 2);
      }
  // Nothing shows: nothing is measured.
  VolumeScene clear = balls(softLayer());
  clear.volume().transfer->opacities = {{1, 0}, {2, 1}};
  EXPECT_EQ(countOf(maskOf(clear)), 0u);
  VolumeScene high = balls(isoLayer());
  high.iso().level = 1.5;
  EXPECT_EQ(countOf(maskOf(high)), 0u);
}

TEST(VolumeLooks, TheBadgeSeesWhatIsWrong) {
  VolumeLayer lit = softLayer();
  lit.shading = ShadingModel::ColourPerVoxel;
  for (const VolumeScene& s : {balls(softLayer()), balls(lit), balls(stepLayer(0.3)), balls(isoLayer())}) {
    const Frame frame = frameOf(s);
    const ErrorReport right = measured(frame, s);
    EXPECT_TRUE(right.exhaustive);
    EXPECT_LT(right.max, 1e-4);
    VolumeScene turned = s;
    turned.scene.camera.roll_deg = 3;
    EXPECT_GT(measured(frame, turned).max, 5);
    VolumeScene cut = s;
    cut.scene.clip.push_back({PatientVec(-1, 0, 0), -10});
    EXPECT_GT(measured(frame, cut).max, 20);
    VolumeScene dyed = s;
    dyed.scene.lights = {{std::nullopt, {1, 0.9, 1}}};
    const auto* volume = std::get_if<VolumeLayer>(&s.scene.layers[0]);
    const bool shaded = !volume || volume->shading != ShadingModel::None;
    EXPECT_EQ(measured(frame, dyed).max > 3, shaded);
  }
}

// A ball in front of another: edges are its outline and that of both together, not what lies within.
TEST(VolumeLooks, EdgesOfASurfaceAreItsOutlines) {
  const int iso = edges(balls(isoLayer()));
  const VolumeScene s = balls(isoLayer());
  const ErrorReport r = measured(frameOf(s), s);
  EXPECT_GT(iso, 60);
  EXPECT_LT(iso, static_cast<int>(r.n) / 2);
  // An opaque step is such a surface, and one that lets light through has also the outlines behind.
  const int opaque = edges(balls(stepLayer(1)));
  EXPECT_GE(opaque, iso);
  EXPECT_LT(opaque, iso + 160);  // and the outline of the volume
}

// Seen along y, a pixel per voxel; columns of the picture but for its border.
template <class LayerKind>
VolumeScene seenAlongY(const LayerKind& layer, const std::function<double(double, double)>& field) {
  VolumeScene s = volumeScene(floatVolume(gridOf(33, 33, 33),
                                          [&](auto i, auto j, auto) {
                                            return field(static_cast<double>(i), static_cast<double>(j));
                                          }),
                              layer);
  s.view = {32, 8};
  s.scene.camera.height_mm = 8;
  return s;
}
std::vector<int> edgeColumns(const VolumeScene& s) {
  const auto layers = Layers::make(s.scene, s.view, s.sources, {});
  EXPECT_TRUE(layers.ok());
  std::vector<int> out;
  for (int x = 1; x < 31; ++x)
    if (layers->atEdge({x + 0.5, 4.5})) out.push_back(x);
  return out;
}

// A wall from x = 8 on and a plate before it from x = 16 on, both reached 0.6 of a voxel earlier.
TEST(VolumeLooks, EdgesAreWhereASurfaceEndsOrJumps) {
  const auto walls = [](double x, double y) {
    return (x >= 8 && y >= 25) || (x >= 16 && y >= 5 && y <= 7) ? 1.0 : 0.0;
  };
  const std::vector<int> outlines{6, 7, 14, 15};
  IsosurfaceLayer iso = isoLayer();
  iso.level = 0.4;
  EXPECT_EQ(edgeColumns(seenAlongY(iso, walls)), outlines);
  for (double opacity : {1.0, 0.97}) {
    VolumeLayer layer = stepLayer(opacity);
    layer.transfer->opacities = {{0.4, 0}, {0.4, opacity}};
    VolumeScene s = seenAlongY(layer, walls);
    EXPECT_EQ(edgeColumns(s), outlines) << opacity;
    s.volume().mode = VolumeMode::Max;  // which side of the step the greatest value is on
    EXPECT_EQ(edgeColumns(s), (std::vector<int>{6, 7})) << opacity;
    s.volume().mode = VolumeMode::Blend;
    s.volume().transfer->opacities = {{0, 0}, {1, opacity}};  // no step
    EXPECT_TRUE(edgeColumns(s).empty());
    // At a value that voxels have, where the surface lies in the faces of cells.
    s.volume().transfer->opacities = {{1, 0}, {1, opacity}};
    EXPECT_EQ(edgeColumns(s), (std::vector<int>{7, 8, 15, 16})) << opacity;
  }
  // Through the plate the wall is seen too; a plate that takes next to nothing has no outline.
  VolumeLayer thin = stepLayer(0.2);
  thin.transfer->opacities = {{0.4, 0}, {0.4, 0.2}};
  EXPECT_EQ(edgeColumns(seenAlongY(thin, walls)), outlines);
  // The same from the other side of the step.
  VolumeLayer turned = stepLayer(1);
  turned.transfer->opacities = {{-0.4, 1}, {-0.4, 0}};
  EXPECT_EQ(edgeColumns(seenAlongY(turned, [&](double x, double y) { return -walls(x, y); })), outlines);
}

TEST(VolumeLooks, SlopesAndBendsAreNoEdges) {
  IsosurfaceLayer iso = isoLayer();
  iso.level = 0;
  VolumeLayer step = stepLayer(1);
  step.transfer->opacities = {{0, 0}, {0, 1}};
  const auto smooth = [&](const std::function<double(double)>& depth) {
    const auto field = [&](double x, double y) { return y - depth(x); };
    EXPECT_TRUE(edgeColumns(seenAlongY(iso, field)).empty());
    EXPECT_TRUE(edgeColumns(seenAlongY(step, field)).empty());
  };
  smooth([](double) { return 12.0; });
  smooth([](double x) { return 30 - 0.9 * x; });
  smooth([](double x) { return 3 + 0.05 * (x - 16) * (x - 16); });
  smooth([](double x) { return x < 16 ? 25.0 : std::max(5.0, 25 - 4 * (x - 16)); });
}

// What a cut shows as a face is an edge against what it shows beside it.
TEST(VolumeLooks, EdgesOfFaces) {
  VolumeScene s = volumeScene(floatVolume(gridOf(33, 33, 33), [](auto, auto j, auto) { return j - 20.0; }),
                              IsosurfaceLayer{});
  s.iso().level = 0;
  s.view = {32, 8};
  s.scene.camera.height_mm = 8;
  s.scene.clip.push_back({PatientVec(0.8, -0.6, 0), 0});          // y >= 4/3 x: beyond 20 from x = 15 on
  EXPECT_EQ(edgeColumns(s), (std::vector<int>{14, 15, 23, 24}));  // and where nothing is left
}

}  // namespace
}  // namespace vernier::quality
