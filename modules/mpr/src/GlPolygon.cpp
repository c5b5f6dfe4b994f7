// SPDX-License-Identifier: GPL-3.0-or-later
// mpr.polygon: one polygon on a 3-D texture of the whole volume. Evenly spaced slices only; a slab is a loop
// in the fragment shader. Drawn in bands of rows, so that a cancel never waits for a whole slab.
#include <algorithm>
#include <array>

#include "GlSlice.h"

namespace vernier::mpr {
namespace {

// Built-in costs on llvmpipe with two cores, measured on 512 x 512 x 256, oblique; the table of this machine
// wins.
constexpr double kFloatSample_ns = 80.0, kFixedSample_ns = 40.0, kSetUp_ms = 12.0;
constexpr double kBandSamples = 1e6;  // between two looks at the stop token
constexpr int kMostSamples = 4096;
constexpr std::array<int, 4> kVertexLayout{2, 1, 2, 2};
constexpr Margin kMargin{1.0 / 16.0, 1e-5};

// A slab's polygon is that of the union of its samples: the picture, cut only where one sample alone is
// drawn.
Outline outlineOf(const SliceParams& p) {
  if (p.slabSamples == 1)
    return crossSection(voxelPlane(p, 0), p.volume->grid(), p.view.width_px, p.view.height_px, kMargin);
  const double w = p.view.width_px, h = p.view.height_px;
  return {{0, 0}, {w, 0}, {w, h}, {0, h}};
}

std::vector<float> vertexFloats(const Outline& outline) {
  std::vector<float> out;
  for (const glm::dvec2& p : outline)
    for (const double v : {p.x, p.y, 0.0, 0.0, 0.0, 0.0, 0.0}) out.push_back(static_cast<float>(v));
  return out;
}

Result<void> drawPolygon(gpu::Device& device, const SliceParams& p, const TexelCode& code, bool fixed,
                         const gpu::Target& target, std::stop_token stop) {
  const Outline outline = outlineOf(p);
  if (outline.empty()) return {};
  auto program = device.program(fixed ? "mpr polygon, fixed-function" : "mpr polygon",
                                shaderOf("", {"picture.vert.glsl"}),
                                shaderOf(fixed ? "#define DEEPER\n#define FIXED\n" : "#define DEEPER\n",
                                         {"position.glsl", "texels.glsl", "polygon.frag.glsl"}));
  if (!program) return program.error();
  auto texture = gpu::volumeTexture(device, *p.volume, code, stop);
  if (!texture) return texture.error();
  Result<gpu::VertexData> vertices = device.vertices(vertexFloats(outline), kVertexLayout);
  if (!vertices) return vertices.error();

  gpu::Draw d;
  d.program = program->get();
  d.vertices = &*vertices;
  d.count = vertices->count();
  d.primitive = gpu::Primitive::TriangleFan;
  d.textures = {{"volume", texture->get(), fixed ? gpu::Filter::Linear : gpu::Filter::Nearest}};
  d.uniforms = {{"size_px", glm::vec2(p.view.width_px, p.view.height_px)},
                {"samples", p.slabSamples},
                {"nearest", p.interpolation == Interpolation::Nearest ? 1 : 0},
                {"mode", static_cast<int>(p.slab.mode)}};
  gpu::addTexelUniforms(d.uniforms, code);
  const VoxelPlane plane = voxelPlane(p, 0);
  addPositionUniforms(d.uniforms, plane, p.view.width_px, p.view.height_px);
  const glm::dvec3 deeper = p.slabSamples > 1 ? voxelPlane(p, 1).origin - plane.origin : glm::dvec3(0);
  addDeeperUniforms(d.uniforms, deeper, p.slabSamples);

  const double perRow = static_cast<double>(p.view.width_px) * p.slabSamples;
  const int rows = std::clamp(static_cast<int>(kBandSamples / perRow), 1, p.view.height_px);
  for (int y = 0; y < p.view.height_px; y += rows) {
    if (stop.stop_requested()) return cancelled();
    d.state.scissor = gpu::Rect{0, y, p.view.width_px, std::min(rows, p.view.height_px - y)};
    if (Result<void> r = device.draw(target, {&d, 1}); !r) return r;
    if (Result<void> r = device.limits().software ? device.finish() : Result<void>(); !r) return r;
  }
  return {};
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<const SliceParams>> params = sliceParams(layer, context);
  if (!params) return params.error();
  const SliceParams& p = **params;
  if (Result<void> r = checkDrawable(p, context.capabilities); !r) return r.error();
  const Result<TexelCode> code = texelCode(*p.volume);
  if (!code) return code.error();
  if (std::string why = gpu::whyNotTexture3d(*p.volume, *code, context.capabilities); !why.empty())
    return makeError(ErrorCode::NoTechnique, std::move(why));
  if (p.slabSamples > kMostSamples)
    return makeError(ErrorCode::NoTechnique, "The slab needs " + std::to_string(p.slabSamples) +
                                                 " samples per pixel; GL here takes up to 4096.");
  const bool fixed =
      context.quality.level == QualityLevel::Draft && gpu::mayUseFixedFunction(*p.volume, p.interpolation);

  Pass pass;
  pass.name = "slice " + std::to_string(index);
  pass.inputs = {"volume texture"};
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.resources = {{"texture3d", code->bytes(p.volume->grid())}};
  const auto known = context.costs.nsPerSample.find("mpr.polygon");
  const double ns = known != context.costs.nsPerSample.end() ? known->second
                    : fixed                                  ? kFixedSample_ns
                                                             : kFloatSample_ns;
  pass.predicted_ms = kSetUp_ms + ns * 1e-6 * p.view.width_px * p.view.height_px * p.slabSamples;
  pass.predictedError = predictedError(p, context.quality.step, fixed);
  pass.fixedFunctionFiltering = fixed;
  pass.params = *params;
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(Host& host, const Pass& pass, Images& images, std::stop_token stop) {
  const auto* p = dynamic_cast<const SliceParams*>(pass.params.get());
  if (!p) return makeError(ErrorCode::Internal, "The pass has no slice parameters.", "mpr.polygon");
  const Result<TexelCode> code = texelCode(*p->volume);
  if (!code) return code.error();
  Result<gpu::Device*> device = host.glDevice();
  if (!device) return device.error();
  gpu::Device& d = **device;
  const Counters before = d.counters();
  Result<gpu::Target> target = accumulationTarget(d, *p);
  if (!target) return target.error();
  if (Result<void> r = drawPolygon(d, *p, *code, pass.fixedFunctionFiltering, *target, stop); !r) return r;
  const std::uint64_t pixels = d.counters().samples - before.samples;
  if (Result<void> r = resolve(d, *target, *p, *code, images); !r) return r;
  images.counters.samples += pixels * static_cast<std::uint64_t>(p->slabSamples);
  addCounters(images.counters, before, d.counters());
  return {};
}

}  // namespace

Technique polygonTechnique(Host& host) {
  Technique t;
  t.name = "mpr.polygon";
  t.kinds = {"slice"};
  t.engine = Engine::Gl;
  t.passesFor = passesFor;
  t.execute = [&host](const Pass& pass, Images& images, std::stop_token stop) {
    return execute(host, pass, images, stop);
  };
  return t;
}

}  // namespace vernier::mpr
