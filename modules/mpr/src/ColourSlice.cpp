// SPDX-License-Identifier: GPL-3.0-or-later
#include "ColourSlice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/base/Threads.h"

namespace vernier::mpr {

Result<void> drawColourSlice(const SliceParams& p, Images& images, std::stop_token stop,
                             const DrawGrey& draw) {
  const std::size_t pixels = images.depth.size();
  const int channels = p.volume->info().channels;
  std::vector<std::vector<float>> values;
  native::SliceJob job = jobOf(p);
  job.invert = false;
  Images one;
  for (int c = 0; c < channels; ++c) {
    one.allocate(p.view.width_px, p.view.height_px, true);
    one.counters = {};
    job.volume = &p.volume->channel(c);
    if (Result<void> done = draw(job, one, stop); !done) return done;
    images.counters += one.counters;
    values.push_back(std::move(one.values));
  }
  std::copy(one.depth.begin(), one.depth.end(), images.depth.begin());
  const float background[3] = {static_cast<float>(p.background.r), static_cast<float>(p.background.g),
                               static_cast<float>(p.background.b)};
  parallelFor(pixels, std::size_t{1} << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      float* const out = &images.colour[4 * n];
      const bool data = !std::isnan(values[0][n]);
      const float alpha = !data ? 0.0f : channels == 4 ? values[3][n] / 255.0f : 1.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        float v = data ? values[c][n] / 255.0f : 0.0f;
        if (p.invert) v = 1.0f - v;
        out[c] = alpha * v + (1.0f - alpha) * background[c];
      }
      out[3] = 1.0f;
      if (!images.values.empty()) images.values[n] = std::numeric_limits<float>::quiet_NaN();
    }
  });
  return {};
}

}  // namespace vernier::mpr
