// SPDX-License-Identifier: GPL-3.0-or-later
// One volume layer (transfer function, or colour), with its tools, in double. Reference.h says what is meant.
#pragma once
#include "EdgeMark.h"
#include "FrontToBack.h"
#include "Shading.h"
#include "Transfer.h"
#include "vernier/quality/Reference.h"

namespace vernier::quality {

class VolumeReference {
 public:
  static Result<VolumeReference> make(const Scene&, const VolumeLayer&, const View&, const Sources&,
                                      const ReferenceOptions&);

  VolumeSeen seen(glm::dvec2 pixel) const;
  EdgeMark edgeMark(glm::dvec2 pixel) const;
  const VolumeRays& rays() const { return rays_; }
  bool contributes(const LocalRange&) const;
  VolumeMode mode() const { return layer_.mode; }
  // Of a part of a ray with lenses, blended; `hits` takes the steps that it shows.
  PartSeen part(const VolumeRay&) const;
  PartMark mark(const VolumeRay& part, double left, std::size_t surfaces,
                std::vector<EdgeMark::Hit>& hits) const;

 private:
  VolumeReference(VolumeRays rays, const VolumeLayer& layer) : rays_(std::move(rays)), layer_(layer) {}
  Result<void> readColours();
  bool isColour() const { return rays_.volume().isColour(); }
  bool shades() const { return layer_.shading != ShadingModel::None; }

  // A ray on its way: what has been gathered, and past how many of the tools.
  struct Walk {
    explicit Walk(const VolumeRay& along) : ray(along) {}
    const VolumeRay& ray;
    FrontToBack light;
    std::size_t passed = 0;
    bool shown = false;
    bool plain = false;        // without shading
    double end_mm = -1;        // of the data so far
    std::size_t interval = 0;  // of the transfer function, there
    std::vector<EdgeMark::Hit>* hits = nullptr;
    // False: nothing behind is seen.
    bool passTools(std::size_t upTo);
  };
  // Blend. The truth, piece by piece; colour volumes; the lattice of samples.
  void blend(Walk&) const;
  bool blendPart(const RayPart&, Walk&) const;
  bool blendStretch(const RayPart&, std::size_t interval, double from, double to, Gradient::Along*,
                    Walk&) const;
  glm::dvec3 colourOf(std::size_t interval, double value, const glm::dvec3* gradient, glm::dvec3 ray) const;
  bool hasData(const VolumeRay&) const;
  void markSteps(Walk&) const;
  void markBeginning(const RayPart&, const std::vector<double>& stops, Walk&) const;
  void markStep(const RayPart&, double u, std::size_t surface, bool cap, Walk&) const;
  bool blendColours(const RayPart&, Walk&) const;
  void lattice(Walk&) const;
  bool sample(glm::dvec3 voxel, double length_mm, Walk&) const;

  // Max, Min.
  struct Extreme {
    std::optional<double> value;
    std::size_t passed = 0;  // tools before it
  };
  Extreme extreme(const VolumeRay&) const;
  VolumeSeen seenExtreme(const VolumeRay&) const;
  VolumeSeen seenColourExtremes(const VolumeRay&) const;
  // Numerators of red, green, blue and alpha with their gains, 0..1 but for the gains.
  std::array<Poly, 4> channelsOf(const RayPart&) const;

  VolumeRays rays_;
  VolumeLayer layer_;
  std::optional<Transfer> transfer_;  // of grey volumes
  std::optional<Shading> shading_;
  std::optional<Gradient> gradient_;
  glm::dvec3 background_{0};
  double smallest_mm_ = 1;
  double step_mm_ = 0;         // above 0: of the lattice
  std::vector<char> showing_;  // of the bricks
};

}  // namespace vernier::quality
