// SPDX-License-Identifier: GPL-3.0-or-later
// What people should not hand to shells, projections and the tools in them: a clear error or a stated clamp,
// and nothing lost of the rest. Files that are not what their name says: volume/SurfaceFileTest.cpp.
#include <gmock/gmock.h>

#include <functional>

#include "ProjectionCases.h"
#include "ShellCases.h"

namespace vernier::test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::shared_ptr<const Mesh> square(double half_mm) {
  MeshBuilder b;
  const std::uint32_t v[4] = {b.vertex({-half_mm, 0, -half_mm}), b.vertex({half_mm, 0, -half_mm}),
                              b.vertex({half_mm, 0, half_mm}), b.vertex({-half_mm, 0, half_mm})};
  b.triangle(v[0], v[1], v[2]), b.triangle(v[0], v[2], v[3]);
  return *b.finish();
}

TEST(BadTools, AnEmptyMeshCannotBeMadeAndOneThatIsNotThereIsSaid) {
  EXPECT_EQ(MeshBuilder().finish().error().code, ErrorCode::NothingToLoad);
  ShellCase shells;
  shells.addTool(nullptr, PatientPoint(0, 0, 0));
  EXPECT_EQ(shells.plan("shells.native").error().where, "/layers/1/source");
  LookCase look;
  look.scene.layers.emplace_back(SurfaceLayer{"absent", {}, {}, 1});
  EXPECT_EQ(look.plan("projection.native").error().where, "/layers/1/source");
}

// A sheet of ten million triangles of 2 micrometres among the vessels: each pixel meets it exactly once.
TEST(BadTools, TenMillionTrianglesAreDrawnAndCounted) {
  constexpr std::uint32_t kSide = 2236;
  MeshBuilder b;
  b.reserve(2 * kSide * kSide);
  std::vector<std::uint32_t> row(kSide + 1), next(kSide + 1);
  const double step = 40.0 / kSide;
  for (std::uint32_t j = 0; j <= kSide; ++j) {
    for (std::uint32_t i = 0; i <= kSide; ++i) next[i] = b.vertex({step * i - 20, 0, step * j - 20});
    if (j > 0)
      for (std::uint32_t i = 0; i < kSide; ++i) {
        b.triangle(row[i], row[i + 1], next[i + 1]);
        b.triangle(row[i], next[i + 1], next[i]);
      }
    std::swap(row, next);
  }
  const std::shared_ptr<const Mesh> mesh = *b.finish();
  ASSERT_GE(mesh->triangles().size(), 9'999'000u);
  ShellCase many, two;
  const PatientPoint middle = many.sources.volumes["v"]->grid().centre();
  many.addTool(mesh, middle, 0.5), two.addTool(square(20), middle, 0.5);
  const Result<Images> a = many.draw("shells.native"), e = two.draw("shells.native");
  ASSERT_TRUE(a.ok()) << a.error().text();
  EXPECT_EQ(a->counters.triangles - e->counters.triangles, mesh->triangles().size() - 2);
  double most = 0;
  for (std::size_t n = 0; n < a->colour.size(); ++n)
    most = std::max(most, static_cast<double>(std::abs(a->colour[n] - e->colour[n])));
  EXPECT_LT(most, 1e-4);
}

// Three sheets on one edge, one of them twice.
std::shared_ptr<const Mesh> notManifold() {
  MeshBuilder b;
  const std::uint32_t low = b.vertex({0, 0, -6}), high = b.vertex({0, 0, 6});
  for (const glm::dvec3 p : {glm::dvec3(8, 1, 0), glm::dvec3(-7, 2, 0), glm::dvec3(2, -8, 1)})
    b.triangle(low, high, b.vertex(p));
  b.triangle(low, high, b.vertex({8, 1, 0}));
  return *b.finish();
}

class BadToolPictures : public ::testing::TestWithParam<const char*> {};

TEST_P(BadToolPictures, SurfacesThatAreNoManifoldsAreDrawnTriangleByTriangle) {
  const std::string technique = GetParam();
  if (technique != "shells.native" && !glDevice()) return;
  for (const double opacity : {1.0, 0.4}) {
    if (opacity < 1 && technique == "shells.gl") continue;
    for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum}) {
      ShellCase c;
      c.shells().mode = mode;
      c.addTool(notManifold(), c.sources.volumes["v"]->grid().centre(), opacity);
      expectTruth(c, technique, technique == "shells.native" ? 2e-6 : 1e-3);
    }
  }
}

// In metres by mistake: its head is behind the eye, its tip beyond everything.
TEST_P(BadToolPictures, AScrewOfThirtyMetresCoversWhatItCovers) {
  const std::string technique = GetParam();
  if (technique != "shells.native" && !glDevice()) return;
  MeshBuilder b;
  const auto corner = [&](int n) {
    const double r = n & 4 ? 2.2 : 3.0;  // a long wedge
    return b.vertex({n & 1 ? r : -r, n & 4 ? 15'000.0 : -15'000.0, n & 2 ? r : -r});
  };
  constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& f : kFaces) {
    b.triangle(corner(f[0]), corner(f[1]), corner(f[2]));
    b.triangle(corner(f[0]), corner(f[2]), corner(f[3]));
  }
  const std::shared_ptr<const Mesh> screw = *b.finish();
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
    ShellCase c;
    c.scene.camera.projection = projection;
    c.shells().a = 0.5, c.shells().cueByDistance = true;
    c.addTool(screw, c.sources.volumes["v"]->grid().centre());
    // The light of GL's own tools comes from differences between floats of 15000 mm.
    const bool floats = technique == "shells.gl";
    expectTruth(c, technique, technique == "shells.native" ? 2e-6 : floats ? 2e-2 : 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadToolPictures, ::testing::ValuesIn(kShellTechniques), shellTechniqueName);

TEST(BadLevels, LevelsOutsideTheDataShowNothingOrTheBoxAndTheOthersStay) {
  ShellCase without;
  const Images expected = *without.draw();
  ShellCase above;
  for (const double level : {5000.0, 6000.0}) above.shells().levels.push_back(level);
  const Images seen = *above.draw();
  EXPECT_EQ(seen.colour, expected.colour);
  ASSERT_TRUE(above.plan().ok());
  EXPECT_THAT(above.plan()->notes, Contains(HasSubstr("2 of 7 levels lie above all values")));
  // All of them: black, and said.
  ShellCase none;
  none.shells().levels = {5000, 6000};
  const Images black = *none.draw();
  EXPECT_TRUE(std::all_of(black.depth.begin(), black.depth.end(), [](float d) { return d == kNothing_mm; }));
  // One below all closes on the volume's box.
  ShellCase below;
  below.shells().levels = {-1e30, 60};
  EXPECT_TRUE(below.draw().ok());
  EXPECT_THAT(below.plan()->notes, Contains(HasSubstr("1 of 2 levels lie below all values")));
}

TEST(BadLevels, NoLevelAndMoreThan1024AreRefused) {
  for (const int count : {0, -3, 1025}) {
    ShellCase c;
    c.shells().levels.clear();
    c.shells().count = count;
    const Error e = c.plan("shells.native").error();
    EXPECT_EQ(e.where, "/layers/0/levels");
    EXPECT_THAT(e.sentence, HasSubstr("1 to 1024"));
  }
  ShellCase listed;
  listed.shells().levels.clear();
  for (int n = 0; n < 1025; ++n) listed.shells().levels.push_back(n);
  EXPECT_THAT(listed.plan("shells.native").error().sentence, HasSubstr("1025 levels were given"));
  // All disabled is no error: nothing is shown, and that is said.
  ShellCase disabled;
  disabled.shells().disabled = {0, 1, 2, 3, 4};
  EXPECT_TRUE(disabled.draw().ok());
  EXPECT_THAT(disabled.plan()->notes, Contains("5 of 5 levels are disabled"));
}

TEST(BadNumbers, NaNInShellsIsRefusedWithItsPlace) {
  const auto placeOf = [](const std::function<void(ShellsLayer&)>& change) {
    ShellCase c;
    change(c.shells());
    const Result<Plan> plan = c.plan("shells.native");
    EXPECT_FALSE(plan.ok());
    return plan.ok() ? "" : plan.error().where;
  };
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.beta0 = kNaN; }), "/layers/0/beta0");
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.betaM = kNaN; }), "/layers/0/beta_m");
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.a = kNaN; }), "/layers/0/a");
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.b = HUGE_VAL; }), "/layers/0/b");
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.phi0 = kNaN; }), "/layers/0/phi0");
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.levels[2] = kNaN; }), "/layers/0/levels");
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.window->width = kNaN; }), "/layers/0/window");
  EXPECT_EQ(placeOf([](ShellsLayer& l) { l.window->center = kNaN; }), "/layers/0/window");
}

TEST(BadNumbers, NaNInProjectionsIsRefusedWithItsPlace) {
  const auto placeOf = [](const std::function<void(ProjectionLayer&)>& change) {
    LookCase c;
    change(c.layer());
    const Result<Plan> plan = c.plan("projection.native");
    EXPECT_FALSE(plan.ok());
    return plan.ok() ? "" : plan.error().where;
  };
  EXPECT_EQ(placeOf([](ProjectionLayer& l) { l.window->width = kNaN; }), "/layers/0/window");
  EXPECT_EQ(placeOf([](ProjectionLayer& l) { l.window->center = HUGE_VAL; }), "/layers/0/window");
  EXPECT_EQ(placeOf([](ProjectionLayer& l) { l.cue = kNaN; }), "/layers/0/cue");
  EXPECT_EQ(placeOf([](ProjectionLayer& l) { l.cue = 1.5; }), "/layers/0/cue");
  EXPECT_EQ(placeOf([](ProjectionLayer& l) { l.gain_perMm = kNaN; }), "/layers/0/gain_per_mm");
  EXPECT_EQ(placeOf([](ProjectionLayer& l) { l.gain_perMm = 0; }), "/layers/0/gain_per_mm");
}

TEST(BadNumbers, NaNInToolsAndCameraIsRefusedWithItsPlace) {
  const auto placeOf = [](const std::function<void(LookCase&, SurfaceLayer&)>& change) {
    LookCase c;
    c.addTools(0.5);
    change(c, std::get<SurfaceLayer>(c.scene.layers[1]));
    const Result<Plan> plan = c.plan("projection.native");
    EXPECT_FALSE(plan.ok());
    return plan.ok() ? "" : plan.error().where;
  };
  EXPECT_EQ(placeOf([](LookCase&, SurfaceLayer& t) { t.opacity = kNaN; }), "/layers/1/opacity");
  EXPECT_EQ(placeOf([](LookCase&, SurfaceLayer& t) { t.pose.translation.y = kNaN; }), "/layers/1/pose");
  EXPECT_EQ(placeOf([](LookCase&, SurfaceLayer& t) { t.pose.linear[1] = glm::dvec3(0); }), "/layers/1/pose");
  EXPECT_THAT(placeOf([](LookCase& c, SurfaceLayer&) { c.scene.camera.azimuth_deg = kNaN; }),
              HasSubstr("/camera"));
  EXPECT_THAT(placeOf([](LookCase& c, SurfaceLayer&) { c.scene.camera.zoom = kNaN; }), HasSubstr("/camera"));
  EXPECT_THAT(placeOf([](LookCase& c, SurfaceLayer&) {
                c.scene.crop = CropBox{VoxelPoint(0, kNaN, 0), VoxelPoint(9, 9, 9)};
              }),
              HasSubstr("/crop"));
  EXPECT_THAT(placeOf([](LookCase& c, SurfaceLayer&) {
                c.scene.clip = {{PatientVec(0, 0, 1), kNaN}};
              }),
              HasSubstr("/clip"));
}

}  // namespace
}  // namespace vernier::test
