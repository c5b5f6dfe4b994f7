// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlParts.h"

namespace vernier::dvr {
namespace {

// The rays that meet no lens.
Result<void> drawPlainRays(const GlVolumeJob& job, bool planar, Images& images, std::stop_token stop,
                           const DrawPart& draw) {
  Result<RayParts> parts = RayParts::make(job, planar, std::move(stop), images.rays.get());
  if (!parts) return parts.error();
  PictureMaker picture(job, *parts);
  for (std::size_t n = 0; n < parts->count(); ++n) {
    const RayImages rays = parts->images(n, picture.through());
    Result<DrawnPart> drawn = draw(rays);
    if (!drawn) return drawn.error();
    picture.take(n, rays, *drawn);
  }
  picture.finish(images);
  return {};
}

// What was drawn of a part, into it. `before`: what the parts before it let through.
void put(const float* seen, const float* found, double entry_mm, float before, RaySegment& s) {
  for (std::size_t c = 0; c < 3; ++c) s.colour[c] = seen[c];
  s.through = seen[3];
  s.covered = seen[3] < 1;
  s.hasDepth = found[0] >= 0 && before > 0.5f;
  if (s.hasDepth) s.depth_mm = static_cast<float>(entry_mm + static_cast<double>(found[0]));
}

// The parts of the rays that meet a lens, as entry and exit images: in each round one part of every ray that
// has one.
Result<void> drawSegments(const GlVolumeJob& job, bool planar, const RaysOfPass& pass, Images& images,
                          const DrawPart& draw) {
  RayIntervals& cut = *images.rays;
  for (int round = 0;; ++round) {
    const RayRound parts = roundOf(cut, pass, round);
    if (!parts.any) return {};
    const auto before = [&](std::size_t p) {
      return parts.segment[p] < 0 ? 0.0f : cut.lightBefore(p, static_cast<std::size_t>(parts.segment[p]));
    };
    const RayImages rays = rayImages(
        job, planar,
        [&](std::size_t p) {
          return RaySpan{static_cast<double>(parts.from_mm[p]), static_cast<double>(parts.to_mm[p])};
        },
        before);
    if (!rays.any()) continue;
    const Result<DrawnPart> drawn = draw(rays);
    if (!drawn) return drawn.error();
    images.counters.samples += drawn->samples;
    for (std::size_t p = 0; p < parts.segment.size(); ++p) {
      if (!(rays.lattice[4 * p + 2] > 0)) continue;
      put(drawn->seen.data() + 4 * p, drawn->found.data() + 4 * p, rays.entry_mm[p], rays.lattice[4 * p + 3],
          cut.segments[static_cast<std::size_t>(parts.segment[p])]);
      images.counters.samples += static_cast<std::uint64_t>(drawn->found[4 * p + 1]);
      images.counters.cells += static_cast<std::uint64_t>(drawn->found[4 * p + 3]);
    }
  }
}

}  // namespace

Result<void> drawParts(const GlVolumeJob& job, bool planar, const RaysOfPass& pass, Images& images,
                       std::stop_token stop, const DrawPart& draw) {
  const auto pixels =
      static_cast<std::size_t>(job.camera.width_px) * static_cast<std::size_t>(job.camera.height_px);
  if (images.rays && images.rays->first.size() != pixels + 1)
    return makeError(ErrorCode::Internal, "The rays are cut for a picture of another size.", "dvr");
  if (!images.rays || pass.drawsPlainRays())
    if (Result<void> r = drawPlainRays(job, planar, images, std::move(stop), draw); !r) return r;
  return images.rays ? drawSegments(job, planar, pass, images, draw) : Result<void>();
}

Result<void> checkParts(const GlVolumeJob& job, const PlanContext& context) {
  if (context.appearances.empty() || !job.extreme()) return {};
  return makeError(ErrorCode::NoTechnique,
                   "With lenses a greatest or least value is drawn by a projection; make it one.");
}

}  // namespace vernier::dvr
