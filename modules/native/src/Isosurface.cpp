// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Isosurface.h"

#include <atomic>
#include <optional>
#include <variant>

#include "IsosurfaceRay.h"
#include "PacketParts.h"
#include "PacketRays.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::native {
namespace {

constexpr int kTile_px = 32;

// What draws one picture; Iso: ExactIso or SampledIso.
template <class Iso>
class Painter {
 public:
  Painter(const IsosurfaceJob& job, Images& images)
      : job_(job),
        images_(images),
        iso_(job),
        lighting_(job.material, job.lights),
        patientGradient_(patientGradients(*job.volume)) {
    if (job.reaching && job.volume->grid().even())
      marks_ = marksOf(*job.reaching, job.volume->grid(), job.camera, job.step_mm, images.rays.get());
  }

  void packet(PacketRays& rays, int x0, int y0, ProjectionWork& work) const {
    RayPacket packet;
    RayMarks marks;
    if (marks_) {
      const int px = x0 / kPacketEdge_px, py = y0 / kPacketEdge_px;
      marks = {marks_->seen(px, py), marks_->words(), marks_->stepsPerBin(), marks_->firstStep()};
    }
    const bool empty = marks_ && !marks_->any(x0 / kPacketEdge_px, y0 / kPacketEdge_px);
    if (!empty) rays.set(x0, y0, packet);
    const RayIntervals* const cut = images_.rays.get();
    if (cut) {
      if (!empty && meetsLens(*cut, x0, y0)) segments(packet, x0, y0, marks, work);
      if (!job_.rays.drawsPlainRays()) return;
      if (!empty) rays.set(x0, y0, packet);
    }
    for (int n = 0; n < kPacketRays; ++n) {
      const int x = x0 + n % kPacketEdge_px, y = y0 + n / kPacketEdge_px;
      if (x >= images_.width || y >= images_.height) continue;
      const std::size_t pixel =
          static_cast<std::size_t>(x) + static_cast<std::size_t>(images_.width) * static_cast<std::size_t>(y);
      if (cut && cut->meetsLens(pixel)) continue;
      double to = empty ? -1 : packet.to_mm[n];
      if (job_.tools && !empty) to = std::min(to, static_cast<double>(job_.tools->end_mm[pixel]));
      IsoHit hit;
      if (!empty && to > packet.from_mm[n])
        hit = iso_.first(packet.ray(n), packet.from_mm[n], to, marks, work);
      put(pixel, hit, hit.found() ? lit(hit, packet.forward(n)) : glm::dvec3(0));
    }
  }

 private:
  // The parts of rays that meet lenses: an iso-surface lets nothing through.
  void segments(RayPacket& packet, int x0, int y0, const RayMarks& marks, ProjectionWork& work) const {
    PacketParts parts(*images_.rays, job_.rays, x0, y0);
    for (int round = 0; parts.next(round, packet, kReferenceLeastLight); ++round)
      for (int n = 0; n < kPacketRays; ++n) {
        RaySegment* const s = parts.segment(n);
        if (!s || !(packet.to_mm[n] > packet.from_mm[n])) continue;
        const IsoHit hit = iso_.first(packet.ray(n), packet.from_mm[n], packet.to_mm[n], marks, work);
        if (!hit.found()) continue;
        RayLight light;
        light.colour = lit(hit, packet.forward(n)), light.through = 0, light.half_mm = hit.t_mm;
        PacketParts::put(*s, light, 1);
      }
  }

  glm::dvec3 lit(const IsoHit& hit, const glm::dvec3& forward) const {
    const glm::dvec3 gradient = hit.atBegin ? -forward : patientGradient_ * hit.gradient;
    return lighting_.lit(colourOf(job_.material.ambientColour), colourOf(job_.material.diffuseColour),
                         gradient, -forward);
  }

  // The surface or what else ends the ray, behind the translucent tools before it.
  void put(std::size_t pixel, const IsoHit& hit, const glm::dvec3& surface) const {
    glm::dvec3 end = hit.found() ? surface : colourOf(job_.background), sum(0);
    double through = 1, depth = hit.t_mm;
    if (const SurfaceHits* tools = job_.tools) {
      if (!hit.found() && std::isfinite(tools->end_mm[pixel])) {
        depth = static_cast<double>(tools->end_mm[pixel]);
        for (std::size_t c = 0; c < 3; ++c)
          end[static_cast<int>(c)] = static_cast<double>(tools->endColour[3 * pixel + c]);
      }
      for (std::uint32_t n = tools->first[pixel]; n < tools->first[pixel + 1]; ++n) {
        const SurfaceHits::Layer& l = tools->layers[n];
        if (static_cast<double>(l.t_mm) > hit.t_mm) break;
        sum += through * glm::dvec3(l.r, l.g, l.b);
        through *= 1 - static_cast<double>(l.alpha);
      }
    }
    const glm::dvec3 colour = sum + through * end;
    for (int c = 0; c < 3; ++c)
      images_.colour[4 * pixel + static_cast<std::size_t>(c)] = static_cast<float>(colour[c]);
    images_.colour[4 * pixel + 3] = 1;
    images_.depth[pixel] = static_cast<float>(depth);
  }

  const IsosurfaceJob& job_;
  Images& images_;
  Iso iso_;
  Lighting lighting_;
  glm::dmat3 patientGradient_;
  std::shared_ptr<const BrickMarks> marks_;
};

template <class Iso>
void draw(const IsosurfaceJob& job, Images& images, const std::stop_token& stop) {
  const Painter<Iso> painter(job, images);
  const int across = (images.width + kTile_px - 1) / kTile_px,
            down = (images.height + kTile_px - 1) / kTile_px;
  std::atomic<std::uint64_t> samples{0}, cells{0};
  parallelFor(static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 1,
              [&](std::size_t begin, std::size_t end) {
                PacketRays rays(job.camera, job.region, *job.volume);
                for (std::size_t t = begin; t < end; ++t) {
                  const int x0 = static_cast<int>(t) % across * kTile_px,
                            y0 = static_cast<int>(t) / across * kTile_px;
                  ProjectionWork work;
                  for (int y = y0; y < std::min(y0 + kTile_px, images.height) && !stop.stop_requested();
                       y += kPacketEdge_px)
                    for (int x = x0; x < std::min(x0 + kTile_px, images.width); x += kPacketEdge_px)
                      painter.packet(rays, x, y, work);
                  samples += work.samples, cells += work.cells;
                }
              });
  images.counters.samples += samples;
  images.counters.cells += cells;
}

template <class T>
void drawOf(const IsosurfaceJob& job, Images& images, const std::stop_token& stop) {
  findsExactly(job) ? draw<ExactIso<T>>(job, images, stop) : draw<SampledIso<T>>(job, images, stop);
}

void drawAny(const IsosurfaceJob& job, Images& images, const std::stop_token& stop) {
  switch (job.volume->type()) {
    case VoxelType::U8:
      return drawOf<std::uint8_t>(job, images, stop);
    case VoxelType::I8:
      return drawOf<std::int8_t>(job, images, stop);
    case VoxelType::U16:
      return drawOf<std::uint16_t>(job, images, stop);
    case VoxelType::I16:
      return drawOf<std::int16_t>(job, images, stop);
    case VoxelType::U32:
      return drawOf<std::uint32_t>(job, images, stop);
    case VoxelType::I32:
      return drawOf<std::int32_t>(job, images, stop);
    case VoxelType::F32:
      break;
  }
  return drawOf<float>(job, images, stop);
}

}  // namespace

bool findsExactly(const IsosurfaceJob& job) {
  const Volume& v = *job.volume;
  return v.grid().even() && v.info().rescale.size() == 1 && !v.info().noData &&
         !(v.type() == VoxelType::F32 && mayHoldNan(v));
}

Result<void> drawIsosurface(const IsosurfaceJob& job, Images& images, std::stop_token stop) {
  if (!job.volume || job.volume->isColour() || !(job.step_mm > 0))
    return makeError(ErrorCode::Internal, "The job has no grey volume.", "drawIsosurface");
  const TraceSpan span("iso-surface");
  images.width = job.camera.width_px, images.height = job.camera.height_px;
  const std::size_t count = static_cast<std::size_t>(images.width) * static_cast<std::size_t>(images.height);
  images.colour.resize(4 * count), images.depth.resize(count);
  drawAny(job, images, stop);
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The iso-surface was cancelled.");
  return {};
}

}  // namespace vernier::native
