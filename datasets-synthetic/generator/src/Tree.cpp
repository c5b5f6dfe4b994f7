// SPDX-License-Identifier: GPL-3.0-or-later
// Vessel trees: each branch walks in short tapered capsules, wanders a little, then splits in two thinner
// ones (radii by Murray's law: r^3 = r1^3 + r2^3). Choices come from the integer hash, in a fixed order.
#include <algorithm>
#include <cmath>

#include "Field.h"
#include "vernier/base/Random.h"

namespace vernier::phantoms {
namespace {

struct Grower {
  std::uint64_t seed = 0, draws = 0;
  glm::dvec3 centre_mm{0}, half_mm{1};
  double smallest_mm = 0.4, wander = 0.3;
  double value = 600, perRadius = 100;
  std::size_t most = 4000;
  std::vector<Solid> out;

  double draw(double low, double high) { return low + (high - low) * randomUnit(seed, draws++); }
  glm::dvec3 drawVec(double size) {
    const double x = draw(-size, size), y = draw(-size, size), z = draw(-size, size);
    return {x, y, z};
  }
  // 1 on the envelope's surface.
  double level(glm::dvec3 p) const {
    const glm::dvec3 q = (p - centre_mm) / half_mm;
    return glm::dot(q, q);
  }
  static glm::dvec3 unit(glm::dvec3 v) { return v / std::sqrt(glm::dot(v, v)); }

  void capsule(glm::dvec3 a, glm::dvec3 b, double ra, double rb) {
    Solid s;
    s.shape = Shape::Capsule;
    s.centre_mm = 0.5 * (a + b);
    const glm::dvec3 z = unit(b - a);
    const glm::dvec3 any = std::fabs(z.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = unit(glm::cross(any, z)), y = glm::cross(z, x);
    s.patientFromLocal = glm::dmat3(x, y, z);
    s.size_mm = {ra, rb, 0.5 * std::sqrt(glm::dot(b - a, b - a))};
    s.value = value + perRadius * ra;
    s.maximum = true;
    out.push_back(s);
  }

  void branch(glm::dvec3 p, glm::dvec3 direction, double radius_mm, int depth) {
    if (depth == 0 || radius_mm < smallest_mm || out.size() >= most) return;
    const int steps = 3 + static_cast<int>(draw(0.0, 4.0));
    for (int n = 0; n < steps; ++n) {
      direction = unit(direction + drawVec(wander));
      const double stride = draw(2.5, 4.5);
      // Near the envelope a branch bends back inside.
      if (level(p + stride * direction) > 0.92) direction = unit(direction + 1.2 * unit(centre_mm - p));
      const glm::dvec3 q = p + stride * direction;
      if (level(q) > 1.0) return;
      capsule(p, q, radius_mm, radius_mm * 0.985);
      p = q;
      radius_mm *= 0.985;
    }
    const double share = draw(0.3, 0.7);
    const auto cubeRoot = [](double x) {  // Newton's iteration: the same everywhere
      double r = 0.8;
      for (int n = 0; n < 12; ++n) r -= (r * r * r - x) / (3.0 * r * r);
      return r;
    };
    const glm::dvec3 side = drawVec(1.0);
    branch(p, unit(direction + 0.8 * side), radius_mm * cubeRoot(share), depth - 1);
    branch(p, unit(direction - 0.8 * side), radius_mm * cubeRoot(1.0 - share), depth - 1);
  }
};

}  // namespace

std::vector<Solid> growTree(const Json& tree, std::uint64_t seed) {
  Grower g;
  g.seed = randomBits(seed, 77);
  g.centre_mm = vecOf(tree.at("envelope").at("centre_mm"));
  g.half_mm = vecOf(tree.at("envelope").at("size_mm"));
  g.smallest_mm = tree.at("smallest_radius_mm");
  g.wander = tree.at("wander");
  g.value = tree.at("value");
  g.perRadius = tree.at("value_per_mm");
  for (const Json& root : tree.at("roots")) {
    glm::dvec3 p = vecOf(root.at("from_mm"));
    const double r = root.at("radius_mm");
    for (const Json& via : root.value("via_mm", Json::array())) {  // a trunk along stated points
      g.capsule(p, vecOf(via), r, r);
      p = vecOf(via);
    }
    g.branch(p, Grower::unit(vecOf(root.at("direction"))), r * root.value("taper", 1.0), root.at("depth"));
  }
  return std::move(g.out);
}

}  // namespace vernier::phantoms
