// SPDX-License-Identifier: GPL-3.0-or-later
// Where techniques that draw a volume slice by slice put their fragments. Slices are drawn in batches, the
// nearest batch first; within a batch back to front. So that a cancel never waits for more than a batch, and
// so that it is known where half of the light is gone: to within a batch.
//
// What a fragment holds: blend: (colour times opacity, what it lets through), (distance from the entry times
// opacity, -, -, what it lets through). Extremes: (sign times value or channels, 1), (-distance). Iso:
// (colour, 0), (distance), and a depth by the draw's rank, nearest first.
#pragma once
#include <optional>
#include <span>
#include <stop_token>

#include "GlDrawing.h"

namespace vernier::dvr {

inline constexpr std::size_t kBatchSlices = 8;

class SliceTargets {
 public:
  static Result<SliceTargets> make(gpu::Device&, const GlVolumeJob&);
  // Before each part of the rays.
  Result<void> clear();
  // The state that each draw of a batch needs.
  gpu::DrawState state() const;
  Result<void> batch(std::span<const gpu::Draw>, const RayTextures&, std::stop_token);
  Result<DrawnPart> read();

 private:
  SliceTargets(gpu::Device& device, const GlVolumeJob& job) : device_(&device), job_(&job) {}
  Result<void> merge(const RayTextures&);
  gpu::Device* device_;
  const GlVolumeJob* job_;
  std::optional<gpu::Target> batch_, front_, next_;  // iso: batch_ alone
  std::optional<gpu::VertexData> picture_;
  std::shared_ptr<const gpu::Program> merge_;
};

}  // namespace vernier::dvr
