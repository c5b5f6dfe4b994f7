// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.stacks, dvr.stacks2, dvr.stacks4: object-aligned stacks of 2-D textures (Rezk-Salama 2000, sections 4
// to 7), with one, two or four slices on a polygon; dvr.stacks2-uncorrected maps both slices of a polygon as
// the first lies, for comparison (figure 13). Of the three stacks only the one that the view needs.
#include <algorithm>
#include <cmath>

#include "DvrTechniques.h"
#include "GlGradients.h"
#include "GlSlices.h"
#include "SlabGeometry.h"

namespace vernier::dvr {
namespace {

// Built-in costs on llvmpipe with two cores; the table of this machine wins.
constexpr double kRead_ns = 60.0, kFixedRead_ns = 25.0, kFragment_ns = 60.0, kPolygon_ms = 0.05,
                 kSetUp_ms = 12.0;
constexpr std::size_t kMostPerPolygon = 4;
constexpr double kNowhere = -1e6;  // the place of a slice that a polygon lacks

struct StackKind {
  const char* name;
  std::size_t perPolygon;
  bool corrected;
};

std::int64_t sizeAlong(const GridGeometry& g, int axis) {
  return axis == 0 ? g.columns : axis == 1 ? g.rows : g.slices;
}

// The samplers of SLICES slices and the statements that read them.
std::string definesOf(const GlVolumeJob& job, const GlInputs& inputs, const StackKind& kind) {
  std::string d = inputs.defines() + "#define SLICES " + std::to_string(kind.perPolygon) + "\n", reads;
  for (std::size_t n = 0; n < kind.perPolygon; ++n) {
    const std::string i = std::to_string(n);
    d += "uniform sampler2D lower" + i + ";\nuniform sampler2D upper" + i + ";\n";
    reads +=
        " slices[" + i + "] = sliceOf(lower" + i + ", upper" + i + ", " + i + ", start, along, box, eye);";
  }
  d += "#define READ_SLICES" + reads + "\n";
  if (job.shaded()) d += "#define GRADIENTS\n";
  if (job.iso) d += "#define ISO\n";
  if (job.extreme()) d += "#define EXTREME\n";
  if (!kind.corrected) d += "#define UNCORRECTED\n";
  return d;
}

class StackPainter {
 public:
  StackPainter(gpu::Device& device, const GlVolumeJob& job, const StackKind& kind, std::stop_token stop)
      : device_(device),
        job_(job),
        kind_(kind),
        stop_(std::move(stop)),
        axis_(stackAxis(job.camera, job.volume->grid())),
        perVoxel_(slicesPerVoxel(job.step_mm / job.smallestSpacing_mm())),
        slices_(stackSlices(sizeAlong(job.volume->grid(), axis_), perVoxel_)),
        polygons_(
            stackPolygons(slices_, kind.perPolygon, axis_, job.camera, job.volume->voxelFromPatient())) {}

  Result<void> draw(Images& images) {
    Result<RayParts> parts = RayParts::make(job_, false, stop_);
    if (!parts) return parts.error();
    if (Result<void> r = prepare(); !r) return r;
    Result<SliceTargets> targets = SliceTargets::make(device_, job_);
    if (!targets) return targets.error();
    PictureMaker picture(job_, *parts);
    for (std::size_t n = 0; n < parts->count(); ++n) {
      const RayImages rays = parts->images(n, picture.through());
      Result<RayTextures> textures = RayTextures::make(device_, job_, rays);
      if (!textures) return textures.error();
      if (Result<void> r = targets->clear(); !r) return r;
      if (Result<void> r = drawPart(*targets, *textures); !r) return r;
      Result<DrawnPart> drawn = targets->read();
      if (!drawn) return drawn.error();
      picture.take(n, rays, *drawn);
    }
    picture.addSamples(targets->fragments() * kind_.perPolygon);
    picture.finish(images);
    return {};
  }

 private:
  // The opacity table is of the way through a slab along the view.
  double table_mm() const {
    return 1.0 / (perVoxel_ * std::abs((job_.volume->voxelFromPatient() * job_.camera.forward).v[axis_]));
  }

  Result<void> prepare() {
    Result<GlInputs> inputs = GlInputs::make(device_, job_, table_mm());
    if (!inputs) return inputs.error();
    inputs_ = *std::move(inputs);
    const std::string d = definesOf(job_, *inputs_, kind_);
    const bool classifies = !job_.iso && !job_.extreme();
    const auto text = [](std::string_view file, bool wanted) { return wanted ? file : std::string_view(); };
    auto program =
        device_.program(programName("dvr stack", d), shaderOf("", {"picture.vert.glsl"}),
                        shaderOf(d, {"ray.glsl", "value.glsl", text("classify.glsl", classifies),
                                     "corner.glsl", "plane.glsl", text("light.glsl", job_.shaded()),
                                     text("appearance.glsl", classifies), "stack.frag.glsl"}));
    if (!program) return program.error();
    program_ = *program;
    std::vector<float> floats;
    for (const StackPolygon& p : polygons_) {
      const Outline outline = outlineOf(p);
      firsts_.push_back(static_cast<int>(floats.size() / 2)),
          counts_.push_back(static_cast<int>(outline.size()));
      for (const glm::dvec2& q : outline)
        floats.push_back(static_cast<float>(q.x)), floats.push_back(static_cast<float>(q.y));
    }
    const std::array layout{2};
    Result<gpu::VertexData> vertices = device_.vertices(floats, layout);
    if (!vertices) return vertices.error();
    vertices_ = *std::move(vertices);
    return {};
  }

  // The slabs of all slices of the polygon.
  Outline outlineOf(const StackPolygon& p) const {
    const GridGeometry& g = job_.volume->grid();
    glm::dvec3 least(0), greatest(g.columns - 1, g.rows - 1, g.slices - 1);
    const double half = 0.5 / perVoxel_, last = greatest[axis_];
    least[axis_] = std::max(0.0, slices_[p.first].place - half);
    greatest[axis_] = std::min(last, slices_[p.first + p.count - 1].place + half);
    constexpr double kAnyDepth = 1e300;
    return dvr::outlineOf(
        bodyBetween(least, greatest, -kAnyDepth, kAnyDepth, job_.camera, g.patientFromVoxel), job_.camera,
        g.patientFromVoxel);
  }

  Result<void> drawPart(SliceTargets& targets, const RayTextures& rays) {
    const std::size_t perBatch = std::max<std::size_t>(1, kBatchSlices / kind_.perPolygon);
    for (std::size_t begin = 0; begin < polygons_.size(); begin += perBatch) {
      const std::size_t end = std::min(begin + perBatch, polygons_.size());
      std::vector<gpu::Draw> draws;
      held_.clear();
      for (std::size_t n = end; n-- > begin;) {  // back to front within the batch
        Result<gpu::Draw> d = drawOf(n, targets, rays);
        if (!d) return d.error();
        draws.push_back(*std::move(d));
      }
      if (Result<void> r = targets.batch(draws, rays, stop_); !r) return r;
    }
    return {};
  }

  Result<const gpu::Texture*> plane(std::int64_t at) {
    auto t = job_.shaded() ? gradientPlane(device_, *job_.volume, job_.code, axis_, at, GradientLength::PerMm)
                           : gpu::planeTexture(device_, *job_.volume, job_.code, axis_, at);
    if (!t) return t.error();
    held_.push_back(*t);
    return held_.back().get();
  }

  Result<gpu::Draw> drawOf(std::size_t n, const SliceTargets& targets, const RayTextures& rays) {
    static constexpr const char* kLower[] = {"lower0", "lower1", "lower2", "lower3"};
    static constexpr const char* kUpper[] = {"upper0", "upper1", "upper2", "upper3"};
    const StackPolygon& p = polygons_[n];
    gpu::Draw d;
    d.program = program_.get(), d.vertices = &*vertices_;
    d.first = firsts_[n], d.count = counts_[n], d.primitive = gpu::Primitive::TriangleFan;
    d.state = targets.state();
    inputs_->addTo(d);
    rays.addTo(d);
    glm::vec4 places(kNowhere), alphas(0);
    const gpu::Filter filter = job_.fixedFunction ? gpu::Filter::Linear : gpu::Filter::Nearest;
    for (std::size_t i = 0; i < kind_.perPolygon; ++i) {
      const StackSlice& s = slices_[p.first + std::min(i, p.count - 1)];
      const auto at = static_cast<int>(i);
      if (i < p.count) places[at] = static_cast<float>(s.place), alphas[at] = static_cast<float>(s.alpha);
      Result<const gpu::Texture*> lower = plane(s.lower), upper = s.alpha > 0 ? plane(s.lower + 1) : lower;
      if (!lower) return lower.error();
      if (!upper) return upper.error();
      d.textures.push_back({kLower[i], *lower, filter});
      d.textures.push_back({kUpper[i], *upper, filter});
    }
    d.uniforms.push_back({"axis", axis_});
    d.uniforms.push_back({"places", places});
    d.uniforms.push_back({"alphas", alphas});
    for (const auto& [name, value] :
         {std::pair{"halfSlab", 0.5 / perVoxel_},
          {"table_mm", table_mm()},
          {"rank", (static_cast<double>(n) + 0.5) / static_cast<double>(polygons_.size())}})
      d.uniforms.push_back({name, static_cast<float>(value)});
    return d;
  }

  gpu::Device& device_;
  const GlVolumeJob& job_;
  const StackKind& kind_;
  const std::stop_token stop_;
  const int axis_, perVoxel_;
  const std::vector<StackSlice> slices_;
  const std::vector<StackPolygon> polygons_;
  std::optional<GlInputs> inputs_;
  std::shared_ptr<const gpu::Program> program_;
  std::optional<gpu::VertexData> vertices_;
  std::vector<int> firsts_, counts_;
  std::vector<std::shared_ptr<const gpu::Texture>> held_;  // until the batch is drawn
};

Error cannot(std::string why) { return makeError(ErrorCode::NoTechnique, std::move(why)); }

Result<void> checkStack(const GlVolumeJob& job, const StackKind& kind, const Capabilities& c) {
  if (Result<void> r = checkPicture(job, c); !r) return r;
  const GridGeometry& g = job.volume->grid();
  const std::int64_t largest = std::max({g.columns, g.rows, g.slices});
  if (c.maxTexture > 0 && largest > c.maxTexture)
    return cannot("The volume has " + std::to_string(largest) +
                  " voxels on a side; GL textures here take up to " + std::to_string(c.maxTexture) + ".");
  if (job.classification == Classification::PreIntegrated && !job.iso && !job.extreme())
    return cannot(
        "Pre-integrated tables are for the values at both ends of a step; stacks have one for each slice.");
  if (job.extreme() && hasTranslucentTools(job))
    return cannot(
        "A tool that is translucent among the extremes of a volume is not drawn on GL; make it opaque.");
  if (!kind.corrected && (job.extreme() || job.iso))
    return cannot("Uncorrected polygons are there to be compared with corrected ones, in blended volumes.");
  if (!job.combiner.empty())
    return cannot("Stacks shade by their own rules here; combiners are drawn by dvr.combined.");
  return {};
}

std::uint64_t bytesOfStack(const GlVolumeJob& job) {
  const GridGeometry& g = job.volume->grid();
  const std::uint64_t texel = job.shaded() ? kGradientBytes : gpu::bytesOfTexel(*job.volume, job.code);
  return texel * static_cast<std::uint64_t>(g.columns * g.rows * g.slices);
}

Result<std::vector<Pass>> passesFor(const StackKind& kind, const Layer& layer, std::size_t index,
                                    const PlanContext& context) {
  Result<std::shared_ptr<GlVolumeJob>> made = glVolumeJob(layer, index, context);
  if (!made) return made.error();
  GlVolumeJob& job = **made;
  if (Result<void> r = checkStack(job, kind, context.capabilities); !r) return r.error();
  job.fixedFunction = job.fixedFunction && !job.shaded();
  const int axis = stackAxis(job.camera, job.volume->grid()), perVoxel = slicesPerVoxel(context.quality.step);
  const std::int64_t planes = sizeAlong(job.volume->grid(), axis), slices = (planes - 1) * perVoxel + 1;
  job.summary = std::string("stack across ") + "xyz"[axis] + " x" + std::to_string(perVoxel) + ", " +
                std::to_string(kind.perPolygon) + (kind.perPolygon > 1 ? " slices" : " slice") +
                " per polygon" + (kind.corrected ? "" : ", uncorrected");
  Pass pass;
  pass.name = (job.iso ? "iso-surface " : "volume ") + std::to_string(index);
  pass.inputs = {job.shaded() ? "gradient textures" : "slice textures"};
  if (!job.tools.empty()) pass.inputs.push_back("mesh");
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.gl.blend = job.iso ? "off" : job.extreme() ? "max" : "remaining";
  pass.gl.depth = job.iso ? "nearest" : "off";
  const std::uint64_t bytes = bytesOfStack(job);
  const auto pixels =
      static_cast<std::uint64_t>(job.camera.width_px) * static_cast<std::uint64_t>(job.camera.height_px);
  pass.resources = {{"texture2d x " + std::to_string(planes), bytes}, {"ray images", 32 * pixels}};
  if (bytes > context.capabilities.glTextureBudget_bytes)
    pass.notes.push_back("the stack needs " + std::to_string(bytes >> 20) + " MB of textures and GL keeps " +
                         std::to_string(context.capabilities.glTextureBudget_bytes >> 20) +
                         " MB: its slices are uploaded anew for each picture");
  const auto known = context.costs.nsPerSample.find(kind.name);
  const double read = known != context.costs.nsPerSample.end() ? known->second
                      : job.fixedFunction                      ? kFixedRead_ns
                                                               : kRead_ns;
  // Fragments: each slice as far as rays meet it.
  const double along = std::abs((job.volume->voxelFromPatient() * job.camera.forward).v[axis]);
  const double reads = raysLength_mm(job) * along * perVoxel;
  const double polygons = static_cast<double>(slices) / static_cast<double>(kind.perPolygon);
  pass.predicted_ms =
      kSetUp_ms + polygons * kPolygon_ms +
      1e-6 * reads * (read * (perVoxel > 1 ? 2 : 1) + kFragment_ns / static_cast<double>(kind.perPolygon));
  pass.predictedError = 1.5 * predictedError(job, 1.0 / perVoxel) + (kind.corrected ? 0 : 60);
  pass.fixedFunctionFiltering = job.fixedFunction;
  pass.params = *made;
  return std::vector<Pass>{std::move(pass)};
}

Technique stackTechnique(Host& host, const StackKind& kind) {
  Technique t;
  t.name = kind.name;
  t.kinds = {"volume", "isosurface"};
  t.engine = Engine::Gl;
  t.passesFor = [&kind](const Layer& layer, std::size_t index, const PlanContext& context) {
    return passesFor(kind, layer, index, context);
  };
  t.execute = [&host, &kind](const Pass& pass, Images& images, std::stop_token stop) -> Result<void> {
    const auto* job = dynamic_cast<const GlVolumeJob*>(pass.params.get());
    if (!job) return makeError(ErrorCode::Internal, "The pass has no parameters of a volume.", kind.name);
    Result<gpu::Device*> device = host.glDevice();
    if (!device) return device.error();
    const Counters before = (*device)->counters();
    if (Result<void> r = StackPainter(**device, *job, kind, std::move(stop)).draw(images); !r) return r;
    addCounters(images.counters, before, (*device)->counters());
    return {};
  };
  return t;
}

constexpr StackKind kOne{"dvr.stacks", 1, true}, kTwo{"dvr.stacks2", 2, true}, kFour{"dvr.stacks4", 4, true},
    kUncorrected{"dvr.stacks2-uncorrected", 2, false};
static_assert(kFour.perPolygon <= kMostPerPolygon);

}  // namespace

Technique glStacksTechnique(Host& host) { return stackTechnique(host, kOne); }
Technique glStacks2Technique(Host& host) { return stackTechnique(host, kTwo); }
Technique glStacks4Technique(Host& host) { return stackTechnique(host, kFour); }
Technique glUncorrectedStacksTechnique(Host& host) { return stackTechnique(host, kUncorrected); }

}  // namespace vernier::dvr
