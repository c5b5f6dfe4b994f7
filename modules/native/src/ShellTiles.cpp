// SPDX-License-Identifier: GPL-3.0-or-later
#include "ShellTiles.h"

#include <algorithm>
#include <cmath>

#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

constexpr std::uint32_t kRun = 128;  // triangles
constexpr std::size_t kChunk = 8192;
// A corner nearer to the eye than this (mm) counts as not before it: its pixel is of no use.
constexpr double kBeforeEye_mm = 1e-6;

}  // namespace

PreparedShells::PreparedShells(const ShellsJob& job, bool frontOnly, const std::stop_token& stop)
    : job_(job),
      frontOnly_(frontOnly),
      perspective_(job.camera.projection == Projection::Perspective),
      pixelFromPatient_(job.camera.pixelFromPatient()) {
  tilesAcross_ = (job.camera.width_px + kShellTile - 1) / kShellTile;
  tilesDown_ = (job.camera.height_px + kShellTile - 1) / kShellTile;
  for (std::size_t n = job.shells.size(); n-- > 0;) {
    if (!job.shells[n].mesh) continue;
    const auto count = static_cast<std::uint32_t>(job.shells[n].mesh->triangles().size());
    triangles_ += count;
    for (std::uint32_t first = 0; first < count; first += kRun)
      runs_.push_back({static_cast<std::uint32_t>(n), first, std::min(kRun, count - first), false, {}});
  }
  transform(stop);
  findBoxes(stop);
  sortIntoTiles();
}

void PreparedShells::transform(const std::stop_token& stop) {
  corners_.resize(job_.shells.size());
  const glm::dmat4& m = pixelFromPatient_;
  for (std::size_t n = 0; n < job_.shells.size(); ++n) {
    if (!job_.shells[n].mesh) continue;
    const auto vertices = job_.shells[n].mesh->vertices();
    std::vector<Corner>& out = corners_[n];
    out.resize(vertices.size());
    parallelFor(vertices.size(), kChunk, [&](std::size_t begin, std::size_t end) {
      if (stop.stop_requested()) return;
      for (std::size_t i = begin; i < end; ++i) {
        const glm::dvec4 p = m * glm::dvec4(vertices[i].p, 1.0);
        const double w = perspective_ ? 1 / p.w : 1;
        out[i] = {p.x * w, p.y * w, p.z};
      }
    });
  }
}

TileRect PreparedShells::boxOf(Run& run) const {
  const std::vector<Corner>& corners = corners_[run.shell];
  const TileRect whole{0, 0, job_.camera.width_px - 1, job_.camera.height_px - 1};
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  bool someBefore = false;
  for (const Triangle& t : meshOf(run.shell).triangles().subspan(run.first, run.count))
    for (const std::uint32_t v : t) {
      const Corner& c = corners[v];
      const bool isBefore = !perspective_ || c.z > kBeforeEye_mm;
      someBefore = someBefore || isBefore;
      run.throughEye = run.throughEye || !isBefore;
      x0 = std::min(x0, c.x), y0 = std::min(y0, c.y), x1 = std::max(x1, c.x), y1 = std::max(y1, c.y);
    }
  if (!someBefore) return {0, 0, -1, -1};
  if (run.throughEye) return whole;
  const auto within = [](double v, int most) {
    return static_cast<int>(std::floor(std::clamp(v, -1.0, most + 1.0)));
  };
  return {std::max(0, within(x0 - 1, whole.x1)), std::max(0, within(y0 - 1, whole.y1)),
          std::min(whole.x1, within(x1 + 1, whole.x1)), std::min(whole.y1, within(y1 + 1, whole.y1))};
}

void PreparedShells::findBoxes(const std::stop_token& stop) {
  parallelFor(runs_.size(), kChunk / kRun, [&](std::size_t begin, std::size_t end) {
    if (stop.stop_requested()) return;
    for (std::size_t i = begin; i < end; ++i) runs_[i].box = boxOf(runs_[i]);
  });
}

void PreparedShells::sortIntoTiles() {
  const auto eachTile = [&](const Run& run, auto&& fn) {
    const TileRect& b = run.box;
    if (b.x0 > b.x1 || b.y0 > b.y1) return;
    for (int ty = b.y0 / kShellTile; ty <= b.y1 / kShellTile; ++ty)
      for (int tx = b.x0 / kShellTile; tx <= b.x1 / kShellTile; ++tx)
        fn(static_cast<std::size_t>(ty * tilesAcross_ + tx));
  };
  tileFirst_.assign(static_cast<std::size_t>(tiles()) + 1, 0);
  for (const Run& run : runs_) eachTile(run, [&](std::size_t tile) { ++tileFirst_[tile + 1]; });
  for (std::size_t t = 1; t < tileFirst_.size(); ++t) tileFirst_[t] += tileFirst_[t - 1];
  tileRuns_.resize(tileFirst_.back());
  std::vector<std::uint32_t> next(tileFirst_.begin(), tileFirst_.end() - 1);
  for (std::size_t i = 0; i < runs_.size(); ++i)
    eachTile(runs_[i], [&](std::size_t tile) { tileRuns_[next[tile]++] = static_cast<std::uint32_t>(i); });
}

TileRect PreparedShells::rect(int tile) const {
  const int x0 = tile % tilesAcross_ * kShellTile, y0 = tile / tilesAcross_ * kShellTile;
  return {x0, y0, std::min(x0 + kShellTile, job_.camera.width_px) - 1,
          std::min(y0 + kShellTile, job_.camera.height_px) - 1};
}

double PreparedShells::cosine(std::uint32_t shell, std::uint32_t triangle, double x, double y) const {
  const Mesh& mesh = meshOf(shell);
  const glm::dvec3 normal = mesh.normalTimesTwiceArea(mesh.triangles()[triangle]).v;
  const glm::dvec3 ray = job_.camera.ray(x, y).direction.v;
  const double size = glm::length(normal);
  return size > 0 ? std::abs(glm::dot(normal, ray)) / size : 0;
}

}  // namespace vernier::native
