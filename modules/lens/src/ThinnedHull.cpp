// SPDX-License-Identifier: GPL-3.0-or-later
// Fewer points for a hull that would have too many faces, and what that costs, measured.
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "HullSolid.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

// The six extreme points along the axes always stay.
void addExtremes(std::span<const glm::dvec3> points, std::vector<glm::dvec3>& out) {
  for (int a = 0; a < 3; ++a) {
    const auto less = [a](const glm::dvec3& p, const glm::dvec3& q) { return p[a] < q[a]; };
    const auto [low, high] = std::minmax_element(points.begin(), points.end(), less);
    out.push_back(*low), out.push_back(*high);
  }
}

// Directions from the middle, sorted into the cells of a cube's faces: which triangles a line may leave by.
class Directions {
 public:
  Directions(const Solid& s, const glm::dvec3& middle, int cells)
      : cells_(cells), triangles_(6 * cells * cells) {
    for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
      std::array<glm::dvec3, 3> c;
      for (std::size_t k = 0; k < 3; ++k) c[k] = s.corners[s.triangles[t][k]] - middle;
      for (int side = 0; side < 6; ++side) add(t, c, side);
    }
  }
  const std::vector<std::uint32_t>& near(const glm::dvec3& d) const {
    int axis = 0;
    for (int a = 1; a < 3; ++a)
      if (std::abs(d[a]) > std::abs(d[axis])) axis = a;
    const double w = std::abs(d[axis]);
    const int side = 2 * axis + (d[axis] < 0);
    return triangles_[index(side, cell(d[(axis + 1) % 3] / w), cell(d[(axis + 2) % 3] / w))];
  }

 private:
  int cell(double v) const { return std::clamp(static_cast<int>((v + 1) * 0.5 * cells_), 0, cells_ - 1); }
  std::size_t index(int side, int u, int v) const {
    return (static_cast<std::size_t>(side) * cells_ + u) * cells_ + v;
  }
  // To each cell that the box around the triangle's picture on this side of the cube meets. A triangle that
  // goes behind the side's plane is cut away there first.
  void add(std::uint32_t t, const std::array<glm::dvec3, 3>& c, int side) {
    const int axis = side / 2;
    const double sign = side % 2 ? -1 : 1;
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    const auto see = [&](const glm::dvec3& p) {
      const double w = sign * p[axis];
      for (int k = 0; k < 2; ++k) {
        const double v = p[(axis + 1 + k) % 3] / w;
        low[k] = std::min(low[k], v), high[k] = std::max(high[k], v);
      }
    };
    double farthest = 0;
    for (const glm::dvec3& p : c) farthest = std::max(farthest, glm::length(p));
    const double least = 1e-3 * farthest;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 &p = c[k], &q = c[(k + 1) % 3];
      const double wp = sign * p[axis] - least, wq = sign * q[axis] - least;
      if (wp >= 0) see(p);
      if ((wp < 0) != (wq < 0)) see(p + (q - p) * (wp / (wp - wq)));
    }
    if (low[0] > 1 || low[1] > 1 || high[0] < -1 || high[1] < -1) return;
    for (int u = cell(std::max(low[0], -1.0)); u <= cell(std::min(high[0], 1.0)); ++u)
      for (int v = cell(std::max(low[1], -1.0)); v <= cell(std::min(high[1], 1.0)); ++v)
        triangles_[index(side, u, v)].push_back(t);
  }

  int cells_;
  std::vector<std::vector<std::uint32_t>> triangles_;
};

}  // namespace

std::vector<glm::dvec3> thinned(std::span<const glm::dvec3> points, const HullScale& scale) {
  glm::dvec3 size(0);
  for (const glm::dvec3& p : points) size = glm::max(size, glm::abs(p - scale.middle));
  // A surface meets about five cells per square of the grid's width; fewer when that is too many.
  for (double width = std::sqrt(kMostHullPoints / 5.0);; width *= 0.9) {
    std::unordered_map<std::uint64_t, std::pair<double, glm::dvec3>> cells;
    for (const glm::dvec3& p : points) {
      const glm::dvec3 share = (p - scale.middle) / size;  // -1..1
      std::uint64_t key = 0;
      for (int a = 0; a < 3; ++a) key = key << 16 | static_cast<std::uint64_t>((share[a] + 1) * 0.5 * width);
      const double out = glm::dot(share, share);
      const auto [at, made] = cells.try_emplace(key, out, p);
      if (!made && out > at->second.first) at->second = {out, p};
    }
    if (cells.size() + 6 > kMostHullPoints) continue;
    std::vector<glm::dvec3> out;
    addExtremes(points, out);
    for (const auto& [key, kept] : cells) out.push_back(kept.second);
    return out;
  }
}

double farthestOutside_mm(const Solid& s, const glm::dvec3& middle, std::span<const glm::dvec3> points) {
  const Directions directions(s, middle, 64);
  double most = 0;
  for (const glm::dvec3& p : points) {
    const glm::dvec3 d = p - middle;
    // The line from the middle leaves the solid where the first of its faces is met.
    double leaves = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : directions.near(d)) {
      const glm::dvec3& n = s.normals[s.planeOf[t]];
      const double along = glm::dot(n, d);
      if (along > 0) leaves = std::min(leaves, glm::dot(n, s.corners[s.triangles[t][0]] - middle) / along);
    }
    if (leaves < 1) most = std::max(most, (1 - leaves) * glm::length(d));
  }
  return most;
}

}  // namespace vernier::lens
