// SPDX-License-Identifier: GPL-3.0-or-later
// Patients, studies and series of hand-made records, and what namesakes are to each other.
#include "Group.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "SeriesFindings.h"

namespace vernier {
namespace {
using ::testing::ElementsAre;

Record object(const std::string& patient, const std::string& study, const std::string& series,
              const std::string& uid = "") {
  Record r;
  r.patientId = patient;
  r.studyUid = study;
  r.seriesUid = series;
  r.instance.sopInstanceUid = uid;
  return r;
}
std::string nameOf(std::size_t n) { return "file" + std::to_string(n); }

TEST(Group, PatientsStudiesSeries) {
  std::vector<Record> r{object("A", "1", "10"), object("A", "1", "11"), object("A", "2", "20"),
                        object("B", "3", "30"), object("A", "1", "10")};
  const Grouping g = groupRecords(r);
  ASSERT_EQ(g.patients.size(), 2u);
  EXPECT_EQ(g.studies.size(), 3u);
  ASSERT_EQ(g.series.size(), 4u);
  EXPECT_THAT(g.patients[0].studies, ElementsAre(0u, 1u));
  EXPECT_THAT(g.studies[0].series, ElementsAre(0u, 1u));
  EXPECT_THAT(g.series[0].instances, ElementsAre(0u, 4u));
  EXPECT_EQ(r[4].instance.series, 0u);
  EXPECT_TRUE(g.findings.empty());
}

TEST(Group, WithoutUidsObjectsStandAlone) {
  std::vector<Record> r{object("A", "", ""), object("A", "", ""), object("A", "1", ""), object("A", "1", "")};
  const Grouping g = groupRecords(r);
  EXPECT_EQ(g.patients.size(), 1u);
  EXPECT_EQ(g.studies.size(), 3u);
  EXPECT_EQ(g.series.size(), 4u);
}

TEST(Group, WithoutPatientIdEachStudyIsAPatient) {
  std::vector<Record> r{object("", "1", "10"), object("", "1", "11"), object("", "2", "20")};
  EXPECT_EQ(groupRecords(r).patients.size(), 2u);
}

TEST(Group, SameIdOfAnotherIssuerIsAnotherPatient) {
  std::vector<Record> r{object("A", "1", "10"), object("A", "2", "20")};
  r[1].issuer = "elsewhere";
  EXPECT_EQ(groupRecords(r).patients.size(), 2u);
}

Record person(const std::string& study, const std::string& series, const std::string& birthDate,
              const std::string& sex) {
  Record r = object("A", study, series);
  r.birthDate = birthDate, r.sex = sex;
  return r;
}

TEST(Group, OneIdWithTwoBirthDatesOrSexesIsOfTwoPatients) {
  for (const auto& [date, sex] : {std::pair("19700103", "F"), std::pair("19700102", "M")}) {
    // In one study, and in one series at that.
    std::vector<Record> r{person("1", "10", "19700102", "F"), person("1", "11", date, sex),
                          person("1", "10", "19700102", "F"), person("1", "10", date, sex)};
    const Grouping g = groupRecords(r);
    ASSERT_EQ(g.patients.size(), 2u);
    EXPECT_EQ(g.patients[1].birthDate, date);
    EXPECT_EQ(g.patients[1].sex, sex);
    const std::size_t of[] = {0, 1, 0, 1};
    for (std::size_t n = 0; n < 4; ++n) EXPECT_EQ(r[n].instance.patient, of[n]) << n;
    ASSERT_EQ(g.findings.size(), 2u);
    EXPECT_EQ(g.findings[0].code, "study-of-several-patients");
    EXPECT_EQ(g.findings[1].code, "patient-id-of-several-people");
    EXPECT_EQ(g.findings[1].severity, Severity::Warning);
    for (const Finding& f : g.findings) EXPECT_EQ(f.sentence.find("1970"), std::string::npos) << f.sentence;
  }
}

TEST(Group, WhatIsAbsentIsNoOtherPerson) {
  std::vector<Record> r{person("1", "10", "", ""), person("1", "11", "19700102", ""),
                        person("2", "20", "", "F")};
  const Grouping g = groupRecords(r);
  ASSERT_EQ(g.patients.size(), 1u);
  EXPECT_EQ(g.patients[0].birthDate, "19700102");
  EXPECT_EQ(g.patients[0].sex, "F");
  EXPECT_TRUE(g.findings.empty());
  // Beside a contradiction nobody can say whose it is.
  r.push_back(person("3", "30", "19700103", "F"));
  EXPECT_EQ(groupRecords(r).patients.size(), 4u);
}

TEST(Group, SeriesUidInSeveralStudiesIsNeverMerged) {
  std::vector<Record> r{object("A", "1", "10"), object("A", "2", "10"), object("A", "3", "10")};
  const Grouping g = groupRecords(r);
  EXPECT_EQ(g.series.size(), 3u);
  ASSERT_EQ(g.findings.size(), 1u);
  EXPECT_EQ(g.findings[0].code, "series-uid-in-several-studies");
  EXPECT_EQ(std::get<double>(g.findings[0].numbers.at("studies")), 3);
}

TEST(Group, StudyOfSeveralPatientsIsAWarning) {
  std::vector<Record> r{object("A", "1", "10"), object("B", "1", "10")};
  const Grouping g = groupRecords(r);
  EXPECT_EQ(g.patients.size(), 2u);
  ASSERT_EQ(g.findings.size(), 1u);
  EXPECT_EQ(g.findings[0].code, "study-of-several-patients");
  EXPECT_EQ(g.findings[0].severity, Severity::Warning);
}

TEST(Identity, EqualValuesKeepOne) {
  std::vector<Record> r{object("A", "1", "10", "9"), object("A", "1", "10", "8"),
                        object("A", "1", "10", "9")};
  const auto f = settleIdentity(
      r, [](auto, auto) { return std::optional(true); }, nameOf);
  EXPECT_EQ(r[0].instance.identity, Identity::Kept);
  EXPECT_EQ(r[1].instance.identity, Identity::Unique);
  EXPECT_EQ(r[2].instance.identity, Identity::Repeated);
  ASSERT_EQ(f.size(), 1u);
  EXPECT_EQ(f[0].severity, Severity::Info);
  EXPECT_THAT(std::get<std::vector<std::string>>(f[0].numbers.at("files")), ElementsAre("file0", "file2"));
}

TEST(Identity, DifferentOrUnknownValuesAreAConflictForAll) {
  for (const std::optional<bool> same : {std::optional<bool>(false), std::optional<bool>()}) {
    std::vector<Record> r{object("A", "1", "10", "9"), object("A", "1", "10", "9")};
    const auto f = settleIdentity(
        r, [&](auto, auto) { return same; }, nameOf);
    EXPECT_EQ(r[0].instance.identity, Identity::Conflict);
    EXPECT_EQ(r[1].instance.identity, Identity::Conflict);
    ASSERT_EQ(f.size(), 1u);
    EXPECT_EQ(f[0].severity, Severity::Warning);
    EXPECT_EQ(std::get<std::string>(f[0].numbers.at("stored_values_identical")),
              same ? "no" : "not computed");
  }
}

TEST(Identity, EqualValuesAtAnotherPlaceAreAConflict) {
  std::vector<Record> r{object("A", "1", "10", "9"), object("A", "1", "10", "9")};
  r[0].rawPlane = RawPlane{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0};
  r[1].rawPlane = RawPlane{{0, 0, 5}, {1, 0, 0}, {0, 1, 0}, 0};
  const auto f = settleIdentity(
      r, [](auto, auto) { return std::optional(true); }, nameOf);
  EXPECT_EQ(r[0].instance.identity, Identity::Conflict);
  EXPECT_NE(f.at(0).sentence.find("positions differ"), std::string::npos);
}

TEST(Identity, EmptyUidsAreNoNamesakes) {
  std::vector<Record> r{object("A", "1", "10"), object("A", "1", "10")};
  EXPECT_TRUE(settleIdentity(
                  r, [](auto, auto) { return std::optional(false); }, nameOf)
                  .empty());
  EXPECT_EQ(r[0].instance.identity, Identity::Unique);
}

TEST(SeriesFindings, WindowsRescaleAndBadWidths) {
  std::vector<Record> r(3);
  for (Record& x : r) {
    x.instance.isImage = true;
    x.windowCenters = {40};
    x.windowWidths = {400};
  }
  const std::vector<std::size_t> members{0, 1, 2};
  EXPECT_TRUE(seriesFindings(r, members, nameOf).empty());
  r[1].windowWidths = {0};
  r[1].badWindowCenters = {40};
  r[1].badWindowWidths = {0};
  r[2].instance.rescale.slope = 2;
  std::vector<std::string> codes;
  for (const Finding& f : seriesFindings(r, members, nameOf)) codes.push_back(f.code);
  EXPECT_THAT(codes, ElementsAre("window-differs-within-series", "rescale-differs-within-series",
                                 "window-width-not-positive"));
}

}  // namespace
}  // namespace vernier
