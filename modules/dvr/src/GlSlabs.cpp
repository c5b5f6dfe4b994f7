// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.slabs: view-aligned slices through slabs of the volume, each a 3-D texture that the memory budget holds
// (SGI, Volume Rendering Primer). dvr.strips: the same slices from pairs of 2-D textures, cut into strips at
// the texture slices (Rezk-Salama 2000, section 9): slow, for comparisons.
#include <algorithm>
#include <cmath>
#include <map>

#include "DvrTechniques.h"
#include "GlGradients.h"
#include "GlParts.h"
#include "GlSlices.h"
#include "Outlines.h"

namespace vernier::dvr {
namespace {

// Built-in costs on llvmpipe with two cores; the table of this machine wins.
constexpr double kRead_ns = 90.0, kFixedRead_ns = 45.0, kFragment_ns = 130.0, kPolygon_ms = 0.18,
                 kSetUp_ms = 12.0;

struct SlabKind {
  const char* name;
  bool strips;
};

std::string definesOf(const GlVolumeJob& job, const GlInputs& inputs, const SlabKind& kind) {
  std::string d = inputs.defines();
  if (kind.strips) d += "#define STRIPS\n";
  if (job.shaded()) d += "#define GRADIENTS\n";
  if (job.iso) d += "#define ISO\n";
  if (job.extreme()) d += "#define EXTREME\n";
  return d;
}

class SlabPainter {
 public:
  SlabPainter(gpu::Device& device, const GlVolumeJob& job, const SlabKind& kind, std::stop_token stop)
      : device_(device), job_(job), kind_(kind), stop_(std::move(stop)), grid_(job.volume->grid()) {
    slabs_ = slabsOf(grid_.slices, job.slabSlices, job.camera, job.volume->voxelFromPatient());
    const glm::dvec2 all = depthsOf(glm::dvec3(0), last(), job.camera, grid_.patientFromVoxel);
    firstPlane_ = std::max(0.0, std::floor(all.x / job.step_mm) - 1);
    lastPlane_ = std::floor(all.y / job.step_mm) + 1;
  }

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
      if (drawn) drawn->samples = rays.samples(!job_.iso && !job_.extreme()) * (readsBothEnds() ? 2 : 1);
      return drawn;
    };
    if (Result<void> r = drawParts(job_, true, pass, images, stop_, draw); !r) return r;
    if (job_.outlines && !images.rays) drawOutlines(images);
    return {};
  }

 private:
  glm::dvec3 last() const {
    return {static_cast<double>(grid_.columns - 1), static_cast<double>(grid_.rows - 1),
            static_cast<double>(grid_.slices - 1)};
  }

  Result<void> prepare() {
    Result<GlInputs> inputs = GlInputs::make(device_, job_, job_.step_mm);
    if (!inputs) return inputs.error();
    inputs_ = *std::move(inputs);
    const std::string d = definesOf(job_, *inputs_, kind_);
    const bool classifies = !job_.iso && !job_.extreme();
    const auto text = [](std::string_view file, bool wanted) { return wanted ? file : std::string_view(); };
    auto program = device_.program(
        programName("dvr slab", d), shaderOf("", {"picture.vert.glsl"}),
        shaderOf(d, {"ray.glsl", "value.glsl", text("classify.glsl", classifies), "corner.glsl",
                     text("plane.glsl", kind_.strips), "slab.glsl", text("light.glsl", job_.shaded()),
                     text("appearance.glsl", classifies), "slab.frag.glsl"}));
    if (!program) return program.error();
    program_ = *program;
    return {};
  }

  // The slab's corners, wider by what a step may reach beyond: a sample may lie here and its step begin
  // there.
  void boxOf(const Slab& slab, glm::dvec3& least, glm::dvec3& greatest) const {
    const CameraPicture& c = job_.camera;
    double along = 0;
    for (const double x : {0.0, static_cast<double>(c.width_px)})
      for (const double y : {0.0, static_cast<double>(c.height_px)})
        along = std::max(along, std::abs((job_.volume->voxelFromPatient() * c.ray(x, y).direction).v.z) *
                                    c.rayPerDepth(x, y));
    const double reach = along * job_.step_mm + 0.01;
    least = glm::dvec3(0), greatest = last();
    least.z = std::max(0.0, static_cast<double>(slab.first) - reach);
    greatest.z = std::min(greatest.z, static_cast<double>(slab.first + slab.count - 1) + reach);
  }

  struct Piece {
    double plane = 0;
    int first = 0, count = 0;  // vertices
  };
  // The polygons of all slices that pass through the slab, nearest first.
  std::vector<Piece> piecesOf(const Slab& slab, std::vector<float>& floats) const {
    glm::dvec3 least, greatest;
    boxOf(slab, least, greatest);
    const glm::dvec2 depths = depthsOf(least, greatest, job_.camera, grid_.patientFromVoxel);
    std::vector<Piece> out;
    for (double k = std::max(0.0, std::floor(depths.x / job_.step_mm) - 1); k * job_.step_mm <= depths.y;
         ++k) {
      const Outline outline = outlineOf(bodyBetween(least, greatest, k * job_.step_mm, (k + 1) * job_.step_mm,
                                                    job_.camera, grid_.patientFromVoxel),
                                        job_.camera, grid_.patientFromVoxel);
      if (outline.empty()) continue;
      out.push_back({k, static_cast<int>(floats.size() / 2), static_cast<int>(outline.size())});
      for (const glm::dvec2& p : outline)
        floats.push_back(static_cast<float>(p.x)), floats.push_back(static_cast<float>(p.y));
    }
    return out;
  }

  bool readsBothEnds() const {
    return job_.classification == Classification::PreIntegrated && !job_.iso && !job_.extreme();
  }

  Result<void> drawPart(SliceTargets& targets, const RayTextures& rays) {
    if (kind_.strips) return drawStrips(targets, rays);
    for (const Slab& slab : slabs_)
      if (Result<void> r = drawSlab(slab, targets, rays); !r) return r;
    return {};
  }

  using Planes = std::map<std::int64_t, std::shared_ptr<const gpu::Texture>>;
  Result<const gpu::Texture*> plane(std::int64_t k, Planes& held) {
    if (const auto found = held.find(k); found != held.end()) return found->second.get();
    auto t = job_.shaded() ? gradientPlane(device_, *job_.volume, job_.code, 2, k, GradientLength::PerMm)
                           : gpu::planeTexture(device_, *job_.volume, job_.code, 2, k);
    if (!t) return t.error();
    return (held[k] = *t).get();
  }

  // Slice by slice, each with all its strips; the texture slices lie in the cache.
  Result<void> drawStrips(SliceTargets& targets, const RayTextures& rays) {
    std::vector<float> floats;
    std::map<double, std::vector<std::pair<const Slab*, Piece>>> planes;
    for (const Slab& slab : slabs_)
      for (const Piece& piece : piecesOf(slab, floats)) planes[piece.plane].emplace_back(&slab, piece);
    if (floats.empty()) return {};
    const std::array layout{2};
    Result<gpu::VertexData> vertices = device_.vertices(floats, layout);
    if (!vertices) return vertices.error();
    for (auto begin = planes.begin(); begin != planes.end();) {
      auto end = begin;
      for (std::size_t n = 0; n < kBatchSlices && end != planes.end(); ++n) ++end;
      Planes held;
      std::vector<gpu::Draw> draws;
      for (auto at = end; at != begin;)  // back to front within the batch
        for (const auto& [slab, piece] : (--at)->second) {
          Result<const gpu::Texture*> lower = plane(slab->first, held), upper = plane(slab->first + 1, held);
          if (!lower) return lower.error();
          if (!upper) return upper.error();
          draws.push_back(drawOf(*slab, piece, *vertices, targets, rays));
          draws.back().textures.push_back({"lower0", *lower, filter()});
          draws.back().textures.push_back({"upper0", *upper, filter()});
        }
      if (Result<void> r = targets.batch(draws, rays, stop_); !r) return r;
      begin = end;
    }
    return {};
  }

  Result<void> drawSlab(const Slab& slab, SliceTargets& targets, const RayTextures& rays) {
    std::vector<float> floats;
    const std::vector<Piece> pieces = piecesOf(slab, floats);
    if (pieces.empty()) return {};
    const std::array layout{2};
    Result<gpu::VertexData> vertices = device_.vertices(floats, layout);
    if (!vertices) return vertices.error();
    if (stop_.stop_requested()) return drawingCancelled();
    // One slab at a time: the one before has been let go.
    const Volume& v = *job_.volume;
    auto texture = job_.shaded() ? gradientVolume(device_, v, job_.code, slab.first, slab.count,
                                                  GradientLength::PerMm, stop_)
                                 : gpu::slabTexture(device_, v, job_.code, slab.first, slab.count, stop_);
    if (!texture) return texture.error();
    for (std::size_t begin = 0; begin < pieces.size(); begin += kBatchSlices) {
      const std::size_t end = std::min(begin + kBatchSlices, pieces.size());
      std::vector<gpu::Draw> draws;
      for (std::size_t n = end; n-- > begin;) {  // back to front within the batch
        draws.push_back(drawOf(slab, pieces[n], *vertices, targets, rays));
        draws.back().textures.push_back({"volume", texture->get(), filter()});
      }
      if (Result<void> r = targets.batch(draws, rays, stop_); !r) return r;
    }
    return {};
  }

  gpu::Filter filter() const { return job_.fixedFunction ? gpu::Filter::Linear : gpu::Filter::Nearest; }

  gpu::Draw drawOf(const Slab& slab, const Piece& piece, const gpu::VertexData& vertices,
                   const SliceTargets& targets, const RayTextures& rays) const {
    gpu::Draw d;
    d.program = program_.get(), d.vertices = &vertices;
    d.first = piece.first, d.count = piece.count, d.primitive = gpu::Primitive::TriangleFan;
    d.state = targets.state();
    inputs_->addTo(d);
    rays.addTo(d);
    d.uniforms.push_back({"slabRange", glm::vec2(slab.from, slab.below)});
    const double rank = (piece.plane - firstPlane_ + 0.5) / (lastPlane_ - firstPlane_ + 1);
    for (const auto& [name, value] :
         {std::pair{"plane", piece.plane}, {"firstSlice", static_cast<double>(slab.first)}, {"rank", rank}})
      d.uniforms.push_back({name, static_cast<float>(value)});
    return d;
  }

  void drawOutlines(Images& images) const {
    for (std::size_t n = slabs_.size(); n-- > 0;) {
      glm::dvec3 least(0), greatest = last();
      least.z = static_cast<double>(slabs_[n].first);
      greatest.z = static_cast<double>(slabs_[n].first + slabs_[n].count - 1);
      const glm::dvec2 depths = depthsOf(least, greatest, job_.camera, grid_.patientFromVoxel);
      for (double k = std::floor(depths.y / job_.step_mm); k >= 0 && (k + 0.5) * job_.step_mm >= depths.x;
           --k) {
        const double at = (k + 0.5) * job_.step_mm;
        drawOutline(images,
                    outlineOf(bodyBetween(least, greatest, at, at, job_.camera, grid_.patientFromVoxel),
                              job_.camera, grid_.patientFromVoxel, 0),
                    kSliceLines);
      }
      drawBox(images, least, greatest, job_.camera, grid_.patientFromVoxel);
    }
  }

  gpu::Device& device_;
  const GlVolumeJob& job_;
  const SlabKind& kind_;
  const std::stop_token stop_;
  const GridGeometry& grid_;
  std::vector<Slab> slabs_;
  double firstPlane_ = 0, lastPlane_ = 0;  // over all slabs, for the depth of iso-surfaces
  std::optional<GlInputs> inputs_;
  std::shared_ptr<const gpu::Program> program_;
};

Error cannot(std::string why) { return makeError(ErrorCode::NoTechnique, std::move(why)); }

std::uint64_t bytesOfSlice(const GlVolumeJob& job) {
  const std::uint64_t texel = job.shaded() ? kGradientBytes : gpu::bytesOfTexel(*job.volume, job.code);
  return texel * static_cast<std::uint64_t>(job.volume->grid().columns * job.volume->grid().rows);
}

// Chooses the slab's size, or says why there is none.
Result<void> takeSlabs(GlVolumeJob& job, const SlabKind& kind, const Capabilities& c) {
  const GridGeometry& g = job.volume->grid();
  const std::int64_t side = std::max(g.columns, g.rows);
  const std::int64_t limit = kind.strips ? (c.maxTexture > 0 ? c.maxTexture : 16384) : c.max3dTexture;
  if (side > limit)
    return cannot("The slices have " + std::to_string(side) + " voxels on a side; " +
                  (kind.strips ? "" : "3-D ") + "textures here take up to " + std::to_string(limit) + ".");
  const std::uint64_t budget = c.glTextureBudget_bytes;
  const std::optional<std::int64_t> size =
      slabSize(g.slices, bytesOfSlice(job), budget, kind.strips ? 2 : c.max3dTexture);
  if (!size)
    return cannot("Two slices of the volume need " + std::to_string((2 * bytesOfSlice(job)) >> 10) +
                  " KB as textures and GL may hold " + std::to_string(budget >> 10) + " KB.");
  job.slabSlices = *size;
  return {};
}

Result<void> checkSlabs(const GlVolumeJob& job, const Capabilities& c) {
  if (Result<void> r = checkPicture(job, c); !r) return r;
  if (job.extreme() && hasTranslucentTools(job))
    return cannot(
        "A tool that is translucent among the extremes of a volume is not drawn on GL; make it opaque.");
  if (job.classification == Classification::PreIntegrated && !job.iso && !job.extreme()) {
    if (job.slabSlices < job.volume->grid().slices)
      return cannot(
          "The values at both ends of a step may lie in two slabs; pre-integrated tables need the volume as "
          "one, and GL holds " +
          std::to_string(job.slabSlices) + " of its " + std::to_string(job.volume->grid().slices) +
          " slices.");
    if (job.shading != ShadingModel::None)
      return cannot("Slices with pre-integrated tables are not shaded; ask for rays.");
  }
  if (!job.combiner.empty()) return cannot("Combiners shade stacks; ask for them.");
  return {};
}

Result<std::vector<Pass>> passesFor(const SlabKind& kind, const Layer& layer, std::size_t index,
                                    const PlanContext& context) {
  Result<std::shared_ptr<GlVolumeJob>> made = glVolumeJob(layer, index, context);
  if (!made) return made.error();
  GlVolumeJob& job = **made;
  if (Result<void> r = takeSlabs(job, kind, context.capabilities); !r) return r.error();
  if (!kind.strips && job.slabSlices == job.volume->grid().slices && !job.shaded())
    chooseOpenClassification(job);
  if (Result<void> r = checkSlabs(job, context.capabilities); !r) return r.error();
  if (Result<void> r = checkParts(job, context); !r) return r.error();
  job.fixedFunction = job.fixedFunction && !job.shaded();
  const GridGeometry& g = job.volume->grid();
  const std::int64_t slabs = (g.slices - 2) / (job.slabSlices - 1) + 1;
  job.summary = std::to_string(slabs) + (kind.strips ? " strips of 2 slices"
                                                     : (slabs == 1 ? " slab of " : " slabs of ") +
                                                           std::to_string(job.slabSlices) + " slices");
  Pass pass;
  pass.name = (job.iso ? "iso-surface " : "volume ") + std::to_string(index);
  pass.inputs = {job.shaded() ? "gradient textures" : kind.strips ? "slice textures" : "slab textures"};
  if (!job.tools.empty()) pass.inputs.push_back("mesh");
  pass.outputs = {"colour", "depth"};
  if (context.view.wantValues) pass.outputs.push_back("values");
  pass.gl.blend = job.iso ? "off" : job.extreme() ? "max" : "remaining";
  pass.gl.depth = job.iso ? "nearest" : "off";
  const auto pixels =
      static_cast<std::uint64_t>(job.camera.width_px) * static_cast<std::uint64_t>(job.camera.height_px);
  const std::uint64_t slice = bytesOfSlice(job);
  pass.resources = {kind.strips ? Resource{"texture2d x " + std::to_string(g.slices),
                                           slice * static_cast<std::uint64_t>(g.slices)}
                                : Resource{"texture3d, one of " + std::to_string(slabs),
                                           slice * static_cast<std::uint64_t>(job.slabSlices)},
                    {"ray images", 32 * pixels}};
  if (job.outlines) pass.notes.push_back(kOutlinesNote);
  const auto known = context.costs.nsPerSample.find(kind.name);
  const double read = known != context.costs.nsPerSample.end() ? known->second
                      : job.fixedFunction                      ? kFixedRead_ns
                                                               : kRead_ns;
  // Polygons: each slab's slices, by the depth of one of them.
  const glm::dvec2 depths = depthsOf(glm::dvec3(0), glm::dvec3(g.columns - 1, g.rows - 1, job.slabSlices - 1),
                                     job.camera, g.patientFromVoxel);
  const double pieces = static_cast<double>(slabs) * ((depths.y - depths.x) / job.step_mm + 2);
  pass.predicted_ms =
      kSetUp_ms + kPolygon_ms * pieces + 1e-6 * (read + kFragment_ns) * raysLength_mm(job) / job.step_mm;
  pass.predictedError = 1.2 * predictedError(job, context.quality.step);
  pass.fixedFunctionFiltering = job.fixedFunction;
  pass.params = *made;
  return std::vector<Pass>{std::move(pass)};
}

Technique slabTechnique(Host& host, const SlabKind& kind) {
  Technique t;
  t.name = kind.name;
  t.kinds = {"volume", "isosurface"};
  t.engine = Engine::Gl;
  t.drawsParts = true;
  t.passesFor = [&kind](const Layer& layer, std::size_t index, const PlanContext& context) {
    return passesFor(kind, layer, index, context);
  };
  t.execute = [&host, &kind](const Pass& pass, Images& images, std::stop_token stop) -> Result<void> {
    const auto* job = dynamic_cast<const GlVolumeJob*>(pass.params.get());
    if (!job) return makeError(ErrorCode::Internal, "The pass has no parameters of a volume.", kind.name);
    Result<gpu::Device*> device = host.glDevice();
    if (!device) return device.error();
    const Counters before = (*device)->counters();
    if (Result<void> r = SlabPainter(**device, *job, kind, std::move(stop)).draw(pass.rays, images); !r)
      return r;
    addCounters(images.counters, before, (*device)->counters());
    return {};
  };
  return t;
}

constexpr SlabKind kSlabs{"dvr.slabs", false}, kStrips{"dvr.strips", true};

}  // namespace

Technique glSlabsTechnique(Host& host) { return slabTechnique(host, kSlabs); }
Technique glStripsTechnique(Host& host) { return slabTechnique(host, kStrips); }

}  // namespace vernier::dvr
