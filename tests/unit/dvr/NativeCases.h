// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes and iso-surfaces through the planner, drawn by native rays.
#pragma once
#include <gtest/gtest.h>

#include "../angiography/TechniqueHost.h"
#include "../angiography/VesselVolume.h"
#include "vernier/dvr/Dvr.h"
#include "vernier/quality/Badge.h"

namespace vernier::test {

class DvrHost final : public TechniqueHost {
 public:
  static DvrHost& instance() {
    static DvrHost host;
    return host;
  }

 private:
  DvrHost() { EXPECT_TRUE(dvr::registerDvr(*this).ok()); }
};

struct NativeCase {
  Scene scene;
  View view{72, 60};
  Sources sources;
  QualityLevel level = QualityLevel::Reference;

  explicit NativeCase(Layer layer, std::shared_ptr<const Volume> volume = vesselVolume()) {
    sources.volumes["v"] = std::move(volume);
    scene.layers.push_back(std::move(layer));
    scene.camera.azimuth_deg = 25, scene.camera.elevation_deg = 15, scene.camera.roll_deg = 5;
    scene.camera.zoom = 1.2;
    scene.background = {.1, .15, .3};
  }
  VolumeLayer& volume() { return std::get<VolumeLayer>(scene.layers[0]); }
  IsosurfaceLayer& iso() { return std::get<IsosurfaceLayer>(scene.layers[0]); }
  void addTools(double opacity) {
    const PatientPoint middle = sources.volumes["v"]->grid().centre();
    for (double shift : {0.0, -4.0}) {
      SurfaceLayer tool;
      tool.source = "t" + std::to_string(scene.layers.size());
      MeshBuilder sheet;
      const std::uint32_t v[4] = {sheet.vertex({-6, 1, -7}), sheet.vertex({7, 2, -5}),
                                  sheet.vertex({5, -3, 8}), sheet.vertex({-8, -1, 6})};
      sheet.triangle(v[0], v[1], v[2]), sheet.triangle(v[0], v[2], v[3]);
      sources.meshes[tool.source] = *sheet.finish();
      tool.pose.translation = middle.p + glm::dvec3(0.3 * shift, shift, 0);
      tool.opacity = shift == 0 ? opacity : 0.4;
      tool.colour = {0.9, 0.5, 0.2};
      scene.layers.emplace_back(tool);
    }
  }
  Result<Plan> plan(double step = 1) const {
    Quality quality;
    quality.technique = std::holds_alternative<VolumeLayer>(scene.layers[0]) ? "dvr.native" : "iso.native";
    quality.step = step, quality.level = level;
    const DvrHost& host = DvrHost::instance();
    return makePlan(scene, view, quality, host.capabilities, CostTable{}, sources, host.registry);
  }
  std::string dump(double step = 1) const {
    const Result<Plan> p = plan(step);
    return p ? p->passes.at(0).params->dump() : "";
  }
  // The sentence that refuses the layer.
  std::string refusal() const {
    const Result<Plan> p = plan();
    if (!p) return p.error().text();
    std::string all;
    for (const Rejected& r : p->rejected) all += r.why + "\n";
    return p->passes.empty() ? all : "";
  }
  Frame draw(double step = 1) const {
    Frame frame;
    const Result<Plan> p = plan(step);
    EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
    if (!p) return frame;
    for (const Pass& pass : p->passes) {
      const auto done = DvrHost::instance().registry.find(pass.technique)->execute(pass, frame.images, {});
      EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().text());
    }
    return frame;
  }
  quality::ErrorReport error(double step = 1) const {
    quality::ErrorOptions options;
    options.samples = 100000;  // every pixel
    const auto report = quality::measureError(draw(step), scene, view, sources, options);
    EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().text());
    return report.ok() ? *report : quality::ErrorReport{};
  }
};

inline Layer volumeLayer(const TransferFunction& f) {
  VolumeLayer layer;
  layer.source = "v";
  layer.transfer = f;
  return layer;
}
inline Layer isoLayer(double level) {
  IsosurfaceLayer layer;
  layer.source = "v";
  layer.level = level;
  return layer;
}
// Over the values of vesselVolume().
inline TransferFunction vesselFunction() {
  return {{{40, {.3, .2, .8}}, {100, {.9, .5, .2}}, {150, {1, 1, .9}}}, {{40, 0}, {90, .05}, {150, .6}}, 1};
}

}  // namespace vernier::test
