// SPDX-License-Identifier: GPL-3.0-or-later
// The continuous truth of one iso-surface layer, with its tools, in double. Reference.h says what is meant.
#pragma once
#include "EdgeMark.h"
#include "Shading.h"

namespace vernier::quality {

class IsosurfaceReference {
 public:
  static Result<IsosurfaceReference> make(const Scene&, const IsosurfaceLayer&, const View&, const Sources&);

  VolumeSeen seen(glm::dvec2 pixel) const;
  EdgeMark edgeMark(glm::dvec2 pixel) const;
  const VolumeRays& rays() const { return rays_; }
  bool contributes(const LocalRange& values) const { return values.max >= level_; }
  // Of a part of a ray with lenses; `hits` takes the surface that it shows.
  PartSeen part(const VolumeRay&) const;
  PartMark mark(const VolumeRay& part, double left, std::size_t surfaces,
                std::vector<EdgeMark::Hit>& hits) const;

 private:
  explicit IsosurfaceReference(VolumeRays rays) : rays_(std::move(rays)) {}
  struct Hit {
    double t_mm = 0;
    std::size_t passed = 0;  // tools before it
    bool face = false;       // data, or the ray's part, begin there, within
    glm::dvec3 gradient{0};  // patient
  };
  std::optional<Hit> firstHit(const VolumeRay&) const;
  static EdgeMark::Hit markOf(const Hit&, const VolumeRay&);

  VolumeRays rays_;
  std::optional<Shading> shading_;
  std::optional<Gradient> gradient_;
  double level_ = 0;
  glm::dvec3 background_{0};
  std::vector<char> reaching_;  // of the bricks
};

}  // namespace vernier::quality
