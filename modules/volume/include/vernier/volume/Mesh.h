// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh: an immutable triangle surface in its own frame (MeshFrame, mm, double). What is drawn, clipped by or
// measured to as a surface is one of these: tools, cutting planes, closed lenses, shells. Shared between
// threads without locks; derived data is cached by its revision.
//
// It stands in `volume`, beside the voxels, since all who need it (plan, native, gpu, quality, measure) see
// that module and nobody else brings data of the patient in.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "vernier/base/Frames.h"
#include "vernier/base/Result.h"
#include "vernier/base/Revision.h"

namespace vernier {

// A surface's own coordinates, mm; its pose is patientFromMesh.
struct MeshFrame {};
using MeshPoint = Point<MeshFrame>;
using MeshVec = Vec<MeshFrame>;
using PatientFromMesh = Transform<PatientFrame, MeshFrame>;

// Three vertices; counter-clockwise seen from outside, as all surface files have it.
using Triangle = std::array<std::uint32_t, 3>;

class VERNIER_API Mesh {
 public:
  std::span<const MeshPoint> vertices() const { return vertices_; }   // all finite, no two equal, each in use
  std::span<const Triangle> triangles() const { return triangles_; }  // at least one; area above 0
  MeshPoint lowest() const { return lowest_; }                        // box of all vertices
  MeshPoint highest() const { return highest_; }
  Revision revision() const { return revision_; }
  std::uint64_t bytes() const;
  // Not of unit length: twice the triangle's area. Never zero.
  MeshVec normalTimesTwiceArea(const Triangle& t) const {
    return cross(vertices_[t[1]] - vertices_[t[0]], vertices_[t[2]] - vertices_[t[0]]);
  }

 private:
  friend class MeshBuilder;
  Mesh() = default;
  std::vector<MeshPoint> vertices_;
  std::vector<Triangle> triangles_;
  MeshPoint lowest_, highest_;
  Revision revision_ = nextRevision();
};

// What was left out, counted.
struct MeshDropped {
  std::uint64_t notFinite = 0;  // triangles with a vertex that is NaN or infinite
  std::uint64_t zeroArea = 0;   // triangles whose area, computed in double, is 0
  friend bool operator==(const MeshDropped&, const MeshDropped&) = default;
};

// The only way to a Mesh. Vertices that are equal bit by bit (-0 counts as 0) become one; triangles that are
// not finite or have no area are dropped and counted; vertices that no triangle uses vanish.
class VERNIER_API MeshBuilder {
 public:
  static constexpr std::uint32_t kNotFinite = 0xFFFFFFFF;
  static constexpr std::size_t kMaxVertices = 0xFFFFFFF0;

  // Room for this many triangles of a closed surface; no more than a hint.
  void reserve(std::size_t triangles);
  // The number to name the vertex by; kNotFinite when it cannot be used.
  std::uint32_t vertex(glm::dvec3 p_mm);
  // Numbers that vertex() gave.
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  const MeshDropped& dropped() const { return dropped_; }
  std::uint64_t given() const { return triangles_.size() + dropped_.notFinite + dropped_.zeroArea; }

  // NothingToLoad when no triangle is left. The builder is empty afterwards.
  Result<std::shared_ptr<const Mesh>> finish();

 private:
  void grow(std::size_t slots);
  std::vector<MeshPoint> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> slots_;  // open addressing, a power of two, kNotFinite = empty
  MeshDropped dropped_;
};

}  // namespace vernier
