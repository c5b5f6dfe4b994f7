// SPDX-License-Identifier: GPL-3.0-or-later
#include "Outlines.h"

#include <algorithm>
#include <cmath>

namespace vernier::dvr {
namespace {

constexpr double kHalfWidth_px = 0.75;
constexpr double kNear_mm = 0.01;  // lines are cut here before the eye

void drawLine(Images& images, glm::dvec2 a, glm::dvec2 b, const LineColour& colour) {
  const auto first = [](double v) { return static_cast<int>(std::floor(v - kHalfWidth_px - 1)); };
  const auto last = [](double v) { return static_cast<int>(std::ceil(v + kHalfWidth_px + 1)); };
  if (!(std::abs(a.x) + std::abs(a.y) + std::abs(b.x) + std::abs(b.y) < 1e7)) return;
  const glm::dvec2 d = b - a;
  const double square = std::max(glm::dot(d, d), 1e-12);
  for (int y = std::max(0, first(std::min(a.y, b.y)));
       y <= std::min(images.height - 1, last(std::max(a.y, b.y))); ++y)
    for (int x = std::max(0, first(std::min(a.x, b.x)));
         x <= std::min(images.width - 1, last(std::max(a.x, b.x))); ++x) {
      const glm::dvec2 p(x + 0.5, y + 0.5);
      const double t = std::clamp(glm::dot(p - a, d) / square, 0.0, 1.0);
      const double cover =
          std::clamp(kHalfWidth_px + 0.5 - glm::length(p - a - t * d), 0.0, 1.0) * colour.opacity;
      if (!(cover > 0)) continue;
      float* const pixel =
          images.colour.data() + 4 * (static_cast<std::size_t>(x) +
                                      static_cast<std::size_t>(images.width) * static_cast<std::size_t>(y));
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<float>(std::lerp(static_cast<double>(pixel[c]), colour.rgb[c], cover));
    }
}

}  // namespace

void drawOutline(Images& images, const Outline& outline, const LineColour& colour) {
  for (std::size_t n = 0; n < outline.size(); ++n)
    drawLine(images, outline[n], outline[(n + 1) % outline.size()], colour);
}

void drawBox(Images& images, glm::dvec3 least, glm::dvec3 greatest, const CameraPicture& camera,
             const PatientFromVoxel& toPatient) {
  const glm::dmat4 pixelFromVoxel = camera.pixelFromPatient() * toPatient.matrix();
  const auto at = [&](int n) {
    return pixelFromVoxel * glm::dvec4(n & 1 ? greatest.x : least.x, n & 2 ? greatest.y : least.y,
                                       n & 4 ? greatest.z : least.z, 1);
  };
  for (int n = 0; n < 8; ++n)
    for (const int bit : {1, 2, 4}) {
      if (n & bit) continue;
      glm::dvec4 a = at(n), b = at(n | bit);
      // w is the depth in perspective, 1 else.
      if (!(std::max(a.w, b.w) > kNear_mm)) continue;
      if (a.w < kNear_mm) a = glm::mix(a, b, (kNear_mm - a.w) / (b.w - a.w));
      if (b.w < kNear_mm) b = glm::mix(b, a, (kNear_mm - b.w) / (a.w - b.w));
      drawLine(images, glm::dvec2(a) / a.w, glm::dvec2(b) / b.w, kSlabLines);
    }
}

}  // namespace vernier::dvr
