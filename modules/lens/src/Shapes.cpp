// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/lens/Shapes.h"

#include <cstring>

#include "HullSolid.h"
#include "MeshConvexity.h"
#include "SolidShapes.h"
#include "vernier/base/Guarded.h"

namespace vernier::lens {
namespace {

using Region = Result<std::shared_ptr<const ConvexRegion>>;

Region share(Result<ConvexRegion> r) {
  if (!r) return r.error();
  return std::shared_ptr<const ConvexRegion>(std::make_shared<const ConvexRegion>(*std::move(r)));
}

Result<DerivedCache::Made<Solid>> made(Result<Solid> s) {
  if (!s) return s.error();
  const std::uint64_t bytes = s->bytes();
  return DerivedCache::Made<Solid>{std::make_shared<const Solid>(*std::move(s)), bytes};
}

// A number for the points' bits, four strands for speed. Points of the same number are compared.
std::uint64_t digest(std::span<const MeshPoint> points) {
  std::uint64_t h[4] = {points.size(), 1, 2, 3};
  for (const MeshPoint& p : points)
    for (int a = 0; a < 3; ++a) {
      std::uint64_t bits;
      std::memcpy(&bits, &p.p[a], sizeof bits);
      h[a] = (h[a] ^ bits) * 0x9E3779B97F4A7C15ull;
      h[a] ^= h[a] >> 29;
    }
  for (const std::uint64_t v : {h[1], h[2], h[3]})
    h[0] = (h[0] ^ v) * 0xD6E8FEB86659FD93ull, h[0] ^= h[0] >> 32;
  return h[0];
}

struct PointsSolid {
  SharedPoints points;
  std::shared_ptr<const Solid> solid;
};

Region regionOf(const BoxShape& b, const PatientFromMesh& pose, const Sources&, DerivedCache&) {
  const Result<Solid> s = boxSolid(b);
  if (!s) return s.error();
  return share(placed(*s, pose));
}

Region regionOf(const SphereShape& s, const PatientFromMesh& pose, const Sources&, DerivedCache& cache) {
  const Result<Transform<MeshFrame, MeshFrame>> place = spherePlace(s);
  if (!place) return place.error();
  const Result<std::shared_ptr<const Solid>> solid = cache.get<Solid>(
      {"lens sphere", 0, std::to_string(s.divisions)}, [&] { return made(icosphere(s.divisions)); });
  if (!solid) return solid.error();
  return share(placed(**solid, pose * *place));
}

Region regionOf(const ConeShape& c, const PatientFromMesh& pose, const Sources&, DerivedCache&) {
  const Result<Solid> s = coneSolid(c);
  if (!s) return s.error();
  return share(placed(*s, pose));
}

using Kept = Result<std::shared_ptr<const PointsSolid>>;

// By what the points are.
Kept hullByValue(const SharedPoints& points, DerivedCache& cache) {
  const auto make = [&]() -> Result<DerivedCache::Made<PointsSolid>> {
    Result<Solid> s = hullSolid(points);
    if (!s) return s.error();
    const std::uint64_t bytes = s->bytes() + points.size() * sizeof(MeshPoint);
    return DerivedCache::Made<PointsSolid>{std::make_shared<const PointsSolid>(PointsSolid{
                                               points, std::make_shared<const Solid>(*std::move(s))}),
                                           bytes};
  };
  const Kept kept = cache.get<PointsSolid>({"lens hull", 0, std::to_string(digest(points))}, make);
  if (!kept || (*kept)->points == points) return kept;
  Result<DerivedCache::Made<PointsSolid>> own = make();  // another set with the same digest
  if (!own) return own.error();
  return own->value;
}

// By which list they are, so that a lens that moves costs no look at its points. What is kept holds its list:
// no other one has the same place meanwhile.
Region regionOf(const HullShape& h, const PatientFromMesh& pose, const Sources&, DerivedCache& cache) {
  const auto make = [&]() -> Result<DerivedCache::Made<PointsSolid>> {
    const Kept value = hullByValue(h.points, cache);
    if (!value) return value.error();
    const bool same = (*value)->points.isSame(h.points);
    return DerivedCache::Made<PointsSolid>{
        std::make_shared<const PointsSolid>(PointsSolid{h.points, (*value)->solid}),
        sizeof(PointsSolid) + (same ? 0 : h.points.size() * sizeof(MeshPoint))};
  };
  const std::string which = std::to_string(reinterpret_cast<std::uintptr_t>(h.points.identity()));
  Kept kept = cache.get<PointsSolid>({"lens points", 0, which}, make);
  if (kept && !(*kept)->points.isSame(h.points)) kept = hullByValue(h.points, cache);
  if (!kept) return kept.error();
  return share(placed(*(*kept)->solid, pose));
}

Region regionOf(const MeshShape& m, const PatientFromMesh& pose, const Sources& sources,
                DerivedCache& cache) {
  const auto found = sources.meshes.find(m.source);
  if (found == sources.meshes.end() || !found->second)
    return shapeFault("The mesh '" + m.source + "' that the lens names is not loaded; give its file.");
  const Mesh& mesh = *found->second;
  const auto make = [&]() -> Result<DerivedCache::Made<Solid>> {
    if (!m.hull)
      if (const Result<void> ok = checkEdges(mesh); !ok) return ok.error();
    Result<Solid> s = hullSolid(mesh.vertices());
    if (s && !m.hull)
      if (const Result<void> ok = checkFilled(mesh, *s); !ok) return ok.error();
    return made(std::move(s));
  };
  const Result<std::shared_ptr<const Solid>> solid =
      cache.get<Solid>({"lens mesh", mesh.revision(), m.hull ? "hull" : "convex"}, make);
  if (!solid) return solid.error();
  return share(placed(**solid, pose));
}

}  // namespace

Region convexRegion(const LensLayer& layer, const Sources& sources, DerivedCache& cache) {
  return guarded("lens shape", [&]() -> Region {
    return std::visit([&](const auto& shape) { return regionOf(shape, layer.pose, sources, cache); },
                      layer.shape);
  });
}

}  // namespace vernier::lens
