// SPDX-License-Identifier: GPL-3.0-or-later
#include "Place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace vernier::ui {
namespace {

std::string number(double v, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, v);
  std::string s = text;
  if (s == "-0" || s == "-0.0") s.erase(0, 1);
  return s;
}

// Whole numbers as such, others to six digits.
std::string value(double v) {
  char text[64];
  if (v == std::floor(v) && std::abs(v) < 1e15)
    std::snprintf(text, sizeof text, "%.0f", v);
  else
    std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

std::string withUnit(double v, const std::string& unit) {
  return value(v) + (unit.empty() || unit == "stored value" ? "" : " " + unit);
}

// "stored 1012 × 1 − 1024"; only the stored value where nothing is done to it.
std::string rescaled(double stored, const ModalityRescale& r) {
  std::string s = "stored " + value(stored);
  if (r.slope == 1 && r.intercept == 0) return s;
  s += " \xC3\x97 " + value(r.slope);
  if (r.intercept != 0) s += (r.intercept < 0 ? " \xE2\x88\x92 " : " + ") + value(std::abs(r.intercept));
  return s;
}

Place imagePlace(const ImageLayer& layer, const Camera& camera, const View& view,
                 const ImageFrameInfo& info) {
  Place p;
  p.image = imagePicture(layer, camera, view, info);
  const ImagePicture& i = *p.image;
  p.unit_mm = i.mmPerPixel > 0 ? i.mmPerPixel : 1 / std::abs(i.pxPerColumn);
  if (!info.plane || !(info.pixelSpacing_mm.x > 0) || !(info.pixelSpacing_mm.y > 0)) return p;
  const PatientVec alongRow = info.pixelSpacing_mm.y * info.plane->rowDirection;  // of one column
  const PatientVec alongColumn = info.pixelSpacing_mm.x * info.plane->columnDirection;
  p.inPatient = true;
  p.right = (1 / i.pxPerColumn) * alongRow;
  p.down = (1 / i.pxPerRow) * alongColumn;
  p.origin = info.plane->origin + (-i.x0 / i.pxPerColumn - 0.5) * alongRow +
             (-i.y0 / i.pxPerRow - 0.5) * alongColumn;
  p.normal = normalize(cross(p.down, p.right));
  return p;
}

// The image of the stack that voxel slice k was made of: slices that could not be decoded are not in the
// volume, so their numbers may differ.
std::size_t imageOfSlice(const Volume& volume, const SourceFacts& facts, std::int64_t k) {
  const GridGeometry& g = volume.grid();
  const glm::dvec3 at =
      g.even() ? glm::dvec3(0, 0, static_cast<double>(k)) : g.sliceOrigin_vox[static_cast<std::size_t>(k)];
  const PatientPoint origin = g.patientFromVoxel * VoxelPoint(at);
  std::size_t best = 0;
  double closest = -1;
  for (std::size_t n = 0; n < facts.frames.size(); ++n) {
    if (!facts.frames[n].plane) continue;
    const double d = length(facts.frames[n].plane->origin - origin);
    if (closest < 0 || d < closest) closest = d, best = n;
  }
  return best;
}

}  // namespace

glm::dvec2 Place::pixelOf(PatientPoint p) const {
  const glm::dvec3 d = (p - origin).v;
  // right and down are at right angles in all that is drawn.
  return {glm::dot(d, right.v) / glm::dot(right.v, right.v), glm::dot(d, down.v) / glm::dot(down.v, down.v)};
}

std::optional<Place> placeOf(const Scene& scene, const SourceFacts& facts, const GridGeometry* grid,
                             const View& view) {
  if (const ImageLayer* image = imageOf(scene)) {
    if (image->index < 0 || image->index >= facts.count()) return std::nullopt;
    return imagePlace(*image, scene.camera, view, facts.frames[static_cast<std::size_t>(image->index)]);
  }
  const SliceLayer* slice = sliceOf(scene);
  if (!slice || !grid) return std::nullopt;
  const Result<SlicePicture> picture = slicePicture(*slice, scene.camera, view, *grid);
  if (!picture) return std::nullopt;
  Place p;
  p.unit_mm = picture->mmPerPixel;
  p.inPatient = true;
  p.origin = picture->origin, p.right = picture->right, p.down = picture->down, p.normal = picture->normal;
  return p;
}

std::optional<PixelLine> crossing(const Place& a, const Place& b, const View& view) {
  if (!a.inPatient || !b.inPatient) return std::nullopt;
  if (length(cross(a.normal, b.normal)) < 1.7e-3) return std::nullopt;
  // b's plane on a's pixels: u x + v y + w = 0.
  const double u = dot(b.normal, a.right), v = dot(b.normal, a.down), w = dot(b.normal, a.origin - b.origin);
  const glm::dvec2 n(u, v);
  const glm::dvec2 foot = n * (-w / glm::dot(n, n)), along(-v, u);
  double lo = -1e30, hi = 1e30;
  const std::array<double, 2> size{static_cast<double>(view.width_px), static_cast<double>(view.height_px)};
  for (int k = 0; k < 2; ++k) {
    const double f = foot[k], d = along[k], end = size[static_cast<std::size_t>(k)];
    if (d == 0) {
      if (f < 0 || f > end) return std::nullopt;
      continue;
    }
    const double t0 = -f / d, t1 = (end - f) / d;
    lo = std::max(lo, std::min(t0, t1)), hi = std::min(hi, std::max(t0, t1));
  }
  if (lo >= hi) return std::nullopt;
  return PixelLine{foot + lo * along, foot + hi * along};
}

std::string placeText(PatientPoint p) {
  const auto part = [](double v, const char* plus, const char* minus) {
    return std::string(v < 0 ? minus : plus) + " " + number(std::abs(v), 1);
  };
  return part(p.p.x, "L", "R") + "  " + part(p.p.y, "P", "A") + "  " + part(p.p.z, "H", "F") + " mm";
}

Probe probeImage(const Place& place, const ImageFrame& frame, const SourceFacts& facts, glm::dvec2 px) {
  const ImageFrameInfo& info = frame.info();
  const double column = (px.x - place.image->x0) / place.image->pxPerColumn - 0.5;
  const double row = (px.y - place.image->y0) / place.image->pxPerRow - 0.5;
  const auto i = static_cast<std::int64_t>(std::floor(column + 0.5));
  const auto j = static_cast<std::int64_t>(std::floor(row + 0.5));
  if (i < 0 || j < 0 || i >= info.columns || j >= info.rows) return {};
  Probe p;
  const double stored = frame.stored(i, j);
  p.value = frame.isNoData(stored) ? "no data (padding)" : withUnit(frame.modality(i, j), info.unit);
  p.origin = info.modalityLut ? "stored " + value(stored) + " through the modality LUT"
                              : rescaled(stored, info.rescale);
  p.origin += ", " + facts.files[static_cast<std::size_t>(info.index)] + ", row " + std::to_string(j) +
              ", column " + std::to_string(i);
  if (place.inPatient) p.place = placeText(place.patientAt(px));
  return p;
}

Probe probeVolume(const Place& place, const Volume& volume, const SourceFacts& facts, glm::dvec2 px,
                  bool slab) {
  const PatientPoint at = place.patientAt(px);
  if (!slab) return probePoint(volume, facts, at);
  Probe p;
  p.place = placeText(at);
  p.value = "projected";
  p.origin = "a slab has no single value under the pointer";
  return p;
}

Probe probePoint(const Volume& volume, const SourceFacts& facts, PatientPoint at) {
  Probe p;
  p.place = placeText(at);
  const auto nearest = probeStored(volume, at);
  const auto here = sampleModality(volume, at);
  if (!nearest) return p.value = "", p;
  const std::string& unit = volume.info().unit;
  p.value = here ? withUnit(std::round(*here * 100) / 100, unit) + " interpolated" : "no data (padding)";
  const OriginalVoxels* original = volume.original();
  const ModalityRescale& r =
      original ? original->rescale[static_cast<std::size_t>(nearest->k)] : volume.rescaleOf(nearest->k);
  p.origin =
      "nearest voxel " + withUnit(nearest->modality, unit) + ", " +
      (original && original->throughLut ? "stored " + value(nearest->stored) + " through the modality LUT"
                                        : rescaled(nearest->stored, r));
  if (!facts.files.empty()) p.origin += ", " + facts.files[imageOfSlice(volume, facts, nearest->k)];
  p.origin += ", row " + std::to_string(nearest->j) + ", column " + std::to_string(nearest->i);
  return p;
}

}  // namespace vernier::ui
