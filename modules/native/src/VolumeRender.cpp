// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/VolumeRender.h"

#include <atomic>
#include <cmath>
#include <optional>

#include "PacketLenses.h"
#include "PacketParts.h"
#include "PacketRays.h"
#include "VolumeColour.h"
#include "VolumeExtreme.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::native {
namespace {

constexpr int kTile_px = 32;

// What draws one picture of mode Blend.
struct Painter {
  const VolumeRenderJob& job;
  Images& images;
  std::shared_ptr<const BrickMarks> marks;
  std::optional<GeneralBlend> general;
  std::optional<ColourBlend> colour;
  std::optional<FastVolume> fast;
  FastBlends kernels;
  // Of appearances drawn together, after the outside; both null where a lens shows nothing.
  struct Inside {
    VolumeRenderJob job;
    std::unique_ptr<const GeneralBlend> general;
    std::shared_ptr<const BrickMarks> marks;
  };
  std::vector<Inside> insides;

  bool together() const { return images.rays && job.rays.which == RaysOfPass::Which::Together; }
  const GeneralBlend* generalOf(int appearance) const {
    return appearance == 0 ? &*general : insides[static_cast<std::size_t>(appearance) - 1].general.get();
  }

  PacketMarks marksOf(int px, int py) const {
    PacketMarks m;
    if (!marks) return m;
    m.seen = {marks->seen(px, py), marks->words(), marks->stepsPerBin(), marks->firstStep()};
    m.holes = marks->holes(px, py);
    return m;
  }
};

// A packet's rays and where they have got to.
struct PacketWork {
  RayPacket rays;
  double until_mm[kPacketRays];      // of the whole ray: the region's end or the tool's
  std::uint32_t layer[kPacketRays];  // next translucent tool
  std::size_t pixel[kPacketRays];
  bool inPicture[kPacketRays];
  RayLight light[kPacketRays];
  PacketLenses lenses;
  LensedMarks lensedMarks;
  std::vector<const std::uint64_t*> seen;
};

void drawParts(const Painter& p, PacketWork& w, const PacketMarks& marks, ProjectionWork& work) {
  if (const FastBlend kernel = w.rays.lenses ? p.kernels.lensed : p.kernels.plain)
    return kernel(*p.fast, w.rays, marks, w.light, work);
  for (int n = 0; n < kPacketRays; ++n) {
    if (!(w.rays.to_mm[n] > w.rays.from_mm[n]) || w.light[n].through < p.job.leastLight) continue;
    if (w.rays.lenses)
      eachPart(w.rays, n, [&](int appearance, double from, double to) {
        const GeneralBlend* const general = p.generalOf(appearance);
        if (general && w.light[n].through >= p.job.leastLight)
          general->along(w.rays.ray(n), w.rays.forward(n), from, to, marks.seen, w.light[n], work);
      });
    else if (p.colour)
      p.colour->along(w.rays.ray(n), w.rays.from_mm[n], w.rays.to_mm[n], w.light[n], work);
    else
      p.general->along(w.rays.ray(n), w.rays.forward(n), w.rays.from_mm[n], w.rays.to_mm[n], marks.seen,
                       w.light[n], work);
  }
}

void addTool(const SurfaceHits::Layer& l, RayLight& light) {
  const double t = static_cast<double>(l.t_mm);
  light.add(glm::dvec3(l.r, l.g, l.b), static_cast<double>(l.alpha), t, t);
}

// Part after part, with the translucent tools between them.
void drawWithTools(const Painter& p, PacketWork& w, const PacketMarks& marks, ProjectionWork& work) {
  const SurfaceHits& tools = *p.job.tools;
  double begin[kPacketRays];
  for (int n = 0; n < kPacketRays; ++n) begin[n] = w.rays.from_mm[n];
  for (bool more = true; more;) {
    more = false;
    for (int n = 0; n < kPacketRays; ++n) {
      const bool layered = w.inPicture[n] && w.layer[n] < tools.first[w.pixel[n] + 1];
      const double end = layered ? static_cast<double>(tools.layers[w.layer[n]].t_mm) : w.until_mm[n];
      w.rays.from_mm[n] = begin[n], w.rays.to_mm[n] = std::min(end, w.until_mm[n]);
    }
    drawParts(p, w, marks, work);
    for (int n = 0; n < kPacketRays; ++n) {
      begin[n] = std::max(begin[n], w.rays.to_mm[n]);
      if (!w.inPicture[n]) continue;
      if (w.layer[n] < tools.first[w.pixel[n] + 1]) {
        addTool(tools.layers[w.layer[n]++], w.light[n]);
        more = true;
      }
    }
  }
}

void put(const Painter& p, PacketWork& w, int n) {
  const VolumeRenderJob& job = p.job;
  RayLight& light = w.light[n];
  glm::dvec3 end = colourOf(job.background);
  if (job.tools && std::isfinite(job.tools->end_mm[w.pixel[n]])) {
    for (std::size_t c = 0; c < 3; ++c)
      end[static_cast<int>(c)] = static_cast<double>(job.tools->endColour[3 * w.pixel[n] + c]);
    if (light.through > 0.5) light.half_mm = static_cast<double>(job.tools->end_mm[w.pixel[n]]);
  }
  const glm::dvec3 colour = light.colour + light.through * end;
  float* const out = p.images.colour.data() + 4 * w.pixel[n];
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(colour[c]);
  out[3] = 1;
  p.images.depth[w.pixel[n]] = static_cast<float>(light.half_mm);
}

// A packet where neither the volume nor a tool is seen.
void putBackground(const Painter& p, int x0, int y0) {
  const Rgb& b = p.job.background;
  for (int y = y0; y < std::min(y0 + kPacketEdge_px, p.images.height); ++y)
    for (int x = x0; x < std::min(x0 + kPacketEdge_px, p.images.width); ++x) {
      const std::size_t pixel = static_cast<std::size_t>(x) +
                                static_cast<std::size_t>(p.images.width) * static_cast<std::size_t>(y);
      float* const out = p.images.colour.data() + 4 * pixel;
      out[0] = static_cast<float>(b.r), out[1] = static_cast<float>(b.g), out[2] = static_cast<float>(b.b),
      out[3] = 1;
      p.images.depth[pixel] = kNothing_mm;
    }
}

// The parts of rays that meet lenses, round by round: in each, one part of every ray that has one.
void drawSegments(const Painter& p, PacketRays& rays, int x0, int y0, PacketWork& w, ProjectionWork& work) {
  PacketParts parts(*p.images.rays, p.job.rays, x0, y0);
  if (parts.none()) return;
  const int px = x0 / kPacketEdge_px, py = y0 / kPacketEdge_px;
  if (p.marks && !p.marks->any(px, py)) return;
  const PacketMarks marks = p.marksOf(px, py);
  rays.set(x0, y0, w.rays);
  for (int round = 0; parts.next(round, w.rays, p.job.leastLight); ++round) {
    for (int n = 0; n < kPacketRays; ++n) {
      w.light[n] = {};
      w.light[n].through = parts.before(n);
    }
    drawParts(p, w, marks, work);
    for (int n = 0; n < kPacketRays; ++n)
      if (RaySegment* s = parts.segment(n)) parts.put(*s, w.light[n], parts.before(n));
  }
}

// The marks of a packet whose rays meet lenses that are drawn together with the outside.
PacketMarks lensedMarks(const Painter& p, PacketWork& w, int px, int py) {
  PacketMarks m = p.marksOf(px, py);
  if (!p.marks) return m;
  w.seen.assign(1, m.seen.seen);
  for (const Painter::Inside& inside : p.insides)
    w.seen.push_back(inside.marks ? inside.marks->seen(px, py) : nullptr);
  m.seen.seen = w.lensedMarks.of(w.rays, m.seen, p.job.step_mm, w.seen);
  return m;
}

void drawPacket(const Painter& p, PacketRays& rays, int x0, int y0, PacketWork& w, ProjectionWork& work) {
  const SurfaceHits* const tools = p.job.tools;
  const int px = x0 / kPacketEdge_px, py = y0 / kPacketEdge_px;
  const RayIntervals* const cut = p.together() ? nullptr : p.images.rays.get();
  const bool lensed = p.together() && setLenses(p.images.rays->lenses, x0, y0, w.lenses);
  w.rays.lenses = lensed ? &w.lenses : nullptr;
  if (cut) {
    if (meetsLens(*cut, x0, y0)) drawSegments(p, rays, x0, y0, w, work);
    if (!p.job.rays.drawsPlainRays()) return;
  }
  if (!tools && !lensed && p.marks && !p.marks->any(px, py)) return putBackground(p, x0, y0);
  rays.set(x0, y0, w.rays);
  for (int n = 0; n < kPacketRays; ++n) {
    const int x = x0 + n % kPacketEdge_px, y = y0 + n / kPacketEdge_px;
    w.light[n] = {};
    w.inPicture[n] = x < p.images.width && y < p.images.height;
    w.pixel[n] =
        static_cast<std::size_t>(x) + static_cast<std::size_t>(p.images.width) * static_cast<std::size_t>(y);
    if (w.inPicture[n] && cut && cut->meetsLens(w.pixel[n])) w.inPicture[n] = false;
    if (!w.inPicture[n]) {
      w.rays.to_mm[n] = w.rays.from_mm[n] - 1, w.until_mm[n] = w.rays.to_mm[n];
      continue;
    }
    if (!tools) continue;
    w.layer[n] = tools->first[w.pixel[n]];
    w.until_mm[n] = std::min(w.rays.to_mm[n], static_cast<double>(tools->end_mm[w.pixel[n]]));
  }
  const PacketMarks marks = lensed ? lensedMarks(p, w, px, py) : p.marksOf(px, py);
  tools ? drawWithTools(p, w, marks, work) : drawParts(p, w, marks, work);
  for (int n = 0; n < kPacketRays; ++n)
    if (w.inPicture[n]) put(p, w, n);
}

bool tableFits(const VolumeRenderJob& job, const TransferTable* post, const PreIntegratedTable* pair) {
  if (job.classification == Classification::Pre) return true;
  return job.classification == Classification::Post ? post && post->step_mm == job.step_mm
                                                    : pair && pair->step_mm == job.step_mm;
}

std::string whatDoesNotFit(const VolumeRenderJob& job) {
  if (!job.volume) return "The job has no volume.";
  if (!(job.step_mm > 0) || !std::isfinite(job.step_mm)) return "The step is no length.";
  if (job.volume->isColour())
    return job.classification != Classification::Post || job.shading != ShadingModel::None
               ? "Colour volumes are neither classified nor shaded."
               : "";
  if (!job.function) return "The job has no transfer function.";
  if (job.mode != VolumeMode::Blend) return "";
  for (const VolumeInside& inside : job.insides)
    if (inside.function && !tableFits(job, inside.table, inside.preIntegrated))
      return "An inside has no table for the step.";
  if (!tableFits(job, job.table, job.preIntegrated)) return "The job has no table for its step.";
  if (job.classification == Classification::PreIntegrated && job.opacity == OpacityRule::Linear)
    return "Pre-integrated tables know the exact rule only.";
  return "";
}

void addInsides(Painter& p) {
  for (const VolumeInside& inside : p.job.insides) {
    Painter::Inside& out = p.insides.emplace_back();
    out.job = p.job;
    if (!inside.function) continue;
    out.job.function = inside.function, out.job.table = inside.table;
    out.job.preIntegrated = inside.preIntegrated;
    if (inside.visible && p.marks)
      out.marks =
          marksOf(*inside.visible, p.job.volume->grid(), p.job.camera, p.job.step_mm, p.images.rays.get());
  }
  // They refer to their jobs, which stay where they are from here on.
  for (std::size_t n = 0; n < p.insides.size(); ++n)
    if (p.job.insides[n].function)
      p.insides[n].general = std::make_unique<const GeneralBlend>(p.insides[n].job);
}

}  // namespace

Result<void> renderVolume(const VolumeRenderJob& job, Images& images, std::stop_token stop) {
  if (std::string why = whatDoesNotFit(job); !why.empty())
    return makeError(ErrorCode::Internal, std::move(why), "renderVolume");
  if (job.mode != VolumeMode::Blend) return renderExtreme(job, images, stop);
  if (job.rays.which == RaysOfPass::Which::Together &&
      (!images.rays || images.rays->lenses.size() != job.insides.size() ||
       job.insides.size() > kMostInsides || job.volume->isColour()))
    return makeError(ErrorCode::Internal, "The job's insides are not those of the rays.", "renderVolume");
  const TraceSpan span("volume rendering");
  images.width = job.camera.width_px, images.height = job.camera.height_px;
  const std::size_t count = static_cast<std::size_t>(images.width) * static_cast<std::size_t>(images.height);
  images.colour.resize(4 * count), images.depth.resize(count);
  Painter painter{job, images, {}, {}, {}, fastVolumeOf(job), {}, {}};
  job.volume->isColour() ? (void)painter.colour.emplace(job) : (void)painter.general.emplace(job);
  if (job.visible && job.volume->grid().even())
    painter.marks = marksOf(*job.visible, job.volume->grid(), job.camera, job.step_mm, images.rays.get());
  if (painter.together()) addInsides(painter);
  if (painter.fast) {
    painter.fast->general = &*painter.general;
    painter.kernels = fastBlendsFor(*painter.fast);
    for (int n = 0; painter.together() && n <= static_cast<int>(painter.insides.size()); ++n)
      painter.fast->looks.general.push_back(painter.generalOf(n));
  }
  const int across = (images.width + kTile_px - 1) / kTile_px,
            down = (images.height + kTile_px - 1) / kTile_px;
  std::atomic<std::uint64_t> samples{0};
  parallelFor(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 1,
              [&](std::size_t begin, std::size_t end) {
                PacketRays rays(job.camera, job.region,
                                job.volume->isColour() ? job.volume->channel(0) : *job.volume);
                PacketWork packet;
                for (std::size_t t = begin; t < end; ++t) {
                  const int x0 = static_cast<int>(t) % across * kTile_px,
                            y0 = static_cast<int>(t) / across * kTile_px;
                  ProjectionWork work;
                  for (int y = y0; y < std::min(y0 + kTile_px, images.height) && !stop.stop_requested();
                       y += kPacketEdge_px)
                    for (int x = x0; x < std::min(x0 + kTile_px, images.width); x += kPacketEdge_px)
                      drawPacket(painter, rays, x, y, packet, work);
                  samples += work.samples;
                }
              });
  if (painter.together()) images.rays.reset();
  images.counters.samples += samples;
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The volume rendering was cancelled.");
  return {};
}

}  // namespace vernier::native
