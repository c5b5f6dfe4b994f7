// SPDX-License-Identifier: GPL-3.0-or-later
// Which steps of which rays may show anything: visible bricks, projected onto packets of 4 x 4 pixels and
// bins of steps along the rays. Whatever a ray's sample in an unmarked bin reads is transparent. Made for
// each picture; the same for any number of threads.
#pragma once
#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "VisibleBricks.h"
#include "vernier/plan/RayIntervals.h"

namespace vernier::native {

inline constexpr int kPacketEdge_px = 4, kPacketRays = 16;

class BrickMarks {
 public:
  BrickMarks(const VisibleBricks&, const GridGeometry&, const CameraPicture&, double step_mm);

  int words() const { return words_; }
  int stepsPerBin() const { return stepsPerBin_; }
  std::int64_t firstStep() const { return firstStep_; }  // of bin 0
  const std::uint64_t* seen(int packetX, int packetY) const { return seen_.data() + at(packetX, packetY); }
  // Bins with no-data about; null where there are none at all.
  const std::uint64_t* holes(int packetX, int packetY) const {
    return holes_.empty() ? nullptr : holes_.data() + at(packetX, packetY);
  }
  bool any(int packetX, int packetY) const {
    const std::uint64_t* w = seen(packetX, packetY);
    for (int n = 0; n < words_; ++n)
      if (w[n]) return true;
    return false;
  }

 private:
  struct Footprint {
    std::int32_t x0, x1, y0, y1;  // packets, both ends in
    std::int32_t bin0, bin1;      // both ends in
  };
  class Projector;
  std::size_t at(int x, int y) const {
    return (static_cast<std::size_t>(x) + static_cast<std::size_t>(across_) * static_cast<std::size_t>(y)) *
           static_cast<std::size_t>(words_);
  }
  void mark(const std::vector<BrickBox>&, const Projector&, std::vector<std::uint64_t>& out) const;
  void put(const Footprint&, int row0, int row1, std::vector<std::uint64_t>& out) const;

  int across_ = 0, down_ = 0, words_ = 1, stepsPerBin_ = 1;
  std::int64_t firstStep_ = 0, bins_ = 0;
  double step_mm_ = 1;
  std::vector<std::uint64_t> seen_, holes_;
};

// The marks of a picture; of one with lenses made once for all its passes, kept beside the cut rays.
std::shared_ptr<const BrickMarks> marksOf(const VisibleBricks&, const GridGeometry&, const CameraPicture&,
                                          double step_mm, RayIntervals*);

// Calls fn(first step, one beyond the last) for each run of marked bins, in order, until it returns false.
template <class Fn>
void eachRun(const std::uint64_t* marks, int words, std::int64_t firstStep, int stepsPerBin, Fn&& fn) {
  const int bits = 64 * words;
  for (int n = 0; n < bits;) {
    const std::uint64_t rest = marks[n / 64] >> (n % 64);
    if (rest == 0) {
      n = (n / 64 + 1) * 64;
      continue;
    }
    n += std::countr_zero(rest);
    int end = n;
    while (end < bits && (marks[end / 64] >> (end % 64) & 1)) ++end;
    if (!fn(firstStep + std::int64_t{stepsPerBin} * n, firstStep + std::int64_t{stepsPerBin} * end)) return;
    n = end;
  }
}

}  // namespace vernier::native
