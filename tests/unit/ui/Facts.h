// SPDX-License-Identifier: GPL-3.0-or-later
// Sources as a study would describe them, without one.
#pragma once
#include "SourceFacts.h"

namespace vernier::ui::test {

// An axial stack: 64 x 48 pixels of 0.5 x 0.5 mm, `slices` slices 2 mm apart, first at z = 10, row to the
// patient's left, column to posterior.
inline GridGeometry axialGrid(std::int64_t slices = 20) {
  GridGeometry g;
  g.columns = 64, g.rows = 48, g.slices = slices;
  g.patientFromVoxel.linear = glm::dmat3(glm::dvec3(0.5, 0, 0), glm::dvec3(0, 0.5, 0), glm::dvec3(0, 0, 2));
  g.patientFromVoxel.translation = {-16, -12, 10};
  return g;
}

inline SourceFacts axialFacts(int document, const std::string& name, const std::string& frame = "1.2.3",
                              const std::string& person = "A", std::int64_t slices = 20) {
  SourceFacts f;
  f.id = {document, name};
  f.title = name;
  f.linkKey = frame + "|" + person;
  f.personKey = person;
  f.grid = axialGrid(slices);
  for (std::int64_t k = 0; k < slices; ++k) {
    ImageFrameInfo info;
    info.columns = 64, info.rows = 48;
    info.pixelSpacing_mm = {0.5, 0.5};
    info.plane = FramePlane{PatientPoint(-16, -12, 10 + 2 * static_cast<double>(k)), PatientVec(1, 0, 0),
                            PatientVec(0, 1, 0)};
    info.index = k, info.count = slices;
    f.frames.push_back(info);
    f.files.push_back("slice" + std::to_string(k) + ".dcm");
  }
  return f;
}

}  // namespace vernier::ui::test
