// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Align.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "vernier/base/Random.h"

namespace vernier::measure {
namespace {

constexpr int kSize = 128;
using Image = std::vector<float>;

ImageView view(const Image& v) { return {kSize, kSize, 1, SampleType::F32, std::as_bytes(std::span(v))}; }
double gauss(std::uint64_t seed, std::uint64_t i) {
  return std::sqrt(-2 * std::log(1 - randomUnit(seed, 2 * i))) *
         std::cos(2 * std::numbers::pi * randomUnit(seed, 2 * i + 1));
}

// A sum of blobs, known at every point of the plane, so that a shifted picture is no interpolation.
struct Scene {
  struct Blob {
    double x, y, sigma, height;
  };
  std::vector<Blob> blobs;
  explicit Scene(std::uint64_t seed) {
    for (std::uint64_t i = 0; i < 40; ++i)
      blobs.push_back({kSize * (1.4 * randomUnit(seed, 4 * i) - 0.2),
                       kSize * (1.4 * randomUnit(seed, 4 * i + 1) - 0.2), 2 + 8 * randomUnit(seed, 4 * i + 2),
                       300 * (randomUnit(seed, 4 * i + 3) - 0.3)});
  }
  double at(double x, double y) const {
    double v = 100;
    for (const Blob& b : blobs)
      v += b.height * std::exp(-((x - b.x) * (x - b.x) + (y - b.y) * (y - b.y)) / (2 * b.sigma * b.sigma));
    return v;
  }
};

struct Pose {
  double dx, dy, turn_deg;
};
// The point of the fixed picture that a pixel of the moving one shows.
ImagePoint fixedFromMoving(const Pose& p, double x, double y) {
  constexpr double kMiddle = (kSize - 1) / 2.0;
  const double c = std::cos(-p.turn_deg * std::numbers::pi / 180),
               s = std::sin(-p.turn_deg * std::numbers::pi / 180);
  const double u = x - kMiddle - p.dx, v = y - kMiddle - p.dy;
  return {c * u - s * v + kMiddle, s * u + c * v + kMiddle};
}

Image drawn(const std::function<double(double, double)>& f, double noise, std::uint64_t seed) {
  Image out;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      out.push_back(static_cast<float>(f(x, y) + noise * gauss(seed, out.size())));
  return out;
}
double sdOf(const Image& v) {
  double mean = 0, squares = 0;
  for (const float x : v) mean += static_cast<double>(x) / static_cast<double>(v.size());
  for (const float x : v) squares += (static_cast<double>(x) - mean) * (static_cast<double>(x) - mean);
  return std::sqrt(squares / static_cast<double>(v.size()));
}

// Distance between the found and the true place, RMS over a lattice of the picture.
double errorOf(const Alignment& a, const Pose& p, const Image& fixed) {
  double squares = 0;
  int n = 0;
  for (int y = 0; y < kSize; y += 9)
    for (int x = 0; x < kSize; x += 9, ++n) {
      const ImagePoint m = movingFromFixed(a, view(fixed), {static_cast<double>(x), static_cast<double>(y)});
      const ImagePoint back = fixedFromMoving(p, m.x, m.y);
      squares += (back.x - x) * (back.x - x) + (back.y - y) * (back.y - y);
    }
  return std::sqrt(squares / n);
}

// `snr` is signal SD to noise SD.
std::vector<double> trial(double snr, bool otherContrast, std::uint64_t draws = 200) {
  std::vector<double> errors;
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    const Scene scene(1000 + draw);
    const auto plain = [&](double x, double y) { return scene.at(x, y); };
    const double noise = sdOf(drawn(plain, 0, 0)) / snr;
    const Pose pose{16 * randomUnit(7, 3 * draw) - 8, 16 * randomUnit(7, 3 * draw + 1) - 8,
                    6 * randomUnit(7, 3 * draw + 2) - 3};
    const double gain = otherContrast ? 0.6 : 1, offset = otherContrast ? 40 : 0;
    const Image fixed = drawn(plain, noise, 2 * draw + 50);
    const Image moving = drawn(
        [&](double x, double y) {
          const ImagePoint p = fixedFromMoving(pose, x, y);
          return gain * scene.at(p.x, p.y) + offset;
        },
        gain * noise, 2 * draw + 51);
    const auto a = alignRigid(view(fixed), view(moving));
    EXPECT_TRUE(a.ok()) << "draw " << draw << ": " << a.error().text();
    if (!a) continue;
    errors.push_back(errorOf(*a, pose, fixed));
    if (!otherContrast) {
      EXPECT_LT(a->residualRms, 3 * noise + 1) << draw;
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

void expectExact(const std::vector<double>& errors, std::size_t draws = 200) {
  ASSERT_EQ(errors.size(), draws);
  EXPECT_LE(errors[draws / 2], 0.05);
  EXPECT_LE(errors[draws * 95 / 100 - 1], 0.1);
}

TEST(Align, WithinAFewHundredthsOfAPixelAtSnr20) { expectExact(trial(20, false)); }
TEST(Align, WithinAFewHundredthsOfAPixelAt20Decibels) { expectExact(trial(10, false)); }
TEST(Align, AnotherBrightnessAndContrastDoNotMatter) { expectExact(trial(20, true, 40), 40); }

TEST(Align, TheSameImageLiesOnItself) {
  const Scene scene(3);
  const Image v = drawn([&](double x, double y) { return scene.at(x, y); }, 5, 1);
  const auto a = alignRigid(view(v), view(v));
  ASSERT_TRUE(a.ok()) << a.error().text();
  EXPECT_NEAR(a->dx_px, 0, 1e-3);
  EXPECT_NEAR(a->dy_px, 0, 1e-3);
  EXPECT_NEAR(a->rotation_deg, 0, 1e-3);
  EXPECT_GT(a->correlation, 0.999);
}

std::string refusal(const Image& f, const Image& m) {
  const auto a = alignRigid(view(f), view(m));
  EXPECT_FALSE(a.ok());
  return a ? "" : a.error().sentence;
}

TEST(Align, PairsWithoutATrustworthyAnswerAreRefused) {
  const Scene one(11), two(99);
  const auto draw = [](const Scene& s) {
    return drawn([&](double x, double y) { return s.at(x, y); }, 3, 4);
  };
  const Image good = draw(one), other = draw(two);
  const Image flat(kSize * kSize, 7.0f);
  EXPECT_NE(refusal(good, flat).find("flat"), std::string::npos);
  EXPECT_NE(refusal(flat, flat).find("flat"), std::string::npos);
  const auto noise = [](std::uint64_t seed) { return drawn([](double, double) { return 50; }, 1, seed); };
  EXPECT_NE(refusal(noise(1), noise(2)), "");
  for (const double period : {8.0, 13.0, 21.3}) {
    const auto waves = [&](double shift, std::uint64_t seed) {
      return drawn(
          [&](double x, double y) {
            return 100 + 50 * std::sin(2 * std::numbers::pi * (x + shift) / period) +
                   50 * std::sin(2 * std::numbers::pi * y / period);
          },
          3, seed);
    };
    EXPECT_NE(refusal(waves(0, 1), waves(2.5, 2)).find("repeats"), std::string::npos) << period;
  }
  Image opposite = good;
  for (float& x : opposite) x = 500 - x;
  EXPECT_NE(refusal(good, opposite).find("opposite"), std::string::npos);
  EXPECT_NE(refusal(good, other), "");
  Image holed = good;
  holed[500] = std::nanf("");
  EXPECT_NE(refusal(good, holed).find("without data"), std::string::npos);
}

// NUMERICS H5: OpenCV's warp rounds places to 1/32 pixel and is for the eye alone.
TEST(Align, H5WarpedPicturesAreForTheEyeWithin8Levels) {
  const Scene scene(5);
  std::vector<std::uint8_t> picture;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      picture.push_back(static_cast<std::uint8_t>(std::clamp(scene.at(x, y), 0.0, 255.0)));
  const ImageView v{kSize, kSize, 1, SampleType::U8, std::as_bytes(std::span(picture))};
  Alignment a;
  a.dx_px = 3.37, a.dy_px = -1.81, a.rotation_deg = 2.2;
  const auto warped = warpedForDisplay(v, a);
  ASSERT_TRUE(warped.ok()) << warped.error().text();
  double most = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const ImagePoint p = movingFromFixed(a, v, {static_cast<double>(x), static_cast<double>(y)});
      if (!(p.x >= 0 && p.y >= 0 && p.x < kSize - 1 && p.y < kSize - 1)) continue;
      const auto i = static_cast<std::size_t>(p.x), j = static_cast<std::size_t>(p.y);
      const double u = p.x - static_cast<double>(i), w = p.y - static_cast<double>(j);
      const auto at = [&](std::size_t k, std::size_t l) {
        return static_cast<double>(picture[l * kSize + k]);
      };
      const double exact = (1 - w) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
                           w * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
      most = std::max(most, std::abs(exact - (*warped)[static_cast<std::size_t>(y * kSize + x)]));
    }
  EXPECT_LE(most, 8);
  EXPECT_GT(most, 0.51);  // it does round: whoever reads values from it gets other ones
  const std::vector<float> values(kSize * kSize);
  EXPECT_FALSE(warpedForDisplay(view(values), a).ok());
}

}  // namespace
}  // namespace vernier::measure
