// SPDX-License-Identifier: GPL-3.0-or-later
// A field: modality values (and noise) along a row of voxels, from the recipe's "source". Immutable;
// thread-safe.
#pragma once
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "Solids.h"

namespace vernier::phantoms {

using Json = nlohmann::json;

class Field {
 public:
  virtual ~Field() = default;
  // What of the field can matter to voxels within `region`: called once per slice, so that a row looks at
  // little.
  virtual std::unique_ptr<const Field> within(const AxisBox& region) const {
    return nullptr;
    (void)region;
  }
  // value: modality values without noise; noise: its standard deviation, in modality units.
  virtual void row(const RowLine&, std::span<double> value, std::span<double> noise) const = 0;
};

class SolidsField : public Field {
 public:
  SolidsField(std::vector<Solid> solids, double background, double noise, double edge_mm, std::uint64_t seed);
  std::unique_ptr<const Field> within(const AxisBox& region) const override;
  void row(const RowLine&, std::span<double> value, std::span<double> noise) const override;
  const std::vector<Solid>& solids() const { return solids_; }

 private:
  struct Numbered {  // the seed of a solid's texture is its place in the recipe, whatever was left out
    const Solid* solid;
    AxisBox bounds;
    std::uint64_t seed;
  };
  SolidsField() = default;
  std::vector<Solid> solids_;
  std::vector<Numbered> order_;
  double background_ = 0, noise_ = 0, edge_mm_ = 0;
};

// Throws std::invalid_argument with a sentence where the recipe is wrong (a mistake of ours, caught by
// guarded()).
std::unique_ptr<const Field> makeField(const Json& recipe, std::uint64_t seed,
                                       const std::vector<Solid>& solids);
// The solids of the recipe's source: those listed, mirrored ones twice (name + "-right"), trees grown.
std::vector<Solid> solidsOf(const Json& recipe, std::uint64_t seed);
glm::dvec3 vecOf(const Json& three);
// About x first, then y, then z, all three fixed axes.
glm::dmat3 rotationOf(glm::dvec3 degreesAboutXyz);

// A branching tree of tapered capsules inside the recipe's envelope, grown by integer-hash choices.
std::vector<Solid> growTree(const Json& tree, std::uint64_t seed);

}  // namespace vernier::phantoms
