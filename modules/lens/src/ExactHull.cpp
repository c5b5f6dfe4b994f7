// SPDX-License-Identifier: GPL-3.0-or-later
#include "ExactHull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "vernier/base/Guarded.h"

namespace vernier::lens {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Exactly so; CGAL's answer to such points changed with its versions.
bool inOnePlane(const std::vector<Kernel::Point_3>& p) {
  std::size_t b = 0, c = 0, d = 0;
  while (b < p.size() && p[b] == p[0]) ++b;
  for (c = b; c < p.size() && CGAL::collinear(p[0], p[b], p[c]);) ++c;
  for (d = c; d < p.size() && CGAL::coplanar(p[0], p[b], p[c], p[d]);) ++d;
  return d >= p.size();
}

TriangleHull hull(std::span<const glm::dvec3> points) {
  std::vector<Kernel::Point_3> in;
  in.reserve(points.size());
  for (const glm::dvec3& p : points) in.emplace_back(p.x, p.y, p.z);
  if (in.empty() || inOnePlane(in)) return {};
  SurfaceMesh mesh;
  CGAL::convex_hull_3(in.begin(), in.end(), mesh);
  TriangleHull out;
  std::vector<std::uint32_t> number(mesh.num_vertices());
  for (const auto v : mesh.vertices()) {
    number[v] = static_cast<std::uint32_t>(out.corners.size());
    const Kernel::Point_3& p = mesh.point(v);
    out.corners.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : mesh.faces()) {
    std::array<std::uint32_t, 3> t{};
    std::size_t n = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      if (n < 3) t[n] = number[v];
      ++n;
    }
    if (n != 3) throw std::runtime_error("a face of the hull is no triangle");
    out.triangles.push_back(t);
  }
  return out;
}

glm::dvec3 exactCross(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  using Number = CGAL::Exact_rational;
  const Number x(a.x), y(a.y), z(a.z);
  const Number ux = Number(b.x) - x, uy = Number(b.y) - y, uz = Number(b.z) - z;
  const Number vx = Number(c.x) - x, vy = Number(c.y) - y, vz = Number(c.z) - z;
  const Number n[3] = {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
  Number most = 0;
  for (const Number& k : n) most = std::max(most, Number(CGAL::abs(k)));
  if (most == 0) return glm::dvec3(0);
  return {CGAL::to_double(Number(n[0] / most)), CGAL::to_double(Number(n[1] / most)),
          CGAL::to_double(Number(n[2] / most))};
}

}  // namespace

Result<TriangleHull> exactHull(std::span<const glm::dvec3> points) {
  return guarded("lens hull", [&]() -> Result<TriangleHull> { return hull(points); });
}

glm::dvec3 exactNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  // The relative error of a cross product in double is about 1e-15 over the sine of the angle; the angle
  // between the two shorter sides has the largest sine.
  const glm::dvec3 ab = b - a, bc = c - b, ca = a - c;
  const double x = glm::dot(ab, ab), y = glm::dot(bc, bc), z = glm::dot(ca, ca);
  const glm::dvec3 n = z >= x && z >= y ? glm::cross(ab, bc)
                       : x >= y         ? glm::cross(bc, ca)
                                        : glm::cross(ca, ab);
  const double shorter = x + y + z - std::max({x, y, z});  // at least the product of the two sides, twice
  const double length = glm::length(n);
  if (length > 0.02 * shorter && length > 1e-200) return n / length;
  const glm::dvec3 e = exactCross(a, b, c);
  return e == glm::dvec3(0) ? e : glm::normalize(e);
}

}  // namespace vernier::lens
