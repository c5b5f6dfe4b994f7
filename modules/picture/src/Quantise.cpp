// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Quantise.h"

#include <utility>

#include "QuantiseRuns.h"
#include "vernier/base/Threads.h"

namespace vernier {

Picture quantise(const Images& images, Picture reuse) {
  Picture out = std::move(reuse);
  out.channels = 3;
  out.width = images.width;
  out.height = images.height;
  const std::size_t n = images.colour.size() / 4;
  out.pixels.resize(3 * n);
  parallelFor(n, 1 << 14, [&](std::size_t begin, std::size_t end) {
    quantiseRuns(&images.colour[4 * begin], end - begin, &out.pixels[3 * begin]);
  });
  return out;
}

}  // namespace vernier
