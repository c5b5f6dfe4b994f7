// SPDX-License-Identifier: GPL-3.0-or-later
// Layers that look through a volume against 20,000 small steps along each of 100 rays, in long double, with
// the planner's camera, region and ramp: nothing here is the reference's own. Random grids, cameras outside
// and inside, cuts, windows, and two tools.
#include <array>
#include <cmath>

#include "VolumeBrute.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

constexpr int kSteps = 20000;

// What the steps of a ray come to, weighed with what the translucent tool leaves.
struct Steps {
  Real length = 0, seen = 0, value = 0, max = 0, min = 1, emission = 0, emissionSeen = 0, emissionBefore = 0;
  Real crossings = 0, greatest = 0;
  bool reachesLevel = false;
};

struct Brute : BruteRay {
  // Of the first layer, a projection, or shells when given: its levels.
  Steps walk(const VoiRamp& window, double cue, const ShellsLayer* shells) const {
    Steps all;
    const Real step = (static_cast<Real>(to) - from) / kSteps;
    std::size_t inside = 0;
    const auto bright = [&](Real phi, Real t) {
      const Real z = std::clamp(static_cast<Real>(ramp.at(static_cast<double>(t) / perDepth)), 0.0L, 1.0L);
      const Real left = t > translucent.t ? 1 - translucent.alpha : 1;
      return left * phi *
             (shells ? shells->beta0 + shells->betaM * (shells->a * z + shells->b) : 1 - cue + cue * z);
    };
    const auto grey = [&](Real v) {
      return std::clamp((v - window.lo) / (window.hi - window.lo), 0.0L, 1.0L);
    };
    const auto passTo = [&](std::size_t now, Real t) {
      for (; inside < now; ++inside) all.crossings += bright(grey(shells->levels[inside]), t);
      for (; inside > now; --inside) all.crossings += bright(grey(shells->levels[inside - 1]), t);
    };
    for (int n = 0; n < kSteps; ++n) {
      const Real t = from + (n + 0.5L) * step;
      const Real v = valueAt(voxelAt(t));
      if (std::isnan(v)) {
        if (shells) passTo(0, t);
        continue;
      }
      const Real left = t > translucent.t ? 1 - translucent.alpha : 1, g = grey(v);
      all.length += step, all.seen += left * step, all.value += v * step;
      all.greatest = std::max(all.greatest, bright(g, t));
      all.min = std::min(all.min, left * g);
      all.emission += g * step, all.emissionSeen += left * g * step;
      if (t <= translucent.t) all.emissionBefore += g * step;
      if (!shells) continue;
      all.reachesLevel = all.reachesLevel || v >= shells->levels.front();
      std::size_t now = 0;
      while (now < shells->levels.size() && v >= shells->levels[now]) ++now;
      passTo(now, t);
    }
    if (shells && !endsAtTool) passTo(0, to);
    return all;
  }
};

// Red of the pixel: the tools are red.
struct Behind {
  Real own = 0, left = 1, opaque = 0;
  bool hasOpaque = false;
};
Behind behindOf(const Brute& b) {
  Behind out;
  if (b.translucent.t < b.opaque.t)
    out.own = b.translucent.alpha * b.translucent.shade, out.left -= b.translucent.alpha;
  out.hasOpaque = b.opaque.t < 1e29L;
  if (out.hasOpaque) out.opaque = out.left * b.opaque.shade;
  return out;
}

TEST(VolumeBruteForce, ProjectionsOfHundredRays) {
  constexpr double gain = 0.3;
  int compared = 0, withTools = 0;
  for (std::uint64_t n = 0; n < 400 && compared < 100; ++n) {
    ProjectionLayer layer;
    layer.source = "v";
    layer.gain_perMm = gain;
    layer.window = VoiWindow{0.5, 0.4 + randomUnit(5, n), VoiFunction::LinearExact, ""};
    BruteCase c = randomCase(n, layer);
    const Brute brute{bruteOf(c)};
    if (!(brute.to - brute.from > 0.05)) continue;
    const Behind behind = behindOf(brute);
    const VoiRamp window = rampOf(*layer.window);
    const std::size_t pixel = static_cast<std::size_t>(c.pixelX) + 40 * static_cast<std::size_t>(c.pixelY);
    const double cue = n % 2 ? 0.8 : 0;
    const Steps truth = brute.walk(window, cue, nullptr);
    if (truth.length < 0.01) continue;
    ++compared;
    withTools += behind.own > 0 || behind.hasOpaque;
    SCOPED_TRACE("ray " + std::to_string(n));
    const auto red = [&](ProjectionMode mode) {
      c.s.projection().mode = mode;
      c.s.projection().cue = mode == ProjectionMode::Max ? cue : 0;
      const ReferencePixel p = pixelOf(c.s, pixel);
      EXPECT_TRUE(p.covered);
      return p.rgba.x;
    };
    // A step of 1e-4 of the ray misses a maximum that the field has with a slope, at a jump, by 1e-3 at most.
    const Real max = behind.own + std::max(truth.greatest, behind.opaque);
    EXPECT_GE(red(ProjectionMode::Max), static_cast<double>(max) - 1e-12);
    EXPECT_LE(red(ProjectionMode::Max), static_cast<double>(max) + 1e-3);
    const Real min = behind.own + std::max(truth.min, behind.opaque);
    EXPECT_NEAR(red(ProjectionMode::Min), static_cast<double>(min), 1e-3);
    const Real grey =
        std::clamp((truth.value / truth.length - window.lo) / (window.hi - window.lo), 0.0L, 1.0L);
    const Real mean = behind.own + std::max(grey * truth.seen / truth.length, behind.opaque);
    EXPECT_NEAR(red(ProjectionMode::Mean), static_cast<double>(mean), 1e-3);
    const Real sum = behind.own + gain * truth.emissionSeen + behind.opaque;
    EXPECT_NEAR(red(ProjectionMode::Sum), static_cast<double>(sum), 3e-4);
    const Real xray = behind.own * std::exp(-gain * truth.emissionBefore) +
                      std::exp(-gain * truth.emission) * (behind.hasOpaque ? behind.opaque : behind.left);
    EXPECT_NEAR(red(ProjectionMode::Attenuation), static_cast<double>(xray), 3e-4);
  }
  EXPECT_EQ(compared, 100);
  EXPECT_GT(withTools, 20);
}

TEST(VolumeBruteForce, ShellsOfHundredRays) {
  int compared = 0, off = 0;
  for (std::uint64_t n = 0; n < 400 && compared < 100; ++n) {
    ShellsLayer layer;
    layer.source = "v";
    layer.levels = {0.25, 0.4, 0.5, 0.65, 0.8};
    layer.window = unitWindow();
    layer.beta0 = 0.1, layer.a = n % 2 ? 0.6 : 0, layer.b = 0.4;
    BruteCase c = randomCase(n, layer);
    const Brute brute{bruteOf(c)};
    if (!(brute.to - brute.from > 0.05)) continue;
    const Behind behind = behindOf(brute);
    const std::size_t pixel = static_cast<std::size_t>(c.pixelX) + 40 * static_cast<std::size_t>(c.pixelY);
    const Steps truth = brute.walk(rampOf(unitWindow()), 0, &layer);
    if (truth.length < 0.01) continue;
    ++compared;
    SCOPED_TRACE("ray " + std::to_string(n));
    const Real max = behind.own + (behind.hasOpaque && !truth.reachesLevel ? behind.opaque : truth.greatest);
    EXPECT_NEAR(pixelOf(c.s, pixel).rgba.x, static_cast<double>(max), 1e-3);
    c.s.shells().mode = ShellsMode::Sum;
    const Real sum = behind.own + truth.crossings + behind.opaque;
    off += std::abs(pixelOf(c.s, pixel).rgba.x - static_cast<double>(sum)) > 2e-3;
  }
  EXPECT_EQ(compared, 100);
  EXPECT_LE(off, 2);  // two crossings, or a crossing and the tool, within one step
}

}  // namespace
}  // namespace vernier::quality
