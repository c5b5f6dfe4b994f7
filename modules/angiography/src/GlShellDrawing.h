// SPDX-License-Identifier: GPL-3.0-or-later
// One picture of shells on OpenGL: GlShells.cpp draws the shells, GlShellTools.cpp the tools among them,
// GlShellCaps.cpp what is cut open, and makes the picture of all.
#pragma once
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "GlShells.h"

namespace vernier::angiography {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Pixels in which something may be seen.
struct Seen {
  double x0 = kInfinity, y0 = kInfinity, x1 = -kInfinity, y1 = -kInfinity;
  bool overlaps(const Seen& o) const { return x0 <= o.x1 && o.x0 <= x1 && y0 <= o.y1 && o.y0 <= y1; }
  void take(const glm::dmat4& pixelFrom, glm::dvec3 p) {
    const glm::dvec4 q = pixelFrom * glm::dvec4(p, 1);
    if (!(q.w > 0)) {  // beside or behind the eye: anywhere
      x0 = y0 = -kInfinity, x1 = y1 = kInfinity;
      return;
    }
    x0 = std::min(x0, q.x / q.w), x1 = std::max(x1, q.x / q.w);
    y0 = std::min(y0, q.y / q.w), y1 = std::max(y1, q.y / q.w);
  }
};

Seen seenOf(const Mesh&, const glm::dmat4& pixelFromMesh);

std::string_view shaderText(std::string_view fileName);  // the files of shaders/
std::string shaderOf(const std::string& defines, std::initializer_list<std::string_view> files);
Error shellsCancelled();

class GlDrawing {
 public:
  GlDrawing(gpu::Device& device, const native::ShellsJob& job, const GlShellsOptions& options,
            std::stop_token stop)
      : device_(device),
        job_(job),
        options_(options),
        stop_(std::move(stop)),
        middle_(job.volume->grid().centre().p),
        width_(job.camera.width_px),
        height_(job.camera.height_px),
        perspective_(job.camera.projection == Projection::Perspective),
        cut_(native::isCut(job)),
        empty_(native::shellColour(job, {}, {})) {}

  Result<void> run(Images& images) {
    if (Result<void> r = prepare(); !r) return r;
    if (Result<void> r = drawTools(); !r) return r;
    if (Result<void> r = drawShells(); !r) return r;
    if (cut_)
      if (Result<void> r = drawCaps(); !r) return r;
    if (max() && !byDepth())
      if (Result<void> r = drawWinners(); !r) return r;
    return compose(images);
  }

 private:
  bool byDepth() const { return options_.maximum == Maximum::DepthBuffer; }
  bool max() const { return job_.mode == ShellsMode::Max; }
  bool opaqueTools() const { return byDepth() && !tools_.empty(); }
  // The depth buffer decides: of the maximum by z*, of the nearest with Lit, of what tools hide.
  bool needsDepth() const { return (max() && byDepth()) || job_.mode == ShellsMode::Lit || opaqueTools(); }

  Result<void> prepare();
  Result<void> findTools();
  Result<void> drawTools();
  Result<void> drawShells();
  Result<void> drawWinners();
  Result<void> drawCaps();
  Result<void> compose(Images&);
  void composePixel(int x, int y, const std::vector<float>& seen, const std::vector<float>& winners,
                    Images&) const;
  void addShell(std::vector<gpu::Draw>&, const gpu::Program&, std::size_t shell);
  void addToolDepth(std::vector<gpu::Draw>&, std::size_t shell);
  Result<std::shared_ptr<const gpu::VertexData>> buffers(const Mesh&, const PatientFromMesh&, bool posed);
  Result<std::shared_ptr<const gpu::Program>> program(const std::string& name, const std::string& defines,
                                                      const char* fragment);
  Result<gpu::Texture> picture(const std::vector<float>& texels, gpu::Format format) {
    return device_.texture2d(format, width_, height_, std::as_bytes(std::span(texels)));
  }
  std::string defines() const;
  std::vector<gpu::Uniform> uniforms(bool withCuts) const;
  glm::dvec2 rampOfDepth() const;  // z' = x + y times depth, in perspective times 1 / depth
  glm::vec2 zStarOf(std::size_t shell) const;
  glm::vec2 zStarOfTools() const;
  std::vector<float> capTexels(std::size_t which) const;
  double depthOf(std::size_t pixel, const std::vector<float>& seen, const std::vector<float>& winners) const;
  native::ToolsOnRay toolsOn(std::size_t pixel) const;
  double perDepth(int x, int y) const { return job_.camera.rayPerDepth(x + 0.5, y + 0.5); }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
  }
  std::size_t pixels() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }

  struct Tool {
    const PlacedSurface* placed;
    std::shared_ptr<const gpu::VertexData> vertices;
    Seen seen;
  };
  gpu::Device& device_;
  const native::ShellsJob& job_;
  const GlShellsOptions options_;
  const std::stop_token stop_;
  const glm::dvec3 middle_;
  const int width_, height_;
  const bool perspective_, cut_;
  const glm::dvec3 empty_;                                      // of a ray that meets nothing
  std::vector<std::shared_ptr<const gpu::VertexData>> shells_;  // nullptr: empty
  std::vector<Tool> tools_;
  std::optional<gpu::Target> target_, winners_;
  std::shared_ptr<const gpu::Program> toolDepth_;
  std::array<std::vector<float>, 2> caps_;  // value, depth, z*, weight
  std::vector<float> toolsSeen_;            // colour and depth of the nearest tool, depth 0: none
  std::optional<native::SurfaceHits> hits_;
  std::vector<gpu::Texture> toolTextures_;
};

}  // namespace vernier::angiography
