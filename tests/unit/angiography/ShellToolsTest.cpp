// SPDX-License-Identifier: GPL-3.0-or-later
// Tools among shells: a screw half in front of and half behind the vessels.
#include <algorithm>

#include "ShellCases.h"

namespace vernier::test {
namespace {

// A rod with a thread around x, from -length/2 to length/2.
std::shared_ptr<const Mesh> screw(double length_mm, double radius_mm) {
  MeshBuilder b;
  constexpr int kAlong = 40, kAround = 14;
  const auto at = [&](int i, int j) {
    const double u = 2 * std::numbers::pi * (j % kAround) / kAround;
    const double r = i <= 0 || i >= kAlong ? 0 : radius_mm * (1 + 0.25 * std::sin(u + 1.6 * i));
    const double x = length_mm * (std::clamp(i, 1, kAlong - 1) / double(kAlong) - 0.5);
    return b.vertex({x, r * std::cos(u), r * std::sin(u)});
  };
  for (int i = 0; i < kAlong; ++i)
    for (int j = 0; j < kAround; ++j) {
      b.triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      b.triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return *b.finish();
}

// Through the middle of the volume, its head towards the viewer and its tip away.
void addScrew(ShellCase& c, double opacity) {
  const GridGeometry& g = c.sources.volumes["v"]->grid();
  c.addTool(screw(24, 2.2), g.centre(), opacity);
  auto& pose = std::get<SurfaceLayer>(c.scene.layers.back()).pose;
  const glm::dvec3 x = glm::normalize(glm::dvec3(0.6, -0.7, 0.2)),
                   y = glm::normalize(glm::cross(x, glm::dvec3(0, 0, 1)));
  pose.linear = glm::dmat3(x, y, glm::cross(x, y));
}

class ShellTools : public ::testing::TestWithParam<const char*> {
 protected:
  std::string technique() const { return GetParam(); }
  bool native() const { return technique() == "shells.native"; }
  double tolerance(ShellsMode mode) const { return native() ? mode == ShellsMode::Lit ? 1e-4 : 2e-6 : 1e-3; }
};
#define NEEDS_GL_UNLESS_NATIVE \
  if (!native() && !glDevice()) return

// 99.9 % of pixels, and none that is wrong farther than a pixel from an edge of the true picture.
void expectTrueButForEdges(const ShellCase& c, const std::string& technique, double tolerance) {
  const Result<Images> images = c.draw(technique);
  ASSERT_TRUE(images.ok()) << images.error().text();
  const auto wrong = wrongPixels(c, *images, tolerance);
  EXPECT_LE(wrong.size(), static_cast<std::size_t>(images->width * images->height) / 1000);
  const ShellTruth truth(c);
  const auto colour = [&](int x, int y) {
    return truth.colour(truth.at(x + 0.5, y + 0.5), x + 0.5, y + 0.5);
  };
  for (const glm::ivec2 p : wrong) {
    double spread = 0;
    for (int n = 0; n < 9; ++n)
      spread = std::max(spread, glm::length(colour(p.x + n % 3 - 1, p.y + n / 3 - 1) - colour(p.x, p.y)));
    EXPECT_GT(spread, tolerance) << p.x << " " << p.y;
  }
}

TEST_P(ShellTools, E1_AScrewHalfInFrontAndHalfBehind) {
  NEEDS_GL_UNLESS_NATIVE;
  for (const Projection projection : {Projection::Orthographic, Projection::Perspective})
    for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit})
      for (const double a : {0.0, 0.7}) {
        ShellCase c;
        c.scene.camera.projection = projection;
        c.shells().mode = mode, c.shells().a = a, c.shells().b = 0.4, c.shells().beta0 = 0.05;
        addScrew(c, 1);
        SCOPED_TRACE(c.plan(technique())->passes[0].params->dump());
        expectTrueButForEdges(c, technique(), tolerance(mode));
      }
}

// The screw is seen, is hidden and hides: else the test above would prove little.
TEST_P(ShellTools, TheScrewIsInTheMidstOfTheShells) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  addScrew(c, 1);
  const ShellTruth truth(c);
  int before = 0, hides = 0, alone = 0;
  for (int y = 0; y < c.view.height_px; ++y)
    for (int x = 0; x < c.view.width_px; ++x) {
      const RayList ray = truth.at(x + 0.5, y + 0.5);
      if (ray.tools.empty()) continue;
      if (ray.shells.empty())
        ++alone;
      else if (ray.shells[0].t_mm < ray.tools[0].t_mm)
        ++before;
      else
        ++hides;
    }
  EXPECT_GT(before, 100);
  EXPECT_GT(hides, 50);
  EXPECT_GT(alone, 10);
}

TEST_P(ShellTools, E7_TranslucentToolsDimWhatIsBehindBeforeTheMaximum) {
  NEEDS_GL_UNLESS_NATIVE;
  if (technique() == "shells.gl") {  // whose depth buffer cannot: shells.glmax is for that
    ShellCase c;
    addScrew(c, 0.4);
    EXPECT_EQ(c.draw(technique()).error().code, ErrorCode::NoTechnique);
    EXPECT_EQ(c.plan("")->passes[0].technique, "shells.native");
    return;
  }
  for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit})
    for (const double opacity : {0.4, 1.0 / 255}) {
      ShellCase c;
      c.scene.background = {0.1, 0.2, 0.1};
      c.shells().mode = mode, c.shells().a = 0.5, c.shells().b = 0.4;
      addScrew(c, opacity);
      expectTrueButForEdges(c, technique(), tolerance(mode));
    }
  ShellCase c;
  const Images without = *c.draw(technique());
  addScrew(c, 0);
  EXPECT_EQ(c.draw(technique())->colour, without.colour);
  EXPECT_EQ(c.draw(technique())->counters.triangles, without.counters.triangles);
}

// Four voxels in a row, 0.2, 0.8, 0.4, 0.6 along y from the viewer, levels 0.3, 0.5, 0.7; an opaque sheet of
// colour (0.5, 0.9, 0) at y = 1.2 faces the eye.
ShellCase fourVoxelsWithASheet() {
  VolumeInfo info;
  info.grid = unitGrid(5, 4, 5);
  std::vector<float> values;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i)
        values.push_back(std::array{0.2f, 0.8f, 0.4f, 0.6f}[static_cast<std::size_t>(j)]);
  ShellCase c(volumeOf(info, values));
  c.scene.camera = {};
  c.view = {9, 9};
  c.shells().levels = {0.3, 0.5, 0.7};
  c.shells().window = VoiWindow{0.5, 1, VoiFunction::LinearExact, ""};
  MeshBuilder sheet;
  const std::uint32_t v[4] = {sheet.vertex({-9, 0, -9}), sheet.vertex({9, 0, -9}), sheet.vertex({9, 0, 9}),
                              sheet.vertex({-9, 0, 9})};
  sheet.triangle(v[0], v[1], v[2]), sheet.triangle(v[0], v[2], v[3]);
  c.addTool(*sheet.finish(), PatientPoint(2, 1.2, 2), 1, {0.5, 0.9, 0});
  return c;
}

TEST_P(ShellTools, AnOpaqueToolIsReplacedOrOutshone) {
  NEEDS_GL_UNLESS_NATIVE;
  const auto middle = [&](const ShellCase& c) {
    const Result<Images> images = c.draw(technique());
    EXPECT_TRUE(images.ok()) << images.error().text();
    const float* const p = images->colour.data() + 4 * (4 + 9 * 4);
    return std::pair{glm::dvec3(p[0], p[1], p[2]), static_cast<double>(images->depth[4 + 9 * 4])};
  };
  const auto expect = [&](const ShellCase& c, glm::dvec3 colour, double atY) {
    const auto [seen, depth] = middle(c);
    EXPECT_LT(glm::length(seen - colour), 1e-5) << seen.x << " " << seen.y << " " << seen.z;
    EXPECT_NEAR(c.job().camera.ray(4.5, 4.5).at(depth).p.y, atY, 1e-4);
  };
  const double lowest = (0.3 - 0.2) / 0.6, highest = (0.7 - 0.2) / 0.6;  // of the levels' first crossings
  ShellCase c = fourVoxelsWithASheet();
  expect(c, glm::dvec3(0.7), highest);  // instead of the tool, though it is brighter in green
  c.shells().surfaceBlend = SurfaceBlend::Max;
  expect(c, {0.7, 0.9, 0.7}, highest);
  c.shells().disabled = {1, 2};
  expect(c, {0.5, 0.9, 0.3}, lowest);
  c.shells().colour = {1, 1, 0};
  c.shells().surfaceBlend = SurfaceBlend::Replace;
  expect(c, {0.3, 0.3, 0}, lowest);
  // Outshone in every channel: what is seen is the tool, and so is the depth.
  c.shells().surfaceBlend = SurfaceBlend::Max;
  std::get<SurfaceLayer>(c.scene.layers[1]).colour = {0.5, 0.9, 0.1};
  expect(c, {0.5, 0.9, 0.1}, 1.2);
  // Before the tool nothing reaches a level: the tool, whatever is asked for.
  for (const SurfaceBlend blend : {SurfaceBlend::Replace, SurfaceBlend::Max}) {
    ShellCase front = fourVoxelsWithASheet();
    front.shells().surfaceBlend = blend;
    std::get<SurfaceLayer>(front.scene.layers[1]).pose.translation.y = 0.1;
    expect(front, {0.5, 0.9, 0}, 0.1);
  }
  // A translucent tool before both weakens both.
  c = fourVoxelsWithASheet();
  c.shells().surfaceBlend = SurfaceBlend::Max;
  if (technique() == "shells.gl") return;
  c.addTool(c.sources.meshes.begin()->second, PatientPoint(2, 0.05, 2), 0.25, {1, 0, 0});
  expect(c, {0.25 + 0.75 * 0.7, 0.75 * 0.9, 0.75 * 0.7}, highest);
}

TEST_P(ShellTools, E7_64LayersOfAHundredth) {
  NEEDS_GL_UNLESS_NATIVE;
  if (technique() == "shells.gl") return;
  ShellCase c;
  const auto sheet = [] {
    MeshBuilder b;
    const auto p = [&](double x, double z) { return b.vertex({x, 0, z}); };
    b.triangle(p(-40, -40), p(40, -40), p(40, 40));
    b.triangle(p(-40, -40), p(40, 40), p(-40, 40));
    return *b.finish();
  }();
  const PatientPoint middle = c.sources.volumes["v"]->grid().centre();
  for (int n = 0; n < 64; ++n)
    c.addTool(sheet, middle + PatientVec(0, 0.2 * (n - 32), 0), 0.01, {0.3, 0.5, 1});
  const Images images = *c.draw(technique());
  // Beyond the eight nearest layers the rest is one, at the place of its nearest: 2 levels of 255.
  EXPECT_LE(wrongPixels(c, images, 0.3).size(), 0u);
  const auto wrong = wrongPixels(c, images, 2.0 / 255);
  std::size_t inside = 0;
  for (const glm::ivec2 p : wrong)
    inside += images.depth[static_cast<std::size_t>(p.x + images.width * p.y)] == kNothing_mm;
  EXPECT_EQ(inside, 0u);  // where no shell stands between the layers nothing is lost
}

TEST_P(ShellTools, E1_TheOrderOfToolsDoesNotMatter) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  addScrew(c, 1);
  c.addTool(screw(20, 1.5), c.sources.volumes["v"]->grid().centre() + PatientVec(0, -3, 2), 1, {0.2, 0.4, 1});
  const Images one = *c.draw(technique());
  std::swap(c.scene.layers[1], c.scene.layers[2]);
  const Images other = *c.draw(technique());
  for (std::size_t n = 0; n < one.colour.size(); ++n) ASSERT_NEAR(one.colour[n], other.colour[n], 1e-6);
}

TEST_P(ShellTools, E3_CoplanarToolsHaveOneWinner) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  addScrew(c, 1);
  addScrew(c, 1);
  std::get<SurfaceLayer>(c.scene.layers[2]).colour = {0, 0, 1};
  const Images images = *c.draw(technique());
  for (std::size_t n = 0; n < images.depth.size(); ++n)
    if (images.colour[4 * n] > 0 && images.colour[4 * n + 1] != images.colour[4 * n])
      FAIL() << "the first of the two shows at " << n;
  for (int turn = 0; turn < 5; ++turn) EXPECT_EQ(c.draw(technique())->colour, images.colour);
}

TEST_P(ShellTools, E4_ATenthOfAMillimetreApartAtTwoMetres) {
  NEEDS_GL_UNLESS_NATIVE;
  for (const double behind_mm : {-0.1, 0.1}) {
    VolumeInfo info;
    info.grid = unitGrid(20, 12, 12);
    std::vector<float> values;
    for (int n = 0; n < 20 * 12 * 12; ++n)
      values.push_back(n / 20 % 12 >= 6 ? 100.0f : 0.0f);  // inside: y > 5.5
    ShellCase c(volumeOf(info, values));
    c.shells().levels = {50};
    c.scene.camera = {};
    c.scene.camera.projection = Projection::Perspective;
    c.scene.camera.distance_mm = 1900, c.scene.camera.zoom = 20;
    MeshBuilder b;
    const auto p = [&](double x, double z) { return b.vertex({x, 5.5 + behind_mm, z}); };
    b.triangle(p(-5, -5), p(30, -5), p(30, 30));
    b.triangle(p(-5, -5), p(30, 30), p(-5, 30));
    c.addTool(*b.finish(), PatientPoint(0, 0, 0));
    expectTrueButForEdges(c, technique(), tolerance(ShellsMode::Max));
    const Images images = *c.draw(technique());
    const std::size_t middle = static_cast<std::size_t>(4 * (36 + images.width * 30));
    EXPECT_EQ(images.colour[middle + 1] == images.colour[middle], behind_mm > 0) << "grey: the shell";
  }
}

TEST(ShellToolLayers, E2_LayersBeyondEightAreCountedWithTheirShare) {
  ShellCase c;
  addScrew(c, 0.4);
  const native::ShellsJob job = c.job();
  const Result<native::SurfaceHits> hits = native::findSurfaces({job.tools, job.camera, glm::dvec3(0)}, {});
  ASSERT_TRUE(hits.ok());
  const ShellTruth truth(c);
  std::uint64_t beyond = 0;
  for (int y = 0; y < c.view.height_px; ++y)
    for (int x = 0; x < c.view.width_px; ++x) beyond += truth.at(x + 0.5, y + 0.5).tools.size() > 8;
  EXPECT_GT(beyond, 0u);
  EXPECT_EQ(hits->pixelsBeyond, beyond);
  EXPECT_GT(hits->largestResidual, 0.001);
  EXPECT_LE(hits->largestResidual, std::pow(0.6, 8));
}

// Triangles without area never get into a mesh; what is left of the tool is drawn.
TEST_P(ShellTools, E6_TrianglesWithoutAreaAreDroppedAndTheRestIsDrawn) {
  NEEDS_GL_UNLESS_NATIVE;
  ShellCase c;
  const PatientPoint middle = c.sources.volumes["v"]->grid().centre();
  MeshBuilder b;
  const auto p = b.vertex({-6, -8, -6}), q = b.vertex({6, -8, -6}), r = b.vertex({0, -8, 6});
  b.triangle(p, q, r), b.triangle(p, p, r), b.triangle(p, q, b.vertex({0, -8, -6}));
  b.triangle(p, q, b.vertex({NAN, 0, 0}));
  EXPECT_EQ(b.dropped().zeroArea, 2u);
  EXPECT_EQ(b.dropped().notFinite, 1u);
  c.addTool(*b.finish(), middle);
  expectTrueButForEdges(c, technique(), tolerance(ShellsMode::Max));
}

INSTANTIATE_TEST_SUITE_P(All, ShellTools, ::testing::ValuesIn(kShellTechniques), shellTechniqueName);

}  // namespace
}  // namespace vernier::test
