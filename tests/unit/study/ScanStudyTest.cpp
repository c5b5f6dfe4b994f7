// SPDX-License-Identifier: GPL-3.0-or-later
// The scan on real files: what is looked at, what is not opened, and what is settled of values and units.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "MakeDicom.h"
#include "SopClasses.h"
#include "TestData.h"
#include "vernier/study/Load.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;
using test::DicomSlice;
using test::TempDir;
using test::writeDicom;
using test::writeSeries;

StudySet scan(const fs::path& p) {
  auto set = scanStudy({p.string()});
  EXPECT_TRUE(set) << set.error().text();
  return set ? std::move(*set) : StudySet();
}
const FileRecord& fileNamed(const StudySet& set, const std::string& name) {
  for (const FileRecord& f : set.files)
    if (f.shown == name) return f;
  static const FileRecord none;
  ADD_FAILURE() << name << " is not listed";
  return none;
}
Instance only(const DicomSlice& s) {
  const TempDir dir;
  writeDicom(dir.path() / "a.dcm", s);
  const StudySet set = scan(dir.path());
  EXPECT_EQ(set.instances.size(), 1u);
  return set.instances.empty() ? Instance() : set.instances[0];
}
void put(const fs::path& p, const std::string& bytes) { std::ofstream(p, std::ios::binary) << bytes; }

TEST(ScanStudy, OneBadFileDoesNotStopTheRest) {
  const TempDir dir;
  writeSeries(dir.path(), 5, {0, 0, 2});
  put(dir.path() / "empty", "");
  put(dir.path() / "text.txt", "just text, long enough to be looked at " + std::string(200, 'x'));
  put(dir.path() / "program",
      "\x7f"
      "ELF" +
          std::string(400, '\1'));
  fs::copy_file(dir.path() / "002.dcm", dir.path() / "cut.dcm");
  fs::resize_file(dir.path() / "cut.dcm", 300);
  const StudySet set = scan(dir.path());
  EXPECT_EQ(set.files.size(), 9u);
  ASSERT_EQ(set.series.size(), 1u);
  ASSERT_EQ(set.series[0].stacks.size(), 1u);
  EXPECT_EQ(set.series[0].stacks[0].slices.size(), 5u);
  EXPECT_TRUE(set.series[0].stacks[0].volume3d);
  for (const char* bad : {"empty", "text.txt", "program", "cut.dcm"}) {
    const FileRecord& f = fileNamed(set, bad);
    ASSERT_TRUE(f.error) << bad;
    EXPECT_EQ(f.error->where, bad);
    EXPECT_EQ(f.error->sentence.back(), '.');
  }
}

TEST(ScanStudy, DevicesAndPipesAreListedAndNeverOpened) {
  const TempDir dir;
  writeSeries(dir.path(), 2, {0, 0, 1});
  ASSERT_EQ(::mkfifo((dir.path() / "pipe").c_str(), 0600), 0);  // opening it would wait for ever
  const StudySet set = scan(dir.path());
  EXPECT_EQ(fileNamed(set, "pipe").error->code, ErrorCode::NotAFile);
  EXPECT_EQ(set.instances.size(), 2u);
  for (const std::string& p : {std::string("/dev/zero"), (dir.path() / "pipe").string()}) {
    const auto direct = scanStudy({p});
    ASSERT_FALSE(direct);
    EXPECT_EQ(direct.error().code, ErrorCode::NotAFile);
  }
  const auto missing = scanStudy({(dir.path() / "nothing").string()});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::FileNotFound);
  EXPECT_EQ(missing.error().where, "nothing");
}

TEST(ScanStudy, LinksStayInTheFolderAndLoopsEnd) {
  const TempDir outside, dir;
  writeDicom(outside.path() / "o.dcm", {});
  fs::create_directories(dir.path() / "in" / "deep");
  writeDicom(dir.path() / "in" / "a.dcm", {});
  fs::create_symlink(outside.path(), dir.path() / "outwards");
  fs::create_symlink(outside.path() / "o.dcm", dir.path() / "outwards.dcm");
  fs::create_symlink(dir.path() / "in", dir.path() / "in" / "deep" / "loop");
  fs::create_symlink(dir.path() / "in" / "a.dcm", dir.path() / "again.dcm");
  fs::create_symlink(dir.path() / "gone", dir.path() / "dangling");
  const StudySet set = scan(dir.path());
  EXPECT_EQ(set.instances.size(), 1u);  // the same file by two names counts once
  for (const char* name : {"outwards", "outwards.dcm", "dangling"})
    EXPECT_TRUE(fileNamed(set, name).error) << name;
}

TEST(ScanStudy, OrderOfFilesDoesNotMatter) {
  const TempDir a, b;
  writeSeries(a.path(), 6, {0, 0, 1.5});
  const char* names[] = {"z", "b", "y", "a", "k", "c"};
  for (int k = 0; k < 6; ++k)
    fs::copy_file(a.path() / ("00" + std::to_string(k) + ".dcm"), b.path() / names[k]);
  const StudySet x = scan(a.path()), y = scan(b.path());
  const Stack &s = x.series.at(0).stacks.at(0), &t = y.series.at(0).stacks.at(0);
  ASSERT_EQ(s.slices.size(), t.slices.size());
  EXPECT_EQ(s.positions_mm, t.positions_mm);
  EXPECT_EQ(s.grid.patientFromVoxel, t.grid.patientFromVoxel);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_EQ(x.instances[s.slices[k].instance].sopInstanceUid,
              y.instances[t.slices[k].instance].sopInstanceUid);
}

TEST(ScanStudy, RepeatedObjectIsUsedOnceAndAConflictKeptOutOfVolumes) {
  const TempDir dir;
  writeSeries(dir.path(), 6, {0, 0, 1});
  DicomSlice same;  // slice 2 in another transfer syntax
  same.instanceNumber = 3;
  same.position = {0, 0, 2};
  same.pixels.assign(16, 20);
  same.transferSyntaxUid = "1.2.840.10008.1.2.5";
  writeDicom(dir.path() / "same.dcm", same);
  StudySet set = scan(dir.path());
  ASSERT_EQ(set.series.at(0).stacks.size(), 1u);
  EXPECT_EQ(set.series[0].stacks[0].slices.size(), 6u);
  EXPECT_TRUE(set.series[0].stacks[0].volume3d);

  same.pixels[5] = 21;
  writeDicom(dir.path() / "same.dcm", same);
  set = scan(dir.path());
  const auto& stacks = set.series.at(0).stacks;
  ASSERT_EQ(stacks.size(), 3u);
  EXPECT_EQ(stacks[0].slices.size(), 5u);  // without both copies; a gap is where they were
  EXPECT_EQ(stacks[0].grid.gapAfter, (std::vector<std::int64_t>{1}));
  for (const std::size_t k : {1u, 2u}) {
    EXPECT_EQ(stacks[k].slices.size(), 1u);
    EXPECT_FALSE(stacks[k].volume3d);
  }
  EXPECT_EQ(set.findings.at(0).code, "repeated-sop-instance-uid");
  EXPECT_EQ(set.findings[0].severity, Severity::Warning);
}

TEST(ScanStudy, CancelledAndProgress) {
  const TempDir dir;
  writeSeries(dir.path(), 20, {0, 0, 1});
  std::uint64_t last = 0, total = 0;
  ASSERT_TRUE(scanStudy({dir.path().string()}, [&](std::string_view, std::uint64_t d, std::uint64_t t) {
    EXPECT_GT(d, last);
    last = d;
    total = t;
  }));
  EXPECT_EQ(last, 20u);
  EXPECT_EQ(total, 20u);
  std::stop_source stop;
  stop.request_stop();
  const auto cancelled = scanStudy({dir.path().string()}, {}, stop.get_token());
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().code, ErrorCode::Cancelled);
}

TEST(ScanStudy, UnitIsHuForCtOnly) {
  DicomSlice s;
  EXPECT_EQ(only(s).unit, "HU");
  s.set = {{"0028,1054", "HU"}};
  EXPECT_EQ(only(s).unit, "HU");
  s.set = {{"0028,1054", "US"}};
  EXPECT_EQ(only(s).unit, "stored value");
  s.set = {{"0008,0008", "ORIGINAL\\PRIMARY\\LOCALIZER"}};
  EXPECT_EQ(only(s).unit, "stored value");
  s.set = {{"0028,1054", "HU"}};
  s.modality = "MR";
  s.sopClassUid = "1.2.840.10008.5.1.4.1.1.4";
  EXPECT_EQ(only(s).unit, "stored value");
  s.set = {{"0054,1001", "BQML"}};
  s.modality = "PT";
  EXPECT_EQ(only(s).unit, "BQML");
}

TEST(ScanStudy, WindowsPaddingAndRescale) {
  DicomSlice s;
  s.set = {{"0028,1050", "40\\50\\60"},
           {"0028,1051", "400\\0\\-3"},
           {"0028,1055", "SOFT\\BAD\\WORSE"},
           {"0028,1056", "SIGMOID"}};
  Instance i = only(s);
  ASSERT_EQ(i.windows.size(), 1u);
  EXPECT_EQ(i.windows[0].center, 40);
  EXPECT_EQ(i.windows[0].width, 400);
  EXPECT_EQ(i.windows[0].explanation, "SOFT");
  EXPECT_EQ(i.windows[0].function, VoiFunction::Sigmoid);

  s.set = {{"0028,0120", "-2000"}, {"0028,0121", "-1990"}};
  i = only(s);
  EXPECT_EQ(i.paddingFirst, -2000);
  EXPECT_EQ(i.paddingLast, -1990);

  s.set = {};
  s.slope = 2.5;
  s.intercept = -1024;
  EXPECT_EQ(only(s).rescale, (ModalityRescale{2.5, -1024}));
  s.slope = 0;
  EXPECT_TRUE(only(s).rescaleInvalid);
  EXPECT_EQ(only(s).rescale, ModalityRescale{});
  EXPECT_EQ(only(s).unit, "stored value");
}

TEST(ScanStudy, WhatIsNotDrawnSaysWhy) {
  DicomSlice s;
  s.samplesPerPixel = 3;
  s.bitsAllocated = s.bitsStored = 8;
  s.isSigned = false;
  s.photometric = "RGB";
  EXPECT_EQ(only(s).notShown, "");
  s.photometric = "HSV";
  EXPECT_EQ(only(s).pixelError->code, ErrorCode::PixelDescriptionInvalid);
  DicomSlice enhanced;
  enhanced.sopClassUid = "1.2.840.10008.5.1.4.1.1.4.1";
  EXPECT_EQ(only(enhanced).notShown, "");
  DicomSlice report;
  report.sopClassUid = "1.2.840.10008.5.1.4.1.1.88.11";
  report.erase = {"7FE0,0010"};
  EXPECT_EQ(only(report).notShown, "kept, not shown: structured report");
  EXPECT_EQ(only(report).sopClassName, "Basic Text SR Storage");
  DicomSlice incomplete;
  incomplete.erase = {"7FE0,0010"};
  EXPECT_EQ(only(incomplete).notShown, "incomplete: an image object without pixel data");
}

TEST(ScanStudy, ObjectsOfTwoPatientsAreNeverOneStack) {
  const TempDir dir;
  writeSeries(dir.path() / "a", 3, {0, 0, 1});
  DicomSlice other;
  other.patientId = "TEST-2";
  other.position = {0, 0, 3};
  other.instanceNumber = 4;
  writeDicom(dir.path() / "b.dcm", other);
  const StudySet set = scan(dir.path());
  ASSERT_EQ(set.series.size(), 1u);
  EXPECT_EQ(set.series[0].stacks.size(), 2u);
  EXPECT_EQ(set.findings.at(0).code, "study-of-several-patients");
  for (const Stack& s : set.series[0].stacks) EXPECT_EQ(s.label.find("TEST"), std::string::npos);
}

TEST(ScanStudy, ObjectsOfOneIdAndTwoBirthDatesAreNeverOneStack) {
  const TempDir dir;
  writeSeries(dir.path() / "a", 3, {0, 0, 1});
  DicomSlice other;
  other.set = {{"0010,0030", "19700103"}};
  other.position = {0, 0, 3};
  other.instanceNumber = 4;
  writeDicom(dir.path() / "b.dcm", other);
  other.set = {{"0010,0030", "19700102"}};
  other.position = {0, 0, 4};
  other.instanceNumber = 5;
  writeDicom(dir.path() / "c.dcm", other);
  const StudySet set = scan(dir.path());
  ASSERT_EQ(set.series.size(), 1u);
  ASSERT_EQ(set.series[0].stacks.size(), 3u) << "the date of the first three is not known";
  std::set<const Patient*> whose;
  for (const Stack& s : set.series[0].stacks) {
    ASSERT_NE(patientOf(set, s), nullptr);
    whose.insert(patientOf(set, s));
    EXPECT_EQ(s.label.find("1970"), std::string::npos) << s.label;
  }
  EXPECT_EQ(whose.size(), 3u);
}

TEST(ScanStudy, DicomDirOpenedByItselfIsAnIndex) {
  VERNIER_NEEDS_DATA("dicomdir_tree");
  const fs::path dir = test::dataDir() / "dicomdir_tree";
  // Files by name, all there, beside other DICOMDIRs and objects that it does not name.
  for (const auto& [name, n] : {std::pair("DICOMDIR", 31u), std::pair("DICOMDIR-bigEnd", 31u),
                                std::pair("DICOMDIR-implicit", 31u), std::pair("DICOMDIR-reordered", 31u),
                                std::pair("DICOMDIR-nooffset", 31u), std::pair("TINY_ALPHA/DICOMDIR", 50u)}) {
    SCOPED_TRACE(name);
    const StudySet set = scan(dir / name);
    EXPECT_EQ(set.instances.size(), n);
    ASSERT_FALSE(set.findings.empty());
    EXPECT_EQ(set.findings[0].code, "dicomdir");
    EXPECT_EQ(std::get<double>(set.findings[0].numbers.at("referenced_files")), n);
    EXPECT_EQ(std::get<double>(set.findings[0].numbers.at("referenced_files_present")), n);
    EXPECT_EQ(set.files.size(), n + 1);
  }
  // Its PATIENT records are of an unknown type; the files are named all the same.
  EXPECT_EQ(scan(dir / "DICOMDIR-nopatient").instances.size(), 31u);
  const StudySet none = scan(dir / "DICOMDIR-empty.dcm");
  EXPECT_TRUE(none.instances.empty());
  EXPECT_EQ(std::get<double>(none.findings.at(0).numbers.at("referenced_files")), 0);
  // 28 files by names that are not there: said, and nothing else is loaded instead.
  VERNIER_NEEDS_DATA("ct_phantom_head_series");
  const StudySet lost = scan(test::dataDir() / "ct_phantom_head_series" / "DIRFILE");
  EXPECT_TRUE(lost.instances.empty());
  EXPECT_EQ(std::get<double>(lost.findings.at(0).numbers.at("referenced_files")), 28);
  EXPECT_EQ(std::get<double>(lost.findings[0].numbers.at("referenced_files_present")), 0);
}

TEST(SopClasses, AreInOrderAndNamed) {
  // Looked up by binary search: any two neighbours out of order would hide a class.
  for (const char* uid :
       {"1.2.840.10008.1.3.10", "1.2.840.10008.5.1.4.1.1.2", "1.2.840.10008.5.1.4.1.1.2.1",
        "1.2.840.10008.5.1.4.1.1.4", "1.2.840.10008.5.1.4.1.1.128", "1.2.840.10008.5.1.4.1.1.7",
        "1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.481.2", "1.2.840.10008.5.1.4.43.1"})
    EXPECT_TRUE(findSopClass(uid)) << uid;
  EXPECT_FALSE(findSopClass("1.2.3"));
  EXPECT_FALSE(findSopClass(""));
}

}  // namespace
}  // namespace vernier
