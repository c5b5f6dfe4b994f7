// SPDX-License-Identifier: GPL-3.0-or-later
#include "Solid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Words.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

constexpr double kMostSqueeze = 1e5;
// Of what stands this much farther away than it is large, corners would come together.
constexpr double kLeastShare = 1.0 / (1 << 26);

double frobenius(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

Result<void> checkPlace(const std::vector<PatientPoint>& corners) {
  double farthest = 0;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const PatientPoint& p : corners) low = glm::min(low, p.p), high = glm::max(high, p.p);
  for (int a = 0; a < 3; ++a) farthest = std::max({farthest, std::abs(low[a]), std::abs(high[a])});
  if (!(farthest <= kFarthest_mm))
    return shapeFault("The pose takes the lens " + inWords(farthest) +
                      " mm away; give one that keeps it within " + inWords(kFarthest_mm) +
                      " mm of the origin.");
  const double size = glm::length(high - low);
  if (!(size >= std::max(kLeast_mm, farthest * kLeastShare)))
    return shapeFault("The pose makes the lens " + inWords(size) + " mm large at " + inWords(farthest) +
                      " mm from the origin, too small to tell its corners apart; make it larger.");
  return {};
}

}  // namespace

std::uint64_t Solid::bytes() const {
  return sizeof(*this) + corners.size() * sizeof(corners[0]) + triangles.size() * sizeof(triangles[0]) +
         planeOf.size() * sizeof(planeOf[0]) + normals.size() * sizeof(normals[0]) + notice.size();
}

Result<ConvexRegion> placed(const Solid& solid, const PatientFromMesh& pose) {
  if (const Result<void> ok = checkPose(pose); !ok) return ok.error();
  const double determinant = glm::determinant(pose.linear);
  const glm::dmat3 inverse = glm::inverse(pose.linear);
  const double squeeze = frobenius(pose.linear) * frobenius(inverse);  // 3 of a rotation
  if (!(squeeze <= kMostSqueeze))
    return shapeFault("The pose squeezes the lens to 1:" + inWords(squeeze) +
                      ", where 1:" + inWords(kMostSqueeze) + " is the most; give one that flattens it less.");
  ConvexRegion out;
  out.notice = solid.notice;
  out.corners.resize(solid.corners.size());
  for (std::size_t n = 0; n < solid.corners.size(); ++n) out.corners[n] = pose * MeshPoint(solid.corners[n]);
  if (const Result<void> ok = checkPlace(out.corners); !ok) return ok.error();

  out.triangles = solid.triangles;
  out.planeOf = solid.planeOf;
  if (determinant < 0)
    for (auto& t : out.triangles) std::swap(t[1], t[2]);

  const glm::dmat3 forNormals = glm::transpose(inverse);
  out.planes.resize(solid.normals.size());
  for (std::size_t n = 0; n < solid.normals.size(); ++n)
    out.planes[n] = {PatientVec(glm::normalize(forNormals * solid.normals[n])),
                     -std::numeric_limits<double>::infinity()};
  for (std::size_t n = 0; n < out.triangles.size(); ++n) {
    HalfSpace& h = out.planes[out.planeOf[n]];
    for (const std::uint32_t c : out.triangles[n])
      h.offset_mm = std::max(h.offset_mm, glm::dot(h.normal.v, out.corners[c].p));
  }
  return out;
}

}  // namespace vernier::lens
