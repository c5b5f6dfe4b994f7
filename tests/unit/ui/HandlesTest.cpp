// SPDX-License-Identifier: GPL-3.0-or-later
// What follows the handle that a hand moves.
#include "Handles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "Facts.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

using measure::Space;
using measure::Spot;

// Rows twice as far apart as columns: what is square in pixels of the frame is not so in mm.
SourceFacts oblongFacts() {
  SourceFacts f = test::axialFacts(1, "a");
  for (ImageFrameInfo& i : f.frames) i.pixelSpacing_mm = {1.0, 0.5};
  return f;
}
struct Ground {
  SourceFacts facts = oblongFacts();
  Scene scene = stackScene("a", 7, {});
  Place place = *placeOf(scene, facts, nullptr, View{200, 160});
};
// mm of a spot of the frame.
glm::dvec2 mm(const Spot& s) { return {0.5 * s.x, 1.0 * s.y}; }
double cosine(const measure::Bidirectional& b) {
  const glm::dvec2 u = mm(b.longAxis[1]) - mm(b.longAxis[0]), v = mm(b.shortAxis[1]) - mm(b.shortAxis[0]);
  return glm::dot(u, v) / glm::length(u) / glm::length(v);
}
double lengthOf(const std::array<Spot, 2>& ends) { return glm::length(mm(ends[1]) - mm(ends[0])); }

// As the window draws them: two points of the long axis, one of the short one, and the hand.
measure::Bidirectional drawn(const Ground& g) {
  const std::array<glm::dvec2, 4> px{{{40, 60}, {120, 90}, {70, 95}, {103, 20}}};
  measure::Bidirectional b;
  for (int n = 0; n < 2; ++n) b.longAxis[n] = spotAt(g.place, Space::Image, px[n]);
  b.shortAxis[0] = spotAt(g.place, Space::Image, px[2]);
  b.shortAxis[1] = spotAt(g.place, Space::Image, acrossLongAxis(px[0], px[1], px[2], px[3]));
  return b;
}

TEST(Handles, TheShortDiameterIsDrawnAtRightAnglesInMillimetres) {
  const Ground g;
  const measure::Bidirectional b = drawn(g);
  EXPECT_NEAR(cosine(b), 0, 1e-12);
  EXPECT_GT(lengthOf(b.shortAxis), 1);
  // No long axis: the hand is where it is.
  EXPECT_EQ(acrossLongAxis({5, 5}, {5, 5}, {1, 1}, {9, 2}), glm::dvec2(9, 2));
}

TEST(Handles, TheShortDiameterTurnsWithTheLongOneAndKeepsItsLength) {
  const Ground g;
  const measure::Bidirectional before = drawn(g);
  measure::Shape s = before;
  moveGrip(s, 1, spotAt(g.place, Space::Image, {60, 140}), g.place, Space::Image);
  const auto& b = std::get<measure::Bidirectional>(s);
  EXPECT_NEAR(cosine(b), 0, 1e-12);
  EXPECT_NEAR(lengthOf(b.shortAxis), lengthOf(before.shortAxis), 1e-9);
  EXPECT_EQ(b.longAxis[0], before.longAxis[0]);
  EXPECT_NE(b.longAxis[1], before.longAxis[1]);
}

TEST(Handles, AnEndOfTheShortDiameterSlidesIt) {
  const Ground g;
  for (const std::size_t n : {2u, 3u}) {
    const measure::Bidirectional before = drawn(g);
    measure::Shape s = before;
    const Spot to = spotAt(g.place, Space::Image, {88, 40});
    moveGrip(s, n, to, g.place, Space::Image);
    const auto& b = std::get<measure::Bidirectional>(s);
    EXPECT_EQ(b.shortAxis[n - 2], to);
    EXPECT_EQ(b.longAxis, before.longAxis);
    EXPECT_NEAR(cosine(b), 0, 1e-12);
    // The other end stays as far from the long axis as it was.
    const glm::dvec2 u = glm::normalize(mm(b.longAxis[1]) - mm(b.longAxis[0])), across(-u.y, u.x);
    EXPECT_NEAR(glm::dot(mm(b.shortAxis[3 - n]) - mm(b.longAxis[0]), across),
                glm::dot(mm(before.shortAxis[3 - n]) - mm(before.longAxis[0]), across), 1e-9);
  }
}

TEST(Handles, TheLongerDiameterIsTheLongAxis) {
  const Ground g;
  measure::Bidirectional b = drawn(g);
  std::swap(b.longAxis, b.shortAxis);
  measure::Shape s = b;
  settleGrips(s, g.place, Space::Image);
  EXPECT_EQ(std::get<measure::Bidirectional>(s), drawn(g));
  settleGrips(s, g.place, Space::Image);
  EXPECT_EQ(std::get<measure::Bidirectional>(s), drawn(g));
}

TEST(Handles, AnOutlineByHandHasFewGripsAndItsNeighboursFollow) {
  const Ground g;
  std::vector<Spot> round;
  for (int n = 0; n < 200; ++n)
    round.emplace_back(30 + 10 * std::cos(n * 0.0314159265), 20 + 10 * std::sin(n * 0.0314159265), 0);
  measure::Shape s = measure::FreehandRegion{round};
  const std::vector<std::size_t> grips = gripsOf(s);
  ASSERT_EQ(grips.size(), kMostGrips);
  EXPECT_EQ(gripsOf(measure::PolygonRegion{round}).size(), 200u);
  EXPECT_EQ(gripsOf(measure::FreehandRegion{{round[0], round[1], round[2]}}).size(), 3u);
  const Spot to = round[grips[0]] + Spot(3, -2, 0);
  moveGrip(s, grips[0], to, g.place, Space::Image);
  const std::vector<Spot>& now = std::get<measure::FreehandRegion>(s).outline;
  EXPECT_EQ(now[grips[0]], to);
  for (std::size_t k = 1; k < grips.size(); ++k) EXPECT_EQ(now[grips[k]], round[grips[k]]) << k;
  // Half way to the next grip half of the way, on both sides, across the end of the list.
  EXPECT_LT(glm::length(now[10] - round[10] - 0.5 * Spot(3, -2, 0)), 1e-12);
  EXPECT_LT(glm::length(now[190] - round[190] - 0.5 * Spot(3, -2, 0)), 1e-12);
  double longest = 0;
  for (std::size_t k = 1; k < now.size(); ++k) longest = std::max(longest, glm::length(now[k] - now[k - 1]));
  EXPECT_LT(longest, 1.0) << "no jump";
}

TEST(Handles, AllOtherPointsMoveAlone) {
  const Ground g;
  measure::Shape s = measure::Cobb{{Spot(1, 1, 0), Spot(9, 2, 0)}, {Spot(1, 20, 0), Spot(9, 25, 0)}};
  moveGrip(s, 2, Spot(4, 4, 0), g.place, Space::Image);
  EXPECT_EQ(measure::handlesOf(s),
            (std::vector<Spot>{Spot(1, 1, 0), Spot(9, 2, 0), Spot(4, 4, 0), Spot(9, 25, 0)}));
}

}  // namespace
}  // namespace vernier::ui
