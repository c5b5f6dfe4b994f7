// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/SlabExact.h"

#include <atomic>

#include "ExactField.h"
#include "SliceKernel.h"
#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

// Narrow, as the sampled slabs: a tile's lines read a part of the volume that stays in the nearest caches.
constexpr int kTileWidth_px = 64, kTileHeight_px = 16;

// The lines of a picture: pixel (x, y) runs from origin + x right + y down over `whole`, in voxels.
struct Lines {
  glm::dvec3 origin{0}, right{0}, down{0}, whole{0};
};

Lines linesOf(const SliceJob& job) {
  SliceJob middle = job;
  middle.slabSamples = 1;
  const VoxelLattice l = latticeOf(middle);  // the plane itself, and the whole slab as its step
  return {l.origin - 0.5 * l.step, l.right, l.down, l.step};
}

template <class T>
ExactWork drawTile(const SliceJob& job, const Lines& lines, const Display& display, const Target& target,
                   const Tile& tile, const std::stop_token& stop) {
  const CellGrid<T> grid = cellGridOf<T>(*job.volume);
  const ModalityRescale rescale = job.volume->rescaleOf(0);
  // Of stored values: a negative slope turns maximum and minimum over.
  const bool greatest = (job.slab.mode == SlabMode::Max) == (rescale.slope > 0);
  ExactWork work;
  for (int y = tile.y0; y < tile.y1 && !stop.stop_requested(); ++y) {
    Greatest<T> extreme(greatest ? 1 : -1);
    for (int x = tile.x0; x < tile.x1; ++x) {
      const glm::dvec3 a =
          lines.origin + static_cast<double>(x) * lines.right + static_cast<double>(y) * lines.down;
      CellWalk<T> walk(grid, a, lines.whole);
      double modality = std::numeric_limits<double>::quiet_NaN();
      if (walk.meetsVolume())
        modality =
            rescale.intercept + rescale.slope * (job.slab.mode == SlabMode::Mean ? meanAlong(walk, work)
                                                                                 : extreme.along(walk, work));
      putPixel(display, target, x, y, modality);
    }
  }
  return work;
}

using ExactKernel = ExactWork (*)(const SliceJob&, const Lines&, const Display&, const Target&, const Tile&,
                                  const std::stop_token&);

ExactKernel kernelFor(VoxelType type) {
  switch (type) {
    case VoxelType::U8:
      return drawTile<std::uint8_t>;
    case VoxelType::I8:
      return drawTile<std::int8_t>;
    case VoxelType::U16:
      return drawTile<std::uint16_t>;
    case VoxelType::I16:
      return drawTile<std::int16_t>;
    case VoxelType::U32:
      return drawTile<std::uint32_t>;
    case VoxelType::I32:
      return drawTile<std::int32_t>;
    case VoxelType::F32:
      break;
  }
  return drawTile<float>;
}

}  // namespace

std::string whyNotExactSlab(const SliceJob& job) {
  const Volume& v = *job.volume;
  if (!(job.slab.thickness_mm > 0)) return "It draws slabs, and a single slice has no thickness.";
  if (job.interpolation != Interpolation::Linear)
    return job.interpolation == Interpolation::Cubic
               ? "It follows the linear field, and cubic was asked for."
               : "It follows the linear field, and nearest was asked for.";
  if (!v.grid().even()) return "It needs evenly spaced slices without a gap.";
  if (v.info().rescale.size() > 1) return "It needs one rescale for all slices.";
  if (v.info().noData) return "It needs data in every voxel, and the volume declares padding.";
  if (v.type() == VoxelType::F32 && mayHoldNan(v))
    return "It needs data in every voxel, and some may not be a number.";
  return "";
}

double cellsPerSlabLine(const SliceJob& job) {
  const glm::dvec3 whole = linesOf(job).whole;
  const GridGeometry& g = job.volume->grid();
  return 1 + std::min(std::abs(whole.x), static_cast<double>(g.columns)) +
         std::min(std::abs(whole.y), static_cast<double>(g.rows)) +
         std::min(std::abs(whole.z), static_cast<double>(g.slices));
}

Result<void> drawSlabExact(const SliceJob& job, Images& images, std::stop_token stop) {
  const std::size_t pixels = static_cast<std::size_t>(job.width_px) * static_cast<std::size_t>(job.height_px);
  if (job.width_px < 1 || job.height_px < 1 || images.width != job.width_px ||
      images.height != job.height_px || images.colour.size() != 4 * pixels || images.depth.size() != pixels ||
      (!images.values.empty() && images.values.size() != pixels))
    return makeError(ErrorCode::Internal, "The images of the frame do not have the size of the slab.",
                     "drawSlabExact");
  if (std::string why = whyNotExactSlab(job); !why.empty())
    return makeError(ErrorCode::Internal, std::move(why), "drawSlabExact");
  const Lines lines = linesOf(job);
  const Display display = displayOf(job);
  const Target target{job.width_px, images.colour.data(), images.depth.data(),
                      images.values.empty() ? nullptr : images.values.data()};
  const ExactKernel kernel = kernelFor(job.volume->type());
  const int tilesX = (job.width_px + kTileWidth_px - 1) / kTileWidth_px;
  const int tilesY = (job.height_px + kTileHeight_px - 1) / kTileHeight_px;
  std::atomic<std::uint64_t> cells{0}, samples{0};
  parallelFor(static_cast<std::size_t>(tilesX) * static_cast<std::size_t>(tilesY), 1,
              [&](std::size_t begin, std::size_t end) {
                for (std::size_t t = begin; t < end && !stop.stop_requested(); ++t) {
                  const int x0 = static_cast<int>(t) % tilesX * kTileWidth_px;
                  const int y0 = static_cast<int>(t) / tilesX * kTileHeight_px;
                  const Tile tile{x0, std::min(x0 + kTileWidth_px, job.width_px), y0,
                                  std::min(y0 + kTileHeight_px, job.height_px)};
                  const ExactWork work = kernel(job, lines, display, target, tile, stop);
                  cells += work.cells;
                  samples += work.samples;
                }
              });
  images.counters.cells += cells;
  images.counters.samples += samples;
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The slab was cancelled.");
  return {};
}

}  // namespace vernier::native
