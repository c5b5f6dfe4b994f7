// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "GlShellDrawing.h"

namespace vernier::angiography {

Error shellsCancelled() { return makeError(ErrorCode::Cancelled, "Drawing the shells was cancelled."); }

std::string shaderOf(const std::string& defines, std::initializer_list<std::string_view> files) {
  std::string text = "#version 330 core\n" + defines;
  for (const std::string_view file : files) text += shaderText(file);
  return text;
}

Seen seenOf(const Mesh& mesh, const glm::dmat4& pixelFromMesh) {
  Seen seen;
  const glm::dvec3 low = mesh.lowest().p, high = mesh.highest().p;
  for (int n = 0; n < 8; ++n)
    seen.take(pixelFromMesh, {n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z});
  return seen;
}

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
    if (stop_.stop_requested()) return shellsCancelled();
    auto made = buffers(*s.mesh, {}, false);
    if (!made) return made.error();
    shells_.back() = *made;
  }
  return {};
}

glm::dvec2 GlDrawing::rampOfDepth() const {
  const double near = job_.ramp.near_mm, far = job_.ramp.far_mm, range = far - near;
  return job_.ramp.afterProjection ? glm::dvec2(-near, near * far) / range : glm::dvec2(far, -1) / range;
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

  const double near = job_.ramp.near_mm, far = job_.ramp.far_mm;
  const bool projected = job_.ramp.afterProjection;
  const glm::dvec3 eye = perspective_ ? camera.eye.p - middle_ : f;
  return {{"clipFromPlace", glm::mat4(clip)},
          {"cuts0", cuts[0]},
          {"cuts1", cuts[1]},
          {"perspective", perspective_ ? 1 : 0},
          {"ramp", glm::vec2(rampOfDepth())},
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
  d.uniforms.push_back({"number", static_cast<float>(shell + 1)});
  d.uniforms.push_back(
      {"fog", glm::vec2(phi * (job_.beta0 + job_.betaM * job_.b), phi * job_.betaM * job_.a)});
  static constexpr std::array kNames{"toolEnd_mm",  "toolLayers0", "toolLayers1",
                                     "toolLayers2", "toolLayers3", "toolLayers4"};
  for (std::size_t n = 0; n < toolTextures_.size(); ++n) d.textures.push_back({kNames[n], &toolTextures_[n]});
  draws.push_back(std::move(d));
}

Result<void> GlDrawing::drawShells() {
  auto made = program("shell", defines(), "shell.frag.glsl");
  if (!made) return made.error();
  const bool eachShell = max() && byDepth();
  bool toolsDrawn = false;
  for (std::size_t n = 0; n < job_.shells.size(); ++n) {
    if (!shells_[n]) continue;
    if (stop_.stop_requested()) return shellsCancelled();
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
    if (stop_.stop_requested()) return shellsCancelled();
    std::vector<gpu::Draw> draws;
    addShell(draws, **winner, n);
    draws[0].textures.push_back({"greatest", &target_->colour(0)});
    if (Result<void> r = device_.draw(*winners_, draws); !r) return r;
    if (Result<void> r = device_.limits().software ? device_.finish() : Result<void>(); !r) return r;
  }
  return {};
}

std::vector<HalfSpace> cuttingPlanes(const native::ShellsJob& job) {
  std::vector<HalfSpace> cuts;
  for (std::size_t n = native::kBoxPlanes; n < job.kept.size(); ++n) {
    bool reaches = false;
    for (int c = 0; c < 8; ++c)
      reaches = reaches || job.kept[n].distance_mm(job.volume->grid().corner(c)) > 1e-6;
    if (reaches) cuts.push_back(job.kept[n]);
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
