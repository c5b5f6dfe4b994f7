// SPDX-License-Identifier: GPL-3.0-or-later
// Included by GlCases.h. What pictures of volumes must be, in double: RENDERING's rules, sample by sample,
// with volume's probe. Techniques differ in where their samples lie.
#pragma once
#include "DvrSample.h"

namespace vernier::test {

class DvrTruth : public DvrSample {
 public:
  using DvrSample::DvrSample;

  // Rays on the lattice; planar: of view-aligned slices, whose lattice counts depth along the view.
  glm::dvec3 rays(double x, double y, bool planar = false) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    glm::dvec3 colour(0), behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    double left = 1, from = s.entry_mm;
    for (std::size_t n = 0; n <= t.layers.size(); ++n) {
      const double at = n < t.layers.size() ? t.layers[n].t_mm : s.exit_mm;
      const double to = std::clamp(at, s.entry_mm, std::max(s.entry_mm, s.exit_mm));
      if (!s.empty() && from < to) addPart(x, y, from, to, planar, colour, left);
      from = to;
      if (n == t.layers.size()) break;
      colour += left * glm::dvec3(t.layers[n].r, t.layers[n].g, t.layers[n].b);
      left *= 1 - static_cast<double>(t.layers[n].alpha);
    }
    return colour + left * behind;
  }
  void addPart(double x, double y, double from, double to, bool planar, glm::dvec3& colour,
               double& left) const {
    const double lengths = planar ? camera_.rayPerDepth(x, y) : 1, d = case_.step_mm() * lengths;
    for (double k = std::floor(from / d); k * d < to; ++k) {
      const double share = (std::min(to, (k + 1) * d) - std::max(from, k * d)) / d;
      if (share <= 0) continue;
      const bool pairs = layer_.classification == Classification::PreIntegrated;
      const glm::dvec4 c = pairs ? between(x, y, k * d, d, d / lengths) : sample(x, y, (k + 0.5) * d, d);
      const double a = opacityOver(c.w, pairs ? share * lengths : share);
      colour += left * a * glm::dvec3(c);
      left *= 1 - a;
    }
  }

  // From t to t + d the value goes evenly, along a step of the table's length: by a thousand thin pieces.
  glm::dvec4 between(double x, double y, double t, double d, double table_mm) const {
    const TransferFunction& f = *layer_.transfer;
    const std::optional<double> front = fieldAt(x, y, t), back = fieldAt(x, y, t + d);
    glm::dvec3 colour(0);
    double left = 1;
    for (int n = 0; n < 1000; ++n) {
      const double v = std::lerp(*front, *back, (n + 0.5) / 1000);
      const double a = opacityOver(opacityAt(f, v), table_mm / 1000 / f.opacityLength_mm);
      colour += left * a * colourAt(f, v);
      left *= 1 - a;
    }
    return left < 1 ? glm::dvec4(colour / (1 - left), 1 - left) : glm::dvec4(0);
  }

  glm::dvec3 extreme(double x, double y) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    if (s.empty()) return behind;
    const double sign = layer_.mode == VolumeMode::Min ? -1 : 1, d = case_.step_mm();
    std::optional<double> best;
    glm::dvec3 channels(sign * -1e9);
    const auto take = [&](double at) {
      if (volume_.isColour()) {
        const glm::dvec3 c(colourSample(voxelAt(x, y, at), d));
        channels = sign > 0 ? glm::max(channels, c) : glm::min(channels, c);
      } else if (const std::optional<double> v = fieldAt(x, y, at)) {
        if (!best || sign * *v > sign * *best) best = v;
      }
    };
    take(s.entry_mm), take(s.exit_mm);
    for (double k = std::floor(s.entry_mm / d); (k + 0.5) * d < s.exit_mm; ++k)
      if ((k + 0.5) * d > s.entry_mm) take((k + 0.5) * d);
    if (volume_.isColour()) return channels;
    if (!best) return behind;
    const double a = opacityAt(*layer_.transfer, *best);
    return a * colourAt(*layer_.transfer, *best) + (1 - a) * behind;
  }

  // The first root of the field along the ray, looked for fifty times in a voxel.
  glm::dvec3 isosurface(double x, double y, double* at_mm = nullptr) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    double end = t.end_mm;
    const glm::dvec3 eye = -camera_.ray(x, y).direction.v;
    const Material& m = iso_.material;
    if (!s.empty()) {
      const double d = 0.02 * case_.step_mm() / case_.quality.step;
      double before = s.entry_mm;
      bool found = reaches(x, y, before);
      const bool begins = found;
      double at = before;
      while (!found && at < s.exit_mm) {
        before = at, at = std::min(at + d, s.exit_mm);
        found = reaches(x, y, at);
      }
      if (found) {
        for (int n = 0; n < 40 && !begins; ++n) {
          const double middle = 0.5 * (before + at);
          (reaches(x, y, middle) ? at : before) = middle;
        }
        const glm::dvec3 n = begins ? eye : gradient(voxelAt(x, y, at), *iso_.level);
        behind = lit(m, rgb(m.ambientColour), rgb(m.diffuseColour), n, eye);
        end = at;
      }
    }
    if (at_mm) *at_mm = end;
    return t.own(end) + t.through(end) * behind;
  }

  // A stack's own slices: each stands for the slab around it, sampled where the ray meets it, at the box's
  // border at the most; with the opacity of the way through its slab.
  struct StackSample {
    double at_mm = 0, length_mm = 0;  // along the ray; of the slab, inside the span
    glm::dvec3 voxel{0};
    bool met = false;  // the slice itself lies inside the span
  };
  std::vector<StackSample> stackSamples(double x, double y, const RaySpan& s, int axis, int perVoxel) const {
    const GridGeometry& g = volume_.grid();
    const glm::dvec3 last(g.columns - 1, g.rows - 1, g.slices - 1);
    const glm::dvec3 from = voxelAt(x, y, 0), along = voxelAt(x, y, 1) - from;
    glm::dvec2 box(-1e30, 1e30);
    for (int n = 0; n < 3; ++n) {
      const double a = -from[n] / along[n], b = (last[n] - from[n]) / along[n];
      box = {std::max(box.x, std::min(a, b)), std::min(box.y, std::max(a, b))};
    }
    std::vector<StackSample> out;
    const int count = static_cast<int>(last[axis]) * perVoxel;
    for (int n = 0; n <= count; ++n) {
      const double place = static_cast<double>(along[axis] > 0 ? n : count - n) / perVoxel;
      const double middle = (place - from[axis]) / along[axis],
                   reach = 0.5 / perVoxel / std::abs(along[axis]);
      StackSample sample;
      sample.length_mm = std::min(s.exit_mm, middle + reach) - std::max(s.entry_mm, middle - reach);
      sample.at_mm = std::clamp(middle, box.x, box.y);
      sample.voxel = from + sample.at_mm * along;
      sample.voxel[axis] = place;
      sample.met = middle >= s.entry_mm && middle <= s.exit_mm;
      if (sample.length_mm > 0) out.push_back(sample);
    }
    return out;
  }
  glm::dvec3 stack(double x, double y, int axis, int perVoxel) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    if (s.empty()) return behind;
    glm::dvec3 colour(0);
    double left = 1;
    for (const StackSample& n : stackSamples(x, y, s, axis, perVoxel)) {
      const glm::dvec4 c = sampleAtVoxel(n.voxel, -camera_.ray(x, y).direction.v, n.length_mm);
      colour += left * c.w * glm::dvec3(c);
      left *= 1 - c.w;
    }
    return colour + left * behind;
  }
  // The nearest slice at which the level is reached.
  glm::dvec3 stackIso(double x, double y, int axis, int perVoxel) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    const Material& m = iso_.material;
    if (s.empty()) return behind;
    for (const StackSample& n : stackSamples(x, y, s, axis, perVoxel)) {
      const std::optional<double> v = field(n.voxel);
      if (!n.met || !v || *v < *iso_.level) continue;
      return lit(m, rgb(m.ambientColour), rgb(m.diffuseColour), gradient(n.voxel, *v),
                 -camera_.ray(x, y).direction.v);
    }
    return behind;
  }
  glm::dvec3 stackExtreme(double x, double y, int axis, int perVoxel) const {
    const RaySpan s = span(x, y);
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    const double sign = layer_.mode == VolumeMode::Min ? -1 : 1;
    std::optional<double> best;
    if (!s.empty())
      for (const StackSample& n : stackSamples(x, y, s, axis, perVoxel))
        if (const std::optional<double> v = field(n.voxel); n.met && v && (!best || sign * *v > sign * *best))
          best = v;
    if (!best) return behind;
    const double a = opacityAt(*layer_.transfer, *best);
    return a * colourAt(*layer_.transfer, *best) + (1 - a) * behind;
  }

  // The nearest view-aligned slice at which the level is reached, and the extreme of these slices.
  template <class Take>
  void eachPlanarSample(double x, double y, Take take) const {
    const RaySpan s = span(x, y);
    const double d = case_.step_mm() * camera_.rayPerDepth(x, y);
    if (s.empty()) return;
    for (double k = std::floor(s.entry_mm / d); (k + 0.5) * d <= s.exit_mm; ++k)
      if ((k + 0.5) * d >= s.entry_mm && !take((k + 0.5) * d)) return;
  }
  glm::dvec3 planarIso(double x, double y) const {
    const native::ToolsOnRay t = tools(x, y);
    glm::dvec3 seen = t.ends() ? t.endColour : rgb(case_.scene.background);
    const Material& m = iso_.material;
    eachPlanarSample(x, y, [&](double at) {
      const std::optional<double> v = fieldAt(x, y, at);
      if (!v || *v < *iso_.level) return true;
      seen = lit(m, rgb(m.ambientColour), rgb(m.diffuseColour), gradient(voxelAt(x, y, at), *v),
                 -camera_.ray(x, y).direction.v);
      return false;
    });
    return seen;
  }
  glm::dvec3 planarExtreme(double x, double y) const {
    const native::ToolsOnRay t = tools(x, y);
    const glm::dvec3 behind = t.ends() ? t.endColour : rgb(case_.scene.background);
    const double sign = layer_.mode == VolumeMode::Min ? -1 : 1;
    std::optional<double> best;
    glm::dvec3 channels(-1e9);
    eachPlanarSample(x, y, [&](double at) {
      if (volume_.isColour())
        channels = glm::max(channels, sign * glm::dvec3(colourSample(voxelAt(x, y, at), 1)));
      else if (const std::optional<double> v = fieldAt(x, y, at); v && (!best || sign * *v > sign * *best))
        best = v;
      return true;
    });
    if (channels.x > -1e8) return sign * channels;
    if (!best) return behind;
    const double a = opacityAt(*layer_.transfer, *best);
    return a * colourAt(*layer_.transfer, *best) + (1 - a) * behind;
  }
};

}  // namespace vernier::test
