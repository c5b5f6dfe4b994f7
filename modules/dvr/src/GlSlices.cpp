// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlSlices.h"

#include <array>

namespace vernier::dvr {
namespace {
constexpr float kNone = -3e38f;  // less than any value
constexpr glm::vec4 kNothingSeen{0, 0, 0, 1}, kNoExtreme{kNone, kNone, kNone, 0}, kNotFound{-1, 0, 0, 1};
}  // namespace

Result<SliceTargets> SliceTargets::make(gpu::Device& device, const GlVolumeJob& job) {
  SliceTargets t(device, job);
  const std::array formats{gpu::Format::Rgba32F, gpu::Format::Rgba32F};
  const auto target = [&] {
    return device.target(job.camera.width_px, job.camera.height_px, formats, job.iso);
  };
  Result<gpu::Target> made = target();
  if (!made) return made.error();
  t.batch_ = *std::move(made);
  if (job.iso) return t;
  for (std::optional<gpu::Target>* at : {&t.front_, &t.next_}) {
    made = target();
    if (!made) return made.error();
    *at = *std::move(made);
  }
  Result<gpu::VertexData> picture = wholePicture(device, job);
  if (!picture) return picture.error();
  t.picture_ = *std::move(picture);
  auto program =
      device.program("dvr merge", shaderOf("", {"picture.vert.glsl"}), shaderOf("", {"merge.frag.glsl"}));
  if (!program) return program.error();
  t.merge_ = *program;
  return t;
}

Result<void> SliceTargets::clear() {
  gpu::Target& target = job_->iso ? *batch_ : *front_;
  if (Result<void> r = device_->clear(target, 0, job_->extreme() ? kNoExtreme : kNothingSeen); !r) return r;
  if (Result<void> r = device_->clear(target, 1, kNotFound); !r) return r;
  return job_->iso ? device_->clearDepth(target, 1) : Result<void>();
}

gpu::DrawState SliceTargets::state() const {
  gpu::DrawState s;
  if (job_->iso)
    s.depth = gpu::DepthTest::Less, s.depthWrite = true;
  else
    s.blend = job_->extreme() ? gpu::Blend::Max : gpu::Blend::Remaining;
  return s;
}

Result<void> SliceTargets::batch(std::span<const gpu::Draw> draws, const RayTextures& rays,
                                 std::stop_token stop) {
  if (draws.empty()) return {};
  if (stop.stop_requested()) return drawingCancelled();
  if (!job_->iso) {
    if (Result<void> r = device_->clear(*batch_, 0, job_->extreme() ? kNoExtreme : kNothingSeen); !r)
      return r;
    if (Result<void> r = device_->clear(*batch_, 1, job_->extreme() ? kNoExtreme : kNothingSeen); !r)
      return r;
  }
  if (Result<void> r = device_->draw(*batch_, draws); !r) return r;
  if (Result<void> r = device_->limits().software ? device_->finish() : Result<void>(); !r) return r;
  return job_->iso ? Result<void>() : merge(rays);
}

Result<void> SliceTargets::merge(const RayTextures& rays) {
  gpu::Draw d;
  d.program = merge_.get(), d.vertices = &*picture_, d.count = 4;
  d.primitive = gpu::Primitive::TriangleStrip;
  d.textures = {{"frontSeen", &front_->colour(0)},
                {"frontFound", &front_->colour(1)},
                {"batchSeen", &batch_->colour(0)},
                {"batchFound", &batch_->colour(1)}};
  rays.addTo(d);
  d.uniforms = {{"size_px", glm::vec2(job_->camera.width_px, job_->camera.height_px)},
                {"rank", 0.0f},
                {"extreme", job_->extreme() ? 1 : 0}};
  if (Result<void> r = device_->draw(*next_, {&d, 1}); !r) return r;
  std::swap(front_, next_);
  return {};
}

Result<DrawnPart> SliceTargets::read() {
  Result<DrawnPart> part = readBack(*device_, job_->iso ? *batch_ : *front_);
  if (!part) return part;
  const std::size_t pixels = part->found.size() / 4;
  const float sign = signOfExtreme(*job_);
  for (std::size_t p = 0; p < pixels; ++p) {
    part->found[4 * p + 1] = 0;
    if (!job_->extreme()) continue;
    part->found[4 * p + 2] = sign * part->seen[4 * p];
    for (std::size_t c = 0; c < 3; ++c) part->seen[4 * p + c] *= sign;
  }
  return part;
}

}  // namespace vernier::dvr
