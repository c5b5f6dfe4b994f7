// SPDX-License-Identifier: GPL-3.0-or-later
// Combiners of the plugin's folder in the source tree, and registers by name.
#pragma once
#include <gtest/gtest.h>

#include <string>

#include "Combiner.h"
#include "TestPaths.h"

namespace vernier::dvr::test {

inline std::vector<std::string> shippedFolder() {
  return {std::string(VERNIER_SOURCE_DIR) + "/plugins/dvr/combiners"};
}

inline Combiner shipped(const std::string& name) {
  const Result<Combiner> c = findCombiner(name, shippedFolder());
  if (!c) ADD_FAILURE() << c.error().text();
  return c ? *c : Combiner{};
}

struct Filling {
  Registers r{};
  glm::dvec4& texture(std::size_t n) { return r[placeOf(Register::Texture0, n)]; }
  glm::dvec4& operator[](Register x) { return r[placeOf(x)]; }
};

}  // namespace vernier::dvr::test
