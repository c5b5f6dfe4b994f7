// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.stacks, dvr.stacks2, dvr.stacks4: object-aligned stacks of 2-D textures (Rezk-Salama 2000, sections 4
// to 7), with one, two or four slices on a polygon; dvr.stacks2-uncorrected maps both slices of a polygon as
// the first lies, for comparison (figure 13). Of the three stacks only the one that the view needs.
#include <algorithm>
#include <cmath>

#include "CombinedText.h"
#include "DvrTechniques.h"
#include "GlGradients.h"
#include "GlParts.h"
#include "Outlines.h"
#include "StackPainter.h"

namespace vernier::dvr {
namespace {

// Built-in costs on llvmpipe with two cores; the table of this machine wins.
constexpr double kRead_ns = 60.0, kFixedRead_ns = 25.0, kFragment_ns = 60.0, kPolygon_ms = 0.05,
                 kSetUp_ms = 12.0;
Error cannot(std::string why) { return makeError(ErrorCode::NoTechnique, std::move(why)); }

bool needsGradients(const GlVolumeJob& job) {
  return job.combination ? job.combinationNeedsNormals : job.shaded();
}

std::uint64_t bytesOfStack(const GlVolumeJob& job) {
  const GridGeometry& g = job.volume->grid();
  const std::uint64_t texel = needsGradients(job) ? kGradientBytes : gpu::bytesOfTexel(*job.volume, job.code);
  return texel * static_cast<std::uint64_t>(g.columns * g.rows * g.slices);
}

Result<std::vector<Pass>> passesFor(const StackKind& kind, const Layer& layer, std::size_t index,
                                    const PlanContext& context) {
  Result<std::shared_ptr<GlVolumeJob>> made = glVolumeJob(layer, index, context);
  if (!made) return made.error();
  const GlVolumeJob& job = **made;
  if (Result<void> r = checkStack(job, context.capabilities); !r) return r.error();
  if (Result<void> r = checkParts(job, context); !r) return r.error();
  if (!kind.corrected && (job.extreme() || job.iso))
    return cannot("Uncorrected polygons are there to be compared with corrected ones, in blended volumes.");
  if (!job.combiner.empty())
    return cannot("The layer is drawn by the combiner " + job.combiner + ", which dvr.combined does.");
  return std::vector<Pass>{stackPass(*made, kind, index, context)};
}

Technique ownRules(Host& host, const StackKind& kind) {
  return stackTechnique(host, kind, {"volume", "isosurface"},
                        [kind](const Layer& layer, std::size_t index, const PlanContext& context) {
                          return passesFor(kind, layer, index, context);
                        });
}

constexpr StackKind kOne{"dvr.stacks", 1, true}, kTwo{"dvr.stacks2", 2, true}, kFour{"dvr.stacks4", 4, true},
    kUncorrected{"dvr.stacks2-uncorrected", 2, false};
static_assert(kFour.perPolygon <= kMostPerPolygon);

}  // namespace

Result<void> checkStack(const GlVolumeJob& job, const Capabilities& c) {
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
  return {};
}

Pass stackPass(const std::shared_ptr<GlVolumeJob>& params, const StackKind& kind, std::size_t index,
               const PlanContext& context) {
  GlVolumeJob& job = *params;
  job.fixedFunction = job.fixedFunction && !needsGradients(job);
  const int axis = stackAxis(job.camera, job.volume->grid()), perVoxel = slicesPerVoxel(context.quality.step);
  const std::int64_t planes = sizeAlong(job.volume->grid(), axis), slices = (planes - 1) * perVoxel + 1;
  job.summary = std::string("stack across ") + "xyz"[axis] + " x" + std::to_string(perVoxel) + ", " +
                std::to_string(kind.perPolygon) + (kind.perPolygon > 1 ? " slices" : " slice") +
                " per polygon" + (kind.corrected ? "" : ", uncorrected");
  Pass pass;
  pass.name = (job.iso ? "iso-surface " : "volume ") + std::to_string(index);
  pass.inputs = {needsGradients(job) ? "gradient textures" : "slice textures"};
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
  if (job.outlines) pass.notes.push_back(kOutlinesNote);
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
  pass.params = params;
  return pass;
}

Technique stackTechnique(
    Host& host, StackKind kind, std::vector<std::string> kinds,
    std::function<Result<std::vector<Pass>>(const Layer&, std::size_t, const PlanContext&)> passes) {
  Technique t;
  t.name = kind.name;
  t.kinds = std::move(kinds);
  t.engine = Engine::Gl;
  t.drawsParts = true;
  t.passesFor = std::move(passes);
  t.execute = [&host, kind](const Pass& pass, Images& images, std::stop_token stop) -> Result<void> {
    const auto* job = dynamic_cast<const GlVolumeJob*>(pass.params.get());
    if (!job) return makeError(ErrorCode::Internal, "The pass has no parameters of a volume.", kind.name);
    Result<gpu::Device*> device = host.glDevice();
    if (!device) return device.error();
    StackKind as = kind;
    if (job->combination) as.perPolygon = slicesPerPolygon(*job->combination);
    return drawStack(**device, *job, as, pass.rays, images, std::move(stop));
  };
  return t;
}

Technique glStacksTechnique(Host& host) { return ownRules(host, kOne); }
Technique glStacks2Technique(Host& host) { return ownRules(host, kTwo); }
Technique glStacks4Technique(Host& host) { return ownRules(host, kFour); }
Technique glUncorrectedStacksTechnique(Host& host) { return ownRules(host, kUncorrected); }

}  // namespace vernier::dvr
