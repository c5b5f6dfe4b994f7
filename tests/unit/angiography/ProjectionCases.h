// SPDX-License-Identifier: GPL-3.0-or-later
// Projections through the planner.
#pragma once
#include <gtest/gtest.h>

#include "TechniqueHost.h"
#include "VesselVolume.h"
#include "vernier/angiography/Angiography.h"
#include "vernier/quality/Badge.h"

namespace vernier::test {

inline constexpr ProjectionMode kAllModes[] = {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Sum,
                                               ProjectionMode::Mean, ProjectionMode::Attenuation};

class LookHost final : public TechniqueHost {
 public:
  static LookHost& instance() {
    static LookHost host;
    return host;
  }

 private:
  LookHost() { EXPECT_TRUE(angiography::registerAngiography(*this).ok()); }
};

struct LookCase {
  Scene scene;
  View view{72, 60};
  Sources sources;
  explicit LookCase(std::shared_ptr<const Volume> volume = vesselVolume()) {
    sources.volumes["v"] = std::move(volume);
    ProjectionLayer layer;
    layer.source = "v";
    layer.window = VoiWindow{90, 120, VoiFunction::LinearExact, ""};
    scene.layers.emplace_back(layer);
    scene.camera.azimuth_deg = 25, scene.camera.elevation_deg = 15, scene.camera.roll_deg = 5;
    scene.camera.zoom = 1.2;
  }
  ProjectionLayer& layer() { return std::get<ProjectionLayer>(scene.layers[0]); }
  void addTools(double opacity) {
    const PatientPoint middle = sources.volumes["v"]->grid().centre();
    // A sheet through the middle, turned so that it cuts the volume, and one in front of it.
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
  Result<Plan> plan(const std::string& technique, double step = 1) const {
    Quality quality;
    quality.technique = technique, quality.step = step;
    const LookHost& host = LookHost::instance();
    return makePlan(scene, view, quality, host.capabilities, CostTable{}, sources, host.registry);
  }
  Frame draw(const std::string& technique, double step = 1) const {
    Frame frame;
    const Result<Plan> p = plan(technique, step);
    EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
    if (!p) return frame;
    for (const Pass& pass : p->passes) {
      const auto done = LookHost::instance().registry.find(pass.technique)->execute(pass, frame.images, {});
      EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().text());
    }
    return frame;
  }
  quality::ErrorReport error(const std::string& technique, double step = 1) const {
    quality::ErrorOptions options;
    options.samples = 100000;  // every pixel
    const auto report = quality::measureError(draw(technique, step), scene, view, sources, options);
    EXPECT_TRUE(report.ok()) << (report.ok() ? "" : report.error().text());
    return report.ok() ? *report : quality::ErrorReport{};
  }
};

}  // namespace vernier::test
