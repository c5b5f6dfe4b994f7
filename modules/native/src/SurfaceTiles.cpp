// SPDX-License-Identifier: GPL-3.0-or-later
#include "SurfaceTiles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "TriangleSetup.h"
#include "vernier/base/Threads.h"

namespace vernier::native {
namespace {

constexpr std::size_t kChunk = 8192, kMostChunks = 64;
// A triangle that touches more tiles is kept once, so that the lists cannot grow without bound.
constexpr int kFewTiles = 16;
// Bounds from rounded quotients may lose a pixel centre that the edge functions would take.
constexpr double kBoundSlack_px = 1e-6;

bool samePlace(double t, double u) { return std::abs(t - u) <= kSamePlace * std::min(t, u); }

}  // namespace

PreparedSurfaces::PreparedSurfaces(const SurfaceJob& job, const std::stop_token& stop) : camera_(job.camera) {
  tilesAcross_ = (camera_.width_px + kSurfaceTile - 1) / kSurfaceTile;
  tilesDown_ = (camera_.height_px + kSurfaceTile - 1) / kSurfaceTile;
  first_.push_back(0);
  for (const PlacedSurface& s : job.surfaces) {
    if (!(s.opacity > 0)) continue;
    const glm::dmat3& m = s.pose.linear;
    drawn_.push_back(
        {&s, {}, glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]))});
    first_.push_back(first_.back() + static_cast<std::uint32_t>(s.mesh->triangles().size()));
  }
  transform(stop);
  findBoxes(stop);
  sortIntoTiles(stop);
}

void PreparedSurfaces::transform(const std::stop_token& stop) {
  const glm::dmat4 pixelFromPatient = camera_.pixelFromPatient();
  for (Drawn& d : drawn_) {
    const glm::dmat4 m = pixelFromPatient * d.placed->pose.matrix();
    const auto vertices = d.placed->mesh->vertices();
    d.points.resize(vertices.size());
    parallelFor(vertices.size(), kChunk, [&](std::size_t begin, std::size_t end) {
      if (stop.stop_requested()) return;
      for (std::size_t i = begin; i < end; ++i) d.points[i] = m * glm::dvec4(vertices[i].p, 1.0);
    });
  }
}

std::size_t PreparedSurfaces::surfaceIndex(std::uint32_t triangle) const {
  return static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), triangle) - first_.begin()) -
         1;
}

PreparedSurfaces::PixelBox PreparedSurfaces::boxOf(SurfaceTriangle triangle) const {
  const Triangle& t = corners(triangle);
  const std::vector<glm::dvec4>& v = drawn_[triangle.surface].points;
  const glm::dvec4 &p = v[t[0]], &q = v[t[1]], &r = v[t[2]];
  const auto pixel = [](double n) { return static_cast<std::uint16_t>(n); };
  const double lastX = camera_.width_px - 1, lastY = camera_.height_px - 1;
  if (!(std::isfinite(p.x + p.y + p.w) && std::isfinite(q.x + q.y + q.w) && std::isfinite(r.x + r.y + r.w)))
    return {};
  if (p.w <= 0 && q.w <= 0 && r.w <= 0) return {};  // behind the eye
  if (p.w <= 0 || q.w <= 0 || r.w <= 0) return {0, 0, pixel(lastX), pixel(lastY)};
  const glm::dvec2 a = glm::dvec2(p) / p.w, b = glm::dvec2(q) / q.w, c = glm::dvec2(r) / r.w;
  const glm::dvec2 low = glm::min(a, glm::min(b, c)) - (0.5 + kBoundSlack_px);
  const glm::dvec2 high = glm::max(a, glm::max(b, c)) - (0.5 - kBoundSlack_px);
  if (!(low.x <= lastX && low.y <= lastY && high.x >= 0 && high.y >= 0)) return {};
  return {pixel(std::ceil(std::max(low.x, 0.0))), pixel(std::ceil(std::max(low.y, 0.0))),
          pixel(std::floor(std::min(high.x, lastX))), pixel(std::floor(std::min(high.y, lastY)))};
}

void PreparedSurfaces::findBoxes(const std::stop_token& stop) {
  boxes_.resize(triangles());
  parallelFor(boxes_.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    if (stop.stop_requested()) return;
    std::size_t surface = surfaceIndex(static_cast<std::uint32_t>(begin));
    for (std::size_t i = begin; i < end; ++i) {
      while (i >= first_[surface + 1]) ++surface;
      boxes_[i] = boxOf({static_cast<std::uint32_t>(i), static_cast<std::uint16_t>(surface)});
    }
  });
}

// onTile(triangle, tile) for triangles [begin, end) and the tiles that they may touch; onLarge(triangle) for
// those that may touch many.
template <class OnTile, class OnLarge>
void PreparedSurfaces::eachTile(std::size_t begin, std::size_t end, OnTile&& onTile,
                                OnLarge&& onLarge) const {
  for (std::size_t i = begin; i < end; ++i) {
    const PixelBox& b = boxes_[i];
    if (b.empty()) continue;
    const int tx0 = b.x0 / kSurfaceTile, tx1 = b.x1 / kSurfaceTile, ty0 = b.y0 / kSurfaceTile,
              ty1 = b.y1 / kSurfaceTile;
    if ((tx1 - tx0 + 1) * (ty1 - ty0 + 1) > kFewTiles) {
      onLarge(static_cast<std::uint32_t>(i));
      continue;
    }
    for (int ty = ty0; ty <= ty1; ++ty)
      for (int tx = tx0; tx <= tx1; ++tx)
        onTile(static_cast<std::uint32_t>(i), static_cast<std::size_t>(ty * tilesAcross_ + tx));
  }
}

// Counted first and placed after, chunk by chunk: a tile's triangles stand in their own order for any number
// of threads.
void PreparedSurfaces::sortIntoTiles(const std::stop_token& stop) {
  const std::size_t n = triangles(), tileCount = static_cast<std::size_t>(tiles());
  const std::size_t chunk = std::max(kChunk, (n + kMostChunks - 1) / kMostChunks),
                    chunks = (n + chunk - 1) / chunk;
  std::vector<std::uint32_t> at(chunks * tileCount, 0);
  std::vector<std::vector<std::uint32_t>> large(chunks);
  const auto eachChunk = [&](auto&& onTile, auto&& onLarge) {
    parallelFor(chunks, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end && !stop.stop_requested(); ++c)
        eachTile(
            c * chunk, std::min(n, (c + 1) * chunk),
            [&](std::uint32_t triangle, std::size_t tile) { onTile(triangle, at[c * tileCount + tile]); },
            [&](std::uint32_t triangle) { onLarge(triangle, large[c]); });
    });
  };
  eachChunk([](std::uint32_t, std::uint32_t& count) { ++count; },
            [](std::uint32_t triangle, std::vector<std::uint32_t>& list) { list.push_back(triangle); });
  tileFirst_.assign(tileCount + 1, 0);
  std::uint32_t sum = 0;
  for (std::size_t tile = 0; tile < tileCount; ++tile) {
    tileFirst_[tile] = sum;
    for (std::size_t c = 0; c < chunks; ++c) sum += std::exchange(at[c * tileCount + tile], sum);
  }
  tileFirst_[tileCount] = sum;
  tileTriangles_.resize(sum);
  eachChunk([&](std::uint32_t triangle, std::uint32_t& place) { tileTriangles_[place++] = triangle; },
            [](std::uint32_t, std::vector<std::uint32_t>&) {});
  for (const auto& list : large) large_.insert(large_.end(), list.begin(), list.end());
}

namespace {

// Within one surface the first triangle keeps a place; a later surface takes it.
inline void keep(TileHits& out, const TileHit& hit, bool opaque) {
  if (!opaque) {
    out.layers.push_back(hit);
    return;
  }
  double& end = out.end_mm[hit.pixel];
  const bool tied = samePlace(hit.t_mm, end);
  if (tied ? hit.triangle.surface == out.endTriangle[hit.pixel].surface : hit.t_mm > end) return;
  end = hit.t_mm;
  out.endTriangle[hit.pixel] = hit.triangle;
}

}  // namespace

void PreparedSurfaces::rasterise(SurfaceTriangle triangle, TileHits& out) const {
  const Triangle& t = corners(triangle);
  const Drawn& surface = drawn_[triangle.surface];
  const glm::dvec4 &p = surface.points[t[0]], &q = surface.points[t[1]], &r = surface.points[t[2]];
  DepthPlane depth;
  if (!depth.set(p, q, r, camera_.projection == Projection::Perspective)) return;
  const PixelBox& box = boxes_[triangle.index];
  const int x0 = std::max<int>(box.x0, out.x0), x1 = std::min<int>(box.x1, out.x0 + out.width - 1);
  const int y0 = std::max<int>(box.y0, out.y0), y1 = std::min<int>(box.y1, out.y0 + out.height - 1);
  const bool opaque = surface.placed->opacity >= 1;
  if (x0 > x1 || y0 > y1) return;
  const EdgeLine edges[3] = {edgeThrough(p, q, t[0] < t[1]), edgeThrough(q, r, t[1] < t[2]),
                             edgeThrough(r, p, t[2] < t[0])};
  std::uint64_t covered[kSurfaceTile];
  coverRows(edges, x0, y0, x1 - x0 + 1, y1 - y0 + 1, covered);
  for (int row = y0; row <= y1; ++row) {
    const int firstPixel = kSurfaceTile * (row - out.y0) - out.x0;
    for (std::uint64_t left = covered[row - y0]; left != 0; left &= left - 1) {
      const int column = x0 + std::countr_zero(left);
      const double x = column + 0.5, y = row + 0.5, z = depth.at(x, y);
      if (z >= camera_.near_mm && z >= 0)
        keep(out, {z * camera_.rayPerDepth(x, y), triangle, static_cast<std::uint16_t>(firstPixel + column)},
             opaque);
    }
  }
}

namespace {

// Translucent hits by pixel, nearest first. Where two share a place, that of the later surface comes first.
void sortLayers(TileHits& out) {
  const auto behindEnd = [&](const TileHit& h) {
    const double end = out.end_mm[h.pixel];
    if (!std::isfinite(end)) return false;
    return samePlace(h.t_mm, end) ? h.triangle.surface < out.endTriangle[h.pixel].surface : h.t_mm > end;
  };
  std::erase_if(out.layers, behindEnd);
  // Counted by pixel and put there in the order of triangles; then each pixel's few hits one after the other.
  out.first.assign(kSurfaceTile * kSurfaceTile + 1, 0);
  for (const TileHit& h : out.layers) ++out.first[h.pixel + 1u];
  for (std::size_t i = 1; i < out.first.size(); ++i) out.first[i] += out.first[i - 1];
  out.sorted.resize(out.layers.size());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  for (const TileHit& h : out.layers) out.sorted[next[h.pixel]++] = h;
  out.layers.swap(out.sorted);
  const auto sink = [&](auto&& before) {
    for (std::size_t i = 1; i < out.layers.size(); ++i)
      for (std::size_t k = i; k > out.first[out.layers[k].pixel] && before(out.layers[k], out.layers[k - 1]);
           --k)
        std::swap(out.layers[k], out.layers[k - 1]);
  };
  sink([](const TileHit& a, const TileHit& b) { return a.t_mm < b.t_mm; });
  sink([](const TileHit& a, const TileHit& b) {
    return samePlace(a.t_mm, b.t_mm) && a.triangle.surface > b.triangle.surface;
  });
}

}  // namespace

void PreparedSurfaces::draw(int tile, TileHits& out) const {
  constexpr std::size_t pixels = kSurfaceTile * kSurfaceTile;
  out.x0 = tile % tilesAcross_ * kSurfaceTile, out.y0 = tile / tilesAcross_ * kSurfaceTile;
  out.width = std::min(kSurfaceTile, camera_.width_px - out.x0);
  out.height = std::min(kSurfaceTile, camera_.height_px - out.y0);
  out.end_mm.assign(pixels, std::numeric_limits<double>::infinity());
  out.endTriangle.assign(pixels, {});
  out.layers.clear();
  const std::size_t index = static_cast<std::size_t>(tile);
  std::size_t surface = 0;
  const auto rasteriseNext = [&](std::uint32_t triangle) {
    while (triangle >= first_[surface + 1]) ++surface;
    rasterise({triangle, static_cast<std::uint16_t>(surface)}, out);
  };
  auto next = large_.begin();  // both lists ascend, and so do the triangles that are drawn
  for (std::uint32_t i = tileFirst_[index]; i < tileFirst_[index + 1]; ++i) {
    for (; next != large_.end() && *next < tileTriangles_[i]; ++next) rasteriseNext(*next);
    rasteriseNext(tileTriangles_[i]);
  }
  for (; next != large_.end(); ++next) rasteriseNext(*next);
  sortLayers(out);
}

glm::dvec3 PreparedSurfaces::shade(SurfaceTriangle triangle, double x, double y) const {
  const Drawn& d = drawn_[triangle.surface];
  const glm::dvec3 normal = d.normalsFromMesh * d.placed->mesh->normalTimesTwiceArea(corners(triangle)).v;
  glm::dvec3 ray = camera_.forward.v;
  double size2 = glm::dot(normal, normal);
  if (camera_.projection == Projection::Perspective) {
    ray += camera_.across(x, y).v;
    size2 *= glm::dot(ray, ray);
  }
  const double cosine = size2 > 0 ? std::abs(glm::dot(normal, ray)) / std::sqrt(size2) : 0;
  return d.placed->colour * std::min(1.0, kAmbient + kDiffuse * cosine);
}

}  // namespace vernier::native
