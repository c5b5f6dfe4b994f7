// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Projection.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "ProjectionFast.h"
#include "ProjectionRay.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::native {
namespace {

constexpr int kTile_px = 32;

// Reads the parts of one picture's rays.
struct Reader {
  const ProjectionJob& job;
  std::optional<FastProjection> fast;
  FastKernel kernel = nullptr;
  VoxelFromPatient voxelFromPatient;

  Gathered gather(const RayPart& part, RayHint& hint, ProjectionWork& work) const {
    const VoxelRay ray{(voxelFromPatient * part.ray.origin).p, voxelFromPatient.linear * part.ray.direction.v,
                       part.rayPerDepth};
    Gathered out;
    const bool sampled = !job.exact || gatherOf(job) == Gather::Extreme;
    RayStretch along = part.along;
    if (job.exact)
      along.beginsInside = along.endsInside = false;  // what the search starts with is in the part
    if (sampled) {
      if (kernel)
        kernel(*fast, ray, along, hint, out, work);
      else if (!job.exact)
        out = gatherGeneral(job, ray, along, work);
    }
    return job.exact ? gatherExact(job, ray, along.from_mm, along.to_mm, out, work) : out;
  }
};

// What a pixel's ray has met so far.
struct Along {
  double toolsWeight = 0;                 // alphas of the tools, weakened alike
  glm::dvec3 tools{0};                    // colours of the tools, premultiplied
  double share = 1;                       // of what comes behind
  double grey = 0, value = 0, at_mm = 0;  // Max, Min
  double integral = 0;                    // Sum, Attenuation, Mean
  double length_mm = 0, shareLength = 0;  // Mean
  double weakened = 0;                    // Attenuation: gain times the integral up to here
  bool covered = false;
};

void addExtreme(const ProjectionJob& job, const Gathered& g, Along& a) {
  if (std::isnan(g.best)) return;
  const double grey = a.share * (job.cue > 0 ? g.best : applyVoi(job.window, g.best));
  const bool greatest = job.mode == ProjectionMode::Max;
  if (a.covered && (greatest ? grey <= a.grey : grey >= a.grey)) return;
  a.grey = grey, a.value = g.best, a.at_mm = g.at_mm, a.covered = true;
}

void addPart(const ProjectionJob& job, const Gathered& g, double from, Along& a) {
  switch (job.mode) {
    case ProjectionMode::Max:
    case ProjectionMode::Min:
      return addExtreme(job, g, a);
    case ProjectionMode::Mean:
      a.integral += g.integral, a.length_mm += g.length_mm, a.shareLength += a.share * g.length_mm;
      break;
    case ProjectionMode::Sum:
      a.integral += a.share * g.integral;
      break;
    case ProjectionMode::Attenuation:
      a.weakened += job.gain_perMm * g.integral;
      break;
  }
  if (!(g.length_mm > 0)) return;
  if (!a.covered) a.at_mm = from;
  a.covered = true;
}

void addTool(const ProjectionJob& job, const SurfaceHits::Layer& layer, Along& a) {
  const double seen = a.share * (job.mode == ProjectionMode::Attenuation ? std::exp(-a.weakened) : 1);
  a.tools += seen * glm::dvec3(layer.r, layer.g, layer.b);
  a.toolsWeight += seen * static_cast<double>(layer.alpha);
  a.share *= 1 - static_cast<double>(layer.alpha);
}

// What a ray with data shows by itself; of Attenuation what it lets through. Sets `value` where it is not
// yet.
double greyOf(const ProjectionJob& job, Along& a) {
  switch (job.mode) {
    case ProjectionMode::Sum:
      return a.value = job.gain_perMm * a.integral;
    case ProjectionMode::Attenuation:
      a.value = a.weakened;
      return std::exp(-a.weakened);
    case ProjectionMode::Mean:
      a.value = a.integral / a.length_mm;
      return applyVoi(job.window, a.value) * a.shareLength / a.length_mm;
    default:
      return a.grey;
  }
}

// The projection and the tools together, by the rules in the header. `end`: of the tool that ends the ray.
glm::dvec3 combined(const ProjectionJob& job, Along& a, bool ended, const glm::dvec3& end) {
  const double grey = greyOf(job, a);
  switch (job.mode) {
    case ProjectionMode::Sum:
      return a.tools + a.share * end + grey;
    case ProjectionMode::Attenuation:
      return a.tools + a.share * grey * (ended ? end : glm::dvec3(1));
    default:
      return a.tools + glm::max(glm::dvec3(grey), a.share * end);
  }
}

// Inverted layers in complements, so that tools keep their colours. Sum and Attenuation show on every ray.
glm::dvec3 colourOf(const ProjectionJob& job, Along& a, bool ended, glm::dvec3 end) {
  const glm::dvec3 background(job.background.r, job.background.g, job.background.b);
  const bool everywhere = job.mode == ProjectionMode::Sum || job.mode == ProjectionMode::Attenuation;
  if (!a.covered && !everywhere) return a.tools + a.share * (ended ? end : background);
  if (job.mode == ProjectionMode::Sum && !ended && !job.invert) end = background;
  if (job.invert) a.tools = a.toolsWeight - a.tools;
  if (job.invert && ended) end = 1.0 - end;
  const glm::dvec3 colour = combined(job, a, ended, end);
  return job.invert ? 1.0 - glm::clamp(colour, 0.0, 1.0) : colour;
}

void put(const ProjectionJob& job, Images& images, std::size_t pixel, const glm::dvec3& colour,
         const Along& a, double end_mm) {
  for (int c = 0; c < 3; ++c)
    images.colour[4 * pixel + static_cast<std::size_t>(c)] = static_cast<float>(colour[c]);
  images.colour[4 * pixel + 3] = 1;
  double depth = a.covered ? a.at_mm : end_mm;
  const bool extreme = job.mode == ProjectionMode::Max || job.mode == ProjectionMode::Min;
  const double own = job.invert ? 1 - a.grey : a.grey;
  if (extreme && a.covered && std::isfinite(end_mm) && colour != glm::dvec3(own)) depth = end_mm;
  images.depth[pixel] = static_cast<float>(depth);
  if (!images.values.empty())
    images.values[pixel] = a.covered ? static_cast<float>(a.value) : std::numeric_limits<float>::quiet_NaN();
}

RayPart rayOf(const ProjectionJob& job, int x, int y) {
  const double px = x + 0.5, py = y + 0.5;
  return {x, y, 0, job.camera.ray(px, py), job.camera.rayPerDepth(px, py), {}};
}

// The segment in double: floats hold its ends to some 1e-5 mm, and where they are borders of what takes part
// the plain rays beside it have them exactly.
RayStretch stretchOf(const RaySegment& s, const RaySpan& span) {
  constexpr double kSame = 1e-6;
  const auto border = [&](double own, double exact) {
    return std::abs(own - exact) <= kSame * (1 + std::abs(own)) ? exact : own;
  };
  RayStretch out{static_cast<double>(s.from_mm),
                 static_cast<double>(s.to_mm),
                 s.beginsInside,
                 s.endsInside,
                 span.entry_mm,
                 span.exit_mm};
  if (!s.beginsInside) out.from_mm = border(out.from_mm, span.entry_mm);
  if (!s.endsInside) out.to_mm = border(out.to_mm, span.exit_mm);
  return out;
}

void putSegment(const ProjectionJob& job, Along& a, RaySegment& to) {
  to.covered = to.hasDepth = a.covered;
  if (!a.covered) return;
  const double grey = greyOf(job, a);
  to.colour.fill(static_cast<float>(job.invert ? 1 - std::clamp(grey, 0.0, 1.0) : grey));
  to.depth_mm = static_cast<float>(a.at_mm);
}

// All parts of the job's appearance on a ray that meets a lens, into the first of them; of Attenuation each
// into its own.
template <class Gather>
void drawSegments(const ProjectionJob& job, RayIntervals& rays, std::size_t pixel, RayPart part,
                  Gather&& gather) {
  const RaySpan span = spanOf(part.ray, job.region, job.camera.near_mm * part.rayPerDepth);
  const bool eachItsOwn = job.mode == ProjectionMode::Attenuation;
  RaySegment* first = nullptr;
  Along a;
  eachSegment(rays, pixel, job.rays, [&](std::size_t n) {
    RaySegment& segment = rays.segments[n];
    if (!first) first = &segment;
    part.along = stretchOf(segment, span);
    if (!(part.along.to_mm > part.along.from_mm)) return;
    a.share = static_cast<double>(segment.weight);
    addPart(job, gather(part), part.along.from_mm, a);
    ++part.passed;
    if (!eachItsOwn) return;
    putSegment(job, a, segment);
    a = {};
  });
  if (first && !eachItsOwn) putSegment(job, a, *first);
}

// gather(part) reads what lies between two tools.
template <class Gather>
void drawPixel(const ProjectionJob& job, Images& images, int x, int y, Gather&& gather) {
  const std::size_t pixel =
      static_cast<std::size_t>(x) + static_cast<std::size_t>(images.width) * static_cast<std::size_t>(y);
  RayPart part = rayOf(job, x, y);
  if (images.rays && images.rays->meetsLens(pixel))
    return drawSegments(job, *images.rays, pixel, part, gather);
  if (images.rays && !job.rays.drawsPlainRays()) return;
  const RaySpan span = spanOf(part.ray, job.region, job.camera.near_mm * part.rayPerDepth);
  const SurfaceHits* const tools = job.tools;
  const double end_mm = tools ? static_cast<double>(tools->end_mm[pixel]) : static_cast<double>(kNothing_mm);
  Along a;
  part.along.from_mm = span.entry_mm;
  const double to = span.empty() ? span.entry_mm : std::min(span.exit_mm, end_mm);
  const auto read = [&](double until) {
    if (span.empty() || !(until > part.along.from_mm)) return;
    part.along.to_mm = until;
    addPart(job, gather(part), part.along.from_mm, a);
    part.along.from_mm = until;
  };
  if (tools)
    for (std::uint32_t n = tools->first[pixel]; n < tools->first[pixel + 1]; ++n) {
      read(std::min(to, static_cast<double>(tools->layers[n].t_mm)));
      addTool(job, tools->layers[n], a);
      ++part.passed;
    }
  read(to);
  glm::dvec3 end(0);
  const bool ended = std::isfinite(end_mm);
  if (ended)
    for (std::size_t c = 0; c < 3; ++c)
      end[static_cast<int>(c)] = static_cast<double>(tools->endColour[3 * pixel + c]);
  put(job, images, pixel, colourOf(job, a, ended, end), a, end_mm);
}

Result<void> fit(const ProjectionJob& job, Images& images) {
  images.width = job.camera.width_px, images.height = job.camera.height_px;
  const std::size_t n = static_cast<std::size_t>(images.width) * static_cast<std::size_t>(images.height);
  if (!job.volume || job.volume->isColour())
    return makeError(ErrorCode::Internal, "The job has no grey volume.", "drawProjection");
  if (images.rays && images.rays->first.size() != n + 1)
    return makeError(ErrorCode::Internal, "The rays are cut for a picture of another size.",
                     "drawProjection");
  images.colour.resize(4 * n);
  images.depth.resize(n);
  if (!images.values.empty()) images.values.resize(n);
  return {};
}

// tile(x0, y0, x1, y1), the ends out.
template <class Tile>
Result<void> eachTile(const Images& images, const std::stop_token& stop, Tile&& tile) {
  const int across = (images.width + kTile_px - 1) / kTile_px,
            down = (images.height + kTile_px - 1) / kTile_px;
  parallelFor(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 1,
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t t = begin; t < end && !stop.stop_requested(); ++t) {
                  const int x0 = static_cast<int>(t) % across * kTile_px;
                  const int y0 = static_cast<int>(t) / across * kTile_px;
                  tile(x0, y0, std::min(x0 + kTile_px, images.width), std::min(y0 + kTile_px, images.height));
                }
              });
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The projection was cancelled.");
  return {};
}

}  // namespace

Steps stepsOf(double from_mm, double to_mm, double step_mm, bool extreme) {
  const auto first = static_cast<std::int64_t>(std::floor(from_mm / step_mm));
  const auto last = static_cast<std::int64_t>(std::ceil(to_mm / step_mm)) - 1;
  const Steps met{first, std::max<std::int64_t>(1, last - first + 1)};
  return extreme ? Steps{met.first - 1, met.count + 2} : met;
}

Steps stepsOf(const RayStretch& s, double step_mm, bool extreme) {
  const Steps met = stepsOf(s.from_mm, s.to_mm, step_mm, extreme);
  if (!extreme) return met;
  const auto middleFrom = [&](double t) { return static_cast<std::int64_t>(std::ceil(t / step_mm - 0.5)); };
  const std::int64_t first = s.beginsInside ? middleFrom(s.from_mm) : met.first;
  const std::int64_t beyond = s.endsInside ? middleFrom(s.to_mm) : met.first + met.count;
  return {first, std::max<std::int64_t>(0, beyond - first)};
}

Result<void> drawProjection(const ProjectionJob& job, Images& images, std::stop_token stop) {
  const TraceSpan span("projection");
  if (Result<void> ok = fit(job, images); !ok) return ok;
  if (job.exact)
    if (std::string why = whyNotExact(job); !why.empty())
      return makeError(ErrorCode::Internal, std::move(why), "drawProjection");
  Reader reader{job, fastProjectionOf(job), nullptr, job.volume->voxelFromPatient()};
  if (reader.fast) reader.kernel = fastKernelFor(*reader.fast);
  std::atomic<std::uint64_t> samples{0}, cells{0};
  Result<void> done = eachTile(images, stop, [&](int x0, int y0, int x1, int y1) {
    ProjectionWork work;
    for (int y = y0; y < y1 && !stop.stop_requested(); ++y) {
      RayHint hint;
      for (int x = x0; x < x1; ++x)
        drawPixel(job, images, x, y, [&](const RayPart& part) { return reader.gather(part, hint, work); });
    }
    samples += work.samples, cells += work.cells;
  });
  images.counters.samples += samples;
  images.counters.cells += cells;
  return done;
}

Result<void> drawProjection(const ProjectionJob& job, const PartReader& reader, Images& images,
                            std::stop_token stop) {
  if (Result<void> ok = fit(job, images); !ok) return ok;
  return eachTile(images, stop, [&](int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1 && !stop.stop_requested(); ++y)
      for (int x = x0; x < x1; ++x) drawPixel(job, images, x, y, reader);
  });
}

}  // namespace vernier::native
