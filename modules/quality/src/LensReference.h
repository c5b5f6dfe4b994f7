// SPDX-License-Identifier: GPL-3.0-or-later
// A layer that looks through a volume with lenses before it, and their tools, in double: exact intervals, one
// appearance between two cuts. Reference.h says what is meant.
#pragma once
#include <variant>

#include "IsosurfaceReference.h"
#include "LensCuts.h"
#include "ShellsReference.h"
#include "VolumeReference.h"

namespace vernier::quality {

class LensReference {
 public:
  // monostate: nothing.
  using Appearance = std::variant<std::monostate, ProjectionReference, ShellsReference, VolumeReference,
                                  IsosurfaceReference>;
  // `base`: the layer behind options.lenses. SceneInvalid: an inside that it cannot have. NotBuiltYet: what
  // cannot be joined, and what the appearances themselves refuse.
  static Result<LensReference> make(const Scene&, std::size_t base, const View&, const Sources&,
                                    const ReferenceOptions&);

  VolumeSeen seen(glm::dvec2 pixel) const;
  EdgeMark edgeMark(glm::dvec2 pixel) const;
  const VolumeRays& rays() const;
  // Of the outside; and of the inside of lens n, from 1.
  bool contributes(const LocalRange& values) const { return contributes(0, values); }
  bool contributes(std::size_t appearance, const LocalRange&) const;
  const std::vector<PlacedLens>& lenses() const { return lenses_; }

 private:
  bool isEmpty(std::size_t n) const { return std::holds_alternative<std::monostate>(appearances_[n]); }
  bool ordered(std::size_t appearance) const;
  // The pieces of each appearance, with all tools.
  struct Parts {
    VolumeRay whole;
    std::vector<VolumeRay> parts;
    std::vector<std::size_t> appearances;
    std::vector<VolumeRay> of(std::size_t group, const std::vector<std::size_t>& groups) const;
  };
  Parts cut(glm::dvec2 pixel) const;
  bool goOn(std::size_t a, std::size_t b) const;
  PartSeen orderedPart(std::size_t appearance, const VolumeRay&) const;
  PartMark markPart(std::size_t appearance, const VolumeRay&, double left, std::vector<EdgeMark::Hit>&) const;
  std::vector<Gathering> gatherings(const Parts&) const;

  std::vector<PlacedLens> lenses_;
  std::vector<Appearance> appearances_;  // the outside, then the lenses
  // The appearance that each is gathered with: the last that is the same mean, else itself.
  std::vector<std::size_t> groups_;
  glm::dvec3 background_{0};
};

}  // namespace vernier::quality
