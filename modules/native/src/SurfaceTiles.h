// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles in pixel space, sorted into tiles, and the hits of one tile.
#pragma once
#include <span>

#include "vernier/native/Surfaces.h"

namespace vernier::native {

inline constexpr int kSurfaceTile = 64;  // a row of it is one word of SurfaceCover.h

// A triangle as PreparedSurfaces counts them: of all drawn surfaces, one after the other.
struct SurfaceTriangle {
  std::uint32_t index = 0;
  std::uint16_t surface = 0;  // which of them it belongs to
};
struct TileHit {
  double t_mm;
  SurfaceTriangle triangle;
  std::uint16_t pixel;  // in the tile: x + kSurfaceTile * y
};

// What one tile shows. Reused from tile to tile by one thread.
struct TileHits {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  std::vector<double> end_mm;  // per pixel of the tile, +inf: no opaque hit
  std::vector<SurfaceTriangle> endTriangle;
  std::vector<TileHit> layers;       // translucent hits before the end, by pixel, nearest first
  std::vector<TileHit> sorted;       // room to sort them in
  std::vector<std::uint32_t> first;  // per pixel into layers, and one more
};

class PreparedSurfaces {
 public:
  PreparedSurfaces(const SurfaceJob&, const std::stop_token&);

  int tiles() const { return tilesAcross_ * tilesDown_; }
  std::uint64_t triangles() const { return first_.empty() ? 0 : first_.back(); }
  void draw(int tile, TileHits&) const;
  const PlacedSurface& surfaceOf(SurfaceTriangle t) const { return *drawn_[t.surface].placed; }
  // Colour of a hit in pixel (x, y), not multiplied by its opacity.
  glm::dvec3 shade(SurfaceTriangle, double x, double y) const;

 private:
  struct Drawn {
    const PlacedSurface* placed;
    std::vector<glm::dvec4> points;  // x w, y w, depth, w in pixel space
    glm::dmat3 normalsFromMesh;      // cross products of the mesh to those of the patient
  };
  // Pixels whose centres a triangle may cover, both ends in; x0 > x1: none.
  struct PixelBox {
    std::uint16_t x0 = 1, y0 = 0, x1 = 0, y1 = 0;
    bool empty() const { return x0 > x1 || y0 > y1; }
  };
  const Triangle& corners(SurfaceTriangle t) const {
    return drawn_[t.surface].placed->mesh->triangles()[t.index - first_[t.surface]];
  }
  PixelBox boxOf(SurfaceTriangle) const;
  std::size_t surfaceIndex(std::uint32_t triangle) const;
  void transform(const std::stop_token&);
  void sortIntoTiles(const std::stop_token&);
  void findBoxes(const std::stop_token&);
  template <class OnTile, class OnLarge>
  void eachTile(std::size_t begin, std::size_t end, OnTile&& onTile, OnLarge&& onLarge) const;
  void rasterise(SurfaceTriangle, TileHits&) const;

  CameraPicture camera_;
  int tilesAcross_ = 0, tilesDown_ = 0;
  std::vector<Drawn> drawn_;          // opacity above 0
  std::vector<std::uint32_t> first_;  // first triangle of each, and the end
  std::vector<PixelBox> boxes_;       // of each triangle
  // Triangles that touch few tiles, tile by tile; and those that touch many, which every tile looks at.
  std::vector<std::uint32_t> tileFirst_, tileTriangles_, large_;
};

}  // namespace vernier::native
