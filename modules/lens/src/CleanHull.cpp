// SPDX-License-Identifier: GPL-3.0-or-later
#include "CleanHull.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ExactHull.h"

namespace vernier::lens {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;

struct Facets {
  std::vector<std::uint32_t> of;  // of each triangle
  std::vector<glm::dvec3> normals;
};

// The triangle on the other side of each edge (corner k to k + 1) of each triangle.
std::vector<std::array<std::uint32_t, 3>> neighbours(const TriangleHull& h) {
  struct Edge {
    std::uint64_t key;
    std::uint32_t triangle, side;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * h.triangles.size());
  for (std::uint32_t t = 0; t < h.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(h.triangles[t][k], h.triangles[t][(k + 1) % 3]);
      edges.push_back({std::uint64_t{low} << 32 | high, t, k});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.key < b.key; });
  std::vector<std::array<std::uint32_t, 3>> out(h.triangles.size(), {kNone, kNone, kNone});
  for (std::size_t n = 0; n + 1 < edges.size(); n += 2) {
    const Edge &a = edges[n], &b = edges[n + 1];
    if (a.key != b.key) break;  // not closed: the caller sees kNone
    out[a.triangle][a.side] = b.triangle, out[b.triangle][b.side] = a.triangle;
  }
  return out;
}

// From the largest triangle on, each plane takes in what hangs together with it and lies in it. The planes
// are those of large triangles, so they are well determined and no corner stands outside them.
Facets facetsOf(const TriangleHull& h, const std::vector<std::array<std::uint32_t, 3>>& next, double flat) {
  const std::size_t count = h.triangles.size();
  std::vector<double> area(count);
  for (std::size_t t = 0; t < count; ++t) {
    const auto& [a, b, c] = h.triangles[t];
    area[t] = glm::length(glm::cross(h.corners[b] - h.corners[a], h.corners[c] - h.corners[a]));
  }
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return area[a] != area[b] ? area[a] > area[b] : a < b; });
  Facets f;
  f.of.assign(count, kNone);
  std::vector<std::uint32_t> open;
  for (const std::uint32_t seed : order) {
    if (f.of[seed] != kNone) continue;
    const auto& [a, b, c] = h.triangles[seed];
    const glm::dvec3 normal = exactNormal(h.corners[a], h.corners[b], h.corners[c]);
    const auto plane = static_cast<std::uint32_t>(f.normals.size());
    f.normals.push_back(normal);
    f.of[seed] = plane;
    open.assign(1, seed);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (const std::uint32_t other : next[t]) {
        if (f.of[other] != kNone) continue;
        const bool within = std::all_of(
            h.triangles[other].begin(), h.triangles[other].end(),
            [&](std::uint32_t v) { return std::abs(glm::dot(normal, h.corners[v] - h.corners[a])) <= flat; });
        if (within) f.of[other] = plane, open.push_back(other);
      }
    }
  }
  return f;
}

// For each corner the number of facets around it, counted to 3.
std::vector<std::array<std::uint32_t, 3>> facetsAround(const TriangleHull& h, const Facets& f) {
  std::vector<std::array<std::uint32_t, 3>> out(h.corners.size(), {kNone, kNone, kNone});
  for (std::size_t t = 0; t < h.triangles.size(); ++t)
    for (const std::uint32_t v : h.triangles[t])
      for (std::uint32_t& place : out[v]) {
        if (place == f.of[t]) break;
        if (place == kNone) {
          place = f.of[t];
          break;
        }
      }
  return out;
}

// Corners with one facet around them lie within it.
std::vector<bool> withinFaces(const std::vector<std::array<std::uint32_t, 3>>& around) {
  std::vector<bool> drop(around.size());
  for (std::size_t v = 0; v < around.size(); ++v) drop[v] = around[v][1] == kNone;
  return drop;
}

// Corners on a straight edge between two facets, and those of thin triangles that lie beside the longest
// side. What a corner leans on stays, so that the surface moves by no more than its distance to that.
std::vector<bool> besideEdges(const TriangleHull& h, const Facets& f,
                              const std::vector<std::array<std::uint32_t, 3>>& next,
                              const std::vector<std::array<std::uint32_t, 3>>& around,
                              const HullScale& scale) {
  std::vector<bool> drop(h.corners.size()), locked(h.corners.size());
  const auto take = [&](std::uint32_t v, std::uint32_t a, std::uint32_t b) {
    if (locked[v] || drop[v] || drop[a] || drop[b]) return;
    drop[v] = true;
    locked[a] = locked[b] = true;
  };
  // The ends of the two borders between facets that meet at a corner.
  std::vector<std::array<std::uint32_t, 2>> ends(h.corners.size(), {kNone, kNone});
  for (std::size_t t = 0; t < h.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (f.of[next[t][k]] == f.of[t]) continue;
      // Each border is met from both sides; here it counts at its beginning.
      auto& e = ends[h.triangles[t][k]];
      (e[0] == kNone ? e[0] : e[1]) = h.triangles[t][(k + 1) % 3];
    }
  for (std::uint32_t v = 0; v < h.corners.size(); ++v) {
    const auto [a, b] = ends[v];
    if (around[v][1] == kNone || around[v][2] != kNone || a == kNone || b == kNone) continue;
    const glm::dvec3 along = glm::normalize(h.corners[b] - h.corners[a]);
    if (glm::length(glm::cross(h.corners[v] - h.corners[a], along)) <= scale.flat) take(v, a, b);
  }
  for (const auto& t : h.triangles) {
    std::size_t longest = 0;
    double most = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double d = glm::distance(h.corners[t[k]], h.corners[t[(k + 1) % 3]]); d > most)
        most = d, longest = k;
    const glm::dvec3 &a = h.corners[t[longest]], &b = h.corners[t[(longest + 1) % 3]];
    const std::uint32_t v = t[(longest + 2) % 3];
    if (glm::length(glm::cross(b - a, h.corners[v] - a)) <= scale.thin * most)
      take(v, t[longest], t[(longest + 1) % 3]);
  }
  return drop;
}

Error flatFault() {
  return shapeFault(
      "A lens needs a volume, and its hull is thinner than a millionth of its length; give points "
      "that enclose more.");
}

}  // namespace

Result<Solid> cleanHull(std::vector<glm::dvec3> points, const HullScale& scale) {
  for (;;) {
    Result<TriangleHull> h = exactHull(points);
    if (!h) return h.error();
    if (h->triangles.empty()) return flatFault();
    const auto next = neighbours(*h);
    for (const auto& n : next)
      if (n[0] == kNone || n[1] == kNone || n[2] == kNone)
        return makeError(ErrorCode::Internal, "The hull of the lens came out open.", "lens hull");
    Facets f = facetsOf(*h, next, scale.flat);
    if (f.normals.size() < 4) return flatFault();
    const auto around = facetsAround(*h, f);
    std::vector<bool> drop = withinFaces(around);
    if (std::find(drop.begin(), drop.end(), true) == drop.end())
      drop = besideEdges(*h, f, next, around, scale);
    points.clear();
    for (std::size_t v = 0; v < h->corners.size(); ++v)
      if (!drop[v]) points.push_back(h->corners[v]);
    if (points.size() < 4) return flatFault();
    if (points.size() < h->corners.size()) continue;
    Solid s;
    s.corners = std::move(h->corners), s.triangles = std::move(h->triangles);
    s.planeOf = std::move(f.of), s.normals = std::move(f.normals);
    return s;
  }
}

}  // namespace vernier::lens
