// SPDX-License-Identifier: GPL-3.0-or-later
// projection.gl: rays through a 3-D texture. GL samples the parts of rays between tools, cuts and borders;
// which parts there are, and what becomes of them, is module native's to say (PartReader), so that cuts,
// tools and the algebra are the same bit by bit. A part is drawn in batches, so that a cancel never waits
// long.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "AngiographyTechniques.h"
#include "GlShellDrawing.h"
#include "ProjectionParams.h"
#include "vernier/gpu/VolumeTexels.h"
#include "vernier/volume/Voi.h"

namespace vernier::angiography {
namespace {

// Built-in costs: of a sample, measured on llvmpipe with two cores, and of a pixel on the host.
constexpr double kSoftwareSample_ns = 30.0, kCardSample_ns = 0.05, kPixel_ns = 300.0, kSetUp_ms = 3.0;
constexpr double kBatchSamples = 5e5;  // between two looks at the stop token
constexpr int kBatchColumns = 64;
constexpr std::uint64_t kBytesPerPixel = 32;  // a part's ends, and what it amounts to

Error cancelled() { return makeError(ErrorCode::Cancelled, "The projection was cancelled."); }

std::string megabytes(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MB"; }

// What GL's samples of one picture come to, part by part.
class GlProjection {
 public:
  GlProjection(gpu::Device& device, const native::ProjectionJob& job, const gpu::TexelCode& code,
               std::stop_token stop)
      : device_(device),
        job_(job),
        code_(code),
        stop_(std::move(stop)),
        width_(job.camera.width_px),
        height_(job.camera.height_px),
        perspective_(job.camera.projection == Projection::Perspective),
        extreme_(isExtreme(job.mode)) {
    const GridGeometry& g = job.volume->grid();
    const double depth = dot(g.centre() - job.camera.eye, job.camera.forward);
    plane_mm_ = std::max(depth, 0.0);
    middle_ = {g.columns / 2, g.rows / 2, g.slices / 2};
  }

  Result<void> run(Images& images) {
    if (Result<void> r = findParts(images); !r) return r;
    for (std::size_t n = 0; n < parts_.size(); ++n)
      if (Result<void> r = drawPart(parts_[n], images.rays ? &borders_[n] : nullptr); !r) return r;
    images.counters.samples += samples_;
    return native::drawProjection(
        job_, [&](const native::RayPart& p) { return read(p); }, images, stop_);
  }

 private:
  std::size_t texel(const native::RayPart& p) const {
    return 4 *
           (static_cast<std::size_t>(p.x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(p.y));
  }

  // Begin, end and samples of every part, from the same walk that joins them in the end.
  Result<void> findParts(Images& images) {
    std::uint32_t most = 0;
    if (job_.tools)
      for (std::size_t n = 0; n + 1 < job_.tools->first.size(); ++n)
        most = std::max(most, job_.tools->first[n + 1] - job_.tools->first[n]);
    if (images.rays) most = std::max(most, mostSegments(*images.rays));
    parts_.resize(most + 1);
    borders_.resize(images.rays ? most + 1 : 0);
    for (auto* all : {&parts_, &borders_})
      for (auto& part : *all)
        part.assign(4 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0f);
    return native::drawProjection(
        job_,
        [&](const native::RayPart& p) {
          const native::Steps steps = native::stepsOf(p.along, job_.step_mm, extreme_);
          const double scale = 1 / p.rayPerDepth;
          float* const out = parts_[p.passed].data() + texel(p);
          out[0] =
              static_cast<float>((static_cast<double>(steps.first) + 0.5) * job_.step_mm * scale - plane_mm_);
          out[1] = static_cast<float>(p.along.from_mm * scale - plane_mm_);
          out[2] = static_cast<float>(p.along.to_mm * scale - plane_mm_);
          out[3] = static_cast<float>(steps.count);
          if (borders_.empty()) return native::Gathered{};
          float* const border = borders_[p.passed].data() + texel(p);
          border[0] = static_cast<float>(p.along.least_mm() * scale - plane_mm_);
          border[1] = static_cast<float>(p.along.most_mm() * scale - plane_mm_);
          return native::Gathered{};
        },
        images, stop_);
  }

  // Parts less one.
  std::uint32_t mostSegments(const RayIntervals& rays) const {
    std::uint32_t most = 1;
    for (std::size_t p = 0; p + 1 < rays.first.size(); ++p) {
      std::uint32_t count = 0;
      eachSegment(rays, p, job_.rays, [&](std::size_t) { ++count; });
      most = std::max(most, count);
    }
    return most - 1;
  }

  native::Gathered read(const native::RayPart& p) const {
    const float* const in = parts_[p.passed].data() + texel(p);
    native::Gathered out;
    const double value = static_cast<double>(in[0]), length = static_cast<double>(in[2]) * p.rayPerDepth;
    if (extreme_) {
      if (!(in[2] > 0)) return out;
      out.best = job_.cue > 0 ? value : value + code_.modalityAtBias;
      out.at_mm = (static_cast<double>(in[1]) + plane_mm_) * p.rayPerDepth;
    } else if (job_.mode == ProjectionMode::Mean) {
      out.length_mm = length;
      out.integral = value * p.rayPerDepth + code_.modalityAtBias * length;
    } else {
      out.length_mm = p.along.to_mm - p.along.from_mm;
      out.integral = value * p.rayPerDepth;
    }
    return out;
  }

  std::vector<gpu::Uniform> uniforms() const {
    const CameraPicture& camera = job_.camera;
    const VoxelFromPatient toVoxel = job_.volume->voxelFromPatient();
    const auto step = [&](PatientVec v) { return glm::vec3(toVoxel.linear * v.v); };
    const glm::dvec3 origin = (toVoxel * (camera.eye + camera.forward * plane_mm_)).p - glm::dvec3(middle_);
    const bool sigmoid = job_.window.function == VoiFunction::Sigmoid;
    const VoiRamp ramp = sigmoid ? VoiRamp{job_.window.center, job_.window.center} : rampOf(job_.window);
    const double perWidth = sigmoid ? 4 / job_.window.width : ramp.hi > ramp.lo ? 1 / (ramp.hi - ramp.lo) : 0;
    std::vector<gpu::Uniform> u{{"middle", glm::ivec3(middle_)},
                                {"origin", glm::vec3(origin)},
                                {"right", step(camera.right * camera.pixelStep)},
                                {"down", step(camera.up * -camera.pixelStep)},
                                {"forward", step(camera.forward)},
                                {"centre_px", 0.5f * glm::vec2(width_, height_)},
                                {"spread", perspective_ ? glm::vec2(plane_mm_, 1) : glm::vec2(1, 0)},
                                {"raySlope", perspective_ ? static_cast<float>(camera.pixelStep) : 0.0f},
                                {"step_mm", static_cast<float>(job_.step_mm)},
                                {"plane_mm", static_cast<float>(plane_mm_)},
                                {"gather", extreme_                            ? (job_.cue > 0 ? 1 : 0)
                                           : job_.mode == ProjectionMode::Mean ? 3
                                                                               : 2},
                                {"sense", job_.mode == ProjectionMode::Min ? -1.0f : 1.0f},
                                {"cue", cue()},
                                {"nearest", job_.interpolation == Interpolation::Nearest ? 1 : 0},
                                {"sigmoid", sigmoid ? 1 : 0},
                                {"low", static_cast<float>(ramp.lo - code_.modalityAtBias)},
                                {"high", static_cast<float>(ramp.hi - code_.modalityAtBias)},
                                {"perWidth", static_cast<float>(perWidth)}};
    gpu::addTexelUniforms(u, code_);
    return u;
  }

  // 1 - cue + cue z' of a depth, not above 1 (plan/Volumetric.h).
  glm::vec3 cue() const {
    const double near = job_.ramp.near_mm, far = job_.ramp.far_mm, share = job_.cue / (far - near);
    if (job_.ramp.afterProjection) return {1 - job_.cue - share * near, 0, share * near * far};
    return {1 - job_.cue + share * (far - plane_mm_), -share, 0};
  }

  // Rays in, what they amount to out.
  Result<void> drawPart(std::vector<float>& part, const std::vector<float>* border) {
    auto texture = gpu::volumeTexture(device_, *job_.volume, code_, stop_);
    if (!texture) return texture.error();
    Result<gpu::Texture> rays =
        device_.texture2d(gpu::Format::Rgba32F, width_, height_, std::as_bytes(std::span(part)));
    if (!rays) return rays.error();
    std::optional<gpu::Texture> borders;
    if (border) {
      Result<gpu::Texture> made =
          device_.texture2d(gpu::Format::Rgba32F, width_, height_, std::as_bytes(std::span(*border)));
      if (!made) return made.error();
      borders = *std::move(made);
    }
    const std::string fragment = "#version 330 core\n" + std::string(gpu::texelShader()) +
                                 std::string(shaderText("projection.frag.glsl"));
    auto program = device_.program("projection", shaderOf("", {"cap.vert.glsl"}), fragment);
    if (!program) return program.error();
    const std::array formats{gpu::Format::Rgba32F};
    Result<gpu::Target> target = device_.target(width_, height_, formats);
    if (!target) return target.error();
    if (Result<void> r = device_.clear(*target, 0, {0, 0, 0, 0}); !r) return r;
    const std::array whole{-1.0f, -1.0f, 3.0f, -1.0f, -1.0f, 3.0f};
    const std::array components{2};
    Result<gpu::VertexData> vertices = device_.vertices(whole, components);
    if (!vertices) return vertices.error();
    gpu::Draw d;
    d.program = program->get();
    d.vertices = &*vertices;
    d.count = 3;
    d.textures = {{"volume", texture->get()}, {"parts", &*rays}, {"borders", borders ? &*borders : &*rays}};
    d.uniforms = uniforms();
    d.uniforms.push_back({"pieces", borders ? 1 : 0});
    if (Result<void> r = drawBatches(d, *target, part); !r) return r;
    return device_.read(*target, 0, part);
  }

  // Columns of rows, as many as hold the samples of a batch.
  Result<void> drawBatches(gpu::Draw& d, const gpu::Target& target, const std::vector<float>& part) {
    for (int x = 0; x < width_; x += kBatchColumns) {
      const int columns = std::min(kBatchColumns, width_ - x);
      double samples = 0;
      for (int y = 0, first = 0; y < height_; ++y) {
        const float* const row =
            part.data() + 4 * (static_cast<std::size_t>(x) +
                               static_cast<std::size_t>(width_) * static_cast<std::size_t>(y));
        for (int n = 0; n < columns; ++n) samples += static_cast<double>(row[4 * n + 3]);
        if (samples < kBatchSamples && y + 1 < height_) continue;
        if (stop_.stop_requested()) return cancelled();
        d.state.scissor = gpu::Rect{x, first, columns, y + 1 - first};
        if (samples > 0)
          if (Result<void> r = device_.draw(target, {&d, 1}); !r) return r;
        if (Result<void> r = device_.limits().software ? device_.finish() : Result<void>(); !r) return r;
        samples_ += static_cast<std::uint64_t>(samples);
        samples = 0, first = y + 1;
      }
    }
    return {};
  }

  gpu::Device& device_;
  const native::ProjectionJob& job_;
  const gpu::TexelCode& code_;
  const std::stop_token stop_;
  const int width_, height_;
  const bool perspective_, extreme_;
  double plane_mm_ = 0;
  glm::i64vec3 middle_{0};
  std::vector<std::vector<float>> parts_;    // by the tools passed: first the rays, then what they amount to
  std::vector<std::vector<float>> borders_;  // of a picture with lenses: between which the samples lie
  std::uint64_t samples_ = 0;
};

Result<void> checkDrawable(const ProjectionParams& p, const gpu::TexelCode& code, const Capabilities& c) {
  if (std::string why = gpu::whyNotTexture3d(*p.volume, code, c); !why.empty())
    return makeError(ErrorCode::NoTechnique, std::move(why));
  const int largest = std::max(p.view.width_px, p.view.height_px);
  if (c.maxTexture > 0 && largest > c.maxTexture)
    return makeError(ErrorCode::NoTechnique, "The picture has " + std::to_string(largest) +
                                                 " pixels on a side; GL here draws up to " +
                                                 std::to_string(c.maxTexture) + ".");
  const std::uint64_t rays = kBytesPerPixel * static_cast<std::uint64_t>(p.view.width_px) *
                             static_cast<std::uint64_t>(p.view.height_px),
                      volume = code.bytes(p.volume->grid());
  if (volume + rays > c.glTextureBudget_bytes)
    return makeError(ErrorCode::NoTechnique,
                     "The volume needs " + megabytes(volume) + " and the picture's rays " + megabytes(rays) +
                         " as textures, and GL may hold " + megabytes(c.glTextureBudget_bytes) + ".");
  return {};
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<ProjectionParams>> params = projectionParams(layer, index, context);
  if (!params) return params.error();
  const ProjectionParams& p = **params;
  const Result<gpu::TexelCode> code = gpu::texelCode(*p.volume);
  if (!code) return code.error();
  if (const Result<void> ok = checkDrawable(p, *code, context.capabilities); !ok) return ok.error();
  Result<Pass> made = projectionPass(*params, index, context);
  if (!made) return made.error();
  Pass pass = *std::move(made);
  pass.inputs[0] = "volume texture";
  const double pixels = static_cast<double>(p.view.width_px) * static_cast<double>(p.view.height_px);
  pass.resources = {{"texture3d", code->bytes(p.volume->grid())},
                    {"rays", kBytesPerPixel * static_cast<std::uint64_t>(pixels)}};
  const auto known = context.costs.nsPerSample.find("projection.gl");
  const double sample_ns = known != context.costs.nsPerSample.end() ? known->second
                           : context.capabilities.glIsSoftware      ? kSoftwareSample_ns
                                                                    : kCardSample_ns;
  const double samples = 0.5 * cameraBox(p.volume->grid()).diagonal_mm / p.job.step_mm;
  pass.predicted_ms =
      kSetUp_ms +
      1e-6 * pixels * (kPixel_ns / std::max(1, context.capabilities.threads) + sample_ns * samples);
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(Host& host, const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const ProjectionParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no projection parameters.", pass.technique);
  const Result<gpu::TexelCode> code = gpu::texelCode(*p->volume);
  if (!code) return code.error();
  Result<gpu::Device*> device = host.glDevice();
  if (!device) return device.error();
  native::ProjectionJob job = p->job;
  job.rays = pass.rays;
  native::SurfaceHits tools;
  if (!p->tools.empty() && pass.rays.drawsPlainRays()) {
    Result<native::SurfaceHits> found = toolsOf(*p, images, stop);
    if (!found) return found.error();
    tools = *std::move(found);
    job.tools = &tools;
  }
  if (p->view.wantValues)
    images.values.resize(static_cast<std::size_t>(p->view.width_px) *
                         static_cast<std::size_t>(p->view.height_px));
  const Counters before = (*device)->counters();
  const Result<void> drawn = GlProjection(**device, job, *code, stop).run(images);
  const Counters& after = (*device)->counters();
  images.counters.bytesUploaded += after.bytesUploaded - before.bytesUploaded;
  images.counters.texturesCreated += after.texturesCreated - before.texturesCreated;
  images.counters.textures3dCreated += after.textures3dCreated - before.textures3dCreated;
  return drawn;
}

}  // namespace

Technique glProjectionTechnique(Host& host) {
  Technique t;
  t.name = "projection.gl";
  t.kinds = {"projection"};
  t.engine = Engine::Gl;
  t.drawsParts = true;
  t.passesFor = passesFor;
  t.execute = [&host](const Pass& p, Images& i, std::stop_token s) { return execute(host, p, i, s); };
  return t;
}

}  // namespace vernier::angiography
