// SPDX-License-Identifier: GPL-3.0-or-later
#include "SceneEdits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

constexpr double kOnSlice_mm = 1e-3;
constexpr double kLeastZoom = 0.05, kMostZoom = 200;
constexpr double kZoomPerPixel = 0.01;  // e-fold in 100 px
constexpr double kTurn_degPerPixel = 0.5;

template <class T>
T* topmost(Scene& scene) {
  for (auto layer = scene.layers.rbegin(); layer != scene.layers.rend(); ++layer)
    if (auto* found = std::get_if<T>(&*layer)) return found;
  return nullptr;
}
template <class T>
const T* topmost(const Scene& scene) {
  return topmost<T>(const_cast<Scene&>(scene));
}

// How far slice k's plane lies from the layer's, along its unit normal.
double offset_mm(const SliceLayer& layer, const GridGeometry& grid, std::int64_t k) {
  const glm::dvec3 n = glm::normalize(layer.plane.normal.v);
  return glm::dot(n, slicePoint(grid, layer.plane.normal, k).p - layer.plane.point.p);
}

}  // namespace

const ImageLayer* imageOf(const Scene& scene) { return topmost<ImageLayer>(scene); }
const SliceLayer* sliceOf(const Scene& scene) { return topmost<SliceLayer>(scene); }

const Layer* lookOf(const Scene& scene) {
  for (auto layer = scene.layers.rbegin(); layer != scene.layers.rend(); ++layer)
    if (looksThroughVolume(*layer)) return &*layer;
  return nullptr;
}

bool needsVolume(const Scene& scene) { return sliceOf(scene) || lookOf(scene); }

std::optional<VoiWindow>* windowOf(Layer& layer) {
  return std::visit(
      [](auto& l) -> std::optional<VoiWindow>* {
        if constexpr (requires { l.window; })
          return &l.window;
        else
          return nullptr;
      },
      layer);
}

bool* inversionOf(Layer& layer) {
  return std::visit(
      [](auto& l) -> bool* {
        if constexpr (requires { l.invert; })
          return &l.invert;
        else
          return nullptr;
      },
      layer);
}

Scene withSource(Scene scene, const std::string& source) {
  for (Layer& layer : scene.layers)
    std::visit(
        [&](auto& l) {
          using L = std::remove_cvref_t<decltype(l)>;
          if constexpr (requires { l.source; } && !std::is_same_v<L, SurfaceLayer>) l.source = source;
        },
        layer);
  return scene;
}

Scene scrolledImage(Scene scene, int notches, std::int64_t count) {
  if (auto* image = topmost<ImageLayer>(scene); image && count > 0)
    image->index = std::clamp<std::int64_t>(image->index + notches, 0, count - 1);
  return scene;
}

Scene scrolledSlice(Scene scene, int notches, const GridGeometry& grid) {
  auto* layer = topmost<SliceLayer>(scene);
  const std::int64_t count = layer ? sliceAxis(grid, layer->plane.normal).count : 0;
  if (count == 0 || notches == 0) return scene;
  // Slice offsets rise or fall with their number; `at` is the last slice at or before the plane in number.
  const double direction = offset_mm(*layer, grid, count - 1) >= offset_mm(*layer, grid, 0) ? 1 : -1;
  std::int64_t before = -1;
  for (std::int64_t lo = 0, hi = count - 1; lo <= hi;) {
    const std::int64_t mid = (lo + hi) / 2;
    if (direction * offset_mm(*layer, grid, mid) <= kOnSlice_mm)
      before = mid, lo = mid + 1;
    else
      hi = mid - 1;
  }
  const bool on = before >= 0 && std::abs(offset_mm(*layer, grid, before)) <= kOnSlice_mm;
  // Between two slices the first notch back reaches `before`, the first one forth `before + 1`.
  const std::int64_t from = on || notches > 0 ? before : before + 1;
  const std::int64_t to = std::clamp<std::int64_t>(from + notches, 0, count - 1);
  layer->plane = through(layer->plane, slicePoint(grid, layer->plane.normal, to));
  return scene;
}

std::optional<std::int64_t> sliceNumber(const SliceLayer& layer, const GridGeometry& grid) {
  const std::int64_t count = sliceAxis(grid, layer.plane.normal).count;
  for (std::int64_t k = 0; k < count; ++k)
    if (std::abs(offset_mm(layer, grid, k)) <= kOnSlice_mm) return k;
  return std::nullopt;
}

VoiWindow draggedWindow(const VoiWindow& from, glm::dvec2 drag_px, bool inverted, double scale) {
  const glm::dvec2 hand = drag_px / scale;
  const double unit = from.width / 500;
  VoiWindow w = from;
  // A LINEAR window is at least 1 wide (PS3.3 C.11.2.1.2); others only need to stay above zero.
  const double least = from.function == VoiFunction::Linear ? 1.0 : from.width / 1000;
  w.width = std::max(std::min(least, from.width), from.width + hand.x * unit);
  w.center = from.center + (inverted ? -1 : 1) * hand.y * unit;
  w.explanation.clear();
  return w;
}

Scene withWindow(Scene scene, const VoiWindow& window) {
  if (auto* slice = topmost<SliceLayer>(scene)) slice->window = window;
  if (auto* image = topmost<ImageLayer>(scene)) image->window = window, image->voiLut.reset();
  return scene;
}

Scene withInversion(Scene scene, bool inverted) {
  if (auto* slice = topmost<SliceLayer>(scene)) slice->invert = inverted;
  if (auto* image = topmost<ImageLayer>(scene)) image->invert = inverted;
  return scene;
}

Scene panned(Scene scene, glm::dvec2 drag_px, double unit_mm) {
  scene.camera.pan_mm += glm::dvec2(-drag_px.x, drag_px.y) * unit_mm;
  return scene;
}

Scene zoomed(Scene scene, glm::dvec2 drag_px, glm::dvec2 fromCentre_px, double unit_mm, double scale) {
  const double before = scene.camera.zoom;
  const double after =
      std::clamp(before * std::exp(-drag_px.y / scale * kZoomPerPixel), kLeastZoom, kMostZoom);
  scene.camera.zoom = after;
  const double shift = unit_mm * (1 - before / after);
  scene.camera.pan_mm += glm::dvec2(fromCentre_px.x, -fromCentre_px.y) * shift;
  return scene;
}

Scene turned(Scene scene, glm::dvec2 drag_px, double scale) {
  Camera& c = scene.camera;
  const glm::dvec2 hand = drag_px * (kTurn_degPerPixel / scale);
  // As the camera's own right and up see the hand: rolled clockwise, its right points down on the screen.
  const double roll = glm::radians(c.roll_deg);
  const double right = std::cos(roll) * hand.x - std::sin(roll) * hand.y;
  const double down = std::sin(roll) * hand.x + std::cos(roll) * hand.y;
  c.azimuth_deg = std::remainder(c.azimuth_deg - right, 360.0);
  c.elevation_deg = std::clamp(c.elevation_deg + down, -90.0, 90.0);
  return scene;
}

TransferFunction draggedTransfer(const TransferFunction& from, glm::dvec2 drag_px, double scale) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  const auto meet = [&](double v) { lo = std::min(lo, v), hi = std::max(hi, v); };
  for (const ColourPoint& p : from.colours) meet(p.value);
  for (const OpacityPoint& p : from.opacities) meet(p.value);
  if (!(hi > lo)) return from;
  const VoiWindow before{0.5 * (lo + hi), hi - lo, VoiFunction::LinearExact, ""};
  const VoiWindow after = draggedWindow(before, drag_px, false, scale);
  TransferFunction f = from;
  const auto map = [&](double v) {
    return after.center + (v - before.center) * (after.width / before.width);
  };
  for (ColourPoint& p : f.colours) p.value = map(p.value);
  for (OpacityPoint& p : f.opacities) p.value = map(p.value);
  return f;
}

Plane through(Plane plane, PatientPoint p) {
  const PatientVec n = normalize(plane.normal);
  plane.point = plane.point + dot(p - plane.point, n) * n;
  return plane;
}

}  // namespace vernier::ui
