// SPDX-License-Identifier: GPL-3.0-or-later
#include "BrickMarks.h"

#include <algorithm>
#include <cmath>

#include "ProjectionBounds.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::native {
namespace {

constexpr int kBand = 4;         // rows of packets that one thread marks at a time
constexpr double kBin_vox = 2;   // about as long as a bin should be, in smallest spacings
constexpr double kSlack = 1e-4;  // pixels and steps: far more than positions are rounded by
constexpr int kMostBins = 64 * 16;

}  // namespace

// From boxes of bricks to pixels and distances.
class BrickMarks::Projector {
 public:
  Projector(const GridGeometry& grid, const CameraPicture& camera, double step_mm)
      : camera_(camera),
        perspective_(camera.projection == Projection::Perspective),
        last_{static_cast<double>(grid.columns - 1), static_cast<double>(grid.rows - 1),
              static_cast<double>(grid.slices - 1)},
        step_mm_(step_mm) {
    const PatientFromVoxel patientFromVoxel = grid.patientFromVoxel;
    const auto seen = [&](const glm::dvec3& p) {  // right, up, forward of the eye, mm
      const glm::dvec3 d = (patientFromVoxel * VoxelPoint(p)).p - camera.eye.p;
      return glm::dvec3(glm::dot(d, camera.right.v), glm::dot(d, camera.up.v), glm::dot(d, camera.forward.v));
    };
    origin_ = seen(glm::dvec3(0));
    for (int a = 0; a < 3; ++a) {
      glm::dvec3 unit(0);
      unit[a] = 1;
      axis_[a] = seen(unit) - origin_;
    }
  }

  struct Extent {
    double x0 = 0, x1 = -1, y0 = 0, y1 = -1, t0 = 0, t1 = -1;  // pixels, mm; empty: x0 > x1
  };

  Extent of(const glm::dvec3& low, const glm::dvec3& high) const {
    const glm::dvec3 centre = origin_ + along(0.5 * (low + high)), half = 0.5 * (high - low);
    glm::dvec3 reach(0);
    for (int a = 0; a < 3; ++a) reach += half[a] * glm::abs(axis_[a]);
    // Samples beyond the box are moved to it, by a step at most.
    for (int a = 0; a < 3; ++a)
      if (low[a] <= 0 || high[a] >= last_[a]) {
        reach += step_mm_;
        break;
      }
    return perspective_ ? inPerspective(centre, reach) : orthographic(centre, reach);
  }
  Extent of(const BrickBox& b) const {
    const glm::dvec3 low(b.x, b.y, b.z);
    return of(glm::min(low * double{kFineEdge}, last_),
              glm::min((low + double(b.edge)) * double{kFineEdge}, last_));
  }
  Extent whole() const { return of(glm::dvec3(0), last_); }

 private:
  glm::dvec3 along(const glm::dvec3& v) const { return v.x * axis_[0] + v.y * axis_[1] + v.z * axis_[2]; }

  Extent orthographic(const glm::dvec3& c, const glm::dvec3& r) const {
    const double px = 1 / camera_.pixelStep;
    const double x = 0.5 * camera_.width_px + c.x * px, y = 0.5 * camera_.height_px - c.y * px;
    return {x - r.x * px, x + r.x * px, y - r.y * px, y + r.y * px, c.z - r.z, c.z + r.z};
  }

  // Of the box about the brick that is aligned with the eye's axes.
  Extent inPerspective(const glm::dvec3& c, const glm::dvec3& r) const {
    const double far = c.z + r.z, near = c.z - r.z;
    if (far <= 0) return {};
    const glm::dvec3 most = glm::abs(c) + r, least = glm::max(glm::abs(c) - r, 0.0);
    Extent e{
        0, double(camera_.width_px), 0, double(camera_.height_px), glm::length(least), glm::length(most)};
    if (near <= 1e-3 * far) return e;  // the eye is in it or beside it
    const auto pixels = [&](double low, double high, double& p0, double& p1) {
      p0 = low / (camera_.pixelStep * (low < 0 ? near : far));
      p1 = high / (camera_.pixelStep * (high < 0 ? far : near));
    };
    double u0, u1, v0, v1;
    pixels(c.x - r.x, c.x + r.x, u0, u1), pixels(c.y - r.y, c.y + r.y, v0, v1);
    e.x0 = 0.5 * camera_.width_px + u0, e.x1 = 0.5 * camera_.width_px + u1;
    e.y0 = 0.5 * camera_.height_px - v1, e.y1 = 0.5 * camera_.height_px - v0;
    return e;
  }

  const CameraPicture& camera_;
  bool perspective_;
  glm::dvec3 last_, origin_, axis_[3];
  double step_mm_;
};

BrickMarks::BrickMarks(const VisibleBricks& visible, const GridGeometry& grid, const CameraPicture& camera,
                       double step_mm) {
  across_ = (camera.width_px + kPacketEdge_px - 1) / kPacketEdge_px;
  down_ = (camera.height_px + kPacketEdge_px - 1) / kPacketEdge_px;
  const Projector projector(grid, camera, step_mm);
  const Projector::Extent box = projector.whole();
  firstStep_ = static_cast<std::int64_t>(std::floor(std::max(0.0, box.t0) / step_mm - kSlack));
  const auto lastStep = static_cast<std::int64_t>(std::floor(std::max(0.0, box.t1) / step_mm + kSlack));
  const glm::dvec3 s = grid.spacing_mm();
  const double wanted = kBin_vox * std::min({s.x, s.y, s.z}) / step_mm;
  const double steps = static_cast<double>(lastStep - firstStep_ + 1);
  stepsPerBin_ = static_cast<int>(std::max({1.0, std::floor(wanted), std::ceil(steps / kMostBins)}));
  bins_ = (lastStep - firstStep_) / stepsPerBin_ + 1;
  words_ = static_cast<int>((bins_ + 63) / 64);
  step_mm_ = step_mm;
  mark(visible.boxes, projector, seen_);
  if (!visible.holes.empty()) mark(visible.holes, projector, holes_);
}

void BrickMarks::put(const Footprint& f, int row0, int row1, std::vector<std::uint64_t>& out) const {
  for (int y = std::max(f.y0, row0); y <= std::min(f.y1, row1 - 1); ++y)
    for (int x = f.x0; x <= f.x1; ++x) {
      std::uint64_t* const w = out.data() + at(x, y);
      for (int word = f.bin0 / 64; word <= f.bin1 / 64; ++word) {
        const int low = std::max(f.bin0 - 64 * word, 0), high = std::min(f.bin1 - 64 * word, 63);
        w[word] |= (~std::uint64_t{0} >> (63 - high)) & (~std::uint64_t{0} << low);
      }
    }
}

void BrickMarks::mark(const std::vector<BrickBox>& boxes, const Projector& projector,
                      std::vector<std::uint64_t>& out) const {
  out.assign(at(0, down_), 0);
  std::vector<Footprint> prints(boxes.size());
  const auto packet = [](double p, double more, int count) {
    return static_cast<std::int32_t>(
        std::floor(std::clamp((p - 0.5 + more) / kPacketEdge_px, -1.0, double(count))));
  };
  const auto bin = [&](double t, double more) {
    const double step = std::floor(t / step_mm_ + more) - static_cast<double>(firstStep_);
    return static_cast<std::int32_t>(std::clamp(std::floor(step / stepsPerBin_), 0.0, double(bins_ - 1)));
  };
  parallelFor(boxes.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const Projector::Extent e = projector.of(boxes[n]);
      Footprint& f = prints[n];
      f = {0, -1, 0, -1, 0, 0};
      if (!(e.x0 <= e.x1)) continue;
      // Pixel p's centre is p + 1/2: the first that is not before x0.
      f = {std::max(packet(std::ceil(e.x0 - 0.5 - kSlack) + 0.5, 0, across_), 0),
           std::min(packet(e.x1, kSlack, across_), across_ - 1),
           std::max(packet(std::ceil(e.y0 - 0.5 - kSlack) + 0.5, 0, down_), 0),
           std::min(packet(e.y1, kSlack, down_), down_ - 1),
           bin(e.t0, -kSlack),
           bin(e.t1, kSlack)};
    }
  });
  const int bands = (down_ + kBand - 1) / kBand;
  std::vector<std::vector<std::uint32_t>> ofBand(static_cast<std::size_t>(bands));
  for (std::uint32_t n = 0; n < prints.size(); ++n)
    if (prints[n].x0 <= prints[n].x1 && prints[n].y0 <= prints[n].y1)
      for (int b = prints[n].y0 / kBand; b <= prints[n].y1 / kBand; ++b)
        ofBand[static_cast<std::size_t>(b)].push_back(n);
  parallelFor(static_cast<std::size_t>(bands), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      for (const std::uint32_t n : ofBand[b])
        put(prints[n], static_cast<int>(b) * kBand, std::min((static_cast<int>(b) + 1) * kBand, down_), out);
  });
}

std::shared_ptr<const BrickMarks> marksOf(const VisibleBricks& bricks, const GridGeometry& grid,
                                          const CameraPicture& camera, double step_mm, RayIntervals* rays) {
  const auto make = [&] {
    const TraceSpan marking("visible bricks");
    return std::make_shared<const BrickMarks>(bricks, grid, camera, step_mm);
  };
  if (!rays) return make();
  std::shared_ptr<const void>& kept = rays->shared[{bricks.id, step_mm}];
  if (!kept) kept = make();
  return std::static_pointer_cast<const BrickMarks>(kept);
}

}  // namespace vernier::native
