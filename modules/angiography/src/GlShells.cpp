// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlShells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vernier::angiography {

std::string_view shaderText(std::string_view fileName);  // the files of shaders/

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Error cancelled() { return makeError(ErrorCode::Cancelled, "Drawing the shells was cancelled."); }

std::string shaderOf(const std::string& defines, std::initializer_list<std::string_view> files) {
  std::string text = "#version 330 core\n" + defines;
  for (const std::string_view file : files) text += shaderText(file);
  return text;
}

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

Seen seenOf(const Mesh& mesh, const glm::dmat4& pixelFromMesh) {
  Seen seen;
  const glm::dvec3 low = mesh.lowest().p, high = mesh.highest().p;
  for (int n = 0; n < 8; ++n)
    seen.take(pixelFromMesh, {n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z});
  return seen;
}

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
        cut_(native::isCut(job)) {}

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
  glm::vec2 zStarOf(std::size_t shell) const;
  std::vector<float> capTexels(std::size_t which) const;
  double depthOf(std::size_t pixel, const std::vector<float>& seen, const std::vector<float>& winners) const;
  native::ToolsOnRay toolsOn(std::size_t pixel) const;
  double perDepth(int x, int y) const { return job_.camera.rayPerDepth(x + 0.5, y + 0.5); }
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
  std::vector<std::shared_ptr<const gpu::VertexData>> shells_;  // nullptr: empty
  std::vector<Tool> tools_;
  std::optional<gpu::Target> target_, winners_;
  std::shared_ptr<const gpu::Program> toolDepth_;
  std::array<std::vector<float>, 2> caps_;  // value, depth, z*, weight
  std::vector<float> toolsSeen_;            // colour and depth of the nearest tool, depth 0: none
  std::optional<native::SurfaceHits> hits_;
  std::vector<gpu::Texture> toolTextures_;
};

Result<std::shared_ptr<const gpu::VertexData>> GlDrawing::buffers(const Mesh& mesh,
                                                                  const PatientFromMesh& pose, bool posed) {
  const auto make = [&]() -> Result<gpu::VertexData> {
    std::vector<float> xyz;
    xyz.reserve(3 * mesh.vertices().size());
    for (const MeshPoint& v : mesh.vertices()) {
      const glm::dvec3 p = (posed ? (pose * v).p : v.p) - middle_;
      for (int c = 0; c < 3; ++c) xyz.push_back(static_cast<float>(p[c]));
    }
    const std::array components{3};
    return device_.vertices(xyz, components, {mesh.triangles().front().data(), 3 * mesh.triangles().size()});
  };
  if (!posed) return device_.cache().vertices({"shell", mesh.revision(), 0}, make);
  Result<gpu::VertexData> made = make();
  if (!made) return made.error();
  return std::make_shared<const gpu::VertexData>(std::move(*made));
}

Result<std::shared_ptr<const gpu::Program>> GlDrawing::program(const std::string& name,
                                                               const std::string& defines,
                                                               const char* fragment) {
  return device_.program("shells " + name + defines, shaderOf(defines, {"shell.vert.glsl"}),
                         shaderOf(defines, {"brightness.glsl", fragment}));
}

Result<void> GlDrawing::prepare() {
  const std::array formats{gpu::Format::Rgba32F};
  Result<gpu::Target> target = device_.target(width_, height_, formats, true);
  if (!target) return target.error();
  target_ = std::move(*target);
  if (Result<void> r = device_.clear(*target_, 0, {0, 0, 0, 0}); !r) return r;
  if (Result<void> r = device_.clearDepth(*target_, 0); !r) return r;
  for (const native::Shell& s : job_.shells) {
    shells_.push_back(nullptr);
    if (!s.mesh) continue;
    if (stop_.stop_requested()) return cancelled();
    auto made = buffers(*s.mesh, {}, false);
    if (!made) return made.error();
    shells_.back() = *made;
  }
  return {};
}

std::vector<gpu::Uniform> GlDrawing::uniforms(bool withCuts) const {
  const CameraPicture& camera = job_.camera;
  // Pixels to clip; depth is kept as it is.
  glm::dmat4 clipFromPixel(1);
  clipFromPixel[0][0] = 2.0 / width_, clipFromPixel[1][1] = 2.0 / height_;
  clipFromPixel[3][0] = clipFromPixel[3][1] = -1;
  glm::dmat4 patientFromPlace(1);
  patientFromPlace[3] = glm::dvec4(middle_, 1);
  const glm::dmat4 clip = clipFromPixel * camera.pixelFromPatient() * patientFromPlace;

  glm::dvec4 planes[8];
  for (glm::dvec4& p : planes) p = {0, 0, 0, 1};
  const double near_mm = std::max(camera.near_mm, 0.0);
  const glm::dvec3 f = camera.forward.v;
  planes[0] = glm::dvec4(f, glm::dot(f, middle_ - camera.eye.p) - near_mm);
  if (withCuts) {
    const std::vector<HalfSpace> cuts = cuttingPlanes(job_);
    for (std::size_t n = 0; n < cuts.size(); ++n)
      planes[n + 1] = glm::dvec4(-cuts[n].normal.v, -cuts[n].distance_mm(PatientPoint(middle_)));
  }
  glm::mat4 cuts[2];
  for (int n = 0; n < 8; ++n) cuts[n / 4][n % 4] = glm::vec4(planes[n]);

  const double near = job_.ramp.near_mm, far = job_.ramp.far_mm, range = far - near;
  const bool projected = job_.ramp.afterProjection;
  const glm::dvec2 ramp = projected ? glm::dvec2(-near, near * far) / range : glm::dvec2(far, -1) / range;
  const glm::dvec3 eye = perspective_ ? camera.eye.p - middle_ : f;
  return {{"clipFromPlace", glm::mat4(clip)},
          {"cuts0", cuts[0]},
          {"cuts1", cuts[1]},
          {"perspective", perspective_ ? 1 : 0},
          {"ramp", glm::vec2(ramp)},
          {"projected", projected ? 1 : 0},
          {"rampEnds_mm", glm::vec2(near, far)},
          {"cue", glm::vec2(job_.beta0 + job_.betaM * job_.b, job_.betaM * job_.a)},
          {"eye_mm", glm::vec4(glm::vec3(eye), perspective_ ? 1.0f : 0.0f)}};
}

// Of the maximum by its shell; of what only has to be nearest the same for all.
glm::vec2 GlDrawing::zStarOf(std::size_t shell) const {
  constexpr double kShare = 0.999;
  if (!(max() && byDepth())) return {5e-4, kShare};
  const double n = static_cast<double>(job_.shells.size()) + 1, i = static_cast<double>(shell) + 1;
  const double b = job_.b + job_.beta0 / job_.betaM, most = job_.shells.back().phi * (job_.a + b);
  if (job_.a == 0 || !(most > 0)) return glm::vec2(i / n, kShare / n);
  const double phi = job_.shells[shell].phi;
  return glm::vec2(5e-4 + kShare * phi * b / most, kShare * phi * job_.a / most);
}

std::string GlDrawing::defines() const {
  std::string d;
  if (needsDepth()) d += "#define Z_STAR\n";
  if (needsDepth() && perspective_ && !job_.ramp.afterProjection) d += "#define BY_DISTANCE\n";
  if (job_.mode == ShellsMode::Lit) d += "#define LIT\n";
  if (options_.route == Route::Fog) d += "#define FOG\n";
  if (!byDepth() && hits_) d += "#define TOOLS\n";
  return d;
}

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
    d.uniforms.push_back({"zStar", glm::vec2(5e-4f, 0.999f)});
    d.uniforms.push_back({"colour", glm::vec3(tool.placed->colour)});
    draws.push_back(std::move(d));
  }
  if (Result<void> r = device_.draw(*target, draws); !r) return r;
  toolsSeen_.resize(4 * pixels());
  return device_.read(*target, 0, toolsSeen_);
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
      const std::size_t p =
          static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
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

void GlDrawing::addShell(std::vector<gpu::Draw>& draws, const gpu::Program& program, std::size_t shell) {
  gpu::Draw d;
  d.program = &program;
  d.vertices = shells_[shell].get();
  d.count = d.vertices->count();
  if (needsDepth()) d.state.depth = gpu::DepthTest::Greater;
  d.state.depthWrite = needsDepth() && job_.mode != ShellsMode::Sum;
  if (job_.mode == ShellsMode::Sum) d.state.blend = gpu::Blend::Add;
  if (max() && !byDepth()) d.state.blend = gpu::Blend::Max;
  if (job_.mode != ShellsMode::Sum && !cut_) d.state.cull = gpu::Cull::Back;
  d.state.clipDistances = cut_ ? 1 + static_cast<int>(cuttingPlanes(job_).size()) : 0;
  d.state.depthClamp = true;
  d.uniforms = uniforms(true);
  const double phi = job_.shells[shell].phi;
  d.uniforms.push_back({"zStar", zStarOf(shell)});
  d.uniforms.push_back({"phi", static_cast<float>(phi)});
  d.uniforms.push_back(
      {"fog", glm::vec2(phi * (job_.beta0 + job_.betaM * job_.b), phi * job_.betaM * job_.a)});
  static constexpr std::array kNames{"toolEnd_mm",  "toolLayers0", "toolLayers1",
                                     "toolLayers2", "toolLayers3", "toolLayers4"};
  for (std::size_t n = 0; n < toolTextures_.size(); ++n) d.textures.push_back({kNames[n], &toolTextures_[n]});
  draws.push_back(std::move(d));
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

Result<void> GlDrawing::drawShells() {
  auto made = program("shell", defines(), "shell.frag.glsl");
  if (!made) return made.error();
  const bool eachShell = max() && byDepth();
  bool toolsDrawn = false;
  for (std::size_t n = 0; n < job_.shells.size(); ++n) {
    if (!shells_[n]) continue;
    if (stop_.stop_requested()) return cancelled();
    std::vector<gpu::Draw> draws;
    if (opaqueTools() && (eachShell || !toolsDrawn)) addToolDepth(draws, n);
    toolsDrawn = true;  // the lowest shell holds all the others
    addShell(draws, **made, n);
    if (Result<void> r = device_.draw(*target_, draws); !r) return r;
    if (Result<void> r = device_.limits().software ? device_.finish() : Result<void>(); !r) return r;
  }
  return {};
}

// A maximum does not say where it is: a second time, only what reaches it.
Result<void> GlDrawing::drawWinners() {
  auto winner = program("shell", defines() + "#define WINNER\n", "shell.frag.glsl");
  if (!winner) return winner.error();
  const std::array formats{gpu::Format::Rgba32F};
  Result<gpu::Target> target = device_.target(width_, height_, formats);
  if (!target) return target.error();
  winners_ = std::move(*target);
  if (Result<void> r = device_.clear(*winners_, 0, {-3e38f, 0, 0, 0}); !r) return r;
  for (std::size_t n = 0; n < job_.shells.size(); ++n) {
    if (!shells_[n]) continue;
    if (stop_.stop_requested()) return cancelled();
    std::vector<gpu::Draw> draws;
    addShell(draws, **winner, n);
    draws[0].textures.push_back({"greatest", &target_->colour(0)});
    if (Result<void> r = device_.draw(*winners_, draws); !r) return r;
    if (Result<void> r = device_.limits().software ? device_.finish() : Result<void>(); !r) return r;
  }
  return {};
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

std::vector<float> GlDrawing::capTexels(std::size_t which) const {
  std::vector<float> texels(4 * pixels(), 0.0f);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t p =
          static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
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
    if (stop_.stop_requested()) return cancelled();
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
  const auto at = [&](const std::vector<float>& texels, std::size_t c) {
    return static_cast<double>(texels[4 * pixel + c]);
  };
  if (!winners_) return at(seen, 1) / std::max(1.0, at(seen, 3));
  if (at(winners, 3) > 0) return -at(winners, 0);
  for (const auto& cap : caps_)
    if (!cap.empty() && at(cap, 3) > 0 && at(cap, 0) >= at(seen, 0)) return at(cap, 1);
  return at(seen, 1);
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
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t p =
          static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
      const double weight = static_cast<double>(seen[4 * p + 3]);
      native::ShellPixel pixel;
      pixel.hit = weight > 0;
      pixel.value = static_cast<double>(seen[4 * p]);
      pixel.t_mm = depthOf(p, seen, winners) * perDepth(x, y);
      const native::ToolsOnRay tools = toolsOn(p);
      const glm::dvec3 colour = native::shellColour(job_, pixel, tools);
      for (int c = 0; c < 3; ++c)
        images.colour[4 * p + static_cast<std::size_t>(c)] = static_cast<float>(colour[c]);
      images.colour[4 * p + 3] = 1;
      images.depth[p] = pixel.hit      ? static_cast<float>(pixel.t_mm)
                        : tools.ends() ? static_cast<float>(tools.end_mm)
                                       : kNothing_mm;
    }
  return {};
}

}  // namespace

std::vector<HalfSpace> cuttingPlanes(const native::ShellsJob& job) {
  std::vector<HalfSpace> cuts;
  for (std::size_t n = native::kBoxPlanes; n < job.kept.size(); ++n) {
    bool cuts_ = false;
    for (int c = 0; c < 8; ++c) cuts_ = cuts_ || job.kept[n].distance_mm(job.volume->grid().corner(c)) > 1e-6;
    if (cuts_) cuts.push_back(job.kept[n]);
  }
  return cuts;
}

bool depthResolves(const native::ShellsJob& job) {
  if (job.mode != ShellsMode::Max || job.a == 0 || job.shells.empty()) return true;
  const double b = job.b + job.beta0 / job.betaM, most = job.shells.back().phi * (job.a + b);
  return job.shells.front().phi >= std::ldexp(most, -10);
}

Result<void> drawGlShells(gpu::Device& device, const native::ShellsJob& job, const GlShellsOptions& options,
                          Images& images, std::stop_token stop) {
  const Counters before = device.counters();
  if (Result<void> r = GlDrawing(device, job, options, std::move(stop)).run(images); !r) return r;
  const Counters& after = device.counters();
  images.counters.triangles += after.triangles - before.triangles;
  images.counters.samples += after.samples - before.samples;
  images.counters.bytesUploaded += after.bytesUploaded - before.bytesUploaded;
  images.counters.texturesCreated += after.texturesCreated - before.texturesCreated;
  return {};
}

}  // namespace vernier::angiography
