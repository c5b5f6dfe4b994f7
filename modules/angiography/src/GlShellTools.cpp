// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "GlShellDrawing.h"

namespace vernier::angiography {

// Opaque tools: their own picture first. Otherwise all that rays meet of them, as images.
Result<void> GlDrawing::drawTools() {
  if (!byDepth()) return findTools();
  const glm::dmat4 pixelFromPatient = job_.camera.pixelFromPatient();
  for (const PlacedSurface& p : job_.tools) {
    if (!(p.opacity > 0)) continue;
    auto made = buffers(*p.mesh, p.pose, true);
    if (!made) return made.error();
    tools_.push_back({&p, *made, seenOf(*p.mesh, pixelFromPatient * p.pose.matrix())});
  }
  if (tools_.empty()) return {};
  const std::string byDistance = perspective_ && !job_.ramp.afterProjection
                                     ? "#define Z_STAR\n#define BY_DISTANCE\n"
                                     : "#define Z_STAR\n";
  auto colours = program("tool", "#define Z_STAR\n", "tool.frag.glsl");
  if (!colours) return colours.error();
  auto depths = program("shell", byDistance, "shell.frag.glsl");
  if (!depths) return depths.error();
  toolDepth_ = *depths;
  const std::array formats{gpu::Format::Rgba32F};
  Result<gpu::Target> target = device_.target(width_, height_, formats, true);
  if (!target) return target.error();
  if (Result<void> r = device_.clear(*target, 0, {0, 0, 0, 0}); !r) return r;
  if (Result<void> r = device_.clearDepth(*target, 0); !r) return r;
  const glm::vec2 zStar = zStarOfTools();
  std::vector<gpu::Draw> draws;
  for (const Tool& tool : tools_) {
    gpu::Draw d;
    d.program = colours->get();
    d.vertices = tool.vertices.get();
    d.count = d.vertices->count();
    d.state.depth = gpu::DepthTest::GreaterEqual,
    d.state.depthWrite = true;  // the later one of two in a place
    d.state.clipDistances = 1, d.state.depthClamp = true;
    d.uniforms = uniforms(false);
    d.uniforms.push_back({"zStar", zStar});
    d.uniforms.push_back({"colour", glm::vec3(tool.placed->colour)});
    draws.push_back(std::move(d));
  }
  if (Result<void> r = device_.draw(*target, draws); !r) return r;
  toolsSeen_.resize(4 * pixels());
  return device_.read(*target, 0, toolsSeen_);
}

// All of the depth that tools take, also before and behind the volume: held at its ends, a tool's far side
// would be as near as its near one.
glm::vec2 GlDrawing::zStarOfTools() const {
  double nearest = kInfinity, farthest = -kInfinity;
  for (const Tool& tool : tools_) {
    const glm::dvec3 low = tool.placed->mesh->lowest().p, high = tool.placed->mesh->highest().p;
    for (int n = 0; n < 8; ++n) {
      const MeshPoint corner(n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z);
      const double depth = dot(tool.placed->pose * corner - job_.camera.eye, job_.camera.forward);
      nearest = std::min(nearest, depth), farthest = std::max(farthest, depth);
    }
  }
  nearest = std::max({nearest, job_.camera.near_mm, 0.0});
  farthest = std::max(farthest, nearest) + 1;
  if (perspective_) nearest = std::max(nearest, 1e-4 * farthest);
  const glm::dvec2 ramp = rampOfDepth();
  const auto z = [&](double depth) { return ramp.x + ramp.y * (perspective_ ? 1 / depth : depth); };
  const double slope = 0.999 / (z(nearest) - z(farthest));
  return {5e-4 - slope * z(farthest), slope};
}

Result<void> GlDrawing::findTools() {
  if (job_.tools.empty()) return {};
  Result<native::SurfaceHits> found = native::findSurfaces({job_.tools, job_.camera, glm::dvec3(0)}, stop_);
  if (!found) return found.error();
  if (found->counters.triangles == 0) return {};
  hits_ = std::move(*found);
  constexpr std::size_t kPairs = (native::kSurfaceLayers + 2) / 2;
  constexpr float kBehindAll = 1e30f;
  std::vector<float> end(pixels(), kBehindAll);
  std::array<std::vector<float>, kPairs> layers;
  for (auto& l : layers) {
    l.resize(4 * pixels());
    for (std::size_t n = 0; n < l.size(); n += 2) l[n] = kBehindAll, l[n + 1] = 0;
  }
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t p = at(x, y);
      const native::ToolsOnRay ray = native::toolsAt(*hits_, p);
      const double scale = 1 / perDepth(x, y);
      if (ray.ends()) end[p] = static_cast<float>(ray.end_mm * scale);
      for (std::size_t n = 0; n < ray.layers.size(); ++n) {
        float* const at = layers[n / 2].data() + 4 * p + 2 * (n % 2);
        at[0] = static_cast<float>(ray.layers[n].t_mm * scale), at[1] = ray.layers[n].alpha;
      }
    }
  Result<gpu::Texture> made = picture(end, gpu::Format::R32F);
  if (!made) return made.error();
  toolTextures_.push_back(std::move(*made));
  for (const auto& l : layers) {
    made = picture(l, gpu::Format::Rgba32F);
    if (!made) return made.error();
    toolTextures_.push_back(std::move(*made));
  }
  return {};
}

// The tools' depth under the shell's rule.
void GlDrawing::addToolDepth(std::vector<gpu::Draw>& draws, std::size_t shell) {
  const Seen seen = seenOf(*job_.shells[shell].mesh, job_.camera.pixelFromPatient());
  for (const Tool& tool : tools_) {
    if (!tool.seen.overlaps(seen)) continue;
    gpu::Draw d;
    d.program = toolDepth_.get();
    d.vertices = tool.vertices.get();
    d.count = d.vertices->count();
    d.state.depth = gpu::DepthTest::Greater, d.state.depthWrite = true;
    d.state.colourMask = {false, false, false, false};
    d.state.clipDistances = 1, d.state.depthClamp = true;
    d.uniforms = uniforms(false);
    d.uniforms.push_back({"zStar", zStarOf(shell)});
    d.uniforms.push_back({"phi", 0.0f});
    draws.push_back(std::move(d));
  }
}

native::ToolsOnRay GlDrawing::toolsOn(std::size_t pixel) const {
  if (hits_) return native::toolsAt(*hits_, pixel);
  native::ToolsOnRay out;
  if (toolsSeen_.empty() || !(toolsSeen_[4 * pixel + 3] > 0)) return out;
  const auto x = static_cast<int>(pixel % static_cast<std::size_t>(width_)),
             y = static_cast<int>(pixel / static_cast<std::size_t>(width_));
  for (std::size_t c = 0; c < 3; ++c)
    out.endColour[static_cast<int>(c)] = static_cast<double>(toolsSeen_[4 * pixel + c]);
  out.end_mm = static_cast<double>(toolsSeen_[4 * pixel + 3]) * perDepth(x, y);
  return out;
}

}  // namespace vernier::angiography
