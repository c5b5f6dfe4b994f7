// SPDX-License-Identifier: GPL-3.0-or-later
// The rays that meet a lens, cut into parts: how the techniques that draw one picture with lenses meet. A ray
// is cut by the region that takes part (keptRegion, near distance), by lenses and by tools. Between two cuts
// one appearance rules: 0 is the layer of the scene that looks through the volume, n the inside of the n-th
// lens of the plan; where lenses overlap the later one. Parts inside a lens that shows nothing are drawn by
// nobody: they stay as they are, and let all through.
//
// A plan with lenses: the rays are cut; the outside draws each ray that meets no lens, as it always does, and
// the first of its parts on the others; each lens draws its parts; the outside draws the rest; all is joined.
// What a pass draws of a part stands in the part, so that the order of passes is for speed alone: light that
// an earlier part has used up need not be looked for behind it.
//
// Joining (Accumulator): ordered parts and tools go front to back, C += T c, T *= t. Commuting ones have been
// gathered by their pass over all parts of their appearance on the ray, each weighted by what the tools
// before it let through, and stand in the first of them; of Attenuation each part says what it lets through,
// unweighted, and what reaches the eye of a tool is weakened by the parts before it. They are the background
// of the ordered ones:
//   C + S * K, S the product of t over ordered parts alone, K of the gathered ones with E, what ends the ray
//   (an opaque tool's colour, else 0), after W, what all tools let through:
//   Max: max(all, W E) in each channel, without a tool max(all, W times the least of shells); where shells
//   that replace an opaque tool are covered, E = 0; Min: max(least of all, W E); Mean and other mixtures: the
//   last in the scene's order, max(that, W E); Sum: sum of all + W E (E the background without a tool);
//   Attenuation: product of all times W E (E = 1 without a tool).
// Without any covered: C + T E, E the scene's background without a tool, or the least of shells outside where
// that is brighter.
//
// Appearances drawn together (RaysOfPass::Together): where all of them are ordered and one pass can draw
// them in one walk along each ray, rays are not cut into parts. That pass is told where the lines of all
// pixels enter and leave each lens, changes the appearance there, and writes the whole picture.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "vernier/base/Api.h"

namespace vernier {

enum class Accumulator { Ordered, Max, Min, Mean, Sum, Attenuation };

struct RaySegment {
  // Instead of an appearance: a translucent tool (its own colour, weighted by its opacity, and what it lets
  // through), and the opaque one that ends the ray (its colour).
  static constexpr std::int16_t kTool = -1, kEnd = -2;
  float from_mm = 0, to_mm = 0;  // along the pixel's ray, from the lattice's origin
  std::int16_t appearance = 0;
  // The end is a lens face or a tool: samples beyond it belong to the neighbour. Else it is the border of the
  // region that takes part.
  bool beginsInside = false, endsInside = false;
  bool covered = false;  // of commuting ones: something has been gathered
  float weight = 1;      // what the tools before it let through
  std::array<float, 3> colour{0, 0, 0};
  float through = 1;
  float depth_mm = 0;  // ordered: where the opacity of all up to there passes 0.5; commuting: of what is seen
  bool hasDepth = false;
};

// mm along a ray from the lattice's origin. Empty: entry > exit.
struct RaySpan {
  double entry_mm = 0, exit_mm = -1;
  bool empty() const { return !(entry_mm <= exit_mm); }
};

// Where the lines of all pixels enter and leave one lens, mm; empty (entry > exit) where they miss it. Lines,
// not rays: a lens around the eye is entered at a negative distance.
struct LensSpans {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels outside [x0, x1) x [y0, y1) miss the lens
  std::vector<RaySpan> spans;          // of those inside, row by row
  // Null where no pixel has an entry.
  const RaySpan* at(int x, int y) const {
    if (x < x0 || x >= x1 || y < y0 || y >= y1) return nullptr;
    return spans.data() + static_cast<std::ptrdiff_t>(y - y0) * (x1 - x0) + (x - x0);
  }
};

struct VERNIER_API RayIntervals {
  int width = 0, height = 0;
  std::vector<std::uint32_t> first;  // of each pixel, one more than there are pixels; row 0 on top
  std::vector<RaySegment> segments;  // nearest first
  // Of appearances drawn together, instead of parts: of each lens, in the scene's order.
  std::vector<LensSpans> lenses;
  // What the passes of one appearance make once and use again, by a number that says what it is made of and
  // the step; theirs alone.
  std::map<std::pair<std::uint64_t, double>, std::shared_ptr<const void>> shared;

  std::span<RaySegment> of(std::size_t pixel) {
    return {segments.data() + first[pixel], segments.data() + first[pixel + 1]};
  }
  std::span<const RaySegment> of(std::size_t pixel) const {
    return {segments.data() + first[pixel], segments.data() + first[pixel + 1]};
  }
  bool meetsLens(std::size_t pixel) const { return first[pixel] != first[pixel + 1]; }
  // What parts and tools before `segment`, an index into `segments`, let through, as far as they are drawn.
  float lightBefore(std::size_t pixel, std::size_t segment) const;
};

// What a pass draws of a picture with lenses.
struct RaysOfPass {
  // Plain: every ray, there are no lenses. First: the appearance's first part on each ray. Rest: its other
  // parts. All: all of them. Who draws appearance 0, but for its rest, draws the rays that meet no lens too.
  // Together: every ray, with all appearances on it.
  enum class Which { Plain, First, Rest, All, Together };
  Which which = Which::Plain;
  std::int16_t appearance = 0;
  friend bool operator==(const RaysOfPass&, const RaysOfPass&) = default;
  bool drawsPlainRays() const { return appearance == 0 && which != Which::Rest; }
};

// Indices into RayIntervals::segments of what the pass draws on a pixel, nearest first: calls fn(index).
// Passes that gather draw all parts of their appearance at once.
template <class Fn>
void eachSegment(const RayIntervals& rays, std::size_t pixel, const RaysOfPass& pass, Fn&& fn) {
  bool seen = false;
  for (std::size_t n = rays.first[pixel]; n < rays.first[pixel + 1]; ++n) {
    if (rays.segments[n].appearance != pass.appearance) continue;
    const bool isFirst = !seen;
    seen = true;
    if (pass.which == RaysOfPass::Which::Rest && isFirst) continue;
    if (pass.which == RaysOfPass::Which::First && !isFirst) continue;
    fn(n);
  }
}

// For engines that draw whole pictures: the round-th part (from 0) that the pass draws of each pixel. `from`
// > `to` where there is none; `segment` -1.
struct RayRound {
  std::vector<float> from_mm, to_mm;
  std::vector<std::int32_t> segment;
  bool any = false;
};
VERNIER_API RayRound roundOf(const RayIntervals&, const RaysOfPass&, int round);

}  // namespace vernier
