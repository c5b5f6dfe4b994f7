// SPDX-License-Identifier: GPL-3.0-or-later
// What an appearance that is gathered whatever lies between its parts (Accumulator: all but Ordered) comes to
// on one ray, and what several of them do together. Reference.h says what is meant.
#pragma once
#include <span>
#include <vector>

#include "VolumeRays.h"
#include "vernier/plan/RayIntervals.h"

namespace vernier::quality {

struct Gathering {
  Accumulator accumulator = Accumulator::Max;
  bool covered = false;
  glm::dvec3 value{0};           // of all parts, weighed with what the tools before each leave
  glm::dvec3 behind{0};          // what stands behind it where no opaque tool does
  glm::dvec3 bare{0};            // the same where nothing is covered, if this is the outside
  bool replacesTool = false;     // the opaque tool is not seen behind it
  std::vector<double> reaching;  // what it leaves of the light of the first tool, the second, ...
};

// Those that show: all that are covered where they can be joined, else the last of these alone. `all` in the
// scene's order.
std::vector<const Gathering*> shownOf(std::span<const Gathering> all);

// What they show together before the opaque tool or the background; `shown` is not empty.
glm::dvec3 joined(std::span<const Gathering* const> shown, const VolumeRay&);

}  // namespace vernier::quality
