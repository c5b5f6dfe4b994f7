// SPDX-License-Identifier: GPL-3.0-or-later
// Grids for tests of plan: every way in which an acquisition can lie along the patient's axes.
#pragma once
#include <string>
#include <vector>

#include "vernier/base/GridGeometry.h"

namespace vernier::test {

struct NamedGrid {
  std::string name;
  GridGeometry grid;
};

// Three acquisition planes x 8 flips of columns, rows and slices (half of them left-handed). All cover the
// same box of patient space: 40 mm along x, 60 along y, 30 along z around (5, -7, 11), with spacings 2, 3 and
// 5 mm there.
inline std::vector<NamedGrid> orthogonalGrids() {
  const glm::dvec3 size_mm{40, 60, 30}, spacing{2, 3, 5}, centre{5, -7, 11};
  const int axesOf[3][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}};
  const char* names[3] = {"axial", "coronal", "sagittal"};
  std::vector<NamedGrid> all;
  for (int plane = 0; plane < 3; ++plane)
    for (int flips = 0; flips < 8; ++flips) {
      GridGeometry g;
      std::int64_t* counts[3] = {&g.columns, &g.rows, &g.slices};
      glm::dvec3 first = centre;
      for (int a = 0; a < 3; ++a) {
        const int patientAxis = axesOf[plane][a];
        const double sign = flips & (1 << a) ? -1 : 1;
        *counts[a] = static_cast<std::int64_t>(size_mm[patientAxis] / spacing[patientAxis]);
        glm::dvec3 step(0);
        step[patientAxis] = sign * spacing[patientAxis];
        g.patientFromVoxel.linear[a] = step;
        first -= step * (0.5 * static_cast<double>(*counts[a] - 1));
      }
      g.patientFromVoxel.translation = first;
      all.push_back({std::string(names[plane]) + " flips " + std::to_string(flips), g});
    }
  return all;
}

}  // namespace vernier::test
