// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Quantise.h"

#include "vernier/base/Threads.h"

namespace vernier {

Picture quantise(const Images& images) {
  Picture out;
  out.width = images.width;
  out.height = images.height;
  const std::size_t n = images.colour.size() / 4;
  out.pixels.resize(3 * n);
  parallelFor(n, 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float* in = &images.colour[4 * i];
      std::uint8_t* to = &out.pixels[3 * i];
      if (std::isnan(in[0]) || std::isnan(in[1]) || std::isnan(in[2]))
        to[0] = kMarker.r, to[1] = kMarker.g, to[2] = kMarker.b;
      else
        to[0] = quantise(in[0]), to[1] = quantise(in[1]), to[2] = quantise(in[2]);
    }
  });
  return out;
}

}  // namespace vernier
