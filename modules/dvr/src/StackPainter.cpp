// SPDX-License-Identifier: GPL-3.0-or-later
#include "StackPainter.h"

#include <algorithm>
#include <cmath>

#include "CombinedText.h"
#include "GlGradients.h"
#include "GlParts.h"
#include "GlSlices.h"
#include "Outlines.h"

namespace vernier::dvr {
namespace {

constexpr double kAnyDepth = 1e300;
constexpr double kNowhere = -1e6;  // the place of a slice that a polygon lacks

// The samplers of SLICES slices and the statements that read them.
std::string definesOf(const GlVolumeJob& job, const GlInputs& inputs, const StackKind& kind) {
  if (job.combination)
    return inputs.defines() + (needsColours(*job.combination) ? "#define CLASSIFY\n" : "") +
           (job.combinationNeedsNormals ? "#define GRADIENTS\n" : "") + combinedDefines(*job.combination);
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

  Result<void> draw(const RaysOfPass& pass, Images& images) {
    if (Result<void> r = prepare(); !r) return r;
    Result<SliceTargets> targets = SliceTargets::make(device_, job_);
    if (!targets) return targets.error();
    const auto draw = [&](const RayImages& rays) -> Result<DrawnPart> {
      Result<RayTextures> textures = RayTextures::make(device_, job_, rays);
      if (!textures) return textures.error();
      if (Result<void> r = targets->clear(); !r) return r.error();
      if (Result<void> r = drawPart(*targets, *textures); !r) return r.error();
      Result<DrawnPart> drawn = targets->read();
      if (drawn) drawn->samples = slicesMet(rays);
      return drawn;
    };
    if (Result<void> r = drawParts(job_, false, pass, images, stop_, draw); !r) return r;
    if (job_.outlines && !images.rays) drawOutlines(images);
    return {};
  }

 private:
  // By all rays: slices whose slab they pass through, of surfaces and extremes those that they meet.
  std::uint64_t slicesMet(const RayImages& rays) const {
    const bool slabs = !job_.iso && !job_.extreme();
    const double last = static_cast<double>(slices_.size() - 1);
    double sum = 0;
    for (std::size_t p = 0; p < rays.entry_mm.size(); ++p) {
      if (rays.lattice[4 * p + 2] == 0) continue;
      const auto width = static_cast<std::size_t>(job_.camera.width_px);
      const PatientRay ray =
          job_.camera.ray(static_cast<double>(p % width) + 0.5, static_cast<double>(p / width) + 0.5);
      const double along = (job_.volume->voxelFromPatient() * ray.direction).v[axis_] *
                           static_cast<double>(rays.start[4 * p + 3]);
      const double a = perVoxel_ * static_cast<double>(rays.start[4 * p + static_cast<std::size_t>(axis_)]),
                   b = a + perVoxel_ * along;
      const double low = std::min(a, b), high = std::max(a, b);
      const double first = slabs ? std::floor(low + 0.5) : std::ceil(low),
                   end = slabs ? std::ceil(high - 0.5) : std::floor(high);
      sum += std::max(0.0, std::min(end, last) - std::max(first, 0.0) + 1);
    }
    return static_cast<std::uint64_t>(sum);
  }

  // The opacity table is of the way through a slab along the view.
  double table_mm() const {
    return 1.0 / (perVoxel_ * std::abs((job_.volume->voxelFromPatient() * job_.camera.forward).v[axis_]));
  }

  Result<std::shared_ptr<const gpu::Program>> ownProgram() {
    const std::string d = definesOf(job_, *inputs_, kind_);
    const bool classifies = !job_.iso && !job_.extreme();
    const auto text = [](std::string_view file, bool wanted) { return wanted ? file : std::string_view(); };
    return device_.program(
        programName("dvr stack", d), shaderOf("", {"picture.vert.glsl"}),
        shaderOf(d, {"ray.glsl", "value.glsl", text("classify.glsl", classifies), "corner.glsl", "plane.glsl",
                     text("light.glsl", job_.shaded()), text("appearance.glsl", classifies), "stack.glsl",
                     "stack.frag.glsl"}));
  }

  Result<std::shared_ptr<const gpu::Program>> combinedProgram() {
    const std::string d = definesOf(job_, *inputs_, kind_);
    const bool classifies = needsColours(*job_.combination);
    return device_.program(
        programName("dvr combined " + job_.combiner + " " + combinerDigest(*job_.combination),
                    inputs_->defines()),
        shaderOf("", {"picture.vert.glsl"}),
        shaderOf(
            d, {"ray.glsl", "value.glsl", classifies ? std::string_view("classify.glsl") : std::string_view(),
                "corner.glsl", "plane.glsl", "light.glsl", "stack.glsl", "combined.frag.glsl"}));
  }

  Result<void> prepare() {
    Result<GlInputs> inputs = GlInputs::make(device_, job_, table_mm());
    if (!inputs) return inputs.error();
    inputs_ = *std::move(inputs);
    auto program = job_.combination ? combinedProgram() : ownProgram();
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
    const Volume& v = *job_.volume;
    const bool normals = job_.combination && job_.combinationNeedsNormals;
    const bool gradients = !job_.combination && job_.shaded();
    auto t = normals     ? gradientPlane(device_, v, job_.code, axis_, at, GradientLength::Unit)
             : gradients ? gradientPlane(device_, v, job_.code, axis_, at, GradientLength::PerMm)
                         : gpu::planeTexture(device_, v, job_.code, axis_, at);
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
    addLevels(d);
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

  // Values as a combiner has them: 0..1 over the volume's range.
  void addLevels(gpu::Draw& d) const {
    const Volume::Range r = job_.volume->modalityRange().value_or(Volume::Range{0, 1});
    const double range = r.max > r.min ? r.max - r.min : 1;
    d.uniforms.push_back(
        {"shareOfValue", glm::vec2(job_.code.slope / range, (job_.code.modalityAtBias - r.min) / range)});
    d.uniforms.push_back({"levelShare", static_cast<float>((job_.level - r.min) / range)});
  }

  void drawOutlines(Images& images) const {
    const GridGeometry& g = job_.volume->grid();
    const glm::dvec3 last(g.columns - 1, g.rows - 1, g.slices - 1);
    for (std::size_t n = polygons_.size(); n-- > 0;)
      for (std::size_t i = 0; i < polygons_[n].count; ++i) {
        glm::dvec3 least(0), greatest = last;
        least[axis_] = greatest[axis_] = slices_[polygons_[n].first + i].place;
        drawOutline(images,
                    dvr::outlineOf(
                        bodyBetween(least, greatest, -kAnyDepth, kAnyDepth, job_.camera, g.patientFromVoxel),
                        job_.camera, g.patientFromVoxel, 0),
                    kSliceLines);
      }
    drawBox(images, glm::dvec3(0), last, job_.camera, g.patientFromVoxel);
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

}  // namespace

std::int64_t sizeAlong(const GridGeometry& g, int axis) {
  return axis == 0 ? g.columns : axis == 1 ? g.rows : g.slices;
}

Result<void> drawStack(gpu::Device& device, const GlVolumeJob& job, const StackKind& kind,
                       const RaysOfPass& pass, Images& images, std::stop_token stop) {
  const Counters before = device.counters();
  if (Result<void> r = StackPainter(device, job, kind, std::move(stop)).draw(pass, images); !r) return r;
  addCounters(images.counters, before, device.counters());
  return {};
}

}  // namespace vernier::dvr
