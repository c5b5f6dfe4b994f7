// SPDX-License-Identifier: GPL-3.0-or-later
// Projections through the planner against the reference in double: all modes, both cameras, cuts, tools.
#include <gtest/gtest.h>

#include "../volume/Grids.h"
#include "ShellCases.h"
#include "vernier/angiography/Angiography.h"
#include "vernier/quality/Badge.h"

namespace vernier::test {
namespace {

constexpr ProjectionMode kAllModes[] = {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Sum,
                                        ProjectionMode::Mean, ProjectionMode::Attenuation};

class LookHost final : public Host {
 public:
  LookHost() {
    EXPECT_TRUE(angiography::registerAngiography(*this).ok());
    Technique surfaces;  // only says that somebody here draws tools
    surfaces.name = "surface.test", surfaces.kinds = {"surface"};
    surfaces.passesFor = [](const Layer&, std::size_t, const PlanContext&) -> Result<std::vector<Pass>> {
      return std::vector<Pass>{};
    };
    surfaces.execute = [](const Pass&, Images&, std::stop_token) -> Result<void> { return {}; };
    EXPECT_TRUE(addTechnique(std::move(surfaces)).ok());
    capabilities.gl = false;
  }
  Result<void> addTechnique(Technique t) override { return registry.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override { return makeError(ErrorCode::GlUnavailable, "Not here."); }
  TechniqueRegistry registry;
  Capabilities capabilities;
};

struct LookCase {
  Scene scene;
  View view{72, 60};
  Sources sources;
  LookHost host;
  LookCase() {
    sources.volumes["v"] = vesselVolume();
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
    return makePlan(scene, view, quality, host.capabilities, CostTable{}, sources, host.registry);
  }
  Frame draw(const std::string& technique, double step = 1) const {
    Frame frame;
    const Result<Plan> p = plan(technique, step);
    EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
    if (!p) return frame;
    for (const Pass& pass : p->passes) {
      const auto done = host.registry.find(pass.technique)->execute(pass, frame.images, {});
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

TEST(ProjectionPictures, ExactRaysAreTheReference) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const ProjectionMode mode : kAllModes)
      for (const int variant : {0, 1, 2, 3}) {
        LookCase c;
        c.layer().mode = mode;
        c.scene.camera.projection = projection;
        if (variant == 1) {
          c.scene.crop = CropBox{VoxelPoint(2, 3, 1.5), VoxelPoint(18, 17, 12)};
          c.scene.clip = {{PatientVec(0.6, 0.8, 0),
                           glm::dot(glm::dvec3(0.6, 0.8, 0), c.sources.volumes["v"]->grid().centre().p) + 2}};
        }
        if (variant == 2) c.layer().invert = true;
        if (variant == 3) c.scene.background = {0.1, 0.2, 0.3}, c.scene.camera.zoom = 0.7;
        const quality::ErrorReport e = c.error("projection.exact");
        EXPECT_GT(e.population, 500u);
        EXPECT_LT(e.max, 0.01) << static_cast<int>(mode) << " variant " << variant;
      }
}

TEST(ProjectionPictures, AnEyeInsideTheVolume) {
  for (const ProjectionMode mode : kAllModes) {
    LookCase c;
    c.layer().mode = mode;
    c.scene.camera.projection = Projection::Perspective;
    c.scene.camera.distance_mm = 2, c.scene.camera.fov_deg = 75;
    EXPECT_LT(c.error("projection.exact").max, 0.01) << static_cast<int>(mode);
  }
}

TEST(ProjectionPictures, ToolsStandInThePicture) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const ProjectionMode mode : kAllModes)
      for (const double opacity : {1.0, 0.5})
        for (const bool invert : {false, true}) {
          LookCase c;
          c.layer().mode = mode, c.layer().invert = invert;
          c.scene.camera.projection = projection;
          c.addTools(opacity);
          const quality::ErrorReport e = c.error("projection.exact");
          // Distances of tools are floats: a value beside the tool differs by what it changes in 1e-5 mm.
          EXPECT_LT(e.p99, 0.02) << static_cast<int>(mode) << " " << opacity << invert;
          EXPECT_LT(e.rms, 1.0) << static_cast<int>(mode) << " " << opacity << invert;
        }
}

TEST(ProjectionPictures, SampledRaysComeCloserWithTheStep) {
  for (const ProjectionMode mode : kAllModes) {
    LookCase c;
    c.layer().mode = mode;
    double before = c.error("projection.native", 1).rms;
    for (const double step : {0.5, 0.25, 0.125}) {
      const double rms = c.error("projection.native", step).rms;
      EXPECT_LT(rms, 0.6 * before + 0.01) << static_cast<int>(mode) << " step " << step;
      before = rms;
    }
    EXPECT_LT(before, 0.6) << static_cast<int>(mode);  // maxima lie on faces of cells, where the field bends
  }
}

TEST(ProjectionPictures, ADepthCueIsMeasuredToo) {
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    LookCase c;
    c.layer().cue = 0.7;
    c.scene.camera.projection = projection;
    EXPECT_LT(c.error("projection.native", 1.0 / 16).p99, 0.9);
    const Result<Plan> plan = c.plan("projection.exact");
    EXPECT_FALSE(plan.ok());
  }
}

TEST(ProjectionPictures, ThePlanIsOnePassAndSaysWhatItDoes) {
  LookCase c;
  c.addTools(1);
  const Result<Plan> plan = c.plan("projection.native");
  ASSERT_TRUE(plan.ok());
  ASSERT_EQ(plan->passes.size(), 1u);
  EXPECT_TRUE(plan->showsWholeScene);
  EXPECT_NE(dumpPlan(*plan).find("max, orthographic, step 0.8 mm"), std::string::npos) << dumpPlan(*plan);
  EXPECT_NE(dumpPlan(*plan).find("tools 2"), std::string::npos);
  c.layer().window = VoiWindow{0, -1, VoiFunction::Linear, ""};
  EXPECT_EQ(c.plan("projection.native").error().where, "/layers/0/window");
}

}  // namespace
}  // namespace vernier::test
