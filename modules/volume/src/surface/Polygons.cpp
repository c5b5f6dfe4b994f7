// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "Readers.h"
#include "vernier/study/Limits.h"

namespace vernier::surface {
namespace {

double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Newell's normal: right for any simple polygon, also one that is not quite flat.
glm::dvec3 newell(std::span<const std::uint32_t> corners, const std::vector<glm::dvec3>& points) {
  const glm::dvec3 o = points[corners[0]];
  glm::dvec3 n(0);
  for (std::size_t i = 0; i < corners.size(); ++i)
    n += glm::cross(points[corners[i]] - o, points[corners[(i + 1) % corners.size()]] - o);
  return n;
}

// The polygon seen along its normal, counter-clockwise.
std::vector<glm::dvec2> flattened(std::span<const std::uint32_t> corners,
                                  const std::vector<glm::dvec3>& points, glm::dvec3 n) {
  const glm::dvec3 size = glm::abs(n);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int u = (drop + 1) % 3, v = (drop + 2) % 3;
  const double side = n[drop] < 0 ? -1 : 1;
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  for (const std::uint32_t c : corners) flat.emplace_back(side * points[c][u], points[c][v]);
  return flat;
}

bool convex(std::span<const glm::dvec2> flat) {
  const std::size_t n = flat.size();
  for (std::size_t i = 0; i < n; ++i)
    if (turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) < 0) return false;
  return true;
}

}  // namespace

void Polygons::reserve(std::uint64_t triangles) {
  builder_.reserve(static_cast<std::size_t>(std::min(triangles, limits::kMaxTriangles)));
}

Result<void> Polygons::mayGoOn(std::size_t more) {
  const std::uint64_t n = builder_.given();
  if (n + more > limits::kMaxTriangles)
    return makeError(ErrorCode::LimitExceeded, "The surface has more than " +
                                                   std::to_string(limits::kMaxTriangles) +
                                                   " triangles; make it coarser first.");
  if ((n & 0xFFF) == 0 && stop_.stop_requested())
    return makeError(ErrorCode::Cancelled, "Reading the surface was cancelled.");
  return {};
}

Result<void> Polygons::triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  if (Result<void> ok = mayGoOn(1); !ok) return ok;
  const std::uint32_t va = builder_.vertex(a), vb = builder_.vertex(b);
  builder_.triangle(va, vb, builder_.vertex(c));
  return {};
}

Result<void> Polygons::polygon(std::span<const std::uint32_t> corners) {
  for (const std::uint32_t c : corners)
    if (c >= points_.size())
      return makeError(ErrorCode::FileDamaged, "A polygon names point " + std::to_string(c) +
                                                   ", but there are " + std::to_string(points_.size()) +
                                                   " points (counted from 0).");
  if (corners.size() < 3) return {};
  if (Result<void> ok = mayGoOn(corners.size() - 2); !ok) return ok;
  if (corners.size() > 3) {
    const glm::dvec3 n = newell(corners, points_);
    const std::vector<glm::dvec2> flat = flattened(corners, points_, n);
    if (glm::dot(n, n) > 0 && std::isfinite(n.x + n.y + n.z) && !convex(flat)) {
      if (corners.size() > limits::kMaxConcaveCorners)
        return makeError(ErrorCode::LimitExceeded, "A polygon that is not convex has " +
                                                       std::to_string(corners.size()) + " corners, at most " +
                                                       std::to_string(limits::kMaxConcaveCorners) +
                                                       " are taken; save the surface as triangles.");
      cutEars(corners, flat);
      return {};
    }
  }
  for (std::size_t i = 2; i < corners.size(); ++i) add(corners[0], corners[i - 1], corners[i]);
  return {};
}

// A corner is an ear when it turns left and no other corner lies in its triangle. A polygon that crosses
// itself may run out of ears: what is left is cut as a fan, so that nothing is lost and nothing loops.
void Polygons::cutEars(std::span<const std::uint32_t> corners, std::span<const glm::dvec2> flat) {
  std::vector<std::size_t> left(corners.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  const auto isEar = [&](std::size_t i) {
    const std::size_t n = left.size(), before = left[(i + n - 1) % n], at = left[i],
                      after = left[(i + 1) % n];
    const glm::dvec2 a = flat[before], b = flat[at], c = flat[after];
    if (turn(a, b, c) <= 0) return false;
    return std::none_of(left.begin(), left.end(), [&](std::size_t k) {
      const glm::dvec2 p = flat[k];
      if (k == before || k == at || k == after || p == a || p == b || p == c) return false;
      return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
    });
  };
  while (left.size() > 3) {
    std::size_t ear = 0;
    while (ear < left.size() && !isEar(ear)) ++ear;
    if (ear == left.size()) break;
    const std::size_t n = left.size();
    add(corners[left[(ear + n - 1) % n]], corners[left[ear]], corners[left[(ear + 1) % n]]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  for (std::size_t i = 2; i < left.size(); ++i) add(corners[left[0]], corners[left[i - 1]], corners[left[i]]);
}

}  // namespace vernier::surface
