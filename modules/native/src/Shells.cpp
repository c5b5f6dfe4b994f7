// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Shells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "ShellTiles.h"
#include "vernier/base/Log.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::native {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kTilePixels = kShellTile * kShellTile;
constexpr std::uint32_t kNoShell = 0xFFFFFFFF, kCapShell = 0xFFFFFFFE;

void putPart(const glm::dvec3& colour, double t_mm, RaySegment& to) {
  for (std::size_t n = 0; n < 3; ++n) to.colour[n] = static_cast<float>(colour[static_cast<int>(n)]);
  to.depth_mm = static_cast<float>(t_mm);
  to.covered = to.hasDepth = true;
}

Error cancelled() { return makeError(ErrorCode::Cancelled, "Drawing the shells was cancelled."); }

// What one tile gathers. Reused from tile to tile by one thread.
struct Gathered {
  // Of the pixel's ray: crossings count between these depths.
  std::vector<double> from = std::vector<double>(kTilePixels), to = std::vector<double>(kTilePixels);
  std::vector<double> value = std::vector<double>(kTilePixels);  // Max: the brightest; Sum: the sum
  std::vector<double> depth = std::vector<double>(kTilePixels);  // of what is shown; +inf: nothing yet
  std::vector<double> nearest = std::vector<double>(kTilePixels, kInfinity);  // Max: of the shell under work
  // Lit: what is shown. Sum: of the last crossing, and how many there are.
  std::vector<std::uint32_t> shell = std::vector<std::uint32_t>(kTilePixels),
                             triangle = std::vector<std::uint32_t>(kTilePixels);
  std::vector<std::uint16_t> touched;
  std::vector<std::array<ShellRay::Cap, 2>> caps;  // only where something is cut
  // Of a picture with lenses, when parts are gathered: the segment of each pixel, none below 0. Over all
  // parts of a sum: how many crossings, and their distances together.
  bool parts = false;
  std::vector<std::int64_t> segment = std::vector<std::int64_t>(kTilePixels);
  std::vector<double> crossings = std::vector<double>(kTilePixels),
                      distance = std::vector<double>(kTilePixels);
};

class Drawing {
 public:
  Drawing(const ShellsJob& job, const PreparedShells& shells, const SurfaceHits* tools, Images& images)
      : job_(job),
        shells_(shells),
        tools_(tools && (tools->counters.triangles > 0) ? tools : nullptr),
        images_(images),
        rays_(images.rays.get()),
        cut_(isCut(job)),
        translucent_(tools_ && !tools_->layers.empty()),
        bounded_(cut_ || tools_ != nullptr || rays_ != nullptr),
        base_(job.beta0 + job.betaM * job.b),
        slope_(job.betaM * job.a),
        empty_(shellColour(job, {}, {})) {}

  void tile(int number, Gathered& g) const {
    if (!rays_ || job_.rays.drawsPlainRays()) {
      begin(number, g);
      gather(number, g);
      compose(number, g);
    }
    for (int round = 0; rays_ && beginParts(number, round, g); ++round) {
      gather(number, g);
      composeParts(number, round, g);
    }
  }

 private:
  void gather(int number, Gathered& g) const {
    switch (job_.mode) {
      case ShellsMode::Max:
        gatherMax(number, g);
        break;
      case ShellsMode::Sum:
        gatherSum(number, g);
        break;
      case ShellsMode::Lit:
        gatherLit(number, g);
        break;
    }
  }
  static std::size_t at(const TileRect& r, int x, int y) {
    return static_cast<std::size_t>(x - r.x0 + kShellTile * (y - r.y0));
  }
  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(job_.camera.width_px) * static_cast<std::size_t>(y);
  }
  ToolsOnRay toolsOf(int x, int y) const { return tools_ ? toolsAt(*tools_, pixel(x, y)) : ToolsOnRay{}; }
  double perDepth(int x, int y) const { return job_.camera.rayPerDepth(x + 0.5, y + 0.5); }

  void clear(Gathered& g) const {
    std::fill(g.value.begin(), g.value.end(), job_.mode == ShellsMode::Max ? -1.0 : 0.0);
    std::fill(g.depth.begin(), g.depth.end(), kInfinity);
    std::fill(g.shell.begin(), g.shell.end(), kNoShell);
    std::fill(g.triangle.begin(), g.triangle.end(), 0u);
    g.caps.clear();
  }
  void begin(int number, Gathered& g) const {
    clear(g);
    g.parts = false;
    if (!bounded_) return;
    const TileRect r = shells_.rect(number);
    if (cut_) g.caps.assign(kTilePixels, {});
    for (int y = r.y0; y <= r.y1; ++y)
      for (int x = r.x0; x <= r.x1; ++x) {
        const std::size_t i = at(r, x, y);
        g.from[i] = -kInfinity, g.to[i] = kInfinity;
        if (meetsLens(x, y)) {
          std::swap(g.from[i], g.to[i]);  // nothing counts
          continue;
        }
        const double scale = 1 / perDepth(x, y);
        if (cut_) {
          const ShellRay ray = shellRay(job_, x + 0.5, y + 0.5);
          g.from[i] = ray.from_mm * scale, g.to[i] = ray.to_mm * scale;
          g.caps[i] = ray.caps;
        }
        // The tool in front of a shell at the same place.
        if (tools_) g.to[i] = std::min(g.to[i], std::nextafter(toolsOf(x, y).end_mm * scale, 0.0));
      }
  }
  bool meetsLens(int x, int y) const { return rays_ && rays_->meetsLens(pixel(x, y)); }
  bool beginParts(int number, int round, Gathered&) const;
  bool counts(const Gathered& g, std::size_t i, double depth) const {
    return !bounded_ || (depth >= g.from[i] && depth <= g.to[i]);
  }
  // visit(i, x, y, cap, depth, which) for the caps of the tile's rays that count.
  template <class Visit>
  void eachCap(const TileRect& r, const Gathered& g, Visit&& visit) const {
    if (g.caps.empty()) return;
    for (int y = r.y0; y <= r.y1; ++y)
      for (int x = r.x0; x <= r.x1; ++x) {
        const std::size_t i = at(r, x, y);
        const double scale = 1 / perDepth(x, y);
        for (std::uint32_t which = 0; which < 2; ++which) {
          const ShellRay::Cap& cap = g.caps[i][which];
          if (cap.shell >= 0 && cap.t_mm * scale <= g.to[i]) visit(i, x, y, cap, cap.t_mm * scale, which);
        }
      }
  }
  double z(double depth) const {
    return job_.ramp.at(std::clamp(depth, job_.ramp.near_mm, job_.ramp.far_mm));
  }
  double bright(double phi, double depth) const {
    return slope_ == 0 ? phi * base_ : phi * (base_ + slope_ * z(depth));
  }

  void gatherMax(int number, Gathered& g) const;
  void endShell(const TileRect&, double phi, Gathered&) const;
  void offer(Gathered& g, std::size_t i, double value, double depth) const {
    if (!(value > g.value[i])) return;
    g.value[i] = value, g.depth[i] = depth;
  }
  // Parts are dimmed as a whole.
  double throughAt(const Gathered& g, int x, int y, double depth) const {
    return translucent_ && !g.parts ? toolsOf(x, y).through(depth * perDepth(x, y)) : 1.0;
  }
  void gatherSum(int number, Gathered& g) const;
  void gatherLit(int number, Gathered& g) const;
  void compose(int number, const Gathered& g) const;
  void composeParts(int number, int round, Gathered& g) const;
  void addPart(Gathered& g, std::size_t i, const ShellPixel&, RaySegment& own, RaySegment& first) const;
  ShellPixel pixelOf(const Gathered& g, std::size_t i, int x, int y) const;

  const ShellsJob& job_;
  const PreparedShells& shells_;
  const SurfaceHits* const tools_;
  Images& images_;
  RayIntervals* const rays_;  // null: there are no lenses
  const bool cut_, translucent_, bounded_;
  const double base_, slope_;
  const glm::dvec3 empty_;  // of a ray that meets nothing
};

// A shell is done when the next one begins: its nearest crossing is its brightest point on the ray.
void Drawing::endShell(const TileRect& r, double phi, Gathered& g) const {
  for (const std::uint16_t i : g.touched) {
    const double depth = std::exchange(g.nearest[i], kInfinity);
    const int x = r.x0 + i % kShellTile, y = r.y0 + i / kShellTile;
    offer(g, i, bright(phi, depth) * throughAt(g, x, y, depth), depth);
  }
  g.touched.clear();
}

// Brighter shells come first: where a shell at its brightest cannot win any more, it is not looked at.
void Drawing::gatherMax(int number, Gathered& g) const {
  const TileRect r = shells_.rect(number);
  std::uint32_t under = kNoShell;
  double most = 0;
  for (const std::uint32_t n : shells_.runsOf(number)) {
    const PreparedShells::Run& run = shells_.run(n);
    if (run.shell != under) {
      if (under != kNoShell) endShell(r, job_.shells[under].phi, g);
      under = run.shell;
      most = job_.shells[under].phi * (base_ + slope_);
    }
    shells_.rasterise(run, r, [&](int x, int y, double depth, std::uint32_t) {
      const std::size_t i = at(r, x, y);
      if (most <= g.value[i] || !(depth < g.nearest[i]) || !counts(g, i, depth)) return;
      if (g.nearest[i] == kInfinity) g.touched.push_back(static_cast<std::uint16_t>(i));
      g.nearest[i] = depth;
    });
  }
  if (under != kNoShell) endShell(r, job_.shells[under].phi, g);
  eachCap(r, g, [&](std::size_t i, int x, int y, const ShellRay::Cap& cap, double depth, std::uint32_t) {
    const double phi = job_.shells[static_cast<std::size_t>(cap.shell)].phi;
    offer(g, i, bright(phi, depth) * throughAt(g, x, y, depth), depth);
  });
}

void Drawing::gatherSum(int number, Gathered& g) const {
  const TileRect r = shells_.rect(number);
  for (const std::uint32_t n : shells_.runsOf(number)) {
    const PreparedShells::Run& run = shells_.run(n);
    const double phi = job_.shells[run.shell].phi;
    shells_.rasterise(run, r, [&](int x, int y, double depth, std::uint32_t) {
      const std::size_t i = at(r, x, y);
      if (!counts(g, i, depth)) return;
      g.value[i] += bright(phi, depth) * throughAt(g, x, y, depth);
      g.depth[i] = (g.shell[i] == kNoShell ? 0 : g.depth[i]) + depth, ++g.triangle[i];
      g.shell[i] = run.shell;
    });
  }
  eachCap(r, g, [&](std::size_t i, int x, int y, const ShellRay::Cap& cap, double depth, std::uint32_t) {
    double phi = 0;
    for (int n = 0; n <= cap.shell; ++n) phi += job_.shells[static_cast<std::size_t>(n)].phi;
    g.value[i] += bright(phi, depth) * throughAt(g, x, y, depth);
    const std::uint32_t crossings = static_cast<std::uint32_t>(cap.shell) + 1;
    g.depth[i] = (g.shell[i] == kNoShell ? 0 : g.depth[i]) + crossings * depth;
    g.triangle[i] += crossings;
    g.shell[i] = kCapShell;
  });
}

void Drawing::gatherLit(int number, Gathered& g) const {
  const TileRect r = shells_.rect(number);
  for (const std::uint32_t n : shells_.runsOf(number)) {
    const PreparedShells::Run& run = shells_.run(n);
    shells_.rasterise(run, r, [&](int x, int y, double depth, std::uint32_t triangle) {
      const std::size_t i = at(r, x, y);
      if (!(depth < g.depth[i]) || !counts(g, i, depth)) return;
      g.depth[i] = depth, g.shell[i] = run.shell, g.triangle[i] = triangle;
    });
  }
  eachCap(r, g, [&](std::size_t i, int, int, const ShellRay::Cap&, double depth, std::uint32_t which) {
    if (depth < g.depth[i]) g.depth[i] = depth, g.shell[i] = kCapShell, g.triangle[i] = which;
  });
}

ShellPixel Drawing::pixelOf(const Gathered& g, std::size_t i, int x, int y) const {
  ShellPixel pixel;
  pixel.hit = job_.mode == ShellsMode::Max ? g.depth[i] < kInfinity : g.shell[i] != kNoShell;
  if (!pixel.hit) return pixel;
  const double mean = job_.mode == ShellsMode::Sum ? 1.0 / std::max(1u, g.triangle[i]) : 1.0;
  pixel.value = g.value[i];
  pixel.t_mm = mean * g.depth[i] * perDepth(x, y);
  if (job_.mode != ShellsMode::Lit) return pixel;
  const auto share = [](double cosine) { return std::min(1.0, kAmbient + kDiffuse * cosine); };
  if (g.shell[i] == kCapShell)
    pixel.value = share(g.caps[i][g.triangle[i]].cosine);
  else
    pixel.value = litShare(job_, g.shell[i], x + 0.5, y + 0.5, pixel.t_mm,
                           share(shells_.cosine(g.shell[i], g.triangle[i], x + 0.5, y + 0.5)));
  return pixel;
}

void Drawing::compose(int number, const Gathered& g) const {
  const TileRect r = shells_.rect(number);
  for (int y = r.y0; y <= r.y1; ++y)
    for (int x = r.x0; x <= r.x1; ++x) {
      const std::size_t i = at(r, x, y), p = pixel(x, y);
      if (meetsLens(x, y)) continue;
      const ToolsOnRay tools = toolsOf(x, y);
      const ShellPixel shown = pixelOf(g, i, x, y);
      const glm::dvec3 colour = shown.hit || tools_ ? shellColour(job_, shown, tools) : empty_;
      for (int c = 0; c < 3; ++c)
        images_.colour[4 * p + static_cast<std::size_t>(c)] = static_cast<float>(colour[c]);
      images_.colour[4 * p + 3] = 1;
      images_.depth[p] = static_cast<float>(shownAt_mm(job_, shown, tools));
    }
}

// The round-th part of each pixel; false when none has one.
bool Drawing::beginParts(int number, int round, Gathered& g) const {
  clear(g);
  g.parts = true;
  g.caps.assign(kTilePixels, {});
  const TileRect r = shells_.rect(number);
  bool any = false;
  for (int y = r.y0; y <= r.y1; ++y)
    for (int x = r.x0; x <= r.x1; ++x) {
      const std::size_t i = at(r, x, y), p = pixel(x, y);
      g.from[i] = kInfinity, g.to[i] = -kInfinity, g.segment[i] = -1;
      int n = 0;
      eachSegment(*rays_, p, job_.rays, [&](std::size_t index) {
        if (n++ == round) g.segment[i] = static_cast<std::int64_t>(index);
      });
      if (g.segment[i] < 0) continue;
      any = true;
      const auto index = static_cast<std::size_t>(g.segment[i]);
      const RaySegment& s = rays_->segments[index];
      if (!(s.to_mm > s.from_mm)) continue;
      if (job_.mode == ShellsMode::Lit && !(rays_->lightBefore(p, index) > 0)) continue;
      const ShellRay ray = shellRay(job_, x + 0.5, y + 0.5, rays_->of(p), index - rays_->first[p]);
      const double scale = 1 / perDepth(x, y);
      g.from[i] = ray.from_mm * scale;
      // A crossing at the cut itself belongs to the part behind it.
      g.to[i] = s.endsInside ? std::nextafter(ray.to_mm * scale, 0.0) : ray.to_mm * scale;
      g.caps[i] = ray.caps;
      if (s.endsInside) g.caps[i][1].t_mm = g.to[i] * perDepth(x, y) * (1 - 1e-15);
    }
  return any;
}

void Drawing::addPart(Gathered& g, std::size_t i, const ShellPixel& shown, RaySegment& own,
                      RaySegment& first) const {
  if (!shown.hit) return;
  if (job_.mode == ShellsMode::Lit) {
    own.through = 0;
    return putPart(job_.colour * shown.value, shown.t_mm, own);
  }
  const glm::dvec3 colour = job_.colour * (static_cast<double>(own.weight) * shown.value);
  const glm::dvec3 before{first.colour[0], first.colour[1], first.colour[2]};
  if (job_.mode == ShellsMode::Max) {
    if (!first.covered || glm::any(glm::greaterThan(colour, before))) putPart(colour, shown.t_mm, first);
    return;
  }
  const double crossings = std::max(1u, g.triangle[i]);
  g.crossings[i] += crossings, g.distance[i] += crossings * shown.t_mm;
  putPart(first.covered ? before + colour : colour, g.distance[i] / g.crossings[i], first);
}

void Drawing::composeParts(int number, int round, Gathered& g) const {
  const TileRect r = shells_.rect(number);
  for (int y = r.y0; y <= r.y1; ++y)
    for (int x = r.x0; x <= r.x1; ++x) {
      const std::size_t i = at(r, x, y), p = pixel(x, y);
      if (g.segment[i] < 0) continue;
      RaySegment& own = rays_->segments[static_cast<std::size_t>(g.segment[i])];
      RaySegment* first = nullptr;
      eachSegment(*rays_, p, job_.rays, [&](std::size_t n) { first = first ? first : &rays_->segments[n]; });
      if (round == 0) {
        first->covered = first->hasDepth = false;
        g.crossings[i] = g.distance[i] = 0;
      }
      addPart(g, i, pixelOf(g, i, x, y), own, *first);
    }
}

}  // namespace

Result<void> drawShells(const ShellsJob& job, Images& images, std::stop_token stop) {
  const TraceSpan span("shells");
  images.width = job.camera.width_px, images.height = job.camera.height_px;
  const std::size_t n = static_cast<std::size_t>(images.width) * static_cast<std::size_t>(images.height);
  images.colour.resize(4 * n);
  images.depth.resize(n);
  images.values.clear();
  if (images.rays && images.rays->first.size() != n + 1)
    return makeError(ErrorCode::Internal, "The rays are cut for a picture of another size.", "drawShells");
  std::optional<SurfaceHits> tools;
  if (!job.tools.empty() && (!images.rays || job.rays.drawsPlainRays())) {
    Result<SurfaceHits> found = findSurfaces({job.tools, job.camera, glm::dvec3(0)}, stop);
    if (!found) return found.error();
    tools = std::move(*found);
    if (tools->pixelsBeyond > 0)
      log(LogLevel::Info, "shells",
          std::to_string(tools->pixelsBeyond) + " pixels have more than " + std::to_string(kSurfaceLayers) +
              " translucent layers of tools; those behind are joined, up to " +
              std::to_string(tools->largestResidual) + " of the light");
    images.counters.triangles += tools->counters.triangles;
  }
  // The nearest crossing of a closed surface from outside is a front face.
  const PreparedShells shells(job, job.mode != ShellsMode::Sum && !isCut(job) && !images.rays, stop);
  if (stop.stop_requested()) return cancelled();
  images.counters.triangles += shells.triangles();
  const Drawing drawing(job, shells, tools ? &*tools : nullptr, images);
  parallelFor(static_cast<std::size_t>(shells.tiles()), 1, [&](std::size_t begin, std::size_t end) {
    Gathered gathered;
    for (std::size_t tile = begin; tile < end && !stop.stop_requested(); ++tile)
      drawing.tile(static_cast<int>(tile), gathered);
  });
  if (stop.stop_requested()) return cancelled();
  return {};
}

}  // namespace vernier::native
