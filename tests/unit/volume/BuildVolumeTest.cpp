// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "HandMadeStudy.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {
using test::countingSlices;
using test::HandMadeStudy;
using ::testing::HasSubstr;

Result<std::shared_ptr<const Volume>> build(HandMadeStudy& s, const BuildOptions& o = {}) {
  return buildVolume(s.set, s.series(), s.stack(), o);
}

const Finding* findingOf(const Volume& v, const std::string& code) {
  for (const Finding& f : v.info().findings)
    if (f.code == code) return &f;
  return nullptr;
}

TEST(BuildVolume, KeepsStoredValuesAndMeaning) {
  HandMadeStudy s;
  auto slices = countingSlices(5);
  for (auto& d : slices) d.slope = 0.5, d.intercept = -1000;
  makeStudy(s, slices);
  for (std::size_t n = 0; n < 5; ++n) s.instance(n).windows = {{double(n), 80, VoiFunction::Linear, ""}};
  s.stack().findings.push_back({"tilt", Severity::Info, "tilted", {}});
  const auto v = build(s);
  ASSERT_TRUE(v.ok()) << v.error().text();
  const VolumeInfo& i = (*v)->info();
  EXPECT_EQ(i.type, VoxelType::I16);
  for (int k = 0; k < 5; ++k)
    for (int p = 0; p < 6; ++p) {
      EXPECT_EQ((*v)->stored(p % 3, p / 3, k), 100 * k + p);
      EXPECT_EQ((*v)->modality(p % 3, p / 3, k), 0.5 * (100 * k + p) - 1000);
    }
  EXPECT_FALSE((*v)->hasOriginal());
  ASSERT_EQ(i.rescale.size(), 1u);
  EXPECT_EQ(i.unit, "HU");
  EXPECT_EQ(i.modality, "CT");
  ASSERT_EQ(i.windows.size(), 1u);
  EXPECT_EQ(i.windows[0].center, 2);  // the middle slice's
  EXPECT_EQ(i.seriesUid, "2.25.1002");
  EXPECT_EQ(i.frameOfReferenceUid, "2.25.1003");
  EXPECT_EQ(i.patientKey, std::string("TEST-1") + '\x1f' + "HOSPITAL");
  EXPECT_EQ(i.title, "a series");
  EXPECT_TRUE(findingOf(**v, "tilt"));
  EXPECT_FALSE(i.inverted || i.unscaled || i.bridged || i.noData);
  EXPECT_EQ((*v)->modalityRange()->max, 0.5 * 405 - 1000);
}

TEST(BuildVolume, DifferentSlopesAreConvertedOnceAndProbesStayExact) {
  HandMadeStudy s;
  auto slices = countingSlices(3);
  makeStudy(s, slices);
  const double slopes[] = {1.0 / 3, 2.87e-6, 1e6};
  for (std::size_t n = 0; n < 3; ++n) {
    s.instance(n).rescale = {slopes[n], double(n)};
    s.instance(n).paddingFirst = s.instance(n).paddingLast = 4;
  }
  const auto v = build(s);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->type(), VoxelType::F32);
  ASSERT_TRUE((*v)->hasOriginal());
  EXPECT_FALSE((*v)->info().noData);
  for (int k = 0; k < 3; ++k)
    for (int p = 0; p < 6; ++p) {
      const double stored = 100 * k + p, truth = slopes[k] * stored + k;
      const VoxelValue x = (*v)->probe(p % 3, p / 3, k);
      EXPECT_EQ(x.stored, stored);
      EXPECT_EQ(x.modality, truth);
      EXPECT_EQ(x.noData, stored == 4);
      if (stored == 4) {
        EXPECT_TRUE(std::isnan((*v)->stored(p % 3, p / 3, k)));
      } else {
        EXPECT_EQ((*v)->stored(p % 3, p / 3, k), double(float(truth)));
        EXPECT_EQ(*sampleModality(**v, PatientPoint(p % 3, p / 3, 2.0 * k)), truth);
      }
    }
}

TEST(BuildVolume, ModalityLutGivesItsValuesAndKeepsTheStoredOnes) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  for (std::size_t n = 0; n < 2; ++n) s.instance(n).modalityLut = LutTable{1, 16, {5000, 6000, 7000}, ""};
  const auto v = build(s);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->probe(0, 0, 0).modality, 5000);
  EXPECT_EQ((*v)->probe(2, 0, 0).modality, 6000);
  EXPECT_EQ((*v)->probe(2, 0, 0).stored, 2);
  EXPECT_EQ((*v)->modality(0, 0, 1), 7000);
}

void damage(HandMadeStudy& s, std::size_t n) {
  std::filesystem::resize_file(s.file(n), s.set.files[n].bytes - 6);
}

TEST(BuildVolume, AFailedSliceIsAGapNotZeros) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(5));
  damage(s, 2);
  const auto v = build(s);
  ASSERT_TRUE(v.ok()) << v.error().text();
  const GridGeometry& g = (*v)->grid();
  EXPECT_EQ(g.slices, 4);
  ASSERT_EQ(g.sliceOrigin_vox.size(), 4u);
  EXPECT_EQ(g.sliceOrigin_vox[2], glm::dvec3(0, 0, 3));
  EXPECT_EQ(g.gapAfter, std::vector<std::int64_t>{1});
  EXPECT_EQ(*sampleModality(**v, PatientPoint(0, 0, 2)), 100);
  EXPECT_EQ(*sampleModality(**v, PatientPoint(0, 0, 6)), 300);
  EXPECT_FALSE(sampleModality(**v, PatientPoint(0, 0, 4)));
  EXPECT_EQ((*v)->stored(2, 1, 3), 405);
  const Finding* f = findingOf(**v, "slices-not-decoded");
  ASSERT_TRUE(f);
  EXPECT_EQ(std::get<double>(f->numbers.at("slices")), 1);
  EXPECT_EQ(std::get<std::vector<double>>(f->numbers.at("positions_mm")), std::vector<double>{4});
  BuildOptions bridge;
  bridge.bridgeGaps = true;
  const auto b = build(s, bridge);
  ASSERT_TRUE(b.ok());
  EXPECT_TRUE((*b)->info().bridged);
  EXPECT_EQ(*sampleModality(**b, PatientPoint(0, 0, 4)), 200);
}

TEST(BuildVolume, FailedSlicesAtTheEndsShortenTheStackInPlace) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(5));
  damage(s, 0);
  damage(s, 4);
  const auto v = build(s);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_TRUE((*v)->grid().even());
  EXPECT_EQ((*v)->grid().slices, 3);
  EXPECT_EQ((*v)->grid().corner(0), PatientPoint(0, 0, 2));
  EXPECT_EQ(*sampleModality(**v, PatientPoint(0, 0, 2)), 100);
  EXPECT_EQ(*sampleModality(**v, PatientPoint(0, 0, 6)), 300);
  EXPECT_FALSE(sampleModality(**v, PatientPoint(0, 0, 0.5)));
}

TEST(BuildVolume, AGapOfTheStackStaysBesideALostSlice) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(5));
  GridGeometry& g = s.stack().grid;
  for (int k = 0; k < 5; ++k) g.sliceOrigin_vox.push_back({0.01 * k, 0, k < 3 ? k : k + 4.0});
  g.gapAfter = {2};
  damage(s, 1);
  const auto v = build(s);
  ASSERT_TRUE(v.ok());
  EXPECT_EQ((*v)->grid().gapAfter, (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ((*v)->grid().sliceOrigin_vox[1], glm::dvec3(0.02, 0, 2));
}

TEST(BuildVolume, AllSlicesFailedIsAnError) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  damage(s, 0);
  damage(s, 1);
  const auto v = build(s);
  ASSERT_FALSE(v.ok());
  EXPECT_EQ(v.error().code, ErrorCode::PixelDataShort);
}

TEST(BuildVolume, RefusesWhatIsNot3D) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  s.stack().volume3d = false;
  s.stack().why2d = "Two slices lie at one place.";
  EXPECT_EQ(build(s).error().code, ErrorCode::GeometryRefused);
  EXPECT_EQ(build(s).error().sentence, "Two slices lie at one place.");
}

TEST(BuildVolume, AColourSliceAmongGreyOnesIsRefused) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  s.instance(1).pixels.samplesPerPixel = 3;
  EXPECT_EQ(build(s).error().code, ErrorCode::NotBuiltYet);
}

TEST(BuildVolume, TheBudgetIsAskedFirstAndHeld) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  MemoryBudget small(23), enough(72);
  BuildOptions o;
  o.budget = &small;
  EXPECT_EQ(build(s, o).error().code, ErrorCode::OutOfMemory);
  o.budget = &enough;
  {
    const auto v = build(s, o);
    ASSERT_TRUE(v.ok());
    EXPECT_EQ(enough.used(), 24u);
  }
  EXPECT_EQ(enough.used(), 0u);
  s.instance(1).rescale.slope = 2;  // stored values and floats
  const auto both = build(s, o);
  ASSERT_TRUE(both.ok());
  EXPECT_EQ(enough.used(), 72u);
}

TEST(BuildVolume, SignedAndUnsignedSlicesShareAContainerThatHoldsBoth) {
  HandMadeStudy s;
  auto slices = countingSlices(3);
  slices[0].pixels = {-32768, -1, 0, 1, 2, 32767};
  slices[1].isSigned = false;
  slices[1].pixels = {0, 1, 2, 3, 4, 65535};
  makeStudy(s, slices);
  const auto v = build(s);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->type(), VoxelType::I32);
  EXPECT_EQ((*v)->stored(0, 0, 0), -32768);
  EXPECT_EQ((*v)->stored(2, 1, 1), 65535);
}

TEST(BuildVolume, CancelEndsTheWork) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(3));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(buildVolume(s.set, s.series(), s.stack(), {}, {}, stop.get_token()).error().code,
            ErrorCode::Cancelled);
}

TEST(BuildVolume, PaddingIsReadWithThePixelsSign) {
  for (const double written : {63536.0, -2000.0}) {
    HandMadeStudy s;
    auto slices = countingSlices(2);
    slices[0].pixels[1] = -2000;
    makeStudy(s, slices);
    for (std::size_t n = 0; n < 2; ++n) s.instance(n).paddingFirst = s.instance(n).paddingLast = written;
    const auto v = build(s);
    ASSERT_TRUE(v.ok());
    EXPECT_TRUE((*v)->probe(1, 0, 0).noData) << written;
    EXPECT_EQ((*v)->modalityRange()->min, 0);
  }
}

TEST(BuildVolume, ZeroPaddingOfMrIsTissueButNotOfCt) {
  for (const bool mr : {true, false}) {
    HandMadeStudy s;
    auto slices = countingSlices(2);
    for (auto& d : slices) d.modality = mr ? "MR" : "CT";
    makeStudy(s, slices);
    for (std::size_t n = 0; n < 2; ++n) s.instance(n).paddingFirst = s.instance(n).paddingLast = 0;
    const auto v = build(s);
    ASSERT_TRUE(v.ok());
    EXPECT_EQ((*v)->info().paddingInTissueRange, mr);
    EXPECT_EQ((*v)->info().noData.has_value(), !mr);
    EXPECT_EQ((*v)->info().windowNoData.has_value(), mr);
    EXPECT_EQ((*v)->probe(0, 0, 0).noData, !mr);
    const VoiWindow w = automaticWindow(**v);
    EXPECT_EQ(w.center - w.width / 2, 1);  // 0 left out either way
  }
}

// A 7 x 5 slice: blurred padding around, one dark voxel in the middle that does not touch it.
TEST(BuildVolume, BlurredPaddingOfLossyCtIsFoundFromTheBorder) {
  for (const bool lossy : {true, false})
    for (const bool hasPadding : {true, false}) {
      HandMadeStudy s;
      test::DicomSlice d;
      d.columns = 7;
      d.rows = 5;
      d.intercept = -24;                                            // below -1024 HU: stored < -1000
      d.pixels = {-2000, -1990, -2000, -1500, -2000, -1001, -2000,  //
                  -1001, -1000, 0,     0,     0,     -999,  -2003,  //
                  -1999, 0,     0,     -1900, 0,     0,     -2000,  //
                  -2000, -1200, 0,     0,     0,     -1000, -1400,  //
                  -2000, -2000, -2001, -2000, -2000, -2000, -2000};
      makeStudy(s, {d, d});
      for (std::size_t n = 0; n < 2; ++n) {
        s.instance(n).lossy = lossy;
        if (hasPadding) s.instance(n).paddingFirst = s.instance(n).paddingLast = -2000;
      }
      const auto v = build(s);
      ASSERT_TRUE(v.ok());
      const bool found = lossy;
      EXPECT_EQ(findingOf(**v, "padding-blurred") != nullptr, found);
      for (int p = 0; p < 35; ++p) {
        const double stored = double(d.pixels[std::size_t(p)]);
        const bool padding = hasPadding && stored == -2000;
        const bool blurred = found && stored < -1000 && p != 17;
        EXPECT_EQ((*v)->probe(p % 7, p / 7, 1).noData, padding || blurred) << p << lossy << hasPadding;
      }
      EXPECT_EQ((*v)->modality(3, 2, 0), -1924);  // the dark voxel inside is data
    }
}

TEST(BuildVolume, OneInversionOnly) {
  const struct {
    const char *photometric, *shape;
    bool inverted;
  } cases[] = {{"MONOCHROME2", "", false},
               {"MONOCHROME2", "IDENTITY", false},
               {"MONOCHROME2", "INVERSE", true},
               {"MONOCHROME1", "", true},
               {"MONOCHROME1", "INVERSE", true}};
  for (const auto& c : cases) {
    HandMadeStudy s;
    makeStudy(s, countingSlices(2));
    for (std::size_t n = 0; n < 2; ++n)
      s.instance(n).photometric = c.photometric, s.instance(n).presentationLutShape = c.shape;
    EXPECT_EQ((*build(s))->info().inverted, c.inverted) << c.photometric << c.shape;
  }
}

TEST(BuildVolume, RefusedRescaleShowsStoredValues) {
  HandMadeStudy s;
  makeStudy(s, countingSlices(2));
  s.instance(0).rescale = {1, 0};
  s.instance(0).rescaleInvalid = true;
  s.instance(1).rescale = {7, 7};
  s.instance(1).windows = {{40, 80, VoiFunction::Linear, ""}};
  const auto v = build(s);
  ASSERT_TRUE(v.ok());
  EXPECT_TRUE((*v)->info().unscaled);
  EXPECT_EQ((*v)->info().unit, "stored value");
  EXPECT_EQ((*v)->modality(1, 0, 1), 101);
  EXPECT_TRUE((*v)->info().windows.empty());  // they speak of modality values
}

}  // namespace
}  // namespace vernier
