// SPDX-License-Identifier: GPL-3.0-or-later
// The values inside a region: stored pixels of a frame or an acquired slice, else samples on a grid of the
// smallest spacing. In double from stored voxels; nothing is warped or resized.
#include <algorithm>
#include <limits>

#include "Region.h"
#include "vernier/measure/Outline.h"
#include "vernier/volume/Sampling.h"

namespace vernier::measure {
namespace {

constexpr double kMostSamples = 1e8;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Whole pixels of a raster that may have their centre inside.
struct Rows {
  std::int64_t firstColumn, lastColumn, firstRow, lastRow;
  bool empty() const { return firstColumn > lastColumn || firstRow > lastRow; }
};
Rows rowsOf(const Box& b, std::optional<std::pair<std::int64_t, std::int64_t>> size) {
  const auto low = [](double x) {
    return static_cast<std::int64_t>(std::floor(std::clamp(x, -1e15, 1e15) - 0.5));
  };
  const auto high = [](double x) {
    return static_cast<std::int64_t>(std::ceil(std::clamp(x, -1e15, 1e15) - 0.5));
  };
  Rows r{low(b.low.x), high(b.high.x), low(b.low.y), high(b.high.y)};
  if (size) {
    r.firstColumn = std::max<std::int64_t>(r.firstColumn, 0);
    r.firstRow = std::max<std::int64_t>(r.firstRow, 0);
    r.lastColumn = std::min(r.lastColumn, size->first - 1);
    r.lastRow = std::min(r.lastRow, size->second - 1);
  }
  return r;
}

// value(i, j): NaN for no data.
template <class Fn>
Inside fill(const Work& w, const Flat& f, const RasterMap& map, const Rows& rows, Fn&& value) {
  Inside in;
  if (rows.empty()) return in;
  const double size = static_cast<double>(rows.lastColumn - rows.firstColumn + 1) *
                      static_cast<double>(rows.lastRow - rows.firstRow + 1);
  if (size > kMostSamples) refuse("The region would take over a hundred million samples; draw it smaller.");
  in.raster.columns = static_cast<std::size_t>(rows.lastColumn - rows.firstColumn + 1);
  in.raster.values.assign(static_cast<std::size_t>(size), kNone);
  std::size_t row = 0;
  for (std::int64_t j = rows.firstRow; j <= rows.lastRow; ++j, ++row) {
    if (w.stop.stop_requested()) throw Refused{makeError(ErrorCode::Cancelled, "")};
    for (const auto& [from, to] : spansOf(f, map, static_cast<double>(j) + 0.5)) {
      const auto first = std::max(rows.firstColumn, static_cast<std::int64_t>(std::ceil(from - 0.5)));
      const auto last = std::min(rows.lastColumn, static_cast<std::int64_t>(std::floor(to - 0.5)));
      for (std::int64_t i = first; i <= last; ++i) {
        const double x = value(i, j);
        if (std::isnan(x)) ++in.noData;
        in.raster.values[row * in.raster.columns + static_cast<std::size_t>(i - rows.firstColumn)] = x;
      }
    }
  }
  return in;
}

Inside ofImage(const Work& w, const Flat& f) {
  const ImageFrame& image = *w.image;
  const RasterMap map{glm::dmat2(1 / w.scale.x, 0, 0, 1 / w.scale.y),
                      glm::dvec2(f.origin) / glm::dvec2(w.scale)};
  const Rows rows = rowsOf(boxOf(f, map), std::pair(image.info().columns, image.info().rows));
  Inside in = fill(w, f, map, rows, [&](std::int64_t i, std::int64_t j) {
    const double stored = image.stored(i, j);
    return image.isNoData(stored) ? kNone : image.modalityOf(stored);
  });
  if (image.info().type != VoxelType::F32 && !image.info().modalityLut)
    in.step = std::abs(image.info().rescale.slope);
  return in;
}

// From the plane's coordinates to pixels of slice k.
RasterMap sliceMap(const Volume& v, const Flat& f, std::int64_t k) {
  const glm::dmat3& m = v.voxelFromPatient().linear;
  const glm::dvec3 right = m * f.right, up = m * f.up, at = (v.voxelFromPatient() * PatientPoint(f.origin)).p;
  const glm::dvec3 first =
      v.grid().even() ? glm::dvec3(0) : v.grid().sliceOrigin_vox[static_cast<std::size_t>(k)];
  return {glm::dmat2(right.x, right.y, up.x, up.y), glm::dvec2(at.x - first.x + 0.5, at.y - first.y + 0.5)};
}

Inside ofSlice(const Work& w, const Flat& f, std::int64_t k) {
  const Volume& v = *w.volume;
  const RasterMap map = sliceMap(v, f, k);
  const Rows rows = rowsOf(boxOf(f, map), std::pair(v.grid().columns, v.grid().rows));
  Inside in = fill(w, f, map, rows, [&](std::int64_t i, std::int64_t j) {
    const VoxelValue x = v.probe(i, j, k);
    return x.noData ? kNone : x.modality;
  });
  const OriginalVoxels* const original = v.original();
  if (original ? original->type != VoxelType::F32 && !original->throughLut : v.type() != VoxelType::F32)
    in.step =
        std::abs(original ? original->rescale[static_cast<std::size_t>(k) % original->rescale.size()].slope
                          : v.rescaleOf(k).slope);
  return in;
}

// The grid is anchored in the patient, not at the region: two regions of one plane see the same samples.
Inside ofPlane(const Work& w, const Flat& f) {
  const Volume& v = *w.volume;
  const glm::dvec3 spacing = v.grid().spacing_mm();
  const double s = std::min({spacing.x, spacing.y, spacing.z});
  const glm::dvec2 origin{glm::dot(f.origin, f.right), glm::dot(f.origin, f.up)};
  const RasterMap map{glm::dmat2(1 / s, 0, 0, 1 / s), origin / s};
  Inside in = fill(w, f, map, rowsOf(boxOf(f, map), std::nullopt), [&](std::int64_t i, std::int64_t j) {
    const glm::dvec2 q = (glm::dvec2(static_cast<double>(i), static_cast<double>(j)) + 0.5) * s - origin;
    return sampleModality(v, PatientPoint(f.toSpace(q))).value_or(kNone);
  });
  in.interpolated = true;
  return in;
}

}  // namespace

std::vector<std::pair<double, double>> spansOf(const Flat& f, const RasterMap& map, double y) {
  std::vector<std::pair<double, double>> out;
  if (!f.ellipse) {
    std::vector<glm::dvec2> corners;
    for (const glm::dvec2& p : f.outline) corners.push_back(map * p);
    for (const RowSpans::Span& s : RowSpans(corners).at(y)) out.emplace_back(s.from, s.to);
    return out;
  }
  // |inverse (p - centre)| <= 1 along the row: a quadratic in x.
  const glm::dvec2 centre = map * ((f.outline[0] + f.outline[2]) * 0.5),
                   d = (f.outline[2] - f.outline[0]) * 0.5;
  const glm::dmat2 toUnit = glm::inverse(map.linear * glm::dmat2(d.x, 0, 0, d.y));
  const glm::dvec2 e = toUnit[0], g = toUnit[1] * (y - centre.y);
  const double a = glm::dot(e, e), b = glm::dot(e, g), c = glm::dot(g, g) - 1;
  const double inner = b * b - a * c;
  if (inner < -1e-9 * a) return out;
  const double half = std::sqrt(std::max(0.0, inner)) / a;
  out.emplace_back(centre.x - b / a - half - 1e-9, centre.x - b / a + half + 1e-9);
  return out;
}

Box boxOf(const Flat& f, const RasterMap& map) {
  Box b{map * f.outline[0], map * f.outline[0]};
  for (const glm::dvec2& p : f.outline) b.low = glm::min(b.low, map * p), b.high = glm::max(b.high, map * p);
  return b;
}

std::optional<std::int64_t> acquiredSlice(const Volume& v, const Flat& f) {
  const GridGeometry& g = v.grid();
  const auto depth = [&](glm::dvec2 q) { return (v.voxelFromPatient() * PatientPoint(f.toSpace(q))).p.z; };
  const double at = depth(f.outline[0]);
  std::int64_t k = static_cast<std::int64_t>(std::llround(std::clamp(at, -1e9, 1e9)));
  double z = static_cast<double>(k);
  if (!g.even()) {
    const auto nearest = std::min_element(
        g.sliceOrigin_vox.begin(), g.sliceOrigin_vox.end(),
        [&](const glm::dvec3& a, const glm::dvec3& b) { return std::abs(a.z - at) < std::abs(b.z - at); });
    k = nearest - g.sliceOrigin_vox.begin();
    z = nearest->z;
  }
  if (k < 0 || k >= g.slices) return std::nullopt;
  for (const glm::dvec2& p : f.outline)
    if (std::abs(depth(p) - z) > 1e-3) return std::nullopt;
  return k;
}

Inside valuesInside(const Work& w, const Flat& f) {
  if (w.image) return ofImage(w, f);
  if (const auto k = acquiredSlice(*w.volume, f)) return ofSlice(w, f, *k);
  return ofPlane(w, f);
}

}  // namespace vernier::measure
