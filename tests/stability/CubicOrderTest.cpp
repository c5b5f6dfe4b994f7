// SPDX-License-Identifier: GPL-3.0-or-later
// How fast interpolation converges to a smooth field when the voxels shrink: linear with the second power of
// the spacing, cubic with the third (Keys 1981). And what cubic does at a sharp edge.
#include <cmath>

#include "../unit/volume/Grids.h"
#include "RenderForTest.h"
#include "vernier/plan/PictureGeometry.h"

namespace vernier {
namespace {

using namespace vernier::test;

constexpr double kSigma_mm = 4, kPeak = 1000;
double gaussian(glm::dvec3 p) { return kPeak * std::exp(-glm::dot(p, p) / (2 * kSigma_mm * kSigma_mm)); }

std::shared_ptr<const Volume> sampledAt(double spacing_mm) {
  const auto n = static_cast<std::int64_t>(std::lround(32 / spacing_mm)) + 1;
  GridGeometry g = unitGrid(n, n, n);
  g.patientFromVoxel.linear = glm::dmat3(spacing_mm);
  g.patientFromVoxel.translation = glm::dvec3(-16 + 0.01, -16 - 0.02, -16 + 0.03);
  std::vector<float> values;
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t j = 0; j < n; ++j)
      for (std::int64_t i = 0; i < n; ++i)
        values.push_back(
            static_cast<float>(gaussian((g.patientFromVoxel * VoxelPoint(glm::dvec3(i, j, k))).p)));
  VolumeInfo info;
  info.grid = g;
  return volumeOf<float>(std::move(info), values);
}

// RMS of an oblique slice through the bump, in the field's units.
double rmsError(double spacing_mm, Interpolation interpolation) {
  Scene scene;
  SliceLayer layer;
  layer.source = "v";
  layer.plane = {PatientPoint(0.3, 0.2, -0.4), PatientVec(0.4, -0.7, 0.6), PatientVec(0.1, 0.3, 1)};
  layer.interpolation = interpolation;
  layer.window = VoiWindow{500, 1000, VoiFunction::LinearExact, ""};
  scene.layers = {layer};
  scene.camera.height_mm = 16;
  const View view{96, 96, true};
  Sources sources;
  sources.volumes["v"] = sampledAt(spacing_mm);
  const auto r = renderWith("mpr.native", scene, view, sources);
  EXPECT_TRUE(r.ok());
  const auto picture = slicePicture(layer, scene.camera, view, *sources.volumes["v"]);
  double sum = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const double truth =
          gaussian((picture->origin + (x + 0.5) * picture->right + (y + 0.5) * picture->down).p);
      const double e = valueOf(*r, x, y) - truth;
      sum += e * e;
    }
  return std::sqrt(sum / (96 * 96));
}

TEST(F1_OrderOfInterpolation, LinearIsSecondCubicIsThird) {
  const double spacings[] = {2, 1, 0.5};
  for (const Interpolation how : {Interpolation::Linear, Interpolation::Cubic}) {
    const bool cubic = how == Interpolation::Cubic;
    double last = 0;
    for (const double spacing : spacings) {
      const double rms = rmsError(spacing, how);
      const double order = last > 0 ? std::log2(last / rms) : 0;
      std::printf("%s, voxels of sigma / %.0f: RMS %.4g of a peak of 1000, order %.2f\n",
                  cubic ? "cubic" : "linear", kSigma_mm / spacing, rms, order);
      if (last > 0) {
        EXPECT_NEAR(order, cubic ? 3.0 : 2.0, cubic ? 0.6 : 0.15) << spacing;
      }
      last = rms;
    }
  }
}

TEST(CubicAtAnEdge, OvershootsByWhatIsStatedAndNoMore) {
  GridGeometry g = unitGrid(24, 24, 24);
  std::vector<std::int16_t> values(24 * 24 * 24);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = n % 24 < 12 ? 0 : 1000;
  VolumeInfo info;
  info.grid = g;
  Sources sources;
  sources.volumes["v"] = volumeOf<std::int16_t>(std::move(info), values);
  Scene scene;
  SliceLayer layer;
  layer.source = "v";
  layer.plane = {g.centre(), PatientVec(0, 0, -1), PatientVec(0, -1, 0)};
  layer.interpolation = Interpolation::Cubic;
  layer.window = VoiWindow{500, 1000, VoiFunction::LinearExact, ""};
  scene.layers = {layer};
  scene.camera.height_mm = 8;
  const auto r = renderWith("mpr.native", scene, {400, 400, true}, sources);
  ASSERT_TRUE(r.ok());
  float least = 1e9f, greatest = -1e9f;
  for (float v : r->frame.images.values) least = std::min(least, v), greatest = std::max(greatest, v);
  EXPECT_NEAR(greatest, 1000 + 2000.0 / 27, 0.2);  // 7.4 %
  EXPECT_NEAR(least, -2000.0 / 27, 0.2);
}

}  // namespace
}  // namespace vernier
