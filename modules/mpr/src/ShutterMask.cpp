// SPDX-License-Identifier: GPL-3.0-or-later
// DICOM PS3.3 C.7.6.11: what lies outside of any shape is covered; places count from 1.
#include <algorithm>

#include "ImageParams.h"
#include "vernier/base/Threads.h"

namespace vernier::mpr {
namespace {

// The parts of the line y = row that lie in the polygon (even-odd), edges included.
std::vector<glm::dvec2> spansOf(const std::vector<glm::dvec2>& polygon, double row) {
  std::vector<double> crossings;
  std::vector<glm::dvec2> spans;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const glm::dvec2 a = polygon[n], b = polygon[(n + 1) % polygon.size()];
    if (a.y == b.y) {
      if (a.y == row) spans.push_back({std::min(a.x, b.x), std::max(a.x, b.x)});
      continue;
    }
    if (row < std::min(a.y, b.y) || row > std::max(a.y, b.y)) continue;
    const double x = a.x + (row - a.y) / (b.y - a.y) * (b.x - a.x);
    if (row == std::max(a.y, b.y))
      spans.push_back({x, x});
    else
      crossings.push_back(x);
  }
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t n = 0; n + 1 < crossings.size(); n += 2) spans.push_back({crossings[n], crossings[n + 1]});
  return spans;
}

}  // namespace

std::vector<std::uint8_t> shutterMask(const Shutter& s, std::int64_t columns, std::int64_t rows,
                                      double rowPerColumn) {
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(columns * rows), 0);
  parallelFor(static_cast<std::size_t>(rows), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      std::uint8_t* const out = mask.data() + j * static_cast<std::size_t>(columns);
      const double row = static_cast<double>(j) + 1;
      const std::vector<glm::dvec2> spans =
          s.polygon.empty() ? std::vector<glm::dvec2>() : spansOf(s.polygon, row);
      for (std::int64_t i = 0; i < columns; ++i) {
        const double column = static_cast<double>(i) + 1;
        bool seen = true;
        if (s.rectangle)
          seen = column >= s.rectangle->left && column <= s.rectangle->right && row >= s.rectangle->upper &&
                 row <= s.rectangle->lower;
        if (s.circle) {
          const glm::dvec2 d((column - s.circle->centre.x), (row - s.circle->centre.y) * rowPerColumn);
          seen = seen && glm::dot(d, d) <= s.circle->radius * s.circle->radius;
        }
        if (!s.polygon.empty())
          seen = seen && std::any_of(spans.begin(), spans.end(),
                                     [&](glm::dvec2 span) { return column >= span.x && column <= span.y; });
        out[i] = seen ? 0 : 1;
      }
    }
  });
  return mask;
}

}  // namespace vernier::mpr
