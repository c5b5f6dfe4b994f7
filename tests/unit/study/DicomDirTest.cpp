// SPDX-License-Identifier: GPL-3.0-or-later
// A DICOMDIR that is opened by itself names files of its own folder, and none elsewhere.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "MakeDicom.h"
#include "MakeDicomDir.h"
#include "TestData.h"
#include "vernier/study/Load.h"

namespace vernier {
namespace {
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class DicomDirTest : public ::testing::Test {
 protected:
  DicomDirTest() {
    fs::create_directories(disk() / "DATA/S1");
    put("DATA/S1/IM1", 1);
  }
  fs::path disk() const { return dir_.path() / "disk"; }
  void put(const std::string& name, int number) {
    test::DicomSlice s;
    s.instanceNumber = number;
    s.position = {0, 0, 2.0 * number};
    test::writeDicom(disk() / name, s);
  }
  StudySet open(const std::vector<std::string>& ids) {
    std::ofstream(disk() / "DICOMDIR", std::ios::binary) << test::dicomDirBytes(ids);
    auto set = scanStudy({(disk() / "DICOMDIR").string()});
    EXPECT_TRUE(set.ok()) << set.error().text();
    EXPECT_EQ(set->findings.at(0).code, "dicomdir");
    return std::move(*set);
  }
  static double number(const StudySet& set, const char* name) {
    return std::get<double>(set.findings.at(0).numbers.at(name));
  }
  test::TempDir dir_;
};

TEST_F(DicomDirTest, NamesAreFoundAsDisksWriteThem) {
  put("DATA/S1/im2", 2);     // lower case
  put("DATA/S1/IM3;1", 3);   // ISO 9660's version
  put("DATA/S1/IM4.;1", 4);  // ... and its empty extension
  const StudySet set =
      open({"DATA\\S1\\IM1", "DATA\\S1\\IM2", "DATA\\S1\\IM3", "DATA\\S1\\IM4", "data\\s1\\IM5"});
  EXPECT_EQ(set.instances.size(), 4u);
  EXPECT_EQ(number(set, "referenced_files"), 5);
  EXPECT_EQ(number(set, "referenced_files_present"), 4);
  EXPECT_EQ(set.findings[0].severity, Severity::Info);
  EXPECT_THAT(set.findings[0].sentence, HasSubstr("5 files, 4 of which are there"));
  ASSERT_EQ(set.series.size(), 1u);
  EXPECT_EQ(set.series[0].stacks.at(0).slices.size(), 4u);
}

TEST_F(DicomDirTest, WhatLiesOutsideIsNotLookedFor) {
  test::writeDicom(dir_.path() / "secret.dcm", {});
  fs::create_directory(dir_.path() / "elsewhere");
  test::writeDicom(dir_.path() / "elsewhere/x.dcm", {});
  fs::create_symlink("../secret.dcm", disk() / "LINK");
  fs::create_directory_symlink("../elsewhere", disk() / "LINKDIR");
  const StudySet set =
      open({"..\\secret.dcm", "DATA\\..\\..\\secret.dcm", (dir_.path() / "secret.dcm").string(), "LINK",
            "LINKDIR\\x.dcm", "DATA\\S1\\IM1"});
  EXPECT_EQ(set.instances.size(), 1u);
  EXPECT_EQ(set.files.size(), 2u);
  EXPECT_EQ(number(set, "referenced_files_present"), 1);
  EXPECT_EQ(number(set, "referenced_files_outside"), 5);
  EXPECT_THAT(set.findings[0].sentence, HasSubstr("5 lie outside"));
}

TEST_F(DicomDirTest, FoldersPipesAndEmptyNamesAreMissing) {
  const StudySet set =
      open({"DATA", "DATA\\S1", "DATA\\\\IM1", "\\", ".", "NONE\\IM1", "DATA\\S1\\IM1\\IM1"});
  EXPECT_TRUE(set.instances.empty());
  EXPECT_EQ(number(set, "referenced_files_present"), 0);
  EXPECT_EQ(number(set, "referenced_files_outside"), 0);
}

TEST_F(DicomDirTest, InAFolderTheFilesRule) {
  put("DATA/S1/IM2", 2);
  std::ofstream(disk() / "DICOMDIR", std::ios::binary) << test::dicomDirBytes({"DATA\\S1\\IM1", "GONE"});
  const auto set = scanStudy({disk().string()});
  ASSERT_TRUE(set.ok());
  EXPECT_EQ(set->instances.size(), 2u);
  EXPECT_THAT(set->findings.at(0).sentence, HasSubstr("in a folder the files themselves rule"));
}

TEST_F(DicomDirTest, OpenedInsideItsOwnFolder) {
  std::ofstream(disk() / "DICOMDIR", std::ios::binary) << test::dicomDirBytes({"DATA\\S1\\IM1"});
  const fs::path before = fs::current_path();
  fs::current_path(disk());
  const auto set = scanStudy({"DICOMDIR"});
  fs::current_path(before);
  ASSERT_TRUE(set.ok());
  EXPECT_EQ(set->instances.size(), 1u);
}

}  // namespace
}  // namespace vernier
