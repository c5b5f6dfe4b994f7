// SPDX-License-Identifier: GPL-3.0-or-later
// Lengths and angles: exact on planes and spacings of every kind, and a +/- that covers.
#include "MeasureCases.h"

namespace vernier::measure::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A grid with spacings up to 1:50, turned and sheared at random.
GridGeometry randomGrid(Draws& d) {
  GridGeometry g = gridOf({9, 8, 7}, {1, 1, 1});
  const double smallest = d.within(0.2, 1);
  const Placement::Axes a = randomAxes(d);
  const glm::dvec3 x = rightOf(a), y = a.up.v, z = a.normal.v;
  const auto spacing = [&] { return smallest * std::exp(d.within(0, std::log(50))); };
  const double sz = spacing();
  g.patientFromVoxel.linear = glm::dmat3(
      spacing() * x, spacing() * y, (d.unit() < 0.5 ? -sz : sz) * z + (d.unit() < 0.5 ? 0.3 * sz : 0.0) * y);
  g.patientFromVoxel.translation = {d.within(-300, 300), d.within(-300, 300), d.within(-1000, 1000)};
  return g;
}

TEST(Lines, LengthsAnglesAndAreasAreExactOnAThousandObliquePlanes) {
  Draws d(1);
  for (int n = 0; n < 1000; ++n) {
    const auto volume = volumeOf(randomGrid(d), [](glm::dvec3) { return 0; });
    const Placement::Axes axes = randomAxes(d);
    const glm::dvec3 origin(d.within(-200, 200), d.within(-200, 200), d.within(-200, 200));
    const double r = d.within(0.5, 300), s = d.within(0.5, 300), turn = d.within(0, 360) * kDegree,
                 opening = d.within(0.5, 179.5);
    const auto at = [&](double radius, double angle) {
      return origin + radius * (std::cos(angle) * rightOf(axes) + std::sin(angle) * axes.up.v);
    };
    Measurement m = inPatient(Length{{origin, at(r, turn)}});
    m.on.axes = axes;
    m.on.screenPixel = 0.3;
    auto said = measure(m, sourcesOf(volume));
    ASSERT_TRUE(said.ok()) << said.error().text();
    ASSERT_NEAR(said->quantities.at(0).value, r, 1e-9 * r);
    ASSERT_EQ(said->quantities.at(0).unit, "mm");
    ASSERT_EQ(said->origin, Origin::PixelSpacing);
    m.shape = Angle{origin, {at(r, turn), at(s, turn + opening * kDegree)}};
    said = measure(m, sourcesOf(volume));
    ASSERT_TRUE(said.ok()) << said.error().text();
    ASSERT_NEAR(said->quantities.at(0).value, opening, 1e-9 * opening + 1e-10 * 300 / std::min(r, s)) << n;
    m.shape = Cobb{{origin, at(r, turn)}, {at(5, 2), at(5, 2) + at(s, turn + opening * kDegree) - origin}};
    said = measure(m, sourcesOf(volume));
    ASSERT_TRUE(said.ok());
    ASSERT_NEAR(said->quantities.at(0).value, std::min(opening, 180 - opening), 1e-7);
    // Areas: a triangle by both sides and the angle between them, a box and its ellipse.
    m.on.shown = Shown::Slab;  // of a plane through nothing there are no values
    m.shape = PolygonRegion{{origin, at(r, turn), at(s, turn + opening * kDegree)}};
    const double triangle = 0.5 * r * s * std::sin(opening * kDegree);
    said = measure(m, sourcesOf(volume));
    ASSERT_TRUE(said.ok()) << said.error().text();
    ASSERT_NEAR(said->quantities.at(0).value, triangle, 1e-9 * triangle + 1e-12 * r * s);
    const std::array<Spot, 2> box{origin, origin + r * rightOf(axes) - s * axes.up.v};
    m.shape = RectangleRegion{box};
    ASSERT_NEAR(measure(m, sourcesOf(volume))->quantities.at(0).value, r * s, 1e-9 * r * s);
    m.shape = EllipseRegion{box};
    ASSERT_NEAR(measure(m, sourcesOf(volume))->quantities.at(0).value, std::numbers::pi / 4 * r * s,
                1e-9 * r * s);
  }
}

// The stated +/- by the stated rule, worked out here by hand for the axes of a plain grid.
TEST(Lines, TheUncertaintyIsTheRuleOfTheDocument) {
  const auto volume = volumeOf(gridOf({8, 8, 8}, {0.5, 0.8, 3}), [](glm::dvec3) { return 0; });
  const auto expanded = [&](glm::dvec3 along, double screen) {
    Measurement m = inPatient(Length{{glm::dvec3(1, 2, 3), glm::dvec3(1, 2, 3) + along}});
    m.on.axes = Placement::Axes{};  // normal z
    m.on.screenPixel = screen;
    return *measure(m, sourcesOf(volume))->quantities.at(0).expanded;
  };
  const auto rule = [](double spacing, double screen) {
    return 2 * std::sqrt(2 * (spacing * spacing / 12 + 0.25 * screen * screen));
  };
  EXPECT_NEAR(expanded({7, 0, 0}, 0), rule(0.5, 0), 1e-12);
  EXPECT_NEAR(expanded({0, 7, 0}, 0.4), rule(0.8, 0.4), 1e-12);
  EXPECT_NEAR(expanded({0, 0, 7}, 0.4), rule(3, 0), 1e-12) << "a hand places in the plane, not through it";
  // An angle of 90 degrees with arms of a and b: u^2 = (c / a)^2 + (c / b)^2 + the corner's part.
  Measurement m = inPatient(Angle{{0, 0, 0}, {glm::dvec3(10, 0, 0), glm::dvec3(0, 20, 0)}});
  const double cx = 0.5 * 0.5 / 12, cy = 0.8 * 0.8 / 12;
  const double u = std::sqrt(2 * cy / 100 + 2 * cx / 400) / kDegree;
  EXPECT_NEAR(*measure(m, sourcesOf(volume))->quantities.at(0).expanded, 2 * u, 1e-9);
}

// Draws from the model: uniform within a voxel along each axis, a hand's normal error in the plane.
glm::dvec3 drawn(Draws& d, const GridGeometry& g, const Placement::Axes& axes, double screen) {
  const glm::dmat3& m = g.patientFromVoxel.linear;
  const glm::dvec3 normal = glm::normalize(glm::cross(m[0], m[1]));
  return m[0] * (d.unit() - 0.5) + m[1] * (d.unit() - 0.5) + normal * (g.spacing_mm().z * (d.unit() - 0.5)) +
         0.5 * screen * (d.normal() * rightOf(axes) + d.normal() * axes.up.v);
}

struct Coverage {
  int covered = 0, all = 0;
  double share() const { return 100.0 * covered / all; }
};

template <class MakeShape>
Coverage coverage(std::uint64_t seed, MakeShape&& makeShape) {
  Draws d(seed);
  Coverage c;
  for (int n = 0; n < 1000; ++n) {
    GridGeometry g = gridOf({4, 4, 4}, {d.within(0.3, 1), d.within(0.3, 1), d.within(0.5, 5)});
    const auto volume = volumeOf(g, [](glm::dvec3) { return 0; });
    const Placement::Axes axes = randomAxes(d);
    const double screen = d.within(0.1, 0.6);
    const auto say = [&](bool wrong) {
      Measurement m =
          inPatient(makeShape(n, axes, [&] { return wrong ? drawn(d, g, axes, screen) : glm::dvec3(0); }));
      m.on.axes = axes;
      m.on.screenPixel = screen;
      const auto said = measure(m, sourcesOf(volume));
      EXPECT_TRUE(said.ok()) << said.error().text();
      return said->quantities.at(0);
    };
    const double truth = say(false).value;
    const Quantity q = say(true);
    ++c.all;
    c.covered += std::abs(q.value - truth) <= *q.expanded;
  }
  return c;
}

TEST(Lines, TheUncertaintyOfLengthsCoversDrawsFromTheModel) {
  const Coverage c = coverage(2, [](int n, const Placement::Axes& a, auto error) {
    const double t = n, r = 20 + n % 100;
    return Length{{error(), r * (std::cos(t) * rightOf(a) + std::sin(t) * a.up.v) + error()}};
  });
  RecordProperty("covered_percent", std::to_string(c.share()));
  EXPECT_GE(c.share(), 93);
  EXPECT_LE(c.share(), 97);
}

TEST(Lines, TheUncertaintyOfAnglesCoversDrawsFromTheModel) {
  const Coverage c = coverage(3, [](int n, const Placement::Axes& a, auto error) {
    const double t = n, opening = (15 + n % 150) * kDegree;
    const auto at = [&](double angle) {
      return 60.0 * (std::cos(angle) * rightOf(a) + std::sin(angle) * a.up.v);
    };
    return Angle{error(), {at(t) + error(), at(t + opening) + error()}};
  });
  RecordProperty("covered_percent", std::to_string(c.share()));
  EXPECT_GE(c.share(), 93);
  EXPECT_LE(c.share(), 97);
}

// A bar's two edges on a phantom with a point spread of one voxel (sigma) and noise of a fifth of the
// contrast, found by the half level of the mean of three neighbouring rows: what a careful reader does.
TEST(Lines, TheUncertaintyCoversEdgesFoundOnABlurredNoisyPhantom) {
  Draws d(4);
  int covered = 0;
  for (int n = 0; n < 1000; ++n) {
    const double spacing = d.within(0.3, 2), from = d.within(9, 10) * spacing,
                 to = d.within(24, 26) * spacing;
    const double contrast = 100, noise = contrast / 5;
    const auto step = [&](double x) { return 0.5 * std::erfc(-x / (spacing * std::numbers::sqrt2)); };
    std::vector<double> row(36, 0);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double x = (static_cast<double>(i) + 0.5) * spacing;
      for (int r = 0; r < 3; ++r)
        row[i] += (contrast * (step(x - from) - step(x - to)) + noise * d.normal()) / 3;
    }
    // The crossing nearest to the middle of the edge's own stretch.
    const auto edge = [&](double near) {
      double best = HUGE_VAL;
      for (std::size_t i = 0; i + 1 < row.size(); ++i) {
        const double a = row[i] - contrast / 2, b = row[i + 1] - contrast / 2;
        if ((a < 0) == (b < 0)) continue;
        const double x = (static_cast<double>(i) + 0.5 + a / (a - b)) * spacing;
        if (std::abs(x - near) < std::abs(best - near)) best = x;
      }
      return best;
    };
    const auto volume = volumeOf(gridOf({2, 2, 2}, glm::dvec3(spacing)), [](glm::dvec3) { return 0; });
    const auto said = measure(inPatient(Length{{glm::dvec3(edge(from), 0, 0), glm::dvec3(edge(to), 0, 0)}}),
                              sourcesOf(volume));
    ASSERT_TRUE(said.ok());
    covered += std::abs(said->quantities.at(0).value - (to - from)) <= *said->quantities.at(0).expanded;
  }
  RecordProperty("covered_percent", std::to_string(covered / 10.0));
  EXPECT_GE(covered, 900);
}

TEST(Lines, ProjectionsAndGapsAreSaid) {
  GridGeometry g = gridOf({4, 4, 6}, {1, 1, 2});
  for (int s = 0; s < 6; ++s) g.sliceOrigin_vox.push_back({0, 0, s + (s > 2 ? 3.0 : 0.0)});
  g.gapAfter = {2};
  const auto volume = volumeOf(g, [](glm::dvec3) { return 0; });
  const auto at = [&](double k) { return (g.patientFromVoxel * VoxelPoint(1, 1, k)).p; };
  const auto notes = [&](double a, double b, Shown shown) {
    Measurement m = inPatient(Length{{at(a), at(b)}});
    m.on.shown = shown;
    const auto said = measure(m, sourcesOf(volume));
    return std::pair(said->notes, said->quantities.at(0).name);
  };
  using ::testing::Contains;
  EXPECT_THAT(notes(2, 6, Shown::Slice).first, Contains("crosses missing slices"));
  EXPECT_THAT(notes(2.6, 2.9, Shown::Slice).first, Contains("crosses missing slices"));
  EXPECT_TRUE(notes(0, 2.4, Shown::Slice).first.empty());
  EXPECT_EQ(notes(0, 2, Shown::Slice).second, "length");
  for (const Shown s : {Shown::Slab, Shown::Projection, Shown::Rendering})
    EXPECT_EQ(notes(0, 2, s).second, "projected length");
}

}  // namespace
}  // namespace vernier::measure::test
