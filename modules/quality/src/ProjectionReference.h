// SPDX-License-Identifier: GPL-3.0-or-later
// One projection layer, with its tools, in double. Reference.h says what is meant.
#pragma once
#include "Gathering.h"

namespace vernier::quality {

class ProjectionReference {
 public:
  static Result<ProjectionReference> make(const Scene&, const ProjectionLayer&, const View&, const Sources&);

  VolumeSeen seen(glm::dvec2 pixel) const;
  std::uint64_t edgeKey(glm::dvec2 pixel) const;
  const VolumeRays& rays() const { return rays_; }
  // Whether voxels of these values, or fewer of them, can show other than nothing.
  bool contributes(const LocalRange&) const;
  bool inverted() const { return invert_; }
  // Two means of the same values, which are one mean over the parts of both.
  bool sameMean(const ProjectionReference& other) const {
    return layer_.mode == ProjectionMode::Mean && other.layer_.mode == ProjectionMode::Mean &&
           layer_.interpolation == other.layer_.interpolation && rays_.window() == other.rays_.window();
  }
  // Of all its parts of a ray with lenses, which have the ray's tools.
  Gathering gathered(const VolumeRay& whole, std::span<const VolumeRay> parts) const;
  PartMark mark(const VolumeRay& part) const;

 private:
  ProjectionReference(VolumeRays rays, const ProjectionLayer& layer)
      : rays_(std::move(rays)), layer_(layer) {}
  // What the parts of a ray with data come to.
  struct Gathered {
    double length_mm = 0, seenLength_mm = 0;  // with data; weighed with what tools leave
    double integral = 0;                      // of the value, over mm
    LocalRange values;                        // least and greatest
    double brightest = 0, darkest = 1;        // of the grey, weighed
    std::vector<double> emission_mm;          // integral of the grey, by how many tools are before it
  };
  static Gathered nothing(const VolumeRay&);
  void gather(const VolumeRay&, Gathered&) const;
  // The grey that all of it comes to; of Attenuation what is left of light.
  double amount(const VolumeRay&, const Gathered&) const;
  // What is left of the light of each tool.
  std::vector<double> reaching(const Gathered&) const;
  // Whether rays without data are as those with data of no emission.
  bool everywhere() const {
    return layer_.mode == ProjectionMode::Sum || layer_.mode == ProjectionMode::Attenuation;
  }
  glm::dvec3 combined(const VolumeRay&, const Gathered&) const;

  VolumeRays rays_;
  ProjectionLayer layer_;
  glm::dvec3 background_{0};
  double gain_perMm_ = 0;
  bool invert_ = false;
};

}  // namespace vernier::quality
