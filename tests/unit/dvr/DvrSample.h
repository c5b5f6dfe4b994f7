// SPDX-License-Identifier: GPL-3.0-or-later
// Included by DvrTruth.h. Rays, tools, field, gradient, light and classification of a case, in double.
#pragma once

namespace vernier::test {

class DvrSample {
 public:
  explicit DvrSample(const DvrCase& c)
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

  static glm::dvec3 rgb(Rgb c) { return {c.r, c.g, c.b}; }

 protected:
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

}  // namespace vernier::test
