// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Colour.h"

#include <algorithm>
#include <cmath>

namespace vernier {

glm::dvec3 rgbOf(ColourSpace space, const std::array<double, 3>& s, std::uint32_t bits,
                 const Palette* palette) {
  if (space == ColourSpace::Palette) {
    const auto& e = palette->at(s[0]);
    return glm::dvec3(e[0], e[1], e[2]) / palette->fullScale;
  }
  const double full = std::exp2(bits) - 1, step = std::exp2(static_cast<int>(bits) - 8);
  glm::dvec3 rgb(s[0], s[1], s[2]);
  if (space == ColourSpace::YbrFull || space == ColourSpace::YbrPartial) {
    const double cb = s[1] - 128 * step, cr = s[2] - 128 * step;
    if (space == ColourSpace::YbrFull) {
      rgb = {s[0] + 1.402 * cr, s[0] - 0.344136 * cb - 0.714136 * cr, s[0] + 1.772 * cb};
    } else {
      const double y = 1.164384 * (s[0] - 16 * step);
      rgb = {y + 1.596027 * cr, y - 0.391762 * cb - 0.812968 * cr, y + 2.017232 * cb};
    }
  }
  return glm::clamp(rgb / full, glm::dvec3(0), glm::dvec3(1));
}

}  // namespace vernier
