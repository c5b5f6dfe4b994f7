// SPDX-License-Identifier: GPL-3.0-or-later
#include "HullSolid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "CleanHull.h"
#include "ExactHull.h"
#include "SolidShapes.h"
#include "Words.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

template <class Measure>
std::size_t farthest(std::span<const glm::dvec3> points, const Measure& measure) {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t n = 0; n < points.size(); ++n)
    if (const double d = measure(points[n]); d > most) most = d, best = n;
  return best;
}

constexpr std::size_t kMostExactPoints = 150000;  // a second's work for the exact hull
constexpr const char* kNext = "; give points that enclose a volume.";

// Four points that span a volume; the reason when there are none.
Result<std::array<std::size_t, 4>> spanning(std::span<const glm::dvec3> p, const HullScale& scale) {
  const std::string count = std::to_string(p.size());
  std::array<std::size_t, 4> s{};
  s[0] = farthest(p, [&](const glm::dvec3& q) { return glm::distance(q, scale.middle); });
  const glm::dvec3 origin = p[s[0]];
  s[1] = farthest(p, [&](const glm::dvec3& q) { return glm::distance(q, origin); });
  const double length = glm::distance(p[s[1]], origin);
  if (!(length >= kLeast_mm))
    return shapeFault("A hull needs a volume, and its " + count + " points are all equal to within " +
                      inWords(kLeast_mm) + " mm" + kNext);
  const glm::dvec3 along = (p[s[1]] - origin) / length;
  const auto fromLine = [&](const glm::dvec3& q) { return glm::length(glm::cross(q - origin, along)); };
  s[2] = farthest(p, fromLine);
  const double width = fromLine(p[s[2]]);
  if (!(width > scale.thin))
    return shapeFault("A hull needs a volume, and its " + count + " points lie in a line to within " +
                      inWords(scale.thin) + " mm" + kNext);
  // The line's part is taken out twice: what is left is across it to rounding.
  glm::dvec3 side = (p[s[2]] - origin) - along * glm::dot(p[s[2]] - origin, along);
  side = glm::normalize(side - along * glm::dot(side, along));
  const glm::dvec3 up = glm::cross(along, side);
  const auto fromPlane = [&](const glm::dvec3& q) { return std::abs(glm::dot(q - origin, up)); };
  s[3] = farthest(p, fromPlane);
  if (!(fromPlane(p[s[3]]) > scale.thin))
    return shapeFault("A lens needs a volume, and the " + count +
                      " points of its hull lie in a plane to within " + inWords(scale.thin) +
                      " mm, so the hull is flat" + kNext);
  return s;
}

}  // namespace

HullScale hullScale(std::span<const glm::dvec3> points) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  double farthestCoordinate = 0;
  for (const glm::dvec3& p : points) {
    low = glm::min(low, p), high = glm::max(high, p);
    for (int a = 0; a < 3; ++a) farthestCoordinate = std::max(farthestCoordinate, std::abs(p[a]));
  }
  HullScale s;
  s.middle = 0.5 * (low + high);
  s.half = 0.5 * glm::length(high - low);
  s.flat = 2e-12 * s.half + 16 * std::numeric_limits<double>::epsilon() * farthestCoordinate;
  s.thin = s.half / (1 << 21) + s.flat;
  return s;
}

Result<Solid> hullSolid(std::span<const MeshPoint> given) {
  if (given.size() < 4)
    return shapeFault("A hull needs a volume, that is at least 4 points that do not lie in a plane; there " +
                      std::string(given.size() == 1 ? "is 1" : "are " + std::to_string(given.size())) + ".");
  std::vector<glm::dvec3> points;
  points.reserve(given.size());
  for (std::size_t n = 0; n < given.size(); ++n) {
    if (const auto ok = checkPoint("A point of the hull", given[n]); !ok)
      return shapeFault(ok.error().sentence + " It is point " + std::to_string(n) + ", counted from 0.");
    points.push_back(given[n].p);
  }
  const HullScale scale = hullScale(points);
  const Result<std::array<std::size_t, 4>> seeds = spanning(points, scale);
  if (!seeds) return seeds.error();
  Result<std::vector<glm::dvec3>> candidates = hullCandidates(points, scale, *seeds);
  if (!candidates) return candidates.error();
  std::vector<glm::dvec3> corners = *std::move(candidates);
  if (corners.size() > kMostHullPoints && corners.size() <= kMostExactPoints) {
    Result<TriangleHull> exact = exactHull(corners);  // most of them may lie inside
    if (!exact) return exact.error();
    corners = std::move(exact->corners);
  }
  if (corners.size() <= kMostHullPoints) return cleanHull(std::move(corners), scale);
  Result<Solid> solid = cleanHull(thinned(corners, scale), scale);
  if (!solid) return solid;
  solid->notice = "its hull, of " + std::to_string(points.size()) + " points, was made of " +
                  std::to_string(kMostHullPoints) + " of them at most: it is up to " +
                  inWords(farthestOutside_mm(*solid, scale.middle, corners)) + " mm smaller";
  return solid;
}

}  // namespace vernier::lens
