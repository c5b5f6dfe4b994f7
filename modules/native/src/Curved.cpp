// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Curved.h"

#include <algorithm>
#include <atomic>

#include "SliceFast.h"
#include "SliceKernel.h"
#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

// Columns of a group are written to the picture together: 16 pixels of 16 bytes a row.
constexpr int kGroup_px = 16;

std::size_t at(int width, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

// The columns of a group, lying down: row n is column n.
struct Lying {
  int length = 0;
  std::vector<float> colour, depth, values;
  Lying(int pixels, bool wantValues) : length(pixels) {
    const auto n = static_cast<std::size_t>(pixels) * kGroup_px;
    colour.resize(4 * n);
    depth.resize(n);
    if (wantValues) values.resize(n);
  }
  Target target(int column) {
    const std::size_t n = at(length, 0, column);
    return {length, colour.data() + 4 * n, depth.data() + n, values.empty() ? nullptr : values.data() + n};
  }
};

std::uint64_t drawColumn(const SliceJob& job, const VoxelVec& toNext, const Display& display,
                         const Target& target, const std::stop_token& stop) {
  VoxelLattice lattice = latticeOf(job);
  lattice.down = toNext.v;  // one row is drawn: it only says where to fetch ahead
  const Tile tile{0, job.width_px, 0, 1};
  if (const std::optional<FastSlice> fast = fastSliceOf(job, lattice, display))
    return drawFast(*fast, job, lattice, display, target, tile, stop);
  return generalKernel(job.volume->type())(job, lattice, display, target, tile, stop);
}

class Sheet {
 public:
  Sheet(const CurvedJob& job, Images& images)
      : job_(job),
        images_(images),
        first_(job.picture->firstRow(job.height_px)),
        end_(job.picture->endRow(job.height_px)) {
    SliceJob any;
    any.window = job.window;
    any.invert = job.invert;
    any.background = job.background;
    display_ = displayOf(any);
  }

  // Columns x0 .. x1 - 1, at most a group.
  std::uint64_t draw(int x0, int x1, const std::stop_token& stop) {
    Lying lying(end_ - first_, !images_.values.empty());
    std::uint64_t samples = 0;
    for (int x = x0; x < x1 && !stop.stop_requested(); ++x)
      if (column(x).shown && end_ > first_) samples += drawOne(x, lying.target(x - x0), stop);
    if (stop.stop_requested()) return samples;
    for (int y = 0; y < job_.height_px; ++y)
      for (int x = x0; x < x1; ++x)
        if (column(x).shown && y >= first_ && y < end_)
          copy(lying, at(lying.length, y - first_, x - x0), x, y);
        else
          putPixel(display_, {job_.width_px, images_.colour.data(), images_.depth.data(), values()}, x, y,
                   std::numeric_limits<double>::quiet_NaN());
    return samples;
  }

 private:
  const CurvedColumn& column(int x) const { return job_.picture->columns[static_cast<std::size_t>(x)]; }
  float* values() { return images_.values.empty() ? nullptr : images_.values.data(); }

  std::uint64_t drawOne(int x, const Target& target, const std::stop_token& stop) const {
    SliceJob job = columnJob(job_, column(x));
    job.picture.origin = job.picture.origin + static_cast<double>(first_) * column(x).down;
    job.width_px = end_ - first_;
    const bool hasNext = x + 1 < job_.width_px && column(x + 1).shown;
    const PatientVec toNext = hasNext ? column(x + 1).centre - column(x).centre : PatientVec();
    return drawColumn(job, job_.volume->voxelFromPatient() * toNext, display_, target, stop);
  }

  void copy(const Lying& from, std::size_t source, int x, int y) {
    const std::size_t to = at(job_.width_px, x, y);
    std::copy_n(from.colour.data() + 4 * source, 4, images_.colour.data() + 4 * to);
    images_.depth[to] = from.depth[source];
    if (!images_.values.empty()) images_.values[to] = from.values[source];
  }

  const CurvedJob& job_;
  Images& images_;
  int first_, end_;
  Display display_;
};

}  // namespace

SliceJob columnJob(const CurvedJob& job, const CurvedColumn& column) {
  SliceJob one;
  one.volume = job.volume;
  one.picture.right = column.down;
  one.picture.normal = column.normal;
  one.picture.mmPerPixel = job.picture->mmPerPixel;
  // Row 0 begins half the sheet above its middle; the slice's only row is centred on the column.
  one.picture.origin = column.centre - job.picture->centreRow_px * column.down;
  one.picture.down = PatientVec(0, 0, 0);
  one.width_px = job.height_px;
  one.height_px = 1;
  one.interpolation = job.interpolation;
  one.slab = job.slab;
  one.slabSamples = job.slabSamples;
  one.window = job.window;
  one.invert = job.invert;
  one.background = job.background;
  return one;
}

Result<void> drawCurved(const CurvedJob& job, Images& images, std::stop_token stop) {
  const std::size_t pixels = static_cast<std::size_t>(job.width_px) * static_cast<std::size_t>(job.height_px);
  if (job.width_px < 1 || job.height_px < 1 ||
      job.picture->columns.size() != static_cast<std::size_t>(job.width_px) || images.width != job.width_px ||
      images.height != job.height_px || images.colour.size() != 4 * pixels || images.depth.size() != pixels ||
      (!images.values.empty() && images.values.size() != pixels))
    return makeError(ErrorCode::Internal, "The images of the frame do not have the size of the reformat.",
                     "drawCurved");
  Sheet sheet(job, images);
  const int groups = (job.width_px + kGroup_px - 1) / kGroup_px;
  std::atomic<std::uint64_t> samples{0};
  parallelFor(static_cast<std::size_t>(groups), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end && !stop.stop_requested(); ++g) {
      const int x0 = static_cast<int>(g) * kGroup_px;
      samples += sheet.draw(x0, std::min(x0 + kGroup_px, job.width_px), stop);
    }
  });
  images.counters.samples += samples;
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The reformat was cancelled.");
  return {};
}

}  // namespace vernier::native
