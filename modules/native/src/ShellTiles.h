// SPDX-License-Identifier: GPL-3.0-or-later
// Shell meshes in pixel space. Runs of triangles that stand together in space (volume/IsoSurface.h) are
// sorted into tiles as a whole; each tile then looks at their triangles one by one.
#pragma once
#include <bit>
#include <cstdint>
#include <span>

#include "TriangleSetup.h"
#include "vernier/native/Shells.h"

namespace vernier::native {

inline constexpr int kShellTile = 64;  // a row of it is one word of SurfaceCover.h

struct TileRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels, both ends in
};

class PreparedShells {
 public:
  // A run of triangles of one shell.
  struct Run {
    std::uint32_t shell = 0, first = 0, count = 0;
    bool throughEye = false;  // a corner is not before the eye
    TileRect box;             // pixels whose centres it may cover; empty: x0 > x1
  };
  // frontOnly: triangles that are turned away are left out. Shells are sorted by falling brightness.
  PreparedShells(const ShellsJob&, bool frontOnly, const std::stop_token&);

  int tiles() const { return tilesAcross_ * tilesDown_; }
  TileRect rect(int tile) const;
  std::span<const std::uint32_t> runsOf(int tile) const {
    return std::span(tileRuns_).subspan(
        tileFirst_[static_cast<std::size_t>(tile)],
        tileFirst_[static_cast<std::size_t>(tile) + 1] - tileFirst_[static_cast<std::size_t>(tile)]);
  }
  const Run& run(std::uint32_t n) const { return runs_[n]; }
  std::uint64_t triangles() const { return triangles_; }
  // visit(x, y, depth_mm, triangle) for each pixel centre within `rect` that a triangle of the run covers.
  template <class Visit>
  void rasterise(const Run&, const TileRect& rect, Visit&& visit) const;
  // |cos| between the pixel's ray and the triangle's normal.
  double cosine(std::uint32_t shell, std::uint32_t triangle, double x, double y) const;

 private:
  struct Corner {
    double x, y, z;  // pixels and depth
  };
  const Mesh& meshOf(std::uint32_t shell) const { return *job_.shells[shell].mesh; }
  void transform(const std::stop_token&);
  void findBoxes(const std::stop_token&);
  void sortIntoTiles();
  TileRect boxOf(Run&) const;
  template <class Visit>
  void before(const Corner&, const Corner&, const Corner&, const Triangle&, const TileRect&, Visit&&) const;
  template <class Visit>
  void through(const Run&, std::uint32_t triangle, const TileRect&, Visit&&) const;

  const ShellsJob& job_;
  const bool frontOnly_, perspective_;
  glm::dmat4 pixelFromPatient_;
  int tilesAcross_ = 0, tilesDown_ = 0;
  std::uint64_t triangles_ = 0;
  std::vector<std::vector<Corner>> corners_;  // of each shell
  std::vector<Run> runs_;
  std::vector<std::uint32_t> tileFirst_, tileRuns_;
};

// Calls visit(x, y) for the covered pixels of a box inside one tile.
template <class Visit>
void eachCovered(const EdgeLine (&edges)[3], const TileRect& box, Visit&& visit) {
  constexpr int kNarrow = 4;
  if (box.x1 - box.x0 < kNarrow) {
    const auto positive = [](const EdgeLine& e, double x, double row) {
      const double v = e.a * x + row;
      return v > 0 || (v == 0 && e.zeroIsPositive);
    };
    for (int y = box.y0; y <= box.y1; ++y) {
      double row[3];
      for (int i = 0; i < 3; ++i) row[i] = edges[i].b * (y + 0.5) + edges[i].c;
      for (int x = box.x0; x <= box.x1; ++x) {
        const bool p = positive(edges[0], x + 0.5, row[0]);
        if (p == positive(edges[1], x + 0.5, row[1]) && p == positive(edges[2], x + 0.5, row[2])) visit(x, y);
      }
    }
    return;
  }
  std::uint64_t covered[kShellTile];
  coverRows(edges, box.x0, box.y0, box.x1 - box.x0 + 1, box.y1 - box.y0 + 1, covered);
  for (int y = box.y0; y <= box.y1; ++y)
    for (std::uint64_t left = covered[y - box.y0]; left != 0; left &= left - 1)
      visit(box.x0 + std::countr_zero(left), y);
}

// A triangle that is before the eye as a whole: corners divided already.
template <class Visit>
void PreparedShells::before(const Corner& p, const Corner& q, const Corner& r, const Triangle& t,
                            const TileRect& rect, Visit&& visit) const {
  const double ux = q.x - p.x, uy = q.y - p.y, vx = r.x - p.x, vy = r.y - p.y, area = ux * vy - uy * vx;
  if (frontOnly_ ? !(area < 0) : !(area < 0 || area > 0)) return;  // y runs down
  // Bounds from rounded quotients may lose a pixel centre that the edge functions would take.
  constexpr double kSlack_px = 1e-6;
  const TileRect box{
      std::max(rect.x0, static_cast<int>(std::ceil(std::min({p.x, q.x, r.x}) - (0.5 + kSlack_px)))),
      std::max(rect.y0, static_cast<int>(std::ceil(std::min({p.y, q.y, r.y}) - (0.5 + kSlack_px)))),
      std::min(rect.x1, static_cast<int>(std::floor(std::max({p.x, q.x, r.x}) - (0.5 - kSlack_px)))),
      std::min(rect.y1, static_cast<int>(std::floor(std::max({p.y, q.y, r.y}) - (0.5 - kSlack_px))))};
  if (box.x0 > box.x1 || box.y0 > box.y1) return;
  const auto line = [](const Corner& a, const Corner& b, bool forwards) {
    return edgeThrough({a.x, a.y, 0, 1}, {b.x, b.y, 0, 1}, forwards);
  };
  const EdgeLine edges[3] = {line(p, q, t[0] < t[1]), line(q, r, t[1] < t[2]), line(r, p, t[2] < t[0])};
  double at0 = 0, gx = 0, gy = 0;
  const double least = std::min({p.z, q.z, r.z}), most = std::max({p.z, q.z, r.z});
  bool set = false;
  eachCovered(edges, box, [&](int x, int y) {
    if (!set) {
      at0 = perspective_ ? 1 / p.z : p.z;
      const double du = (perspective_ ? 1 / q.z : q.z) - at0, dv = (perspective_ ? 1 / r.z : r.z) - at0;
      gx = (du * vy - dv * uy) / area, gy = (dv * ux - du * vx) / area;
      set = true;
    }
    const double d = at0 + gx * (x + 0.5 - p.x) + gy * (y + 0.5 - p.y);
    visit(x, y, std::clamp(perspective_ ? 1 / d : d, least, most));
  });
}

// Any triangle, also beside and behind the eye.
template <class Visit>
void PreparedShells::through(const Run& run, std::uint32_t triangle, const TileRect& rect,
                             Visit&& visit) const {
  const Mesh& mesh = meshOf(run.shell);
  const Triangle& t = mesh.triangles()[triangle];
  glm::dvec4 p[3];
  for (std::size_t i = 0; i < 3; ++i) p[i] = pixelFromPatient_ * glm::dvec4(mesh.vertices()[t[i]].p, 1.0);
  if (p[0].w <= 0 && p[1].w <= 0 && p[2].w <= 0) return;
  DepthPlane depth;
  if (!depth.set(p[0], p[1], p[2], perspective_)) return;
  const EdgeLine edges[3] = {edgeThrough(p[0], p[1], t[0] < t[1]), edgeThrough(p[1], p[2], t[1] < t[2]),
                             edgeThrough(p[2], p[0], t[2] < t[0])};
  eachCovered(edges, rect, [&](int x, int y) {
    const double z = depth.at(x + 0.5, y + 0.5);
    if (z >= 0) visit(x, y, z);
  });
}

template <class Visit>
void PreparedShells::rasterise(const Run& run, const TileRect& rect, Visit&& visit) const {
  const std::vector<Corner>& corners = corners_[run.shell];
  const auto triangles = meshOf(run.shell).triangles();
  for (std::uint32_t n = run.first; n < run.first + run.count; ++n) {
    const auto at = [&](int x, int y, double z) { visit(x, y, z, n); };
    if (run.throughEye) {
      through(run, n, rect, at);
      continue;
    }
    const Triangle& t = triangles[n];
    before(corners[t[0]], corners[t[1]], corners[t[2]], t, rect, at);
  }
}

}  // namespace vernier::native
