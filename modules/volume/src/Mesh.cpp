// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace vernier {
namespace {

std::uint64_t hashOf(glm::dvec3 p) {
  std::uint64_t h = 0x9E3779B97F4A7C15ull;
  for (int axis = 0; axis < 3; ++axis) {
    h = (h ^ std::bit_cast<std::uint64_t>(p[axis])) * 0xD6E8FEB86659FD93ull;
    h ^= h >> 32;
  }
  return h;
}

}  // namespace

std::uint64_t Mesh::bytes() const {
  return vertices_.size() * sizeof(MeshPoint) + triangles_.size() * sizeof(Triangle);
}

void MeshBuilder::reserve(std::size_t triangles) {
  triangles_.reserve(triangles);
  vertices_.reserve(triangles / 2 + 4);  // Euler: a closed surface has half as many vertices as triangles
  grow(triangles + 8);
}

void MeshBuilder::grow(std::size_t slots) {
  const std::size_t n = std::bit_ceil(std::max<std::size_t>(slots, 64));
  if (n <= slots_.size()) return;
  slots_.assign(n, kNotFinite);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    std::size_t at = hashOf(vertices_[i].p) & (n - 1);
    while (slots_[at] != kNotFinite) at = (at + 1) & (n - 1);
    slots_[at] = static_cast<std::uint32_t>(i);
  }
}

std::uint32_t MeshBuilder::vertex(glm::dvec3 p) {
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return kNotFinite;
  p += 0.0;  // -0 becomes 0
  if (2 * (vertices_.size() + 1) > slots_.size()) grow(std::max<std::size_t>(64, 2 * slots_.size()));
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = hashOf(p) & mask;
  for (; slots_[at] != kNotFinite; at = (at + 1) & mask)
    if (vertices_[slots_[at]].p == p) return slots_[at];
  VERNIER_ASSERT(vertices_.size() < kMaxVertices);
  slots_[at] = static_cast<std::uint32_t>(vertices_.size());
  vertices_.emplace_back(p);
  return slots_[at];
}

void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (a == kNotFinite || b == kNotFinite || c == kNotFinite) {
    ++dropped_.notFinite;
    return;
  }
  VERNIER_ASSERT(a < vertices_.size() && b < vertices_.size() && c < vertices_.size());
  const MeshVec n = cross(vertices_[b] - vertices_[a], vertices_[c] - vertices_[a]);
  // Coordinates near the ends of double make a product that overflows: such a triangle cannot be worked with.
  if (!std::isfinite(n.v.x) || !std::isfinite(n.v.y) || !std::isfinite(n.v.z))
    ++dropped_.notFinite;
  else if (!(glm::dot(n.v, n.v) > 0))
    ++dropped_.zeroArea;
  else
    triangles_.push_back({a, b, c});
}

Result<std::shared_ptr<const Mesh>> MeshBuilder::finish() {
  const MeshBuilder emptied = std::exchange(*this, MeshBuilder());
  if (emptied.triangles_.empty())
    return makeError(ErrorCode::NothingToLoad,
                     "The surface holds no triangle that can be drawn (" + std::to_string(emptied.given()) +
                         " given, " + std::to_string(emptied.dropped_.zeroArea) + " without area, " +
                         std::to_string(emptied.dropped_.notFinite) + " not finite).");
  std::shared_ptr<Mesh> mesh(new Mesh());
  std::vector<std::uint32_t> kept(emptied.vertices_.size(), kNotFinite);
  for (const Triangle& t : emptied.triangles_)
    for (const std::uint32_t v : t) kept[v] = 0;
  mesh->lowest_ = mesh->highest_ = emptied.vertices_[emptied.triangles_[0][0]];
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == kNotFinite) continue;
    kept[i] = static_cast<std::uint32_t>(mesh->vertices_.size());
    mesh->vertices_.push_back(emptied.vertices_[i]);
    mesh->lowest_.p = glm::min(mesh->lowest_.p, emptied.vertices_[i].p);
    mesh->highest_.p = glm::max(mesh->highest_.p, emptied.vertices_[i].p);
  }
  mesh->triangles_ = emptied.triangles_;
  for (Triangle& t : mesh->triangles_)
    for (std::uint32_t& v : t) v = kept[v];
  mesh->vertices_.shrink_to_fit();
  return std::shared_ptr<const Mesh>(std::move(mesh));
}

}  // namespace vernier
