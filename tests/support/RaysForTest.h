// SPDX-License-Identifier: GPL-3.0-or-later
// Rays of a picture cut at a convex region, by half-spaces in double, and joined again by the rules of
// plan/RayIntervals.h: for tests of techniques that draw parts of rays. Without tools.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>

#include "vernier/plan/Volumetric.h"

namespace vernier::test {

// A box around `centre`, its half edges along axes that are turned away from the volume's.
inline std::vector<HalfSpace> turnedBox(PatientPoint centre, glm::dvec3 half_mm) {
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.8, 0.5, -0.3));
  const glm::dvec3 y = glm::normalize(glm::cross(glm::dvec3(0.1, -0.2, 0.9), x)), z = glm::cross(x, y);
  std::vector<HalfSpace> out;
  const glm::dvec3 axes[] = {x, y, z};
  for (int n = 0; n < 3; ++n)
    for (const double sign : {1.0, -1.0}) {
      const glm::dvec3 normal = sign * axes[n];
      out.push_back({PatientVec(normal), glm::dot(normal, centre.p) + half_mm[n]});
    }
  return out;
}

// Outside appearance 0, inside 1. Parts without length are left out.
inline std::shared_ptr<RayIntervals> cutRays(const CameraPicture& camera,
                                             const std::vector<HalfSpace>& region,
                                             const std::vector<HalfSpace>& lens) {
  auto rays = std::make_shared<RayIntervals>();
  rays->width = camera.width_px, rays->height = camera.height_px;
  rays->first.push_back(0);
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      const PatientRay ray = camera.ray(x + 0.5, y + 0.5);
      const double near_mm = camera.near_mm * camera.rayPerDepth(x + 0.5, y + 0.5);
      const RaySpan whole = spanOf(ray, region, near_mm);
      RaySpan inside = spanOf(ray, lens, near_mm);
      inside.entry_mm = std::max(inside.entry_mm, whole.entry_mm);
      inside.exit_mm = std::min(inside.exit_mm, whole.exit_mm);
      if (!whole.empty() && inside.exit_mm > inside.entry_mm) {
        const auto add = [&](double from, double to, std::int16_t appearance) {
          if (!(to > from)) return;
          RaySegment s;
          s.from_mm = static_cast<float>(from), s.to_mm = static_cast<float>(to);
          s.appearance = appearance;
          s.beginsInside = from != whole.entry_mm, s.endsInside = to != whole.exit_mm;
          rays->segments.push_back(s);
        };
        add(whole.entry_mm, inside.entry_mm, 0);
        add(inside.entry_mm, inside.exit_mm, 1);
        add(inside.exit_mm, whole.exit_mm, 0);
      }
      rays->first.push_back(static_cast<std::uint32_t>(rays->segments.size()));
    }
  return rays;
}

// What all that has been gathered on a pixel comes to, by one accumulator; the background where nothing has.
inline glm::dvec3 joined(const RayIntervals& rays, std::size_t pixel, Accumulator how,
                         const glm::dvec3& background) {
  glm::dvec3 sum(0), most(0), least(1e30), product(1);
  bool any = false;
  for (const RaySegment& s : rays.of(pixel)) {
    if (!s.covered) continue;
    const glm::dvec3 c(s.colour[0], s.colour[1], s.colour[2]);
    sum += c, product *= c, most = glm::max(most, c), least = glm::min(least, c);
    any = true;
  }
  if (how == Accumulator::Attenuation) return product;
  if (how == Accumulator::Sum) return sum + background;
  return !any ? background : how == Accumulator::Min ? least : most;
}

// Ordered parts, front to back, over the background.
inline glm::dvec3 joinedInOrder(const RayIntervals& rays, std::size_t pixel, const glm::dvec3& background) {
  glm::dvec3 sum(0);
  double through = 1;
  for (const RaySegment& s : rays.of(pixel)) {
    sum += through * glm::dvec3(s.colour[0], s.colour[1], s.colour[2]);
    through *= static_cast<double>(s.through);
  }
  return sum + through * background;
}

}  // namespace vernier::test
