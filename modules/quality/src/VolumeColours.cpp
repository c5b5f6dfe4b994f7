// SPDX-License-Identifier: GPL-3.0-or-later
// Colour volumes, and blended volumes as an engine samples them.
#include <cmath>

#include "VolumeReference.h"

namespace vernier::quality {
namespace {

constexpr double kMostOpacity = 1 - 0x1p-53;

double over(double opacity, double lengths) {
  return opacity >= 1 ? 1 : -std::expm1(lengths * std::log1p(-opacity));
}
double clamped(double x) { return std::clamp(x, 0.0, 1.0); }

}  // namespace

Result<void> VolumeReference::readColours() {
  for (double gain : layer_.gains)
    if (!(gain >= 0) || !std::isfinite(gain))
      return makeError(ErrorCode::SceneInvalid, "The gains of a colour volume are finite and not below 0.");
  if (shades())
    return makeError(ErrorCode::NotBuiltYet,
                     "A volume in colour has no single values, and so no gradient that could be lit; show it "
                     "without shading.");
  return {};
}

std::array<Poly, 4> VolumeReference::channelsOf(const RayPart& part) const {
  std::array<Poly, 4> out;
  const Volume& volume = rays_.volume();
  for (std::size_t c = 0; c < 4; ++c) {
    Poly& p = out[c];
    if (static_cast<int>(c) >= volume.info().channels) {
      p.c[0] = layer_.gains[c];
      continue;
    }
    const Field field(volume.channel(static_cast<int>(c)), layer_.interpolation);
    if (const auto piece = field.piece(part.from_vox, part.across_vox, 0, 1, nullptr)) {
      p = piece->numerator;
      for (double& x : p.c) x = layer_.gains[c] * x / 255;
    }
  }
  return out;
}

// Cut where a channel passes 1, beyond which it is held.
bool VolumeReference::blendColours(const RayPart& part, Walk& walk) const {
  if (!walk.passTools(part.passed)) return false;
  const std::array<Poly, 4> channels = channelsOf(part);
  std::vector<double> stops{0, 1};
  for (Poly p : channels) {
    p.c[0] -= 1;
    for (double u : rootsInside(p)) stops.push_back(u);
  }
  std::sort(stops.begin(), stops.end());
  const auto colour = [&](double u) {
    return glm::dvec3(clamped(channels[0](u)), clamped(channels[1](u)), clamped(channels[2](u)));
  };
  for (std::size_t n = 0; n + 1 < stops.size(); ++n) {
    if (!(stops[n + 1] > stops[n])) continue;
    const double alpha = channels[3](0.5 * (stops[n] + stops[n + 1]));
    walk.shown = walk.shown || alpha > 0;
    if (alpha >= 1) {
      walk.light.cover(colour(stops[n]), 1);
      return false;
    }
    const double lengths = part.length_mm() / smallest_mm_;
    walk.light.absorb(
        [&](double u) {
          const double a = std::clamp(channels[3](u), 0.0, kMostOpacity);
          return Emission{-lengths * std::log1p(-a), colour(u)};
        },
        stops[n], stops[n + 1]);
    if (walk.light.ended()) return false;
  }
  return true;
}

// The extreme of each channel by itself, opaque where it is first reached.
VolumeSeen VolumeReference::seenColourExtremes(const VolumeRay& ray) const {
  const double sign = layer_.mode == VolumeMode::Max ? 1 : -1;
  std::array<Extreme, 3> extremes;
  rays_.alongData(ray, [&](const RayPart& part) {
    const std::array<Poly, 4> channels = channelsOf(part);
    for (std::size_t c = 0; c < 3; ++c) {
      Piece piece;
      piece.numerator = channels[c];
      const LocalRange e = piece.extremes();
      const double value = clamped(sign > 0 ? e.max : e.min);
      if (!extremes[c].value || sign * value > sign * *extremes[c].value) extremes[c] = {value, part.passed};
    }
    return true;
  });
  VolumeSeen out;
  out.shown = extremes[0].value.has_value();
  out.covered = out.shown || ray.opaque || !ray.tools.empty();
  const glm::dvec3 behind = ray.opaque ? ray.opaque->colour : background_;
  for (int c = 0; c < 3; ++c) {
    const Extreme& e = extremes[static_cast<std::size_t>(c)];
    const std::size_t tools = e.value ? e.passed : ray.tools.size();
    for (std::size_t n = 0; n < tools; ++n)
      out.colour[c] += ray.through[n] * ray.tools[n].opacity * ray.tools[n].colour[c];
    out.colour[c] += ray.through[tools] * e.value.value_or(behind[c]);
  }
  return out;
}

// One sample of the lattice, for as much of its step as is left.
bool VolumeReference::sample(glm::dvec3 voxel, double length_mm, Walk& walk) const {
  double opacity = 0, unit_mm = smallest_mm_;
  glm::dvec3 colour(0);
  if (isColour()) {
    std::array<double, 4> c;
    for (int n = 0; n < 4; ++n) {
      const double gain = layer_.gains[static_cast<std::size_t>(n)];
      double share = 1;
      if (n < rays_.volume().info().channels) {
        const Field field(rays_.volume().channel(n), layer_.interpolation);
        share = field.at(voxel).value_or(0) / 255;
      }
      c[static_cast<std::size_t>(n)] = clamped(gain * share);
    }
    colour = {c[0], c[1], c[2]}, opacity = c[3];
  } else {
    const auto value = Field(rays_.volume(), layer_.interpolation).at(voxel);
    if (!value) return true;
    const std::size_t interval = transfer_->at(*value);
    opacity = transfer_->opacity(interval, *value), unit_mm = transfer_->opacityLength_mm();
    if (!(opacity > 0)) return true;
    const glm::dvec3 g = shades() ? gradient_->at(voxel) : glm::dvec3(0);
    colour = colourOf(interval, *value, shades() ? &g : nullptr, walk.ray.line.direction);
  }
  // Of the whole step, then of what is left of it.
  const double lengths = step_mm_ / unit_mm;
  const double whole =
      layer_.opacity == OpacityRule::Linear ? clamped(opacity * lengths) : over(opacity, lengths);
  const double left = over(whole, length_mm / step_mm_);
  walk.shown = walk.shown || left > 0;
  walk.light.cover(colour, left);
  return !walk.light.ended();
}

// RENDERING's lattice: samples at (k + 1/2) steps from the origin, what an end or a tool cuts off a step
// taken from its length only.
void VolumeReference::lattice(Walk& walk) const {
  const VolumeRay& ray = walk.ray;
  if (!(ray.begin_mm < ray.end_mm)) return;
  const CentreBox box = centreBox(rays_.volume().grid());
  const double first = std::floor(ray.begin_mm / step_mm_), last = std::ceil(ray.end_mm / step_mm_);
  for (double k = first; k < last; ++k) {
    const glm::dvec3 voxel = box.hold(rays_.voxelAt(ray, (k + 0.5) * step_mm_));
    double from = std::max(k * step_mm_, ray.begin_mm);
    const double end = std::min((k + 1) * step_mm_, ray.end_mm);
    while (walk.passed < ray.tools.size() && ray.tools[walk.passed].t_mm < end) {
      const double tool = std::max(from, ray.tools[walk.passed].t_mm);
      if (tool > from && !sample(voxel, tool - from, walk)) return;
      if (!walk.passTools(walk.passed + 1)) return;
      from = tool;
    }
    if (end > from && !sample(voxel, end - from, walk)) return;
  }
}

}  // namespace vernier::quality
