// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes on OpenGL through the planner, and how far their pictures are from what they must be (DvrTruth.h).
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "../volume/Grids.h"
#include "DvrTechniques.h"
#include "GlForTest.h"
#include "vernier/native/Shells.h"
#include "vernier/plan/MakePlan.h"
#include "vernier/plan/Volumetric.h"
#include "vernier/volume/Sampling.h"

namespace vernier::test {

inline GridGeometry tiltedGrid(std::int64_t columns, std::int64_t rows, std::int64_t slices,
                               glm::dvec3 spacing = {0.8, 0.9, 1.2}, bool leftHanded = false) {
  GridGeometry g = unitGrid(columns, rows, slices);
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.95, 0.2, 0.1));
  const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(0.1, 0.95, -0.15)));
  g.patientFromVoxel.linear =
      glm::dmat3(spacing.x * x, spacing.y * glm::cross(z, x), (leftHanded ? -spacing.z : spacing.z) * z);
  g.patientFromVoxel.translation = {-10, 40, 200};
  return g;
}

// Tubes and a ball, -100 to about 300, with a little grain.
inline std::shared_ptr<const Volume> bumpyVolume(GridGeometry grid = tiltedGrid(30, 28, 22),
                                                 std::optional<NoDataRange> noData = {}, double grain = 8) {
  VolumeInfo info;
  info.grid = std::move(grid);
  info.rescale = {ModalityRescale{0.5, -100}};
  info.noData = noData;
  std::vector<std::int16_t> values;
  const GridGeometry& g = info.grid;
  const glm::dvec3 size(static_cast<double>(g.columns), static_cast<double>(g.rows),
                        static_cast<double>(g.slices));
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) {
        const glm::dvec3 p = glm::dvec3(i, j, k) / size * 24.0;
        const auto bump = [](double d2, double width) { return std::exp(-d2 / (width * width)); };
        const double tube = std::pow(p.y - 7 - 3 * std::sin(0.3 * p.x), 2) + std::pow(p.z - 9, 2);
        const double other = std::pow(p.x - 15 - 0.3 * p.z, 2) + std::pow(p.y - 14 + 0.3 * p.z, 2);
        const double ball = std::pow(p.x - 8, 2) + std::pow(p.y - 16, 2) + std::pow(p.z - 15, 2);
        const double noise = grain * randomUnit(5, values.size());
        values.push_back(static_cast<std::int16_t>(400 * bump(tube, 2.5) + 500 * bump(other, 2.4) +
                                                   700 * bump(ball, 5) + noise));
      }
  return volumeOf(info, values);
}

inline TransferFunction smoothTransfer() {
  return {{{-100, {.2, .1, .6}}, {0, {.9, .3, .1}}, {150, {1, .8, .4}}, {300, {1, 1, .9}}},
          {{-60, 0}, {40, .15}, {200, .6}, {300, .9}},
          2};
}

class DvrHost final : public Host {
 public:
  static DvrHost& instance() {
    static DvrHost host;
    return host;
  }
  Result<void> addTechnique(Technique t) override { return registry.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override {
    if (gpu::Device* device = vernier::test::glDevice()) return device;
    return makeError(ErrorCode::GlUnavailable, "GL is not here.");
  }
  TechniqueRegistry registry;
  Capabilities capabilities;

 private:
  DvrHost() {
    for (Technique (*make)(Host&) : {dvr::glRaysTechnique, dvr::glStacksTechnique, dvr::glStacks2Technique,
                                     dvr::glStacks4Technique, dvr::glUncorrectedStacksTechnique,
                                     dvr::glSlabsTechnique, dvr::glStripsTechnique, dvr::glCombinedTechnique})
      EXPECT_TRUE(addTechnique(make(*this)).ok());
    Technique surfaces;  // only says that somebody here draws tools
    surfaces.name = "surface.test", surfaces.kinds = {"surface"};
    surfaces.passesFor = [](const Layer&, std::size_t, const PlanContext&) -> Result<std::vector<Pass>> {
      return std::vector<Pass>{};
    };
    surfaces.execute = [](const Pass&, Images&, std::stop_token) -> Result<void> { return {}; };
    EXPECT_TRUE(addTechnique(std::move(surfaces)).ok());
    gpu::probe(capabilities);
  }
};

inline std::shared_ptr<const Mesh> squareMesh(double half_mm) {
  MeshBuilder b;
  const auto p = b.vertex({-half_mm, -half_mm, 0}), q = b.vertex({half_mm, -half_mm, 0}),
             r = b.vertex({half_mm, half_mm, 0}), s = b.vertex({-half_mm, half_mm, 0});
  b.triangle(p, q, r), b.triangle(p, r, s);
  return *b.finish();
}

struct DvrCase {
  Scene scene;
  View view{64, 56};
  Quality quality;
  Sources sources;
  std::optional<std::uint64_t> budget;  // of textures
  explicit DvrCase(std::shared_ptr<const Volume> volume = bumpyVolume(), bool iso = false) {
    sources.volumes["v"] = std::move(volume);
    if (iso) {
      IsosurfaceLayer layer;
      layer.source = "v", layer.level = 60;
      scene.layers.emplace_back(layer);
    } else {
      VolumeLayer layer;
      layer.source = "v", layer.transfer = smoothTransfer();
      scene.layers.emplace_back(layer);
    }
    scene.camera.azimuth_deg = 25, scene.camera.elevation_deg = 15, scene.camera.roll_deg = 5;
    scene.camera.zoom = 1.2;
    scene.background = {0.1, 0.2, 0.3};
    quality.level = QualityLevel::Review;
  }
  VolumeLayer& layer() { return std::get<VolumeLayer>(scene.layers[0]); }
  IsosurfaceLayer& iso() { return std::get<IsosurfaceLayer>(scene.layers[0]); }
  const Volume& volume() const { return *sources.volumes.at("v"); }
  // A square across the view at a depth before (negative) or behind the volume's middle.
  void addTool(double depth_mm, double half_mm, double opacity, Rgb colour = {0.2, 0.9, 0.3}) {
    const CameraPicture c = camera();
    SurfaceLayer tool;
    tool.source = "tool" + std::to_string(scene.layers.size());
    tool.opacity = opacity, tool.colour = colour;
    const glm::dvec3 up = glm::normalize(c.up.v + 0.3 * c.forward.v);
    tool.pose.linear = glm::dmat3(c.right.v, up, glm::cross(c.right.v, up));
    tool.pose.translation = volume().grid().centre().p + depth_mm * c.forward.v;
    sources.meshes[tool.source] = squareMesh(half_mm);
    scene.layers.emplace_back(tool);
  }
  CameraPicture camera() const { return *cameraPicture(scene.camera, view, cameraBox(volume().grid())); }
  double step_mm() const {
    const glm::dvec3 s = volume().grid().spacing_mm();
    return quality.step * std::min({s.x, s.y, s.z});
  }
  Result<Plan> plan(const std::string& technique) const {
    Quality q = quality;
    q.technique = technique;
    const DvrHost& host = DvrHost::instance();
    Capabilities machine = host.capabilities;
    if (budget) machine.glTextureBudget_bytes = *budget;
    return makePlan(scene, view, q, machine, CostTable{}, sources, host.registry);
  }
  Result<Images> draw(const std::string& technique, std::stop_token stop = {}) const {
    const Result<Plan> p = plan(technique);
    if (!p) return p.error();
    Images images;
    for (const Pass& pass : p->passes)
      if (auto done = DvrHost::instance().registry.find(pass.technique)->execute(pass, images, stop); !done)
        return done.error();
    return images;
  }
};

}  // namespace vernier::test

#include "DvrTruth.h"

namespace vernier::test {

struct Off {
  double worst = 0, rms = 0;
  std::size_t wrong = 0, pixels = 0;
  glm::ivec2 first{-1, -1};
};
using PixelColour = std::function<glm::dvec3(double x, double y)>;
// Levels of 255; wrong: beyond `allowed`.
inline Off offFrom(const Images& images, const PixelColour& truth, double allowed = 0.5) {
  Off out;
  for (int y = 0; y < images.height; ++y)
    for (int x = 0; x < images.width; ++x) {
      const float* const seen = images.colour.data() + 4 * (x + images.width * y);
      const glm::dvec3 d = 255.0 * glm::abs(glm::dvec3(seen[0], seen[1], seen[2]) - truth(x + 0.5, y + 0.5));
      const double most = std::max({d.x, d.y, d.z});
      out.worst = std::max(out.worst, most), out.rms += most * most, ++out.pixels;
      if (most <= allowed) continue;
      if (out.wrong++ == 0) out.first = {x, y};
    }
  out.rms = std::sqrt(out.rms / static_cast<double>(out.pixels));
  return out;
}
inline PixelColour colourOf(const Images& images) {
  return [&images](double x, double y) {
    const float* const seen =
        images.colour.data() + 4 * (static_cast<int>(x) + images.width * static_cast<int>(y));
    return glm::dvec3(seen[0], seen[1], seen[2]);
  };
}
// A picture of something: at least a tenth of its pixels differ from the background.
inline void expectSomething(const DvrCase& c, const Images& images) {
  const Off off = offFrom(
      images, [&](double, double) { return DvrTruth::rgb(c.scene.background); }, 2);
  EXPECT_GT(off.wrong, off.pixels / 10);
}
// At most 1 pixel in 1000 is off by more than half a level.
inline void expectClose(const DvrCase& c, const std::string& technique, const PixelColour& truth,
                        double share = 0.001) {
  const Result<Images> images = c.draw(technique);
  ASSERT_TRUE(images.ok()) << images.error().text();
  expectSomething(c, *images);
  const Off off = offFrom(*images, truth);
  EXPECT_LE(static_cast<double>(off.wrong), share * static_cast<double>(off.pixels))
      << technique << ": " << off.wrong << " of " << off.pixels << " pixels, worst " << off.worst
      << ", first at " << off.first.x << " " << off.first.y;
  if (std::getenv("VERNIER_SHOW"))
    std::cout << "  " << technique << ": worst " << off.worst << ", rms " << off.rms << ", " << off.wrong
              << " wrong\n";
}

inline std::shared_ptr<const Volume> colourVolume() {
  VolumeInfo info;
  info.grid = tiltedGrid(24, 20, 18);
  std::vector<std::byte> texels;
  for (int k = 0; k < 18; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 24; ++i) {
        const double d = std::hypot(i - 12.0, j - 10.0, 1.2 * (k - 9.0));
        for (const double v : {10.0 * i, 12.0 * j, 13.0 * k, 160 * std::exp(-d * d / 40)})
          texels.push_back(static_cast<std::byte>(static_cast<int>(v)));
      }
  return *Volume::makeColour(info, 4, texels);
}

inline constexpr Projection kBothProjections[] = {Projection::Orthographic, Projection::Perspective};

}  // namespace vernier::test
