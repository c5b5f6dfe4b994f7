// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering: the SIMD kernel and the one in double against rays in long double; what is left out
// changes no bit; threads; cuts; tools.
#include "vernier/native/VolumeRender.h"

#include <gtest/gtest.h>

#include "VolumeCases.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {

using native::VolumeRenderJob;
using test::BruteCaster;
using test::differenceFromBrute;
using test::VolumeCase;
using test::volumeCase;

constexpr Projection kBoth[] = {Projection::Orthographic, Projection::Perspective};

void setShading(VolumeCase& c, ShadingModel model) {
  c.job.shading = model;
  c.job.material.ambientColour = {.9, .5, .3}, c.job.material.diffuseColour = {.4, .8, .6};
}

TEST(VolumeRender, KernelEqualsLongDouble) {
  for (const Projection p : kBoth)
    for (const Classification how : {Classification::Post, Classification::PreIntegrated})
      for (const ShadingModel model :
           {ShadingModel::None, ShadingModel::GlobalAmbient, ShadingModel::ColourPerVoxel}) {
        VolumeCase c = volumeCase(test::balls(), test::softFunction(), test::turnedCamera(p));
        c.job.classification = how;
        setShading(c, model);
        c.useVisible();
        ASSERT_TRUE(native::rendersFast(c.job));
        // The pre-integrated table is read between its entries, and its knots stand between them.
        const double within = how == Classification::Post ? 0.02 : 0.3;
        EXPECT_LT(differenceFromBrute(c, c.draw()), within) << int(p) << int(how) << int(model);
      }
}

TEST(VolumeRender, EveryTypeEqualsLongDouble) {
  const auto check = [](auto type, bool fast) {
    using T = decltype(type);
    VolumeCase c =
        volumeCase(test::balls<T>(), test::softFunction(sizeof(T) == 1 ? 120 : 1000), test::turnedCamera());
    c.useVisible();
    EXPECT_EQ(native::rendersFast(c.job), fast);
    EXPECT_LT(differenceFromBrute(c, c.draw()), 0.02);
    setShading(c, ShadingModel::ColourPerVoxel);
    EXPECT_LT(differenceFromBrute(c, c.draw()), 0.02);
  };
  check(std::uint8_t{}, true), check(std::uint16_t{}, true), check(std::int16_t{}, true),
      check(float{}, true);
  check(std::int8_t{}, false), check(std::uint32_t{}, false), check(std::int32_t{}, false);
}

// Values with structure at every voxel, up to the faces of the box, a falling rescale, a flat grid.
TEST(VolumeRender, NoiseUpToTheFacesEqualsLongDouble) {
  for (const double slope : {1.0, -0.5}) {
    VolumeInfo info = test::obliqueVolume(19, 13, 2);
    info.rescale = {ModalityRescale{slope, 40}};
    const auto volume = test::volumeOf(info, test::randomValues<std::int16_t>(19 * 13 * 2, 3, 0, 1000));
    VolumeCase c = volumeCase(volume, test::softFunction(), test::turnedCamera(Projection::Perspective));
    if (slope < 0) {
      TransferFunction f = test::softFunction();
      for (ColourPoint& p : f.colours) p.value -= 500;
      for (OpacityPoint& p : f.opacities) p.value -= 500;
      c = volumeCase(volume, f, test::turnedCamera(Projection::Perspective));
    }
    c.useVisible();
    setShading(c, ShadingModel::ColourPerVoxel);
    c.job.lights = {Light{PatientVec(1, 2, 3), {1, .5, .5}}, Light{PatientVec(-3, 1, 0), {.2, .9, .3}},
                    Light{}};
    c.job.material.power = 7.5;
    EXPECT_LT(differenceFromBrute(c, c.draw(), 200), 0.03) << slope;
    c.job.material.power = 0;
    EXPECT_LT(differenceFromBrute(c, c.draw(), 200), 0.03) << slope;
  }
}

TEST(VolumeRender, LinearRuleEqualsLongDouble) {
  VolumeCase c = volumeCase(test::balls(), test::softFunction(), test::turnedCamera());
  const Images exact = c.draw();
  c.job.opacity = OpacityRule::Linear;
  c.setStep(c.job.step_mm);
  EXPECT_LT(differenceFromBrute(c, c.draw()), 0.02);
  EXPECT_NE(exact.colour, c.draw().colour);
}

TEST(VolumeRender, CutsMoveNoSample) {
  for (const Projection p : kBoth) {
    Scene scene;
    scene.clip = {HalfSpace{normalize(PatientVec(1, 2, 0.5)), 0}};
    scene.background = {.2, .4, .6};
    const auto volume = test::balls();
    scene.clip[0].offset_mm = glm::dot(scene.clip[0].normal.v, volume->grid().centre().p);
    VolumeCase c = volumeCase(volume, test::softFunction(), test::turnedCamera(p), {48, 40}, scene);
    c.useVisible();
    EXPECT_LT(differenceFromBrute(c, c.draw(), 200), 0.02);
    // What the plane keeps and what it takes, one over the other, are the whole ray.
    VolumeCase rest = volumeCase(volume, test::softFunction(), test::turnedCamera(p), {48, 40}, scene);
    rest.job.region.back() = {-scene.clip[0].normal, -scene.clip[0].offset_mm};
    VolumeCase whole = volumeCase(volume, test::softFunction(), test::turnedCamera(p), {48, 40});
    const BruteCaster kept(c.job), taken(rest.job), all(whole.job);
    for (int n = 0; n < 200; ++n) {
      const double x = 48 * randomUnit(9, std::uint64_t(2 * n)),
                   y = 40 * randomUnit(9, std::uint64_t(2 * n + 1));
      EXPECT_NEAR(kept.at(x, y).through * taken.at(x, y).through, all.at(x, y).through, 1e-12);
    }
  }
}

std::vector<VolumeCase> kinds() {
  std::vector<VolumeCase> out;
  for (const Projection p : kBoth)
    for (const Classification how : {Classification::Post, Classification::PreIntegrated})
      for (const ShadingModel model : {ShadingModel::None, ShadingModel::ColourPerVoxel}) {
        Scene scene;
        scene.background = {.1, .2, .3};
        VolumeCase c =
            volumeCase(test::balls(), test::softFunction(), test::turnedCamera(p), {75, 61}, scene);
        c.job.classification = how;
        setShading(c, model);
        out.push_back(std::move(c));
      }
  return out;
}

TEST(VolumeRender, WhatIsLeftOutChangesNoBit) {
  for (VolumeCase& c : kinds()) {
    for (const double step : {0.2, 0.8, 1.1}) {
      c.setStep(step);
      c.job.visible = nullptr;
      const Images all = c.draw();
      c.useVisible();
      const Images some = c.draw();
      EXPECT_EQ(all.colour, some.colour);
      EXPECT_EQ(all.depth, some.depth);
      EXPECT_LT(some.counters.samples, all.counters.samples * 2 / 3);
    }
  }
}

// Noise: bricks of all kinds of ranges, at an opacity that only some reach.
TEST(VolumeRender, WhatIsLeftOutOfNoiseChangesNoBit) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const VolumeInfo info = test::obliqueVolume(33, 26, 31);
    auto values = test::randomValues<std::uint8_t>(33 * 26 * 31, seed, 0, 100);
    for (std::size_t n = 0; n < values.size(); n += 997) values[n] = 200;
    Camera camera = test::turnedCamera(seed % 2 ? Projection::Perspective : Projection::Orthographic);
    camera.azimuth_deg = 61.0 * double(seed), camera.elevation_deg = 40.0 - 25.0 * double(seed);
    if (seed == 3) camera.distance_mm = 5, camera.fov_deg = 120, camera.zoom = 1;  // inside
    const TransferFunction f{{{0, {1, 1, 1}}}, {{120, 0}, {180, .9}}, 1};
    VolumeCase c = volumeCase(test::volumeOf(info, values), f, camera, {80, 60});
    for (const Classification how : {Classification::Post, Classification::PreIntegrated}) {
      c.job.classification = how;
      c.job.visible = nullptr;
      const Images all = c.draw();
      c.useVisible();
      const Images some = c.draw();
      EXPECT_EQ(all.colour, some.colour) << seed;
      EXPECT_EQ(all.depth, some.depth) << seed;
    }
  }
}

// Pixels much smaller than voxels and steps, about a corner of the box and in its middle, along the axes and
// aslant: here the outlines of bricks are as tight as they get, and samples are moved to the box sideways.
TEST(VolumeRender, WhatIsLeftOutUnderALensChangesNoBit) {
  VolumeInfo info;
  info.grid = test::unitGrid(33, 33, 33);
  std::vector<std::uint8_t> values(33 * 33 * 33, 0);
  for (std::size_t n = 0; n < values.size(); ++n) {
    const std::size_t x = n % 33, y = n / 33 % 33, z = n / 1089;
    // Every second brick, up to the faces of the box; dark between two of them.
    const auto between = [](std::size_t i) { return i % 4 == 0 && i != 0 && i != 32; };
    if ((x / 4 + y / 4 + z / 4) % 2 == 0 && !between(x) && !between(y) && !between(z)) values[n] = 200;
  }
  const TransferFunction f{{{0, {1, 1, 1}}}, {{10, 0}, {180, .4}}, 1};
  const auto volume = test::volumeOf(info, values);
  int differs = 0;
  for (const Projection p : kBoth)
    for (const double azimuth : {0.0, 37.0, 225.0})
      for (const double elevation : {0.0, 20.0})
        for (const PatientPoint& target :
             {PatientPoint(0, 0, 0), PatientPoint(16, 16, 16), PatientPoint(4, 0, 6), PatientPoint(8, 0, 2)})
          for (const double step : {0.3, 1.7}) {
            Camera camera;
            camera.azimuth_deg = azimuth, camera.elevation_deg = elevation, camera.projection = p;
            camera.target = target, camera.zoom = 12;
            VolumeCase c = volumeCase(volume, f, camera, {40, 36});
            c.job.classification = step < 1 ? Classification::Post : Classification::PreIntegrated;
            c.setStep(step);
            const Images all = c.draw();
            c.useVisible();
            const Images some = c.draw();
            differs += all.colour != some.colour || all.depth != some.depth;
          }
  EXPECT_EQ(differs, 0);
}

TEST(VolumeRender, BitEqualForAnyThreads) {
  const int before = threads();
  for (VolumeCase& c : kinds()) {
    c.useVisible();
    std::vector<float> first;
    for (const int n : {1, 2, 3}) {
      setThreads(n);
      const Images images = c.draw();
      if (first.empty()) first = images.colour;
      EXPECT_EQ(first, images.colour);
    }
  }
  setThreads(before);
}

TEST(VolumeRender, EarlyTerminationLeavesOutWhatItSays) {
  VolumeCase c = volumeCase(test::balls(), test::softFunction(), test::turnedCamera(), {96, 80});
  const Images all = c.draw();
  for (const double least : {1e-2, native::kReviewLeastLight, native::kReferenceLeastLight}) {
    c.job.leastLight = least;
    const Images some = c.draw();
    EXPECT_LT(some.counters.samples, all.counters.samples);
    double most = 0;
    for (std::size_t n = 0; n < all.colour.size(); ++n)
      most = std::max(most, double(std::abs(all.colour[n] - some.colour[n])));
    EXPECT_LE(most, least);
    EXPECT_GT(most, 0);
  }
}

TEST(VolumeRender, NoDataIsTransparent) {
  VolumeInfo info = test::obliqueVolume(40, 36, 28);
  info.noData = NoDataRange{-2000, -2000};
  std::vector<std::int16_t> v(40 * 36 * 28, 600);
  for (int k = 0; k < 28; ++k)
    for (int j = 0; j < 36; ++j)
      for (int i = 0; i < 40; ++i)
        if (i < 20 || (i + 7 * j + 3 * k) % 41 == 0) v[std::size_t(i + 40 * (j + 36 * k))] = -2000;
  const TransferFunction f{{{0, {1, .5, .25}}}, {{0, .05}}, 1};
  for (const ShadingModel model : {ShadingModel::None, ShadingModel::ColourPerVoxel}) {
    VolumeCase c = volumeCase(test::volumeOf(info, v), f, test::turnedCamera());
    setShading(c, model);
    EXPECT_FALSE(native::rendersFast(c.job));  // nobody says where the holes are
    const Images general = c.draw();
    c.useVisible();
    EXPECT_TRUE(native::rendersFast(c.job));
    const Images fast = c.draw();
    double most = 0, brightest = 0;
    for (std::size_t n = 0; n < fast.colour.size(); ++n) {
      most = std::max(most, 255 * double(std::abs(fast.colour[n] - general.colour[n])));
      if (n % 4 != 3) brightest = std::max(brightest, double(fast.colour[n]));
    }
    EXPECT_LT(most, 0.02);
    EXPECT_GT(brightest, 0.3);
  }
}

TEST(VolumeRender, NearestAndPreAreWhatTheySay) {
  // Along an axis through voxel centres both can be told by hand: steps of half a voxel.
  VolumeInfo info;
  info.grid = test::unitGrid(4, 4, 4);
  std::vector<std::int16_t> v;
  for (int n = 0; n < 64; ++n) v.push_back(static_cast<std::int16_t>(100 * (n / 16)));  // by slice
  const TransferFunction f{{{0, {0, 0, 0}}, {300, {1, .5, 0}}}, {{0, 0}, {100, .4}, {300, .2}}, 1};
  Camera camera;
  camera.elevation_deg = 90, camera.target = PatientPoint(1.5, 1.5, 1.5), camera.distance_mm = 4.5;
  VolumeCase c = volumeCase(test::volumeOf(info, v), f, camera, {1, 1});
  c.setStep(0.5);
  // Seen from above: slices 3 to 0, samples 0.25 mm in.
  const auto expected = [&](auto shown) {
    double colour = 0, through = 1;
    for (int k = 0; k < 6; ++k) {
      const auto [c0, a] = shown(3 - 0.5 * k - 0.25);
      const double opacity = 1 - std::sqrt(1 - a);
      colour += through * opacity * c0, through *= 1 - opacity;
    }
    return colour;
  };
  const auto lookup = [&](double value) { return std::pair(colourAt(f, value).x, opacityAt(f, value)); };
  EXPECT_NEAR(c.draw().colour[0], expected([&](double z) { return lookup(100 * z); }), 1e-5);
  c.job.interpolation = Interpolation::Nearest;
  EXPECT_NEAR(c.draw().colour[0], expected([&](double z) { return lookup(100 * std::round(z)); }), 1e-7);
  c.job.interpolation = Interpolation::Linear, c.job.classification = Classification::Pre;
  EXPECT_NEAR(c.draw().colour[0], expected([&](double z) {
                const double t = z - std::floor(z);
                const auto low = lookup(100 * std::floor(z)), high = lookup(100 * std::ceil(z));
                const double a = std::lerp(low.second, high.second, t);
                return std::pair(std::lerp(low.first * low.second, high.first * high.second, t) / a, a);
              }),
              1e-7);
}

TEST(VolumeRender, RefusesJobsThatDoNotFit) {
  VolumeCase c = volumeCase(test::balls(), test::softFunction());
  Images images;
  const auto code = [&] { return native::renderVolume(c.job, images).error().code; };
  c.job.step_mm *= 2;  // the table is of another step
  EXPECT_EQ(code(), ErrorCode::Internal);
  c.setStep(1);
  c.job.function = nullptr;
  EXPECT_EQ(code(), ErrorCode::Internal);
  c.job.function = c.function.get();
  c.job.volume = nullptr;
  EXPECT_EQ(code(), ErrorCode::Internal);
  c.job.volume = c.volume.get();
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(native::renderVolume(c.job, images, stop.get_token()).error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier
