// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.rays: ray casting in a fragment shader through a 3-D texture of the whole volume, on the view's
// sampling lattice. Drawn in bands of rows, so that a cancel never waits for a whole picture.
#include <algorithm>

#include "DvrTechniques.h"
#include "GlParts.h"

namespace vernier::dvr {
namespace {

// Built-in costs on llvmpipe with two cores; the table of this machine wins.
constexpr double kFloatRead_ns = 80.0, kFixedRead_ns = 40.0, kRay_ns = 200.0, kSetUp_ms = 10.0;

const char* fragmentOf(const GlVolumeJob& job) {
  return job.iso ? "iso.frag.glsl" : job.extreme() ? "extreme.frag.glsl" : "rays.frag.glsl";
}

Result<std::shared_ptr<const gpu::Program>> programOf(gpu::Device& device, const GlVolumeJob& job,
                                                      const GlInputs& inputs) {
  const char* fragment = fragmentOf(job);
  const std::string d = inputs.defines() + (job.walksCells ? "#define CELLS\n" : "");
  const bool classifies = !job.iso && !job.extreme();
  const auto text = [&](std::string_view file, bool wanted) { return wanted ? file : std::string_view(); };
  return device.program(
      programName(std::string("dvr ") + fragment, d), shaderOf("", {"picture.vert.glsl"}),
      shaderOf(d, {"ray.glsl", "value.glsl", text("classify.glsl", classifies), "volume.glsl",
                   text("light.glsl", job.shaded()), text("gradient.glsl", job.shaded()),
                   text("cells.glsl", job.walksCells), fragment}));
}

// One part of all rays into `target`, band by band.
Result<void> drawBands(gpu::Device& device, const GlVolumeJob& job, const RayImages& rays, gpu::Draw& draw,
                       const gpu::Target& target, std::stop_token stop) {
  const auto most = static_cast<std::uint64_t>(static_cast<double>(kBatchReads) / readsPerSample(job));
  for (int y = 0; y < job.camera.height_px;) {
    std::uint64_t steps = 0;
    const int first = y;
    do steps += rays.stepsInRow[static_cast<std::size_t>(y++)];
    while (y < job.camera.height_px && steps + rays.stepsInRow[static_cast<std::size_t>(y)] <= most);
    if (steps == 0) continue;
    if (stop.stop_requested()) return drawingCancelled();
    draw.state.scissor = gpu::Rect{0, first, job.camera.width_px, y - first};
    if (Result<void> r = device.draw(target, {&draw, 1}); !r) return r;
    if (Result<void> r = device.limits().software ? device.finish() : Result<void>(); !r) return r;
  }
  return {};
}

// Everything on the device that the parts of one picture's rays are drawn with.
class RayDrawer {
 public:
  static Result<RayDrawer> make(gpu::Device& device, const GlVolumeJob& job, std::stop_token stop) {
    Result<GlInputs> inputs = GlInputs::make(device, job, job.step_mm);
    if (!inputs) return inputs.error();
    auto volume = gpu::slabTexture(device, *job.volume, job.code, 0, job.volume->grid().slices, stop);
    if (!volume) return volume.error();
    auto program = programOf(device, job, *inputs);
    if (!program) return program.error();
    Result<gpu::VertexData> vertices = wholePicture(device, job);
    if (!vertices) return vertices.error();
    const std::array formats{gpu::Format::Rgba32F, gpu::Format::Rgba32F};
    Result<gpu::Target> target = device.target(job.camera.width_px, job.camera.height_px, formats);
    if (!target) return target.error();
    return RayDrawer{device,
                     job,
                     *std::move(inputs),
                     *std::move(volume),
                     *std::move(program),
                     *std::move(vertices),
                     *std::move(target),
                     std::move(stop)};
  }

  Result<DrawnPart> draw(const RayImages& rays) {
    Result<RayTextures> textures = RayTextures::make(device_, job_, rays);
    if (!textures) return textures.error();
    for (int c = 0; c < 2; ++c)
      if (Result<void> r = device_.clear(target_, c, glm::vec4(0)); !r) return r.error();
    gpu::Draw draw;
    draw.program = program_.get(), draw.vertices = &vertices_, draw.count = 4;
    draw.primitive = gpu::Primitive::TriangleStrip;
    inputs_.addTo(draw);
    textures->addTo(draw);
    const GridGeometry& g = job_.volume->grid();
    draw.uniforms.push_back({"mostCells", static_cast<int>(g.columns + g.rows + g.slices)});
    draw.textures.push_back(
        {"volume", volume_.get(), job_.fixedFunction ? gpu::Filter::Linear : gpu::Filter::Nearest});
    for (const auto& [name, value] :
         {std::pair{"firstSlice", 0.0f}, {"enough", static_cast<float>(job_.leastLight)}, {"rank", 0.0f}})
      draw.uniforms.push_back({name, value});
    if (Result<void> r = drawBands(device_, job_, rays, draw, target_, stop_); !r) return r.error();
    return readBack(device_, target_);
  }

 private:
  using Shared = std::shared_ptr<const gpu::Program>;
  RayDrawer(gpu::Device& device, const GlVolumeJob& job, GlInputs inputs,
            std::shared_ptr<const gpu::Texture> volume, Shared program, gpu::VertexData vertices,
            gpu::Target target, std::stop_token stop)
      : device_(device),
        job_(job),
        inputs_(std::move(inputs)),
        volume_(std::move(volume)),
        program_(std::move(program)),
        vertices_(std::move(vertices)),
        target_(std::move(target)),
        stop_(std::move(stop)) {}

  gpu::Device& device_;
  const GlVolumeJob& job_;
  GlInputs inputs_;
  std::shared_ptr<const gpu::Texture> volume_;
  Shared program_;
  gpu::VertexData vertices_;
  gpu::Target target_;
  std::stop_token stop_;
};

Result<void> drawRays(gpu::Device& device, const GlVolumeJob& job, const RaysOfPass& pass, Images& images,
                      std::stop_token stop) {
  Result<RayDrawer> drawer = RayDrawer::make(device, job, stop);
  if (!drawer) return drawer.error();
  return drawParts(job, false, pass, images, std::move(stop),
                   [&](const RayImages& rays) { return drawer->draw(rays); });
}

// As the native rays do: exact where the field is known in every cell. Float volumes may hold NaN anywhere.
bool mayWalkCells(const GlVolumeJob& job, QualityLevel level) {
  if (!job.iso && !(job.extreme() && level != QualityLevel::Draft)) return false;
  const Volume& v = *job.volume;
  return !v.isColour() && !v.info().noData && v.type() != VoxelType::F32 &&
         (job.iso || job.interpolation == Interpolation::Linear);
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<GlVolumeJob>> made = glVolumeJob(layer, index, context);
  if (!made) return made.error();
  GlVolumeJob& job = **made;
  chooseOpenClassification(job);
  if (Result<void> r = checkParts(job, context); !r) return r.error();
  job.walksCells = mayWalkCells(job, context.quality.level);
  job.fixedFunction = job.fixedFunction && !job.walksCells;
  if (Result<void> r = checkPicture(job, context.capabilities); !r) return r.error();
  if (Result<void> r = checkWhole3dTexture(job, context.capabilities); !r) return r.error();
  if (job.extreme() && hasTranslucentTools(job))
    return makeError(
        ErrorCode::NoTechnique,
        "A tool that is translucent among the extremes of a volume is not drawn on GL; make it opaque.");
  if (!job.combiner.empty())
    return makeError(ErrorCode::NoTechnique, "Combiners shade slices, not rays; ask for stacks.");
  const GridGeometry& g = job.volume->grid();
  Pass pass;
  pass.name = (job.iso ? "iso-surface " : "volume ") + std::to_string(index);
  pass.inputs = {"volume texture"};
  if (!job.tools.empty()) pass.inputs.push_back("mesh");
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  const std::uint64_t texel = gpu::bytesOfTexel(*job.volume, job.code);
  const auto pixels =
      static_cast<std::uint64_t>(job.camera.width_px) * static_cast<std::uint64_t>(job.camera.height_px);
  pass.resources = {{"texture3d", texel * static_cast<std::uint64_t>(g.columns * g.rows * g.slices)},
                    {"ray images", 32 * pixels}};
  const auto known = context.costs.nsPerSample.find("dvr.rays");
  const double ns = known != context.costs.nsPerSample.end() ? known->second
                    : job.fixedFunction                      ? kFixedRead_ns
                                                             : kFloatRead_ns;
  pass.predicted_ms = kSetUp_ms + 1e-6 * (kRay_ns * static_cast<double>(pixels) +
                                          ns * readsPerSample(job) * raysLength_mm(job) / job.step_mm);
  pass.predictedError = predictedError(job, context.quality.step);
  pass.fixedFunctionFiltering = job.fixedFunction;
  pass.params = *made;
  return std::vector<Pass>{std::move(pass)};
}

Result<void> execute(Host& host, const Pass& pass, Images& images, std::stop_token stop) {
  const auto* job = dynamic_cast<const GlVolumeJob*>(pass.params.get());
  if (!job) return makeError(ErrorCode::Internal, "The pass has no parameters of a volume.", "dvr.rays");
  Result<gpu::Device*> device = host.glDevice();
  if (!device) return device.error();
  const Counters before = (*device)->counters();
  if (Result<void> r = drawRays(**device, *job, pass.rays, images, stop); !r) return r;
  addCounters(images.counters, before, (*device)->counters());
  return {};
}

}  // namespace

Technique glRaysTechnique(Host& host) {
  Technique t;
  t.name = "dvr.rays";
  t.kinds = {"volume", "isosurface"};
  t.engine = Engine::Gl;
  t.drawsParts = true;
  t.passesFor = passesFor;
  t.execute = [&host](const Pass& pass, Images& images, std::stop_token stop) {
    return execute(host, pass, images, stop);
  };
  return t;
}

}  // namespace vernier::dvr
