// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes on OpenGL through the planner, and what rays on the view's lattice must give: RENDERING's rules in
// double, sample by sample, with volume's probe.
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

// What a picture must be, pixel by pixel. Techniques differ in where their samples lie.
class DvrTruth {
 public:
  explicit DvrTruth(const DvrCase& c)
      : case_(c), volume_(c.volume()), camera_(c.camera()), region_(*keptRegion(c.scene, volume_.grid())) {
    const Result<std::vector<PlacedSurface>> tools = placedSurfaces(c.scene, c.sources);
    if (!tools->empty()) hits_ = *native::findSurfaces({*tools, camera_, glm::dvec3(0)}, {});
    const auto* layer = std::get_if<VolumeLayer>(&c.scene.layers[0]);
    if (layer) layer_ = *layer;
    if (const auto* iso = std::get_if<IsosurfaceLayer>(&c.scene.layers[0])) iso_ = *iso;
  }

  const CameraPicture& camera() const { return camera_; }
  const VolumeLayer& layer() const { return layer_; }
  const Material& material() const { return iso_.source.empty() ? layer_.material : iso_.material; }
  const std::vector<HalfSpace>& region() const { return region_; }
  RaySpan span(double x, double y) const {
    RaySpan s = spanOf(camera_.ray(x, y), region_, camera_.near_mm * camera_.rayPerDepth(x, y));
    s.exit_mm = std::min(s.exit_mm, tools(x, y).end_mm);
    return s;
  }
  native::ToolsOnRay tools(double x, double y) const {
    if (hits_.width == 0) return {};
    return native::toolsAt(hits_, static_cast<std::size_t>(x) +
                                      static_cast<std::size_t>(y) * static_cast<std::size_t>(hits_.width));
  }

  // Positions are held in the box of voxel centres.
  std::optional<double> field(glm::dvec3 voxel) const {
    const GridGeometry& g = volume_.grid();
    voxel = glm::clamp(voxel, glm::dvec3(0), glm::dvec3(g.columns - 1, g.rows - 1, g.slices - 1));
    return sampleModality(volume_, g.patientFromVoxel * VoxelPoint(voxel), layer_.interpolation);
  }
  glm::dvec3 voxelAt(double x, double y, double t) const {
    return (volume_.voxelFromPatient() * camera_.ray(x, y).at(t)).p;
  }
  std::optional<double> fieldAt(double x, double y, double t) const { return field(voxelAt(x, y, t)); }

  // plan/Scene.h: the gradient of all shading, and the light.
  glm::dvec3 gradient(glm::dvec3 voxel, double own) const {
    const GridGeometry& g = volume_.grid();
    voxel = glm::clamp(voxel, glm::dvec3(0), glm::dvec3(g.columns - 1, g.rows - 1, g.slices - 1));
    glm::dvec3 d;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 e(0);
      e[axis] = 1;
      d[axis] = 0.5 * (field(voxel + e).value_or(own) - field(voxel - e).value_or(own));
    }
    return glm::transpose(volume_.voxelFromPatient().linear) * d;
  }
  glm::dvec3 lit(const Material& m, glm::dvec3 ambient, glm::dvec3 diffuse, glm::dvec3 n,
                 glm::dvec3 eye) const {
    glm::dvec3 sum = m.ambient * ambient;
    std::vector<Light> lights = case_.scene.lights;
    if (lights.empty()) lights.emplace_back();
    if (glm::length(n) > 1e-9) {
      n = glm::normalize(n);
      if (glm::dot(n, eye) < 0) n = -n;
      for (const Light& l : lights) {
        const glm::dvec3 to = l.towards ? glm::normalize(l.towards->v) : eye;
        const glm::dvec3 h = glm::length(to + eye) > 1e-9 ? glm::normalize(to + eye) : glm::dvec3(0);
        sum += glm::dvec3(l.colour.r, l.colour.g, l.colour.b) *
               (m.diffuse * diffuse * std::max(0.0, glm::dot(n, to)) +
                m.specular * std::pow(std::max(0.0, glm::dot(n, h)), m.power));
      }
    }
    return glm::clamp(sum, 0.0, 1.0);
  }

  // Colour and opacity of a piece of ray `length_mm` long whose sample lies at t.
  glm::dvec4 sample(double x, double y, double t, double length_mm) const {
    return sampleAtVoxel(voxelAt(x, y, t), -camera_.ray(x, y).direction.v, length_mm);
  }
  glm::dvec4 sampleAtVoxel(glm::dvec3 voxel, glm::dvec3 eye, double length_mm) const {
    if (volume_.isColour()) return colourSample(voxel, length_mm);
    if (layer_.classification == Classification::Pre) return preSample(voxel, length_mm);
    const TransferFunction& f = *layer_.transfer;
    const std::optional<double> v = field(voxel);
    if (!v) return glm::dvec4(0);
    const double a = over(opacityAt(f, *v), length_mm / f.opacityLength_mm);
    glm::dvec3 c = colourAt(f, *v);
    if (a > 0 && layer_.shading != ShadingModel::None) {
      const Material& m = layer_.material;
      const bool global = layer_.shading == ShadingModel::GlobalAmbient;
      c = lit(m, global ? rgb(m.ambientColour) : c, global ? rgb(m.diffuseColour) : c, gradient(voxel, *v),
              eye);
    }
    return {c, a};
  }
  double over(double a, double lengths) const {
    return layer_.opacity == OpacityRule::Linear ? opacityOverLinear(a, lengths) : opacityOver(a, lengths);
  }

  // Rays on the lattice; planar: of view-aligned slices, whose lattice counts depth along the view.
  glm::dvec3 rays(double x, double y, bool planar = false) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    glm::dvec3 colour(0), behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    double left = 1, from = s.entry_mm;
    for (std::size_t n = 0; n <= t.layers.size(); ++n) {
      const double at = n < t.layers.size() ? t.layers[n].t_mm : s.exit_mm;
      const double to = std::clamp(at, s.entry_mm, std::max(s.entry_mm, s.exit_mm));
      if (!s.empty() && from < to) addPart(x, y, from, to, planar, colour, left);
      from = to;
      if (n == t.layers.size()) break;
      colour += left * glm::dvec3(t.layers[n].r, t.layers[n].g, t.layers[n].b);
      left *= 1 - static_cast<double>(t.layers[n].alpha);
    }
    return colour + left * behind;
  }
  void addPart(double x, double y, double from, double to, bool planar, glm::dvec3& colour,
               double& left) const {
    const double lengths = planar ? camera_.rayPerDepth(x, y) : 1, d = case_.step_mm() * lengths;
    for (double k = std::floor(from / d); k * d < to; ++k) {
      const double share = (std::min(to, (k + 1) * d) - std::max(from, k * d)) / d;
      if (share <= 0) continue;
      const bool pairs = layer_.classification == Classification::PreIntegrated;
      const glm::dvec4 c = pairs ? between(x, y, k * d, d, d / lengths) : sample(x, y, (k + 0.5) * d, d);
      const double a = opacityOver(c.w, pairs ? share * lengths : share);
      colour += left * a * glm::dvec3(c);
      left *= 1 - a;
    }
  }

  // From t to t + d the value goes evenly, along a step of the table's length: by a thousand thin pieces.
  glm::dvec4 between(double x, double y, double t, double d, double table_mm) const {
    const TransferFunction& f = *layer_.transfer;
    const std::optional<double> front = fieldAt(x, y, t), back = fieldAt(x, y, t + d);
    glm::dvec3 colour(0);
    double left = 1;
    for (int n = 0; n < 1000; ++n) {
      const double v = std::lerp(*front, *back, (n + 0.5) / 1000);
      const double a = opacityOver(opacityAt(f, v), table_mm / 1000 / f.opacityLength_mm);
      colour += left * a * colourAt(f, v);
      left *= 1 - a;
    }
    return left < 1 ? glm::dvec4(colour / (1 - left), 1 - left) : glm::dvec4(0);
  }

  glm::dvec3 extreme(double x, double y) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    if (s.empty()) return behind;
    const double sign = layer_.mode == VolumeMode::Min ? -1 : 1, d = case_.step_mm();
    std::optional<double> best;
    glm::dvec3 channels(sign * -1e9);
    const auto take = [&](double at) {
      if (volume_.isColour()) {
        const glm::dvec3 c(colourSample(voxelAt(x, y, at), d));
        channels = sign > 0 ? glm::max(channels, c) : glm::min(channels, c);
      } else if (const std::optional<double> v = fieldAt(x, y, at)) {
        if (!best || sign * *v > sign * *best) best = v;
      }
    };
    take(s.entry_mm), take(s.exit_mm);
    for (double k = std::floor(s.entry_mm / d); (k + 0.5) * d < s.exit_mm; ++k)
      if ((k + 0.5) * d > s.entry_mm) take((k + 0.5) * d);
    if (volume_.isColour()) return channels;
    if (!best) return behind;
    const double a = opacityAt(*layer_.transfer, *best);
    return a * colourAt(*layer_.transfer, *best) + (1 - a) * behind;
  }

  // The first root of the field along the ray, looked for fifty times in a voxel.
  glm::dvec3 isosurface(double x, double y, double* at_mm = nullptr) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    double end = t.end_mm;
    const glm::dvec3 eye = -camera_.ray(x, y).direction.v;
    const Material& m = iso_.material;
    if (!s.empty()) {
      const double d = 0.02 * case_.step_mm() / case_.quality.step;
      double before = s.entry_mm;
      bool found = reaches(x, y, before);
      const bool begins = found;
      double at = before;
      while (!found && at < s.exit_mm) {
        before = at, at = std::min(at + d, s.exit_mm);
        found = reaches(x, y, at);
      }
      if (found) {
        for (int n = 0; n < 40 && !begins; ++n) {
          const double middle = 0.5 * (before + at);
          (reaches(x, y, middle) ? at : before) = middle;
        }
        const glm::dvec3 n = begins ? eye : gradient(voxelAt(x, y, at), *iso_.level);
        behind = lit(m, rgb(m.ambientColour), rgb(m.diffuseColour), n, eye);
        end = at;
      }
    }
    if (at_mm) *at_mm = end;
    return t.own(end) + t.through(end) * behind;
  }

  // A stack's own slices: each stands for the slab around it, sampled where the ray meets it, at the box's
  // border at the most; with the opacity of the way through its slab.
  struct StackSample {
    double at_mm = 0, length_mm = 0;  // along the ray; of the slab, inside the span
    glm::dvec3 voxel{0};
    bool met = false;  // the slice itself lies inside the span
  };
  std::vector<StackSample> stackSamples(double x, double y, const RaySpan& s, int axis, int perVoxel) const {
    const GridGeometry& g = volume_.grid();
    const glm::dvec3 last(g.columns - 1, g.rows - 1, g.slices - 1);
    const glm::dvec3 from = voxelAt(x, y, 0), along = voxelAt(x, y, 1) - from;
    glm::dvec2 box(-1e30, 1e30);
    for (int n = 0; n < 3; ++n) {
      const double a = -from[n] / along[n], b = (last[n] - from[n]) / along[n];
      box = {std::max(box.x, std::min(a, b)), std::min(box.y, std::max(a, b))};
    }
    std::vector<StackSample> out;
    const int count = static_cast<int>(last[axis]) * perVoxel;
    for (int n = 0; n <= count; ++n) {
      const double place = static_cast<double>(along[axis] > 0 ? n : count - n) / perVoxel;
      const double middle = (place - from[axis]) / along[axis],
                   reach = 0.5 / perVoxel / std::abs(along[axis]);
      StackSample sample;
      sample.length_mm = std::min(s.exit_mm, middle + reach) - std::max(s.entry_mm, middle - reach);
      sample.at_mm = std::clamp(middle, box.x, box.y);
      sample.voxel = from + sample.at_mm * along;
      sample.voxel[axis] = place;
      sample.met = middle >= s.entry_mm && middle <= s.exit_mm;
      if (sample.length_mm > 0) out.push_back(sample);
    }
    return out;
  }
  glm::dvec3 stack(double x, double y, int axis, int perVoxel) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    if (s.empty()) return behind;
    glm::dvec3 colour(0);
    double left = 1;
    for (const StackSample& n : stackSamples(x, y, s, axis, perVoxel)) {
      const glm::dvec4 c = sampleAtVoxel(n.voxel, -camera_.ray(x, y).direction.v, n.length_mm);
      colour += left * c.w * glm::dvec3(c);
      left *= 1 - c.w;
    }
    return colour + left * behind;
  }
  // The nearest slice at which the level is reached.
  glm::dvec3 stackIso(double x, double y, int axis, int perVoxel) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    const Material& m = iso_.material;
    if (s.empty()) return behind;
    for (const StackSample& n : stackSamples(x, y, s, axis, perVoxel)) {
      const std::optional<double> v = field(n.voxel);
      if (!n.met || !v || *v < *iso_.level) continue;
      return lit(m, rgb(m.ambientColour), rgb(m.diffuseColour), gradient(n.voxel, *v),
                 -camera_.ray(x, y).direction.v);
    }
    return behind;
  }
  glm::dvec3 stackExtreme(double x, double y, int axis, int perVoxel) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    const double sign = layer_.mode == VolumeMode::Min ? -1 : 1;
    std::optional<double> best;
    if (!s.empty())
      for (const StackSample& n : stackSamples(x, y, s, axis, perVoxel))
        if (const std::optional<double> v = field(n.voxel); n.met && v && (!best || sign * *v > sign * *best))
          best = v;
    if (!best) return behind;
    const double a = opacityAt(*layer_.transfer, *best);
    return a * colourAt(*layer_.transfer, *best) + (1 - a) * behind;
  }

  // The nearest view-aligned slice at which the level is reached, and the extreme of these slices.
  template <class Take>
  void eachPlanarSample(double x, double y, Take take) const {
    const RaySpan s = span(x, y);
    const double d = case_.step_mm() * camera_.rayPerDepth(x, y);
    if (s.empty()) return;
    for (double k = std::floor(s.entry_mm / d); (k + 0.5) * d <= s.exit_mm; ++k)
      if ((k + 0.5) * d >= s.entry_mm && !take((k + 0.5) * d)) return;
  }
  glm::dvec3 planarIso(double x, double y) const {
    const native::ToolsOnRay t = tools(x, y);
    glm::dvec3 seen = t.ends() ? t.endColour : rgb(case_.scene.background);
    const Material& m = iso_.material;
    eachPlanarSample(x, y, [&](double at) {
      const std::optional<double> v = fieldAt(x, y, at);
      if (!v || *v < *iso_.level) return true;
      seen = lit(m, rgb(m.ambientColour), rgb(m.diffuseColour), gradient(voxelAt(x, y, at), *v),
                 -camera_.ray(x, y).direction.v);
      return false;
    });
    return seen;
  }
  glm::dvec3 planarExtreme(double x, double y) const {
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    const double sign = layer_.mode == VolumeMode::Min ? -1 : 1;
    std::optional<double> best;
    glm::dvec3 channels(-1e9);
    eachPlanarSample(x, y, [&](double at) {
      if (volume_.isColour())
        channels = glm::max(channels, sign * glm::dvec3(colourSample(voxelAt(x, y, at), 1)));
      else if (const std::optional<double> v = fieldAt(x, y, at); v && (!best || sign * *v > sign * *best))
        best = v;
      return true;
    });
    if (channels.x > -1e8) return sign * channels;
    if (!best) return behind;
    const double a = opacityAt(*layer_.transfer, *best);
    return a * colourAt(*layer_.transfer, *best) + (1 - a) * behind;
  }

  static glm::dvec3 rgb(Rgb c) { return {c.r, c.g, c.b}; }

 private:
  bool reaches(double x, double y, double t) const {
    const std::optional<double> v = fieldAt(x, y, t);
    return v && *v >= *iso_.level;
  }
  glm::dvec4 colourSample(glm::dvec3 voxel, double length_mm) const {
    const GridGeometry& g = volume_.grid();
    voxel = glm::clamp(voxel, glm::dvec3(0), glm::dvec3(g.columns - 1, g.rows - 1, g.slices - 1));
    const auto c = *sampleColour(volume_, g.patientFromVoxel * VoxelPoint(voxel), layer_.interpolation);
    const glm::dvec3 spacing = g.spacing_mm();
    glm::dvec4 out;
    for (int n = 0; n < 4; ++n) {
      const auto i = static_cast<std::size_t>(n);
      out[n] = std::clamp(c[i] / 255 * layer_.gains[i], 0.0, 1.0);
    }
    out.w = over(out.w, length_mm / std::min({spacing.x, spacing.y, spacing.z}));
    return out;
  }
  glm::dvec4 preSample(glm::dvec3 voxel, double length_mm) const {
    const GridGeometry& g = volume_.grid();
    const glm::dvec3 last(g.columns - 1, g.rows - 1, g.slices - 1);
    voxel = glm::clamp(voxel, glm::dvec3(0), last);
    glm::dvec4 sum(0);
    for (int corner = 0; corner < 8; ++corner) {
      glm::dvec3 at = glm::floor(voxel);
      double w = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const double t = voxel[axis] - at[axis];
        w *= corner >> axis & 1 ? t : 1 - t;
        at[axis] += corner >> axis & 1;
      }
      if (w == 0) continue;
      const double v = volume_.modality(static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y),
                                        static_cast<std::int64_t>(at.z));
      const double a = over(opacityAt(*layer_.transfer, v), length_mm / layer_.transfer->opacityLength_mm);
      sum += w * glm::dvec4(a * colourAt(*layer_.transfer, v), a);
    }
    return sum.w > 0 ? glm::dvec4(glm::dvec3(sum) / sum.w, sum.w) : glm::dvec4(0);
  }
  const DvrCase& case_;
  const Volume& volume_;
  CameraPicture camera_;
  std::vector<HalfSpace> region_;
  native::SurfaceHits hits_;
  VolumeLayer layer_;
  IsosurfaceLayer iso_;
};

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
