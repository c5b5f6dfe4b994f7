// SPDX-License-Identifier: GPL-3.0-or-later
// Shells that crop box, clip planes and near distance cut open: caps.
#include "ShellCases.h"

namespace vernier::test {
namespace {

class ShellCuts : public ::testing::TestWithParam<const char*> {
 protected:
  std::string technique() const { return GetParam(); }
  bool native() const { return technique() == "shells.native"; }
  double tolerance() const { return native() ? 1e-6 : 1e-3; }  // lit by roots: 1e-4
  void expectEveryMode(ShellCase& c) const {
    if (!native() && !glDevice()) return;
    for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit})
      for (const double a : {0.0, 0.6})
        for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
          c.scene.camera.projection = projection;
          c.shells().mode = mode, c.shells().a = a, c.shells().b = 0.4;
          SCOPED_TRACE(c.plan(technique())->passes[0].params->dump());
          expectTruth(c, technique(), mode == ShellsMode::Lit && native() ? 1e-4 : tolerance());
        }
  }
};

TEST_P(ShellCuts, CropBox) {
  ShellCase c;
  c.scene.crop = CropBox{VoxelPoint(4.3, 3.7, 2.2), VoxelPoint(16.4, 15.1, 9.3)};
  expectEveryMode(c);
}

TEST_P(ShellCuts, ClipPlanes) {
  ShellCase c;
  const glm::dvec3 middle = c.sources.volumes["v"]->grid().centre().p;
  for (const glm::dvec3 n : {glm::dvec3(0.2, -0.9, 0.3), glm::dvec3(-0.7, 0.1, -0.5)})
    c.scene.clip.push_back({PatientVec(glm::normalize(n)), glm::dot(glm::normalize(n), middle) + 1.5});
  expectEveryMode(c);
}

// A crop box that is the volume's own box cuts nothing: the shells are closed there once, not twice.
TEST_P(ShellCuts, TheWholeBoxAsACropBoxChangesNothing) {
  if (!native() && !glDevice()) return;
  VolumeInfo info;
  info.grid = unitGrid(8, 7, 6);
  ShellCase c(volumeOf(info, randomValues<float>(8 * 7 * 6, 5, 0, 200)));
  c.shells().mode = ShellsMode::Sum;
  const Images whole = *c.draw(technique());
  c.scene.crop = CropBox{VoxelPoint(0, 0, 0), VoxelPoint(7, 6, 5)};
  const Images cropped = *c.draw(technique());
  for (std::size_t n = 0; n < whole.colour.size(); ++n) ASSERT_NEAR(whole.colour[n], cropped.colour[n], 1e-6);
  expectTruth(c, technique(), 5 * tolerance());
}

TEST_P(ShellCuts, E5_TheNearDistanceCutsTheBallAndItIsClosed) {
  ShellCase c;
  c.scene.camera.near_mm = length(c.sources.volumes["v"]->grid().centre() - c.job().camera.eye) - 1;
  c.scene.camera.distance_mm = length(c.sources.volumes["v"]->grid().centre() - c.job().camera.eye);
  expectEveryMode(c);
}

TEST_P(ShellCuts, CutAwayAltogether) {
  if (!native() && !glDevice()) return;
  ShellCase c;
  c.scene.clip.push_back({PatientVec(0, 0, 1), -1e5});
  const Images images = *c.draw(technique());
  for (const float d : images.depth) ASSERT_EQ(d, kNothing_mm);
}

INSTANTIATE_TEST_SUITE_P(All, ShellCuts, ::testing::ValuesIn(kShellTechniques), shellTechniqueName);

}  // namespace
}  // namespace vernier::test
