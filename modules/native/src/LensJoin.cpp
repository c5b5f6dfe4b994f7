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

// Which of what has been gathered along one ray shows, by the rules in RayIntervals.h: all that is covered
// where it can be joined, else the last in the scene's order alone; lenses follow the outside there.
struct Shown {
  bool covered = false, together = true;
  Accumulator accumulator = Accumulator::Max;
  std::int16_t last = -1;

  Shown(const JoinJob& job, std::span<const RaySegment> segments) {
    for (const RaySegment& s : segments) {
      if (s.appearance == RaySegment::kEnd) break;
      if (s.appearance < 0 || !s.covered) continue;
      const Accumulator a = job.accumulators[static_cast<std::size_t>(s.appearance)];
      if (a == Accumulator::Ordered) continue;
      together = together && a != Accumulator::Mean && (!covered || a == accumulator);
      if (s.appearance >= last) last = s.appearance, accumulator = a;
      covered = true;
    }
  }
  bool holds(const RaySegment& s, const JoinJob& job) const {
    return s.appearance >= 0 && s.covered && (together || s.appearance == last) &&
           job.accumulators[static_cast<std::size_t>(s.appearance)] != Accumulator::Ordered;
  }
};

// What they come to.
struct Gathering {
  bool any = false, overBackground = false, replaces = false;
  glm::dvec3 value{0}, least{0};
  float depth_mm = kNothing_mm;

  void add(const RaySegment& s, Accumulator a, const JoinJob& job) {
    const auto n = static_cast<std::size_t>(s.appearance);
    const glm::dvec3 c = colourOf(s);
    const float depth = s.hasDepth ? s.depth_mm : kNothing_mm;
    if (!any) {
      value = c, depth_mm = depth;
    } else if (a == Accumulator::Sum || a == Accumulator::Attenuation) {
      value = a == Accumulator::Sum ? value + c : value * c;
      depth_mm = std::min(depth_mm, depth);
    } else {
      const glm::dvec3 joined = a == Accumulator::Min ? glm::min(value, c) : glm::max(value, c);
      if (joined != value) depth_mm = depth;
      value = joined;
    }
    any = true;
    overBackground = overBackground || (a == Accumulator::Sum && job.overBackground[n]);
    if (a != Accumulator::Max) return;
    if (n < job.least.size()) least = glm::max(least, job.least[n]);
    replaces = replaces || (n < job.replaces.size() && job.replaces[n]);
  }
};

struct Joined {
  glm::dvec3 colour{0};
  float depth_mm = kNothing_mm;
};

// What stands behind a ray on which nothing has been gathered and that no tool ends.
glm::dvec3 bare(const JoinJob& job) {
  if (job.accumulators.front() == Accumulator::Attenuation)
    return glm::dvec3(1);  // nothing weakens the light
  return job.least.empty() ? job.background : glm::max(job.background, job.least.front());
}

Joined joined(const JoinJob& job, std::span<const RaySegment> segments) {
  Joined out;
  const Shown shown(job, segments);
  Gathering gathered;
  double through = 1, ordered = 1, tools = 1;
  glm::dvec3 reaching(1), end(0);  // of a tool's colour: what has not been attenuated
  bool ended = false;
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
      if (!shown.holds(s, job)) continue;
      gathered.add(s, a, job);
      if (a == Accumulator::Attenuation) reaching *= colourOf(s);
      continue;
    }
    const double after = through * static_cast<double>(s.through);
    out.colour += through * (tool ? reaching * colourOf(s) : colourOf(s));
    if (through > 0.5 && after <= 0.5) out.depth_mm = s.hasDepth ? s.depth_mm : s.to_mm;
    through = after;
    (tool ? tools : ordered) *= static_cast<double>(s.through);
  }
  if (!shown.covered) {
    out.colour += through * (ended ? end : bare(job));
    return out;
  }
  const Accumulator a = shown.accumulator;
  if (!ended && a == Accumulator::Sum && gathered.overBackground) end = job.background;
  if (!ended && a == Accumulator::Attenuation) end = glm::dvec3(1);
  if (!ended && a == Accumulator::Max) end = gathered.least;
  if (ended && gathered.replaces) end = glm::dvec3(0);
  const glm::dvec3 behind = tools * end;
  const glm::dvec3 seen = a == Accumulator::Sum           ? gathered.value + behind
                          : a == Accumulator::Attenuation ? gathered.value * behind
                                                          : glm::max(gathered.value, behind);
  out.colour += ordered * seen;
  if (ordered > 0.5 && (!ended || gathered.replaces || seen != behind)) out.depth_mm = gathered.depth_mm;
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
