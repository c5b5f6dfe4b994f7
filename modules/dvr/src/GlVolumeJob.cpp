// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlVolumeJob.h"

#include <algorithm>
#include <cmath>

#include "ChooseClassification.h"
#include "NativeLook.h"
#include "SamplingError.h"

namespace vernier::dvr {
namespace {

Error cannot(std::string why) { return makeError(ErrorCode::NoTechnique, std::move(why)); }
Error invalid(std::string why, std::string where) {
  return makeError(ErrorCode::SceneInvalid, std::move(why), std::move(where));
}

// As dvr.native takes them.
Result<void> takeColours(const VolumeLayer& layer, const std::string& where, GlVolumeJob& job) {
  if (layer.transfer || !layer.preset.empty())
    return invalid("A colour volume has its own colours and takes no transfer function.",
                   where + (layer.transfer ? "/transfer" : "/preset"));
  if (job.shading != ShadingModel::None)
    return cannot("A colour volume has no single values whose gradient could be lit.");
  if (layer.classification && *layer.classification != Classification::Post)
    return cannot("A colour volume has no values that could be classified.");
  for (std::size_t c = 0; c < 4; ++c)
    if (!(layer.gains[c] >= 0) || !std::isfinite(layer.gains[c]))
      return invalid("A gain is a number not below 0.", where + "/gains/" + std::to_string(c));
  return {};
}

Result<void> takeVolume(const VolumeLayer& layer, const std::string& where, GlVolumeJob& job) {
  job.mode = layer.mode, job.gains = layer.gains, job.opacity = layer.opacity;
  job.interpolation = layer.interpolation, job.shading = layer.shading, job.material = layer.material;
  job.combiner = layer.combiner, job.outlines = layer.outlines;
  if (!job.combiner.empty()) job.shading = ShadingModel::None;
  job.classification = layer.classification.value_or(Classification::Post);
  if (Result<void> r = checkMaterial(layer.material, where + "/material"); !r) return r;
  if (layer.interpolation == Interpolation::Cubic)
    return cannot("Volumes are interpolated nearest or linear.");
  if (job.extreme() && job.shading != ShadingModel::None)
    return cannot("A greatest or least value has no face that could be lit.");
  if (job.volume->isColour()) return takeColours(layer, where, job);
  if (layer.classification == Classification::PreIntegrated && layer.opacity == OpacityRule::Linear)
    return cannot(
        "Pre-integrated tables hold exact opacities; the linear rule is for the other classifications.");
  job.classificationOpen = !layer.classification && job.mode == VolumeMode::Blend &&
                           layer.opacity == OpacityRule::Exact &&
                           layer.interpolation == Interpolation::Linear;
  if (layer.transfer) {
    job.transfer = *layer.transfer;
    const Result<void> ok = checkTransferFunction(job.transfer);
    if (!ok) return invalid(ok.error().sentence, where + "/transfer" + ok.error().where);
    return {};
  }
  Result<TransferFunction> f =
      transferPreset(layer.preset.empty() ? defaultTransferPreset(*job.volume) : layer.preset, *job.volume);
  if (!f) return invalid(f.error().sentence, where + "/preset");
  job.transfer = *std::move(f);
  return {};
}

Result<void> takeIso(const IsosurfaceLayer& layer, const std::string& where, GlVolumeJob& job) {
  if (layer.level && !std::isfinite(*layer.level))
    return invalid("The level must be a finite number.", where + "/level");
  if (Result<void> r = checkMaterial(layer.material, where + "/material"); !r) return r;
  if (job.volume->isColour()) return cannot("A colour volume has no iso-surfaces.");
  job.iso = true, job.material = layer.material, job.combiner = layer.combiner;
  job.level = layer.level.value_or(defaultIsoLevel(*job.volume));
  return {};
}

}  // namespace

double GlVolumeJob::smallestSpacing_mm() const {
  const glm::dvec3 s = volume->grid().spacing_mm();
  return std::min(s.x, std::min(s.y, s.z));
}

std::string GlVolumeJob::dump() const {
  constexpr const char* modes[] = {"blend", "max", "min"};
  constexpr const char* classes[] = {"post", "pre", "pre-integrated"};
  constexpr const char* models[] = {"", ", global ambient", ", colour per voxel"};
  std::string s = iso ? "iso " + number(level) : modes[static_cast<int>(mode)];
  s += perspective() ? ", perspective" : ", orthographic";
  s += walksCells ? ", cell by cell" : ", step " + number(step_mm) + " mm";
  if (!iso && volume->isColour()) s += ", RGBA";
  if (!iso && !volume->isColour()) s += std::string(", ") + classes[static_cast<int>(classification)];
  if (opacity == OpacityRule::Linear) s += ", linear opacity";
  if (interpolation == Interpolation::Nearest) s += ", nearest";
  s += models[static_cast<int>(shading)];
  if (!combiner.empty()) s += ", combiner " + combiner;
  if (shaded()) s += ", lights " + std::to_string(lights.size());
  if (region.size() > 6) s += ", cut by " + std::to_string(region.size() - 6) + " planes";
  if (!tools.empty()) s += ", tools " + std::to_string(tools.size());
  if (outlines) s += ", outlines";
  if (!summary.empty()) s += "; " + summary;
  return s;
}

Result<std::shared_ptr<GlVolumeJob>> glVolumeJob(const Layer& any, std::size_t index,
                                                 const PlanContext& context) {
  const std::string* source = volumeOf(any);
  const auto* layer = std::get_if<VolumeLayer>(&any);
  const auto* iso = std::get_if<IsosurfaceLayer>(&any);
  if (!source || (!layer && !iso)) return makeError(ErrorCode::SceneInvalid, "The layer is no volume.");
  const std::string where = "/layers/" + std::to_string(index);
  const auto found = context.sources.volumes.find(*source);
  if (found == context.sources.volumes.end() || !found->second)
    return invalid("The volume that the layer names is not loaded.", where + "/source");
  auto job = std::make_shared<GlVolumeJob>();
  job->volume = found->second;
  const GridGeometry& grid = job->volume->grid();
  Result<std::vector<HalfSpace>> region = keptRegion(context.scene, grid);
  if (!region) return region.error();
  Result<CameraPicture> camera = cameraPicture(context.scene.camera, context.view, cameraBox(grid));
  if (!camera) return camera.error();
  if (Result<void> r = layer ? takeVolume(*layer, where, *job) : takeIso(*iso, where, *job); !r)
    return r.error();
  if (!grid.even())
    return cannot("The slices are unevenly spaced or have gaps, and textures here know even spacing only.");
  if (!job->volume->isColour()) {
    Result<gpu::TexelCode> code = gpu::texelCode(*job->volume);
    if (!code) return code.error();
    job->code = *code;
  }
  job->camera = *camera, job->region = std::move(*region), job->tools = context.tools;
  std::erase_if(job->tools, [](const PlacedSurface& t) { return !(t.opacity > 0); });
  const Rgb& b = context.scene.background;
  job->background = {b.r, b.g, b.b};
  job->lights = context.scene.lights.empty() ? std::vector<Light>{Light{}} : context.scene.lights;
  job->step_mm = context.quality.step * job->smallestSpacing_mm();
  job->wantValues = context.view.wantValues;
  if (context.quality.level == QualityLevel::Reference) job->leastLight = native::kReferenceLeastLight;
  job->fixedFunction = context.quality.level == QualityLevel::Draft && !job->volume->isColour() &&
                       !job->iso && job->classification != Classification::Pre &&
                       gpu::mayUseFixedFunction(*job->volume, job->interpolation);
  return job;
}

Result<void> checkPicture(const GlVolumeJob& job, const Capabilities& c) {
  const int largest = std::max(job.camera.width_px, job.camera.height_px);
  if (c.maxTexture > 0 && largest > c.maxTexture)
    return cannot("The picture has " + std::to_string(largest) + " pixels on a side; GL here draws up to " +
                  std::to_string(c.maxTexture) + ".");
  return {};
}

Result<void> checkWhole3dTexture(const GlVolumeJob& job, const Capabilities& c) {
  const GridGeometry& g = job.volume->grid();
  const std::int64_t largest = std::max({g.columns, g.rows, g.slices});
  if (largest > c.max3dTexture)
    return cannot("The volume has " + std::to_string(largest) +
                  " voxels on a side; 3-D textures here take up to " + std::to_string(c.max3dTexture) + ".");
  const std::uint64_t bytes =
      gpu::bytesOfTexel(*job.volume, job.code) * static_cast<std::uint64_t>(g.columns * g.rows * g.slices);
  if (bytes > c.glTextureBudget_bytes)
    return cannot("The volume needs " + std::to_string(bytes >> 20) + " MB as a texture and GL may hold " +
                  std::to_string(c.glTextureBudget_bytes >> 20) + " MB; slabs take it in parts.");
  return {};
}

bool hasTranslucentTools(const GlVolumeJob& job) {
  return std::any_of(job.tools.begin(), job.tools.end(),
                     [](const PlacedSurface& t) { return t.opacity < 1; });
}

void chooseOpenClassification(GlVolumeJob& job) {
  if (job.classificationOpen)
    job.classification = chooseClassification(*job.volume, job.transfer, job.step_mm);
}

Result<TransferTable> tableOf(const GlVolumeJob& job, double step_mm) {
  const Volume::Range values = job.volume->modalityRange().value_or(Volume::Range{0, 1});
  return makeTransferTable(job.transfer, transferTableRange(job.transfer, values), step_mm,
                           job.opacity == OpacityRule::Linear);
}

double predictedError(const GlVolumeJob& job, double step) {
  const double own = 0.02 + (job.fixedFunction ? 255 * 3.0 / 512 : 0);
  if (job.iso) return own + (job.walksCells ? 0.5 : 4 * step);
  return own + samplingError(job.mode, job.shading, job.opacity, job.walksCells, step);
}

double readsPerSample(const GlVolumeJob& job) {
  return !job.iso && job.shading != ShadingModel::None ? 7 : 1;
}

double raysLength_mm(const GlVolumeJob& job) {
  // Of a coarse raster of rays.
  constexpr int kRaster = 16;
  double sum = 0;
  for (int j = 0; j < kRaster; ++j)
    for (int i = 0; i < kRaster; ++i) {
      const double x = (i + 0.5) * job.camera.width_px / kRaster,
                   y = (j + 0.5) * job.camera.height_px / kRaster;
      const RaySpan span =
          spanOf(job.camera.ray(x, y), job.region, job.camera.near_mm * job.camera.rayPerDepth(x, y));
      if (!span.empty()) sum += span.exit_mm - span.entry_mm;
    }
  return sum / (kRaster * kRaster) * job.camera.width_px * job.camera.height_px;
}

}  // namespace vernier::dvr
