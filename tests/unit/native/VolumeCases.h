// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering jobs for tests, and what they must give: a ray caster in long double that shares the
// camera's rays and the transfer function's numbers with the engine, and nothing else.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../volume/Grids.h"
#include "vernier/native/VolumeRender.h"

namespace vernier::test {

struct VolumeCase {
  std::shared_ptr<const Volume> volume;
  std::shared_ptr<const native::ProjectionBounds> bounds;
  std::shared_ptr<const native::VisibleBricks> visible;
  std::shared_ptr<const TransferFunction> function;
  std::shared_ptr<const TransferTable> table;
  std::shared_ptr<const PreIntegratedTable> preIntegrated;
  native::VolumeRenderJob job;

  Images draw() const {
    Images images;
    const Result<void> drawn = native::renderVolume(job, images);
    EXPECT_TRUE(drawn.ok()) << (drawn.ok() ? "" : drawn.error().text());
    return images;
  }
  Volume::Range range() const {
    const Volume::Range values = volume->modalityRange().value_or(Volume::Range{0, 1});
    return job.classification == Classification::PreIntegrated ? preIntegratedRange(*function, values)
                                                               : transferTableRange(*function, values);
  }
  // Tables for a step in mm.
  void setStep(double step_mm) {
    job.step_mm = step_mm;
    Result<TransferTable> t =
        makeTransferTable(*function, range(), step_mm, job.opacity == OpacityRule::Linear);
    const Volume::Range values = volume->modalityRange().value_or(Volume::Range{0, 1});
    Result<PreIntegratedTable> p =
        makePreIntegratedTable(*function, preIntegratedRange(*function, values), step_mm);
    ASSERT_TRUE(t && p);
    table = std::make_shared<const TransferTable>(*std::move(t));
    preIntegrated = std::make_shared<const PreIntegratedTable>(*std::move(p));
    job.table = table.get(), job.preIntegrated = preIntegrated.get();
  }
  void useVisible() {
    bounds = *native::projectionBounds(*volume);
    const bool byTable = job.classification == Classification::PreIntegrated;
    visible = native::visibleBricks(*bounds, *function, range(), byTable ? preIntegrated->size : table->size);
    job.bounds = bounds.get(), job.visible = visible.get();
  }
};

inline VolumeCase volumeCase(std::shared_ptr<const Volume> volume, const TransferFunction& f,
                             Camera camera = {}, View view = {48, 40}, const Scene& scene = {}) {
  VolumeCase c;
  c.volume = std::move(volume);
  c.function = std::make_shared<const TransferFunction>(f);
  const GridGeometry& grid = c.volume->grid();
  c.job.volume = c.volume.get();
  c.job.function = c.function.get();
  const Result<CameraPicture> picture = cameraPicture(camera, view, cameraBox(grid));
  EXPECT_TRUE(picture) << picture.error().sentence;
  c.job.camera = *picture;
  c.job.region = *keptRegion(scene, grid);
  c.job.background = scene.background;
  c.job.leastLight = 0;
  const glm::dvec3 s = grid.spacing_mm();
  c.setStep(0.7 * std::min({s.x, s.y, s.z}));
  return c;
}

inline VolumeInfo obliqueVolume(std::int64_t columns, std::int64_t rows, std::int64_t slices) {
  VolumeInfo info;
  info.grid = unitGrid(columns, rows, slices);
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.9, 0.3, 0.1));
  const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(0.1, 0.9, -0.2)));
  info.grid.patientFromVoxel.linear = glm::dmat3(0.8 * x, 0.9 * glm::cross(z, x), 1.3 * z);
  info.grid.patientFromVoxel.translation = {-120, 30, 700};
  return info;
}

// Three soft balls, values 0..1000.
template <class T = std::int16_t>
std::shared_ptr<const Volume> balls(VolumeInfo info = obliqueVolume(40, 36, 28)) {
  const GridGeometry& g = info.grid;
  std::vector<T> v;
  for (int k = 0; k < g.slices; ++k)
    for (int j = 0; j < g.rows; ++j)
      for (int i = 0; i < g.columns; ++i) {
        const auto ball = [&](double x, double y, double z, double r) {
          return std::exp(-(std::pow(i - x, 2) + std::pow(j - y, 2) + std::pow(k - z, 2)) / (2 * r * r));
        };
        const double sum = ball(12, 15, 8, 4) + 0.8 * ball(28, 22, 18, 3) + 0.6 * ball(20, 6, 20, 5);
        v.push_back(static_cast<T>((sizeof(T) == 1 ? 250 : 1000) * std::min(1.0, sum)));
      }
  return volumeOf(info, v);
}

// Over values 0..`most`: nothing, then translucent, then dense.
inline TransferFunction softFunction(double most = 1000) {
  return {{{0.1 * most, {.2, .1, .9}}, {0.5 * most, {.9, .6, .1}}, {most, {1, 1, .8}}},
          {{0.1 * most, 0}, {0.3 * most, .08}, {0.6 * most, .25}, {most, .9}},
          1};
}

inline Camera turnedCamera(Projection p = Projection::Orthographic) {
  Camera c;
  c.azimuth_deg = 34, c.elevation_deg = 21, c.roll_deg = -8, c.projection = p;
  c.zoom = 1.3;
  return c;
}

struct BruteRay {
  glm::dvec3 colour{0};
  double through = 1, half_mm = INFINITY;
};

class BruteCaster {
 public:
  explicit BruteCaster(const native::VolumeRenderJob& job) : job_(job), v_(*job.volume) {}
  bool splitsEnds = true;  // false: a cut step counts whole, the mutant

  BruteRay at(double x, double y) const {
    const PatientRay ray = job_.camera.ray(x, y);
    double from = std::max(0.0, job_.camera.near_mm * job_.camera.rayPerDepth(x, y)), to = INFINITY;
    for (const HalfSpace& h : job_.region) {
      const double outside = h.distance_mm(ray.origin), slope = dot(h.normal, ray.direction);
      if (slope > 0) to = std::min(to, -outside / slope);
      if (slope < 0) from = std::max(from, -outside / slope);
      if (slope == 0 && outside > 0) to = -1;
    }
    long double c[3] = {0, 0, 0}, through = 1;
    BruteRay out;
    for (auto k = static_cast<std::int64_t>(std::floor(from / job_.step_mm)); from < to; ++k) {
      const long double s = job_.step_mm, begin = k * s, end = (k + 1) * s;
      if (begin >= static_cast<long double>(to)) break;
      long double share = (std::min<long double>(end, to) - std::max<long double>(begin, from)) / s;
      if (!splitsEnds) share = 1;
      const auto [colour, opacity] = step(ray, begin, end);
      const long double a = opacity >= 1 ? 1 : -std::expm1(share * std::log1p(-opacity));
      for (int n = 0; n < 3; ++n) c[n] += through * a * static_cast<long double>(colour[n]);
      const long double after = through * (1 - a);
      if (through > 0.5L && after <= 0.5L) {
        const double low = double(std::max<long double>(begin, from)),
                     high = double(std::min<long double>(end, to));
        out.half_mm = after > 0
                          ? low + (high - low) * double(std::log(0.5L / through) / std::log(after / through))
                          : low;
      }
      through = after;
    }
    const glm::dvec3 bg(job_.background.r, job_.background.g, job_.background.b);
    for (int n = 0; n < 3; ++n) out.colour[n] = double(c[n] + through * static_cast<long double>(bg[n]));
    out.through = double(through);
    return out;
  }

  // Trilinear, moved to the box of voxel centres.
  double field(glm::dvec3 p) const {
    const GridGeometry& g = v_.grid();
    const double last[3] = {double(g.columns - 1), double(g.rows - 1), double(g.slices - 1)};
    std::int64_t i[3];
    double f[3];
    for (int a = 0; a < 3; ++a) {
      p[a] = std::clamp(p[a], 0.0, last[a]);
      i[a] = std::min<std::int64_t>(std::int64_t(p[a]), std::int64_t(last[a]) - 1);
      f[a] = p[a] - double(i[a]);
    }
    double sum = 0;
    for (int n = 0; n < 8; ++n) {
      const int dx = n & 1, dy = n >> 1 & 1, dz = n >> 2;
      sum += (dx ? f[0] : 1 - f[0]) * (dy ? f[1] : 1 - f[1]) * (dz ? f[2] : 1 - f[2]) *
             v_.modality(i[0] + dx, i[1] + dy, i[2] + dz);
    }
    return sum;
  }

 private:
  glm::dvec3 voxel(const PatientRay& ray, long double t) const {
    return (v_.voxelFromPatient() * ray.at(double(t))).p;
  }

  std::pair<glm::dvec3, long double> step(const PatientRay& ray, long double begin, long double end) const {
    const glm::dvec3 p = voxel(ray, (begin + end) / 2);
    glm::dvec3 colour(0);
    long double opacity = 0;
    if (job_.classification == Classification::PreIntegrated) {
      const double front = field(voxel(ray, begin)), back = field(voxel(ray, end));
      constexpr int kLayers = 400;
      long double through = 1, c[3] = {0, 0, 0};
      for (int n = 0; n < kLayers; ++n) {
        const double value = front + (back - front) * (n + 0.5) / kLayers;
        const long double left =
            std::pow(1 - static_cast<long double>(opacityAt(*job_.function, value)),
                     static_cast<long double>(job_.step_mm / job_.function->opacityLength_mm / kLayers));
        for (int k = 0; k < 3; ++k)
          c[k] += through * (1 - left) * static_cast<long double>(colourAt(*job_.function, value)[k]);
        through *= left;
      }
      opacity = 1 - through;
      if (opacity > 0) colour = {double(c[0] / opacity), double(c[1] / opacity), double(c[2] / opacity)};
    } else {
      const double value = field(p);
      const long double a = opacityAt(*job_.function, value),
                        lengths = job_.step_mm / job_.function->opacityLength_mm;
      opacity =
          job_.opacity == OpacityRule::Linear ? std::min(1.0L, a * lengths) : 1 - std::pow(1 - a, lengths);
      colour = colourAt(*job_.function, value);
    }
    if (job_.shading != ShadingModel::None && opacity > 0) colour = lit(p, colour, -ray.direction.v);
    return {colour, opacity};
  }

  glm::dvec3 lit(const glm::dvec3& q, const glm::dvec3& own, const glm::dvec3& eye) const {
    const GridGeometry& grid = v_.grid();
    const glm::dvec3 p =
        glm::clamp(q, glm::dvec3(0), glm::dvec3(grid.columns - 1, grid.rows - 1, grid.slices - 1));
    glm::dvec3 g(0);
    for (int a = 0; a < 3; ++a) {
      glm::dvec3 e(0);
      e[a] = 1;
      g[a] = (field(p + e) - field(p - e)) / 2;
    }
    g = glm::transpose(v_.voxelFromPatient().linear) * g;
    const Material& m = job_.material;
    const bool perVoxel = job_.shading == ShadingModel::ColourPerVoxel;
    const glm::dvec3 ca =
        perVoxel ? own : glm::dvec3(m.ambientColour.r, m.ambientColour.g, m.ambientColour.b);
    const glm::dvec3 cd =
        perVoxel ? own : glm::dvec3(m.diffuseColour.r, m.diffuseColour.g, m.diffuseColour.b);
    glm::dvec3 out = m.ambient * ca;
    std::vector<Light> lights = job_.lights;
    if (lights.empty()) lights.emplace_back();
    if (glm::length(g) > 0) {
      glm::dvec3 n = glm::normalize(g);
      if (glm::dot(n, eye) < 0) n = -n;
      for (const Light& light : lights) {
        const glm::dvec3 l = light.towards ? glm::normalize(light.towards->v) : eye,
                         h = glm::normalize(l + eye);
        out += glm::dvec3(light.colour.r, light.colour.g, light.colour.b) *
               (m.diffuse * std::max(0.0, glm::dot(n, l)) * cd +
                m.specular * std::pow(std::max(0.0, glm::dot(n, h)), m.power));
      }
    }
    return glm::clamp(out, 0.0, 1.0);
  }

  const native::VolumeRenderJob& job_;
  const Volume& v_;
};

// The largest difference of `count` pixels, in levels of 255, spread over the picture.
inline double differenceFromBrute(const VolumeCase& c, const Images& images, int count = 100) {
  const BruteCaster brute(c.job);
  double most = 0;
  for (int n = 0; n < count; ++n) {
    const int x = int(randomUnit(7, std::uint64_t(2 * n)) * images.width);
    const int y = int(randomUnit(7, std::uint64_t(2 * n + 1)) * images.height);
    const BruteRay truth = brute.at(x + 0.5, y + 0.5);
    const std::size_t pixel = std::size_t(x) + std::size_t(images.width) * std::size_t(y);
    for (std::size_t k = 0; k < 3; ++k)
      most = std::max(most, 255 * std::abs(double(images.colour[4 * pixel + k]) - truth.colour[int(k)]));
    // Where light falls slowly through a half, the place is as sensitive.
    const bool none = std::isinf(images.depth[pixel]);
    if (std::isinf(truth.half_mm) || none) {
      EXPECT_TRUE((std::isinf(truth.half_mm) && none) || std::abs(truth.through - 0.5) < 1e-3);
    } else {
      EXPECT_NEAR(images.depth[pixel], truth.half_mm, 0.02) << x << " " << y;
    }
  }
  return most;
}

}  // namespace vernier::test
