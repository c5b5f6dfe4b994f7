// SPDX-License-Identifier: GPL-3.0-or-later
// Shells through the planner, and what their pictures must be: each pixel's ray against each triangle in
// double, sorted lists of crossings, and the rules of plan/Scene.h applied to them.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "AngiographyTechniques.h"
#include "ShellParams.h"
#include "TechniqueHost.h"
#include "VesselVolume.h"
#include "vernier/volume/Sampling.h"

namespace vernier::test {

inline constexpr const char* kShellTechniques[] = {"shells.native", "shells.gl", "shells.glmax"};
inline std::string shellTechniqueName(const ::testing::TestParamInfo<const char*>& name) {
  return std::string(name.param).substr(7);
}

class ShellHost final : public TechniqueHost {
 public:
  static ShellHost& instance() {
    static ShellHost host;
    return host;
  }
  std::shared_ptr<angiography::ShellStore> store = std::make_shared<angiography::ShellStore>(*this);

 private:
  ShellHost() {
    EXPECT_TRUE(addTechnique(angiography::nativeShellsTechnique(store)).ok());
    EXPECT_TRUE(addTechnique(angiography::glShellsTechnique(*this, store)).ok());
    EXPECT_TRUE(addTechnique(angiography::glMaxShellsTechnique(*this, store)).ok());
  }
};

struct ShellCase {
  Scene scene;
  View view{72, 60};
  Sources sources;
  explicit ShellCase(std::shared_ptr<const Volume> volume = vesselVolume()) {
    sources.volumes["v"] = std::move(volume);
    ShellsLayer layer;
    layer.source = "v";
    layer.levels = {30, 60, 90, 120, 150};
    layer.window = VoiWindow{100, 200, VoiFunction::LinearExact, ""};
    scene.layers.emplace_back(layer);
    scene.camera.azimuth_deg = 25, scene.camera.elevation_deg = 15, scene.camera.roll_deg = 5;
    scene.camera.zoom = 1.2;
  }
  ShellsLayer& shells() { return std::get<ShellsLayer>(scene.layers[0]); }
  void addTool(std::shared_ptr<const Mesh> mesh, PatientPoint at, double opacity = 1,
               Rgb colour = {1, 0.2, 0.1}) {
    SurfaceLayer tool;
    tool.source = "tool" + std::to_string(scene.layers.size());
    tool.pose.translation = at.p;
    tool.opacity = opacity, tool.colour = colour;
    sources.meshes[tool.source] = std::move(mesh);
    scene.layers.emplace_back(tool);
  }
  Result<Plan> plan(const std::string& technique = "") const {
    Quality quality;
    quality.technique = technique;
    const ShellHost& host = ShellHost::instance();
    return makePlan(scene, view, quality, host.capabilities, CostTable{}, sources, host.registry);
  }
  Result<Images> draw(const std::string& technique = "shells.native", std::stop_token stop = {}) const {
    const Result<Plan> p = plan(technique);
    if (!p) return p.error();
    Images images;
    for (const Pass& pass : p->passes)
      if (auto done = ShellHost::instance().registry.find(pass.technique)->execute(pass, images, stop); !done)
        return done.error();
    return images;
  }
  native::ShellsJob job() const {
    const Result<Plan> p = plan("shells.native");
    EXPECT_TRUE(p.ok()) << p.error().text();
    return *angiography::withMeshes(dynamic_cast<const angiography::ShellParams&>(*p->passes[0].params),
                                    *ShellHost::instance().store, {});
  }
};

struct Hit {
  double t_mm = 0;
  int of = 0;  // shell or tool
  double cosine = 1;
  bool cap = false;
};

// T. Moeller, B. Trumbore, Fast, Minimum Storage Ray/Triangle Intersection (1997).
inline std::optional<Hit> meet(const PatientRay& ray, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const glm::dvec3 ab = b - a, ac = c - a, d = ray.direction.v, p = glm::cross(d, ac);
  const double det = glm::dot(ab, p);
  if (det == 0) return std::nullopt;
  const glm::dvec3 s = (ray.origin.p - a) / det, q = glm::cross(s, ab);
  const double u = glm::dot(s, p), v = glm::dot(d, q);
  if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
  const glm::dvec3 n = glm::normalize(glm::cross(ab, ac));
  return Hit{glm::dot(ac, q), 0, std::abs(glm::dot(n, d)), false};
}

// Triangles in the patient, in runs with a sphere around each: what the ray passes by is not looked at.
class Triangles {
 public:
  Triangles(const Mesh& mesh, const PatientFromMesh& pose) {
    for (const Triangle& t : mesh.triangles())
      for (const std::uint32_t v : t) corners_.push_back((pose * mesh.vertices()[v]).p);
    for (std::size_t first = 0; first < corners_.size(); first += kRun) {
      const std::size_t end = std::min(corners_.size(), first + kRun);
      glm::dvec3 low(1e9), high(-1e9);
      for (std::size_t n = first; n < end; ++n)
        low = glm::min(low, corners_[n]), high = glm::max(high, corners_[n]);
      spheres_.emplace_back(0.5 * (low + high), 0.5 * glm::length(high - low) + 1e-9);
    }
  }
  void meetAll(const PatientRay& ray, int of, std::vector<Hit>& out) const {
    for (std::size_t s = 0; s < spheres_.size(); ++s) {
      const glm::dvec3 to = glm::dvec3(spheres_[s]) - ray.origin.p;
      const double along = glm::dot(to, ray.direction.v);
      if (glm::dot(to, to) - along * along > spheres_[s].w * spheres_[s].w * (1 + 1e-9) + 1e-6) continue;
      for (std::size_t n = s * kRun; n < std::min(corners_.size(), (s + 1) * kRun); n += 3)
        if (auto h = meet(ray, corners_[n], corners_[n + 1], corners_[n + 2])) h->of = of, out.push_back(*h);
    }
  }

 private:
  static constexpr std::size_t kRun = 3 * 16;
  std::vector<glm::dvec3> corners_;
  std::vector<glm::dvec4> spheres_;
};

// The exact list of a pixel.
struct RayList {
  std::vector<Hit> shells, tools;  // nearest first
};

class ShellTruth {
 public:
  explicit ShellTruth(const ShellCase& c) : job_(c.job()) {
    for (std::size_t n = 0; n < job_.shells.size(); ++n)
      if (job_.shells[n].mesh) shells_.emplace_back(n, Triangles(*job_.shells[n].mesh, {}));
    for (std::size_t n = 0; n < job_.tools.size(); ++n)
      if (job_.tools[n].opacity > 0)
        tools_.emplace_back(n, Triangles(*job_.tools[n].mesh, job_.tools[n].pose));
  }
  const native::ShellsJob& job() const { return job_; }

  RayList at(double x, double y) const {
    const PatientRay ray = job_.camera.ray(x, y);
    RayList out;
    for (const auto& [n, triangles] : shells_) triangles.meetAll(ray, n, out.shells);
    for (const auto& [n, triangles] : tools_) triangles.meetAll(ray, n, out.tools);
    const double near_mm = job_.camera.near_mm * job_.camera.rayPerDepth(x, y);
    std::erase_if(out.shells,
                  [&](const Hit& h) { return cutAway(ray.at(h.t_mm)) || h.t_mm < near_mm || h.t_mm < 0; });
    std::erase_if(out.tools, [&](const Hit& h) { return h.t_mm < near_mm || h.t_mm < 0; });
    addCaps(ray, near_mm, x, y, out.shells);
    for (auto* list : {&out.shells, &out.tools})
      std::sort(list->begin(), list->end(), [](const Hit& a, const Hit& b) { return a.t_mm < b.t_mm; });
    return out;
  }

  glm::dvec3 colour(const RayList& ray, double x, double y) const {
    double end = INFINITY, through = 1;
    glm::dvec3 own(0), backdrop = job_.background;
    std::vector<Hit> shells = ray.shells;
    if (job_.mode == ShellsMode::Lit && !shells.empty()) end = shells[0].t_mm;
    std::vector<std::pair<double, double>> left{{-INFINITY, 1.0}};
    bool opaque = false;
    for (const Hit& h : ray.tools) {
      if (h.t_mm >= end) break;
      const PlacedSurface& tool = job_.tools[static_cast<std::size_t>(h.of)];
      const glm::dvec3 lit = tool.colour * std::min(1.0, 0.2 + 0.8 * h.cosine);
      if (tool.opacity >= 1) {
        end = h.t_mm, opaque = true, backdrop = lit;
        break;
      }
      own += through * tool.opacity * lit;
      through *= 1 - tool.opacity;
      left.emplace_back(h.t_mm, through);
    }
    if (job_.mode != ShellsMode::Lit)
      std::erase_if(shells, [&](const Hit& h) { return h.t_mm >= end; });
    else if (opaque)
      shells.clear();
    const auto brightness = [&](const Hit& h) {
      double w = 1;
      for (const auto& [t, l] : left)
        if (t < h.t_mm) w = l;
      const double depth = h.t_mm / job_.camera.rayPerDepth(x, y);
      const double z = job_.ramp.at(std::clamp(depth, job_.ramp.near_mm, job_.ramp.far_mm));
      return w * job_.shells[static_cast<std::size_t>(h.of)].phi *
             (job_.beta0 + job_.betaM * (job_.a * z + job_.b));
    };
    if (job_.mode == ShellsMode::Lit) {
      if (!shells.empty()) backdrop = job_.colour * std::min(1.0, 0.2 + 0.8 * litCosine(shells[0], x, y));
      return own + through * backdrop;
    }
    double most = 0, sum = 0;
    for (const Hit& h : shells) most = std::max(most, brightness(h)), sum += brightness(h);
    if (job_.mode == ShellsMode::Sum)
      return own + job_.colour * sum + (shells.empty() || opaque ? through * backdrop : glm::dvec3(0));
    const glm::dvec3 floor = through * job_.colour * job_.beta0 * job_.phi0;
    if (opaque) return own + (shells.empty() ? through * backdrop : job_.colour * most);
    return own + glm::max(floor, shells.empty() ? through * backdrop : job_.colour * most);
  }

  // Of a lit shell: by the field's gradient where the ray passes the level next to the mesh, found by small
  // steps; the triangle's own where it does not pass it within 1.5 voxels.
  double litCosine(const Hit& hit, double x, double y) const {
    if (hit.cap) return hit.cosine;
    const PatientRay ray = job_.camera.ray(x, y);
    const double level = job_.shells[static_cast<std::size_t>(hit.of)].level;
    const glm::dmat3 toVoxel = job_.volume->voxelFromPatient().linear;
    const glm::dvec3 perMm = glm::abs(toVoxel * ray.direction.v);
    const double voxel = 1 / std::max({perMm.x, perMm.y, perMm.z}), step = voxel / 128;
    const auto value = [&](double t) {
      return sampleModality(*job_.volume, ray.at(t)).value_or(NAN) - level;
    };
    for (std::size_t n = 0; n < 6; ++n)  // flat where the volume ends inside of a shell
      if (job_.kept[n].distance_mm(ray.at(hit.t_mm)) > -1e-3 && value(hit.t_mm) >= 0) return hit.cosine;
    for (int n = 0; n < 192; ++n)
      for (const double side : {-1.0, 1.0}) {
        double from = hit.t_mm + side * n * step, to = from + side * step, f = value(from);
        if (const double g = value(to); !((f < 0 && g >= 0) || (f >= 0 && g < 0))) continue;
        for (int halves = 0; halves < 50; ++halves) {
          const double middle = 0.5 * (from + to), g = value(middle);
          ((g < 0) == (f < 0) ? from : to) = middle;
        }
        const PatientPoint at = ray.at(from);
        glm::dvec3 slope(0);
        for (int axis = 0; axis < 3; ++axis) {
          glm::dvec3 off(0);
          off[axis] = 1e-6;
          const PatientVec d(glm::inverse(toVoxel) * off);
          slope[axis] = *sampleModality(*job_.volume, at + d) - *sampleModality(*job_.volume, at - d);
        }
        const glm::dvec3 normal = glm::normalize(glm::transpose(toVoxel) * slope);
        return std::abs(glm::dot(normal, ray.direction.v));
      }
    return hit.cosine;
  }

 private:
  bool cutAway(PatientPoint p) const {
    for (std::size_t n = 6; n < job_.kept.size(); ++n)
      if (job_.kept[n].distance_mm(p) > 1e-7) return true;
    return false;
  }
  // A ray that gets into, or out of, the region elsewhere than at the volume's box meets what it is inside
  // of.
  void addCaps(const PatientRay& ray, double near_mm, double x, double y, std::vector<Hit>& out) const {
    double begin = std::max(0.0, near_mm), end = INFINITY, beginCosine = 1 / job_.camera.rayPerDepth(x, y),
           endCosine = 1;
    bool cutBegin = true, cutEnd = false;
    for (std::size_t n = 0; n < job_.kept.size(); ++n) {
      const HalfSpace& h = job_.kept[n];
      const double slope = dot(h.normal, ray.direction), t = -h.distance_mm(ray.origin) / slope;
      if (slope < 0 && t > begin - (n < 6 ? 1e-6 : 0)) begin = t, cutBegin = n >= 6, beginCosine = -slope;
      if (slope > 0 && t < end - (n < 6 ? 0 : 1e-6)) end = t, cutEnd = n >= 6, endCosine = slope;
    }
    if (!(begin < end)) return;
    const auto cap = [&](double t, double cosine) {
      const auto value = sampleModality(*job_.volume, ray.at(t));
      if (!value) return;
      int reached = 0;
      while (reached < static_cast<int>(job_.shells.size()) &&
             job_.shells[static_cast<std::size_t>(reached)].level <= *value)
        ++reached;
      for (int s = job_.mode == ShellsMode::Sum ? 0 : std::max(0, reached - 1); s < reached; ++s)
        out.push_back({t, s, cosine, true});
    };
    if (cutBegin) cap(begin, beginCosine);
    if (cutEnd) cap(end, endCosine);
  }
  native::ShellsJob job_;
  std::vector<std::pair<int, Triangles>> shells_, tools_;
};

// Pixels whose colour is off by more than `tolerance` in any channel; by more than 2 levels of 255 where a
// ray meets more than eight tools, of which those behind are joined.
inline std::vector<glm::ivec2> wrongPixels(const ShellCase& c, const Images& images, double tolerance) {
  const ShellTruth truth(c);
  std::vector<glm::ivec2> wrong;
  for (int y = 0; y < images.height; ++y)
    for (int x = 0; x < images.width; ++x) {
      const RayList ray = truth.at(x + 0.5, y + 0.5);
      const glm::dvec3 expected = truth.colour(ray, x + 0.5, y + 0.5);
      const double allowed = ray.tools.size() > 8 ? std::max(tolerance, 2.0 / 255) : tolerance;
      const float* const seen = images.colour.data() + 4 * (x + images.width * y);
      const glm::dvec3 off = glm::abs(glm::dvec3(seen[0], seen[1], seen[2]) - expected);
      if (!(std::max({off.x, off.y, off.z}) <= allowed)) wrong.emplace_back(x, y);
    }
  return wrong;
}

// At most 1 in 1000 pixels wrong, and not a picture of nothing.
inline void expectTruth(const ShellCase& c, const std::string& technique, double tolerance) {
  const Result<Images> images = c.draw(technique);
  ASSERT_TRUE(images.ok()) << images.error().text();
  const auto pixels = static_cast<std::size_t>(images->width * images->height);
  std::size_t shown = 0;
  for (std::size_t n = 0; n < pixels; ++n) shown += images->depth[n] < kNothing_mm;
  EXPECT_GT(shown, pixels / 10);
  const auto wrong = wrongPixels(c, *images, tolerance);
  EXPECT_LE(wrong.size(), pixels / 1000) << technique << ", first at " << (wrong.empty() ? -1 : wrong[0].x)
                                         << " " << (wrong.empty() ? -1 : wrong[0].y);
}

}  // namespace vernier::test
