// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses on slices: another window, or nothing, where the plane cuts a convex region.
#include <algorithm>
#include <cmath>

#include "NativeJob.h"
#include "SliceParams.h"
#include "vernier/base/Threads.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr {
namespace {

// The faces of a region that a slice meets: what lies outside the region on the slice lies outside one of
// them, for the slice cuts a convex polygon out of the region, and these hold its edges.
std::vector<HalfSpace> facesOnSlice(const ConvexRegion& region, const SlicePicture& picture) {
  const PatientPoint origin = patientAt(picture, {0, 0});
  const PatientVec normal =
      normalize(cross(patientAt(picture, {1, 0}) - origin, patientAt(picture, {0, 1}) - origin));
  std::vector<double> height(region.corners.size());
  double farthest = 0;
  for (std::size_t n = 0; n < height.size(); ++n) {
    height[n] = dot(normal, region.corners[n] - origin);
    farthest = std::max(farthest, std::abs(height[n]));
  }
  // Corners lie on their planes to rounding: faces that the slice all but touches are met too.
  const double slack = 1e-9 * (1 + farthest);
  std::vector<bool> met(region.planes.size(), false);
  for (std::size_t n = 0; n < region.triangles.size(); ++n) {
    const auto [least, most] = std::minmax(
        {height[region.triangles[n][0]], height[region.triangles[n][1]], height[region.triangles[n][2]]});
    if (least <= slack && most >= -slack) met[region.planeOf[n]] = true;
  }
  std::vector<HalfSpace> out;
  for (std::size_t n = 0; n < met.size(); ++n)
    if (met[n]) out.push_back(region.planes[n]);
  return out;
}

struct PixelRange {
  int from = 0, to = 0;  // [from, to)
};

// The pixels of one row whose points all faces hold. The interval is found from the faces' distances, which
// change evenly along the row; pixels beside its ends are looked at one by one.
PixelRange insideOf(const std::vector<HalfSpace>& faces, const SlicePicture& picture, int y, int width) {
  const auto at = [&](int x) { return patientAt(picture, {x + 0.5, y + 0.5}); };
  const PatientPoint first = at(0);
  const PatientVec step = at(1) - first;
  double low = 0, high = width - 1;
  for (const HalfSpace& h : faces) {
    const double d = h.distance_mm(first), slope = dot(h.normal, step);
    if (slope > 0)
      high = std::min(high, -d / slope);
    else if (slope < 0)
      low = std::max(low, -d / slope);
    else if (d > 0)
      return {};
  }
  const auto inside = [&](int x) {
    const PatientPoint p = at(x);
    return std::all_of(faces.begin(), faces.end(), [&](const HalfSpace& h) { return h.contains(p); });
  };
  if (!(low <= high + 2)) return {};
  const auto pixel = [&](double x) {
    return static_cast<int>(std::clamp(x, -1.0, static_cast<double>(width)));
  };
  PixelRange out{std::max(pixel(std::floor(low)) - 1, 0), std::min(pixel(std::ceil(high)) + 2, width)};
  while (out.from < out.to && !inside(out.from)) ++out.from;
  while (out.to > out.from && !inside(out.to - 1)) --out.to;
  return out;
}

void putInside(const SliceParams& p, const SliceInside& lens, const Images& inside, Images& images) {
  const auto width = static_cast<std::size_t>(images.width);
  const std::vector<HalfSpace> faces = facesOnSlice(*lens.region, p.picture);
  if (faces.empty()) return;
  const float background[3] = {static_cast<float>(p.background.r), static_cast<float>(p.background.g),
                               static_cast<float>(p.background.b)};
  parallelFor(static_cast<std::size_t>(images.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const PixelRange row = insideOf(faces, p.picture, static_cast<int>(y), images.width);
      for (std::size_t pixel = y * width + static_cast<std::size_t>(row.from);
           pixel < y * width + static_cast<std::size_t>(row.to); ++pixel) {
        for (std::size_t c = 0; c < 3; ++c)
          images.colour[4 * pixel + c] = lens.cutOut ? background[c] : inside.colour[4 * pixel + c];
        if (lens.cutOut) images.depth[pixel] = kNothing_mm;
      }
    }
  });
}

}  // namespace

Result<std::vector<SliceInside>> lensesOnSlice(const SliceParams& p, const PlanContext& context) {
  std::vector<SliceInside> out;
  if (!context.lenses.empty() && p.volume->isColour())
    return makeError(ErrorCode::NoTechnique, "it draws lenses in grey volumes only");
  for (const PlacedLens& placed : context.lenses) {
    const LensInner& inner = std::get<LensLayer>(context.scene.layers[placed.layer]).inner;
    SliceInside lens;
    lens.region = placed.region;
    if (const auto* look = std::get_if<SliceLook>(&inner)) {
      lens.cutOut = false;
      lens.interpolation = look->interpolation;
      lens.window = normalised(look->window ? *look->window : defaultWindow(*p.volume));
      lens.invert = look->invert != p.volume->info().inverted;
      if (!usableWindow(lens.window))
        return makeError(ErrorCode::SceneInvalid,
                         "The lens's window must have a width above 0 and finite numbers.");
    }
    out.push_back(std::move(lens));
  }
  return out;
}

Result<void> drawLenses(const SliceParams& p, Images& images, std::stop_token stop) {
  for (const SliceInside& lens : p.lenses) {
    Images inside;
    if (!lens.cutOut) {
      inside.allocate(images.width, images.height, false);
      native::SliceJob job = jobOf(p);
      job.interpolation = lens.interpolation, job.window = lens.window, job.invert = lens.invert;
      if (Result<void> drawn = native::drawSlice(job, inside, stop); !drawn) return drawn;
      images.counters += inside.counters;
    }
    putInside(p, lens, inside, images);
  }
  return {};
}

}  // namespace vernier::mpr
