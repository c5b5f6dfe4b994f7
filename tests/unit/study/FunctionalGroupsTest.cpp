// SPDX-License-Identifier: GPL-3.0-or-later
// Multi-frame objects that describe their frames one by one: whose attribute counts, what splits, in which
// order, and what becomes of descriptions that are wrong.
#include <algorithm>
#include <cmath>

#include "ScanSupport.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {
using test::EnhancedObject;
using test::enhancedStack;
using test::number;
using test::Scan;
using test::scanOf;

TEST(FunctionalGroups, TheFramesOwnCountThenTheSharedNeverTheRoot) {
  EnhancedObject o = enhancedStack({4, 0, 2});
  o.hasGeometry = true;  // the root lies about everything
  o.position = {90, 90, 90};
  o.spacing = {7, 7};
  o.erase.clear();
  o.slope = 9, o.intercept = 9;
  o.set.push_back({"0028,1050", "1"});
  o.set.push_back({"0028,1051", "1"});
  o.shared->push_back({"0028,9145", {{"0028,1053", "2"}, {"0028,1052", "-100"}, {"0028,1054", "HU"}}});
  o.shared->push_back({"0028,9132", {{"0028,1050", "40"}, {"0028,1051", "400"}, {"0028,1055", "SOFT"}}});
  o.perFrame[1].push_back({"0028,9145", {{"0028,1053", "3"}, {"0028,1052", "5"}, {"0028,1054", "HU"}}});
  o.perFrame[2].push_back({"0028,9132", {{"0028,1050", "50"}, {"0028,1051", "350"}}});
  const Scan s = scanOf({o});
  const Instance& i = s.instance();
  ASSERT_TRUE(i.frames);
  ASSERT_EQ(i.frames->size(), 3u);
  EXPECT_EQ(i.frame(0).plane->origin, PatientPoint(0, 0, 4));
  EXPECT_EQ(i.frame(1).plane->origin, PatientPoint(0, 0, 0));
  EXPECT_EQ(i.frame(2).pixelSpacing_mm, glm::dvec2(1, 1));
  EXPECT_EQ(i.frame(0).rescale, (ModalityRescale{2, -100}));
  EXPECT_EQ(i.frame(1).rescale, (ModalityRescale{3, 5}));
  EXPECT_EQ(i.frame(0).unit, "HU");
  ASSERT_EQ(i.frame(1).windows.size(), 1u);
  EXPECT_EQ(i.frame(1).windows[0].width, 400);
  EXPECT_EQ(i.frame(1).windows[0].explanation, "SOFT");
  EXPECT_EQ(i.frame(2).windows[0].width, 350);
  EXPECT_EQ(i.plane->origin, i.frame(0).plane->origin) << "the object itself stands for its first frame";
  EXPECT_EQ(number(*s.finding("window-differs-per-frame"), "different"), 2);
}

TEST(FunctionalGroups, WithoutAnyTheRootIsStillNotAsked) {
  EnhancedObject o;
  o.sopClassUid = "1.2.840.10008.5.1.4.1.1.4.1";
  o.modality = "MR";
  o.frames = 2;
  o.slope = 9;
  o.set = {{"0028,1050", "1"}, {"0028,1051", "1"}};
  const Scan s = scanOf({o});
  EXPECT_FALSE(s.instance().plane);
  EXPECT_EQ(s.instance().rescale, ModalityRescale{});
  EXPECT_TRUE(s.instance().windows.empty());
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{0, 1}));
  EXPECT_FALSE(s.stack().volume3d);
  EXPECT_FALSE(s.stack().why2d.empty());
  EXPECT_TRUE(s.finding("functional-groups-missing"));
}

TEST(FunctionalGroups, ShuffledFramesAreOrderedByPositionAndDecodedRight) {
  const Scan s = scanOf({enhancedStack({6, 0, 4, 2})});
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{1, 3, 2, 0}));
  EXPECT_EQ(s.stack().shape, StackShape::Uniform);
  EXPECT_TRUE(s.stack().volume3d);
  EXPECT_DOUBLE_EQ(s.stack().step_mm, 2);
  std::vector<std::int16_t> voxels(4 * 16);
  std::vector<SliceFailure> failed;
  ASSERT_TRUE(
      decodeStack(s.set, s.stack(), SampleType::I16, std::as_writable_bytes(std::span(voxels)), failed));
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(voxels[k * 16 + 5], 100 * static_cast<int>(s.order()[k]) + 5);
}

struct SplitCase {
  const char* by;
  std::vector<std::vector<test::Macro>> groups;  // added to frames 0 and 1, and to 2 and 3
};
class FunctionalGroupsSplit : public ::testing::TestWithParam<SplitCase> {};

TEST_P(FunctionalGroupsSplit, ByWhatTheFramesSay) {
  const SplitCase& c = GetParam();
  EnhancedObject o = enhancedStack({0, 2, 0, 2});
  for (std::size_t f = 0; f < 4; ++f)
    for (const test::Macro& m : c.groups[f / 2]) o.perFrame[f].push_back(m);
  const Scan s = scanOf({o});
  ASSERT_EQ(s.series().stacks.size(), 2u);
  EXPECT_EQ(s.order(0), (std::vector<std::uint64_t>{0, 1}));
  EXPECT_EQ(s.order(1), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_TRUE(s.stack(0).volume3d && s.stack(1).volume3d);
  const auto* by = std::get_if<std::vector<std::string>>(&s.finding("split-into-stacks")->numbers.at("by"));
  EXPECT_EQ(*by, std::vector<std::string>{c.by});
  EXPECT_NE(s.stack(0).label, s.stack(1).label);
}

std::vector<std::vector<test::Macro>> two(const std::string& sequence, const std::string& tag,
                                          const std::string& a, const std::string& b) {
  return {{{sequence, {{tag, a}}}}, {{sequence, {{tag, b}}}}};
}
INSTANTIATE_TEST_SUITE_P(
    Attributes, FunctionalGroupsSplit,
    ::testing::Values(SplitCase{"echo time", two("0018,9114", "0018,9082", "20", "90")},
                      SplitCase{"b-value", two("0018,9117", "0018,9087", "0", "1000")},
                      SplitCase{"diffusion direction",
                                two("0018,9117/0018,9076", "0018,9089", "1\\0\\0", "0\\1\\0")},
                      SplitCase{"temporal position", two("0020,9111", "0020,9128", "1", "2")},
                      SplitCase{"stack id", two("0020,9111", "0020,9056", "1", "2")},
                      SplitCase{"component", two("0018,9226", "0008,9208", "MAGNITUDE", "PHASE")},
                      SplitCase{"kernel", two("0018,9314", "0018,1210", "B30", "B60")},
                      SplitCase{"kVp", two("0018,9325", "0018,0060", "80", "140")},
                      SplitCase{"image type", two("0018,9329", "0008,9007", "ORIGINAL\\PRIMARY\\VOLUME\\NONE",
                                                  "DERIVED\\PRIMARY\\VOLUME\\NONE")},
                      SplitCase{"rescale type", two("0028,9145", "0028,1054", "HU", "Z")},
                      SplitCase{"pixel spacing", two("0028,9110", "0028,0030", "1\\1", "2\\2")},
                      // Legacy Converted objects keep what has no macro as the classic object had it.
                      SplitCase{"echo time", two("0020,9171", "0018,0081", "20", "90")},
                      // Only because positions coincide.
                      SplitCase{"acquisition number", two("0020,9111", "0020,9156", "1", "2")},
                      SplitCase{"trigger time", two("0018,9118", "0020,9153", "0", "250")},
                      SplitCase{"derivation", two("0008,9124", "0008,2111", "sum", "difference")}),
    [](const auto& c) {
      std::string name = c.param.by + std::string("_") + std::to_string(c.index);
      std::replace_if(
          name.begin(), name.end(), [](char x) { return !std::isalnum(static_cast<unsigned char>(x)); }, '_');
      return name;
    });

// Nothing that we know tells the frames apart, but the object's own dimension does.
TEST(FunctionalGroups, ADimensionOfTheObjectTellsPositionsApart) {
  EnhancedObject o = enhancedStack({0, 2, 0, 2});
  for (std::size_t f = 0; f < 4; ++f)
    o.perFrame[f].push_back(
        {"0020,9111", {{"0020,9157", std::to_string(f / 2 + 1) + "\\" + std::to_string(f % 2 + 1)}}});
  Scan without = scanOf({o});
  EXPECT_EQ(without.series().stacks.size(), 1u);
  EXPECT_FALSE(without.stack().volume3d);
  EXPECT_TRUE(without.finding("coincident-positions"));

  o.sequences = {{"0020,9222", {{"0020,9165", "(0018,9257)"}, {"0020,9421", "label or control"}}}};
  const Scan s = scanOf({o});
  ASSERT_EQ(s.series().stacks.size(), 2u);
  EXPECT_EQ(s.stack(0).label, "label or control 1");
  EXPECT_TRUE(s.stack(1).volume3d);
}

TEST(FunctionalGroups, WithoutPositionsTheDimensionsGiveTheOrder) {
  EnhancedObject o = enhancedStack({0, 0, 0});
  const char* const index[] = {"2\\1", "1\\2", "1\\1"};
  for (std::size_t f = 0; f < 3; ++f) o.perFrame[f] = {{"0020,9111", {{"0020,9157", index[f]}}}};
  const Scan s = scanOf({o});
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{2, 1, 0}));
  EXPECT_EQ(s.stack().shape, StackShape::NoGeometry);
}

TEST(FunctionalGroups, TwoObjectsOfOneSeriesWithTheSamePlacesAreTwoStacks) {
  EnhancedObject a = enhancedStack({0, 2}), b = enhancedStack({0, 2});
  b.instanceNumber = 2;
  const Scan s = scanOf({a, b});
  ASSERT_EQ(s.series().stacks.size(), 2u);
  EXPECT_TRUE(s.stack(0).volume3d && s.stack(1).volume3d);
  EXPECT_EQ(s.stack(1).label, "object 2");
}

EnhancedObject part(const std::vector<double>& z, int number, int offset, int total = 2) {
  EnhancedObject o = enhancedStack(z);
  o.instanceNumber = 10 - number;  // instance numbers say nothing
  o.set.push_back({"0020,9161", "2.25.77"});
  o.set.push_back({"0020,9162", std::to_string(number)});
  o.set.push_back({"0020,9163", std::to_string(total)});
  o.set.push_back({"0020,9228", std::to_string(offset)});
  return o;
}

TEST(FunctionalGroups, AConcatenationIsOneStack) {
  const Scan s = scanOf({part({4, 6}, 2, 2), part({2, 0}, 1, 0)});
  ASSERT_EQ(s.series().stacks.size(), 1u);
  EXPECT_TRUE(s.stack().volume3d);
  EXPECT_EQ(s.order(), (std::vector<std::uint64_t>{1, 0, 0, 1}));
  EXPECT_EQ(s.stack().slices[0].instance, 1u);
  const Finding* f = s.finding("concatenation");
  ASSERT_TRUE(f);
  EXPECT_EQ(number(*f, "frames"), 4);
  EXPECT_EQ(number(*f, "parts"), 2);
}

TEST(FunctionalGroups, AConcatenationWithoutPlacesIsBrowsedInItsOrder) {
  EnhancedObject second = part({0, 0}, 2, 2), first = part({0, 0}, 1, 0);
  for (EnhancedObject* o : {&second, &first}) o->perFrame.assign(2, {{"0020,9111", {{"0020,9056", "1"}}}});
  const Scan s = scanOf({second, first});
  ASSERT_EQ(s.series().stacks.size(), 1u);
  EXPECT_EQ(s.stack().slices[0].instance, 1u);
  EXPECT_EQ(s.stack().slices[2].instance, 0u);
}

TEST(FunctionalGroups, PartsOfAConcatenationThatAreMissingOrOverlapAreSaid) {
  EXPECT_TRUE(scanOf({part({0, 2}, 1, 0, 3), part({8, 10}, 3, 4, 3)}).finding("concatenation-incomplete"));
  EXPECT_TRUE(scanOf({part({0, 2}, 1, 0, 2)}).finding("concatenation-incomplete"));
  EXPECT_TRUE(scanOf({part({0, 2}, 1, 0), part({4, 6}, 2, 1)}).finding("concatenation-overlap"));
}

TEST(FunctionalGroups, ALegacyConvertedSeriesAndItsSourceStayTwoAndAreLinked) {
  Scan s;
  EnhancedObject o = enhancedStack({0, 2});
  o.sopClassUid = "1.2.840.10008.5.1.4.1.1.2.2";
  o.seriesUid = "2.25.55";
  for (std::size_t f = 0; f < 2; ++f) {
    test::DicomSlice classic;
    classic.instanceNumber = static_cast<int>(f) + 1;
    classic.position = {0, 0, 2.0 * static_cast<double>(f)};
    s.add(classic);
    o.perFrame[f].push_back({"0020,9172", {{"0008,1155", "2.25.1002." + std::to_string(f + 1)}}});
  }
  s.add(o);
  s.run();
  ASSERT_EQ(s.set.series.size(), 2u);
  EXPECT_EQ(s.set.series[0].stacks.size(), 1u);
  for (const Series& series : s.set.series) {
    ASSERT_FALSE(series.findings.empty());
    const Finding& f = series.findings.back();
    EXPECT_EQ(f.code, "converted-copy");
    EXPECT_EQ(number(f, "images"), 2);
  }
}

// --- descriptions that are wrong ---

TEST(FunctionalGroups, TooFewOrTooManyDescriptionsAreNotBelieved) {
  for (const int described : {2, 4}) {
    EnhancedObject o = enhancedStack({0, 2, 4});
    o.shared->push_back({"0028,9145", {{"0028,1053", "2"}, {"0028,1052", "0"}, {"0028,1054", "HU"}}});
    o.perFrame.resize(static_cast<std::size_t>(described), o.perFrame[0]);
    const Scan s = scanOf({o});
    const Finding* f = s.finding("functional-groups-count");
    ASSERT_TRUE(f);
    EXPECT_EQ(f->severity, Severity::Refusal);
    EXPECT_EQ(number(*f, "groups"), described);
    EXPECT_FALSE(s.stack().volume3d);
    EXPECT_EQ(s.stack().slices.size(), 3u) << "all frames can be browsed";
    EXPECT_FALSE(s.instance().frames);
    EXPECT_EQ(s.instance().rescale.slope, 2) << "what is shared holds";
    // Values of single frames cannot be told apart: stored values, unscaled.
    o.perFrame[0].push_back({"0028,9145", {{"0028,1053", "3"}, {"0028,1052", "0"}}});
    EXPECT_TRUE(scanOf({o}).instance().rescaleInvalid);
  }
}

TEST(FunctionalGroups, NoDescriptionOfTheFrames) {
  EnhancedObject o = enhancedStack({0, 2, 4});
  o.perFrame.clear();
  const Scan s = scanOf({o});
  EXPECT_TRUE(s.finding("functional-groups-missing"));
  EXPECT_FALSE(s.stack().volume3d);
  EXPECT_EQ(s.stack().slices.size(), 3u);
}

TEST(FunctionalGroups, FramesWithoutAUsablePlaceAreKeptOutOf3d) {
  for (const char* bad : {"NaN\\0\\4", "0\\0", "0\\0\\x", ""}) {
    EnhancedObject o = enhancedStack({0, 2, 4, 6, 8, 10});
    o.perFrame[2] = {{"0020,9113", {{"0020,0032", bad}}}};
    const Scan s = scanOf({o});
    SCOPED_TRACE(bad);
    ASSERT_TRUE(s.finding("frames-without-place"));
    EXPECT_EQ(number(*s.finding("frames-without-place"), "frames"), 1);
    ASSERT_EQ(s.series().stacks.size(), 2u);
    EXPECT_EQ(s.order(0), (std::vector<std::uint64_t>{0, 1, 3, 4, 5}));
    EXPECT_TRUE(s.finding("gap")) << "a hole, not a bridge";
    EXPECT_EQ(s.stack(1).shape, StackShape::NoGeometry);
  }
}

TEST(FunctionalGroups, OrientationSpacingAndRescaleThatCannotBe) {
  EnhancedObject o = enhancedStack({0, 2});
  o.shared->at(0).set[0].second = "1\\0\\0\\0.5\\1\\0";
  EXPECT_TRUE(scanOf({o}).finding("orientation-unusable"));
  o.shared->at(0).set[0].second = "1\\0\\0\\NaN\\1\\0";
  EXPECT_FALSE(scanOf({o}).stack().volume3d);
  o = enhancedStack({0, 2});
  o.shared->at(1).set[0].second = "0\\1";
  const Scan noSpacing = scanOf({o});
  EXPECT_TRUE(noSpacing.finding("pixel-spacing-unusable"));
  EXPECT_EQ(noSpacing.instance().frame(0).pixelSpacing_mm, glm::dvec2(0, 0));
  o = enhancedStack({0, 2});
  o.perFrame[1].push_back({"0028,9145", {{"0028,1053", "0"}, {"0028,1052", "0"}}});
  const Scan noSlope = scanOf({o});
  EXPECT_FALSE(noSlope.instance().frame(0).rescaleInvalid);
  EXPECT_TRUE(noSlope.instance().frame(1).rescaleInvalid);
  EXPECT_EQ(noSlope.instance().frame(1).unit, "stored value");
}

TEST(FunctionalGroups, MoreFramesThanThePixelDataHoldsAreRefused) {
  EnhancedObject o = enhancedStack({0, 2, 4});
  o.set[0].second = "5";  // Number of Frames; the pixel data has 3
  o.perFrame.resize(5, o.perFrame[0]);
  const Scan s = scanOf({o});
  ASSERT_TRUE(s.instance().pixelError);
  EXPECT_EQ(s.instance().pixelError->code, ErrorCode::PixelDataShort);
  EXPECT_TRUE(s.series().stacks.empty());
}

TEST(FunctionalGroups, MoreStacksThanTheLimitStayTogether) {
  std::vector<double> z(limits::kMaxStacksPerSeries + 60);
  for (std::size_t f = 0; f < z.size(); ++f) z[f] = static_cast<double>(f);
  EnhancedObject o = enhancedStack(z);
  for (std::size_t f = 0; f < z.size(); ++f)
    o.perFrame[f].push_back({"0018,9114", {{"0018,9082", std::to_string(f)}}});
  const Scan s = scanOf({o});
  EXPECT_EQ(s.series().stacks.size(), limits::kMaxStacksPerSeries + 1);
  ASSERT_TRUE(s.finding("too-many-stacks"));
  EXPECT_EQ(s.stack(0).slices.size(), 60u);
  EXPECT_FALSE(s.stack(0).volume3d);
  z.resize(limits::kMaxStacksPerSeries);
  o.perFrame.resize(z.size());
  o.frames = static_cast<int>(z.size());
  o.set[0].second = std::to_string(z.size());
  EXPECT_FALSE(scanOf({o}).finding("too-many-stacks"));
}

TEST(FunctionalGroups, AnUltrasoundVolumeStandsInItsOwnFrame) {
  EnhancedObject o = enhancedStack({0, 1});
  o.sopClassUid = "1.2.840.10008.5.1.4.1.1.6.2";
  o.modality = "US";
  o.set.push_back({"0020,9312", "2.25.88"});
  o.shared->at(0) = {"0020,930F", {{"0020,9302", "1\\0\\0\\0\\1\\0"}}};
  o.perFrame = {{{"0020,930E", {{"0020,9301", "0\\0\\0"}}}}, {{"0020,930E", {{"0020,9301", "0\\0\\3"}}}}};
  const Scan s = scanOf({o});
  EXPECT_EQ(s.instance().frameOfReferenceUid, "2.25.88");
  EXPECT_TRUE(s.stack().volume3d);
  EXPECT_DOUBLE_EQ(s.stack().step_mm, 3);
  EXPECT_TRUE(s.finding("not-patient-frame"));
}

}  // namespace
}  // namespace vernier
