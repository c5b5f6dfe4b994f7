// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses of random faces against many small steps along each of 100 rays, in long double: every step asks
// every face whether it is inside, and steps that a face or a tool divides are halved until nothing is left
// to be divided. The planner's camera and region; nothing here is the reference's own.
#include <algorithm>

#include "VolumeBrute.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;
using Colour = glm::vec<3, Real>;

enum class Kind { Blend, Iso, Max, Min, Mean, Sum, Attenuation, CutOut };
constexpr int kKinds = 8;
constexpr double kGain = 0.2;

struct Look {
  Kind kind = Kind::CutOut;
  TransferFunction transfer;
  double level = 0, width = 1;  // of the window from 0 on
  glm::dvec3 surface{0};
};

Look lookOf(std::uint64_t n, std::uint64_t which, Kind kind) {
  const auto draw = [&](std::uint64_t k) { return randomUnit(700 + n, 100 * which + k); };
  Look l;
  l.kind = kind;
  l.transfer.opacityLength_mm = 0.8;
  l.transfer.colours = {{0.2, {draw(0), draw(1), draw(2)}}, {0.7, {draw(3), draw(4), draw(5)}}};
  l.transfer.opacities = {{0.1 + 0.2 * draw(6), 0}, {0.6, 0.4 * draw(7)}, {0.9, 0.6 * draw(8)}};
  l.level = 0.4 + 0.3 * draw(9), l.width = 0.7 + 0.6 * draw(10);
  l.surface = {draw(11), draw(12), draw(13)};
  return l;
}

template <class Any>
Any layerOf(const Look& l) {
  if (l.kind == Kind::Blend) {
    VolumeLayer v;
    v.source = "v", v.transfer = l.transfer;
    return v;
  }
  if (l.kind == Kind::Iso) {
    IsosurfaceLayer i;
    const Rgb own{l.surface.x, l.surface.y, l.surface.z};
    i.source = "v", i.level = l.level, i.material = {1, 0, 0, 1, own, own};
    return i;
  }
  ProjectionLayer p;
  p.source = "v", p.gain_perMm = kGain;
  p.window = VoiWindow{l.width / 2, l.width, VoiFunction::LinearExact, ""};
  p.mode = l.kind == Kind::Max    ? ProjectionMode::Max
           : l.kind == Kind::Min  ? ProjectionMode::Min
           : l.kind == Kind::Mean ? ProjectionMode::Mean
           : l.kind == Kind::Sum  ? ProjectionMode::Sum
                                  : ProjectionMode::Attenuation;
  return p;
}

// Three to nine random faces around a place near the volume's middle; not always bounded.
std::shared_ptr<const ConvexRegion> randomRegion(std::uint64_t n, std::uint64_t which, glm::dvec3 middle) {
  const auto draw = [&](std::uint64_t k) { return randomUnit(300 + n, 1000 * which + k); };
  auto r = std::make_shared<ConvexRegion>();
  const glm::dvec3 at = middle + 0.8 * glm::dvec3(draw(0) - 0.5, draw(1) - 0.5, draw(2) - 0.5);
  const auto faces = static_cast<std::uint64_t>(3 + 7 * draw(3));
  for (std::uint64_t f = 0; f < faces; ++f) {
    const glm::dvec3 normal =
        glm::normalize(glm::dvec3(draw(4 + 3 * f), draw(5 + 3 * f), draw(6 + 3 * f)) - 0.5);
    r->planes.push_back({PatientVec(normal), glm::dot(normal, at) + 0.1 + 0.5 * draw(40 + f)});
  }
  return r;
}

struct Gathered {
  Real most = 0, least = 1, integral = 0, length = 0, seen = 0, emission = 0, emissionSeen = 0,
       emissionBefore = 0;
};

struct Brute : BruteRay {
  std::vector<Look> looks;  // the outside, then the lenses
  std::vector<std::shared_ptr<const ConvexRegion>> regions;
  Colour background{0};
  bool certain = true;

  Colour toolColour(const BruteTool& tool) const { return Colour(1, 0.5L, 0) * tool.shade; }
  std::size_t appearanceAt(Real t) const {
    const Colour p = Colour(ray.origin.p) + t * Colour(ray.direction.v);
    for (std::size_t n = regions.size(); n > 0; --n) {
      bool in = true;
      for (const HalfSpace& h : regions[n - 1]->planes)
        in = in && glm::dot(Colour(h.normal.v), p) <= static_cast<Real>(h.offset_mm);
      if (in) return n;
    }
    return 0;
  }
  bool toolBefore(Real t) const { return translucent.t < opaque.t && translucent.t <= t; }

  // What has been gathered on the way.
  std::vector<Gathered> all = {};
  struct Ordered {
    Colour colour{0};
    Real light = 1, only = 1;
  };
  Ordered over = {};
  Real lightAtTool = -1;
  void passTool(Real t) {
    if (lightAtTool < 0 && toolBefore(t)) lightAtTool = over.light, over.light *= 1 - translucent.alpha;
  }
  static Real greyOf(const Look& l, Real v) {
    return std::isnan(v) ? v : std::clamp<Real>(v / static_cast<Real>(l.width), 0, 1);
  }
  void step(Real a, Real b, int depth) {
    const std::size_t first = appearanceAt(a), last = appearanceAt(b);
    const Real level = looks[first].kind == Kind::Iso ? static_cast<Real>(looks[first].level) : 9;
    const bool crosses = (valueAt(voxelAt(a)) >= level) != (valueAt(voxelAt(b)) >= level);
    if ((crosses || first != last || toolBefore(a) != toolBefore(b)) && depth < 40) {
      step(a, (a + b) / 2, depth + 1);
      step((a + b) / 2, b, depth + 1);
      return;
    }
    const Real t = (a + b) / 2, length = b - a, v = valueAt(voxelAt(t));
    const std::size_t n = appearanceAt(t);
    const Look& l = looks[n];
    passTool(t);
    if (std::isnan(v) || l.kind == Kind::CutOut) return;
    if (l.kind == Kind::Blend) {
      const Real alpha = opacityAt(l.transfer, static_cast<double>(v));
      const Real left = std::exp(std::log1p(-alpha) * length / l.transfer.opacityLength_mm);
      over.colour += over.light * (1 - left) * Colour(colourAt(l.transfer, static_cast<double>(v)));
      over.light *= left, over.only *= left;
    } else if (l.kind == Kind::Iso) {
      if (over.only > 0 && std::fabs(v - static_cast<Real>(l.level)) < 1e-5L) certain = false;
      if (v < l.level) return;
      over.colour += over.light * Colour(l.surface);
      over.light = over.only = 0;
    } else {
      Gathered& g = all[n];
      const Real tool = toolBefore(t) ? 1 - translucent.alpha : 1, grey = greyOf(l, v);
      for (Real at : {a, t, b})
        if (const Real end = greyOf(l, valueAt(voxelAt(at))); !std::isnan(end))
          g.most = std::max(g.most, tool * end), g.least = std::min(g.least, tool * end);
      g.integral += v * length, g.length += length, g.seen += tool * length;
      g.emission += grey * length, g.emissionSeen += tool * grey * length;
      if (!toolBefore(t)) g.emissionBefore += grey * length;
    }
  }

  Colour pixel(int steps) {
    all.assign(looks.size(), {});
    const Real d = (static_cast<Real>(to) - from) / steps;
    for (int n = 0; n < steps; ++n) step(from + n * d, from + (n + 1) * d, 0);
    passTool(1e29L);
    // Several of one kind join, else the last one shows.
    std::vector<std::size_t> shown;
    for (std::size_t n = 0; n < all.size(); ++n)
      if (all[n].length > 0) shown.push_back(n);
    const bool alike = std::all_of(shown.begin(), shown.end(), [&](std::size_t n) {
      return looks[n].kind == looks[shown[0]].kind && looks[n].kind != Kind::Mean;
    });
    if (!alike) shown = {shown.back()};
    const bool translucentShows = translucent.t < opaque.t, ends = opaque.t < 1e29L;
    const Real tools = translucentShows ? 1 - translucent.alpha : 1;
    Real value = 0, reaching = 1;
    const Kind kind = shown.empty() ? looks[0].kind : looks[shown[0]].kind;
    if (kind == Kind::Min || kind == Kind::Attenuation) value = 1;
    for (std::size_t n : shown) {
      const Gathered& g = all[n];
      if (kind == Kind::Max) value = std::max(value, g.most);
      if (kind == Kind::Min) value = std::min(value, g.least);
      if (kind == Kind::Mean)
        value = std::clamp<Real>(g.integral / g.length / static_cast<Real>(looks[n].width), 0, 1) * g.seen /
                g.length;
      if (kind == Kind::Sum) value += kGain * g.emissionSeen;
      if (kind != Kind::Attenuation) continue;
      value *= std::exp(-kGain * g.emission);
      reaching *= std::exp(-kGain * g.emissionBefore);
    }
    Colour end = ends ? toolColour(opaque) : Colour(0);
    if (!ends && (shown.empty() || kind == Kind::Sum)) end = background;
    if (!ends && kind == Kind::Attenuation) end = Colour(1);
    end *= tools;
    Colour behind = end;
    if (!shown.empty()) {
      behind = glm::max(Colour(value), end);
      if (kind == Kind::Sum) behind = Colour(value) + end;
      if (kind == Kind::Attenuation) behind = value * end;
    }
    Colour out = over.colour + over.only * behind;
    if (translucentShows) out += lightAtTool * reaching * translucent.alpha * toolColour(translucent);
    return out;
  }
};

TEST(LensBrute, HundredRays) {
  int compared = 0, changed = 0, inside = 0, kinds[kKinds] = {};
  for (std::uint64_t n = 0; n < 900 && compared < 100; ++n) {
    if (n % 5 == 2 || n % 5 == 3) continue;  // fields that jump have tests of their own
    const auto draw = [&](std::uint64_t k) { return randomUnit(1700 + n, k); };
    std::vector<Look> looks;
    for (std::uint64_t w = 0; w < 4; ++w)
      looks.push_back(
          lookOf(n, w, static_cast<Kind>(static_cast<int>((w == 0 ? kKinds - 1 : kKinds) * draw(w)))));
    BruteCase c = randomCase(n, layerOf<Layer>(looks[0]));
    c.s.scene.background = {0.1, 0.3, 0.9};
    Brute brute{bruteOf(c), looks, {}, Colour(0.1L, 0.3L, 0.9L)};
    if (!(brute.to - brute.from > 0.05)) continue;
    ReferenceOptions options;
    options.lenses.emplace();
    const glm::dvec3 middle = brute.volume.grid().centre().p;
    for (std::size_t w = 1; w < looks.size(); ++w) {
      brute.regions.push_back(randomRegion(n, w, middle));
      LensLayer lens;
      if (looks[w].kind != Kind::CutOut) lens.inner = layerOf<LensInner>(looks[w]);
      options.lenses->push_back({brute.regions.back(), c.s.scene.layers.size()});
      c.s.scene.layers.emplace_back(lens);
    }
    const Colour truth = brute.pixel(6000);
    if (!brute.certain) continue;
    ++compared;
    std::string said = "ray " + std::to_string(n) + ", appearances";
    for (const Look& l : looks) said += " " + std::to_string(static_cast<int>(l.kind));
    SCOPED_TRACE(said);
    const std::size_t pixel = static_cast<std::size_t>(c.pixelX) + 40 * static_cast<std::size_t>(c.pixelY);
    const auto got = referencePixels(c.s.scene, c.s.view, c.s.sources, std::span(&pixel, 1), options);
    ASSERT_TRUE(got.ok()) << got.error().text();
    // A peak lies between two steps of 4e-4 mm or so, with slopes of up to 1 / mm.
    const bool extremes = std::any_of(
        looks.begin(), looks.end(), [](const Look& l) { return l.kind == Kind::Max || l.kind == Kind::Min; });
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR((*got)[0].rgba[k], static_cast<double>(truth[k]), extremes ? 1e-4 : 1e-6)
          << "channel " << k;
    // That the rays are worth it.
    for (std::size_t w = 0; w < looks.size(); ++w) ++kinds[static_cast<int>(looks[w].kind)];
    inside += brute.appearanceAt(brute.from) != 0 ? 1 : 0;
    options.lenses->clear();
    const auto without = referencePixels(c.s.scene, c.s.view, c.s.sources, std::span(&pixel, 1), options);
    changed += glm::length((*without)[0].rgba - (*got)[0].rgba) > 1e-3 ? 1 : 0;
  }
  EXPECT_EQ(compared, 100);
  EXPECT_GT(changed, 60);
  EXPECT_GT(inside, 20);
  for (int k : kinds) EXPECT_GT(k, 15);
}

}  // namespace
}  // namespace vernier::quality
