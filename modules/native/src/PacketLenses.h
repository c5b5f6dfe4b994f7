// SPDX-License-Identifier: GPL-3.0-or-later
// Appearances drawn together (RayIntervals.h): lenses on the rays of one packet, the parts that they cut a
// ray into, and where the packet may show anything.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "VolumeFast.h"
#include "vernier/plan/RayIntervals.h"

namespace vernier::native {

// False when no ray meets a lens.
inline bool setLenses(const std::vector<LensSpans>& lenses, int x0, int y0, PacketLenses& out) {
  bool any = false;
  out.count = static_cast<int>(lenses.size());
  for (std::size_t k = 0; k < lenses.size(); ++k)
    for (int n = 0; n < kPacketRays; ++n) {
      const RaySpan* const s = lenses[k].at(x0 + n % kPacketEdge_px, y0 + n / kPacketEdge_px);
      out.entry_mm[k][n] = s ? s->entry_mm : 1, out.exit_mm[k][n] = s ? s->exit_mm : -1;
      any = any || out.entry_mm[k][n] < out.exit_mm[k][n];
    }
  return any;
}

// Calls fn(appearance, from_mm, to_mm) for the parts of ray n, nearest first.
template <class Fn>
void eachPart(const RayPacket& p, int n, Fn&& fn) {
  const double end = p.to_mm[n];
  int appearance = 0;
  for (double from = p.from_mm[n], next = end; from < end; from = next) {
    appearance = 0, next = end;
    for (int k = 0; p.lenses && k < p.lenses->count; ++k) {
      const double in = p.lenses->entry_mm[k][n], out = p.lenses->exit_mm[k][n];
      if (!(in < out)) continue;
      if (in <= from && from < out) appearance = k + 1;
      if (in > from) next = std::min(next, in);
      if (out > from) next = std::min(next, out);
    }
    fn(appearance, from, next);
  }
}

// Where a packet with lenses may show anything: bins of the outside beside the lenses, of each lens within.
// `seen`: of each appearance, null where it shows nothing.
class LensedMarks {
 public:
  const std::uint64_t* of(const RayPacket& p, const RayMarks& bins, double step_mm,
                          const std::vector<const std::uint64_t*>& seen) {
    const auto words = static_cast<std::size_t>(bins.words);
    words_.assign(words, 0);
    if (seen[0]) std::copy_n(seen[0], words, words_.begin());
    for (int k = 0; k < p.lenses->count; ++k) {
      const double* const entry = p.lenses->entry_mm[k];
      const double* const exit = p.lenses->exit_mm[k];
      double first = 1e300, last = -1e300, allIn = -1e300, allOut = 1e300;
      bool all = true;
      for (int n = 0; n < kPacketRays; ++n) {
        if (!(p.to_mm[n] > p.from_mm[n])) continue;
        if (!(entry[n] < exit[n])) {
          all = false;
          continue;
        }
        first = std::min(first, entry[n]), last = std::max(last, exit[n]);
        allIn = std::max(allIn, entry[n]), allOut = std::min(allOut, exit[n]);
      }
      if (!(first < last)) continue;
      const double bin_mm = step_mm * bins.stepsPerBin,
                   begin = static_cast<double>(bins.firstStep) / bins.stepsPerBin;
      const auto bin = [&](double t) { return t / bin_mm - begin; };
      if (all && allIn < allOut)
        eachBit(std::ceil(bin(allIn)), std::floor(bin(allOut)),
                [&](std::size_t w, std::uint64_t bits) { words_[w] &= ~bits; });
      const std::uint64_t* const inner = seen[static_cast<std::size_t>(k) + 1];
      if (inner)
        eachBit(std::floor(bin(first)), std::ceil(bin(last)),
                [&](std::size_t w, std::uint64_t bits) { words_[w] |= inner[w] & bits; });
    }
    return words_.data();
  }

 private:
  // Bits [from, to).
  template <class Fn>
  void eachBit(double from, double to, Fn&& fn) {
    const double most = 64.0 * static_cast<double>(words_.size());
    const auto a = static_cast<std::size_t>(std::clamp(from, 0.0, most)),
               b = static_cast<std::size_t>(std::clamp(to, 0.0, most));
    for (std::size_t w = a / 64; 64 * w < b; ++w) {
      const std::size_t low = a > 64 * w ? a - 64 * w : 0, high = std::min<std::size_t>(b - 64 * w, 64);
      fn(w, (~std::uint64_t{0} >> (64 - high)) & (~std::uint64_t{0} << low));
    }
  }
  std::vector<std::uint64_t> words_;
};

}  // namespace vernier::native
