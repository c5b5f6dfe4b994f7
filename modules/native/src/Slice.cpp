// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Slice.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "SliceFast.h"
#include "SliceKernel.h"
#include "vernier/base/Threads.h"

namespace vernier::native {

// Narrow tiles keep the part of the volume that a tile of a slab reads in the nearest caches.
constexpr int kTileWidth_px = 64, kTileHeight_px = 32;

VoxelLattice latticeOf(const SliceJob& job) {
  const VoxelFromPatient& m = job.volume->voxelFromPatient();
  const int n = std::max(1, job.slabSamples);
  const double step_mm = job.slab.thickness_mm / n;
  const double first_mm = 0.5 * step_mm - 0.5 * job.slab.thickness_mm;
  VoxelLattice l;
  l.samples = n;
  l.right = (m * job.picture.right).v;
  l.down = (m * job.picture.down).v;
  l.step = (m * (job.picture.normal * step_mm)).v;
  const PatientPoint first = job.picture.origin + 0.5 * job.picture.right + 0.5 * job.picture.down;
  l.origin = (m * (n == 1 ? first : first + first_mm * job.picture.normal)).p;
  return l;
}

Display displayOf(const SliceJob& job) {
  Display d;
  d.window = job.window;
  d.invert = job.invert;
  d.background[0] = static_cast<float>(job.background.r);
  d.background[1] = static_cast<float>(job.background.g);
  d.background[2] = static_cast<float>(job.background.b);
  if (job.window.function == VoiFunction::Sigmoid) return d;
  const VoiRamp ramp = rampOf(job.window);
  if (!(ramp.hi > ramp.lo)) return d;  // a step: compared exactly
  d.ramp = true;
  d.scale = 1.0 / (ramp.hi - ramp.lo);
  d.offset = -ramp.lo * d.scale;
  if (job.invert) d.scale = -d.scale, d.offset = 1.0 - d.offset;
  return d;
}

void putPixel(const Display& display, const Target& target, int x, int y, double modality) {
  const std::size_t n =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(target.width) + static_cast<std::size_t>(x);
  float* rgba = target.colour + 4 * n;
  const bool data = !std::isnan(modality);
  const float grey = data ? static_cast<float>(display.grey(modality)) : 0.0f;
  for (int c = 0; c < 3; ++c) rgba[c] = data ? grey : display.background[c];
  rgba[3] = 1.0f;
  target.depth[n] = data ? 0.0f : kNothing_mm;
  if (target.values) target.values[n] = static_cast<float>(modality);
}

bool drawsFast(const SliceJob& job) { return fastSliceOf(job, latticeOf(job), displayOf(job)).has_value(); }

Result<void> drawSlice(const SliceJob& job, Images& images, std::stop_token stop) {
  const std::size_t pixels = static_cast<std::size_t>(job.width_px) * static_cast<std::size_t>(job.height_px);
  if (job.width_px < 1 || job.height_px < 1 || images.width != job.width_px ||
      images.height != job.height_px || images.colour.size() != 4 * pixels || images.depth.size() != pixels ||
      (!images.values.empty() && images.values.size() != pixels))
    return makeError(ErrorCode::Internal, "The images of the frame do not have the size of the slice.",
                     "drawSlice");
  const VoxelLattice lattice = latticeOf(job);
  const Display display = displayOf(job);
  const Target target{job.width_px, images.colour.data(), images.depth.data(),
                      images.values.empty() ? nullptr : images.values.data()};
  const std::optional<FastSlice> fast = fastSliceOf(job, lattice, display);
  const TileKernel general = generalKernel(job.volume->type());
  const int tilesX = (job.width_px + kTileWidth_px - 1) / kTileWidth_px;
  const int tilesY = (job.height_px + kTileHeight_px - 1) / kTileHeight_px;
  std::atomic<std::uint64_t> samples{0};
  parallelFor(static_cast<std::size_t>(tilesX) * static_cast<std::size_t>(tilesY), 1,
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t t = begin; t < end && !stop.stop_requested(); ++t) {
                  const int x0 = static_cast<int>(t) % tilesX * kTileWidth_px;
                  const int y0 = static_cast<int>(t) / tilesX * kTileHeight_px;
                  const Tile tile{x0, std::min(x0 + kTileWidth_px, job.width_px), y0,
                                  std::min(y0 + kTileHeight_px, job.height_px)};
                  samples += fast ? drawFast(*fast, job, lattice, display, target, tile, stop)
                                  : general(job, lattice, display, target, tile, stop);
                }
              });
  images.counters.samples += samples;
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The slice was cancelled.");
  return {};
}

}  // namespace vernier::native
