// SPDX-License-Identifier: GPL-3.0-or-later
// Automatic and default windows, and frames, against sorting.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "Grids.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/ImageFrame.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {
using test::unitGrid;
using test::volumeOf;

double low(const VoiWindow& w) { return w.center - w.width / 2; }
double high(const VoiWindow& w) { return w.center + w.width / 2; }

struct Pair {
  double first, last;
};
Pair byRank(const Volume& v) {
  std::vector<double> all;
  for (std::int64_t k = 0; k < v.grid().slices; ++k)
    for (std::int64_t j = 0; j < v.grid().rows; ++j)
      for (std::int64_t i = 0; i < v.grid().columns; ++i)
        if (!v.isNoData(v.stored(i, j, k))) all.push_back(v.modality(i, j, k));
  std::sort(all.begin(), all.end());
  const double n = double(all.size());
  return {all[std::size_t(std::ceil(n / 100) - 1)], all[std::size_t(std::ceil(99 * n / 100) - 1)]};
}

template <class T>
class AutomaticWindow : public ::testing::Test {};
using AllTypes = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                  std::int32_t, float>;
TYPED_TEST_SUITE(AutomaticWindow, AllTypes);

TYPED_TEST(AutomaticWindow, IsThe1stAnd99thPercentile) {
  using T = TypeParam;
  const double top = std::min(1e9, double(std::numeric_limits<T>::max()));
  const double bottom = std::is_signed_v<T> ? -top / 2 : 0;
  for (int round = 0; round < 6; ++round) {
    VolumeInfo info;
    info.grid = unitGrid(13, 11, 7 + round);
    auto values =
        test::randomValues<T>(std::size_t(13 * 11 * (7 + round)), std::uint64_t(round), bottom, top);
    if (round & 1) info.rescale = {{-0.25, 17}};
    if (round & 2) info.noData = NoDataRange{bottom, bottom + 0.3 * (top - bottom)};
    const auto v = volumeOf(info, values);
    const Pair expected = byRank(*v);
    const VoiWindow w = automaticWindow(*v);
    EXPECT_NEAR(low(w), expected.first, 1e-9 * top) << round;
    EXPECT_NEAR(high(w), expected.last, 1e-9 * top) << round;
  }
}

TEST(Window, PercentilesWithSlopesOfTheirOwnAreExactToFloat) {
  VolumeInfo info;
  info.grid = unitGrid(20, 20, 3);
  info.rescale = {{0.1, 0}, {-7, 3}, {0.003, 1e4}};
  const auto v = volumeOf(info, test::randomValues<std::int16_t>(1200, 3, -2000, 2000));
  const Pair expected = byRank(*v);
  EXPECT_NEAR(low(automaticWindow(*v)), expected.first, 1e-3);
  EXPECT_NEAR(high(automaticWindow(*v)), expected.last, 1e-3);
}

TEST(Window, NaNIsLeftOut) {
  VolumeInfo info;
  info.grid = unitGrid(10, 10, 1);
  std::vector<float> values(100, std::nanf(""));
  values[3] = -2;
  values[50] = 6;
  const VoiWindow w = automaticWindow(*volumeOf(info, values));
  EXPECT_EQ(low(w), -2);
  EXPECT_EQ(high(w), 6);
}

TEST(Window, AConstantVolumeIsMidGrey) {
  VolumeInfo info;
  info.grid = unitGrid(4, 4, 2);
  for (double slope : {1.0, 0.001, 30.0}) {
    info.rescale = {{slope, -5}};
    const auto v = volumeOf(info, std::vector<std::int16_t>(32, 77));
    const VoiWindow w = defaultWindow(*v);
    EXPECT_GT(w.width, 0);
    EXPECT_NEAR(applyVoi(w, v->modality(1, 1, 1)), 0.5, 1e-9);
  }
  info.rescale = {{1, 0}};
  for (float x : {0.0f, 1e-30f, -3e38f, 1e30f}) {
    const auto v = volumeOf(info, std::vector<float>(32, x));
    EXPECT_NEAR(applyVoi(defaultWindow(*v), x), 0.5, 1e-9) << x;
  }
}

TEST(Window, AllPaddingGivesSomeWindow) {
  VolumeInfo info;
  info.grid = unitGrid(4, 4, 2);
  info.noData = NoDataRange{7, 7};
  const auto v = volumeOf(info, std::vector<std::int16_t>(32, 7));
  EXPECT_TRUE(usableWindow(defaultWindow(*v)));
  ASSERT_EQ(v->info().findings.size(), 1u);
  EXPECT_EQ(v->info().findings[0].code, "all-padding");
}

TEST(Window, TheFilesFirstUsableOneIsTheDefault) {
  VolumeInfo info;
  info.grid = unitGrid(2, 2, 1);
  info.windows = {
      {1, 0, VoiFunction::Linear, ""}, {40, 0.5, VoiFunction::Linear, ""}, {1, 2, VoiFunction::Linear, ""}};
  const VoiWindow w = defaultWindow(*volumeOf(info, std::vector<std::int16_t>(4, 0)));
  EXPECT_EQ(w.center, 40);
  EXPECT_EQ(w.function, VoiFunction::LinearExact);
}

TEST(Window, TissueRangePaddingIsLeftOutOfTheAutomaticWindowOnly) {
  VolumeInfo info;
  info.grid = unitGrid(10, 10, 1);
  info.paddingInTissueRange = true;
  info.windowNoData = NoDataRange{0, 0};
  std::vector<std::int16_t> values(100, 0);
  for (std::size_t i = 0; i < 50; ++i) values[i] = static_cast<std::int16_t>(100 + i);
  const auto v = volumeOf(info, values);
  EXPECT_EQ(low(automaticWindow(*v)), 100);
  EXPECT_EQ(high(automaticWindow(*v)), 149);
  EXPECT_EQ(v->modalityRange()->min, 0);
  EXPECT_FALSE(v->probe(9, 9, 0).noData);
  // nothing but padding value: then it is data
  const auto black = volumeOf(info, std::vector<std::int16_t>(100, 0));
  EXPECT_NEAR(applyVoi(automaticWindow(*black), 0), 0.5, 1e-12);
}

ImageFrameInfo frameInfo() {
  ImageFrameInfo i;
  i.columns = 2;
  i.rows = 2;
  i.type = VoxelType::U16;
  return i;
}

TEST(ImageFrame, ReadsStoredAndModalityValues) {
  ImageFrameInfo info = frameInfo();
  info.rescale = {2.5, -1000};
  info.noData = NoDataRange{9, 9};
  const auto f = ImageFrame::make(info, test::bufferOf<std::uint16_t>({0, 1, 9, 65535}));
  ASSERT_TRUE(f.ok());
  EXPECT_EQ((*f)->stored(1, 1), 65535);
  EXPECT_EQ((*f)->modality(1, 0), -997.5);
  EXPECT_TRUE((*f)->isNoData((*f)->stored(0, 1)));
}

TEST(ImageFrame, ModalityLutHoldsItsEnds) {
  ImageFrameInfo info = frameInfo();
  info.modalityLut = LutTable{10, 16, {100, 200, 300}, ""};
  const auto f = ImageFrame::make(info, test::bufferOf<std::uint16_t>({0, 11, 12, 65535}));
  ASSERT_TRUE(f.ok());
  EXPECT_EQ((*f)->modality(0, 0), 100);
  EXPECT_EQ((*f)->modality(1, 0), 200);
  EXPECT_EQ((*f)->modality(0, 1), 300);
  EXPECT_EQ((*f)->modality(1, 1), 300);
}

TEST(ImageFrame, RefusesWhatDoesNotFit) {
  const auto code = [](ImageFrameInfo info, std::size_t n) {
    const auto f = ImageFrame::make(std::move(info), test::bufferOf(std::vector<std::uint16_t>(n)));
    EXPECT_FALSE(f.ok());
    return f.ok() ? ErrorCode::Internal : f.error().code;
  };
  EXPECT_EQ(code(frameInfo(), 3), ErrorCode::PixelDataShort);
  ImageFrameInfo empty = frameInfo();
  empty.columns = 0;
  EXPECT_EQ(code(empty, 0), ErrorCode::PixelDescriptionInvalid);
  ImageFrameInfo flat = frameInfo();
  flat.rescale.slope = 0;
  EXPECT_EQ(code(flat, 4), ErrorCode::RescaleInvalid);
  ImageFrameInfo noLut = frameInfo();
  noLut.modalityLut = LutTable{};
  EXPECT_EQ(code(noLut, 4), ErrorCode::PixelDescriptionInvalid);
}

TEST(Voi, LutClampsAndScalesByItsBits) {
  const LutTable lut{-2, 8, {0, 51, 255}, ""};
  EXPECT_EQ(applyVoi(lut, -50), 0);
  EXPECT_EQ(applyVoi(lut, -1), 0.2);
  EXPECT_EQ(applyVoi(lut, 0), 1);
  EXPECT_EQ(applyVoi(lut, 1e9), 1);
  EXPECT_TRUE(std::isnan(applyVoi(lut, std::nan(""))));
}

}  // namespace
}  // namespace vernier
