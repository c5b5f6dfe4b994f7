// SPDX-License-Identifier: GPL-3.0-or-later
#include "Gathering.h"

#include <algorithm>

namespace vernier::quality {

std::vector<const Gathering*> shownOf(std::span<const Gathering> all) {
  std::vector<const Gathering*> shown;
  for (const Gathering& g : all)
    if (g.covered) shown.push_back(&g);
  const bool together = std::all_of(shown.begin(), shown.end(), [&](const Gathering* g) {
    return g->accumulator == shown.front()->accumulator && g->accumulator != Accumulator::Mean;
  });
  if (!together) shown = {shown.back()};
  return shown;
}

glm::dvec3 joined(std::span<const Gathering* const> shown, const VolumeRay& ray) {
  glm::dvec3 value = shown.front()->value, behind = shown.front()->behind;
  bool replaced = false;
  const Accumulator accumulator = shown.front()->accumulator;
  for (const Gathering* g : shown) {
    replaced = replaced || g->replacesTool;
    if (g == shown.front()) continue;
    behind = glm::max(behind, g->behind);
    if (accumulator == Accumulator::Max) value = glm::max(value, g->value);
    if (accumulator == Accumulator::Min) value = glm::min(value, g->value);
    if (accumulator == Accumulator::Sum) value += g->value;
    if (accumulator == Accumulator::Attenuation) value *= g->value;
  }
  const glm::dvec3 end = replaced ? glm::dvec3(0) : ray.backdrop(behind);
  if (accumulator == Accumulator::Sum) return value + end;
  if (accumulator == Accumulator::Attenuation) return value * end;
  return glm::max(value, end);
}

}  // namespace vernier::quality
