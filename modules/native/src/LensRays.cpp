// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/LensRays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "TriangleSetup.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::native {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr RaySpan kMiss{kInfinite, -kInfinite};

// Where the plane of a face stands on the line of a pixel: depth along forward = (at0 + x atX + y atY) /
// (along0 + x alongX + y alongY), pixels from the picture's first corner; the lower part is negative where
// lines enter through the face.
struct FaceDepth {
  double at0 = 0, atX = 0, atY = 0, along0 = 0, alongX = 0, alongY = 0;

  FaceDepth(const HalfSpace& h, const CameraPicture& c) {
    const PatientVec corner = c.across(0, 0);
    const double x = glm::dot(h.normal.v, c.right.v) * c.pixelStep,
                 y = -glm::dot(h.normal.v, c.up.v) * c.pixelStep;
    const double before = -h.distance_mm(c.eye), forward = glm::dot(h.normal.v, c.forward.v),
                 first = glm::dot(h.normal.v, corner.v);
    if (c.projection == Projection::Orthographic)
      at0 = before - first, atX = -x, atY = -y, along0 = forward;
    else
      at0 = before, along0 = forward + first, alongX = x, alongY = y;
  }
  double at(double x, double y) const { return at0 + x * atX + y * atY; }
  double along(double x, double y) const { return along0 + x * alongX + y * alongY; }
};

std::vector<glm::dvec4> projected(const ConvexRegion& lens, const CameraPicture& camera) {
  const glm::dmat4 pixel = camera.pixelFromPatient();
  std::vector<glm::dvec4> out;
  out.reserve(lens.corners.size());
  for (const PatientPoint& p : lens.corners) out.push_back(pixel * glm::dvec4(p.p, 1));
  return out;
}

struct PixelBox {
  int x0, y0, x1, y1;
};

// Pixels whose centres the points may cover; all of them when a point is not before the eye.
template <class Points>
PixelBox boxOf(const Points& points, const CameraPicture& camera) {
  double x0 = kInfinite, y0 = kInfinite, x1 = -kInfinite, y1 = -kInfinite;
  for (const glm::dvec4& p : points) {
    if (!(p.w > 1e-9)) return {0, 0, camera.width_px, camera.height_px};
    x0 = std::min(x0, p.x / p.w), x1 = std::max(x1, p.x / p.w);
    y0 = std::min(y0, p.y / p.w), y1 = std::max(y1, p.y / p.w);
  }
  const auto within = [](double v, int most) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(most)));
  };
  return {within(std::floor(x0 - 0.5), camera.width_px), within(std::floor(y0 - 0.5), camera.height_px),
          within(std::ceil(x1 + 0.5), camera.width_px), within(std::ceil(y1 + 0.5), camera.height_px)};
}

struct Facet {
  EdgeLine edges[3];
  PixelBox box;
  FaceDepth depth;
};

std::vector<Facet> facetsOf(const ConvexRegion& lens, const CameraPicture& camera,
                            const std::vector<glm::dvec4>& corners) {
  std::vector<Facet> out;
  out.reserve(lens.triangles.size());
  for (std::size_t n = 0; n < lens.triangles.size(); ++n) {
    const auto& t = lens.triangles[n];
    const std::array<glm::dvec4, 3> p{corners[t[0]], corners[t[1]], corners[t[2]]};
    Facet f{{}, boxOf(p, camera), FaceDepth(lens.planes[lens.planeOf[n]], camera)};
    if (f.box.x0 >= f.box.x1 || f.box.y0 >= f.box.y1) continue;
    for (std::size_t i = 0; i < 3; ++i) f.edges[i] = edgeThrough(p[i], p[(i + 1) % 3], t[i] < t[(i + 1) % 3]);
    out.push_back(f);
  }
  return out;
}

// From depths to distances along the pixels' rays, for one row of the box.
void toDistances(const CameraPicture& camera, int row, LensSpans& out) {
  if (camera.projection == Projection::Orthographic) return;
  const std::size_t width = static_cast<std::size_t>(out.x1 - out.x0);
  RaySpan* const spans = out.spans.data() + static_cast<std::size_t>(row - out.y0) * width;
  const double v = (0.5 * camera.height_px - (row + 0.5)) * camera.pixelStep;
  for (std::size_t n = 0; n < width; ++n) {
    const double u = (out.x0 + static_cast<double>(n) + 0.5 - 0.5 * camera.width_px) * camera.pixelStep;
    const double perDepth = std::sqrt(1 + u * u + v * v);
    spans[n].entry_mm *= perDepth, spans[n].exit_mm *= perDepth;
  }
}

void rasterise(const ConvexRegion& lens, const CameraPicture& camera, const std::vector<glm::dvec4>& corners,
               LensSpans& out) {
  constexpr int kBand = 16, kStrip = 64;
  const std::vector<Facet> facets = facetsOf(lens, camera, corners);
  const int width = out.x1 - out.x0, bands = (out.y1 - out.y0 + kBand - 1) / kBand;
  parallelFor(static_cast<std::size_t>(std::max(bands, 0)), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const int top = out.y0 + kBand * static_cast<int>(b), bottom = std::min(top + kBand, out.y1);
      for (const Facet& f : facets) {
        const int y0 = std::max(top, f.box.y0), y1 = std::min(bottom, f.box.y1);
        if (y0 >= y1) continue;
        for (int x0 = std::max(f.box.x0, out.x0); x0 < std::min(f.box.x1, out.x1); x0 += kStrip) {
          std::uint64_t rows[kBand];
          coverRows(f.edges, x0, y0, std::min(kStrip, std::min(f.box.x1, out.x1) - x0), y1 - y0, rows);
          for (int y = y0; y < y1; ++y)
            for (std::uint64_t bits = rows[y - y0]; bits; bits &= bits - 1) {
              const int x = x0 + std::countr_zero(bits);
              const double along = f.depth.along(x + 0.5, y + 0.5);
              if (along == 0) continue;
              RaySpan& span = out.spans[static_cast<std::size_t>((y - out.y0) * width + x - out.x0)];
              (along < 0 ? span.entry_mm : span.exit_mm) = f.depth.at(x + 0.5, y + 0.5) / along;
            }
        }
      }
      for (int y = top; y < bottom; ++y) toDistances(camera, y, out);
    }
  });
}

// Row by row, all pixels against one face after the other.
void throughAllFaces(const ConvexRegion& lens, const CameraPicture& camera, LensSpans& out) {
  std::vector<FaceDepth> faces;
  for (const HalfSpace& h : lens.planes) faces.emplace_back(h, camera);
  const auto width = static_cast<std::size_t>(out.x1 - out.x0);
  parallelFor(static_cast<std::size_t>(out.y1 - out.y0), 8, [&](std::size_t begin, std::size_t end) {
    std::vector<double> entry(width), exit(width);
    for (std::size_t row = begin; row < end; ++row) {
      const double y = out.y0 + static_cast<double>(row) + 0.5;
      entry.assign(width, -kInfinite), exit.assign(width, kInfinite);
      for (const FaceDepth& f : faces)
        for (std::size_t n = 0; n < width; ++n) {
          const double x = out.x0 + static_cast<double>(n) + 0.5;
          const double along = f.along(x, y), at = f.at(x, y), depth = at / along;
          const bool never = along == 0 && at < 0;
          entry[n] = along < 0 ? std::max(entry[n], depth) : never ? kInfinite : entry[n];
          exit[n] = along > 0 ? std::min(exit[n], depth) : exit[n];
        }
      for (std::size_t n = 0; n < width; ++n)
        out.spans[row * width + n] = entry[n] <= exit[n] ? RaySpan{entry[n], exit[n]} : kMiss;
      toDistances(camera, out.y0 + static_cast<int>(row), out);
    }
  });
}

}  // namespace

LensSpans lensSpans(const ConvexRegion& lens, const CameraPicture& camera, bool rasterised) {
  const std::vector<glm::dvec4> corners = projected(lens, camera);
  const PixelBox box = boxOf(corners, camera);
  LensSpans out{box.x0, box.y0, std::max(box.x0, box.x1), std::max(box.y0, box.y1), {}};
  const int width = out.x1 - out.x0, height = out.y1 - out.y0;
  out.spans.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kMiss);
  if (rasterised) {
    rasterise(lens, camera, corners, out);
    return out;
  }
  throughAllFaces(lens, camera, out);
  return out;
}

namespace {

// Cuts one pixel's ray.
class RayCutter {
 public:
  RayCutter(const LensRaysJob& job, const std::vector<LensSpans>& lenses) : job_(job), lenses_(lenses) {
    within_.resize(lenses.size());
  }

  void cut(int x, int y, std::vector<RaySegment>& out) {
    if (!meetsAny(x, y)) return;
    const PatientRay ray = job_.camera.ray(x + 0.5, y + 0.5);
    RaySpan span = spanOf(ray, job_.region, job_.camera.near_mm * job_.camera.rayPerDepth(x + 0.5, y + 0.5));
    if (span.empty() || !clipTo(span, x, y)) return;
    const std::size_t pixel = static_cast<std::size_t>(x) +
                              static_cast<std::size_t>(job_.camera.width_px) * static_cast<std::size_t>(y);
    cuts_.assign({span.entry_mm, span.exit_mm});
    for (const RaySpan& s : within_)
      if (!s.empty()) cuts_.push_back(s.entry_mm), cuts_.push_back(s.exit_mm);
    addTools(pixel, span);
    std::sort(cuts_.begin(), cuts_.end());
    parts(pixel, span, out);
  }

 private:
  bool meetsAny(int x, int y) const {
    return std::any_of(lenses_.begin(), lenses_.end(), [&](const LensSpans& l) {
      const RaySpan* const s = l.at(x, y);
      return s && !s->empty();
    });
  }

  // The parts of the ray in each lens; false when there is none.
  bool clipTo(const RaySpan& span, int x, int y) {
    bool any = false;
    for (std::size_t n = 0; n < lenses_.size(); ++n) {
      within_[n] = kMiss;
      const RaySpan* const found = lenses_[n].at(x, y);
      if (!found) continue;
      RaySpan s = *found;
      s.entry_mm = std::max(s.entry_mm, span.entry_mm), s.exit_mm = std::min(s.exit_mm, span.exit_mm);
      if (!(s.entry_mm < s.exit_mm)) continue;
      within_[n] = s;
      any = true;
    }
    return any;
  }

  void addTools(std::size_t pixel, const RaySpan& span) {
    end_mm_ = kInfinite;
    if (!job_.tools) return;
    end_mm_ = static_cast<double>(job_.tools->end_mm[pixel]);
    cuts_.push_back(std::clamp(end_mm_, span.entry_mm, span.exit_mm));
    for (std::uint32_t n = job_.tools->first[pixel]; n < job_.tools->first[pixel + 1]; ++n)
      cuts_.push_back(
          std::clamp(static_cast<double>(job_.tools->layers[n].t_mm), span.entry_mm, span.exit_mm));
  }

  void tools(std::size_t pixel, double until_mm, std::vector<RaySegment>& out) {
    for (; job_.tools && layer_ < job_.tools->first[pixel + 1]; ++layer_) {
      const SurfaceHits::Layer& l = job_.tools->layers[layer_];
      if (static_cast<double>(l.t_mm) > until_mm) return;
      RaySegment s;
      s.from_mm = s.to_mm = l.t_mm;
      s.appearance = RaySegment::kTool;
      s.weight = weight_, s.colour = {l.r, l.g, l.b}, s.through = 1 - l.alpha;
      weight_ *= s.through;
      out.push_back(s);
    }
  }

  std::int16_t appearanceAt(double t) const {
    for (std::size_t n = within_.size(); n-- > 0;)
      if (within_[n].entry_mm <= t && t <= within_[n].exit_mm) return static_cast<std::int16_t>(n + 1);
    return 0;
  }

  void parts(std::size_t pixel, const RaySpan& span, std::vector<RaySegment>& out) {
    weight_ = 1;
    if (job_.tools) layer_ = job_.tools->first[pixel];
    for (std::size_t n = 0; n + 1 < cuts_.size(); ++n) {
      const double from = cuts_[n], to = cuts_[n + 1];
      if (!(static_cast<float>(from) < static_cast<float>(to)) || from >= end_mm_) continue;
      tools(pixel, from, out);
      const std::int16_t appearance = appearanceAt(0.5 * (from + to));
      RaySegment* last = out.empty() ? nullptr : &out.back();
      if (last && last->appearance == appearance && last->to_mm == static_cast<float>(from)) {
        last->to_mm = static_cast<float>(to), last->endsInside = to < span.exit_mm;
        continue;
      }
      RaySegment s;
      s.from_mm = static_cast<float>(from), s.to_mm = static_cast<float>(to);
      s.appearance = appearance, s.weight = weight_;
      s.beginsInside = from > span.entry_mm, s.endsInside = to < span.exit_mm;
      out.push_back(s);
    }
    tools(pixel, kInfinite, out);
    if (!(end_mm_ < kInfinite)) return;
    RaySegment s;
    s.from_mm = s.to_mm = static_cast<float>(end_mm_);
    s.appearance = RaySegment::kEnd;
    s.weight = weight_, s.through = 0;
    for (std::size_t c = 0; c < 3; ++c) s.colour[c] = job_.tools->endColour[3 * pixel + c];
    out.push_back(s);
  }

  const LensRaysJob& job_;
  const std::vector<LensSpans>& lenses_;
  std::vector<RaySpan> within_;
  std::vector<double> cuts_;
  double end_mm_ = kInfinite;
  float weight_ = 1;
  std::uint32_t layer_ = 0;
};

std::vector<LensSpans> spansOf(const LensRaysJob& job) {
  std::vector<LensSpans> found;
  for (const auto& lens : job.lenses)
    found.push_back(lensSpans(*lens, job.camera, lens->planes.size() > kAnalyticFacets));
  return found;
}

}  // namespace

Result<void> markLenses(const LensRaysJob& job, Images& images, std::stop_token stop) {
  const TraceSpan span("lenses on rays");
  auto rays = std::make_shared<RayIntervals>();
  rays->width = job.camera.width_px, rays->height = job.camera.height_px;
  rays->lenses = job.known ? *job.known : spansOf(job);
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "Finding lenses on rays was cancelled.");
  images.rays = std::move(rays);
  return {};
}

Result<void> cutRays(const LensRaysJob& job, Images& images, std::stop_token stop) {
  const TraceSpan span("rays cut at lenses");
  std::vector<LensSpans> found;
  if (!job.known) found = spansOf(job);
  const std::vector<LensSpans>& lenses = job.known ? *job.known : found;
  const auto width = static_cast<std::size_t>(job.camera.width_px),
             height = static_cast<std::size_t>(job.camera.height_px);
  auto rays = std::make_shared<RayIntervals>();
  rays->width = job.camera.width_px, rays->height = job.camera.height_px;
  rays->first.assign(width * height + 1, 0);
  std::vector<std::vector<RaySegment>> rows(height);
  parallelFor(height, 4, [&](std::size_t begin, std::size_t end) {
    RayCutter cutter(job, lenses);
    std::vector<RaySegment> pixel;
    for (std::size_t y = begin; y < end && !stop.stop_requested(); ++y)
      for (std::size_t x = 0; x < width; ++x) {
        pixel.clear();
        cutter.cut(static_cast<int>(x), static_cast<int>(y), pixel);
        rows[y].insert(rows[y].end(), pixel.begin(), pixel.end());
        rays->first[y * width + x + 1] = static_cast<std::uint32_t>(pixel.size());
      }
  });
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "Cutting rays at lenses was cancelled.");
  for (std::size_t n = 0; n < width * height; ++n) rays->first[n + 1] += rays->first[n];
  rays->segments.resize(rays->first.back());
  for (std::size_t y = 0; y < height; ++y)
    std::copy(rows[y].begin(), rows[y].end(), rays->segments.begin() + rays->first[y * width]);
  images.rays = std::move(rays);
  return {};
}

}  // namespace vernier::native
