// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/ContactSheet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "vernier/picture/Png.h"

namespace vernier {
namespace {

double meanOf(const Picture& p) {
  return std::accumulate(p.pixels.begin(), p.pixels.end(), 0.0) / static_cast<double>(p.pixels.size());
}

TEST(Shrunk, KeepsTheMeanAndTheAspect) {
  Picture p(120, 90);
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x)
      for (int k = 0; k < 3; ++k) p.at(x, y)[k] = static_cast<std::uint8_t>((x * 7 + y * 13 + k * 50) % 256);
  const Picture half = shrunk(p, 60, 60);
  EXPECT_EQ(half.width, 60);
  EXPECT_EQ(half.height, 45);
  EXPECT_NEAR(meanOf(half), meanOf(p), 0.1);
  const int sum = p.at(2, 4)[0] + p.at(3, 4)[0] + p.at(2, 5)[0] + p.at(3, 5)[0];
  EXPECT_EQ(half.at(1, 2)[0], std::lround(sum / 4.0));
  const Picture odd = shrunk(p, 37, 1000);
  EXPECT_EQ(odd.width, 37);
  EXPECT_NEAR(meanOf(odd), meanOf(p), 0.5);
  EXPECT_EQ(shrunk(p, 500, 500), p) << "never enlarged";
  EXPECT_EQ(shrunk(Picture(1000, 2, {9, 8, 7}), 10, 10), Picture(10, 1, {9, 8, 7}));
}

TEST(ContactSheet, EachPictureStandsInItsCell) {
  std::vector<SheetEntry> entries;
  for (int n = 0; n < 5; ++n)
    entries.push_back({Picture(100, 100, {static_cast<std::uint8_t>(50 * n + 40), 0, 255}),
                       "view " + std::to_string(n),
                       {"0.4 ms, native", "error <= 0.01 of 255 (99 %)"}});
  const auto sheet = contactSheet("Vernier", entries, 3, 120);
  ASSERT_TRUE(sheet.ok());
  EXPECT_EQ(sheet->width, 16 + 3 * 136);
  for (int n = 0; n < 5; ++n) {
    int count = 0;
    for (std::size_t i = 0; i < sheet->pixels.size(); i += 3)
      count += sheet->pixels[i] == 50 * n + 40 && sheet->pixels[i + 1] == 0 && sheet->pixels[i + 2] == 255;
    EXPECT_EQ(count, 100 * 100) << "picture " << n << " is shown whole and unchanged";
  }
  EXPECT_EQ(*contactSheet("Vernier", entries, 3, 120), *sheet);
  // Something stands under the first picture.
  int ink = 0;
  for (int y = 16 + 38 + 120; y < 16 + 38 + 120 + 60; ++y)
    for (int x = 16; x < 136; ++x) ink += sheet->at(x, y)[0] > 150;
  EXPECT_GT(ink, 200);
}

TEST(ContactSheet, RefusesWhatCannotBe) {
  EXPECT_EQ(contactSheet("", {}, 3, 100).error().code, ErrorCode::OptionInvalid);
  EXPECT_EQ(contactSheet("", {{Picture(2, 2), "a", {}}}, 0, 100).error().code, ErrorCode::OptionInvalid);
  EXPECT_EQ(contactSheet("", {{Picture(), "a", {}}}, 1, 100).error().code, ErrorCode::OptionInvalid);
  EXPECT_EQ(contactSheet("", {{Picture(2, 2), "a", {}}}, 1, 40000).error().code, ErrorCode::LimitExceeded);
}

}  // namespace
}  // namespace vernier
