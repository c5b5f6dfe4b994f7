// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases B1..B13: stored values, rescale, windows, padding. From pixels in DICOM files to volumes,
// frames and the grey that a window gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <set>

#include "HandMadeStudy.h"
#include "vernier/volume/Bricks.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {
using test::DicomSlice;
using test::HandMadeStudy;
using VolumePtr = std::shared_ptr<const Volume>;

VolumePtr volumeOf(HandMadeStudy& s) {
  auto v = buildVolume(s.set, s.series(), s.stack());
  EXPECT_TRUE(v.ok()) << (v.ok() ? "" : v.error().text());
  return v.ok() ? *v : nullptr;
}

// Two equal slices of these pixels, one row.
DicomSlice rowOf(std::vector<std::int64_t> pixels) {
  DicomSlice d;
  d.rows = 1;
  d.columns = int(pixels.size());
  d.pixels = std::move(pixels);
  return d;
}

VolumePtr floatVolume(const std::vector<float>& values, std::int64_t n) {
  VolumeInfo info;
  info.type = VoxelType::F32;
  info.grid.columns = info.grid.rows = info.grid.slices = n;
  auto made = Buffer::make(values.size() * sizeof(float));
  EXPECT_TRUE(made.ok());
  Buffer b = std::move(made).value();
  std::memcpy(b.data(), values.data(), b.size());
  auto v = Volume::make(std::move(info), std::move(b));
  EXPECT_TRUE(v.ok());
  return v.ok() ? *v : nullptr;
}

const Finding* findingOf(const Volume& v, const std::string& code) {
  for (const Finding& f : v.info().findings)
    if (f.code == code) return &f;
  return nullptr;
}

// Least and greatest of what a window makes of a whole volume.
struct Greys {
  double low = 2, high = -1;
};
Greys greysOf(const Volume& v, const VoiWindow& w) {
  Greys g;
  for (std::int64_t k = 0; k < v.grid().slices; ++k)
    for (std::int64_t j = 0; j < v.grid().rows; ++j)
      for (std::int64_t i = 0; i < v.grid().columns; ++i) {
        const double y = applyVoi(w, v.modality(i, j, k));
        g.low = std::min(g.low, y);
        g.high = std::max(g.high, y);
      }
  return g;
}

TEST(Stability, B01_FullRangesRoundTripWithoutSignFlip) {
  for (const bool isSigned : {true, false}) {
    DicomSlice d;
    d.rows = d.columns = 256;
    d.isSigned = isSigned;
    const int lowest = isSigned ? -32768 : 0;
    for (int n = 0; n < 65536; ++n) d.pixels.push_back(lowest + n);
    HandMadeStudy s;
    makeStudy(s, {d, d});
    ASSERT_TRUE(s.scan());
    const VolumePtr v = volumeOf(s);
    ASSERT_TRUE(v);
    for (int n = 0; n < 65536; ++n) ASSERT_EQ(v->stored(n % 256, n / 256, 1), lowest + n);
    EXPECT_EQ(v->modalityRange()->min, lowest);
    EXPECT_EQ(v->modalityRange()->max, lowest + 65535);
    const auto f = buildImageFrame(s.set, s.series(), s.stack(), 0);
    ASSERT_TRUE(f.ok());
    EXPECT_EQ((*f)->stored(0, 0), lowest);
    EXPECT_EQ((*f)->stored(255, 255), lowest + 65535);
  }
}

TEST(Stability, B02_GarbageAboveBitsStoredIsMaskedBeforeTheRange) {
  DicomSlice d =
      rowOf({0x7001 /* 1 */, 0xA7FF /* 2047 */, 0x5800 /* -2048 */, 0x0FFF /* -1 */, 0xF000 /* 0 */});
  d.bitsStored = 12;
  HandMadeStudy s;
  makeStudy(s, {d, d});
  ASSERT_TRUE(s.scan());
  const VolumePtr v = volumeOf(s);
  ASSERT_TRUE(v);
  const double expected[] = {1, 2047, -2048, -1, 0};
  for (int i = 0; i < 5; ++i) EXPECT_EQ(v->stored(i, 0, 0), expected[i]) << i;
  EXPECT_EQ(v->modalityRange()->min, -2048);
  EXPECT_EQ(v->modalityRange()->max, 2047);
}

// Ten digits, as the file has them.
double slopeInFile(const DicomSlice& d) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", d.slope);
  return std::strtod(text, nullptr);
}

TEST(Stability, B03_TinyAndHugeSlopesKeepTwelveDigits) {
  for (const bool perSlice : {false, true})
    for (const double slope : {2.87e-6, 1.0 / 65535, 1e-6, 1e6}) {
      DicomSlice d = rowOf({-32768, -7, 1, 12345, 32767}), e = d;
      d.slope = slope;
      e.slope = perSlice ? 3 * slope : slope;
      HandMadeStudy s;
      makeStudy(s, {d, e});
      ASSERT_TRUE(s.scan());
      const VolumePtr v = volumeOf(s);
      ASSERT_TRUE(v);
      EXPECT_EQ(v->hasOriginal(), perSlice);
      for (std::int64_t k = 0; k < 2; ++k)
        for (std::int64_t i = 0; i < 5; ++i) {
          const long double truth = static_cast<long double>(slopeInFile(k == 0 ? d : e)) *
                                    static_cast<long double>(v->probe(i, 0, k).stored);
          const auto sampled = sampleModality(*v, PatientPoint(double(i), 0, 2.0 * double(k)));
          ASSERT_TRUE(sampled);
          EXPECT_LE(std::fabs(v->probe(i, 0, k).modality - truth), 1e-12L * std::fabs(truth));
          EXPECT_LE(std::fabs(*sampled - truth), 1e-12L * std::fabs(truth));
        }
    }
}

TEST(Stability, B04_AnImpossibleSlopeIsRefusedAndStoredValuesAreShownUnscaled) {
  for (const double slope : {0.0, std::nan(""), double(INFINITY)}) {
    VolumeInfo info;
    info.grid.columns = info.grid.rows = info.grid.slices = 1;
    info.rescale = {{slope, 0}};
    const auto v = Volume::make(info, std::move(Buffer::make(2)).value());
    ASSERT_FALSE(v.ok());
    EXPECT_EQ(v.error().code, ErrorCode::RescaleInvalid);
  }
  for (const char* slope : {"0", "1e999", "NaN"}) {
    DicomSlice d = rowOf({1, 2, 300});
    d.set = {{"0028,1053", slope}};
    HandMadeStudy s;
    makeStudy(s, {d, d});
    ASSERT_TRUE(s.scan());
    const VolumePtr v = volumeOf(s);
    ASSERT_TRUE(v);
    EXPECT_TRUE(v->info().unscaled) << slope;
    EXPECT_EQ(v->info().unit, "stored value");
    EXPECT_EQ(v->modality(2, 0, 0), 300);
  }
}

TEST(Stability, B05_WidthOneAndTwoAreThresholds) {
  for (const double c : {-1000.0, 0.0, 40.0, 2048.0})
    for (int x = -3000; x <= 3000; ++x) {
      ASSERT_EQ(applyVoi({c, 1, VoiFunction::Linear, ""}, x), x < c ? 0 : 1) << c << " " << x;
      ASSERT_EQ(applyVoi({c, 2, VoiFunction::Linear, ""}, x), x < c ? 0 : 1) << c << " " << x;
    }
  // other numbers switch at c - 0.5
  EXPECT_EQ(applyVoi({40, 1, VoiFunction::Linear, ""}, 39.5), 0);
  EXPECT_EQ(applyVoi({40, 1, VoiFunction::Linear, ""}, 39.5 + 1e-9), 1);
}

TEST(Stability, B06_WidthBelowOneIsLinearExactWithANotice) {
  HandMadeStudy s;
  DicomSlice d = rowOf({0, 1, 2});
  d.set = {{"0028,1050", "1"}, {"0028,1051", "0.5"}};
  makeStudy(s, {d, d});
  ASSERT_TRUE(s.scan());
  const VolumePtr v = volumeOf(s);
  ASSERT_TRUE(v);
  EXPECT_EQ(defaultWindow(*v).function, VoiFunction::LinearExact);
  EXPECT_EQ(applyVoi(defaultWindow(*v), 1), 0.5);
  EXPECT_EQ(applyVoi(defaultWindow(*v), 0.75), 0);
  EXPECT_EQ(applyVoi(defaultWindow(*v), 1.25), 1);
  const Finding* f = findingOf(*v, "window-width-below-one");
  ASSERT_TRUE(f);
  EXPECT_EQ(f->severity, Severity::Notice);
}

TEST(Stability, B07_ImpossibleWidthsGiveTheDefaultWindowWithoutInversion) {
  for (const char* width : {"0", "-100", "NaN", "1e999"}) {
    DicomSlice d = rowOf({0, 50, 100});
    d.set = {{"0028,1050", "40"}, {"0028,1051", width}};
    HandMadeStudy s;
    makeStudy(s, {d, d});
    ASSERT_TRUE(s.scan());
    const VolumePtr v = volumeOf(s);
    ASSERT_TRUE(v);
    const VoiWindow w = defaultWindow(*v);
    EXPECT_TRUE(usableWindow(w));
    EXPECT_LT(applyVoi(w, 0), applyVoi(w, 100));
    EXPECT_NEAR(applyVoi(w, 50), 0.5, 1e-12);
  }
}

TEST(Stability, B08_AConstantImageIsUniformGrey) {
  for (const std::int64_t value : {-32768, -1, 0, 1000, 32767}) {
    HandMadeStudy s;
    makeStudy(s, {rowOf({value, value}), rowOf({value, value})});
    ASSERT_TRUE(s.scan());
    const VolumePtr v = volumeOf(s);
    ASSERT_TRUE(v);
    const VoiWindow w = defaultWindow(*v);
    EXPECT_GE(w.width, 1);
    EXPECT_EQ(greysOf(*v, w).low, 0.5);
    EXPECT_EQ(greysOf(*v, w).high, 0.5);
    const auto f = buildImageFrame(s.set, s.series(), s.stack(), 0);
    ASSERT_TRUE(f.ok());
    EXPECT_EQ(applyVoi((*f)->info().autoWindow, double(value)), 0.5);
  }
}

TEST(Stability, B09_WindowsFarBeyondTheDataAreFlatAndSignedDataIsNotClipped) {
  HandMadeStudy s;
  makeStudy(s, {rowOf({-1024, 0, 3071}), rowOf({-1024, 0, 3071})});
  ASSERT_TRUE(s.scan());
  const VolumePtr v = volumeOf(s);
  ASSERT_TRUE(v);
  const Greys wide = greysOf(*v, {0, 1e9, VoiFunction::Linear, ""});
  EXPECT_NEAR(wide.low, 0.5, 1e-5);
  EXPECT_NEAR(wide.high, 0.5, 1e-5);
  EXPECT_LT(wide.low, wide.high);
  EXPECT_EQ(greysOf(*v, {1e9, 100, VoiFunction::Linear, ""}).high, 0);
  EXPECT_EQ(greysOf(*v, {-1e9, 100, VoiFunction::Linear, ""}).low, 1);
  EXPECT_EQ(greysOf(*v, {1e300, 1e-300, VoiFunction::LinearExact, ""}).high, 0);
  // negative values are greys of their own
  const VoiWindow lung{-600, 1500, VoiFunction::Linear, ""};
  EXPECT_GT(applyVoi(lung, -1024), 0.2);
  EXPECT_LT(applyVoi(lung, -1024), applyVoi(lung, -500));
}

TEST(Stability, B10_ANarrowWindowOverATinySlopeKeepsItsGreys) {
  DicomSlice d;
  d.rows = d.columns = 64;
  for (int n = 0; n < 4096; ++n) d.pixels.push_back(n);
  d.slope = 2.4e-4;
  d.set = {{"0028,1050", "0.5"}, {"0028,1051", "0.91"}};
  HandMadeStudy s;
  makeStudy(s, {d, d});
  ASSERT_TRUE(s.scan());
  const VolumePtr v = volumeOf(s);
  ASSERT_TRUE(v);
  std::set<int> levels;
  for (int n = 0; n < 4096; ++n)
    levels.insert(int(std::floor(255 * applyVoi(defaultWindow(*v), v->modality(n % 64, n / 64, 0)) + 0.5)));
  EXPECT_GE(levels.size(), 200u);
}

TEST(Stability, B11_PaddingIsOutOfWindowRangeAndSamples) {
  const struct {
    const char* name;
    std::vector<std::int64_t> pixels;
    const char *first, *last;
    double min, max;
  } cases[] = {{"padding is the minimum", {-2000, -1008, 0, 500}, "-2000", nullptr, -1008, 500},
               {"range limit", {-2000, -1990, -1008, 0, 500}, "-2000", "-1500", -1008, 500},
               {"range limit below the value", {-2000, -1990, -1008, 0, 500}, "-1500", "-2000", -1008, 500},
               {"padding is the maximum", {-1008, 0, 500, 3000}, "3000", nullptr, -1008, 500},
               {"padding that does not occur", {-1008, 0, 500}, "-9999", nullptr, -1008, 500}};
  for (const char* syntax :
       {"1.2.840.10008.1.2.1", "1.2.840.10008.1.2"})  // the implicit one does not write the sign
    for (const auto& c : cases) {
      DicomSlice d = rowOf(c.pixels);
      d.transferSyntaxUid = syntax;
      d.set = {{"0028,0120", c.first}};
      if (c.last) d.set.push_back({"0028,0121", c.last});
      HandMadeStudy s;
      makeStudy(s, {d, d});
      ASSERT_TRUE(s.scan());
      const VolumePtr v = volumeOf(s);
      ASSERT_TRUE(v && v->modalityRange()) << c.name;
      EXPECT_EQ(v->modalityRange()->min, c.min) << c.name;
      EXPECT_EQ(v->modalityRange()->max, c.max) << c.name;
      const VoiWindow w = defaultWindow(*v);
      EXPECT_EQ(w.center - w.width / 2, c.min) << c.name;
      EXPECT_EQ(w.center + w.width / 2, c.max) << c.name;
      for (std::size_t i = 0; i < c.pixels.size(); ++i) {
        const bool data = double(c.pixels[i]) >= c.min && double(c.pixels[i]) <= c.max;
        EXPECT_EQ(sampleModality(*v, PatientPoint(double(i), 0, 0)).has_value(), data) << c.name << " " << i;
      }
      const auto f = buildImageFrame(s.set, s.series(), s.stack(), 0);
      ASSERT_TRUE(f.ok());
      EXPECT_EQ((*f)->info().autoWindow, w) << c.name;
    }
}

TEST(Stability, B11_AllPaddingSaysNoData) {
  HandMadeStudy s;
  DicomSlice d = rowOf({-2000, -2000});
  d.set = {{"0028,0120", "-2000"}};
  makeStudy(s, {d, d});
  ASSERT_TRUE(s.scan());
  const VolumePtr v = volumeOf(s);
  ASSERT_TRUE(v);
  EXPECT_FALSE(v->modalityRange());
  EXPECT_TRUE(findingOf(*v, "all-padding"));
  EXPECT_TRUE(usableWindow(defaultWindow(*v)));
  EXPECT_FALSE(sampleModality(*v, PatientPoint(0, 0, 0)));
  const Bricks b = makeBricks(*v);
  EXPECT_GT(b.min[0], b.max[0]);
  EXPECT_TRUE(buildImageFrame(s.set, s.series(), s.stack(), 0).ok());
}

TEST(Stability, B12_SmallestAndLargestPixelValueAreNotBelieved) {
  HandMadeStudy s;
  DicomSlice d = rowOf({-5, 0, 7});
  d.set = {{"0028,0106", "100"}, {"0028,0107", "101"}};
  makeStudy(s, {d, d});
  ASSERT_TRUE(s.scan());
  const VolumePtr v = volumeOf(s);
  ASSERT_TRUE(v);
  EXPECT_EQ(v->modalityRange()->min, -5);
  EXPECT_EQ(v->modalityRange()->max, 7);
  EXPECT_EQ(defaultWindow(*v).width, 12);
}

TEST(Stability, B13_NonFiniteVoxelsAreNoDataAndCounted) {
  std::vector<float> values(27, 10);
  values[0] = -5;
  values[26] = 20;
  values[13] = std::nanf("");  // the middle
  values[4] = INFINITY;
  values[22] = -INFINITY;
  const VolumePtr v = floatVolume(values, 3);
  ASSERT_TRUE(v);
  EXPECT_EQ(v->modalityRange()->min, -5);
  EXPECT_EQ(v->modalityRange()->max, 20);
  const Finding* f = findingOf(*v, "non-finite-voxels");
  ASSERT_TRUE(f);
  EXPECT_EQ(std::get<double>(f->numbers.at("nan")), 1);
  EXPECT_EQ(std::get<double>(f->numbers.at("plus_infinite")), 1);
  EXPECT_EQ(std::get<double>(f->numbers.at("minus_infinite")), 1);
  EXPECT_FALSE(sampleModality(*v, PatientPoint(1, 1, 1)));
  EXPECT_EQ(sampleModality(*v, PatientPoint(0.5, 0, 1)), 10);            // not touched by it
  EXPECT_NEAR(*sampleModality(*v, PatientPoint(0.6, 1, 1)), 10, 1e-12);  // next to it: the others' mean
  const VoiWindow w = defaultWindow(*v);
  EXPECT_TRUE(usableWindow(w));
  EXPECT_TRUE(std::isfinite(w.center));
  const Bricks b = makeBricks(*v);
  EXPECT_EQ(b.hasNoData[0], 1);
  EXPECT_EQ(b.min[0], -5);
  EXPECT_EQ(b.max[0], 20);
}

TEST(Stability, B13_NothingButNaN) {
  const VolumePtr v = floatVolume(std::vector<float>(8, std::nanf("")), 2);
  ASSERT_TRUE(v);
  EXPECT_FALSE(v->modalityRange());
  EXPECT_TRUE(usableWindow(defaultWindow(*v)));
}

}  // namespace
}  // namespace vernier
