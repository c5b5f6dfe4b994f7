// SPDX-License-Identifier: GPL-3.0-or-later
#include "Work.h"

#include <algorithm>

#include "vernier/measure/Millimetres.h"

namespace vernier::measure {
namespace {

glm::dmat3 outer(glm::dvec3 v) { return glm::outerProduct(v, v); }

void checkPoints(std::span<const Spot> points) {
  for (const Spot& p : points)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      refuse("A point is not finite; give numbers.");
}

Placement::Axes checkedAxes(const Placement::Axes& a) {
  const double n = glm::length(a.normal.v);
  if (!(n > 0) || !std::isfinite(n)) refuse("The picture's plane has no normal.");
  const glm::dvec3 normal = a.normal.v / n;
  const glm::dvec3 up = a.up.v - glm::dot(a.up.v, normal) * normal;
  if (!(glm::length(up) > 1e-9 * glm::length(a.up.v))) refuse("The picture's up is parallel to its normal.");
  return {PatientVec(normal), PatientVec(glm::normalize(up))};
}

void prepareImage(Work& w, std::span<const Spot> points) {
  if (!w.sources.image) refuse("There is no image to measure on.");
  auto image = w.sources.image(w.what.on.source, w.what.on.frame);
  if (!image) throw Refused{image.error()};
  w.image = image->frame;
  for (const Spot& p : points)
    if (p.z != 0) refuse("In an image a point has two coordinates, in pixels.");
  const ImageFrameInfo& f = w.image->info();
  const PixelScale s = pixelScaleOf(f, image->calibration, points, w.what.on.userSpacing_mm);
  w.scale = {s.perPixel, 1};
  w.unit = s.unit;
  w.out.origin = s.origin;
  w.out.originText = s.text;
  w.out.sopInstanceUid = f.sopInstanceUid;
  w.out.frameOfReferenceUid = image->frameOfReferenceUid;
  w.out.frameNumber = f.frameNumber;
  w.axes = Placement::Axes{};
  const double hand = 0.5 * w.what.on.screenPixel;
  for (int a = 0; a < 2; ++a) w.covariance[a][a] = w.scale[a] * w.scale[a] * (hand * hand + 1.0 / 12);
}

bool needsVolume(const Shape& s) {
  const auto named = [](const SurfaceRef& r) { return !r.level_val; };
  if (const auto* p = std::get_if<ToolToVessel>(&s)) return !named(p->tool) || !named(p->vessel);
  if (const auto* p = std::get_if<PointToSurface>(&s)) return !named(p->surface);
  if (const auto* p = std::get_if<SurfaceVolume>(&s)) return !named(p->surface);
  return !std::holds_alternative<ConvexVolume>(s) && !std::holds_alternative<Arrow>(s) &&
         !std::holds_alternative<Text>(s);
}

void preparePatient(Work& w) {
  if (w.what.on.axes) w.axes = checkedAxes(*w.what.on.axes);
  w.out.origin = Origin::PixelSpacing;
  w.out.originText = "mm (Pixel Spacing and slice positions)";
  auto volume = w.sources.volume ? w.sources.volume(w.what.on.source)
                                 : Result<std::shared_ptr<const Volume>>(makeError(
                                       ErrorCode::OptionInvalid, "There is no volume to measure in."));
  if (!volume) {
    if (needsVolume(w.what.shape)) throw Refused{volume.error()};
    w.known = false;
    w.out.origin = Origin::File;
    w.out.originText = "mm (of the surfaces' files)";
    return;
  }
  w.volume = *volume;
  const VolumeInfo& info = w.volume->info();
  w.out.frameOfReferenceUid = info.frameOfReferenceUid;
  if (info.seriesUid.empty()) {
    const FileScale file = fileScaleOf(info.findings);
    w.out.origin = file.origin;
    w.out.originText = file.text;
    if (file.origin == Origin::Pixels) w.unit = "px";
  }
  const glm::dmat3& m = info.grid.patientFromVoxel.linear;
  const glm::dvec3 spacing = info.grid.spacing_mm();
  w.covariance =
      (outer(m[0]) + outer(m[1]) + spacing.z * spacing.z * outer(glm::normalize(glm::cross(m[0], m[1])))) *
      (1.0 / 12);
  if (w.axes) {
    const double hand = 0.5 * w.what.on.screenPixel;
    w.covariance += hand * hand * (glm::dmat3(1) - outer(w.axes->normal.v));
  }
}

}  // namespace

void refuse(std::string sentence) { throw Refused{makeError(ErrorCode::OptionInvalid, std::move(sentence))}; }

void Work::note(std::string text) {
  if (std::find(out.notes.begin(), out.notes.end(), text) == out.notes.end())
    out.notes.push_back(std::move(text));
}

double Work::worstVariance() const {
  // The largest eigenvalue, by powers of a symmetric matrix without negative eigenvalues.
  glm::dmat3 m = covariance;
  for (int i = 0; i < 40; ++i) {
    const double size = std::max({m[0][0], m[1][1], m[2][2]});
    if (!(size > 0)) return 0;
    m = (m / size) * (m / size);
  }
  int longest = 0;
  for (int a = 1; a < 3; ++a)
    if (glm::length(m[a]) > glm::length(m[longest])) longest = a;
  return quadratic(glm::normalize(m[longest]));
}

glm::dvec3 screenRight(const Placement::Axes& a) { return glm::cross(a.up.v, a.normal.v); }

void prepare(Work& w, std::span<const Spot> points) {
  checkPoints(points);
  if (!(w.what.on.screenPixel >= 0) || !std::isfinite(w.what.on.screenPixel))
    refuse("The size of a screen's pixel is 0 or above.");
  if (w.what.on.space == Space::Image) {
    if (w.what.on.shown != Shown::Slice) refuse("A stored frame is measured as it is: a slice.");
    prepareImage(w, points);
  } else {
    if (w.what.on.userSpacing_mm)
      refuse("A calibration by the user is for stored frames; the volume has its own mm.");
    preparePatient(w);
  }
  if (w.projected()) w.note("projected: what lies in depth is not measured");
}

void noteGaps(Work& w, std::span<const Spot> points) {
  if (!w.volume || points.empty()) return;
  const GridGeometry& g = w.volume->grid();
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Spot& p : points) {
    const double k = (w.volume->voxelFromPatient() * PatientPoint(p)).p.z;
    low = std::min(low, k), high = std::max(high, k);
  }
  for (const std::int64_t s : g.gapAfter) {
    const double from = g.sliceOrigin_vox[static_cast<std::size_t>(s)].z + 0.5,
                 to = g.sliceOrigin_vox[static_cast<std::size_t>(s) + 1].z - 0.5;
    if (low < to && high > from) {
      w.note("crosses missing slices");
      return;
    }
  }
}

}  // namespace vernier::measure
