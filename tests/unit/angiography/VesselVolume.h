// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

#include "../volume/Grids.h"

namespace vernier::test {

// Two tubes and a ball of Gaussian profile, 0 to about 200, on an anisotropic, oblique grid.
inline std::shared_ptr<const Volume> vesselVolume(bool leftHanded = false) {
  VolumeInfo info;
  info.grid = unitGrid(22, 20, 15);
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.9, 0.3, 0.1));
  const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(0.1, 0.9, -0.2)));
  info.grid.patientFromVoxel.linear =
      glm::dmat3(0.8 * x, 0.9 * glm::cross(z, x), (leftHanded ? -1.4 : 1.4) * z);
  info.grid.patientFromVoxel.translation = {-10, 40, 200};
  std::vector<float> values;
  for (int k = 0; k < 15; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 22; ++i) {
        const auto bump = [](double d2, double width) { return std::exp(-d2 / (width * width)); };
        const double tube = std::pow(j - 6 - 3 * std::sin(0.3 * i), 2) + std::pow(1.5 * (k - 5), 2);
        const double other = std::pow(i - 15 - 0.3 * k, 2) + std::pow(j - 12 + 0.3 * k, 2);
        const double ball = std::pow(i - 7, 2) + std::pow(j - 14, 2) + std::pow(1.5 * (k - 9), 2);
        values.push_back(
            static_cast<float>(120 * bump(tube, 2.5) + 150 * bump(other, 2.2) + 190 * bump(ball, 4)));
      }
  return volumeOf(info, values);
}

}  // namespace vernier::test
