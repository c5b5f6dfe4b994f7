// SPDX-License-Identifier: GPL-3.0-or-later
// Material and lights of Scene.h, one point at a time in double.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "vernier/plan/Scene.h"
#include "vernier/volume/Volume.h"

namespace vernier::native {

inline glm::dvec3 colourOf(const Rgb& c) { return {c.r, c.g, c.b}; }

struct Lighting {
  struct Lamp {
    std::optional<glm::dvec3> towards;  // unit; absent: the eye
    glm::dvec3 colour{1};
  };
  Material material;
  std::vector<Lamp> lamps;

  Lighting(const Material& m, const std::vector<Light>& lights) : material(m) {
    if (lights.empty()) lamps.push_back({});
    for (const Light& l : lights)
      lamps.push_back(
          {l.towards ? std::optional(glm::normalize(l.towards->v)) : std::nullopt, colourOf(l.colour)});
  }

  // `ambient`, `diffuse`: the point's own colour in both parts. `toEye`: unit.
  glm::dvec3 lit(const glm::dvec3& ambient, const glm::dvec3& diffuse, glm::dvec3 gradient,
                 const glm::dvec3& toEye) const {
    glm::dvec3 sum = material.ambient * ambient;
    const double size = glm::length(gradient);
    if (size > 0) {
      const glm::dvec3 n = gradient * ((glm::dot(gradient, toEye) < 0 ? -1 : 1) / size);
      for (const Lamp& lamp : lamps) {
        const glm::dvec3 l = lamp.towards.value_or(toEye), between = l + toEye;
        const double width = glm::length(between);
        const double nl = std::max(0.0, glm::dot(n, l));
        const double nh = width > 0 ? std::max(0.0, glm::dot(n, between) / width) : 0;
        sum += lamp.colour *
               (material.diffuse * nl * diffuse + material.specular * std::pow(nh, material.power));
      }
    }
    return glm::clamp(sum, 0.0, 1.0);
  }
};

// Gradients per voxel to gradients per mm in the patient.
inline glm::dmat3 patientGradients(const Volume& v) { return glm::transpose(v.voxelFromPatient().linear); }

// The gradient that shading means, per voxel. `field(p)`: NaN where there is no data; `centre`: its value at
// p.
template <class Field>
glm::dvec3 gradientAt(const Field& field, const glm::dvec3& p, double centre, const glm::dvec3& last) {
  glm::dvec3 g(0);
  for (int a = 0; a < 3; ++a) {
    double side[2];
    for (int s = 0; s < 2; ++s) {
      glm::dvec3 q = p;
      q[a] = std::clamp(p[a] + (s ? 1 : -1), 0.0, last[a]);
      const double value = field(q);
      side[s] = std::isnan(value) ? centre : value;
    }
    g[a] = 0.5 * (side[1] - side[0]);
  }
  return g;
}

}  // namespace vernier::native
