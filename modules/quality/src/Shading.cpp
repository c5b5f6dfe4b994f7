// SPDX-License-Identifier: GPL-3.0-or-later
#include "Shading.h"

#include <cmath>

namespace vernier::quality {
namespace {

glm::dvec3 of(Rgb c) { return {c.r, c.g, c.b}; }
bool finite(glm::dvec3 v) { return std::isfinite(v.x + v.y + v.z); }

}  // namespace

Result<Shading> Shading::make(const Scene& scene, const Material& m) {
  Shading s;
  s.material_ = m;
  s.ambientColour_ = of(m.ambientColour), s.diffuseColour_ = of(m.diffuseColour);
  if (!std::isfinite(m.ambient + m.diffuse + m.specular + m.power) ||
      !finite(s.ambientColour_ + s.diffuseColour_))
    return makeError(ErrorCode::SceneInvalid, "The numbers of a material must be finite.");
  for (std::size_t n = 0; n < scene.lights.size(); ++n) {
    const Light& light = scene.lights[n];
    Lamp lamp;
    lamp.colour = of(light.colour);
    if (light.towards) {
      const double length = glm::length(light.towards->v);
      if (!(length > 0) || !std::isfinite(length) || !finite(lamp.colour))
        return makeError(ErrorCode::SceneInvalid, "A light needs a finite direction other than 0.",
                         "/lights/" + std::to_string(n));
      lamp.towards = light.towards->v / length;
    }
    s.lamps_.push_back(lamp);
  }
  if (s.lamps_.empty()) s.lamps_.push_back({});
  return s;
}

glm::dvec3 Shading::lit(glm::dvec3 ambient, glm::dvec3 diffuse, glm::dvec3 gradient, glm::dvec3 ray) const {
  glm::dvec3 sum = material_.ambient * ambient;
  const double size = glm::length(gradient);
  if (size > 0 && std::isfinite(size)) {
    const glm::dvec3 eye = -ray;
    glm::dvec3 n = gradient / size;
    if (glm::dot(n, eye) < 0) n = -n;
    for (const Lamp& lamp : lamps_) {
      const glm::dvec3 l = lamp.towards.value_or(eye), halfway = l + eye;
      const double apart = glm::length(halfway);
      const double facing = std::max(0.0, glm::dot(n, l));
      const double shine = apart > 0 ? std::max(0.0, glm::dot(n, halfway) / apart) : 0;
      sum += lamp.colour *
             (material_.diffuse * facing * diffuse + material_.specular * std::pow(shine, material_.power));
    }
  }
  return glm::clamp(sum, 0.0, 1.0);
}

Gradient::Gradient(const Volume& volume, Interpolation interpolation)
    : volume_(volume), field_(volume, interpolation) {
  const GridGeometry& g = volume.grid();
  even_ = g.even() && interpolation == Interpolation::Linear;
  toPatient_ = glm::transpose(volume.voxelFromPatient().linear);
  box_ = centreBox(g);
}

glm::dvec3 Gradient::at(glm::dvec3 p) const {
  const std::optional<double> here = field_.at(p);
  if (!here) return glm::dvec3(0);
  glm::dvec3 d;
  for (int axis = 0; axis < 3; ++axis) {
    const auto beside = [&](double by) {
      glm::dvec3 q = p;
      q[axis] += by;
      return field_.at(box_.hold(q)).value_or(*here);
    };
    d[axis] = 0.5 * (beside(1) - beside(-1));
  }
  return patient(d);
}

std::optional<glm::dvec3> Gradient::atVoxel(glm::i64vec3 p) const {
  const GridGeometry& g = volume_.grid();
  const glm::i64vec3 last(g.columns - 1, g.rows - 1, g.slices - 1);
  glm::dvec3 d;
  for (int axis = 0; axis < 3; ++axis) {
    double side[2];
    for (int s = 0; s < 2; ++s) {
      glm::i64vec3 q = p;
      q[axis] = std::clamp<std::int64_t>(q[axis] + 2 * s - 1, 0, last[axis]);
      const std::optional<double> v = field_.voxel(q.x, q.y, q.z);
      if (!v) return std::nullopt;
      side[s] = *v;
    }
    d[axis] = 0.5 * (side[1] - side[0]);
  }
  return patient(d);
}

Gradient::Along::Along(const Gradient& gradient, const RayPart& part)
    : gradient_(gradient), from_vox_(part.from_vox), across_vox_(part.across_vox) {
  if (!gradient.even_ || !part.piece.plain) return;
  const GridGeometry& g = gradient.volume_.grid();
  const glm::dvec3 mid = from_vox_ + 0.5 * across_vox_;
  const glm::i64vec3 last(g.columns - 2, g.rows - 2, g.slices - 2);
  glm::i64vec3 cell;
  for (int axis = 0; axis < 3; ++axis)
    cell[axis] = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(mid[axis])), 0, last[axis]);
  std::array<glm::dvec3, 8> corner;
  for (int n = 0; n < 8; ++n) {
    const auto v = gradient.atVoxel(cell + glm::i64vec3(n & 1, n >> 1 & 1, n >> 2));
    if (!v) return;
    corner[static_cast<std::size_t>(n)] = *v;
  }
  // The trilinear interpolation of the corners at f + s u.
  const glm::dvec3 f = from_vox_ - glm::dvec3(cell), s = across_vox_;
  const auto& c = corner;
  const glm::dvec3 x = c[1] - c[0], y = c[2] - c[0], z = c[4] - c[0], xy = c[3] - c[2] - x,
                   yz = c[6] - c[4] - y, zx = c[5] - c[4] - x, xyz = c[7] - c[6] - c[5] + c[4] - xy;
  c_[0] = c[0] + f.x * x + f.y * y + f.z * z + f.x * f.y * xy + f.y * f.z * yz + f.z * f.x * zx +
          f.x * f.y * f.z * xyz;
  c_[1] = s.x * x + s.y * y + s.z * z + (f.x * s.y + s.x * f.y) * xy + (f.y * s.z + s.y * f.z) * yz +
          (f.z * s.x + s.z * f.x) * zx + (s.x * f.y * f.z + f.x * s.y * f.z + f.x * f.y * s.z) * xyz;
  c_[2] = s.x * s.y * xy + s.y * s.z * yz + s.z * s.x * zx +
          (s.x * s.y * f.z + s.x * f.y * s.z + f.x * s.y * s.z) * xyz;
  c_[3] = s.x * s.y * s.z * xyz;
  cubic_ = true;
}

glm::dvec3 Gradient::Along::operator()(double u) const {
  if (cubic_) return ((c_[3] * u + c_[2]) * u + c_[1]) * u + c_[0];
  return gradient_.at(from_vox_ + u * across_vox_);
}

std::vector<double> Gradient::Along::turns(glm::dvec3 direction) const {
  if (!cubic_) return {};
  Poly p;
  p.degree = 3;
  for (std::size_t n = 0; n < 4; ++n) p.c[n] = glm::dot(c_[n], direction);
  return rootsInside(p);
}

}  // namespace vernier::quality
