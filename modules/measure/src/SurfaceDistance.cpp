// SPDX-License-Identifier: GPL-3.0-or-later
// Closest point of a triangle and of two segments: C. Ericson, Real-Time Collision Detection (2005), 5.1.5
// and 5.1.9.
#include "SurfaceDistance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::measure {
namespace {

constexpr std::uint32_t kLeaf = 8;
using Corners = std::array<glm::dvec3, 3>;

glm::dvec3 onTriangle(glm::dvec3 p, const Corners& t) {
  const glm::dvec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const glm::dvec3 bp = p - t[1];
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t[0] + d1 / (d1 - d3) * ab;
  const glm::dvec3 cp = p - t[2];
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t[0] + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const double whole = 1 / (va + vb + vc);
  return t[0] + vb * whole * ab + vc * whole * ac;
}

void keep(Nearest& best, glm::dvec3 a, glm::dvec3 b) {
  const double d = glm::length(b - a);
  if (d < best.distance_mm) best = {d, a, b};
}

void segments(Nearest& best, glm::dvec3 p, glm::dvec3 p2, glm::dvec3 q, glm::dvec3 q2) {
  const glm::dvec3 u = p2 - p, v = q2 - q, r = p - q;
  const double a = glm::dot(u, u), e = glm::dot(v, v), f = glm::dot(v, r), c = glm::dot(u, r),
               b = glm::dot(u, v);
  const double det = a * e - b * b;
  double s = det > 0 ? std::clamp((b * f - c * e) / det, 0.0, 1.0) : 0;
  double t = (b * s + f) / e;
  if (t < 0) t = 0, s = std::clamp(-c / a, 0.0, 1.0);
  if (t > 1) t = 1, s = std::clamp((b - c) / a, 0.0, 1.0);
  keep(best, p + s * u, q + t * v);
}

// Where a segment passes through a triangle.
void through(Nearest& best, glm::dvec3 p, glm::dvec3 q, const Corners& t) {
  const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double a = glm::dot(n, p - t[0]), b = glm::dot(n, q - t[0]);
  if ((a > 0) == (b > 0) || a == b) return;
  const glm::dvec3 x = p + a / (a - b) * (q - p);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 from = t[static_cast<std::size_t>(i)], to = t[static_cast<std::size_t>((i + 1) % 3)];
    if (glm::dot(glm::cross(to - from, x - from), n) < 0) return;
  }
  best = {0, x, x};
}

void triangles(Nearest& best, const Corners& s, const Corners& t) {
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 s0 = s[static_cast<std::size_t>(i)], s1 = s[static_cast<std::size_t>((i + 1) % 3)];
    keep(best, s0, onTriangle(s0, t));
    through(best, s0, s1, t);
    for (int j = 0; j < 3; ++j) {
      const glm::dvec3 t0 = t[static_cast<std::size_t>(j)], t1 = t[static_cast<std::size_t>((j + 1) % 3)];
      if (i == 0) {
        keep(best, onTriangle(t0, s), t0);
        through(best, t0, t1, s);
      }
      segments(best, s0, s1, t0, t1);
    }
  }
}

}  // namespace

SurfaceTree::SurfaceTree(const Mesh& mesh, const PatientFromMesh& pose) {
  triangles_.reserve(mesh.triangles().size());
  for (const Triangle& t : mesh.triangles())
    triangles_.push_back({(pose * mesh.vertices()[t[0]]).p, (pose * mesh.vertices()[t[1]]).p,
                          (pose * mesh.vertices()[t[2]]).p});
  build(0, static_cast<std::uint32_t>(triangles_.size()));
}

SurfaceTree::Box SurfaceTree::boxOf(std::uint32_t first, std::uint32_t count) const {
  Box b{triangles_[first][0], triangles_[first][0]};
  for (std::uint32_t n = first; n < first + count; ++n)
    for (const glm::dvec3& p : triangles_[n]) b.low = glm::min(b.low, p), b.high = glm::max(b.high, p);
  return b;
}

std::uint32_t SurfaceTree::build(std::uint32_t first, std::uint32_t count) {
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({boxOf(first, count), first, count, 0, 0});
  if (count <= kLeaf) return at;
  const glm::dvec3 size = nodes_[at].box.high - nodes_[at].box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto begin = triangles_.begin() + first, middle = begin + count / 2;
  std::nth_element(begin, middle, begin + count, [&](const Corners& a, const Corners& b) {
    return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
  });
  const std::uint32_t left = build(first, count / 2), right = build(first + count / 2, count - count / 2);
  nodes_[at].count = 0;
  nodes_[at].left = left;
  nodes_[at].right = right;
  return at;
}

double SurfaceTree::apart(const Box& a, const Box& b) {
  const glm::dvec3 d = glm::max(glm::max(a.low - b.high, b.low - a.high), glm::dvec3(0));
  return glm::dot(d, d);
}

Nearest SurfaceTree::nearest(glm::dvec3 p) const {
  Nearest best{std::numeric_limits<double>::infinity(), p, p};
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Node& n = nodes_[open.back()];
    open.pop_back();
    if (apart(n.box, {p, p}) > best.distance_mm * best.distance_mm) continue;
    for (std::uint32_t t = n.first; t < n.first + n.count; ++t) keep(best, p, onTriangle(p, triangles_[t]));
    if (n.count > 0) continue;
    const bool leftFirst = apart(nodes_[n.left].box, {p, p}) <= apart(nodes_[n.right].box, {p, p});
    open.push_back(leftFirst ? n.right : n.left);
    open.push_back(leftFirst ? n.left : n.right);
  }
  return best;
}

Nearest SurfaceTree::nearest(const SurfaceTree& other, std::stop_token stop) const {
  Nearest best{std::numeric_limits<double>::infinity(), {}, {}};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, 0}};
  while (!open.empty() && best.distance_mm > 0 && !stop.stop_requested()) {
    const auto [i, j] = open.back();
    open.pop_back();
    const Node &a = nodes_[i], &b = other.nodes_[j];
    if (apart(a.box, b.box) >= best.distance_mm * best.distance_mm) continue;
    if (a.count > 0 && b.count > 0) {
      for (std::uint32_t s = a.first; s < a.first + a.count; ++s)
        for (std::uint32_t t = b.first; t < b.first + b.count; ++t)
          triangles(best, triangles_[s], other.triangles_[t]);
      continue;
    }
    const auto size = [](const Node& n) { return glm::dot(n.box.high - n.box.low, n.box.high - n.box.low); };
    std::array<std::pair<std::uint32_t, std::uint32_t>, 2> next;
    if (b.count > 0 || (a.count == 0 && size(a) >= size(b)))
      next = {{{a.left, j}, {a.right, j}}};
    else
      next = {{{i, b.left}, {i, b.right}}};
    const auto gap = [&](const auto& p) { return apart(nodes_[p.first].box, other.nodes_[p.second].box); };
    if (gap(next[0]) <= gap(next[1])) std::swap(next[0], next[1]);
    open.push_back(next[0]);
    open.push_back(next[1]);
  }
  return best;
}

}  // namespace vernier::measure
