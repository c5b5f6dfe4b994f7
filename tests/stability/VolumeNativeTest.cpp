// SPDX-License-Identifier: GPL-3.0-or-later
// Cases F of volume rendering by native rays. F5 to F7 are those of slices on GL.
#include <gtest/gtest.h>

#include "../unit/native/VolumeCases.h"

namespace vernier {
namespace {

using test::BruteCaster;
using test::VolumeCase;
using test::volumeCase;

constexpr Projection kBoth[] = {Projection::Orthographic, Projection::Perspective};

TransferFunction medium(double perMm) { return {{{0, {.9, .6, .3}}}, {{0, -std::expm1(-perMm)}}, 1}; }

template <class T = std::int16_t>
std::shared_ptr<const Volume> constantVolume() {
  return test::volumeOf(test::obliqueVolume(24, 20, 16), std::vector<T>(24 * 20 * 16, T(100)));
}

// Largest difference from c (1 - exp(-tau L)) over all pixels, in levels.
double offClosedForm(const VolumeCase& c, double perMm) {
  const Images images = c.draw();
  const glm::dvec3 bg(c.job.background.r, c.job.background.g, c.job.background.b), own(.9, .6, .3);
  double most = 0;
  for (int y = 0; y < images.height; ++y)
    for (int x = 0; x < images.width; ++x) {
      const RaySpan span = spanOf(c.job.camera.ray(x + 0.5, y + 0.5), c.job.region,
                                  c.job.camera.near_mm * c.job.camera.rayPerDepth(x + 0.5, y + 0.5));
      const double left = span.empty() ? 1 : std::exp(-perMm * (span.exit_mm - span.entry_mm));
      const glm::dvec3 truth = own * (1 - left) + bg * left;
      for (int k = 0; k < 3; ++k) {
        const double is = double(images.colour[4 * std::size_t(x + images.width * y) + std::size_t(k)]);
        EXPECT_FALSE(std::isnan(is));
        most = std::max(most, 255 * std::abs(is - truth[k]));
      }
    }
  return most;
}

TEST(VolumeStability, F1_ConstantVolumeIsExponential) {
  Scene scene;
  scene.background = {.2, .1, .4};
  scene.clip = {HalfSpace{normalize(PatientVec(1, 1, -2)), 0}};
  const auto volume = constantVolume();
  scene.clip[0].offset_mm = glm::dot(scene.clip[0].normal.v, volume->grid().centre().p) + 3;
  for (const Projection p : kBoth)
    for (const double perMm : {0.02, 0.3})
      for (const Classification how :
           {Classification::Post, Classification::Pre, Classification::PreIntegrated}) {
        VolumeCase c = volumeCase(volume, medium(perMm), test::turnedCamera(p), {64, 48}, scene);
        c.job.classification = how;
        c.job.leastLight = native::kReferenceLeastLight;
        for (const double step : {0.8, 0.1}) {
          c.setStep(step);
          c.useVisible();
          EXPECT_LT(offClosedForm(c, perMm), 0.25)
              << int(p) << " " << perMm << " " << int(how) << " " << step;
        }
      }
}

TEST(VolumeStability, F3_StepChangesLeaveTheMediumAlone) {
  const auto volume = constantVolume();
  for (const double factor : {0.5, 1.0, 2.0, 4.0}) {
    VolumeCase c = volumeCase(volume, medium(0.1), test::turnedCamera(), {64, 48});
    c.setStep(0.8 * factor);
    EXPECT_LT(offClosedForm(c, 0.1), 0.5) << factor;
  }
}

// The papers' approximation stays wrong however small the step is.
TEST(VolumeStability, F2_LinearOpacityDoesNotConverge) {
  VolumeCase c = volumeCase(constantVolume(), medium(0.3), test::turnedCamera(), {64, 48});
  c.job.opacity = OpacityRule::Linear;
  for (const double step : {0.8, 0.4, 0.2, 0.1}) {
    c.setStep(step);
    EXPECT_GT(offClosedForm(c, 0.3), 2);
  }
}

// A Gaussian in whole numbers fine enough that they don't count, and a function that is smooth to its table.
template <class T>
std::shared_ptr<const Volume> gaussian() {
  VolumeInfo info;
  info.grid = test::unitGrid(33, 33, 33);
  const double most = sizeof(T) == 2 ? 30000 : 1e9;
  std::vector<T> v;
  for (int k = 0; k < 33; ++k)
    for (int j = 0; j < 33; ++j)
      for (int i = 0; i < 33; ++i) {
        const double r2 = (i - 16.0) * (i - 16.0) + (j - 16.0) * (j - 16.0) + (k - 16.0) * (k - 16.0);
        v.push_back(T(most * std::exp(-r2 / (2 * 5.0 * 5.0))));
      }
  info.rescale = {ModalityRescale{1 / most, 0}};
  return test::volumeOf(info, v);
}

TransferFunction smoothFunction() {
  TransferFunction f;
  for (int n = 0; n <= 2000; ++n) {
    const double x = n / 2000.0, s = std::pow(std::sin(1.5 * x), 3);
    f.colours.push_back({x, {x * x, 1 - x * x, 0.5 + 0.4 * std::sin(3 * x)}});
    f.opacities.push_back({x, 0.25 * s});
  }
  return f;
}

double rms(const Images& a, const Images& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.colour.size(); ++n)
    sum += std::pow(255 * (double(a.colour[n]) - double(b.colour[n])), 2);
  return std::sqrt(sum / double(a.colour.size()));
}

TEST(VolumeStability, F2_SecondOrderInTheStep) {
  for (const Projection p : kBoth)
    for (const bool fast : {false, true}) {
      const auto volume = fast ? gaussian<std::int16_t>() : gaussian<std::int32_t>();
      Camera camera = test::turnedCamera(p);
      camera.zoom = 1.7;
      // Cut through the middle: a sum of even steps over what vanishes at both ends would be better than
      // that.
      Scene scene;
      scene.clip = {HalfSpace{normalize(PatientVec(-0.3, -1, 0.4)), 0}};
      scene.clip[0].offset_mm = glm::dot(scene.clip[0].normal.v, volume->grid().centre().p);
      scene.clip[0] = {-scene.clip[0].normal, -scene.clip[0].offset_mm};
      VolumeCase c = volumeCase(volume, smoothFunction(), camera, {36, 32}, scene);  // 1152 rays
      ASSERT_EQ(native::rendersFast(c.job), fast);
      const auto draw = [&](double step) {
        c.setStep(step);
        return c.draw();
      };
      const Images truth = draw(1.0 / 48);
      double before = rms(draw(1), truth);
      EXPECT_GT(before, 0.02);
      for (const double step : {0.5, 0.25, 0.125}) {
        const double now = rms(draw(step), truth);
        EXPECT_NEAR(std::log2(before / now), 2.0, 0.1)
            << int(p) << fast << " step " << step << " rms " << now;
        before = now;
      }
    }
}

// The mutant: whole steps where a ray ends within one.
TEST(VolumeStability, F2_UnsplitEndsAreOfFirstOrder) {
  VolumeCase c = volumeCase(constantVolume(), medium(0.1), test::turnedCamera(), {40, 32});
  const auto error = [&](double step) {
    c.job.step_mm = step;
    BruteCaster whole(c.job), split(c.job);
    whole.splitsEnds = false;
    double sum = 0, splitSum = 0;
    int count = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 40; ++x) {
        const RaySpan span = spanOf(c.job.camera.ray(x + 0.5, y + 0.5), c.job.region, 0);
        if (span.empty()) continue;
        const double truth = std::exp(-0.1 * (span.exit_mm - span.entry_mm));
        sum += std::pow(255 * (whole.at(x + 0.5, y + 0.5).through - truth), 2), ++count;
        splitSum += std::pow(255 * (split.at(x + 0.5, y + 0.5).through - truth), 2);
      }
    EXPECT_LT(std::sqrt(splitSum / count), 1e-6);
    return std::sqrt(sum / count);
  };
  const double coarse = error(0.8), fine = error(0.1);
  EXPECT_NEAR(std::log2(coarse / fine) / 3, 1.0, 0.2);
}

TEST(VolumeStability, F4_OpacitiesOfZeroOneAndNearlyOne) {
  const TransferFunction f{{{0, {0, .5, 1}}, {1000, {1, 1, 1}}},
                           {{100, 0}, {300, 1 - 1e-7}, {400, 1}, {500, 1}, {500, 0}, {700, 1e-7}, {900, 1}},
                           0.7};
  for (const Classification how : {Classification::Post, Classification::Pre, Classification::PreIntegrated})
    for (const ShadingModel model : {ShadingModel::None, ShadingModel::ColourPerVoxel}) {
      VolumeCase c = volumeCase(test::balls(), f, test::turnedCamera(), {64, 48});
      c.job.classification = how, c.job.shading = model;
      c.useVisible();
      const Images images = c.draw();
      for (const float x : images.colour) ASSERT_TRUE(x >= 0 && x <= 1.00001f);
    }
  // 1 ends the ray: one sample, not a whole row of them.
  const TransferFunction wall{{{0, {1, 1, 1}}}, {{0, 1}}, 1};
  VolumeCase c = volumeCase(constantVolume(), wall, test::turnedCamera(), {64, 48});
  c.job.leastLight = native::kReviewLeastLight;
  const Images images = c.draw();
  std::size_t rays = 0;
  for (const float d : images.depth) rays += std::isfinite(d);
  EXPECT_GT(rays, 500u);
  // A ray that begins within a step has the rest of it as its first one; both are opaque.
  EXPECT_LE(images.counters.samples, rays + rays / 2);
}

TEST(VolumeStability, F8_AnEyeInsideSeesNoMissingWedge) {
  Camera camera = test::turnedCamera(Projection::Perspective);
  camera.fov_deg = 130, camera.zoom = 1, camera.distance_mm = 0.5;
  for (const double near : {0.0, 1.5})
    for (const double perMm : {0.02, 0.2}) {
      camera.near_mm = near;
      VolumeCase c = volumeCase(constantVolume(), medium(perMm), camera, {96, 64});
      c.useVisible();
      EXPECT_LT(offClosedForm(c, perMm), 0.25);
      const Images images = c.draw();
      float least = 1;
      for (std::size_t n = 0; n < images.colour.size(); n += 4) least = std::min(least, images.colour[n]);
      EXPECT_GT(least, 0.02);  // on every ray there is some of the medium
    }
  VolumeCase c = volumeCase(test::balls(), test::softFunction(), camera, {96, 64});
  c.useVisible();
  EXPECT_LT(test::differenceFromBrute(c, c.draw()), 0.02);
}

// A peak that steps jump over: samples hit it by chance, integrals do not.
TEST(VolumeStability, F9_FunctionNarrowerThanAStep) {
  const TransferFunction f{{{0, {1, .8, .6}}}, {{395, 0}, {400, .9}, {405, 0}}, 1};
  VolumeCase c = volumeCase(test::balls(), f, test::turnedCamera(), {64, 48});
  c.setStep(1.0 / 64);
  const Images truth = c.draw();
  c.setStep(0.8);
  const double post = rms(c.draw(), truth);
  c.job.classification = Classification::PreIntegrated;
  const double integrated = rms(c.draw(), truth);
  EXPECT_GT(post, 2);
  EXPECT_LT(integrated, 0.35 * post) << "post " << post;
}

}  // namespace
}  // namespace vernier
