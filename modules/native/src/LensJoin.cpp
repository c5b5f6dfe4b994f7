// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "vernier/base/Threads.h"
#include "vernier/native/LensRays.h"

namespace vernier::native {
namespace {

glm::dvec3 colourOf(const RaySegment& s) {
  return {static_cast<double>(s.colour[0]), static_cast<double>(s.colour[1]),
          static_cast<double>(s.colour[2])};
}

// What has been gathered along one ray, by the rules in RayIntervals.h.
struct Gathering {
  bool covered = false, mixed = false, overBackground = false;
  Accumulator accumulator = Accumulator::Max;
  std::int16_t appearance = -1;
  glm::dvec3 value{0};
  float depth_mm = kNothing_mm;

  void add(const RaySegment& s, Accumulator a) {
    const glm::dvec3 c = colourOf(s);
    const bool same = !covered || a == accumulator;
    mixed = mixed || !same;
    const float depth = s.hasDepth ? s.depth_mm : kNothing_mm;
    if (!covered || mixed || a == Accumulator::Mean) {
      // The last in the scene's order shows; lenses follow the outside there.
      if (covered && s.appearance < appearance) return;
      value = c, depth_mm = depth;
    } else if (a == Accumulator::Max || a == Accumulator::Min) {
      const glm::dvec3 joined = a == Accumulator::Max ? glm::max(value, c) : glm::min(value, c);
      if (joined != value) depth_mm = depth;
      value = joined;
    } else {
      value = a == Accumulator::Sum ? value + c : value * c;
      depth_mm = std::min(depth_mm, depth);
    }
    covered = true, accumulator = a, appearance = s.appearance;
  }
  // With what ends the ray, `end` weighted by what tools let through.
  glm::dvec3 with(const glm::dvec3& end) const {
    if (accumulator == Accumulator::Sum) return value + end;
    if (accumulator == Accumulator::Attenuation) return value * end;
    return glm::max(value, end);
  }
};

struct Joined {
  glm::dvec3 colour{0};
  float depth_mm = kNothing_mm;
};

Joined joined(const JoinJob& job, std::span<const RaySegment> segments) {
  Joined out;
  Gathering gathered;
  double through = 1, ordered = 1, tools = 1;
  bool ended = false;
  glm::dvec3 end(0);
  for (const RaySegment& s : segments) {
    if (s.appearance == RaySegment::kEnd) {
      ended = true, end = colourOf(s);
      if (through > 0.5) out.depth_mm = s.from_mm;
      break;
    }
    const bool tool = s.appearance == RaySegment::kTool;
    const Accumulator a =
        tool ? Accumulator::Ordered : job.accumulators[static_cast<std::size_t>(s.appearance)];
    if (a != Accumulator::Ordered) {
      if (!s.covered) continue;
      gathered.add(s, a);
      if (a == Accumulator::Sum)
        gathered.overBackground =
            gathered.overBackground || job.overBackground[static_cast<std::size_t>(s.appearance)];
      continue;
    }
    const double after = through * static_cast<double>(s.through);
    out.colour += through * colourOf(s);
    if (through > 0.5 && after <= 0.5) out.depth_mm = s.hasDepth ? s.depth_mm : s.to_mm;
    through = after;
    (tool ? tools : ordered) *= static_cast<double>(s.through);
  }
  if (!gathered.covered) {
    const bool clear =
        job.accumulators.front() == Accumulator::Attenuation;  // nothing has weakened the light
    out.colour += through * (ended ? end : clear ? glm::dvec3(1) : job.background);
    return out;
  }
  if (!ended && gathered.accumulator == Accumulator::Sum && gathered.overBackground) end = job.background;
  if (!ended && gathered.accumulator == Accumulator::Attenuation) end = glm::dvec3(1);
  const glm::dvec3 behind = tools * end, shown = gathered.with(behind);
  out.colour += ordered * shown;
  if (ordered > 0.5 && (!ended || shown != behind)) out.depth_mm = gathered.depth_mm;
  return out;
}

}  // namespace

Result<void> joinParts(const JoinJob& job, Images& images, std::stop_token stop) {
  const std::shared_ptr<RayIntervals> rays = std::move(images.rays);
  images.rays.reset();
  if (!rays || rays->width != images.width || rays->height != images.height)
    return makeError(ErrorCode::Internal, "The picture has no parts of rays to be joined.", "joinParts");
  const auto width = static_cast<std::size_t>(images.width);
  parallelFor(static_cast<std::size_t>(images.height), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end && !stop.stop_requested(); ++y)
      for (std::size_t pixel = y * width; pixel < (y + 1) * width; ++pixel) {
        if (!rays->meetsLens(pixel)) continue;
        const Joined j = joined(job, std::as_const(*rays).of(pixel));
        for (int c = 0; c < 3; ++c)
          images.colour[4 * pixel + static_cast<std::size_t>(c)] = static_cast<float>(j.colour[c]);
        images.colour[4 * pixel + 3] = 1;
        images.depth[pixel] = j.depth_mm;
      }
  });
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The picture with lenses was cancelled.");
  return {};
}

}  // namespace vernier::native
