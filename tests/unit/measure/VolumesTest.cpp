// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes and distances against closed forms.
#include "MeasureCases.h"
#include "vernier/measure/ConvexBody.h"

namespace vernier::measure::test {
namespace {

using ::testing::Contains;

std::vector<HalfSpace> boxOf(glm::dvec3 half, const glm::dmat3& turn, glm::dvec3 centre) {
  std::vector<HalfSpace> out;
  for (int a = 0; a < 3; ++a)
    for (const double sign : {-1.0, 1.0}) {
      const glm::dvec3 n = sign * turn[a];
      out.push_back({PatientVec(n), glm::dot(n, centre) + half[a]});
    }
  return out;
}

TEST(Volumes, ConvexRegionsAreExact) {
  Draws d(11);
  for (int n = 0; n < 300; ++n) {
    const Placement::Axes a = randomAxes(d);
    const glm::dmat3 turn(rightOf(a), a.up.v, a.normal.v);
    const glm::dvec3 half(d.within(0.1, 60), d.within(0.1, 60), d.within(0.1, 60));
    const glm::dvec3 centre(d.within(-500, 500), d.within(-500, 500), d.within(-1500, 1500));
    std::vector<HalfSpace> box = boxOf(half, turn, centre);
    const double whole = 8 * half.x * half.y * half.z;
    auto body = convexBody(box);
    ASSERT_TRUE(body.ok()) << body.error().text();
    ASSERT_NEAR(body->volume_mm3, whole, 1e-9 * whole);
    ASSERT_NEAR(body->faces[0], 4 * half.y * half.z, 1e-9 * body->faces[0]);
    box.push_back(box[2]);                                                   // twice the same plane
    box.push_back({PatientVec(turn[0]), glm::dot(turn[0], centre) + 1000});  // far away
    body = convexBody(box);
    ASSERT_TRUE(body.ok());
    ASSERT_NEAR(body->volume_mm3, whole, 1e-9 * whole);
    // A corner cut off: the tetrahedron with legs t along the edges.
    const double t = 0.5 * std::min({half.x, half.y, half.z});
    const glm::dvec3 inward = turn[0] + turn[1] + turn[2], unit = inward / std::sqrt(3.0);
    const glm::dvec3 corner = centre + turn * half;
    box.push_back({PatientVec(unit), glm::dot(unit, corner) - t / std::sqrt(3.0)});
    body = convexBody(box);
    ASSERT_TRUE(body.ok());
    ASSERT_NEAR(body->volume_mm3, whole - t * t * t / 6, 1e-9 * whole);
  }
}

TEST(Volumes, OpenAndEmptyRegionsAreRefused) {
  const std::vector<HalfSpace> box = boxOf({1, 2, 3}, glm::dmat3(1), {0, 0, 0});
  for (std::size_t n = 0; n < 6; ++n) {
    std::vector<HalfSpace> open = box;
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(n));
    EXPECT_FALSE(convexBody(open).ok()) << n;
  }
  std::vector<HalfSpace> empty = box;
  empty.push_back({PatientVec(1, 0, 0), -5});
  ASSERT_FALSE(convexBody(empty).ok());
  EXPECT_NE(convexBody(empty).error().sentence.find("enclose nothing"), std::string::npos);
  EXPECT_FALSE(convexBody(std::vector<HalfSpace>{}).ok());
  std::vector<HalfSpace> longer = box;
  longer[0].normal = PatientVec(-2, 0, 0);
  EXPECT_FALSE(convexBody(longer).ok());
}

// A box whose faces run between voxel centres holds a whole number of voxels: exact. A ball: within its +/-.
TEST(Volumes, IsoRegionsAreCountedInVoxels) {
  for (const double aspect : {1.0, 5.0, 50.0}) {
    const GridGeometry g = gridOf({20, 30, 12}, {1, 0.5, 0.5 * aspect});
    const auto volume = volumeOf(g, [&](glm::dvec3 p) {
      return std::abs(p.x) < 4 && std::abs(p.y) < 3 && std::abs(p.z) < aspect ? 100 : 0;
    });
    const auto said = measure(inPatient(IsoVolume{50, {}}), sourcesOf(volume));
    ASSERT_TRUE(said.ok()) << said.error().text();
    EXPECT_NEAR(said->quantities.at(0).value, 8 * 6 * 2 * aspect, 1e-9 * 96 * aspect);
    EXPECT_EQ(said->quantities.at(0).unit, "mm3");
  }
  Draws d(12);
  int covered = 0;
  for (int n = 0; n < 40; ++n) {
    const glm::dvec3 centre(d.within(-1, 1), d.within(-1, 1), d.within(-1, 1));
    const double r = d.within(6, 9);
    const auto volume = volumeOf(gridOf({26, 26, 26}, {0.8, 0.8, 0.8}), [&](glm::dvec3 p) {
      return std::clamp((r - glm::length(p - centre)) / 0.8 + 0.5, 0.0, 1.0);
    });
    const auto said = measure(inPatient(IsoVolume{0.5, centre}), sourcesOf(volume));
    ASSERT_TRUE(said.ok());
    covered += std::abs(said->quantities.at(0).value - 4.0 / 3 * std::numbers::pi * r * r * r) <=
               *said->quantities.at(0).expanded;
    EXPECT_LT(*said->quantities.at(0).expanded, 0.03 * said->quantities.at(0).value);
  }
  EXPECT_GE(covered, 36);
}

TEST(Volumes, ASeedTakesOneRegionAndGapsDivide) {
  GridGeometry g = gridOf({10, 6, 6}, {1, 1, 2});
  const auto two = [](glm::dvec3 p) { return std::abs(p.x) > 2 && std::abs(p.y) < 2 ? 1 : 0; };
  auto volume = volumeOf(g, two);
  auto said = measure(inPatient(IsoVolume{0.5, Spot(3.5, 0.5, 1)}), sourcesOf(volume));
  ASSERT_TRUE(said.ok()) << said.error().text();
  EXPECT_EQ(said->quantities[1].value, 3 * 4 * 6);
  EXPECT_EQ(measure(inPatient(IsoVolume{0.5, {}}), sourcesOf(volume))->quantities[1].value, 2 * 3 * 4 * 6);
  EXPECT_FALSE(measure(inPatient(IsoVolume{0.5, Spot(0.5, 0.5, 1)}), sourcesOf(volume)).ok());
  EXPECT_FALSE(measure(inPatient(IsoVolume{5, {}}), sourcesOf(volume)).ok());
  for (int s = 0; s < 6; ++s) g.sliceOrigin_vox.push_back({0, 0, s + (s > 2 ? 4.0 : 0.0)});
  g.gapAfter = {2};
  volume = volumeOf(g, two);
  const glm::dvec3 seed = (g.patientFromVoxel * VoxelPoint(8, 3, 1)).p;
  said = measure(inPatient(IsoVolume{0.5, seed}), sourcesOf(volume));
  ASSERT_TRUE(said.ok());
  EXPECT_EQ(said->quantities[1].value, 3 * 4 * 3)
      << "what lies beyond missing slices is not known to hang together";
  EXPECT_NEAR(said->quantities.at(0).value, 3 * 4 * 3 * 2, 1e-9);
  EXPECT_THAT(said->notes, Contains("missing slices are left out"));
}

std::shared_ptr<const Mesh> boxMesh(glm::dvec3 low, glm::dvec3 high) {
  MeshBuilder b;
  std::array<std::uint32_t, 8> v{};
  for (unsigned n = 0; n < 8; ++n)
    v[n] = b.vertex({n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z});
  constexpr std::array<std::array<int, 4>, 6> faces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : faces) {
    const auto at = [&](int n) { return v[static_cast<std::size_t>(f[static_cast<std::size_t>(n)])]; };
    b.triangle(at(0), at(1), at(2));
    b.triangle(at(0), at(2), at(3));
  }
  return *b.finish();
}

double distanceToBox(glm::dvec3 p, glm::dvec3 low, glm::dvec3 high) {
  const glm::dvec3 out = glm::max(glm::max(low - p, p - high), glm::dvec3(0));
  if (glm::length(out) > 0) return glm::length(out);
  const glm::dvec3 in = glm::min(p - low, high - p);
  return std::min({in.x, in.y, in.z});
}

TEST(Volumes, DistancesToAndBetweenSurfacesAreExact) {
  Draws d(13);
  const auto volume = volumeOf(gridOf({5, 5, 5}, {1, 1, 1}), [](glm::dvec3) { return 0; });
  for (int n = 0; n < 200; ++n) {
    const auto corner = [&] { return glm::dvec3(d.within(-20, 20), d.within(-20, 20), d.within(-20, 20)); };
    const glm::dvec3 a = corner(), b = a + glm::dvec3(d.within(1, 9), d.within(1, 9), d.within(1, 9));
    const glm::dvec3 c = corner(), e = c + glm::dvec3(d.within(1, 9), d.within(1, 9), d.within(1, 9));
    Sources s = sourcesOf(volume);
    s.surface = [&](const std::string& name) -> Result<std::shared_ptr<const Mesh>> {
      return name == "tool" ? boxMesh(a, b) : boxMesh(c, e);
    };
    const glm::dvec3 p = corner();
    auto said = measure(inPatient(PointToSurface{p, {"tool", {}, {}}}), s);
    ASSERT_TRUE(said.ok()) << said.error().text();
    ASSERT_NEAR(said->quantities.at(0).value, distanceToBox(p, a, b), 1e-9);
    ASSERT_NEAR(glm::length(said->found[1] - said->found[0]), said->quantities.at(0).value, 1e-12);
    said = measure(inPatient(ToolToVessel{{"tool", {}, {}}, {"vessel", {}, {}}}), s);
    ASSERT_TRUE(said.ok());
    const glm::dvec3 gap = glm::max(glm::max(c - b, a - e), glm::dvec3(0));
    const bool nested = glm::all(glm::greaterThan(c, a)) && glm::all(glm::lessThan(e, b));
    const bool inside = glm::all(glm::greaterThan(a, c)) && glm::all(glm::lessThan(b, e));
    if (!nested && !inside) {
      ASSERT_NEAR(said->quantities.at(0).value, glm::length(gap), 1e-9) << n;
    }
    said = measure(inPatient(SurfaceVolume{{"tool", {}, {}}}), s);
    ASSERT_TRUE(said.ok());
    ASSERT_NEAR(said->quantities.at(0).value, (b.x - a.x) * (b.y - a.y) * (b.z - a.z),
                1e-9 * said->quantities.at(0).value);
  }
}

TEST(Volumes, SurfacesNeedAVolumeOnlyForTheirLevels) {
  Sources s = sourcesOf(std::shared_ptr<const Volume>());
  s.surface = [](const std::string&) -> Result<std::shared_ptr<const Mesh>> {
    return boxMesh({0, 0, 0}, {1, 1, 1});
  };
  const auto said = measure(inPatient(SurfaceVolume{{"a", {}, {}}}), s);
  ASSERT_TRUE(said.ok()) << said.error().text();
  EXPECT_FALSE(said->quantities.at(0).expanded.has_value()) << "nothing is known of the file's accuracy";
  EXPECT_EQ(said->origin, Origin::File);
  EXPECT_FALSE(measure(inPatient(SurfaceVolume{{"", 5.0, {}}}), s).ok());
  EXPECT_FALSE(measure(inPatient(Length{{Spot(0, 0, 0), Spot(1, 0, 0)}}), s).ok());
}

}  // namespace
}  // namespace vernier::measure::test
