// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Scene.h"

#include <cmath>

namespace vernier {
namespace {
std::string kind(const ImageLayer&) { return "image"; }
std::string kind(const SliceLayer&) { return "slice"; }
std::string kind(const CurvedLayer&) { return "curved"; }
std::string kind(const SurfaceLayer&) { return "surface"; }
std::string kind(const ProjectionLayer&) { return "projection"; }
std::string kind(const ShellsLayer&) { return "shells"; }
std::string kind(const CustomLayer& layer) { return layer.kind; }
}  // namespace

std::string kindOf(const Layer& layer) {
  return std::visit([](const auto& l) { return kind(l); }, layer);
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
