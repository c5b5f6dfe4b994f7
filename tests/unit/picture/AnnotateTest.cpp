// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Annotate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "vernier/picture/Describe.h"

namespace vernier {
namespace {

using ::testing::Contains;

Annotations full() {
  Annotations a;
  a.letters = {"RA", "LP", "AR", "PL"};
  a.flipped = true;
  a.what = {{"MIP 10 mm axial 12/28", "MIP 10 mm", Tone::Normal},
            {"slice missing at 28.1..38.1 mm", "slice missing", Tone::Normal},
            {"coarse in z", "", Tone::Normal}};
  a.status = {errorLine(0.31, 99), {"C 40 W 400 HU", "C 40 W 400", Tone::Normal}};
  a.mmPerPixel = 0.48828125;
  return a;
}
bool overlap(const Box& a, const Box& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}
const LaidText* find(const Layout& layout, const std::string& text) {
  for (const LaidText& t : layout.texts)
    if (t.text == text) return &t;
  return nullptr;
}
double centreX(const Box& b) { return b.x + b.width / 2.0; }
double centreY(const Box& b) { return b.y + b.height / 2.0; }

TEST(Layout, NothingOverlapsOrLeavesThePictureAtAnySize) {
  for (int width = 128; width <= 1100; width += 27)
    for (int height : {128, 200, 391, 512, 1000})
      for (double scale : {1.0, 1.5, 2.0, 3.0}) {
        const Layout layout = layoutAnnotations(full(), width, height, scale);
        std::vector<Box> boxes;
        for (const LaidText& t : layout.texts) boxes.push_back(t.box);
        if (layout.bar) boxes.push_back(layout.bar->box);
        const int size = layout.texts.empty() ? 0 : layout.texts.back().size_px;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
          const Box& b = boxes[i];
          ASSERT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.width <= width && b.y + b.height <= height)
              << width << " x " << height << " scale " << scale;
          for (std::size_t j = 0; j < i; ++j) {
            // Outlines of neighbouring rows, and of the scale bar and its label, may touch; what is inside
            // may not.
            Box a = boxes[j], c = b;
            const int outline = std::max(2, size / 6);
            a.y += outline, a.height -= 2 * outline, c.y += outline, c.height -= 2 * outline;
            ASSERT_FALSE(overlap(a, c))
                << i << ", " << j << " at " << width << " x " << height << " scale " << scale;
          }
        }
      }
}

TEST(Layout, LettersStandAtTheirEdgesAndAreNeverLost) {
  for (int size : {128, 256, 512, 1024}) {
    const Layout layout = layoutAnnotations(full(), size, size);
    const LaidText *left = find(layout, "RA"), *right = find(layout, "LP"), *top = find(layout, "AR"),
                   *bottom = find(layout, "PL");
    ASSERT_TRUE(left && right && top && bottom) << size;
    EXPECT_LT(left->box.x, 8);
    EXPECT_GT(right->box.x + right->box.width, size - 8);
    EXPECT_LT(top->box.y, 8);
    EXPECT_GT(bottom->box.y + bottom->box.height, size - 8);
    for (const LaidText* t : {left, right}) EXPECT_NEAR(centreY(t->box), size / 2.0, 0.04 * size);
    for (const LaidText* t : {top, bottom}) EXPECT_NEAR(centreX(t->box), size / 2.0, 0.02 * size);
    EXPECT_NE(find(layout, "FLIPPED"), nullptr) << size;
  }
}

TEST(Layout, AllIsShownWhereThereIsRoom) {
  const Layout layout = layoutAnnotations(full(), 512, 512);
  EXPECT_TRUE(layout.dropped.empty());
  for (const char* text : {"MIP 10 mm axial 12/28", "slice missing at 28.1..38.1 mm", "coarse in z",
                           "error <= 0.31 of 255 (99 %)", "C 40 W 400 HU", "50 mm"})
    EXPECT_NE(find(layout, text), nullptr) << text;
  EXPECT_LT(find(layout, "MIP 10 mm axial 12/28")->box.y, find(layout, "coarse in z")->box.y);
  EXPECT_GT(find(layout, "C 40 W 400 HU")->box.y, 400);
}

TEST(Layout, TheLeastImportantGoesFirst) {
  const Layout layout = layoutAnnotations(full(), 128, 128);
  EXPECT_TRUE(find(layout, "MIP 10 mm") || find(layout, "MIP 10 mm axial 12/28"));
  EXPECT_TRUE(find(layout, "<= 0.31/255") || find(layout, "error <= 0.31 of 255 (99 %)"));
  const Layout tiny = layoutAnnotations(full(), 64, 64);
  EXPECT_FALSE(tiny.dropped.empty());
  EXPECT_NE(find(tiny, "RA"), nullptr);
}

TEST(Layout, NoTextIsCut) {
  const Annotations a = full();
  for (int width : {128, 160, 300})
    for (const LaidText& t : layoutAnnotations(a, width, 200).texts) {
      bool known = t.text.ends_with(" mm") || t.text == "FLIPPED" || t.text == "RA" || t.text == "LP" ||
                   t.text == "AR" || t.text == "PL";
      for (const auto* lines : {&a.what, &a.status})
        for (const TextLine& l : *lines) known = known || t.text == l.text || t.text == l.shortText;
      EXPECT_TRUE(known) << t.text;
    }
}

TEST(Layout, NoLettersWhenUnknown) {
  Annotations a;
  const Layout layout = layoutAnnotations(a, 256, 256);
  ASSERT_EQ(layout.texts.size(), 1u);
  EXPECT_EQ(layout.texts[0].text, "lengths in px");
  EXPECT_FALSE(layout.bar.has_value());
  a.scaleBar = false;
  EXPECT_TRUE(layoutAnnotations(a, 256, 256).texts.empty());
}

TEST(ScaleBar, LengthIsRoundAndTrue) {
  EXPECT_DOUBLE_EQ(scaleBarLength_mm(0.5, 128), 50);
  EXPECT_DOUBLE_EQ(scaleBarLength_mm(0.5, 100), 50);
  EXPECT_DOUBLE_EQ(scaleBarLength_mm(0.5, 99), 20);
  EXPECT_DOUBLE_EQ(scaleBarLength_mm(0.01, 99), 0.5);
  for (double mmPerPixel = 0.001; mmPerPixel < 50; mmPerPixel *= 1.13)
    for (int width : {128, 500, 2000}) {
      Annotations a;
      a.mmPerPixel = mmPerPixel;
      const Layout layout = layoutAnnotations(a, width, width);
      ASSERT_TRUE(layout.bar.has_value());
      const double length_px = layout.bar->x1 - layout.bar->x0;
      EXPECT_NEAR(length_px * mmPerPixel, layout.bar->length_mm, 0.5 * mmPerPixel) << "to half a pixel";
      EXPECT_LE(length_px, 0.25 * width + 1);
      EXPECT_GE(length_px, 0.09 * width);
      const double lead =
          layout.bar->length_mm / std::pow(10, std::floor(std::log10(layout.bar->length_mm) + 1e-9));
      EXPECT_TRUE(std::abs(lead - 1) < 1e-9 || std::abs(lead - 2) < 1e-9 || std::abs(lead - 5) < 1e-9)
          << lead;
    }
}

TEST(ScaleBar, IsDrawnAsLongAsItSays) {
  Annotations a;
  a.mmPerPixel = 1;
  Picture p(400, 400, {90, 90, 90});
  const Layout layout = layoutAnnotations(a, 400, 400);
  drawLayout(p, layout);
  int bright = 0;
  for (int x = 0; x < 400; ++x) bright += p.at(x, layout.bar->y)[0] == 240;
  EXPECT_EQ(layout.bar->length_mm, 100);
  EXPECT_EQ(bright, 100);
}

// The ink of a text, and what surrounds it, on backgrounds from black to white and on noise.
TEST(Annotate, TextCanBeReadOnAnyBackground) {
  for (int background = 0; background <= 256; background += 32) {
    Picture p(256, 64, {});
    for (std::size_t i = 0; i < p.pixels.size(); ++i)
      p.pixels[i] = background == 256 ? static_cast<std::uint8_t>((i / 3 * 2654435761u) >> 24)
                                      : static_cast<std::uint8_t>(std::min(background, 255));
    Layout layout;
    layout.texts.push_back({"H", 100, 40, 24, Tone::Normal, {}});
    drawLayout(p, layout);
    // The left stem of the H: bright ink, dark on both sides of it.
    int brightest = 0, at = 0;
    for (int x = 98; x < 108; ++x)
      if (p.at(x, 34)[1] > brightest) brightest = p.at(x, 34)[1], at = x;
    EXPECT_GE(brightest, 225) << background;
    int darkLeft = 255, darkRight = 255;
    for (int d = 1; d <= 4; ++d) {
      darkLeft = std::min<int>(darkLeft, p.at(at - d, 34)[1]);
      darkRight = std::min<int>(darkRight, p.at(at + d, 34)[1]);
    }
    EXPECT_LE(darkLeft, 40) << background;
    EXPECT_LE(darkRight, 40) << background;
  }
}

TEST(Annotate, OnlyTheBoxesAreTouched) {
  Picture p(320, 240, {77, 88, 99});
  const Layout layout = layoutAnnotations(full(), 320, 240);
  drawLayout(p, layout);
  const auto inside = [&](int x, int y) {
    const int shadow = 4;
    const auto in = [&](const Box& b) {
      return x >= b.x - shadow && x < b.x + b.width + shadow && y >= b.y - shadow &&
             y < b.y + b.height + shadow;
    };
    for (const LaidText& t : layout.texts)
      if (in(t.box)) return true;
    return layout.bar && in(layout.bar->box);
  };
  int touched = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x) {
      const bool changed = p.at(x, y)[0] != 77 || p.at(x, y)[1] != 88 || p.at(x, y)[2] != 99;
      touched += changed;
      ASSERT_TRUE(!changed || inside(x, y)) << x << ", " << y;
    }
  EXPECT_GT(touched, 1000);
}

TEST(Annotate, SameEachTimeAndSafeWithOddText) {
  Annotations a = full();
  a.what.push_back({"\xE2\x89\xA4 \xC3\xA4\xC3\xB6 \xFF\xFE\xE2 \x01\n", "", Tone::Amber});
  Picture p(512, 512), q(512, 512);
  annotate(p, a);
  annotate(q, a);
  EXPECT_EQ(p, q);
  Picture small(3, 2);
  annotate(small, a, 3);
  EXPECT_EQ(small, Picture(3, 2)) << "nothing fits, nothing is drawn";
}

}  // namespace
}  // namespace vernier
