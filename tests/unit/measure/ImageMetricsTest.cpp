// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/ImageMetrics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "vernier/base/Random.h"

namespace vernier::measure {
namespace {

template <class T>
constexpr SampleType kTypeOf = sizeof(T) == 1   ? SampleType::U8
                               : sizeof(T) == 2 ? SampleType::U16
                                                : SampleType::F32;
template <class T>
ImageView view(const std::vector<T>& v, int width, int height, int channels = 1) {
  return {width, height, channels, kTypeOf<T>, std::as_bytes(std::span(v))};
}

std::vector<double> noise(std::size_t n, std::uint64_t seed) {
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = randomUnit(seed, i);
  return out;
}
template <class T>
std::vector<T> scaled(const std::vector<double>& v, double by) {
  std::vector<T> out;
  for (const double x : v) out.push_back(static_cast<T>(x * by));
  return out;
}

// The formula as it stands in the paper, every window by itself, in long double.
double bruteSsim(const std::vector<double>& a, const std::vector<double>& b, int w, int h, double range) {
  long double weight[11][11], all = 0;
  for (int y = -5; y <= 5; ++y)
    for (int x = -5; x <= 5; ++x)
      all += weight[y + 5][x + 5] = std::exp(-static_cast<long double>(x * x + y * y) / (2 * 1.5L * 1.5L));
  const long double c1 = std::pow(0.01L * range, 2), c2 = std::pow(0.03L * range, 2);
  long double sum = 0;
  for (int cy = 5; cy < h - 5; ++cy)
    for (int cx = 5; cx < w - 5; ++cx) {
      long double ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
      const auto each = [&](auto&& f) {
        for (int y = -5; y <= 5; ++y)
          for (int x = -5; x <= 5; ++x) {
            const auto i = static_cast<std::size_t>((cy + y) * w + cx + x);
            f(weight[y + 5][x + 5] / all, static_cast<long double>(a[i]), static_cast<long double>(b[i]));
          }
      };
      each([&](long double k, long double p, long double q) { ma += k * p, mb += k * q; });
      each([&](long double k, long double p, long double q) {
        va += k * (p - ma) * (p - ma), vb += k * (q - mb) * (q - mb), cov += k * (p - ma) * (q - mb);
      });
      sum += (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    }
  return static_cast<double>(sum / ((w - 10) * (h - 10)));
}

template <class T>
void identicalIsExactlyZero(double scale, int channels) {
  const auto a = scaled<T>(noise(static_cast<std::size_t>(40 * 30 * channels), 3), scale);
  const auto m = compareImages(view(a, 40, 30, channels), view(a, 40, 30, channels));
  ASSERT_TRUE(m.ok()) << m.error().text();
  EXPECT_EQ(m->max, 0);
  EXPECT_EQ(m->mean, 0);
  EXPECT_EQ(m->rmse, 0);
  EXPECT_EQ(m->differing, 0);
  EXPECT_TRUE(std::isinf(m->psnr_dB) && m->psnr_dB > 0);
  EXPECT_EQ(m->ssim, 1.0);
  if (channels >= 3 && sizeof(T) < 4) {
    EXPECT_EQ(m->ciede2000_max, 0.0);
    EXPECT_EQ(m->ciede2000_mean, 0.0);
  } else {
    EXPECT_FALSE(m->ciede2000_max);
  }
}

TEST(ImageMetrics, IdenticalIsExactlyZeroOfEveryDepthAndColour) {
  for (const int channels : {1, 3, 4}) {
    identicalIsExactlyZero<std::uint8_t>(256, channels);
    identicalIsExactlyZero<std::uint16_t>(65536, channels);
    identicalIsExactlyZero<float>(3000, channels);
  }
}

TEST(ImageMetrics, NumbersByHand) {
  const std::vector<std::uint8_t> a = {10, 20, 30, 40}, b = {10, 23, 26, 40};
  const auto m = compareImages(view(a, 2, 2), view(b, 2, 2));
  ASSERT_TRUE(m.ok());
  EXPECT_EQ(m->compared, 4u);
  EXPECT_EQ(m->max, 4);
  EXPECT_DOUBLE_EQ(m->mean, 7.0 / 4);
  EXPECT_DOUBLE_EQ(m->rmse, 2.5);
  EXPECT_DOUBLE_EQ(m->bias, -0.25);
  EXPECT_DOUBLE_EQ(m->differing, 0.5);
  EXPECT_EQ(m->worstX, 0);
  EXPECT_EQ(m->worstY, 1);
  EXPECT_DOUBLE_EQ(m->psnr_dB, 20 * std::log10(255 / 2.5));
  EXPECT_FALSE(m->ssim);  // smaller than its window
}

TEST(ImageMetrics, AgreesWithLongDouble) {
  const auto x = noise(5000, 1), y = noise(5000, 2);
  const auto a = scaled<std::uint16_t>(x, 65536), b = scaled<std::uint16_t>(y, 65536);
  long double sum = 0, squares = 0, most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const long double d = std::fabs(static_cast<long double>(a[i]) - static_cast<long double>(b[i]));
    sum += d, squares += d * d, most = std::max(most, d);
  }
  const auto m = compareImages(view(a, 100, 50), view(b, 100, 50));
  ASSERT_TRUE(m.ok());
  EXPECT_NEAR(m->mean / static_cast<double>(sum / 5000), 1, 1e-13);
  EXPECT_NEAR(m->rmse / static_cast<double>(std::sqrt(squares / 5000)), 1, 1e-13);
  EXPECT_EQ(m->max, static_cast<double>(most));
}

TEST(ImageMetrics, SsimIsThePapersFormula) {
  for (const double mix : {0.02, 0.2, 1.0}) {
    const auto x = noise(37 * 29, 5), n = noise(37 * 29, 6);
    std::vector<std::uint8_t> a, b;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double smooth = 128 + 90 * std::sin(0.2 * static_cast<double>(i % 37));
      a.push_back(static_cast<std::uint8_t>(smooth + 20 * x[i]));
      b.push_back(static_cast<std::uint8_t>((1 - mix) * smooth + mix * 200 * n[i]));
    }
    const std::vector<double> da(a.begin(), a.end()), db(b.begin(), b.end());
    const auto m = compareImages(view(a, 37, 29), view(b, 37, 29));
    ASSERT_TRUE(m.ok() && m->ssim);
    EXPECT_NEAR(*m->ssim, bruteSsim(da, db, 37, 29, 255), 1e-10) << mix;
    EXPECT_LT(*m->ssim, 1);
  }
}

TEST(ImageMetrics, NoDataIsNoDifferenceButIsCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> a = {1, nan, 3, nan}, b = {2, nan, nan, 4};
  const auto m = compareImages(view(a, 4, 1), view(b, 4, 1));
  ASSERT_TRUE(m.ok());
  EXPECT_EQ(m->compared, 1u);
  EXPECT_EQ(m->unmatched, 2u);
  EXPECT_EQ(m->max, 1);
  EXPECT_DOUBLE_EQ(m->differing, 0.75);
}

TEST(ImageMetrics, DifferentSizeDepthOrColourIsRefused) {
  const std::vector<std::uint8_t> a(12 * 12), wide(12 * 13), rgb(12 * 12 * 3);
  const std::vector<std::uint16_t> deep(12 * 12);
  const auto refusal = [&](const ImageView& other) {
    const auto m = compareImages(view(a, 12, 12), other);
    EXPECT_FALSE(m.ok());
    return m ? std::string() : m.error().sentence;
  };
  EXPECT_NE(refusal(view(wide, 13, 12)).find("size"), std::string::npos);
  EXPECT_NE(refusal(view(deep, 12, 12)).find("depth"), std::string::npos);
  EXPECT_NE(refusal(view(rgb, 12, 12, 3)).find("colour"), std::string::npos);
  EXPECT_FALSE(compareImages(view(a, 11, 12), view(a, 11, 12)).ok());  // samples beyond its size
}

// Sharma, Wu and Dalal 2005, table 1.
struct Pair {
  Lab p, q;
  double difference;
};
constexpr std::array<Pair, 34> kSharma = {{
    {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
    {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
    {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
    {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
    {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
    {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
    {{50, 0, 0}, {50, -1, 2}, 2.3669},
    {{50, -1, 2}, {50, 0, 0}, 2.3669},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0010}, 7.1792},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
    {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0012}, 7.2195},
    {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
    {{50, -0.0010, 2.4900}, {50, 0.0010, -2.4900}, 4.8045},
    {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
    {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
    {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
    {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
    {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
    {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
    {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1.0000},
    {{50, 2.5, 0}, {50, 3.2972, 0}, 1.0000},
    {{50, 2.5, 0}, {50, 1.8634, 0.5757}, 1.0000},
    {{50, 2.5, 0}, {50, 3.2592, 0.3350}, 1.0000},
    {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
    {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
    {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
    {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
    {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
    {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
    {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
    {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
    {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
    {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
}};

TEST(ImageMetrics, Ciede2000OfThePublishedPairs) {
  for (std::size_t i = 0; i < kSharma.size(); ++i) {
    EXPECT_NEAR(ciede2000(kSharma[i].p, kSharma[i].q), kSharma[i].difference, 5e-5) << "pair " << i + 1;
    EXPECT_NEAR(ciede2000(kSharma[i].q, kSharma[i].p), kSharma[i].difference, 5e-5) << "pair " << i + 1;
  }
}

TEST(ImageMetrics, ColoursByTheirPublishedLab) {
  const Lab white = labFromSrgb(1, 1, 1), red = labFromSrgb(1, 0, 0), grey = labFromSrgb(0.5, 0.5, 0.5);
  EXPECT_NEAR(white.L, 100, 1e-9);
  EXPECT_NEAR(white.a, 0, 1e-9);
  EXPECT_NEAR(white.b, 0, 1e-9);
  EXPECT_NEAR(red.L, 53.24, 0.01);
  EXPECT_NEAR(red.a, 80.09, 0.02);
  EXPECT_NEAR(red.b, 67.20, 0.03);  // the standard states its matrix to four digits
  EXPECT_NEAR(grey.L, 53.389, 0.001);
  // Black against white: L alone differs, by 100 / SL with L' = 50.
  const std::vector<std::uint8_t> a = {0, 0, 0}, b = {255, 255, 255};
  const auto m = compareImages(view(a, 1, 1, 3), view(b, 1, 1, 3));
  ASSERT_TRUE(m.ok());
  EXPECT_NEAR(*m->ciede2000_max, 100, 1e-9);
}

}  // namespace
}  // namespace vernier::measure
