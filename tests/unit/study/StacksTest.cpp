// SPDX-License-Identifier: GPL-3.0-or-later
// What splits a series, on hand-made records.
#include "Stacks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "StackGeometry.h"

namespace vernier {
namespace {

Record slice(double z, int number = 0) {
  Record r;
  Instance& i = r.instance;
  i.isImage = true;
  i.sopClassUid = "1.2.840.10008.5.1.4.1.1.2";
  i.sopClassName = "CT Image Storage";
  i.instanceNumber = number;
  i.sopInstanceUid = "1.2." + std::to_string(number) + "." + std::to_string(z);
  i.pixels.rows = i.pixels.columns = 8;
  i.photometric = "MONOCHROME2";
  i.frameOfReferenceUid = "1.2.3";
  i.pixelSpacing_mm = {1, 1};
  i.plane = FramePlane{PatientPoint(0, 0, z), PatientVec(1, 0, 0), PatientVec(0, 1, 0)};
  i.imageType = {"ORIGINAL", "PRIMARY", "AXIAL"};
  return r;
}
std::vector<std::size_t> all(const std::vector<Record>& records) {
  std::vector<std::size_t> m(records.size());
  for (std::size_t k = 0; k < m.size(); ++k) m[k] = k;
  return m;
}
std::vector<Record> series(int n) {
  std::vector<Record> records;
  for (int k = 0; k < n; ++k) records.push_back(slice(k, k + 1));
  return records;
}

TEST(Stacks, OneStackInOrderWhateverTheInstanceNumbers) {
  std::vector<Record> records;
  for (const double z : {3.0, 1.0, 2.0, 0.0}) records.push_back(slice(z, static_cast<int>(10 - z)));
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 1u);
  EXPECT_TRUE(s.findings.empty());
  EXPECT_EQ(s.stacks[0].label, "");
  std::vector<std::size_t> order;
  for (const SliceRef& r : s.stacks[0].slices) order.push_back(r.instance);
  EXPECT_EQ(order, (std::vector<std::size_t>{3, 1, 2, 0}));
}

struct SplitCase {
  const char* name;
  std::function<void(Record&)> change;
};
class StacksSplit : public ::testing::TestWithParam<SplitCase> {};

TEST_P(StacksSplit, TwoOfSixSlicesDiffer) {
  std::vector<Record> records = series(6);
  for (const std::size_t k : {1u, 4u}) GetParam().change(records[k]);
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 2u);
  EXPECT_EQ(s.stacks[0].slices.size(), 4u);  // largest first
  EXPECT_EQ(s.stacks[1].slices.size(), 2u);
  EXPECT_FALSE(s.stacks[0].label.empty());
  EXPECT_NE(s.stacks[0].label.find(GetParam().name), std::string::npos) << s.stacks[0].label;
  ASSERT_EQ(s.findings.size(), 1u);
  EXPECT_EQ(s.findings[0].code, "split-into-stacks");
  EXPECT_EQ(std::get<std::vector<std::string>>(s.findings[0].numbers.at("by")),
            (std::vector<std::string>{GetParam().name}));
}

glm::dvec3 turned(double deg) {
  return {std::cos(deg * 0.017453292519943295), std::sin(deg * 0.017453292519943295), 0};
}

INSTANTIATE_TEST_SUITE_P(
    Attributes, StacksSplit,
    ::testing::Values(
        SplitCase{"patient", [](Record& r) { r.patientId = "other"; }},
        SplitCase{"SOP class", [](Record& r) { r.instance.sopClassName = "other"; }},
        SplitCase{"size", [](Record& r) { r.instance.pixels.rows = 9; }},
        SplitCase{"photometric", [](Record& r) { r.instance.photometric = "MONOCHROME1"; }},
        SplitCase{"frame of reference", [](Record& r) { r.instance.frameOfReferenceUid = "9"; }},
        SplitCase{"pixel spacing",
                  [](Record& r) {
                    r.instance.pixelSpacing_mm = {1.0002, 1};
                  }},
        SplitCase{"orientation",
                  [](Record& r) {
                    r.instance.plane->rowDirection = PatientVec(turned(0.11));
                    r.instance.plane->columnDirection = PatientVec(-turned(0.11).y, turned(0.11).x, 0);
                  }},
        SplitCase{"image type", [](Record& r) { r.instance.imageType[0] = "DERIVED"; }},
        SplitCase{"image type", [](Record& r) { r.instance.imageType.push_back("M"); }},
        SplitCase{"kernel", [](Record& r) { r.kernel = "B60"; }},
        SplitCase{"kVp", [](Record& r) { r.kvp = "80"; }},
        SplitCase{"echo time", [](Record& r) { r.instance.echoTime_ms = 90; }},
        SplitCase{"echo number", [](Record& r) { r.echoNumbers = "2"; }},
        SplitCase{"b-value", [](Record& r) { r.bValue_s_mm2 = 1000; }},
        SplitCase{"diffusion direction", [](Record& r) { r.diffusionDirection = glm::dvec3(0, 0, 1); }},
        SplitCase{"temporal position", [](Record& r) { r.instance.temporalPosition = 2; }},
        SplitCase{"stack id", [](Record& r) { r.stackId = "2"; }},
        SplitCase{"segment", [](Record& r) { r.segmentNumber = "2"; }},
        SplitCase{"rescale type", [](Record& r) { r.rescaleType = "HU"; }},
        SplitCase{"units", [](Record& r) { r.units = "BQML"; }}));

TEST(Stacks, WhatDoesNotSplit) {
  std::vector<Record> records = series(6);
  records[1].instance.imageType[1] = "SECONDARY";      // value 2
  records[2].instance.pixelSpacing_mm = {1.00005, 1};  // within 1e-4
  records[3].instance.plane->rowDirection = PatientVec(turned(0.05));
  records[3].instance.plane->columnDirection = PatientVec(-turned(0.05).y, turned(0.05).x, 0);
  records[4].acquisitionNumber = "2";  // positions don't coincide
  records[5].triggerTime = "300";
  for (Record& r : records) r.instance.echoTime_ms = 90;
  records[5].instance.echoTime_ms = 90.09;
  const SplitResult s = makeStacks(records, all(records));
  EXPECT_EQ(s.stacks.size(), 1u);
}

TEST(Stacks, PositionsThatCoincideAreToldApartByTheFirstAttributeThatDoes) {
  std::vector<Record> records;
  for (int phase = 0; phase < 2; ++phase)
    for (int k = 0; k < 4; ++k) {
      records.push_back(slice(k, phase * 4 + k));
      records.back().acquisitionNumber = k == 0 ? "1" : "2";  // differs, but does not separate
      records.back().triggerTime = phase == 0 ? "0" : "500";
      records.back().contentTime = std::to_string(records.size());
    }
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 2u);
  for (const Stack& stack : s.stacks) {
    EXPECT_EQ(stack.slices.size(), 4u);
    EXPECT_TRUE(stack.volume3d);
    EXPECT_NE(stack.label.find("trigger time"), std::string::npos);
  }
}

TEST(Stacks, PositionsThatNothingTellsApartRefuse3d) {
  std::vector<Record> records = series(4);
  records.push_back(slice(2, 9));
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 1u);
  EXPECT_EQ(s.stacks[0].slices.size(), 5u);  // never dropped, never averaged
  EXPECT_FALSE(s.stacks[0].volume3d);
  EXPECT_NE(s.stacks[0].why2d.find("one position"), std::string::npos);
}

TEST(Stacks, LocalizerIsItsOwnStackAndNever3d) {
  std::vector<Record> records = series(4);
  for (const std::size_t k : {0u, 1u}) records[k].instance.imageType[2] = "LOCALIZER";
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 2u);
  int localizers = 0;
  for (const Stack& stack : s.stacks)
    if (records[stack.slices[0].instance].instance.imageType[2] == "LOCALIZER") {
      ++localizers;
      EXPECT_FALSE(stack.volume3d);
      EXPECT_NE(stack.why2d.find("localizer"), std::string::npos);
    } else {
      EXPECT_TRUE(stack.volume3d);
    }
  EXPECT_EQ(localizers, 1);
}

TEST(Stacks, WithoutGeometryByInstanceNumber) {
  std::vector<Record> records = series(3);
  for (std::size_t k = 0; k < 3; ++k) {
    records[k].instance.plane.reset();
    records[k].instance.instanceNumber = static_cast<std::int64_t>(3 - k);
  }
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 1u);
  EXPECT_EQ(s.stacks[0].shape, StackShape::NoGeometry);
  EXPECT_EQ(s.stacks[0].slices[0].instance, 2u);
  EXPECT_FALSE(s.stacks[0].why2d.empty());
}

TEST(Stacks, FramesOfAMultiFrameObjectAreBrowsed) {
  std::vector<Record> records{slice(0, 1)};
  records[0].instance.pixels.framesDeclared = 5;
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 1u);
  EXPECT_EQ(s.stacks[0].slices.size(), 5u);
  EXPECT_EQ(s.stacks[0].slices[4].frame, 4u);
  EXPECT_FALSE(s.stacks[0].volume3d);
}

TEST(Stacks, CrookedOrientationIsFlaggedOrRefused) {
  std::vector<Record> records = series(3);
  for (Record& r : records)
    r.rawPlane = RawPlane{r.instance.plane->origin.p, {1, 0, 0}, {0.005, 1, 0}, 0.005};
  SplitResult s = makeStacks(records, all(records));
  EXPECT_TRUE(s.stacks[0].volume3d);
  EXPECT_TRUE(s.stacks[0].orientationFixed);
  EXPECT_EQ(s.stacks[0].findings.at(0).code, "orientation-fixed");
  for (Record& r : records) {
    r.rawPlane->offOrthonormal = 0.02;
    r.instance.plane.reset();
  }
  s = makeStacks(records, all(records));
  EXPECT_FALSE(s.stacks[0].volume3d);
  EXPECT_EQ(s.stacks[0].findings.at(0).code, "orientation-unusable");
}

TEST(Stacks, EqualLabelsAreNumberedAndLongOnesCut) {
  std::vector<Record> records = series(3);
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = 0.1 * static_cast<double>(k);
    records[k].instance.plane->rowDirection = PatientVec(std::cos(a), std::sin(a), 0);
    records[k].instance.plane->columnDirection = PatientVec(-std::sin(a), std::cos(a), 0);
  }
  SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 3u);
  EXPECT_EQ(s.stacks[0].label, "orientation axial, 1 of 3");
  EXPECT_EQ(s.stacks[2].label, "orientation axial, 3 of 3");

  records = series(2);
  records[0].kernel = std::string(39, 'x') + "\xC3\xA9" + std::string(1000, 'x');
  s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.size(), 2u);
  EXPECT_EQ(s.stacks[0].label, "kernel " + std::string(39, 'x') + "...") << "no half character";
}

TEST(Stacks, QuadrupedsAreSaid) {
  std::vector<Record> records = series(2);
  EXPECT_TRUE(makeStacks(records, all(records)).stacks.at(0).findings.empty());
  for (Record& r : records) r.quadruped = true;
  const SplitResult s = makeStacks(records, all(records));
  ASSERT_EQ(s.stacks.at(0).findings.size(), 1u);
  EXPECT_EQ(s.stacks[0].findings[0].code, "quadruped");
  EXPECT_EQ(s.stacks[0].findings[0].severity, Severity::Warning);
}

TEST(Stacks, ResultDoesNotDependOnTheOrderOfFiles) {
  std::vector<Record> records = series(7);
  records[2].kernel = records[5].kernel = "B60";
  std::vector<std::size_t> members = all(records);
  const SplitResult a = makeStacks(records, members);
  std::reverse(members.begin(), members.end());
  const SplitResult b = makeStacks(records, members);
  ASSERT_EQ(a.stacks.size(), b.stacks.size());
  for (std::size_t s = 0; s < a.stacks.size(); ++s) {
    ASSERT_EQ(a.stacks[s].slices.size(), b.stacks[s].slices.size());
    for (std::size_t k = 0; k < a.stacks[s].slices.size(); ++k)
      EXPECT_EQ(a.stacks[s].slices[k].instance, b.stacks[s].slices[k].instance);
  }
}

}  // namespace
}  // namespace vernier
