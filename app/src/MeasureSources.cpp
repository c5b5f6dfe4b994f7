// SPDX-License-Identifier: GPL-3.0-or-later
#include "MeasureSources.h"

#include <algorithm>

#include "vernier/volume/IsoSurface.h"

namespace vernier::app {
namespace {

using MeshResult = Result<std::shared_ptr<const Mesh>>;

Result<measure::Image> imageOf(Session& session, const std::string& source, std::int64_t frame) {
  const auto image = session.image(source, frame);
  if (!image) return image.error();
  measure::Image out{*image, {}, {}};
  const Result<StackChoice> choice = session.choose(source);
  const Stack* const stack = source.empty() ? session.chosenStack()
                             : choice       ? session.stackOf(*choice)
                                            : nullptr;
  if (!stack || frame < 0 || frame >= static_cast<std::int64_t>(stack->slices.size())) return out;
  const SliceRef slice = stack->slices[static_cast<std::size_t>(frame)];
  Result<PixelCalibration> calibration = pixelCalibration(session.study(), slice.instance);
  if (!calibration) return calibration.error();
  out.calibration = std::move(*calibration);
  out.frameOfReferenceUid = session.study().instances[slice.instance].frameOfReferenceUid;
  return out;
}

}  // namespace

measure::Sources measureSources(Session& session, std::stop_token stop) {
  measure::Sources s;
  s.volume = [&session, stop](const std::string& source) { return session.volume(source, {}, stop); };
  s.image = [&session](const std::string& source, std::int64_t frame) {
    return imageOf(session, source, frame);
  };
  s.surface = [&session](const std::string& name) -> MeshResult {
    const auto file = session.surface(name);
    if (file) return file->mesh;
    return makeError(ErrorCode::OptionInvalid,
                     "There is no surface of the name '" + name + "'; open it with --surface.");
  };
  const auto cache = std::make_shared<DerivedCache>(std::uint64_t{256} << 20);
  s.isoSurface = [&session, stop, cache](const std::string& source, double level) -> MeshResult {
    const auto volume = session.volume(source, {}, stop);
    if (!volume) return volume.error();
    const Result<IsoSurfaces> made = isoSurfaces(**volume, std::array{level}, *cache, stop);
    if (!made) return made.error();
    return made->meshes.front();
  };
  return s;
}

Result<void> measuringPlugin(const Session& session) {
  const auto& all = session.plugins();
  if (std::any_of(all.begin(), all.end(),
                  [](const PluginInfo& p) { return p.name == "measure" && p.state == PluginState::Loaded; }))
    return {};
  return makeError(
      ErrorCode::PluginMissing,
      "Measuring needs the plugin `measure`; `vernier plugins` tells where plugins are looked for.",
      "measure");
}

}  // namespace vernier::app
