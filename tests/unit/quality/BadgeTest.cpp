// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/Badge.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "Scenes.h"
#include "vernier/base/Random.h"
#include "vernier/base/Threads.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

// A smooth volume with noise, cut obliquely.
SliceScene phantom(int size_px = 128) {
  GridGeometry g = gridOf(40, 36, 24, {1, 1.1, 2});
  const auto v = floatVolume(g, [](auto i, auto j, auto k) {
    const double x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
    return 500 + 300 * std::sin(0.4 * x) * std::cos(0.3 * y) + 10 * z +
           40 * randomUnit(3, static_cast<std::uint64_t>(i + 40 * j + 1440 * k));
  });
  SliceScene s =
      sliceScene(v, Plane{g.centre(), PatientVec(0.3, -0.2, 0.9), PatientVec(0, 1, 0.1)}, size_px, 60);
  s.layer().window = VoiWindow{600, 400, VoiFunction::LinearExact, ""};
  s.scene.background = Rgb{0.2, 0.1, 0.3};
  return s;
}

// What a perfect engine would draw: the reference, rounded to float.
Frame drawn(const SliceScene& s, bool values = false) {
  Frame f;
  f.images.allocate(s.view.width_px, s.view.height_px, values);
  std::vector<std::size_t> all(f.images.depth.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto p = referencePixels(s.scene, s.view, s.sources, all);
  EXPECT_TRUE(p.ok());
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (int c = 0; c < 4; ++c)
      f.images.colour[4 * n + static_cast<std::size_t>(c)] = static_cast<float>((*p)[n].rgba[c]);
    if (values) f.images.values[n] = static_cast<float>((*p)[n].value);
  }
  return f;
}

ErrorReport measured(const Frame& f, const SliceScene& s, const ErrorOptions& options = {}) {
  const auto r = measureError(f, s.scene, s.view, s.sources, options);
  EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
  return r.ok() ? *r : ErrorReport{};
}

TEST(Badge, APerfectPictureHasOnlyFloatRounding) {
  const SliceScene s = phantom(256);
  const ErrorReport r = measured(drawn(s, true), s);
  EXPECT_EQ(r.n, 1024u);
  EXPECT_EQ(r.rank, 4u);
  EXPECT_FALSE(r.exhaustive);
  ASSERT_TRUE(r.bound);
  EXPECT_LE(*r.bound, r.max);
  EXPECT_LT(r.max, 255 * 1.2e-7);
  EXPECT_LE(r.rms, r.max);
  EXPECT_LE(r.p50, r.p99);
  EXPECT_GT(r.populationShare, 0.3);
  EXPECT_LT(r.populationShare, 1);
  EXPECT_GT(r.edge.share, 0);
  EXPECT_EQ(r.quantisation, 0.5);
  ASSERT_TRUE(r.values);
  EXPECT_GT(r.values->n, 500u);
  EXPECT_EQ(r.values->coverageDiffers, 0u);
  EXPECT_LT(r.values->worstOfBound, 1);
}

TEST(Badge, CatchesMutants) {
  const SliceScene s = phantom();
  const Frame good = drawn(s);
  // The whole picture shifted by a pixel.
  Frame shifted = good;
  for (std::size_t n = shifted.images.colour.size(); n-- > 4;)
    shifted.images.colour[n] = good.images.colour[n - 4];
  EXPECT_GT(*measured(shifted, s).bound, 5);
  // The window off by one unit of 400: 255/400 = 0.64 levels.
  SliceScene window = s;
  window.layer().window->center += 1;
  EXPECT_NEAR(*measured(drawn(window), s).bound, 255.0 / 400, 1e-3);
  // One slice off.
  SliceScene slice = s;
  slice.layer().plane.point = slice.layer().plane.point + 2.0 * normalize(slice.layer().plane.normal);
  EXPECT_GT(*measured(drawn(slice), s).bound, 5);
  // Gamma.
  Frame gamma = good;
  for (float& c : gamma.images.colour) c = std::pow(c, 1.0f / 1.05f);
  EXPECT_GT(*measured(gamma, s).bound, 2);
  // Half a pixel too far right.
  SliceScene half = s;
  half.scene.camera.pan_mm.x += 0.5 * 60 / 128;
  EXPECT_GT(*measured(drawn(half), s).bound, 5);
  // Background missing, seen at the dilated rim only.
  SliceScene black = s;
  black.scene.background = Rgb{0, 0, 0};
  EXPECT_NEAR(measured(drawn(black), s).max, 255 * 0.3, 1e-3);
  // A single colour channel.
  Frame green = good;
  for (std::size_t n = 1; n < green.images.colour.size(); n += 4) green.images.colour[n] *= 0.99f;
  EXPECT_GT(*measured(green, s).bound, 1);
}

TEST(Badge, NanIsTheLargestError) {
  const SliceScene s = phantom(32);
  Frame f = drawn(s);
  f.images.colour[4 * (16 * 32 + 16)] = std::numeric_limits<float>::quiet_NaN();
  const ErrorReport r = measured(f, s);  // 1024 pixels: all tested
  EXPECT_TRUE(r.exhaustive);
  EXPECT_EQ(r.max, 255);
  EXPECT_LT(*r.bound, 1e-3);  // one pixel of 1000 is within the 1 %
}

TEST(Badge, ClampsAsTheDisplayDoes) {
  const SliceScene s = phantom(32);
  Frame f = drawn(s);
  for (float& c : f.images.colour)
    if (c == 1.0f)
      c = 7.0f;
    else if (c == 0.0f)
      c = -3.0f;
  EXPECT_LT(measured(f, s).max, 1e-3);
}

TEST(Badge, EdgePixelsAreToldApartAndCount) {
  const SliceScene s = phantom();
  Frame f = drawn(s);
  // Damage every pixel that has a neighbour without data.
  const Frame values = drawn(s, true);
  const int w = 128;
  std::size_t damaged = 0;
  for (int y = 1; y < w - 1; ++y)
    for (int x = 1; x < w - 1; ++x) {
      const auto data = [&](int a, int b) {
        return !std::isnan(values.images.values[static_cast<std::size_t>(a + w * b)]);
      };
      if (data(x, y) && !(data(x - 1, y) && data(x + 1, y) && data(x, y - 1) && data(x, y + 1))) {
        f.images.colour[4 * static_cast<std::size_t>(x + w * y)] += 0.5f;
        ++damaged;
      }
    }
  ASSERT_GT(damaged, 100u);
  ErrorOptions all;
  all.samples = 128 * 128;
  const ErrorReport r = measured(f, s, all);
  EXPECT_GT(r.edge.p99, 50);
  EXPECT_GT(*r.bound, 50);  // more than 1 % of the population, so never left out
  EXPECT_GT(r.edge.share * static_cast<double>(r.n), static_cast<double>(damaged));
  EXPECT_LT(r.p50, 1e-3);
}

TEST(Badge, ModelAndImplementationAreToldApart) {
  // A slab of the truth's samples: no implementation error, but a model error.
  SliceScene s = phantom();
  s.layer().slab = Slab{6, SlabMode::Max};
  Frame f;
  f.images.allocate(128, 128, false);
  std::vector<std::size_t> all(128 * 128);
  std::iota(all.begin(), all.end(), std::size_t{0});
  ErrorOptions options;
  options.reference = {ErrorKind::Implementation, 2};
  const auto p = referencePixels(s.scene, s.view, s.sources, all, options.reference);
  for (std::size_t n = 0; n < all.size(); ++n)
    for (int c = 0; c < 4; ++c)
      f.images.colour[4 * n + static_cast<std::size_t>(c)] = static_cast<float>((*p)[n].rgba[c]);
  const ErrorReport implementation = measured(f, s, options);
  EXPECT_LT(implementation.max, 1e-3);
  EXPECT_EQ(implementation.kind, ErrorKind::Implementation);
  const ErrorReport model = measured(f, s);
  EXPECT_GT(*model.bound, 2);
  EXPECT_STREQ(nameOf(model.kind), "model");
  // Three samples at midpoints of 6 mm; a smaller step comes nearer to the truth.
  options.reference.step = 0.25;
  const auto fine = referencePixels(s.scene, s.view, s.sources, all, options.reference);
  for (std::size_t n = 0; n < all.size(); ++n)
    for (int c = 0; c < 4; ++c)
      f.images.colour[4 * n + static_cast<std::size_t>(c)] = static_cast<float>((*fine)[n].rgba[c]);
  EXPECT_LT(measured(f, s).rms, 0.5 * model.rms);
}

TEST(Badge, IsTheSameForAnyNumberOfThreads) {
  const SliceScene s = phantom();
  Frame f = drawn(s);
  for (std::size_t n = 0; n < f.images.colour.size(); ++n)
    f.images.colour[n] += 1e-3f * static_cast<float>(randomUnit(9, n));
  const ErrorReport reference = measured(f, s);
  for (int threads : {1, 2, 3}) {
    setThreads(threads);
    const ErrorReport r = measured(f, s);
    EXPECT_EQ(r.rms, reference.rms);
    EXPECT_EQ(r.bound, reference.bound);
    EXPECT_EQ(r.p50, reference.p50);
  }
  setThreads(0);
  ErrorOptions other;
  other.seed = 2;
  EXPECT_NE(measured(f, s, other).rms, reference.rms);
}

TEST(Badge, RefusesTheWrongFrame) {
  const SliceScene s = phantom(32);
  Frame f = drawn(s);
  View larger = s.view;
  larger.width_px = 33;
  EXPECT_EQ(measureError(f, s.scene, larger, s.sources).error().code, ErrorCode::SceneInvalid);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(measureError(f, s.scene, s.view, s.sources, {}, stop.get_token()).error().code,
            ErrorCode::Cancelled);
}

// A pixel of a rendering may take milliseconds, so no other is begun once a stop is asked for.
TEST(Badge, AStopIsHeardBeforeTheNextPixel) {
  const SliceScene s = phantom(32);
  const Frame f = drawn(s);
  setThreads(1);
  std::stop_source stop;
  int asked = 0;
  ErrorOptions options;
  options.reference.truths[0] = [&](glm::dvec2, glm::dvec4 under) {
    ++asked;
    stop.request_stop();
    return under;
  };
  EXPECT_EQ(measureError(f, s.scene, s.view, s.sources, options, stop.get_token()).error().code,
            ErrorCode::Cancelled);
  setThreads(0);
  EXPECT_EQ(asked, 1);
}

TEST(Badge, SaysWhenThereIsNothingOrTooLittle) {
  SliceScene s = phantom(32);
  s.layer().plane.point = PatientPoint(1000, 1000, 1000);
  const ErrorReport none = measured(drawn(s), s);
  EXPECT_EQ(none.n, 0u);
  EXPECT_FALSE(none.bound);
  EXPECT_NE(errorSentence(none).find("nothing"), std::string::npos);
  const SliceScene t = phantom();
  ErrorOptions few;
  few.samples = 100;
  const ErrorReport r = measured(drawn(t), t, few);
  EXPECT_FALSE(r.bound);
  EXPECT_NE(errorSentence(r).find("too few"), std::string::npos);
  EXPECT_NE(errorSentence(measured(drawn(t), t)).find("99 % sure"), std::string::npos);
}

// A plugin's layer over the slice: the left half of the picture becomes a mix of 0.25 of what lies below and
// pure red.
TEST(Badge, ALayerOfAPluginIsMeasuredAgainstItsOwnTruth) {
  SliceScene s = phantom(64);
  const Frame bare = drawn(s);
  s.scene.layers.emplace_back(CustomLayer{"acme.half", 1, R"({"kind":"acme.half"})"});
  EXPECT_FALSE(measureError(bare, s.scene, s.view, s.sources).ok())
      << "without its truth nothing can be said";

  ErrorOptions options;
  options.samples = 64 * 64;
  options.reference.truths[1] = [](glm::dvec2 pixel, glm::dvec4 under) {
    return pixel.x < 32 ? 0.25 * under + 0.75 * glm::dvec4(1, 0, 0, 1) : under;
  };
  Frame mixed = bare;
  for (std::size_t n = 0; n < 64 * 64; ++n)
    for (std::size_t c = 0; c < 3; ++c)
      if (float& v = mixed.images.colour[4 * n + c]; n % 64 < 32) v = 0.25f * v + (c == 0 ? 0.75f : 0.0f);
  const ErrorReport good = measured(mixed, s, options);
  EXPECT_LT(good.max, 1e-4);
  EXPECT_EQ(good.population, measured(bare, phantom(64)).population) << "the slice's pixels, no more";

  // The picture without the layer is wrong there by 0.75 of the colour, and nowhere else.
  const ErrorReport missing = measured(bare, s, options);
  double expected = 0;
  for (std::size_t n = 0; n < 64 * 64; ++n) {
    const float* rgb = &bare.images.colour[4 * n];
    if (n % 64 < 32) expected = std::max({expected, 0.75 * (1 - rgb[0]), 0.75 * rgb[1], 0.75 * rgb[2]});
  }
  EXPECT_NEAR(missing.max, 255 * expected, 0.5);
  EXPECT_GT(missing.max, 20);
}

// Without a slice or an image the whole picture counts.
TEST(Badge, ALayerOfAPluginAloneIsTheWholePicture) {
  SliceScene s = phantom(16);
  s.scene.layers = {CustomLayer{"acme.half", 1, R"({"kind":"acme.half"})"}};
  Frame f;
  f.images.allocate(16, 16, false);
  ErrorOptions options;
  options.reference.truths[0] = [](glm::dvec2, glm::dvec4 under) { return under; };
  const ErrorReport r = measured(f, s, options);
  EXPECT_EQ(r.population, 256u);
  EXPECT_NEAR(r.max, 255 * 0.3, 1e-4) << "the background's blue";
}

}  // namespace
}  // namespace vernier::quality
