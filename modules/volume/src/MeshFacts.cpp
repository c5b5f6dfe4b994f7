// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/MeshFacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier {
namespace {

// Edges as low vertex, high vertex, direction: sorted, all uses of one edge stand together.
void countEdges(const Mesh& mesh, MeshFacts& facts) {
  struct Use {
    std::uint64_t edge;
    bool downwards;
  };
  std::vector<Use> uses;
  uses.reserve(3 * mesh.triangles().size());
  for (const Triangle& t : mesh.triangles())
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t a = t[i], b = t[(i + 1) % 3];
      uses.push_back({std::min(a, b) << 32 | std::max(a, b), a > b});
    }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.edge < b.edge; });
  bool paired = true;
  for (std::size_t i = 0; i < uses.size();) {
    std::uint64_t up = 0, down = 0;
    for (const std::uint64_t edge = uses[i].edge; i < uses.size() && uses[i].edge == edge; ++i)
      ++(uses[i].downwards ? down : up);
    ++facts.distinctEdges;
    facts.edgesUsedOnce += up + down == 1;
    facts.edgesUsedOverTwice += up + down > 2;
    facts.directedEdgesUsedTwice += (up > 1) + (down > 1);
    paired = paired && up == 1 && down == 1;
  }
  facts.closed = paired;
}

std::uint64_t duplicates(const Mesh& mesh) {
  std::vector<Triangle> sorted(mesh.triangles().begin(), mesh.triangles().end());
  for (Triangle& t : sorted) std::sort(t.begin(), t.end());
  std::sort(sorted.begin(), sorted.end());
  std::uint64_t n = 0;
  for (std::size_t i = 1; i < sorted.size(); ++i) n += sorted[i] == sorted[i - 1];
  return n;
}

// Eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's rotations.
glm::dvec3 principalAxis(glm::dmat3 m) {
  glm::dmat3 axes(1.0);
  for (int sweep = 0; sweep < 50; ++sweep) {
    int p = 0, q = 1;
    if (std::abs(m[0][2]) > std::abs(m[p][q])) q = 2;
    if (std::abs(m[1][2]) > std::abs(m[p][q])) p = 1, q = 2;
    if (m[p][q] == 0) break;
    const double theta = 0.5 * std::atan2(2 * m[p][q], m[q][q] - m[p][p]);
    glm::dmat3 turn(1.0);
    turn[p][p] = turn[q][q] = std::cos(theta);
    turn[q][p] = std::sin(theta), turn[p][q] = -turn[q][p];
    m = glm::transpose(turn) * m * turn;
    axes = axes * turn;
  }
  int best = 0;
  for (int i = 1; i < 3; ++i)
    if (m[i][i] > m[best][best]) best = i;
  return glm::normalize(axes[best]);
}

void measureShape(const Mesh& mesh, MeshFacts& facts) {
  const auto vertex = [&](std::uint32_t v) { return mesh.vertices()[v].p; };
  glm::dvec3 mean(0);
  for (const Triangle& t : mesh.triangles()) mean += vertex(t[0]) + vertex(t[1]) + vertex(t[2]);
  mean /= 3.0 * static_cast<double>(mesh.triangles().size());
  glm::dmat3 spread(0.0);
  for (const Triangle& t : mesh.triangles()) {
    const glm::dvec3 a = vertex(t[0]) - mean, b = vertex(t[1]) - mean, c = vertex(t[2]) - mean;
    facts.area_mm2 += 0.5 * length(mesh.normalTimesTwiceArea(t));
    facts.signedVolume_mm3 += glm::dot(a, glm::cross(b, c)) / 6;
    for (const glm::dvec3& p : {a, b, c}) spread += glm::outerProduct(p, p);
  }
  const glm::dvec3 axis = principalAxis(spread);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const MeshPoint& p : mesh.vertices()) {
    const double along = glm::dot(axis, p.p - mean);
    low = std::min(low, along), high = std::max(high, along);
  }
  facts.extentAlongPrincipalAxis_mm = high - low;
  facts.extent_mm = mesh.highest() - mesh.lowest();
}

}  // namespace

MeshFacts meshFacts(const Mesh& mesh) {
  MeshFacts facts;
  countEdges(mesh, facts);
  facts.duplicateTriangles = duplicates(mesh);
  measureShape(mesh, facts);
  return facts;
}

}  // namespace vernier
