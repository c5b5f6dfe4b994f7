// SPDX-License-Identifier: GPL-3.0-or-later
#include "Enlarge.h"

#include <algorithm>
#include <cmath>

#include "vernier/base/Threads.h"

namespace vernier::ui {
namespace {

constexpr int kOne = 256;

// Where a row or a column of the result lies between two of the small picture.
struct Between {
  int first = 0, second = 0;
  int part = 0;  // of the second, in 1/256
};

std::vector<Between> places(int small, double perPixel, int large) {
  std::vector<Between> all(static_cast<std::size_t>(large));
  for (int n = 0; n < large; ++n) {
    const double at = (n + 0.5 - 0.5 * large) / perPixel + 0.5 * small - 0.5;
    const double inside = std::clamp(at, 0.0, static_cast<double>(small - 1));
    const int first = static_cast<int>(inside);
    all[static_cast<std::size_t>(n)] = {first, std::min(first + 1, small - 1),
                                        static_cast<int>(std::lround((inside - first) * kOne))};
  }
  return all;
}

}  // namespace

Picture enlarged(const Picture& small, double perPixel, int width, int height) {
  Picture out(width, height);
  const std::vector<Between> columns = places(small.width, perPixel, width);
  const std::vector<Between> rows = places(small.height, perPixel, height);
  parallelFor(static_cast<std::size_t>(height), 32, [&](std::size_t begin, std::size_t end) {
    std::vector<int> mixed(3 * static_cast<std::size_t>(small.width));  // two rows, in 1/256
    for (std::size_t y = begin; y < end; ++y) {
      const std::uint8_t* const a = small.at(0, rows[y].first);
      const std::uint8_t* const b = small.at(0, rows[y].second);
      const int part = rows[y].part;
      for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i] = a[i] * (kOne - part) + b[i] * part;
      std::uint8_t* to = out.at(0, static_cast<int>(y));
      for (const Between& c : columns) {
        const int* const p = &mixed[3 * static_cast<std::size_t>(c.first)];
        const int* const q = &mixed[3 * static_cast<std::size_t>(c.second)];
        for (int k = 0; k < 3; ++k)
          *to++ = static_cast<std::uint8_t>((p[k] * (kOne - c.part) + q[k] * c.part + kOne * kOne / 2) /
                                            (kOne * kOne));
      }
    }
  });
  return out;
}

}  // namespace vernier::ui
