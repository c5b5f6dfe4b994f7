// SPDX-License-Identifier: GPL-3.0-or-later
#include "MeshConvexity.h"

#include <algorithm>
#include <cmath>

#include "Words.h"
#include "vernier/volume/MeshFacts.h"

namespace vernier::lens {
namespace {

constexpr double kShare = 1e-5;
constexpr const char* kNext = " Ask for its hull (\"hull\": true), or give a closed convex mesh.";

// Of each edge, from its smaller vertex to its larger one, a triangle and the vertex opposite to it there.
struct EdgeUse {
  std::uint64_t key;
  std::uint32_t triangle, opposite;
};

std::vector<EdgeUse> edgeUses(const Mesh& m) {
  std::vector<EdgeUse> out;
  out.reserve(3 * m.triangles().size());
  for (std::uint32_t t = 0; t < m.triangles().size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Triangle& c = m.triangles()[t];
      const auto [low, high] = std::minmax(c[k], c[(k + 1) % 3]);
      out.push_back({std::uint64_t{low} << 32 | high, t, c[(k + 2) % 3]});
    }
  std::sort(out.begin(), out.end(), [](const EdgeUse& a, const EdgeUse& b) { return a.key < b.key; });
  return out;
}

}  // namespace

double volume_mm3(const Solid& s) {
  double six = 0;
  const glm::dvec3 o = s.corners.front();
  for (const auto& [a, b, c] : s.triangles)
    six += glm::dot(s.corners[a] - o, glm::cross(s.corners[b] - o, s.corners[c] - o));
  return six / 6;
}

Result<void> checkEdges(const Mesh& m) {
  const MeshFacts facts = meshFacts(m);
  if (!facts.closed) {
    std::string why;
    if (facts.edgesUsedOnce > 0)
      why = std::to_string(facts.edgesUsedOnce) + " of its edges have one triangle only";
    else if (facts.edgesUsedOverTwice > 0)
      why = std::to_string(facts.edgesUsedOverTwice) + " of its edges have more than two triangles";
    else
      why = std::to_string(facts.directedEdgesUsedTwice) +
            " of its edges have triangles turned against each other";
    return shapeFault("The mesh is no lens, since it is not closed: " + why + "." + kNext);
  }
  // A mesh that is inside out as a whole is convex all the same.
  const double turned = facts.signedVolume_mm3 < 0 ? -1 : 1;
  const double slack = kShare * length(m.highest() - m.lowest());
  const std::vector<EdgeUse> uses = edgeUses(m);
  std::uint64_t concave = 0;
  double deepest = 0;
  for (std::size_t n = 0; n + 1 < uses.size(); n += 2) {
    const Triangle& t = m.triangles()[uses[n].triangle];
    const MeshVec normal = normalize(m.normalTimesTwiceArea(t));
    const double above = turned * dot(normal, m.vertices()[uses[n + 1].opposite] - m.vertices()[t[0]]);
    if (above > slack) ++concave, deepest = std::max(deepest, above);
  }
  if (concave > 0)
    return shapeFault("The mesh is not convex: at " + std::to_string(concave) +
                      " of its edges it bends inwards, by up to " + inWords(deepest) + " mm." + kNext);
  return {};
}

Result<void> checkFilled(const Mesh& m, const Solid& hull) {
  const double share = std::abs(meshFacts(m).signedVolume_mm3) / volume_mm3(hull);
  if (std::abs(share - 1) <= kShare) return {};
  return shapeFault("The mesh is not convex: it fills " + inWords(100 * share) + " % of its hull." + kNext);
}

}  // namespace vernier::lens
