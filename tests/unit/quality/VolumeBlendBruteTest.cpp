// SPDX-License-Identifier: GPL-3.0-or-later
// Blended volumes, their extremes and iso-surfaces against many small steps along each of 100 rays, in long
// double. Lit ones with the gradient as Scene.h words it, written down once more.
#include <algorithm>

#include "VolumeBrute.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;
using Colour = glm::vec<3, Real>;

// Bends only, or with steps and what is opaque at once.
TransferFunction functionOf(std::uint64_t n, bool steps) {
  const auto draw = [&](std::uint64_t k) { return randomUnit(900 + n, k); };
  TransferFunction f;
  f.opacityLength_mm = 0.7;
  f.colours = {{0.2, {draw(0), draw(1), draw(2)}}, {0.7, {draw(3), draw(4), draw(5)}}};
  f.opacities = {{0.15 + 0.2 * draw(6), 0}, {0.6, 0.5 * draw(7)}, {0.9, 0.5 * draw(8)}};
  if (!steps) return f;
  f.colours.insert(f.colours.begin() + 1, {0.2, {draw(9), draw(10), draw(11)}});
  f.opacities.insert(f.opacities.begin() + 1, {f.opacities[0].value, 0.4 * draw(12)});
  if (draw(13) < 0.5) f.opacities.push_back({0.9, 1});
  return f;
}

struct Brute : BruteRay {
  const Scene& scene;
  Colour background{0};

  Colour toolColour(const BruteTool& tool) const { return Colour(1, 0.5L, 0) * tool.shade; }

  // Central differences, per mm in the patient.
  Colour gradientAt(glm::vec<3, Real> p, Real here) const {
    const GridGeometry& g = volume.grid();
    glm::vec<3, Real> least(0), greatest(g.columns - 1, g.rows - 1, 0);
    Real low[2] = {0, 0}, high[2] = {0, 0};
    for (const glm::dvec3& o : g.sliceOrigin_vox)
      for (int a = 0; a < 2; ++a)
        low[a] = std::min<Real>(low[a], o[a]), high[a] = std::max<Real>(high[a], o[a]);
    for (int a = 0; a < 2; ++a) least[a] += low[a], greatest[a] += high[a];
    least.z = positionOf(g, 0), greatest.z = positionOf(g, g.slices - 1);
    Colour d;
    for (int a = 0; a < 3; ++a) {
      Real side[2];
      for (int s = 0; s < 2; ++s) {
        glm::vec<3, Real> q = p;
        q[a] = std::clamp(q[a] + (s ? 1 : -1), least[a], greatest[a]);
        side[s] = valueAt(q);
        if (std::isnan(side[s])) side[s] = here;
      }
      d[a] = (side[1] - side[0]) / 2;
    }
    const glm::dmat3& m = volume.voxelFromPatient().linear;
    Colour out(0);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) out[c] += m[c][r] * d[r];
    return out;
  }
  Colour lit(const Material& m, Colour ambient, Colour diffuse, Colour gradient) const {
    Colour sum = static_cast<Real>(m.ambient) * ambient;
    const Colour v = -Colour(ray.direction.v);
    const Real size = std::sqrt(glm::dot(gradient, gradient));
    if (size > 0) {
      Colour n = gradient / size;
      if (glm::dot(n, v) < 0) n = -n;
      for (const Light& light : scene.lights) {
        Colour l = v;
        if (light.towards) l = Colour(light.towards->v) / static_cast<Real>(glm::length(light.towards->v));
        const Colour h = l + v;
        const Real shine = glm::dot(n, h) / std::sqrt(glm::dot(h, h));
        sum +=
            Colour(light.colour.r, light.colour.g, light.colour.b) *
            (static_cast<Real>(m.diffuse) * std::max<Real>(0, glm::dot(n, l)) * diffuse +
             static_cast<Real>(m.specular) * std::pow(std::max<Real>(0, shine), static_cast<Real>(m.power)));
      }
    }
    for (int c = 0; c < 3; ++c) sum[c] = std::clamp<Real>(sum[c], 0, 1);
    return sum;
  }

  struct Over {
    Colour colour{0};
    Real left = 1;
    void cover(Colour c, Real a) { colour += left * a * c, left *= 1 - a; }
  };
  bool passTool(Over& over, bool passed, Real t) const {
    if (passed || !(translucent.t < opaque.t) || translucent.t > t) return passed;
    over.cover(toolColour(translucent), translucent.alpha);
    return true;
  }
  void ground(Over& over, bool passed) const {
    passTool(over, passed, 1e29L);
    over.cover(opaque.t < 1e29L ? toolColour(opaque) : background, 1);
  }

  Colour blend(const VolumeLayer& layer, int steps) const {
    const TransferFunction& f = *layer.transfer;
    const Real step = (static_cast<Real>(to) - from) / steps;
    Over over;
    bool passed = false;
    for (int n = 0; n < steps; ++n) {
      const Real t = from + (n + 0.5L) * step;
      passed = passTool(over, passed, t);
      const auto p = voxelAt(t);
      const Real v = valueAt(p);
      if (std::isnan(v)) continue;
      const Real a = opacityAt(f, static_cast<double>(v));
      if (!(a > 0)) continue;
      Colour c(colourAt(f, static_cast<double>(v)));
      if (layer.shading == ShadingModel::ColourPerVoxel) c = lit(layer.material, c, c, gradientAt(p, v));
      if (layer.shading == ShadingModel::GlobalAmbient) {
        const Rgb& x = layer.material.ambientColour;
        const Rgb& y = layer.material.diffuseColour;
        c = lit(layer.material, {x.r, x.g, x.b}, {y.r, y.g, y.b}, gradientAt(p, v));
      }
      over.cover(c, a >= 1 ? 1 : -std::expm1(std::log1p(-a) * step / f.opacityLength_mm));
    }
    ground(over, passed);
    return over.colour;
  }

  Colour extreme(const VolumeLayer& layer, int steps) const {
    const Real step = (static_cast<Real>(to) - from) / steps, sign = layer.mode == VolumeMode::Max ? 1 : -1;
    Real best = 0, at = -1;
    for (int n = 0; n < steps; ++n) {
      const Real t = from + (n + 0.5L) * step, v = valueAt(voxelAt(t));
      if (!std::isnan(v) && (at < 0 || sign * v > sign * best)) best = v, at = t;
    }
    Over over;
    bool passed = false;
    if (at >= 0) {
      passed = passTool(over, passed, at);
      const auto v = static_cast<double>(best);
      over.cover(Colour(colourAt(*layer.transfer, v)), opacityAt(*layer.transfer, v));
    }
    ground(over, passed);
    return over.colour;
  }

  // A step at or above the level after one below it, then bisected.
  Colour iso(const IsosurfaceLayer& layer, int steps, bool& certain) const {
    const Real step = (static_cast<Real>(to) - from) / steps, level = *layer.level;
    const Rgb& x = layer.material.ambientColour;
    const Rgb& y = layer.material.diffuseColour;
    const Colour ambient(x.r, x.g, x.b), diffuse(y.r, y.g, y.b);
    Over over;
    bool passed = false, before = false;  // before: data below the level
    Real highest = -1;
    for (int n = 0; n < steps; ++n) {
      Real t = from + (n + 0.5L) * step;
      const Real v = valueAt(voxelAt(t));
      highest = std::max(highest, v);
      if (std::isnan(v) || v < level) {
        before = !std::isnan(v);
        continue;
      }
      if (before) {
        Real lo = t - step;
        for (int k = 0; k < 60; ++k) {
          const Real mid = (lo + t) / 2;
          (valueAt(voxelAt(mid)) >= level ? t : lo) = mid;
        }
      }
      passed = passTool(over, passed, t);
      over.cover(lit(layer.material, ambient, diffuse,
                     before ? gradientAt(voxelAt(t), level) : Colour(ray.direction.v)),
                 1);
      return over.colour;
    }
    certain = highest < level - 1e-3L;
    ground(over, passed);
    return over.colour;
  }
};

// Calls fn(scene, ray, pixel, n) for random rays that pass through something, until it has counted `rays`.
template <class Fn>
void alongRays(const Layer& layer, int rays, Fn&& fn) {
  int compared = 0;
  for (std::uint64_t n = 0; n < 600 && compared < rays; ++n) {
    BruteCase c = randomCase(n, layer);
    c.s.scene.background = {0.1, 0.3, 0.9};
    c.s.scene.lights = {{PatientVec(1, -2, 0.5), {0.9, 0.2, 0.1}}, {std::nullopt, {0.1, 0.5, 0.6}}};
    const Brute brute{bruteOf(c), c.s.scene, Colour(0.1L, 0.3L, 0.9L)};
    if (!(brute.to - brute.from > 0.05)) continue;
    ++compared;
    SCOPED_TRACE("ray " + std::to_string(n));
    fn(c.s, brute, static_cast<std::size_t>(c.pixelX) + 40 * static_cast<std::size_t>(c.pixelY), n);
  }
  EXPECT_EQ(compared, rays);
}

void expectNear(const VolumeScene& s, std::size_t pixel, Colour truth, double within) {
  const glm::dvec4 got = pixelOf(s, pixel).rgba;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], static_cast<double>(truth[c]), within) << "channel " << c;
}
// Whether the field has no jumps: neither gaps nor padding.
bool smooth(std::uint64_t n) { return n % 5 != 2 && n % 5 != 3; }

TEST(VolumeBlendBrute, BlendOfHundredRays) {
  VolumeLayer layer;
  layer.source = "v";
  alongRays(layer, 100, [&](VolumeScene& s, const Brute& brute, std::size_t pixel, std::uint64_t n) {
    const bool steps = n / 5 % 2;
    s.volume().transfer = functionOf(n, steps);
    // A jump is missed by half a step of 1.5e-4 mm at most, of up to 3 / mm; a tool as well.
    const bool tool = brute.translucent.t > brute.from && brute.translucent.t < brute.to;
    expectNear(s, pixel, brute.blend(s.volume(), 20000), steps || !smooth(n) ? 5e-4 : tool ? 5e-5 : 1e-6);
  });
}

TEST(VolumeBlendBrute, LitBlendOfFiftyRays) {
  VolumeLayer layer;
  layer.source = "v";
  layer.material.ambientColour = {0.8, 0.7, 0.2}, layer.material.diffuseColour = {0.3, 1, 0.9};
  alongRays(layer, 50, [&](VolumeScene& s, const Brute& brute, std::size_t pixel, std::uint64_t n) {
    s.volume().transfer = functionOf(n, n / 5 % 2);
    s.volume().shading = n % 3 ? ShadingModel::ColourPerVoxel : ShadingModel::GlobalAmbient;
    // Normals that turn are jumps too.
    expectNear(s, pixel, brute.blend(s.volume(), 6000), 1.5e-3);
  });
}

TEST(VolumeBlendBrute, ExtremesOfHundredRays) {
  VolumeLayer layer;
  layer.source = "v";
  alongRays(layer, 100, [&](VolumeScene& s, const Brute& brute, std::size_t pixel, std::uint64_t n) {
    s.volume().mode = n / 5 % 2 ? VolumeMode::Max : VolumeMode::Min;
    s.volume().transfer = functionOf(n, false);
    expectNear(s, pixel, brute.extreme(s.volume(), 10000), 1e-3);
  });
}

TEST(VolumeBlendBrute, IsosurfacesOfHundredRays) {
  IsosurfaceLayer layer;
  layer.source = "v";
  int hits = 0, faces = 0;
  alongRays(layer, 100, [&](VolumeScene& s, const Brute& brute, std::size_t pixel, std::uint64_t n) {
    s.iso().level = 0.35 + 0.5 * randomUnit(8, n);
    bool certain = true;
    const Colour truth = brute.iso(s.iso(), 10000, certain);
    const bool shown = !std::isnan(pixelOf(s, pixel).value);
    if (!certain && shown) return;  // a peak between two steps
    hits += shown ? 1 : 0;
    faces += shown && brute.valueAt(brute.voxelAt(brute.from + 1e-6L)) >= *s.iso().level ? 1 : 0;
    // Where padding begins the field is known on one side only; a step may end there.
    expectNear(s, pixel, truth, smooth(n) ? 1e-9 : 2e-3);
  });
  EXPECT_GT(hits, 40);
  EXPECT_GT(faces, 10);
}

}  // namespace
}  // namespace vernier::quality
