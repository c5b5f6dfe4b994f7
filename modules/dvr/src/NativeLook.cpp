// SPDX-License-Identifier: GPL-3.0-or-later
#include "NativeLook.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace vernier::dvr {
namespace {

Error invalid(std::string why, std::string where) {
  return makeError(ErrorCode::SceneInvalid, std::move(why), std::move(where));
}

bool within01(double x) { return x >= 0 && x <= 1; }
bool within01(const Rgb& c) { return within01(c.r) && within01(c.g) && within01(c.b); }

Result<void> checkLights(const std::vector<Light>& lights) {
  if (lights.size() > kMostLights)
    return invalid("There may be at most " + std::to_string(kMostLights) + " lights.", "/lights");
  for (std::size_t n = 0; n < lights.size(); ++n) {
    const std::string where = "/lights/" + std::to_string(n);
    if (lights[n].towards) {
      const double size = length(*lights[n].towards);
      if (!(size > 0) || !std::isfinite(size))
        return invalid("A light needs a direction of finite numbers other than 0, 0, 0.", where + "/towards");
    }
    if (!within01(lights[n].colour))
      return invalid("The parts of a colour lie between 0 and 1.", where + "/colour");
  }
  return {};
}

}  // namespace

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

std::string exactNumber(double v) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, v).ptr);
}

Result<void> checkMaterial(const Material& m, const std::string& where) {
  for (const auto& [name, value] :
       {std::pair{"ambient", m.ambient}, std::pair{"diffuse", m.diffuse}, std::pair{"specular", m.specular}})
    if (!within01(value)) return invalid("The parts of a material lie between 0 and 1.", where + "/" + name);
  if (!(m.power >= 0 && m.power <= 1000))
    return invalid("The power lies between 0 and 1000.", where + "/power");
  if (!within01(m.ambientColour))
    return invalid("The parts of a colour lie between 0 and 1.", where + "/ambient_colour");
  if (!within01(m.diffuseColour))
    return invalid("The parts of a colour lie between 0 and 1.", where + "/diffuse_colour");
  return {};
}

Result<void> NativeLook::take(const std::string& source, const std::string& where,
                              const PlanContext& context) {
  const auto found = context.sources.volumes.find(source);
  if (found == context.sources.volumes.end() || !found->second)
    return invalid("The volume that the layer names is not loaded.", where + "/source");
  volume = found->second;
  const GridGeometry& grid = volume->grid();
  Result<std::vector<HalfSpace>> kept = keptRegion(context.scene, grid);
  if (!kept) return kept.error();
  Result<CameraPicture> picture = cameraPicture(context.scene.camera, context.view, cameraBox(grid));
  if (!picture) return picture.error();
  if (Result<void> ok = checkLights(context.scene.lights); !ok) return ok;
  const glm::dvec3 s = grid.spacing_mm();
  camera = *picture, region = std::move(*kept), tools = context.tools;
  lights = std::max<std::size_t>(context.scene.lights.size(), 1);
  step_mm = context.quality.step * std::min({s.x, s.y, s.z});
  wantValues = context.view.wantValues;
  return {};
}

std::string NativeLook::dumpCamera() const {
  return camera.projection == Projection::Perspective ? ", perspective" : ", orthographic";
}

std::string NativeLook::dumpLights() const { return ", lights " + std::to_string(lights); }

std::string NativeLook::dumpCuts() const {
  std::string s;
  if (region.size() > 6) s += ", cut by " + std::to_string(region.size() - 6) + " planes";
  if (!tools.empty()) s += ", tools " + std::to_string(tools.size());
  return s;
}

Pass NativeLook::pass(std::string name) const {
  Pass pass;
  pass.name = std::move(name);
  pass.inputs = {"volume"};
  pass.outputs = {"colour", "depth"};
  if (!tools.empty()) pass.inputs.push_back("mesh");
  return pass;
}

double NativeLook::predicted_ms(double ray_ns, double step_ns, const PlanContext& context) const {
  const double rays = static_cast<double>(camera.width_px) * static_cast<double>(camera.height_px);
  const double steps = 0.5 * cameraBox(volume->grid()).diagonal_mm / step_mm;
  return rays * (ray_ns + steps * step_ns) * 1e-6 / std::max(1, context.capabilities.threads);
}

Result<std::shared_ptr<const native::ProjectionBounds>> NativeLook::bounds(DerivedCache& cache) const {
  if (volume->isColour() || !volume->grid().even()) return std::shared_ptr<const native::ProjectionBounds>();
  return cache.get<native::ProjectionBounds>(
      {"projection bounds", volume->revision(), ""},
      [&]() -> Result<DerivedCache::Made<native::ProjectionBounds>> {
        Result<std::shared_ptr<const native::ProjectionBounds>> made = native::projectionBounds(*volume);
        if (!made) return made.error();
        return DerivedCache::Made<native::ProjectionBounds>{*made, native::bytesOfBounds(volume->grid())};
      });
}

Result<native::SurfaceHits> NativeLook::findTools(Images& images, std::stop_token stop) const {
  if (tools.empty()) return native::SurfaceHits{};
  Result<native::SurfaceHits> found = native::findSurfaces({tools, camera, glm::dvec3(0)}, stop);
  if (found) images.counters.triangles += found->counters.triangles;
  return found;
}

void NativeLook::allocateValues(Images& images) const {
  images.values.resize(static_cast<std::size_t>(camera.width_px) *
                       static_cast<std::size_t>(camera.height_px));
}

}  // namespace vernier::dvr
