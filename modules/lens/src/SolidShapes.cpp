// SPDX-License-Identifier: GPL-3.0-or-later
#include "SolidShapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "Words.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

constexpr double kThinnest = 1.0 / (1 << 20);  // the least extent of a lens, of its largest one
constexpr int kFewSides = 48;                  // a ring keeps these before its end becomes a point

// The neighbouring corners of a ring must stay apart, and stay convex, when float32 rounds them: the middle
// one of three stands 2 pi^2 r / n^2 before the line through the others.
int mostSides(double radius, double half) {
  const double n = std::sqrt(2 * std::numbers::pi * std::numbers::pi * radius / (half * kThinnest));
  return static_cast<int>(std::min(n, 1e6));
}

// Two unit vectors across `axis`, right-handed with it.
std::array<glm::dvec3, 2> across(const glm::dvec3& axis) {
  int least = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(axis[a]) < std::abs(axis[least])) least = a;
  glm::dvec3 e(0);
  e[least] = 1;
  const glm::dvec3 u = glm::normalize(e - axis * glm::dot(axis, e));
  return {u, glm::cross(axis, u)};
}

struct Rings {
  glm::dvec3 from, to;
  double fromRadius, toRadius;
  int sides;
};

Solid prism(const Rings& r) {
  const glm::dvec3 axis = glm::normalize(r.to - r.from);
  const auto [u, v] = across(axis);
  const double length = glm::length(r.to - r.from);
  const auto n = static_cast<std::uint32_t>(r.sides);
  Solid s;
  const auto ring = [&](const glm::dvec3& centre, double radius) {
    const auto first = static_cast<std::uint32_t>(s.corners.size());
    if (radius == 0) {
      s.corners.push_back(centre);
      return first;
    }
    for (std::uint32_t k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * k / n;
      s.corners.push_back(centre + radius * (std::cos(a) * u + std::sin(a) * v));
    }
    return first;
  };
  const std::uint32_t lower = ring(r.from, r.fromRadius), upper = ring(r.to, r.toRadius);
  const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    s.triangles.push_back({a, b, c});
    s.planeOf.push_back(static_cast<std::uint32_t>(s.normals.size()));
  };
  // The sides: their normal leans by the slope of the inscribed circles.
  const double inner = std::cos(std::numbers::pi / n);
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    if (r.fromRadius > 0) face(lower + k, lower + next, r.toRadius > 0 ? upper + next : upper);
    if (r.toRadius > 0) face(r.fromRadius > 0 ? lower + k : lower, upper + next, upper + k);
    const double a = 2 * std::numbers::pi * (k + 0.5) / n;
    s.normals.push_back(glm::normalize(length * (std::cos(a) * u + std::sin(a) * v) +
                                       (r.fromRadius - r.toRadius) * inner * axis));
  }
  if (r.fromRadius > 0) {
    for (std::uint32_t k = 1; k + 1 < n; ++k) face(lower, lower + k + 1, lower + k);
    s.normals.push_back(-axis);
  }
  if (r.toRadius > 0) {
    for (std::uint32_t k = 1; k + 1 < n; ++k) face(upper, upper + k, upper + k + 1);
    s.normals.push_back(axis);
  }
  return s;
}

Result<void> checkRadius(const char* what, double r) { return r == 0 ? Result<void>() : checkSize(what, r); }

}  // namespace

Result<void> checkSize(const char* what, double v) {
  if (v >= kLeast_mm && v <= kFarthest_mm) return {};
  return shapeFault(std::string(what) + " is " + inWords(v) + " mm; give one from " + inWords(kLeast_mm) +
                    " to " + inWords(kFarthest_mm) + " mm.");
}

Result<void> checkPoint(const char* what, const MeshPoint& p) {
  for (int a = 0; a < 3; ++a)
    if (!(std::abs(p.p[a]) <= kFarthest_mm))
      return shapeFault(std::string(what) + " has the coordinate " + inWords(p.p[a]) +
                        "; give finite numbers within " + inWords(kFarthest_mm) + " mm.");
  return {};
}

Result<Solid> boxSolid(const BoxShape& b) {
  if (const auto ok = checkPoint("The box's centre", b.centre); !ok) return ok.error();
  for (int a = 0; a < 3; ++a)
    if (const auto ok = checkSize("A size of the box", b.size_mm[a]); !ok) return ok.error();
  const double least = std::min({b.size_mm.x, b.size_mm.y, b.size_mm.z});
  const double most = std::max({b.size_mm.x, b.size_mm.y, b.size_mm.z});
  if (least < most * kThinnest)
    return shapeFault("The box is " + inWords(least) + " mm thick and " + inWords(most) +
                      " mm long, which is flat; make it at least a millionth as thick as it is long.");
  Solid s;
  for (int n = 0; n < 8; ++n)
    s.corners.push_back(b.centre.p +
                        0.5 * b.size_mm * glm::dvec3(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1));
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::uint32_t i = 1u << axis, u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
      const std::uint32_t base = side ? i : 0;
      // Seen from the axis' far end u to v turns counterclockwise.
      const std::uint32_t second = side ? base + u : base + v, fourth = side ? base + v : base + u;
      s.triangles.push_back({base, second, base + u + v});
      s.triangles.push_back({base, base + u + v, fourth});
      const auto plane = static_cast<std::uint32_t>(s.normals.size());
      s.planeOf.insert(s.planeOf.end(), {plane, plane});
      glm::dvec3 n(0);
      n[static_cast<int>(axis)] = side ? 1 : -1;
      s.normals.push_back(n);
    }
  return s;
}

Solid icosphere(int divisions) {
  const double g = std::numbers::phi;
  Solid s;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g}) {
      s.corners.emplace_back(0, a, b), s.corners.emplace_back(a, b, 0), s.corners.emplace_back(b, 0, a);
    }
  for (glm::dvec3& c : s.corners) c = glm::normalize(c);
  // Three corners make a face when they are each other's neighbours, 63.4 degrees apart.
  const auto near = [&](std::uint32_t a, std::uint32_t b) {
    return glm::dot(s.corners[a], s.corners[b]) > 0.4;
  };
  for (std::uint32_t a = 0; a < 12; ++a)
    for (std::uint32_t b = a + 1; b < 12; ++b)
      for (std::uint32_t c = b + 1; c < 12; ++c)
        if (near(a, b) && near(b, c) && near(a, c)) {
          const bool outward = glm::dot(glm::cross(s.corners[b] - s.corners[a], s.corners[c] - s.corners[a]),
                                        s.corners[a]) > 0;
          s.triangles.push_back(outward ? std::array{a, b, c} : std::array{a, c, b});
        }
  for (int d = 0; d < divisions; ++d) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, made] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(s.corners.size()));
      if (made) s.corners.push_back(glm::normalize(s.corners[a] + s.corners[b]));
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    finer.reserve(4 * s.triangles.size());
    for (const auto& [a, b, c] : s.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    s.triangles = std::move(finer);
  }
  for (const auto& [a, b, c] : s.triangles) {
    s.planeOf.push_back(static_cast<std::uint32_t>(s.normals.size()));
    s.normals.push_back(glm::normalize(glm::cross(s.corners[b] - s.corners[a], s.corners[c] - s.corners[a])));
  }
  return s;
}

Result<Transform<MeshFrame, MeshFrame>> spherePlace(const SphereShape& s) {
  if (const auto ok = checkPoint("The sphere's centre", s.centre); !ok) return ok.error();
  if (const auto ok = checkSize("The sphere's radius", s.radius_mm); !ok) return ok.error();
  if (s.divisions < 0 || s.divisions > 5)
    return shapeFault("A sphere is divided 0 to 5 times, not " + std::to_string(s.divisions) + ".");
  return Transform<MeshFrame, MeshFrame>{glm::dmat3(s.radius_mm), s.centre.p};
}

Result<Solid> coneSolid(const ConeShape& c) {
  if (const auto ok = checkPoint("The cone's beginning", c.from); !ok) return ok.error();
  if (const auto ok = checkPoint("The cone's end", c.to); !ok) return ok.error();
  if (const auto ok = checkRadius("The radius at the cone's beginning", c.fromRadius_mm); !ok)
    return ok.error();
  if (const auto ok = checkRadius("The radius at the cone's end", c.toRadius_mm); !ok) return ok.error();
  if (c.sides < 3 || c.sides > 1000)
    return shapeFault("A cone has 3 to 1000 sides, not " + std::to_string(c.sides) + ".");
  if (c.fromRadius_mm == 0 && c.toRadius_mm == 0)
    return shapeFault("Both radii of the cone are 0, which leaves a line; give one of them a size.");
  const double length = glm::length(c.to.p - c.from.p);
  if (!(length >= kLeast_mm))
    return shapeFault("The cone begins where it ends, so it has no axis; move one of the two points.");
  Rings r{c.from.p, c.to.p, c.fromRadius_mm, c.toRadius_mm, c.sides};
  const double widest = std::max(r.fromRadius, r.toRadius);
  const double half = 0.5 * std::hypot(length, 2 * widest);
  if (2 * widest < length * kThinnest || length < 2 * widest * kThinnest || mostSides(widest, half) < 3)
    return shapeFault("The cone is " + inWords(2 * widest) + " mm wide and " + inWords(length) +
                      " mm long, which is flat or a line; bring the two within a millionth of each other.");
  std::string notice;
  const int wanted = std::min(r.sides, mostSides(widest, half));
  for (double* end : {&r.fromRadius, &r.toRadius})
    if (*end > 0 && mostSides(*end, half) < std::min(wanted, kFewSides)) {
      *end = 0;
      notice = "the cone's thin end is drawn as a point";
    }
  const double least = r.fromRadius > 0 && r.toRadius > 0 ? std::min(r.fromRadius, r.toRadius) : widest;
  r.sides = std::min(r.sides, mostSides(least, half));
  if (r.sides < c.sides)
    notice += std::string(notice.empty() ? "" : "; ") + "the cone, so thin, has " + std::to_string(r.sides) +
              " sides";
  Solid s = prism(r);
  s.notice = std::move(notice);
  return s;
}

}  // namespace vernier::lens
