// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Scene.h"

#include <cmath>
#include <type_traits>

namespace vernier {
namespace {
std::string kind(const ImageLayer&) { return "image"; }
std::string kind(const SliceLayer&) { return "slice"; }
std::string kind(const CurvedLayer&) { return "curved"; }
std::string kind(const SurfaceLayer&) { return "surface"; }
std::string kind(const ProjectionLayer&) { return "projection"; }
std::string kind(const ShellsLayer&) { return "shells"; }
std::string kind(const VolumeLayer&) { return "volume"; }
std::string kind(const IsosurfaceLayer&) { return "isosurface"; }
std::string kind(const LensLayer&) { return "lens"; }
std::string kind(const CustomLayer& layer) { return layer.kind; }

template <class L>
concept ReadsVolume =
    std::is_same_v<L, SliceLayer> || std::is_same_v<L, CurvedLayer> || std::is_same_v<L, ProjectionLayer> ||
    std::is_same_v<L, ShellsLayer> || std::is_same_v<L, VolumeLayer> || std::is_same_v<L, IsosurfaceLayer>;
}  // namespace

std::string kindOf(const Layer& layer) {
  return std::visit([](const auto& l) { return kind(l); }, layer);
}

bool looksThroughVolume(const Layer& layer) {
  return std::holds_alternative<ProjectionLayer>(layer) || std::holds_alternative<ShellsLayer>(layer) ||
         std::holds_alternative<VolumeLayer>(layer) || std::holds_alternative<IsosurfaceLayer>(layer);
}

const std::string* volumeOf(const Layer& layer) {
  return std::visit(
      [](const auto& l) -> const std::string* {
        if constexpr (ReadsVolume<std::remove_cvref_t<decltype(l)>>)
          return &l.source;
        else
          return nullptr;
      },
      layer);
}

Result<void> checkPose(const PatientFromMesh& pose) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      if (!std::isfinite(column < 3 ? pose.linear[column][row] : pose.translation[row]))
        return makeError(ErrorCode::SceneInvalid, "The pose holds a number that is not finite.");
  const double volume = glm::determinant(pose.linear);
  if (!std::isfinite(volume) || volume == 0)
    return makeError(ErrorCode::SceneInvalid,
                     "The pose flattens the surface: its 3x3 part must have a determinant other than 0.");
  return {};
}

}  // namespace vernier
