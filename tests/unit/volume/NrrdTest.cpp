// SPDX-License-Identifier: GPL-3.0-or-later
// NRRD files that teem wrote (files/make_nrrd.sh), and headers written here in every way that the format
// allows.
#include <gmock/gmock.h>

#include <cstring>
#include <fstream>

#include "FileCases.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {
using test::has;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kFiles = fs::path(VERNIER_SOURCE_DIR) / "tests/unit/volume/files";

void expectCounting(const Volume& v) {
  ASSERT_EQ(v.grid().columns, 4);
  ASSERT_EQ(v.grid().rows, 3);
  ASSERT_EQ(v.grid().slices, 2);
  for (std::int64_t p = 0; p < 24; ++p)
    ASSERT_EQ(v.stored(p % 4, p / 4 % 3, p / 12), static_cast<double>(p - 12));
}

// RAS (1,2,3) is LPS (-1,-2,3), and so on for each axis.
void expectPlace(const PatientFromVoxel& m) {
  EXPECT_EQ(m.translation, glm::dvec3(-1, -2, 3));
  EXPECT_EQ(m.linear[0], glm::dvec3(-0.5, 0, 0));
  EXPECT_EQ(m.linear[1], glm::dvec3(0, -0.75, 0.1));
  EXPECT_EQ(m.linear[2], glm::dvec3(-0.2, 0, 2));
}

TEST(Nrrd, AsTeemWritesIt) {
  for (const char* name : {"teem-raw.nrrd", "teem-gzip.nrrd", "teem-bzip2.nrrd", "teem-ascii.nrrd",
                           "teem-big.nrrd", "teem-double.nrrd"}) {
    SCOPED_TRACE(name);
    const auto v = readVolumeFile((kFiles / name).string());
    ASSERT_TRUE(v.ok()) << v.error().text();
    expectCounting(**v);
    expectPlace((*v)->grid().patientFromVoxel);
    EXPECT_EQ((*v)->type(), std::string(name) == "teem-double.nrrd" ? VoxelType::F32 : VoxelType::I16);
    EXPECT_FALSE(has((*v)->info().findings, "axes-unknown"));
    EXPECT_EQ((*v)->info().unit, "stored value");
  }
}

struct Case {
  test::TempDir dir;
  std::string raw;
  Case() {
    for (int i = -12; i < 12; ++i) {
      const auto x = static_cast<std::int16_t>(i);
      raw.append(reinterpret_cast<const char*>(&x), 2);
    }
  }
  void write(const std::string& name, const std::string& bytes) {
    std::ofstream(dir.path() / name, std::ios::binary) << bytes;
  }
  Result<std::shared_ptr<const Volume>> read(const std::string& header, const BuildOptions& o = {}) {
    write("v.nhdr", "NRRD0005\n" + header);
    write("v.raw", raw);
    return readVolumeFile((dir.path() / "v.nhdr").string(), o);
  }
  ErrorCode refusal(const std::string& header) {
    const auto v = read(header);
    EXPECT_FALSE(v.ok()) << header;
    if (v.ok()) return ErrorCode::Internal;
    EXPECT_GT(v.error().sentence.size(), 20u);
    EXPECT_EQ(v.error().where.find('/'), std::string::npos);
    return v.error().code;
  }
};

const std::string kValues = "type: short\ndimension: 3\nsizes: 4 3 2\nencoding: raw\nendian: little\n";
const std::string kPlace =
    "space: left-posterior-superior\nspace directions: (0.5,0,0) (0,0.75,0) (0,0,2)\nspace origin: (1,2,3)\n";
const std::string kDetached = "data file: v.raw\n";

TEST(NrrdSpaces, AreTurnedToLps) {
  const std::pair<const char*, glm::dvec3> spaces[] = {{"left-posterior-superior", {1, 1, 1}},
                                                       {"LPS", {1, 1, 1}},
                                                       {"right-anterior-superior", {-1, -1, 1}},
                                                       {"RAS", {-1, -1, 1}},
                                                       {"LAS", {1, -1, 1}},
                                                       {"left-anterior-superior", {1, -1, 1}}};
  for (const auto& [space, signs] : spaces) {
    Case c;
    const auto v = c.read(kValues + kDetached + "space: " + space +
                          "\nspace directions: (0.5,0.1,0) (-0.2,0.75,0) (0,0,-2)\nspace origin: (1,2,3)\n");
    ASSERT_TRUE(v.ok()) << v.error().text();
    expectCounting(**v);
    EXPECT_EQ((*v)->grid().patientFromVoxel.linear[0], signs * glm::dvec3(0.5, 0.1, 0)) << space;
    EXPECT_EQ((*v)->grid().patientFromVoxel.linear[1], signs * glm::dvec3(-0.2, 0.75, 0)) << space;
    EXPECT_EQ((*v)->grid().patientFromVoxel.linear[2], signs * glm::dvec3(0, 0, -2)) << space;
    EXPECT_EQ((*v)->grid().patientFromVoxel.translation, signs * glm::dvec3(1, 2, 3)) << space;
    EXPECT_FALSE(has((*v)->info().findings, "axes-unknown"));
  }
  for (const char* space :
       {"space: scanner-xyz\nspace directions: (0.5,0,0) (0,0.75,0) (0,0,2)\n", "spacings: 0.5 0.75 2\n",
        "space dimension: 3\nspace directions: (0.5,0,0) (0,0.75,0) (0,0,2)\n"}) {
    Case c;
    const auto v = c.read(kValues + kDetached + space);
    ASSERT_TRUE(v.ok()) << v.error().text();
    EXPECT_TRUE(has((*v)->info().findings, "axes-unknown")) << space;
    EXPECT_EQ((*v)->grid().spacing_mm(), glm::dvec3(0.5, 0.75, 2)) << space;
  }
  Case c;
  const auto bare = c.read(kValues + kDetached);
  ASSERT_TRUE(bare.ok());
  EXPECT_TRUE(has((*bare)->info().findings, "spacing-assumed"));
}

TEST(NrrdSpaces, UnitsOfLengthAreTurnedToMillimetres) {
  Case c;
  const auto v =
      c.read(kValues + kDetached + kPlace + "space units: \"cm\" \"cm\" \"cm\"\nsample units: HU\n");
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->grid().spacing_mm(), glm::dvec3(5, 7.5, 20));
  EXPECT_EQ((*v)->grid().patientFromVoxel.translation, glm::dvec3(10, 20, 30));
  EXPECT_EQ((*v)->info().unit, "HU") << "stated by the file";
  EXPECT_EQ(c.refusal(kValues + kDetached + kPlace + "space units: \"furlong\" \"mm\" \"mm\"\n"),
            ErrorCode::FileDamaged);
}

TEST(NrrdFiles, AttachedSkipsAndWindowsLineEnds) {
  Case c;
  c.write("a.nrrd",
          "NRRD0001\r\n# a comment\r\ntype: short\r\ndimension: 3\r\nsizes: 4 3 2\r\nkey:=a: value\r\n"
          "encoding: raw\r\nendian: little\r\n\r\n" +
              c.raw);
  const auto attached = readVolumeFile((c.dir.path() / "a.nrrd").string());
  ASSERT_TRUE(attached.ok()) << attached.error().text();
  expectCounting(**attached);
  const std::string plain = c.raw;
  c.raw = "first line\nsecond\nxyz" + plain;
  const auto skipped = c.read(kValues + kDetached + "line skip: 2\nbyte skip: 3\n");
  ASSERT_TRUE(skipped.ok()) << skipped.error().text();
  expectCounting(**skipped);
  const auto fromEnd = c.read(kValues + kDetached + "byte skip: -1\n");
  ASSERT_TRUE(fromEnd.ok());
  expectCounting(**fromEnd);
  EXPECT_EQ(c.refusal(kValues + kDetached + "line skip: 900\n"), ErrorCode::PixelDataShort);
  EXPECT_EQ(c.refusal(kValues + kDetached + "byte skip: -2\n"), ErrorCode::FileDamaged);
}

TEST(NrrdFiles, TextNumbersMustFitTheirType) {
  const std::string head = "type: uchar\ndimension: 2\nsizes: 3 2\nencoding: ascii\n" + kDetached;
  Case c;
  c.raw = "1, 2 3\n4\t255\r\n0";
  const auto v = c.read(head);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->stored(1, 1, 0), 255);
  EXPECT_EQ((*v)->stored(2, 1, 0), 0);
  for (const char* bad : {"1 2 3 4 256 0", "1 2 3 4 -1 0", "1 2 3 4 2.5 0", "1 2 3 x 5 0", "1 2 3 4 5 "}) {
    c.raw = bad;
    const ErrorCode code = c.refusal(head);
    EXPECT_TRUE(code == ErrorCode::FileDamaged || code == ErrorCode::PixelDataShort) << bad;
  }
  c.raw = std::string(100'000, '7');
  EXPECT_EQ(c.refusal(head), ErrorCode::FileDamaged);
}

TEST(NrrdFiles, AListAxisBehindSpaceIsFrames) {
  Case c;
  const std::string head =
      "type: short\ndimension: 4\nsizes: 4 3 1 2\nencoding: raw\nendian: little\nspace: LPS\n"
      "space directions: (0.5,0,0) (0,0.75,0) (0,0,2) none\nkinds: domain domain domain list\n" +
      kDetached;
  EXPECT_EQ(c.refusal(head), ErrorCode::OptionInvalid);
  BuildOptions o;
  o.frame = 1;
  const auto v = c.read(head, o);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->stored(0, 0, 0), 0);
  EXPECT_EQ((*v)->grid().slices, 1);
  EXPECT_EQ(c.refusal("type: short\ndimension: 4\nsizes: 3 4 2 1\nencoding: raw\nendian: little\nspace: LPS\n"
                      "space directions: none (0.5,0,0) (0,0.75,0) (0,0,2)\n" +
                      kDetached),
            ErrorCode::NotBuiltYet);
  const auto one = c.read(
      "type: short\ndimension: 4\nsizes: 1 4 3 2\nencoding: raw\nendian: little\nspace: LPS\n"
      "space directions: none (0.5,0,0) (0,0.75,0) (0,0,2)\n" +
      kDetached);
  ASSERT_TRUE(one.ok()) << one.error().text();
  expectCounting(**one);
}

TEST(NrrdFiles, DataOutsideTheFolderIsRefused) {
  Case c;
  fs::create_directories(c.dir.path() / "in");
  c.write("v.raw", c.raw);
  fs::create_symlink("../v.raw", c.dir.path() / "in/link.raw");
  for (const std::string& name :
       {std::string("../v.raw"), (c.dir.path() / "v.raw").string(), std::string("link.raw")}) {
    std::ofstream(c.dir.path() / "in/v.nhdr") << "NRRD0004\n" + kValues + "data file: " + name + "\n";
    const auto v = readVolumeFile((c.dir.path() / "in/v.nhdr").string());
    ASSERT_FALSE(v.ok()) << name;
    EXPECT_EQ(v.error().code, ErrorCode::FileDamaged);
    EXPECT_THAT(v.error().sentence, HasSubstr("outside the header's folder"));
  }
}

TEST(NrrdFiles, WhatCannotBeUsedSaysWhy) {
  const std::pair<std::string, ErrorCode> headers[] = {
      {"", ErrorCode::FileDamaged},
      {"no colon here\n", ErrorCode::FileDamaged},
      {kValues, ErrorCode::FileDamaged},  // attached without a blank line
      {"type: short\ndimension: 3\nsizes: 4 3\nencoding: raw\nendian: little\n" + kDetached,
       ErrorCode::FileDamaged},
      {"type: short\ndimension: 3\nsizes: 4 -3 2\nencoding: raw\nendian: little\n" + kDetached,
       ErrorCode::FileDamaged},
      {"type: short\ndimension: 99\nsizes: 4\nencoding: raw\nendian: little\n" + kDetached,
       ErrorCode::FileDamaged},
      {"type: short\ndimension: 3\nsizes: 4 3 3\nencoding: raw\nendian: little\n" + kDetached,
       ErrorCode::PixelDataShort},
      {"type: short\ndimension: 3\nsizes: 3000000000 3000000000 3000000000\nencoding: raw\nendian: little\n" +
           kDetached,
       ErrorCode::LimitExceeded},
      {"type: short\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n" + kDetached, ErrorCode::FileDamaged},
      {"type: block\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n" + kDetached, ErrorCode::NotBuiltYet},
      {"type: short\ndimension: 3\nsizes: 4 3 2\nencoding: hex\nendian: little\n" + kDetached,
       ErrorCode::NotBuiltYet},
      {"type: short\ndimension: 3\nsizes: 4 3 2\nencoding: gzip\nendian: little\n" + kDetached,
       ErrorCode::FileDamaged},
      {"type: short\ndimension: 3\nsizes: 4 3 2\nencoding: bzip2\nendian: little\n" + kDetached,
       ErrorCode::FileDamaged},
      {"type: short\ndimension: 3\nsizes: 4 3 2\nencoding: raw\nendian: middle\n" + kDetached,
       ErrorCode::FileDamaged},
      {kValues + "data file: LIST\nv.raw\n", ErrorCode::FileDamaged},
      {kValues + "data file: v%d.raw 1 2 1\n", ErrorCode::NotBuiltYet},
      {kValues + "data file: none.raw\n", ErrorCode::FileNotFound},
      {kValues + kDetached + "space: LPS\nspace directions: (nan,0,0) (0,1,0) (0,0,1)\n",
       ErrorCode::GeometryRefused},
      {kValues + kDetached + "space: LPS\nspace directions: (1,0,0) (1,0,0) (0,0,1)\n",
       ErrorCode::GeometryRefused},
      {kValues + kDetached + "space: LPS\nspace directions: (0,0,0) (0,1,0) (0,0,1)\n",
       ErrorCode::GeometryRefused},
      {kValues + kDetached + "space: LPS\nspace directions: (1,0,0) (0,1,0)\n", ErrorCode::FileDamaged},
      {kValues + kDetached + "space: LPS\nspace directions: (1,0,0 (0,1,0) (0,0,1)\n",
       ErrorCode::FileDamaged},
      {kValues + kDetached + kPlace + "space origin: 1 2 3\n", ErrorCode::FileDamaged},
      {kValues + kDetached + "spacings: 1 1\n", ErrorCode::FileDamaged},
  };
  for (const auto& [header, code] : headers) {
    Case c;
    EXPECT_EQ(c.refusal(header), code) << header;
  }
}

}  // namespace
}  // namespace vernier
