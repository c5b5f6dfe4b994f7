// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/SlabExact.h"

#include <atomic>

#include "ExactLine.h"
#include "SliceKernel.h"
#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

// Narrow, as the sampled slabs: a tile's lines read a part of the volume that stays in the nearest caches.
constexpr int kTileWidth_px = 64, kTileHeight_px = 16;

struct Work {
  std::uint64_t cells = 0, samples = 0;
};

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
CellGrid<T> cellGridOf(const Volume& volume) {
  const GridGeometry& g = volume.grid();
  return {reinterpret_cast<const T*>(volume.data()),
          {g.columns - 1, g.rows - 1, g.slices - 1},
          {1, g.columns, g.columns * g.rows}};
}

// Stored values where `sign` is -1 are turned over, so that a minimum is a maximum too.
template <class T>
void signedCorners(const T* v, double sign, double* out) {
  for (int n = 0; n < 8; ++n) out[n] = sign * static_cast<double>(v[n]);
}

// The greatest value of one line after the other. The place of the last line's maximum is tried first:
// neighbouring lines often share it, and a good start leaves out most cells.
template <class T>
class Greatest {
 public:
  explicit Greatest(double sign) : sign_(sign) {}

  double along(CellWalk<T>& walk, Work& work) {
    best_ = -std::numeric_limits<double>::infinity();
    if (place_ > walk.begin() && place_ < walk.end()) {
      walk.enter(place_);
      take(valueAt(walk, place_), place_, work);
    }
    walk.enter(walk.begin());
    take(valueAt(walk, walk.begin()), walk.begin(), work);
    for (;; walk.step()) {
      ++work.cells;
      piece(walk, work);
      if (walk.atEnd()) break;
    }
    return sign_ * best_;
  }

 private:
  void take(double value, double t, Work& work) {
    ++work.samples;
    if (value > best_) best_ = value, place_ = t;
  }

  double valueAt(const CellWalk<T>& walk, double t) const {
    T stored[8];
    double v[8], f[3];
    walk.corners(stored);
    signedCorners(stored, sign_, v);
    walk.fractions(t, f);
    return trilinear(v, f);
  }

  bool mayWin(const T* v) const {
    if (sign_ > 0)
      return static_cast<double>(std::max(std::max(std::max(v[0], v[1]), std::max(v[2], v[3])),
                                          std::max(std::max(v[4], v[5]), std::max(v[6], v[7])))) > best_;
    return -static_cast<double>(std::min(std::min(std::min(v[0], v[1]), std::min(v[2], v[3])),
                                         std::min(std::min(v[4], v[5]), std::min(v[6], v[7])))) > best_;
  }

  // The piece's begin is the end of the last one, which was taken or could not win.
  void piece(const CellWalk<T>& walk, Work& work) {
    T stored[8];
    walk.corners(stored);
    if (!mayWin(stored)) return;
    const double length = walk.exit() - walk.entry();
    double v[8], f[3], g[3], s[2];
    signedCorners(stored, sign_, v);
    walk.fractions(walk.entry(), f);
    for (int n = 0; n < 3; ++n) g[n] = length * walk.direction()[n];
    const Cubic cubic = cubicAlong(v, f, g);
    take(cubic.at(1), walk.exit(), work);
    if (!cubic.mayExceed(best_)) return;
    const int roots = extremaInside(cubic, s);
    for (int n = 0; n < roots; ++n) take(cubic.at(s[n]), walk.entry() + s[n] * length, work);
  }

  double sign_ = 1, best_ = 0;
  double place_ = -1;
};

// Simpson's rule is exact for the cubic of each piece.
template <class T>
double meanAlong(CellWalk<T>& walk, Work& work) {
  T stored[8];
  double v[8], f[3], sum = 0, length = 0;
  const auto value = [&](double t) {
    ++work.samples;
    walk.fractions(t, f);
    return trilinear(v, f);
  };
  walk.enter(walk.begin());
  for (double atEntry = 0;; walk.step()) {
    ++work.cells;
    walk.corners(stored);
    signedCorners(stored, 1, v);
    if (length == 0) atEntry = value(walk.entry());
    const double l = walk.exit() - walk.entry();
    const double atExit = value(walk.exit());
    sum += l * (atEntry + 4 * value(0.5 * (walk.entry() + walk.exit())) + atExit);
    length += l;
    atEntry = atExit;
    if (walk.atEnd()) break;
  }
  return sum / (6 * length);
}

template <class T>
Work drawTile(const SliceJob& job, const Lines& lines, const Display& display, const Target& target,
              const Tile& tile, const std::stop_token& stop) {
  const CellGrid<T> grid = cellGridOf<T>(*job.volume);
  const ModalityRescale rescale = job.volume->rescaleOf(0);
  // Of stored values: a negative slope turns maximum and minimum over.
  const bool greatest = (job.slab.mode == SlabMode::Max) == (rescale.slope > 0);
  Work work;
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

// Volume::make() notes what was not finite, except in volumes converted from others, where NaN is padding.
bool mayHoldNan(const Volume& v) {
  if (const OriginalVoxels* o = v.original()) return o->noData || o->type == VoxelType::F32;
  const auto& findings = v.info().findings;
  return std::any_of(findings.begin(), findings.end(),
                     [](const Finding& f) { return f.code == "non-finite-voxels"; });
}

using ExactKernel = Work (*)(const SliceJob&, const Lines&, const Display&, const Target&, const Tile&,
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
                  const Work work = kernel(job, lines, display, target, tile, stop);
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
