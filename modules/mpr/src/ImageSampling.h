// SPDX-License-Identifier: GPL-3.0-or-later
// What grey and colour frames share when they are drawn: which samples of the frame lie beside a pixel, and
// the frame's lines, converted once while neighbouring picture rows need them.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace vernier::mpr {

// One direction of the picture: which two samples of the frame lie beside a pixel, and the weight of the
// second.
struct Beside {
  std::int64_t first = -1, second = -1;  // -1: outside
  double t = 0;
};

inline std::vector<Beside> besides(int pixels, double start_px, double pxPerSample, std::int64_t n,
                                   bool nearest) {
  // A picture's edge that falls on a pixel centre stays in, whatever its rounding.
  constexpr double kEdge = 1e-9;
  std::vector<Beside> out(static_cast<std::size_t>(pixels));
  const double last = static_cast<double>(n - 1);
  for (int i = 0; i < pixels; ++i) {
    const double at = (i + 0.5 - start_px) / pxPerSample - 0.5;
    if (!(at >= -0.5 - kEdge && at <= last + 0.5 + kEdge)) continue;
    // Rounding of the zoom must not turn a pixel centre into a blend with its neighbour.
    const double snapped = std::abs(at - std::nearbyint(at)) < kEdge ? std::nearbyint(at) : at;
    const double held = std::clamp(nearest ? std::floor(snapped + 0.5) : snapped, 0.0, last);
    Beside& b = out[static_cast<std::size_t>(i)];
    b.first = static_cast<std::int64_t>(std::floor(held));
    b.second = std::min(b.first + 1, n - 1);
    b.t = held - std::floor(held);
  }
  return out;
}

// The lines above and below a picture row. Fill: (line, Value* out) writes the places that the picture shows,
// out[n] for place n, at most `last`.
template <class Value, class Fill>
class KeptLines {
 public:
  KeptLines(std::int64_t last, Fill fill) : last_(last), fill_(std::move(fill)) {}

  // Valid until the line after next is asked for.
  const Value* line(std::int64_t number) {
    for (const Kept& k : kept_)
      if (k.number == number) return k.values.data();
    Kept& k = kept_[next_];
    next_ = 1 - next_;
    k.number = number;
    k.values.resize(static_cast<std::size_t>(last_ + 1));
    fill_(number, k.values.data());
    return k.values.data();
  }

 private:
  struct Kept {
    std::int64_t number = -1;
    std::vector<Value> values;
  };
  std::int64_t last_;
  Fill fill_;
  Kept kept_[2];
  std::size_t next_ = 0;
};

}  // namespace vernier::mpr
