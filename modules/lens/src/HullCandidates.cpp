// SPDX-License-Identifier: GPL-3.0-or-later
// Large sets of points before the exact hull: most of them lie well inside, or, of grids, in the faces, where
// exact predicates are at their slowest.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ExactHull.h"
#include "HullSolid.h"

namespace vernier::lens {
namespace {

constexpr std::size_t kMostFaces = 512;  // beyond, a look at all faces for each point does not pay
constexpr int kRounds = 5;
constexpr double kWorthIt = 0.1;  // a round that takes less of the points away is the last

// The faces of a rough hull: structure of arrays for the one loop that costs.
struct Faces {
  std::vector<double> x, y, z, offset;
  std::vector<std::array<glm::dvec3, 3>> corners;
  std::size_t size() const { return x.size(); }
};

Faces facesOf(const TriangleHull& h, const glm::dvec3& middle) {
  Faces f;
  for (const auto& [a, b, c] : h.triangles) {
    const glm::dvec3 n = exactNormal(h.corners[a], h.corners[b], h.corners[c]);
    f.x.push_back(n.x), f.y.push_back(n.y), f.z.push_back(n.z);
    f.offset.push_back(glm::dot(n, h.corners[a] - middle));
    f.corners.push_back({h.corners[a] - middle, h.corners[b] - middle, h.corners[c] - middle});
  }
  return f;
}

struct Outermost {
  double distance;
  std::size_t face;
};

Outermost outermost(const Faces& f, const glm::dvec3& p) {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < f.size(); ++n)
    most = std::max(most, f.x[n] * p.x + f.y[n] * p.y + f.z[n] * p.z - f.offset[n]);
  std::size_t face = 0;
  while (face + 1 < f.size() && f.x[face] * p.x + f.y[face] * p.y + f.z[face] * p.z - f.offset[face] != most)
    ++face;
  return {most, face};
}

// Whether a point that no face has outside by more than `flat` lies on one of the triangles, to `flat`.
bool onSurface(const Faces& f, const glm::dvec3& p, double flat) {
  for (std::size_t n = 0; n < f.size(); ++n) {
    const glm::dvec3 normal(f.x[n], f.y[n], f.z[n]);
    if (std::abs(glm::dot(normal, p) - f.offset[n]) > flat) continue;
    bool within = true;
    for (std::size_t k = 0; k < 3 && within; ++k) {
      const glm::dvec3 edge = f.corners[n][(k + 1) % 3] - f.corners[n][k];
      within = glm::dot(glm::cross(edge, normal), p - f.corners[n][k]) <= flat * glm::length(edge);
    }
    if (within) return true;
  }
  return false;
}

// The first corner of the hull in 26 directions: those of a cube's faces, edges and corners.
void addSupports(std::span<const glm::dvec3> points, std::vector<std::size_t>& out) {
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        if (!i && !j && !k) continue;
        std::size_t best = 0;
        double most = -std::numeric_limits<double>::infinity();
        for (std::size_t n = 0; n < points.size(); ++n)
          if (const double d = i * points[n].x + j * points[n].y + k * points[n].z; d > most)
            most = d, best = n;
        out.push_back(best);
      }
}

}  // namespace

Result<std::vector<glm::dvec3>> hullCandidates(std::span<const glm::dvec3> points, const HullScale& scale,
                                               const std::array<std::size_t, 4>& seeds) {
  std::vector<std::size_t> chosen(seeds.begin(), seeds.end());
  addSupports(points, chosen);
  std::vector<glm::dvec3> rough;
  for (const std::size_t n : chosen) rough.push_back(points[n]);
  std::vector<glm::dvec3> rest(points.begin(), points.end());
  for (int round = 0; round < kRounds && !rest.empty(); ++round) {
    const Result<TriangleHull> h = exactHull(rough);
    if (!h) return h.error();
    if (h->triangles.empty() || h->triangles.size() > kMostFaces) break;
    const Faces f = facesOf(*h, scale.middle);
    std::vector<std::pair<double, glm::dvec3>> far(f.size(), {0, glm::dvec3(0)});
    std::vector<glm::dvec3> kept;
    for (const glm::dvec3& p : rest) {
      const Outermost o = outermost(f, p - scale.middle);
      if (o.distance <= -scale.flat) continue;
      if (o.distance <= scale.flat && onSurface(f, p - scale.middle, scale.flat)) continue;
      kept.push_back(p);
      if (o.distance > far[o.face].first) far[o.face] = {o.distance, p};
    }
    const double taken = 1 - static_cast<double>(kept.size()) / static_cast<double>(rest.size());
    rest = std::move(kept);
    if (taken < kWorthIt) break;
    rough = h->corners;
    for (const auto& [distance, p] : far)
      if (distance > 0) rough.push_back(p);
  }
  rough.insert(rough.end(), rest.begin(), rest.end());
  return rough;
}

}  // namespace vernier::lens
