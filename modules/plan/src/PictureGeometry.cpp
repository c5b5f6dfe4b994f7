// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/PictureGeometry.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "Vectors.h"

namespace vernier {
namespace {

Error degenerate(const std::string& what) {
  return makeError(ErrorCode::PlaneDegenerate,
                   what + "; give a normal and an up vector that are not parallel to it.");
}

struct Extent {
  double right_mm = 0, up_mm = 0;  // largest distance from the centre
};

// How far the volume's box, with half a voxel of border, reaches from `centre` in the picture's directions.
// Slices of an uneven stack are taken where they are.
Extent extentAround(PatientPoint centre, glm::dvec3 right, glm::dvec3 up, const GridGeometry& grid) {
  Extent e;
  const auto take = [&](double x, double y, double z) {
    const glm::dvec3 d = (grid.patientFromVoxel * VoxelPoint(x, y, z)).p - centre.p;
    e.right_mm = std::max(e.right_mm, std::abs(glm::dot(d, right)));
    e.up_mm = std::max(e.up_mm, std::abs(glm::dot(d, up)));
  };
  const double lastColumn = static_cast<double>(grid.columns) - 0.5,
               lastRow = static_cast<double>(grid.rows) - 0.5;
  const auto takeSlice = [&](glm::dvec3 origin, double z) {
    for (double x : {-0.5, lastColumn})
      for (double y : {-0.5, lastRow}) take(x + origin.x, y + origin.y, z);
  };
  if (grid.even()) {
    takeSlice(glm::dvec3(0), -0.5);
    takeSlice(glm::dvec3(0), static_cast<double>(grid.slices) - 0.5);
  } else {
    takeSlice(grid.sliceOrigin_vox.front(), grid.firstPosition_vox() - 0.5);
    for (const glm::dvec3& origin : grid.sliceOrigin_vox) takeSlice(origin, origin.z);
    takeSlice(grid.sliceOrigin_vox.back(), grid.lastPosition_vox() + 0.5);
  }
  return e;
}

std::string opposite(const std::string& letters) {
  constexpr std::string_view from = "LRAPHF", to = "RLPAFH";
  std::string out = letters;
  for (char& c : out) c = to[from.find(c)];
  return out;
}

EdgeLetters aroundPicture(const std::string& right, const std::string& down) {
  return {opposite(right), right, opposite(down), down};
}

// Two values of Patient Orientation (0020,0020): direction of the rows, then of the columns.
std::optional<std::array<std::string, 2>> humanOrientation(const std::string& value) {
  const std::size_t bar = value.find('\\');
  if (bar == std::string::npos || value.find('\\', bar + 1) != std::string::npos) return std::nullopt;
  std::array<std::string, 2> both{value.substr(0, bar), value.substr(bar + 1)};
  for (std::string& s : both) {
    while (!s.empty() && s.back() == ' ') s.pop_back();
    while (!s.empty() && s.front() == ' ') s.erase(0, 1);
    if (s.empty() || s.size() > 3 || s.find_first_not_of("LRAPHF") != std::string::npos) return std::nullopt;
  }
  return both;
}

}  // namespace

Result<SlicePicture> slicePicture(const SliceLayer& layer, const Camera& camera, const View& view,
                                  const GridGeometry& grid) {
  if (view.width_px < 1 || view.height_px < 1)
    return makeError(ErrorCode::SceneInvalid,
                     "The picture has no pixels; give it a width and a height above 0.");
  if (!(camera.zoom > 0) || (camera.height_mm && !(*camera.height_mm > 0)))
    return makeError(ErrorCode::SceneInvalid, "The camera's zoom and height_mm must be above 0.", "/camera");
  if (!finite(layer.plane.point.p) || !std::isfinite(camera.zoom) || !std::isfinite(camera.pan_mm.x) ||
      !std::isfinite(camera.pan_mm.y) || (camera.height_mm && !std::isfinite(*camera.height_mm)))
    return degenerate("The plane's point or the camera is not finite");
  const glm::dvec3 normal = unit(layer.plane.normal.v);
  const glm::dvec3 wanted = unit(layer.plane.up.v);
  if (normal == glm::dvec3(0)) return degenerate("The plane's normal has no length or is not finite");
  if (wanted == glm::dvec3(0)) return degenerate("The plane's up vector has no length or is not finite");
  const glm::dvec3 across = glm::cross(wanted, normal);
  if (!(glm::length(across) >= kLeastAngle_rad))
    return degenerate("The plane's up vector is parallel to its normal");
  const glm::dvec3 right = glm::normalize(across);
  const glm::dvec3 up = glm::cross(normal, right);

  SlicePicture picture;
  if (camera.height_mm) {
    picture.mmPerPixel = *camera.height_mm / view.height_px;
  } else {
    const Extent e = extentAround(layer.plane.point, right, up, grid);
    picture.mmPerPixel = std::max(2 * e.right_mm / view.width_px, 2 * e.up_mm / view.height_px);
  }
  picture.mmPerPixel /= camera.zoom;
  if (!std::isfinite(picture.mmPerPixel) || !(picture.mmPerPixel > 0))
    return degenerate("The picture's scale is not a finite number above 0");
  picture.normal = PatientVec(normal);
  picture.right = PatientVec(right * picture.mmPerPixel);
  picture.down = PatientVec(-up * picture.mmPerPixel);
  const glm::dvec3 centre = layer.plane.point.p + right * camera.pan_mm.x + up * camera.pan_mm.y;
  picture.origin = PatientPoint(centre - picture.right.v * (0.5 * view.width_px) -
                                picture.down.v * (0.5 * view.height_px));
  return picture;
}

PatientPoint patientAt(const SlicePicture& picture, glm::dvec2 pixel) {
  return picture.origin + pixel.x * picture.right + pixel.y * picture.down;
}

glm::dvec2 pixelAt(const SlicePicture& picture, PatientPoint point) {
  const PatientVec d = point - picture.origin;
  return {dot(d, picture.right) / dot(picture.right, picture.right),
          dot(d, picture.down) / dot(picture.down, picture.down)};
}

namespace {

// Steps between columns (x) and rows (y), in mm or in columns, and whether they are mm.
struct PixelShape {
  glm::dvec2 step{1, 1};
  bool known = false;
};

PixelShape pixelShape(const ImageFrameInfo& frame, const FramePresentation* presentation) {
  const auto usable = [](double mm) { return mm >= 1e-4 && mm <= 1e3; };
  PixelShape shape;
  glm::dvec2 spacing = frame.pixelSpacing_mm;  // row\column: between rows, then between columns
  const bool asked = presentation && presentation->area;
  if (asked && presentation->area->pixelSpacing_mm) spacing = *presentation->area->pixelSpacing_mm;
  shape.known = usable(spacing.x) && usable(spacing.y);
  if (shape.known) shape.step = {spacing.y, spacing.x};
  if (asked && !presentation->area->pixelSpacing_mm && presentation->area->pixelAspect) {
    const glm::dvec2 aspect = *presentation->area->pixelAspect;  // vertical\horizontal
    const double rows = shape.step.x * aspect.x / aspect.y;
    // A shape that contradicts the image's spacing leaves no length that could be trusted.
    if (std::abs(rows - shape.step.y) > 0.01 * shape.step.y) shape.known = false;
    shape.step.y = rows;
  }
  return shape;
}

// What is to fill the picture: columns and rows from `least` to `greatest`, edges of pixels.
struct Shown {
  glm::dvec2 least{-0.5}, greatest{0};
};

Shown shownArea(const ImageFrameInfo& frame, const FramePresentation* presentation) {
  Shown s;
  s.greatest = {static_cast<double>(frame.columns) - 0.5, static_cast<double>(frame.rows) - 0.5};
  if (presentation && presentation->area) {
    const DisplayedArea& a = *presentation->area;
    s.least = glm::min(a.topLeft, a.bottomRight) - 1.5;
    s.greatest = glm::max(a.topLeft, a.bottomRight) - 0.5;
  }
  return s;
}

}  // namespace

ImagePicture imagePicture(const ImageLayer& layer, const Camera& camera, const View& view,
                          const ImageFrameInfo& frame, const FramePresentation* presentation) {
  const int turn_deg = presentation ? presentation->rotation_deg : 0;
  const PixelShape shape = pixelShape(frame, presentation);
  const Shown shown = shownArea(frame, presentation);
  ImagePicture p;
  p.transposed = turn_deg == 90 || turn_deg == 270;
  glm::dvec2 size = (shown.greatest - shown.least) * shape.step;
  if (p.transposed) size = {size.y, size.x};
  double perPixel = std::max(size.x / view.width_px, size.y / view.height_px);  // mm, or columns
  if (presentation && presentation->area && presentation->area->mode == AreaMode::Magnify)
    perPixel = shape.step.x / presentation->area->magnification;
  if (shape.known && camera.height_mm) perPixel = *camera.height_mm / view.height_px;
  perPixel /= camera.zoom;

  p.pxPerColumn = shape.step.x / perPixel;
  p.pxPerRow = shape.step.y / perPixel;
  p.mmPerPixel = shape.known ? perPixel : 0;
  if (turn_deg == 180 || turn_deg == 270) p.pxPerColumn = -p.pxPerColumn;
  if (turn_deg == 90 || turn_deg == 180) p.pxPerRow = -p.pxPerRow;
  double& alongX = p.transposed ? p.pxPerRow : p.pxPerColumn;
  double& alongY = p.transposed ? p.pxPerColumn : p.pxPerRow;
  if (layer.flipHorizontal != (presentation && presentation->flipHorizontal)) alongX = -alongX;
  if (layer.flipVertical) alongY = -alongY;
  const glm::dvec2 middle = 0.5 * (shown.least + shown.greatest) + 0.5;
  p.x0 = 0.5 * view.width_px - camera.pan_mm.x / perPixel - (p.transposed ? middle.y : middle.x) * alongX;
  p.y0 = 0.5 * view.height_px + camera.pan_mm.y / perPixel - (p.transposed ? middle.x : middle.y) * alongY;
  return p;
}

glm::dvec2 frameFromPicture(const ImagePicture& p, glm::dvec2 pixel) {
  const glm::dvec2 at(pixel.x - p.x0, pixel.y - p.y0);
  return {(p.transposed ? at.y : at.x) / p.pxPerColumn - 0.5,
          (p.transposed ? at.x : at.y) / p.pxPerRow - 0.5};
}

glm::dvec2 pictureFromFrame(const ImagePicture& p, glm::dvec2 columnRow) {
  const double c = (columnRow.x + 0.5) * p.pxPerColumn, r = (columnRow.y + 0.5) * p.pxPerRow;
  return {p.x0 + (p.transposed ? r : c), p.y0 + (p.transposed ? c : r)};
}

bool isMirrored(const ImagePicture& p) { return (p.pxPerColumn * p.pxPerRow < 0) != p.transposed; }

Result<std::optional<FramePresentation>> presentationOf(const ImageLayer& layer, const ImageFrameInfo& frame,
                                                        const Sources& sources) {
  if (layer.presentation.empty()) return std::optional<FramePresentation>{};
  const auto found = sources.presentations.find(layer.presentation);
  if (found == sources.presentations.end() || !found->second)
    return makeError(ErrorCode::SceneInvalid,
                     "The presentation state that the image layer names is not among what was opened.",
                     "presentation");
  Result<FramePresentation> p = presentationFor(*found->second, frame.sopInstanceUid, frame.frameNumber);
  if (!p) return p.error();
  return std::optional<FramePresentation>(std::move(*p));
}

std::string lettersOf(PatientVec direction) {
  const glm::dvec3 d = unit(direction.v);
  std::array<int, 3> order{0, 1, 2};
  // Components that differ by rounding only count as equal, so that a diagonal always reads the same.
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return std::abs(d[a]) > std::abs(d[b]) + 1e-9; });
  constexpr char positive[] = {'L', 'P', 'H'}, negative[] = {'R', 'A', 'F'};
  std::string letters;
  for (int axis : order)
    if (std::abs(d[axis]) > 0.1) letters += d[axis] > 0 ? positive[axis] : negative[axis];
  return letters;
}

EdgeLetters edgeLetters(const SlicePicture& picture) {
  return aroundPicture(lettersOf(picture.right), lettersOf(picture.down));
}

EdgeLetters edgeLetters(const ImagePicture& picture, const ImageFrameInfo& frame) {
  std::string right, down;
  if (frame.plane) {
    right = lettersOf(frame.plane->rowDirection);
    down = lettersOf(frame.plane->columnDirection);
  } else if (const auto both = humanOrientation(frame.patientOrientation)) {
    right = (*both)[0];
    down = (*both)[1];
  }
  if (picture.pxPerColumn < 0) right = opposite(right);
  if (picture.pxPerRow < 0) down = opposite(down);
  return picture.transposed ? aroundPicture(down, right) : aroundPicture(right, down);
}

}  // namespace vernier
