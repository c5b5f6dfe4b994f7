// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Surfaces.h"

#include <algorithm>
#include <cmath>

#include "SurfaceTiles.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::native {
namespace {

Error cancelled() { return makeError(ErrorCode::Cancelled, "Drawing the surfaces was cancelled."); }

// body(tile, hits) for every tile that is drawn, spread over threads.
template <class Body>
Result<void> eachTile(const PreparedSurfaces& surfaces, const std::stop_token& stop, Body&& body) {
  parallelFor(static_cast<std::size_t>(surfaces.tiles()), 1, [&](std::size_t begin, std::size_t end) {
    TileHits hits;
    for (std::size_t tile = begin; tile < end && !stop.stop_requested(); ++tile) {
      surfaces.draw(static_cast<int>(tile), hits);
      body(hits);
    }
  });
  if (stop.stop_requested()) return cancelled();
  return {};
}

// The layers of one pixel of a tile.
std::span<const TileHit> layersOf(const TileHits& tile, std::size_t pixel) {
  return std::span(tile.layers).subspan(tile.first[pixel], tile.first[pixel + 1] - tile.first[pixel]);
}

template <class Fn>
void eachPixel(const TileHits& tile, Fn&& fn) {  // fn(pixel in the tile, x, y in the picture)
  for (int y = 0; y < tile.height; ++y)
    for (int x = 0; x < tile.width; ++x)
      fn(static_cast<std::size_t>(x + kSurfaceTile * y), tile.x0 + x, tile.y0 + y);
}

struct Over {
  glm::dvec3 colour{0};
  double left = 1;  // what still shines through
  void add(const glm::dvec3& c, double alpha) {
    colour += left * alpha * c;
    left *= 1 - alpha;
  }
};

void writeTile(const PreparedSurfaces& surfaces, const TileHits& tile, glm::dvec3 background,
               Images& images) {
  eachPixel(tile, [&](std::size_t pixel, int column, int row) {
    const double x = column + 0.5, y = row + 0.5;
    Over over;
    for (const TileHit& h : layersOf(tile, pixel))
      over.add(surfaces.shade(h.triangle, x, y), surfaces.surfaceOf(h.triangle).opacity);
    const bool ends = std::isfinite(tile.end_mm[pixel]);
    over.add(ends ? surfaces.shade(tile.endTriangle[pixel], x, y) : background, 1);
    const std::size_t at = static_cast<std::size_t>(column) +
                           static_cast<std::size_t>(images.width) * static_cast<std::size_t>(row);
    for (int c = 0; c < 3; ++c)
      images.colour[4 * at + static_cast<std::size_t>(c)] = static_cast<float>(over.colour[c]);
    images.colour[4 * at + 3] = 1;
    images.depth[at] = ends ? static_cast<float>(tile.end_mm[pixel]) : kNothing_mm;
  });
}

}  // namespace

Result<void> drawSurfaces(const SurfaceJob& job, Images& images, std::stop_token stop) {
  const TraceSpan span("surfaces");
  images.width = job.camera.width_px, images.height = job.camera.height_px;
  const std::size_t n = static_cast<std::size_t>(images.width) * static_cast<std::size_t>(images.height);
  images.colour.resize(4 * n);
  images.depth.resize(n);
  images.values.clear();
  const PreparedSurfaces surfaces(job, stop);
  if (stop.stop_requested()) return cancelled();
  images.counters.triangles += surfaces.triangles();
  return eachTile(surfaces, stop,
                  [&](const TileHits& tile) { writeTile(surfaces, tile, job.background, images); });
}

namespace {

// What a tile adds to SurfaceHits, before its place in the whole is known.
struct TileLayers {
  std::vector<SurfaceHits::Layer> layers;  // pixel by pixel, rows first
  std::uint64_t pixelsBeyond = 0;
  double largestResidual = 0;
};

SurfaceHits::Layer layerOf(double t_mm, const Over& o) {
  return {static_cast<float>(t_mm), static_cast<float>(o.colour.x), static_cast<float>(o.colour.y),
          static_cast<float>(o.colour.z), static_cast<float>(1 - o.left)};
}

// Appends the layers of one pixel; gives how many.
std::uint32_t appendLayers(const PreparedSurfaces& surfaces, std::span<const TileHit> hits, double x,
                           double y, TileLayers& out) {
  double through = 1;
  for (std::size_t i = 0; i < std::min(hits.size(), kSurfaceLayers); ++i) {
    Over one;
    one.add(surfaces.shade(hits[i].triangle, x, y), surfaces.surfaceOf(hits[i].triangle).opacity);
    out.layers.push_back(layerOf(hits[i].t_mm, one));
    through *= one.left;
  }
  if (hits.size() <= kSurfaceLayers) return static_cast<std::uint32_t>(hits.size());
  Over rest;
  for (const TileHit& h : hits.subspan(kSurfaceLayers))
    rest.add(surfaces.shade(h.triangle, x, y), surfaces.surfaceOf(h.triangle).opacity);
  out.layers.push_back(layerOf(hits[kSurfaceLayers].t_mm, rest));
  ++out.pixelsBeyond;
  out.largestResidual = std::max(out.largestResidual, through * (1 - rest.left));
  return kSurfaceLayers + 1;
}

}  // namespace

Result<SurfaceHits> findSurfaces(const SurfaceJob& job, std::stop_token stop) {
  const TraceSpan span("surface hits");
  SurfaceHits out;
  out.width = job.camera.width_px, out.height = job.camera.height_px;
  const std::size_t width = static_cast<std::size_t>(out.width),
                    n = width * static_cast<std::size_t>(out.height);
  out.end_mm.assign(n, kNothing_mm);
  out.endColour.assign(3 * n, 0.0f);
  out.first.assign(n + 1, 0);
  const PreparedSurfaces surfaces(job, stop);
  if (stop.stop_requested()) return cancelled();
  out.counters.triangles = surfaces.triangles();
  const int across = (out.width + kSurfaceTile - 1) / kSurfaceTile;
  std::vector<TileLayers> tiles(static_cast<std::size_t>(surfaces.tiles()));
  const auto tileAt = [&](int column, int row) -> TileLayers& {
    return tiles[static_cast<std::size_t>(row / kSurfaceTile * across + column / kSurfaceTile)];
  };
  const Result<void> drawn = eachTile(surfaces, stop, [&](const TileHits& tile) {
    eachPixel(tile, [&](std::size_t pixel, int column, int row) {
      const double x = column + 0.5, y = row + 0.5;
      const std::size_t at = static_cast<std::size_t>(column) + width * static_cast<std::size_t>(row);
      out.first[at + 1] = appendLayers(surfaces, layersOf(tile, pixel), x, y, tileAt(column, row));
      if (!std::isfinite(tile.end_mm[pixel])) return;
      out.end_mm[at] = static_cast<float>(tile.end_mm[pixel]);
      const glm::dvec3 c = surfaces.shade(tile.endTriangle[pixel], x, y);
      for (std::size_t i = 0; i < 3; ++i)
        out.endColour[3 * at + i] = static_cast<float>(c[static_cast<int>(i)]);
    });
  });
  if (!drawn) return drawn.error();
  for (std::size_t at = 0; at < n; ++at) out.first[at + 1] += out.first[at];
  out.layers.resize(out.first[n]);
  std::vector<std::size_t> taken(tiles.size(), 0);
  for (int row = 0; row < out.height; ++row)
    for (int column = 0; column < out.width; ++column) {
      const std::size_t at = static_cast<std::size_t>(column) + width * static_cast<std::size_t>(row);
      TileLayers& tile = tileAt(column, row);
      std::size_t& next = taken[static_cast<std::size_t>(&tile - tiles.data())];
      for (std::uint32_t i = out.first[at]; i < out.first[at + 1]; ++i) out.layers[i] = tile.layers[next++];
    }
  for (const TileLayers& tile : tiles) {
    out.pixelsBeyond += tile.pixelsBeyond;
    out.largestResidual = std::max(out.largestResidual, tile.largestResidual);
  }
  return out;
}

}  // namespace vernier::native
