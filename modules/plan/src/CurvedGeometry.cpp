// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/CurvedGeometry.h"

#include "CurvedPath.h"
#include "Numbers.h"
#include "Vectors.h"

namespace vernier {
namespace {

constexpr double kFarthest_mm = 1e5;
constexpr double kWidest_mm = 1e4;
constexpr double kSlack_mm = 1e-6;  // a pixel's centre on the sheet's edge is on the sheet

Error degenerate(const std::string& sentence) { return makeError(ErrorCode::PathDegenerate, sentence); }

Result<void> checkPoints(const std::vector<PatientPoint>& path) {
  if (path.size() < 2)
    return degenerate("The path has " + std::to_string(path.size()) +
                      (path.size() == 1 ? " point" : " points") + "; give at least two.");
  if (path.size() > kMostPathPoints)
    return degenerate("The path has " + std::to_string(path.size()) + " points; give at most " +
                      std::to_string(kMostPathPoints) + ".");
  for (std::size_t n = 0; n < path.size(); ++n) {
    const glm::dvec3 p = path[n].p;
    if (!finite(p) || std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > kFarthest_mm)
      return degenerate("Point " + std::to_string(n + 1) +
                        " of the path is not a place within 100 m; correct it.");
  }
  return {};
}

// The patient axis, head before anterior before left, that is most across the path: across its first step
// (straightened) or its whole extent (stretched).
glm::dvec3 ownUp(const CurvedLayer& layer) {
  glm::dvec3 size(0);
  if (layer.form == CurvedForm::Straightened) {
    for (std::size_t n = 1; n < layer.path.size() && size == glm::dvec3(0); ++n)
      if (glm::length(layer.path[n].p - layer.path[0].p) >= kCoincident_mm)
        size = glm::abs(unit(layer.path[n].p - layer.path[0].p));
  } else {
    glm::dvec3 least = layer.path[0].p, greatest = least;
    for (const PatientPoint& p : layer.path) least = glm::min(least, p.p), greatest = glm::max(greatest, p.p);
    size = greatest - least;
  }
  const double tie = 1e-6 * (size.x + size.y + size.z);
  if (size.z <= std::min(size.x, size.y) + tie) return {0, 0, 1};
  return size.y <= size.x + tie ? glm::dvec3(0, -1, 0) : glm::dvec3(1, 0, 0);
}

Result<void> checkView(const CurvedLayer& layer, const Camera& camera, const View& view) {
  if (view.width_px < 1 || view.height_px < 1)
    return makeError(ErrorCode::SceneInvalid,
                     "The picture has no pixels; give it a width and a height above 0.");
  if (!(layer.width_mm > 0 && layer.width_mm <= kWidest_mm))
    return makeError(ErrorCode::SceneInvalid,
                     "The sheet of a curved reformat must be above 0 and at most 10000 mm wide.");
  const double height = camera.height_mm.value_or(1);
  if (!(camera.zoom > 0) || !std::isfinite(camera.zoom) || !(height > 0) || !std::isfinite(height) ||
      !std::isfinite(camera.pan_mm.x) || !std::isfinite(camera.pan_mm.y))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom and height_mm must be above 0, and finite.",
                     "/camera");
  return {};
}

std::vector<std::string> notesOn(const CurvedPath& path, double half_mm, double halfSlab_mm) {
  std::vector<std::string> notes;
  if (const CurvedPath::Overlap o = path.overlap(half_mm, halfSlab_mm); o.radius_mm > 0)
    notes.push_back("overlaps itself: radius " + rounded(o.radius_mm, 2) + " mm at " + rounded(o.at_mm, 3) +
                    " mm of the path");
  if (const double s = path.crossing(); s >= 0)
    notes.push_back("the path crosses itself at " + rounded(s, 3) + " mm");
  if (path.coincident() > 0)
    notes.push_back(std::to_string(path.coincident()) +
                    (path.coincident() == 1 ? " coincident point" : " coincident points") + " left out");
  return notes;
}

}  // namespace

Result<CurvedPicture> curvedPicture(const CurvedLayer& layer, const Camera& camera, const View& view) {
  if (Result<void> r = checkView(layer, camera, view); !r) return r.error();
  if (Result<void> r = checkPoints(layer.path); !r) return r.error();
  const glm::dvec3 up = layer.up ? unit(layer.up->v) : ownUp(layer);
  if (up == glm::dvec3(0))
    return degenerate("The up vector of the path has no length or is not finite; give a direction.");
  const bool stretched = layer.form == CurvedForm::Stretched;
  const Result<CurvedPath> path = CurvedPath::make(layer.path, up, stretched);
  if (!path) return path.error();

  CurvedPicture p;
  p.length_mm = path->length_mm();
  p.across_mm = layer.width_mm + (path->highest_mm() - path->lowest_mm());
  p.mmPerPixel = camera.height_mm ? *camera.height_mm / view.height_px
                                  : std::max(p.length_mm / view.width_px, p.across_mm / view.height_px);
  p.mmPerPixel /= camera.zoom;
  if (!(p.mmPerPixel > 0) || !std::isfinite(p.mmPerPixel))
    return makeError(ErrorCode::SceneInvalid, "The picture's scale is not a finite number above 0.");
  const double middle_mm = 0.5 * p.length_mm + camera.pan_mm.x;
  p.startColumn_px = 0.5 * view.width_px - middle_mm / p.mmPerPixel;
  p.centreRow_px = 0.5 * view.height_px + camera.pan_mm.y / p.mmPerPixel;
  p.columns.resize(static_cast<std::size_t>(view.width_px));
  for (int x = 0; x < view.width_px; ++x) {
    const double s = middle_mm + (x + 0.5 - 0.5 * view.width_px) * p.mmPerPixel;
    if (s < -kSlack_mm || s > p.length_mm + kSlack_mm) continue;
    const CurvedPath::At at = path->at(s);
    p.columns[static_cast<std::size_t>(x)] = {PatientPoint(at.point), PatientVec(-p.mmPerPixel * at.up),
                                              PatientVec(glm::cross(at.tangent, at.up)), true};
  }
  p.notes = notesOn(*path, 0.5 * layer.width_mm, 0.5 * layer.slab.thickness_mm);
  return p;
}

int CurvedPicture::firstRow(int height_px) const {
  const double y = centreRow_px - (0.5 * across_mm + kSlack_mm) / mmPerPixel;
  return static_cast<int>(std::clamp(std::ceil(y - 0.5), 0.0, static_cast<double>(height_px)));
}

int CurvedPicture::endRow(int height_px) const {
  const double y = centreRow_px + (0.5 * across_mm + kSlack_mm) / mmPerPixel;
  return std::max(firstRow(height_px),
                  static_cast<int>(std::clamp(std::floor(y - 0.5) + 1, 0.0, static_cast<double>(height_px))));
}

std::optional<PatientPoint> patientAt(const CurvedPicture& picture, glm::dvec2 pixel) {
  const double x = std::floor(pixel.x);
  if (!(x >= 0 && x < static_cast<double>(picture.columns.size()))) return std::nullopt;
  const CurvedColumn& column = picture.columns[static_cast<std::size_t>(x)];
  const double down_px = pixel.y - picture.centreRow_px;
  if (!column.shown || !(std::abs(down_px) * picture.mmPerPixel <= 0.5 * picture.across_mm + kSlack_mm))
    return std::nullopt;
  return column.centre + down_px * column.down;
}

EdgeLetters edgeLetters(const CurvedPicture& picture) {
  std::optional<EdgeLetters> all;
  for (const CurvedColumn& column : picture.columns) {
    if (!column.shown) continue;
    SlicePicture here;
    here.down = column.down;
    // right = up x normal
    here.right = PatientVec(glm::cross(column.normal.v, column.down.v));
    const EdgeLetters letters = edgeLetters(here);
    if (!all) all = letters;
    if (letters.right != all->right) all->left.clear(), all->right.clear();
    if (letters.bottom != all->bottom) all->top.clear(), all->bottom.clear();
  }
  return all.value_or(EdgeLetters{});
}

}  // namespace vernier
