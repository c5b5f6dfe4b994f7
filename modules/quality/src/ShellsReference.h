// SPDX-License-Identifier: GPL-3.0-or-later
// The continuous truth of one shells layer, with its tools, in double: level sets of the trilinear field,
// not meshes. Reference.h says what is meant.
#pragma once
#include "ProjectionReference.h"

namespace vernier::quality {

class ShellsReference {
 public:
  static Result<ShellsReference> make(const Scene&, const ShellsLayer&, const View&, const Sources&);

  VolumeSeen seen(glm::dvec2 pixel) const;
  std::uint64_t edgeKey(glm::dvec2 pixel) const;
  const VolumeRays& rays() const { return rays_; }
  bool contributes(const LocalRange&) const;
  // Max and sum are gathered, lit ones are found front to back.
  bool lit() const { return layer_.mode == ShellsMode::Lit; }
  bool sameLevels(const ShellsReference& other) const { return levels_ == other.levels_; }
  // Of all its parts of a ray with lenses, which have the ray's tools.
  Gathering gathered(const VolumeRay& whole, std::span<const VolumeRay> parts) const;
  PartSeen part(const VolumeRay&) const;
  PartMark mark(const VolumeRay& part) const;

 private:
  ShellsReference(VolumeRays rays, const ShellsLayer& layer) : rays_(std::move(rays)), layer_(layer) {}
  // The ray gets into, or out of, level `level` (of those enabled) at t_mm. `cap`: not through the level set,
  // but where the part of the ray or its data begin or end.
  struct Crossing {
    double t_mm = 0;
    std::size_t level = 0, passed = 0;
    bool cap = false, first = false;  // first: at the beginning of the ray's part
    double cell_mm = 0;               // a place in the cell that it lies in
  };
  // Calls fn(crossing) in the order along the ray, until it returns false.
  template <class Fn>
  void crossings(const VolumeRay&, Fn&&) const;
  double brightness(const VolumeRay&, const Crossing&) const;
  // What a ray shows of the shells, without the tools.
  struct Volume {
    bool shown = false;
    double value = 0;       // Max: the brightest, Sum: all, weighed with what tools leave
    bool replaces = false;  // Max: reaches the lowest level
  };
  void greatest(const VolumeRay&, Volume&) const;
  void sum(const VolumeRay&, Volume&) const;
  std::optional<RayTool> firstShell(const VolumeRay&) const;
  glm::dvec3 faceNormal(const VolumeRay&, double t_mm) const;

  VolumeRays rays_;
  ShellsLayer layer_;
  std::vector<double> levels_;  // enabled, ascending
  std::vector<double> phi_;
  glm::dvec3 background_{0}, colour_{1};
};

}  // namespace vernier::quality
