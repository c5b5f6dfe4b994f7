// SPDX-License-Identifier: GPL-3.0-or-later
#include "VisibleBricks.h"

#include <algorithm>
#include <cmath>

#include "ProjectionBounds.h"
#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

constexpr int kMostEdge = 8;  // of a box, in bricks

// One flag per brick of a level.
struct Flags {
  std::array<std::int32_t, 3> size{};
  std::vector<std::uint8_t> set;
  explicit Flags(const std::array<std::int32_t, 3>& n)
      : size(n),
        set(static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) *
            static_cast<std::size_t>(n[2])) {}
  std::uint8_t& at(std::int32_t x, std::int32_t y, std::int32_t z) {
    return set[static_cast<std::size_t>(x) +
               static_cast<std::size_t>(size[0]) *
                   (static_cast<std::size_t>(y) +
                    static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(z))];
  }
};

template <class Fn>
void eachBrick(const Flags& f, Fn&& fn) {
  for (std::int32_t z = 0; z < f.size[2]; ++z)
    for (std::int32_t y = 0; y < f.size[1]; ++y)
      for (std::int32_t x = 0; x < f.size[0]; ++x) fn(x, y, z);
}

// Calls fn for the up to eight bricks that a brick of the next level is made of.
template <class Fn>
void eachPart(Flags& fine, std::int32_t x, std::int32_t y, std::int32_t z, Fn&& fn) {
  for (std::int32_t k = 2 * z; k < std::min(2 * z + 2, fine.size[2]); ++k)
    for (std::int32_t j = 2 * y; j < std::min(2 * y + 2, fine.size[1]); ++j)
      for (std::int32_t i = 2 * x; i < std::min(2 * x + 2, fine.size[0]); ++i) fn(fine.at(i, j, k));
}

// Flags that are full of set ones; these are taken away from the finer level.
Flags joined(Flags& fine) {
  Flags out({(fine.size[0] + 1) / 2, (fine.size[1] + 1) / 2, (fine.size[2] + 1) / 2});
  eachBrick(out, [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    bool all = true;
    eachPart(fine, x, y, z, [&](std::uint8_t set) { all &= set != 0; });
    if (!all) return;
    out.at(x, y, z) = 1;
    eachPart(fine, x, y, z, [](std::uint8_t& set) { set = 0; });
  });
  return out;
}

void addBoxes(Flags& f, int edge, std::vector<BrickBox>& out) {
  eachBrick(f, [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    if (!f.at(x, y, z)) return;
    const auto u = [edge](std::int32_t v) { return static_cast<std::uint16_t>(v * edge); };
    out.push_back({u(x), u(y), u(z), static_cast<std::uint16_t>(edge)});
  });
}

// All bricks of a level, joined as far as they go.
void addJoined(Flags flags, std::vector<BrickBox>& out) {
  int edge = 1;
  for (; edge < kMostEdge; edge *= 2) {
    Flags next = joined(flags);
    addBoxes(flags, edge, out);
    flags = std::move(next);
  }
  addBoxes(flags, edge, out);
}

// Visible or not: a bin of steps that a visible brick marks may reach into its neighbours too.
void addHoles(const ProjectionBounds& bounds, VisibleBricks& out) {
  if (bounds.holes.empty()) return;
  Flags near(bounds.fine.size);
  eachBrick(near, [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    if (!(bounds.holes[bounds.fine.index(x, y, z)] > 0)) return;
    // A gradient reads one voxel further.
    for (std::int32_t k = std::max(z - 1, 0); k <= std::min(z + 1, near.size[2] - 1); ++k)
      for (std::int32_t j = std::max(y - 1, 0); j <= std::min(y + 1, near.size[1] - 1); ++j)
        for (std::int32_t i = std::max(x - 1, 0); i <= std::min(x + 1, near.size[0] - 1); ++i)
          near.at(i, j, k) = 1;
  });
  addJoined(std::move(near), out.holes);
}

template <class IsVisible>
std::shared_ptr<const VisibleBricks> bricksOf(const ProjectionBounds& bounds, IsVisible&& isVisible) {
  Flags flags(bounds.fine.size);
  parallelFor(flags.set.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      flags.set[n] = isVisible(bounds.fine.least[n], bounds.fine.greatest[n]) ? 1 : 0;
  });
  auto out = std::make_shared<VisibleBricks>();
  out->size = bounds.fine.size;
  addHoles(bounds, *out);
  addJoined(std::move(flags), out->boxes);
  return out;
}

}  // namespace

std::shared_ptr<const VisibleBricks> visibleBricks(const ProjectionBounds& bounds, const TransferFunction& f,
                                                   const Volume::Range& range, int entries) {
  const auto intervals = static_cast<std::size_t>(std::max(entries, 2) - 1);
  const double width = (range.max - range.min) / static_cast<double>(intervals);
  std::vector<std::uint32_t> before(intervals + 1);  // how many intervals before this one show anything
  for (std::size_t n = 0; n < intervals; ++n) {
    const double from = range.min + width * static_cast<double>(n);
    before[n + 1] = before[n] + (greatestOpacity(f, from, from + 1.0000001 * width) > 0 ? 1 : 0);
  }
  const bool seenBelow = opacityAt(f, range.min) > 0, seenAbove = opacityAt(f, range.max) > 0;
  // A reader interpolates between entries, in float: one more on both sides. Beyond the ends these hold.
  const double last = static_cast<double>(intervals);
  return bricksOf(bounds, [&](float least, float greatest) {
    if (!(least <= greatest)) return false;
    const double low = (static_cast<double>(least) - range.min) / width - 1;
    const double high = (static_cast<double>(greatest) - range.min) / width + 1;
    if ((low < 0 && seenBelow) || (high > last && seenAbove)) return true;
    if (high <= 0 || low >= last) return false;
    const auto from = static_cast<std::size_t>(std::max(low, 0.0));
    const auto to = static_cast<std::size_t>(std::ceil(std::min(high, last)));
    return before[to] > before[from];
  });
}

std::shared_ptr<const VisibleBricks> bricksReaching(const ProjectionBounds& bounds, double level) {
  return bricksOf(bounds, [level](float least, float greatest) {
    return least <= greatest && static_cast<double>(greatest) >= level;
  });
}

std::uint64_t bytesOf(const VisibleBricks& v) { return sizeof(BrickBox) * (v.boxes.size() + v.holes.size()); }

}  // namespace vernier::native
