// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "GlShellDrawing.h"
#include "vernier/base/Threads.h"

namespace vernier::angiography {

std::vector<float> GlDrawing::capTexels(std::size_t which) const {
  std::vector<float> texels(4 * pixels(), 0.0f);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t p = at(x, y);
      const native::ShellRay::Cap cap = native::shellRay(job_, x + 0.5, y + 0.5).caps[which];
      const native::ToolsOnRay tools = toolsOn(p);
      if (cap.shell < 0 || !(cap.t_mm < tools.end_mm)) continue;
      const double depth = cap.t_mm / perDepth(x, y), through = tools.through(cap.t_mm);
      const auto shell = static_cast<std::size_t>(cap.shell);
      const bool sum = job_.mode == ShellsMode::Sum;
      double phi = 0;
      for (std::size_t s = sum ? 0 : shell; s <= shell; ++s) phi += job_.shells[s].phi;
      const double value = job_.mode == ShellsMode::Lit
                               ? std::min(1.0, native::kAmbient + native::kDiffuse * cap.cosine)
                               : through * job_.brightness(phi, depth);
      const double z = job_.ramp.at(std::clamp(depth, job_.ramp.near_mm, job_.ramp.far_mm));
      const double crossings = sum ? static_cast<double>(cap.shell) + 1 : 1;
      const glm::vec2 zStar = zStarOf(shell);
      const double texel[] = {value, depth * crossings,
                              static_cast<double>(zStar.x) + static_cast<double>(zStar.y) * z, crossings};
      for (std::size_t c = 0; c < 4; ++c) texels[4 * p + c] = static_cast<float>(texel[c]);
    }
  return texels;
}

Result<void> GlDrawing::drawCaps() {
  const bool tested = needsDepth();
  const auto capProgram = [&](const std::string& defines) {
    return device_.program("shells cap" + defines, shaderOf("", {"cap.vert.glsl"}),
                           shaderOf(defines, {"cap.frag.glsl"}));
  };
  auto made = capProgram(tested ? "#define Z_STAR\n" : "");
  if (!made) return made.error();
  const std::array whole{-1.0f, -1.0f, 3.0f, -1.0f, -1.0f, 3.0f};
  const std::array components{2};
  Result<gpu::VertexData> vertices = device_.vertices(whole, components);
  if (!vertices) return vertices.error();
  for (std::size_t which = 0; which < 2; ++which) {
    if (stop_.stop_requested()) return shellsCancelled();
    caps_[which] = capTexels(which);
    Result<gpu::Texture> caps = picture(caps_[which], gpu::Format::Rgba32F);
    if (!caps) return caps.error();
    gpu::Draw d;
    d.program = made->get();
    d.vertices = &*vertices;
    d.count = 3;
    d.textures = {{"caps", &*caps}};
    if (job_.mode == ShellsMode::Sum) d.state.blend = gpu::Blend::Add;
    if (max() && !byDepth()) d.state.blend = gpu::Blend::Max;
    // What a tool hides is left out already.
    if (tested && job_.mode != ShellsMode::Sum)
      d.state.depth = gpu::DepthTest::Greater, d.state.depthWrite = true;
    if (Result<void> r = device_.draw(*target_, {&d, 1}); !r) return r;
  }
  return {};
}

double GlDrawing::depthOf(std::size_t pixel, const std::vector<float>& seen,
                          const std::vector<float>& winners) const {
  const auto texel = [&](const std::vector<float>& texels, std::size_t c) {
    return static_cast<double>(texels[4 * pixel + c]);
  };
  if (!winners_) return texel(seen, 1) / std::max(1.0, texel(seen, 3));
  if (texel(winners, 3) > 0) return -texel(winners, 0);
  for (const auto& cap : caps_)
    if (!cap.empty() && texel(cap, 3) > 0 && texel(cap, 0) >= texel(seen, 0)) return texel(cap, 1);
  return texel(seen, 1);
}

namespace {

void put(Images& images, std::size_t pixel, const glm::dvec3& colour, double depth_mm) {
  for (int c = 0; c < 3; ++c)
    images.colour[4 * pixel + static_cast<std::size_t>(c)] = static_cast<float>(colour[c]);
  images.colour[4 * pixel + 3] = 1;
  images.depth[pixel] = static_cast<float>(depth_mm);
}

}  // namespace

void GlDrawing::composePixel(int x, int y, const std::vector<float>& seen, const std::vector<float>& winners,
                             Images& images) const {
  const std::size_t p = at(x, y);
  native::ShellPixel pixel;
  pixel.hit = seen[4 * p + 3] > 0;
  if (!pixel.hit && tools_.empty() && !hits_) return put(images, p, empty_, kInfinity);
  pixel.value = static_cast<double>(seen[4 * p]);
  pixel.t_mm = depthOf(p, seen, winners) * perDepth(x, y);
  // Lit: which shell it is, from 1; caps have 0 and their own light.
  if (const float shell = seen[4 * p + 2]; pixel.hit && job_.mode == ShellsMode::Lit && shell > 0)
    pixel.value = native::litShare(job_, static_cast<std::size_t>(shell) - 1, x + 0.5, y + 0.5, pixel.t_mm,
                                   pixel.value);
  const native::ToolsOnRay tools = toolsOn(p);
  put(images, p, native::shellColour(job_, pixel, tools), native::shownAt_mm(job_, pixel, tools));
}

Result<void> GlDrawing::compose(Images& images) {
  images.width = width_, images.height = height_;
  images.colour.resize(4 * pixels());
  images.depth.resize(pixels());
  images.values.clear();
  std::vector<float> seen(4 * pixels()), winners;
  if (Result<void> r = device_.read(*target_, 0, seen); !r) return r;
  if (winners_) {
    winners.resize(4 * pixels());
    if (Result<void> r = device_.read(*winners_, 0, winners); !r) return r;
  }
  parallelFor(static_cast<std::size_t>(height_), 8, [&](std::size_t begin, std::size_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width_; ++x) composePixel(x, y, seen, winners, images);
  });
  return {};
}

}  // namespace vernier::angiography
