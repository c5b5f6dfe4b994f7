// SPDX-License-Identifier: GPL-3.0-or-later
#include "LensedPlan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vernier/base/Guarded.h"
#include "vernier/plan/Volumetric.h"

namespace vernier {
namespace {

std::string pathOf(std::size_t layer, const char* key) {
  return "/layers/" + std::to_string(layer) + "/" + key;
}

Error fault(std::size_t layer, const char* key, std::string why) {
  return makeError(ErrorCode::SceneInvalid, std::move(why), pathOf(layer, key));
}

// The part of a convex polygon inside a half-space.
std::vector<glm::dvec3> cut(const std::vector<glm::dvec3>& polygon, const HalfSpace& h) {
  std::vector<glm::dvec3> out;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const glm::dvec3& a = polygon[n];
    const glm::dvec3& b = polygon[(n + 1) % polygon.size()];
    const double da = h.distance_mm(PatientPoint(a)), db = h.distance_mm(PatientPoint(b));
    if (da <= 0) out.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) out.push_back(a + (b - a) * (da / (da - db)));
  }
  return out;
}

// What the camera can see, as half-spaces: beyond the near distance and the eye, within the picture's edges.
void addView(const CameraPicture& c, std::vector<HalfSpace>& planes) {
  const bool perspective = c.projection == Projection::Perspective;
  const auto add = [&](const PatientVec& outward, const PatientPoint& on) {
    const PatientVec n = normalize(outward);
    planes.push_back({n, glm::dot(n.v, on.p)});
  };
  add(-c.forward, c.eye + c.forward * c.near_mm);
  const PatientPoint centre = c.eye;
  const double w = c.width_px, h = c.height_px;
  const auto side = [&](const PatientVec& toEdge, const PatientVec& outward) {
    if (!perspective) return add(outward, centre + toEdge);
    // The plane through the eye that holds the edge: its normal has no part along the way to the edge.
    const PatientVec along = c.forward + toEdge;
    add(outward - along * (dot(outward, along) / dot(along, along)), c.eye);
  };
  side(c.across(0, 0.5 * h), -c.right), side(c.across(w, 0.5 * h), c.right);
  side(c.across(0.5 * w, 0), c.up), side(c.across(0.5 * w, h), -c.up);
}

std::vector<PatientPoint> boxCorners(const GridGeometry& grid) {
  std::vector<PatientPoint> out;
  for (int n = 0; n < 8; ++n) out.push_back(grid.corner(n));
  return out;
}

// Why the layer cannot have this inside; "" when it can.
// `inverted`: the volume itself (VolumeInfo).
std::string whyNotInside(const Layer& base, const LensInner& inner, bool inverted) {
  if (std::holds_alternative<CutOut>(inner)) return "";
  const bool look = std::holds_alternative<SliceLook>(inner);
  if (const auto* slice = std::get_if<SliceLayer>(&base)) {
    if (!look) return "On a slice a lens shows 'slice' (another window) or 'cut-out'.";
    if (slice->slab.thickness_mm > 0)
      return "A lens acts on single slices, and this one is a slab; make its thickness 0.";
    return "";
  }
  if (look) return "A lens that shows 'slice' acts on slices, and there is none here.";
  const auto sourceOf = [](const auto& l) -> const std::string* {
    if constexpr (requires { l.source; })
      return &l.source;
    else
      return nullptr;
  };
  const std::string* own = std::visit(sourceOf, inner);
  if (own && *own != *volumeOf(base))
    return "A lens shows the volume that is seen around it, and names another.";
  const auto* projection = std::get_if<ProjectionLayer>(&inner);
  if (projection && projection->invert != inverted)
    return "An inverted projection cannot be joined with what is around it.";
  return "";
}

bool crossesPlane(const ConvexRegion& region, const Plane& plane) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const PatientPoint& p : region.corners) {
    const double d = dot(plane.normal, p - plane.point);
    least = std::min(least, d), most = std::max(most, d);
  }
  return least <= 0 && most >= 0;
}

}  // namespace

bool meets(const ConvexRegion& region, std::span<const HalfSpace> planes,
           const std::vector<PatientPoint>& corners) {
  for (const auto& t : region.triangles) {
    std::vector<glm::dvec3> polygon{region.corners[t[0]].p, region.corners[t[1]].p, region.corners[t[2]].p};
    for (const HalfSpace& h : planes)
      if (polygon = cut(polygon, h); polygon.empty()) break;
    if (!polygon.empty()) return true;
  }
  // No face of it is inside: it holds all of it or nothing.
  return std::any_of(corners.begin(), corners.end(),
                     [&](const PatientPoint& p) { return region.contains(p); });
}

std::optional<Layer> innerLayer(const LensLayer& lens) {
  return std::visit(
      [](const auto& l) -> std::optional<Layer> {
        using L = std::remove_cvref_t<decltype(l)>;
        if constexpr (std::is_same_v<L, CutOut> || std::is_same_v<L, SliceLook>)
          return std::nullopt;
        else
          return Layer(l);
      },
      lens.inner);
}

Result<std::optional<std::size_t>> layerBehindLenses(const Scene& scene) {
  std::optional<std::size_t> lens, through, slice;
  for (std::size_t n = 0; n < scene.layers.size(); ++n) {
    if (std::holds_alternative<LensLayer>(scene.layers[n]) && !lens) lens = n;
    if (looksThroughVolume(scene.layers[n]) && !through) through = n;
    if (std::holds_alternative<SliceLayer>(scene.layers[n]) && !slice) slice = n;
  }
  if (!lens) return std::optional<std::size_t>();
  if (!through && !slice)
    return makeError(
        ErrorCode::SceneInvalid,
        "A lens needs a volume, iso-surface, projection, shells or slice layer to look into; the "
        "scene has none.",
        "/layers/" + std::to_string(*lens));
  return through ? through : slice;
}

Result<std::vector<PlacedLens>> lensesBefore(std::size_t layer, const PlanContext& context,
                                             const Technique& technique, std::vector<std::string>& notes) {
  const Layer& base = context.scene.layers[layer];
  const auto volume = context.sources.volumes.find(*volumeOf(base));
  std::vector<PlacedLens> out;
  if (volume == context.sources.volumes.end() || !volume->second)
    return out;  // said where the layer is planned
  const GridGeometry& grid = volume->second->grid();
  const bool inverted = volume->second->info().inverted;
  const auto* slice = std::get_if<SliceLayer>(&base);
  std::vector<HalfSpace> seen;
  if (!slice) {
    const auto* projection = std::get_if<ProjectionLayer>(&base);
    Result<std::vector<HalfSpace>> kept = keptRegion(context.scene, grid);
    if (!kept) return kept.error();
    Result<CameraPicture> camera = cameraPicture(context.scene.camera, context.view, cameraBox(grid));
    if (!camera) return camera.error();
    seen = *std::move(kept);
    addView(*camera, seen);
    if (projection && projection->invert != inverted)
      return fault(layer, "invert", "An inverted projection cannot be joined with a lens; leave invert out.");
  }
  for (std::size_t n = 0; n < context.scene.layers.size(); ++n) {
    const auto* lens = std::get_if<LensLayer>(&context.scene.layers[n]);
    if (!lens) continue;
    if (std::string why = whyNotInside(base, lens->inner, inverted); !why.empty())
      return fault(n, "inner", why);
    if (const Result<void> ok = checkPose(lens->pose); !ok) return fault(n, "pose", ok.error().sentence);
    Result<std::shared_ptr<const ConvexRegion>> region =
        guarded(technique.name, [&] { return technique.region(*lens, context.sources); });
    if (!region) return fault(n, "shape", region.error().sentence);
    if (!(*region)->notice.empty())
      notes.push_back("layer " + std::to_string(n) + " (lens): " + (*region)->notice);
    const bool shows = slice ? crossesPlane(**region, slice->plane) : meets(**region, seen, boxCorners(grid));
    if (shows)
      out.push_back({*region, n});
    else
      notes.push_back("layer " + std::to_string(n) + " (lens) lies outside what is " +
                      (slice ? "cut by the slice" : "seen of the volume") + ": the picture is as without it");
  }
  return out;
}

}  // namespace vernier
