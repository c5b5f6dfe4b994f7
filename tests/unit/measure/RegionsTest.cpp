// SPDX-License-Identifier: GPL-3.0-or-later
// Regions: area in closed form, values as a long double brute force over stored pixels has them.
#include "MeasureCases.h"
#include "vernier/measure/Contour.h"
#include "vernier/measure/Outline.h"
#include "vernier/measure/Statistics.h"
#include "vernier/volume/Sampling.h"

namespace vernier::measure::test {
namespace {

using ::testing::Contains;

// Even-odd by crossings of a ray, edges in: written without a thought of speed.
bool insideBrute(const std::vector<glm::dvec2>& o, double x, double y) {
  bool in = false;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const glm::dvec2 a = o[i], b = o[(i + 1) % o.size()];
    const double cross = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    if (std::abs(cross) < 1e-12 && x >= std::min(a.x, b.x) && x <= std::max(a.x, b.x) &&
        y >= std::min(a.y, b.y) && y <= std::max(a.y, b.y))
      return true;
    if ((a.y > y) != (b.y > y) && x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

struct Brute {
  std::size_t n = 0;
  long double mean = 0, sd = 0, median = 0, min = 0, max = 0;
};
Brute bruteOf(std::vector<long double> v) {
  Brute b;
  b.n = v.size();
  if (v.empty()) return b;
  for (const long double x : v) b.mean += x;
  b.mean /= static_cast<long double>(v.size());
  for (const long double x : v) b.sd += (x - b.mean) * (x - b.mean);
  b.sd = v.size() > 1 ? std::sqrt(b.sd / static_cast<long double>(v.size() - 1)) : 0;
  std::sort(v.begin(), v.end());
  b.min = v.front(), b.max = v.back();
  b.median = v.size() % 2 ? v[v.size() / 2] : (v[v.size() / 2 - 1] + v[v.size() / 2]) / 2;
  return b;
}
void expectSame(const Statistics& s, const Brute& b) {
  ASSERT_EQ(s.n, b.n);
  const auto near = [](double x, long double y) {
    EXPECT_LE(std::abs(static_cast<long double>(x) - y), 1e-12L * std::max(1.0L, std::abs(y))) << x;
  };
  near(s.mean, b.mean);
  if (b.n > 1) near(*s.sd, b.sd);
  near(s.median, b.median);
  near(s.min, b.min);
  near(s.max, b.max);
  std::uint64_t counted = 0;
  for (const std::uint64_t c : s.histogram.counts) counted += c;
  EXPECT_EQ(counted, s.n);
}

struct StoredFrame {
  std::int64_t columns = 40, rows = 31;
  std::vector<std::int16_t> values;
  ImageFrameInfo info;
  explicit StoredFrame(std::uint64_t seed) {
    for (std::int64_t n = 0; n < columns * rows; ++n)
      values.push_back(
          static_cast<std::int16_t>(-2000 + 4000 * randomUnit(seed, static_cast<std::uint64_t>(n))));
    for (std::size_t n = 0; n < values.size(); n += 17) values[n] = -3024;
    info.noData = NoDataRange{-3024, -3024};
    info.rescale = {0.7, -1024};
    info.sopInstanceUid = "2.25.4";
    info.modality = "CT";
    info.pixelSpacing_mm = {0.9, 0.6};
  }
  std::shared_ptr<const ImageFrame> frame() const { return frameOf(columns, rows, values, info); }
  template <class Fn>
  Brute brute(Fn&& inside) const {
    std::vector<long double> v;
    for (std::int64_t j = 0; j < rows; ++j)
      for (std::int64_t i = 0; i < columns; ++i) {
        const std::int16_t x = values[static_cast<std::size_t>(j * columns + i)];
        if (x != -3024 && inside(static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5))
          v.push_back(static_cast<long double>(x) * static_cast<long double>(0.7) - 1024);
      }
    return bruteOf(v);
  }
};

TEST(Regions, StatisticsOfStoredPixelsAreTheBruteForces) {
  Draws d(5);
  int measured = 0;
  for (int n = 0; n < 200; ++n) {
    const StoredFrame f(static_cast<std::uint64_t>(n));
    const auto sources = sourcesOf(f.frame());
    const auto spot = [&] { return Spot(d.within(-3, 43), d.within(-3, 34), 0); };
    // A polygon of any shape, also through itself; every other one with corners on pixel centres.
    PolygonRegion p;
    std::vector<glm::dvec2> outline;
    for (int c = 0; c < 3 + n % 6; ++c) {
      Spot s = spot();
      if (n % 2) s = {std::floor(s.x) + 0.5, std::floor(s.y) + 0.5, 0};
      p.corners.push_back(s);
      outline.emplace_back(s);
    }
    auto said = measure(inImage(p), sources);
    const Brute b = f.brute([&](double x, double y) { return insideBrute(outline, x, y); });
    if (said) {
      ++measured;
      expectSame(*said->values, b);
      EXPECT_NEAR(said->quantities.at(0).value, areaOf(outline) * 0.54, 1e-9 * said->quantities.at(0).value);
    } else {
      EXPECT_TRUE(b.n == 0 || areaOf(outline) == 0) << said.error().text() << " " << n;
    }
    // A rectangle and an ellipse between the same corners.
    const Spot u = spot(), v = spot();
    const auto within = [](double x, double a, double c) {
      return x >= std::min(a, c) && x <= std::max(a, c);
    };
    said = measure(inImage(RectangleRegion{{u, v}}), sources);
    const Brute box = f.brute([&](double x, double y) { return within(x, u.x, v.x) && within(y, u.y, v.y); });
    ASSERT_EQ(said.ok(), box.n > 0);
    if (said) expectSame(*said->values, box);
    said = measure(inImage(EllipseRegion{{u, v}}), sources);
    const Brute round = f.brute([&](double x, double y) {
      const double a = (2 * x - u.x - v.x) / (u.x - v.x), c = (2 * y - u.y - v.y) / (u.y - v.y);
      return a * a + c * c <= 1;
    });
    ASSERT_EQ(said.ok(), round.n > 0);
    if (said) {
      expectSame(*said->values, round);
      EXPECT_NEAR(said->quantities.at(0).value,
                  std::numbers::pi / 4 * std::abs((u.x - v.x) * (u.y - v.y)) * 0.54, 1e-9);
    }
  }
  EXPECT_GT(measured, 150);
}

// The same region in the patient, on the acquired slice of an oblique, sheared, left-handed volume, is the
// same pixels.
TEST(Regions, AcquiredSlicesGiveStoredPixelsWhateverTheGrid) {
  Draws d(6);
  for (int n = 0; n < 60; ++n) {
    GridGeometry g = gridOf({24, 18, 5}, {0.7, 1.1, 2.5});
    const Placement::Axes a = randomAxes(d);
    g.patientFromVoxel.linear =
        glm::dmat3(0.7 * rightOf(a), -1.1 * a.up.v, (n % 2 ? 2.5 : -2.5) * a.normal.v);
    if (n % 3 == 0) g.patientFromVoxel.linear[2] += 0.8 * a.up.v;
    if (n % 3 == 1)
      for (int s = 0; s < 5; ++s) g.sliceOrigin_vox.push_back({0.1 * s, -0.05 * s, s + 0.2 * std::sin(s)});
    const auto volume = volumeOf(g, [&](glm::dvec3 p) { return std::sin(p.x) * 100 + p.y + 3 * p.z; });
    const std::int64_t k = n % 5;
    const glm::dvec3 first =
        g.even() ? glm::dvec3(0, 0, static_cast<double>(k)) : g.sliceOrigin_vox[static_cast<std::size_t>(k)];
    std::vector<glm::dvec2> outline;
    PolygonRegion p;
    for (int c = 0; c < 5; ++c) {
      const double x = d.within(0, 24), y = d.within(0, 18);
      outline.emplace_back(x, y);
      p.corners.push_back((g.patientFromVoxel * VoxelPoint(first + glm::dvec3(x - 0.5, y - 0.5, 0))).p);
    }
    Measurement m = inPatient(p);
    m.on.axes = Placement::Axes{a.normal, a.up};
    const auto said = measure(m, sourcesOf(volume));
    std::vector<long double> v;
    for (int j = 0; j < 18; ++j)
      for (int i = 0; i < 24; ++i)
        if (insideBrute(outline, i + 0.5, j + 0.5)) v.push_back(volume->probe(i, j, k).modality);
    ASSERT_TRUE(said.ok()) << said.error().text();
    expectSame(*said->values, bruteOf(v));
    EXPECT_NEAR(said->quantities.at(0).value, areaOf(outline) * 0.77, 1e-9 * said->quantities.at(0).value);
    EXPECT_THAT(said->notes, ::testing::Not(Contains("interpolated")));
  }
}

TEST(Regions, OtherPlanesAreSampledOnTheSmallestSpacingAndSaySo) {
  const auto field = [](glm::dvec3 p) { return 2 * p.x - 3 * p.y + p.z; };  // linear: interpolation is exact
  const auto volume = volumeOf(gridOf({40, 40, 20}, {0.5, 0.75, 1.5}), field);
  Draws d(7);
  for (int n = 0; n < 40; ++n) {
    const Placement::Axes a = randomAxes(d);
    Measurement m =
        inPatient(EllipseRegion{{-4.0 * rightOf(a) - 3.0 * a.up.v, 4.0 * rightOf(a) + 3.0 * a.up.v}});
    m.on.axes = a;
    const auto said = measure(m, sourcesOf(volume));
    ASSERT_TRUE(said.ok()) << said.error().text();
    EXPECT_NEAR(said->quantities.at(0).value, std::numbers::pi * 12, 1e-9 * 40);
    EXPECT_NEAR(static_cast<double>(said->values->n) * 0.25, std::numbers::pi * 12, 2.0);
    EXPECT_NEAR(said->values->mean, 0, 0.2);  // of a field odd about the centre, up to the edge of the grid
    EXPECT_THAT(said->notes, Contains("interpolated"));
    EXPECT_THAT(said->notes, Contains("SD lower than pixel SD"));
  }
}

TEST(Regions, ProjectionsHaveNoValues) {
  const auto volume = volumeOf(gridOf({20, 20, 20}, {1, 1, 1}), [](glm::dvec3 p) { return p.x; });
  for (const Shown s : {Shown::Slab, Shown::Projection, Shown::Rendering}) {
    Measurement m = inPatient(RectangleRegion{{glm::dvec3(-3, -3, 0.5), glm::dvec3(3, 3, 0.5)}});
    m.on.axes = Placement::Axes{};
    m.on.shown = s;
    const auto said = measure(m, sourcesOf(volume));
    ASSERT_TRUE(said.ok());
    EXPECT_FALSE(said->values.has_value());
    EXPECT_EQ(said->quantities.size(), 1u);
    EXPECT_EQ(said->quantities.at(0).name, "projected area");
    m.shape = Probe{{0, 0, 0}};
    EXPECT_FALSE(measure(m, sourcesOf(volume)).ok());
    m.shape = ThresholdRegion{0, {0, 0, 0.5}};
    EXPECT_FALSE(measure(m, sourcesOf(volume)).ok());
  }
}

TEST(Regions, WhatCannotBeMeasuredIsRefusedWithASentence) {
  const StoredFrame f(1);
  const auto sources = sourcesOf(f.frame());
  const std::vector<Shape> none = {
      PolygonRegion{{{1, 1, 0}, {9, 9, 0}}},                    // two corners
      PolygonRegion{{{1, 1, 0}, {9, 9, 0}, {5, 5, 0}}},         // on one line
      RectangleRegion{{Spot(3, 3, 0), Spot(3, 9, 0)}},          // no width
      RectangleRegion{{Spot(3.6, 3.6, 0), Spot(4.4, 4.4, 0)}},  // between centres
      EllipseRegion{{Spot(100, 100, 0), Spot(120, 120, 0)}},    // beside the image
      Length{{Spot(0, 0, 0), Spot(NAN, 0, 0)}},
      IsoVolume{0, {}},  // no stored frame holds a volume
  };
  for (const Shape& s : none) {
    const auto said = measure(inImage(s), sources);
    ASSERT_FALSE(said.ok()) << kindOf(s);
    EXPECT_EQ(said.error().code, ErrorCode::OptionInvalid);
    EXPECT_GT(said.error().sentence.size(), 20u);
  }
  // Padding alone: pixel (0, 0) is padding.
  const auto said = measure(inImage(RectangleRegion{{Spot(0.2, 0.2, 0), Spot(0.8, 0.8, 0)}}), sources);
  ASSERT_FALSE(said.ok());
  EXPECT_NE(said.error().sentence.find("padding"), std::string::npos);
  // In the patient a region needs its plane, and must lie in it.
  const auto volume = volumeOf(gridOf({9, 9, 9}, {1, 1, 1}), [](glm::dvec3) { return 0; });
  Measurement m = inPatient(PolygonRegion{{{-2, -2, 0}, {2, -2, 0}, {2, 2, 1}}});
  EXPECT_FALSE(measure(m, sourcesOf(volume)).ok());
  m.on.axes = Placement::Axes{};
  EXPECT_FALSE(measure(m, sourcesOf(volume)).ok());
}

// n_eff: noise smeared over w pixels holds about 1 / w^2 as many independent values; white noise nearly all.
TEST(Regions, TheMeansUncertaintyCountsIndependentValues) {
  Draws d(8);
  const std::size_t size = 96;
  std::vector<double> white(size * size);
  for (double& x : white) x = d.normal();
  const Statistics s = statisticsOf(white, 0);
  EXPECT_GT(effectiveCount({size, white}, s.mean, s.n), 0.7 * static_cast<double>(s.n));
  std::vector<double> smooth(size * size);
  for (std::size_t j = 0; j < size; ++j)
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t v = 0; v < 4; ++v)
        for (std::size_t u = 0; u < 4; ++u)
          smooth[j * size + i] += white[(j + v) % size * size + (i + u) % size] / 16;
  const Statistics t = statisticsOf(smooth, 0);
  const double n = effectiveCount({size, smooth}, t.mean, t.n);
  EXPECT_GT(n, 0.5 * static_cast<double>(t.n) / 16);
  EXPECT_LT(n, 1.5 * static_cast<double>(t.n) / 16);
}

TEST(Regions, AThresholdFollowsADisc) {
  // A disc of radius 11.3 px with an edge one pixel soft: at its half level it is that disc.
  const auto value = [](std::int64_t i, std::int64_t j) {
    const double r = std::hypot(static_cast<double>(i) + 0.5 - 20.2, static_cast<double>(j) + 0.5 - 18.7);
    return 1000 * std::clamp(11.3 - r + 0.5, 0.0, 1.0);
  };
  const auto outline = thresholdContour(40, 40, value, 500, 20, 18);
  ASSERT_TRUE(outline.ok()) << outline.error().text();
  EXPECT_NEAR(areaOf(*outline), std::numbers::pi * 11.3 * 11.3, 1.5);
  std::size_t mask = 0, inside = 0;
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) {
      mask += value(i, j) >= 500;
      inside += insideBrute(*outline, i + 0.5, j + 0.5);
      ASSERT_EQ(value(i, j) >= 500, insideBrute(*outline, i + 0.5, j + 0.5)) << i << ' ' << j;
    }
  EXPECT_EQ(mask, inside);
  EXPECT_FALSE(thresholdContour(40, 40, value, 500, 1, 1).ok());
  EXPECT_FALSE(thresholdContour(40, 40, value, 500, -1, 1).ok());
  // Random masks: whatever hangs together is inside, single pixels and thin lines too.
  Draws d(9);
  for (int n = 0; n < 60; ++n) {
    std::vector<double> noise(144);
    for (double& x : noise) x = d.unit();
    noise[6 * 12 + 6] = 1;
    const auto field = [&](std::int64_t i, std::int64_t j) {
      return noise[static_cast<std::size_t>(j * 12 + i)];
    };
    const auto around = thresholdContour(12, 12, field, 0.55, 6, 6);
    ASSERT_TRUE(around.ok());
    for (const glm::dvec2& p : *around) {
      // Each point lies on the line between two centres, where the value passes the level (or at the image's
      // edge).
      const double fx = p.x - 0.5 - std::floor(p.x - 0.5), fy = p.y - 0.5 - std::floor(p.y - 0.5);
      ASSERT_TRUE(fx == 0 || fy == 0);
      const auto i = static_cast<std::int64_t>(std::floor(p.x - 0.5)),
                 j = static_cast<std::int64_t>(std::floor(p.y - 0.5));
      const double t = fx + fy;
      if (t == 0) continue;
      const double v = (1 - t) * field(i, j) + t * field(fx > 0 ? i + 1 : i, fy > 0 ? j + 1 : j);
      ASSERT_NEAR(v, 0.55, 1e-9);
    }
  }
}

TEST(Regions, AProbeReadsThePixelUnderIt) {
  const StoredFrame f(3);
  const auto said = measure(inImage(Probe{{7.9, 3.2, 0}}), sourcesOf(f.frame()));
  ASSERT_TRUE(said.ok()) << said.error().text();
  const double stored = f.values[3 * 40 + 7];
  EXPECT_EQ(said->quantities.at(0).value, 0.7 * stored - 1024);
  EXPECT_EQ(said->quantities[1].value, stored);
  EXPECT_FALSE(measure(inImage(Probe{{-0.1, 3, 0}}), sourcesOf(f.frame())).ok());
  // Between slices it is interpolated and says so; on a slice it is the pixel.
  const auto volume = volumeOf(gridOf({9, 9, 9}, {1, 1, 1}), [](glm::dvec3 p) { return 10 * p.z + p.x; });
  const auto between = measure(inPatient(Probe{{0.3, 0, 0.5}}), sourcesOf(volume));
  EXPECT_NEAR(between->quantities.at(0).value, 5.3, 1e-6);
  EXPECT_THAT(between->notes, Contains("interpolated"));
  const auto on = measure(inPatient(Probe{{0.3, 0, 1}}), sourcesOf(volume));
  EXPECT_EQ(on->quantities.at(0).value, 10);
  // The value changes by 10 per mm along z, whose place is known to 1 / sqrt(12) mm.
  EXPECT_NEAR(*between->quantities.at(0).expanded, 2 * std::sqrt(101.0 / 12), 1e-5);
}

}  // namespace
}  // namespace vernier::measure::test
