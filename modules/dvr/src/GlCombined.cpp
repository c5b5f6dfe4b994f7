// SPDX-License-Identifier: GPL-3.0-or-later
// dvr.combined: an object-aligned stack whose fragments a combiner computes (Rezk-Salama 2000, sections 5 to
// 8): layers that name one.
#include "CombinedText.h"
#include "DvrTechniques.h"
#include "StackPainter.h"

namespace vernier::dvr {
namespace {

Error cannot(std::string why) { return makeError(ErrorCode::NoTechnique, std::move(why)); }

Result<void> checkCombination(const GlVolumeJob& job) {
  const Combiner& c = *job.combination;
  const std::string name = "The combiner " + job.combiner;
  if (job.extreme()) return cannot(name + " blends; extremes of a volume are not its.");
  if (job.iso != (c.test == FragmentTest::Level))
    return cannot(name + (job.iso ? " does not test for a level, as an iso-surface needs."
                                  : " tests for a level, which iso-surfaces have."));
  if (job.iso && needsColours(c))
    return cannot(name + " asks for colours by value; an iso-surface has those of its material only.");
  if (job.volume->isColour() && (needsNormals(c) || job.iso))
    return cannot(name + " needs normals, and a colour volume has no values that would give them.");
  if (slicesPerPolygon(c) > kMostPerPolygon)
    return cannot(name + " takes " + std::to_string(slicesPerPolygon(c)) +
                  " slices on a polygon; GL here draws up to " + std::to_string(kMostPerPolygon) + ".");
  if (lightCount(c) > kMostLights)
    return cannot(name + " asks for " + std::to_string(lightCount(c)) + " lights; a scene has up to " +
                  std::to_string(kMostLights) + ".");
  if (job.classification == Classification::Pre && needsNormals(c))
    return cannot(name + " reads values beside normals; they are classified after interpolation only.");
  return {};
}

Result<std::vector<Pass>> passesFor(const Layer& layer, std::size_t index, const PlanContext& context) {
  Result<std::shared_ptr<GlVolumeJob>> made = glVolumeJob(layer, index, context);
  if (!made) return made.error();
  GlVolumeJob& job = **made;
  if (job.combiner.empty()) return cannot("The layer names no combiner.");
  Result<Combiner> found = findCombiner(job.combiner);
  if (!found) return found.error();
  job.combinationNeedsNormals = needsNormals(*found);
  job.combination = std::make_shared<const Combiner>(*std::move(found));
  if (Result<void> r = checkStack(job, context.capabilities); !r) return r.error();
  if (Result<void> r = checkCombination(job); !r) return r.error();
  const StackKind kind{"dvr.combined", slicesPerPolygon(*job.combination), true};
  Pass pass = stackPass(*made, kind, index, context);
  // The paper's light has no specular part, its normals are not made unit again between voxels.
  pass.predictedError += job.combinationNeedsNormals ? 20 : 1;
  return std::vector<Pass>{std::move(pass)};
}

}  // namespace

Technique glCombinedTechnique(Host& host) {
  return stackTechnique(host, {"dvr.combined", 1, true}, {"volume", "isosurface"}, passesFor);
}

}  // namespace vernier::dvr
