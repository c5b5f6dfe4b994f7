// SPDX-License-Identifier: GPL-3.0-or-later
#include "Population.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "Bricks.h"

namespace vernier::quality {
namespace {

constexpr double kDilate_px = 2;
constexpr int kTile = 16;

double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Convex hull, counter-clockwise, by Andrew's monotone chain.
std::vector<glm::dvec2> hullOf(std::vector<glm::dvec2> p) {
  std::sort(p.begin(), p.end(),
            [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<glm::dvec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const glm::dvec2& q : p) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), q) <= 0) hull.pop_back();
      hull.push_back(q);
    }
    hull.pop_back();
    std::reverse(p.begin(), p.end());
  }
  return hull;
}

// The box that holds all voxels with their half-voxel borders, as two corners in the Voxel frame.
std::array<glm::dvec3, 2> boxOf(const GridGeometry& g) {
  glm::dvec2 least(0), greatest(0);
  if (!g.even()) least = greatest = glm::dvec2(g.sliceOrigin_vox.front());
  for (const glm::dvec3& o : g.sliceOrigin_vox) {
    least = glm::min(least, glm::dvec2(o));
    greatest = glm::max(greatest, glm::dvec2(o));
  }
  const double reach = 0.5 + 1e-6;
  return {
      glm::dvec3(least - reach, g.firstPosition_vox() - reach),
      glm::dvec3(
          greatest + glm::dvec2(static_cast<double>(g.columns - 1), static_cast<double>(g.rows - 1)) + reach,
          g.lastPosition_vox() + reach)};
}

// Corners, in pixels, of the part of the volume's box that lies within the slab.
std::vector<glm::dvec2> slabOutline(const SliceReference& slice) {
  const GridGeometry& g = slice.volume().grid();
  const std::array<glm::dvec3, 2> box = boxOf(g);
  std::array<glm::dvec3, 8> corner;
  std::array<double, 8> height;
  const glm::dvec3 onPlane = slice.patientAt({0, 0});
  for (std::size_t n = 0; n < 8; ++n) {
    const VoxelPoint p(box[n & 1].x, box[n >> 1 & 1].y, box[n >> 2].z);
    corner[n] = (g.patientFromVoxel * p).p;
    height[n] = glm::dot(corner[n] - onPlane, slice.normal());
  }
  const double half = 0.5 * slice.reading().thickness_mm() + 1e-9;
  std::vector<glm::dvec2> out;
  for (std::size_t n = 0; n < 8; ++n) {
    if (std::abs(height[n]) <= half) out.push_back(slice.pixelOf(corner[n]));
    for (std::size_t bit = 1; bit < 8; bit <<= 1) {
      const std::size_t m = n | bit;
      if (m == n) continue;
      for (double level : {-half, half})
        if ((height[n] - level) * (height[m] - level) < 0) {
          const double t = (level - height[n]) / (height[m] - height[n]);
          out.push_back(slice.pixelOf(corner[n] + t * (corner[m] - corner[n])));
        }
    }
  }
  return out;
}

void fill(const std::vector<glm::dvec2>& outline, const View& view, std::vector<char>& mask) {
  std::vector<glm::dvec2> wide;
  for (const glm::dvec2& p : outline)
    for (double dx : {-kDilate_px, kDilate_px})
      for (double dy : {-kDilate_px, kDilate_px}) wide.push_back(p + glm::dvec2(dx, dy));
  if (wide.empty()) return;
  const std::vector<glm::dvec2> hull = hullOf(std::move(wide));
  const auto [top, bottom] =
      std::minmax_element(hull.begin(), hull.end(), [](glm::dvec2 a, glm::dvec2 b) { return a.y < b.y; });
  const int first =
      static_cast<int>(std::clamp(std::floor(top->y), 0.0, static_cast<double>(view.height_px)));
  const int last =
      static_cast<int>(std::clamp(std::ceil(bottom->y), 0.0, static_cast<double>(view.height_px)));
  for (int row = first; row < last; ++row) {
    const double y = row + 0.5;
    double from = 1e300, to = -1e300;
    for (std::size_t n = 0; n < hull.size(); ++n) {
      const glm::dvec2 a = hull[n], b = hull[(n + 1) % hull.size()];
      if ((a.y > y) == (b.y > y) && a.y != y && b.y != y) continue;
      const double x = a.y == b.y ? a.x : a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
      from = std::min(from, x);
      to = std::max(to, x);
    }
    const double left = std::clamp(std::ceil(from - 0.5), 0.0, static_cast<double>(view.width_px));
    const double right = std::clamp(std::floor(to - 0.5), -1.0, static_cast<double>(view.width_px - 1));
    const auto start = static_cast<std::size_t>(row) * static_cast<std::size_t>(view.width_px);
    for (double x = left; x <= right; ++x) mask[start + static_cast<std::size_t>(x)] = 1;
  }
}

// Each triangle's own outline; the whole picture where one of its corners is not before the eye.
void fillSurfaces(const SurfaceReference& surfaces, const View& view, std::vector<char>& mask) {
  std::array<glm::dvec2, 3> px;
  for (std::size_t t = 0; t < surfaces.triangles(); ++t) {
    if (!surfaces.corners(t, px)) {
      std::fill(mask.begin(), mask.end(), 1);
      return;
    }
    fill({px[0], px[1], px[2]}, view, mask);
  }
}

void fill(const BrickOutlines& bricks, const View& view, std::vector<char>& mask) {
  if (bricks.everywhere) std::fill(mask.begin(), mask.end(), 1);
  for (const auto& corners : bricks.corners_px) fill({corners.begin(), corners.end()}, view, mask);
}

void fillBricks(const VolumeRays& rays, const Layers::Prepared& layer, const View& view,
                std::vector<char>& mask) {
  fill(brickOutlines(rays, [&](const LocalRange& values) { return layer.contributes(values); }), view, mask);
}

// What the inside of a lens shows: bricks that reach into it, where the lens is.
void fillInsides(const LensReference& lensed, const View& view, std::vector<char>& mask) {
  for (std::size_t n = 0; n < lensed.lenses().size(); ++n) {
    const ConvexRegion& region = *lensed.lenses()[n].region;
    std::vector<char> bricks(mask.size(), 0), lens(mask.size(), 0);
    fill(brickOutlines(
             lensed.rays(), [&](const LocalRange& values) { return lensed.contributes(n + 1, values); },
             &region),
         view, bricks);
    std::vector<glm::dvec2> outline(region.corners.size());
    bool before = true;
    for (std::size_t c = 0; c < outline.size(); ++c)
      before = lensed.rays().camera().pixelOf(region.corners[c].p, outline[c]) && before;
    before ? fill(outline, view, lens) : std::fill(lens.begin(), lens.end(), 1);
    for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = mask[p] || (bricks[p] && lens[p]) ? 1 : 0;
  }
}

// Columns are lines: the rows at which each passes through the volume's box, widened by half a slab. With
// their neighbours, which is the dilation along x.
void fillCurved(const CurvedReference& curved, const View& view, std::vector<char>& mask) {
  const std::array<glm::dvec3, 2> box = boxOf(curved.volume().grid());
  const VoxelFromPatient& toVoxel = curved.volume().voxelFromPatient();
  const int dilate = static_cast<int>(kDilate_px);
  for (int x = 0; x < view.width_px; ++x) {
    const auto line = curved.columnAt(x);
    if (!line) continue;
    const glm::dvec3 origin = (toVoxel * PatientPoint(line->top)).p,
                     step = (toVoxel * PatientVec(line->down)).v;
    const glm::dvec3 slab =
        glm::abs((toVoxel * PatientVec(0.5 * curved.reading().thickness_mm() * line->normal)).v);
    double from = line->firstRow, to = line->lastRow;  // rows, centres at half-integers
    for (int a = 0; a < 3; ++a) {
      const double low = box[0][a] - slab[a] - origin[a], high = box[1][a] + slab[a] - origin[a];
      if (std::abs(step[a]) < 1e-12) {
        if (low > 0 || high < 0) to = from - 1e9;
        continue;
      }
      from = std::max(from, std::min(low / step[a], high / step[a]));
      to = std::min(to, std::max(low / step[a], high / step[a]));
    }
    if (from > to) continue;
    const int y0 = std::max(0, static_cast<int>(std::floor(from)) - dilate);
    const int y1 = std::min(view.height_px - 1, static_cast<int>(std::floor(to)) + dilate);
    for (int y = y0; y <= y1; ++y)
      for (int n = std::max(0, x - dilate); n <= std::min(view.width_px - 1, x + dilate); ++n)
        mask[static_cast<std::size_t>(n) +
             static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width_px)] = 1;
  }
}

}  // namespace

std::vector<std::size_t> population(const Layers& layers, const View& view) {
  const auto width = static_cast<std::size_t>(view.width_px),
             height = static_cast<std::size_t>(view.height_px);
  std::vector<char> mask(width * height, 0);
  bool known = false;
  for (const Layers::Prepared& p : layers.prepared()) {
    if (const auto* slice = std::get_if<SliceReference>(&p.layer)) {
      fill(slabOutline(*slice), view, mask);
      known = true;
    } else if (const auto* curved = std::get_if<CurvedReference>(&p.layer)) {
      fillCurved(*curved, view, mask);
      known = true;
    } else if (const auto* surfaces = std::get_if<SurfaceReference>(&p.layer)) {
      fillSurfaces(*surfaces, view, mask);
      known = true;
    } else if (const VolumeRays* rays = p.rays()) {
      fillBricks(*rays, p, view, mask);
      fillSurfaces(rays->surfaces(), view, mask);
      if (const auto* lensed = std::get_if<LensReference>(&p.layer)) fillInsides(*lensed, view, mask);
      known = true;
    } else if (const auto* image = std::get_if<ImageReference>(&p.layer)) {
      const auto [a, b] = image->outline();
      fill({a, {b.x, a.y}, b, {a.x, b.y}}, view, mask);
      known = true;
    }
  }
  // Where a plugin's layer alone can show something is not known: every pixel counts.
  if (!known && !layers.prepared().empty()) std::fill(mask.begin(), mask.end(), 1);
  std::vector<std::size_t> out;
  out.reserve(mask.size());
  for (std::size_t y0 = 0; y0 < height; y0 += kTile)
    for (std::size_t x0 = 0; x0 < width; x0 += kTile)
      for (std::size_t y = y0; y < std::min(height, y0 + kTile); ++y)
        for (std::size_t x = x0; x < std::min(width, x0 + kTile); ++x)
          if (mask[x + width * y]) out.push_back(x + width * y);
  return out;
}

}  // namespace vernier::quality
