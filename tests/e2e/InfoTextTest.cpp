// SPDX-License-Identifier: GPL-3.0-or-later
// What a person reads of a study: every file accounted for, nothing twice, nothing that a terminal obeys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "InfoJson.h"

namespace vernier {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

FileRecord fileOf(const char* name, FileKind kind) {
  FileRecord f;
  f.shown = name;
  f.kind = kind;
  if (kind == FileKind::Unreadable) f.error = makeError(ErrorCode::FileDamaged, "It was cut short.", name);
  return f;
}

StudySet twoPatientsOneStudy() {
  StudySet set;
  set.files = {fileOf("a.dcm", FileKind::NonImage), fileOf("DICOMDIR", FileKind::DicomDir),
               fileOf("cut.dcm", FileKind::Unreadable), fileOf("readme.txt", FileKind::NotDicom)};
  Instance i;
  i.sopClassName = "Basic Text SR Storage";
  i.notShown = "kept, not shown: structured report";
  set.instances = {i};
  set.series.resize(1);
  set.series[0].instances = {0};
  set.series[0].description = "one\x1b[2J\xC2\x9B series";
  set.studies.resize(1);
  set.studies[0].date = "20150206";
  set.studies[0].series = {0};
  set.patients.resize(2);
  set.patients[0].id = "A";
  set.patients[1].id = "B";
  set.patients[1].birthDate = "1960.1.2";
  for (Patient& p : set.patients) p.studies = {0};
  return set;
}

std::size_t timesIn(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(InfoText, EveryFileIsAccountedFor) {
  const std::string text = infoText(twoPatientsOneStudy());
  EXPECT_THAT(text, HasSubstr("4 files: 2 patients, 1 study, 1 series, 1 object; 1 DICOMDIR; "
                              "1 file without a readable object; 1 file not DICOM\n"));
  EXPECT_THAT(text, HasSubstr("Failed cut.dcm: It was cut short.\n"));
}

TEST(InfoText, AStudyOfTwoPatientsIsPrintedOnce) {
  const std::string text = infoText(twoPatientsOneStudy());
  EXPECT_EQ(timesIn(text, "Study 2015-02-06"), 2u);
  EXPECT_EQ(timesIn(text, "(the same study as above)"), 1u);
  EXPECT_EQ(timesIn(text, "Basic Text SR Storage"), 1u);
  EXPECT_THAT(text, HasSubstr("born 1960.1.2")) << "no date: as it is";
}

TEST(InfoText, ControlCharactersNeverReachTheTerminal) {
  const std::string text = infoText(twoPatientsOneStudy());
  EXPECT_THAT(text, HasSubstr("one?[2J? series"));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(InfoText, EqualFindingsOnceAndFilesNamedWhereSomethingIsWrong) {
  StudySet set = twoPatientsOneStudy();
  const std::vector<std::string> files{"1", "2", "3", "4"};
  set.findings = {{"repeated", Severity::Info, "Same.", {{"files", files}}},
                  {"repeated", Severity::Info, "Same.", {}},
                  {"conflict", Severity::Warning, "Differ.", {{"files", files}}}};
  const std::string text = infoText(set);
  EXPECT_THAT(text, HasSubstr("info    repeated: Same. (2 times)\n"));
  EXPECT_EQ(timesIn(text, "repeated"), 1u);
  EXPECT_THAT(text, HasSubstr("WARNING conflict: Differ. (1, 2, 3 and 1 more)\n"));
}

}  // namespace
}  // namespace vernier
