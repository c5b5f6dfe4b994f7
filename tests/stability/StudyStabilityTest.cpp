// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases A1..A13, A16..A19: geometry and structure of studies that are wrong, rare or hostile. Where
// the rules of docs/studies.md are stricter or milder than the general list of cases, they hold.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <fstream>

#include "MakeDicom.h"
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
  EXPECT_TRUE(set) << (set ? "" : set.error().text());
  return set ? std::move(*set) : StudySet();
}
// The series of n slices with that step; its largest stack.
struct Loaded {
  StudySet set;
  const Stack& stack() const { return set.series.at(0).stacks.at(0); }
  const Finding* finding(const std::string& code) const {
    for (const Finding& f : stack().findings)
      if (f.code == code) return &f;
    return nullptr;
  }
};
Loaded load(int n, std::array<double, 3> step_mm, const DicomSlice& first = {}) {
  const TempDir dir;
  writeSeries(dir.path(), n, step_mm, first);
  return {scan(dir.path())};
}
Loaded loadAt(const std::vector<std::array<double, 3>>& positions, DicomSlice s = {}) {
  const TempDir dir;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    s.instanceNumber = static_cast<int>(k) + 1;
    s.position = positions[k];
    writeDicom(dir.path() / (std::to_string(k) + ".dcm"), s);
  }
  return {scan(dir.path())};
}
glm::dvec3 place(const GridGeometry& g, double i, double j, double k) {
  return (g.patientFromVoxel * VoxelPoint(i, j, k)).p;
}
void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_LE(glm::length(a - b), tolerance) << a.x << "," << a.y << "," << a.z;
}
DicomSlice withOrientation(std::array<double, 6> o) {
  DicomSlice s;
  s.orientation = o;
  return s;
}

TEST(Stability, A01_OrientationOffBy1e4IsFixedSilently) {
  const Loaded l = load(3, {0, 0, 2}, withOrientation({1.00005, 0, 0, 0.00009, 1, 0}));
  EXPECT_TRUE(l.stack().volume3d);
  EXPECT_FALSE(l.stack().orientationFixed);
  const glm::dmat3& m = l.stack().grid.patientFromVoxel.linear;
  EXPECT_NEAR(glm::dot(m[0], m[1]), 0, 1e-15);
  EXPECT_NEAR(glm::length(m[0]), 1, 1e-15);
  // The farthest pixel of this image moves by less than a hundredth of a voxel.
  const glm::dvec3 asWritten = 3.0 * glm::dvec3(1.00005, 0, 0) + 3.0 * glm::dvec3(0.00009, 1, 0);
  expectNear(place(l.stack().grid, 3, 3, 0), asWritten, 0.01);
}

TEST(Stability, A02_OrientationFartherOffIsFlaggedThenRefused) {
  for (const double off : {2e-4, 9e-3}) {
    const Loaded l = load(3, {0, 0, 2}, withOrientation({1, 0, 0, off, 1, 0}));
    EXPECT_TRUE(l.stack().volume3d) << off;
    EXPECT_TRUE(l.stack().orientationFixed) << off;
    ASSERT_TRUE(l.finding("orientation-fixed"));
    EXPECT_EQ(l.finding("orientation-fixed")->severity, Severity::Notice);
  }
  const double nan = std::nan("");
  for (const auto& o : std::vector<std::array<double, 6>>{{1, 0, 0, 0.02, 1, 0},
                                                          {0, 0, 0, 0, 1, 0},
                                                          {1, 0, 0, 1, 0, 0},
                                                          {1, 0, 0, 2, 0, 0},
                                                          {nan, 0, 0, 0, 1, 0}}) {
    const Loaded l = load(3, {0, 0, 2}, withOrientation(o));
    EXPECT_FALSE(l.stack().volume3d);
    EXPECT_FALSE(l.stack().why2d.empty());
    EXPECT_EQ(l.stack().slices.size(), 3u);  // 2-D is still there
    EXPECT_EQ(l.stack().shape, StackShape::NoGeometry);
  }
}

TEST(Stability, A03_UnevenSlicesKeepTheirTruePositionsAndSayByHowMuch) {
  const Loaded l = loadAt({{0, 0, 0}, {0, 0, 2}, {0, 0, 4.4}, {0, 0, 6}, {0, 0, 8}});
  EXPECT_EQ(l.stack().shape, StackShape::Uneven);
  ASSERT_TRUE(l.finding("uneven-spacing"));
  EXPECT_NEAR(l.stack().deviation_mm, 0.32, 1e-9);  // the fitted line moves by a fifth of 0.4
  const GridGeometry& g = l.stack().grid;
  const double z[] = {0, 2, 4.4, 6, 8};
  for (std::size_t k = 0; k < 5; ++k)
    expectNear((g.patientFromVoxel * VoxelPoint(g.sliceOrigin_vox.at(k))).p, {0, 0, z[k]}, 1e-9);
}

TEST(Stability, A04_MissingSliceIsAGapAndTheEndStaysInPlace) {
  const Loaded l = loadAt({{0, 0, 0}, {0, 0, 5}, {0, 0, 10}, {0, 0, 20}, {0, 0, 25}});
  EXPECT_EQ(l.stack().grid.gapAfter, (std::vector<std::int64_t>{2}));
  ASSERT_TRUE(l.finding("gap"));
  EXPECT_EQ(std::get<double>(l.finding("gap")->numbers.at("missing_slices")), 1);
  const GridGeometry& g = l.stack().grid;
  expectNear((g.patientFromVoxel * VoxelPoint(g.sliceOrigin_vox.back())).p, {0, 0, 25}, 1e-9);
}

TEST(Stability, A05_SpacingBetweenSlicesNeverMakesGeometry) {
  DicomSlice s;
  s.set = {{"0018,0088", "-7.5"}, {"0018,0050", "99"}, {"0020,1041", "-1000"}};
  const Loaded l = load(4, {0, 0, 2.5}, s);
  EXPECT_EQ(l.stack().shape, StackShape::Uniform);
  expectNear(place(l.stack().grid, 0, 0, 3), {0, 0, 7.5}, 1e-9);
  // Instance numbers running downwards turn nothing round either.
  const Loaded down = load(4, {0, 0, -2.5}, s);
  expectNear(place(down.stack().grid, 0, 0, 0), {0, 0, -7.5}, 1e-9);
}

TEST(Stability, A06_GantryTiltIsAShearedAffineWithinAThousandthOfAMillimetre) {
  const double a = 14 * 3.14159265358979323846 / 180;
  const Loaded l = load(5, {0, -5 * std::sin(a), 5 * std::cos(a)});
  EXPECT_EQ(l.stack().shape, StackShape::Sheared);
  ASSERT_TRUE(l.finding("tilt"));
  EXPECT_NEAR(l.stack().shear_deg, 14, 1e-6);
  // A ruler from the first slice's corner to the last slice's opposite corner.
  const double measured = glm::length(place(l.stack().grid, 3, 3, 4) - place(l.stack().grid, 0, 0, 0));
  const double truth = glm::length(glm::dvec3(3, 3 - 20 * std::sin(a), 20 * std::cos(a)));
  EXPECT_NEAR(measured, truth, 1e-3);
}

TEST(Stability, A07_MirroredRowsAndColumnsKeepTheirSides) {
  // Eight flips of rows, columns and file order: the voxel under a patient point is always the stored one.
  for (int flip = 0; flip < 8; ++flip) {
    const double sx = flip & 1 ? -1 : 1, sy = flip & 2 ? -1 : 1, sz = flip & 4 ? -1 : 1;
    DicomSlice s = withOrientation({sx, 0, 0, 0, sy, 0});
    const Loaded l = load(3, {0, 0, sz * 2}, s);
    ASSERT_TRUE(l.stack().volume3d);
    const GridGeometry& g = l.stack().grid;
    EXPECT_NEAR(g.patientFromVoxel.linear[0].x, sx, 1e-12);
    EXPECT_NEAR(g.patientFromVoxel.linear[1].y, sy, 1e-12);
    for (std::size_t k = 0; k < 3; ++k) {
      const Instance& i = l.set.instances[l.stack().slices[k].instance];
      expectNear(place(g, 0, 0, static_cast<double>(k)), i.plane->origin.p, 1e-9);
    }
  }
}

TEST(Stability, A08_TwoSlicesAtOnePositionRefuse3d) {
  const Loaded l = loadAt({{0, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 2}});
  EXPECT_FALSE(l.stack().volume3d);
  ASSERT_TRUE(l.finding("coincident-positions"));
  EXPECT_EQ(l.stack().slices.size(), 4u);
  // Two phases that an attribute tells apart are two stacks.
  const TempDir dir;
  DicomSlice phase;
  for (int p = 0; p < 2; ++p) {
    phase.seriesUid = "2.25.77";
    phase.set = {{"0018,1060", std::to_string(p * 400)}, {"0008,0018", "2.25.78." + std::to_string(p)}};
    for (int k = 0; k < 3; ++k) {
      phase.position = {0, 0, 2.0 * k};
      phase.instanceNumber = p * 3 + k + 1;
      phase.set[1].second = "2.25.78." + std::to_string(phase.instanceNumber);
      writeDicom(dir.path() / (std::to_string(phase.instanceNumber) + ".dcm"), phase);
    }
  }
  const StudySet set = scan(dir.path());
  ASSERT_EQ(set.series.at(0).stacks.size(), 2u);
  for (const Stack& s : set.series[0].stacks) EXPECT_TRUE(s.volume3d);
}

TEST(Stability, A09_PixelSpacingThatCannotBe) {
  for (const auto& spacing :
       std::vector<std::array<double, 2>>{{0, 1}, {1, -1}, {std::nan(""), 1}, {1e-9, 1e-9}, {1e6, 1e6}}) {
    DicomSlice s;
    s.spacing = spacing;
    const Loaded l = load(3, {0, 0, 1}, s);
    EXPECT_FALSE(l.stack().volume3d);
    EXPECT_TRUE(l.finding("pixel-spacing-unusable"));
    EXPECT_EQ(l.set.instances[0].pixelSpacing_mm, glm::dvec2(0, 0));  // lengths in pixels only
  }
  DicomSlice absent;
  absent.erase = {"0028,0030"};
  EXPECT_FALSE(load(3, {0, 0, 1}, absent).stack().volume3d);
}

TEST(Stability, A10_PixelSpacingIsRowThenColumn) {
  DicomSlice s;
  s.spacing = {2, 1};  // rows are 2 mm apart, columns 1 mm
  const Loaded l = load(2, {0, 0, 3}, s);
  const GridGeometry& g = l.stack().grid;
  EXPECT_NEAR(glm::length(place(g, 0, 3, 0) - place(g, 0, 0, 0)), 6, 6e-9);
  EXPECT_NEAR(glm::length(place(g, 3, 0, 0) - place(g, 0, 0, 0)), 3, 3e-9);
}

TEST(Stability, A11_OneSliceAndTwoSlices) {
  const Loaded one = load(1, {0, 0, 1});
  EXPECT_EQ(one.stack().shape, StackShape::Single);
  EXPECT_FALSE(one.stack().volume3d);
  EXPECT_GT(std::abs(glm::determinant(one.stack().grid.patientFromVoxel.linear)), 0);
  const Loaded two = load(2, {0, 0, 4});
  EXPECT_TRUE(two.stack().volume3d);
  EXPECT_NEAR(two.stack().grid.spacing_mm().z, 4, 1e-12);
}

TEST(Stability, A12_ImagesOfOneRowOrColumn) {
  for (const auto& [rows, columns] : {std::pair(1, 7), std::pair(7, 1), std::pair(1, 1)}) {
    DicomSlice s;
    s.rows = rows;
    s.columns = columns;
    const TempDir dir;
    writeSeries(dir.path(), 3, {0, 0, 1}, s);
    const Loaded l{scan(dir.path())};
    EXPECT_TRUE(l.stack().volume3d);
    EXPECT_EQ(l.stack().grid.rows, rows);
    EXPECT_EQ(l.stack().grid.columns, columns);
    std::vector<std::byte> pixels(static_cast<std::size_t>(rows * columns) * 2);
    EXPECT_TRUE(decodeSlice(l.set, l.stack().slices[1], pixels));
    EXPECT_EQ(pixels[0], std::byte{10});
  }
}

TEST(Stability, A13_AnisotropyOfFifty) {
  DicomSlice s;
  s.spacing = {0.1, 0.1};
  const Loaded l = load(4, {0, 0, 5}, s);
  EXPECT_EQ(l.stack().shape, StackShape::Uniform);
  const glm::dvec3 mm = l.stack().grid.spacing_mm();
  EXPECT_NEAR(mm.z / mm.x, 50, 0.05);
  EXPECT_NEAR(mm.y, 0.1, 1e-12);
}

TEST(Stability, A16_ShortPixelDataIsRefusedAndNeverPadded) {
  DicomSlice s;
  s.set = {{"0028,0008", "1000"}};  // 1000 frames, one is there
  const Loaded many = load(1, {0, 0, 1}, s);
  ASSERT_EQ(many.set.instances.size(), 1u);
  ASSERT_TRUE(many.set.instances[0].pixelError);
  EXPECT_EQ(many.set.instances[0].pixelError->code, ErrorCode::PixelDataShort);
  EXPECT_TRUE(many.set.series.at(0).stacks.empty());

  const TempDir dir;
  writeSeries(dir.path(), 5, {0, 0, 1});
  fs::resize_file(dir.path() / "002.dcm", fs::file_size(dir.path() / "002.dcm") - 2);
  const StudySet set = scan(dir.path());
  EXPECT_EQ(set.series.at(0).stacks.at(0).slices.size(), 4u);
  EXPECT_EQ(set.series[0].stacks[0].grid.gapAfter.size(), 1u);  // the bad slice is missing, not black
}

TEST(Stability, A17_RowsThatLie) {
  for (const char* rows : {"0", "65535"}) {
    DicomSlice s;
    s.set = {{"0028,0010", rows}, {"0028,0011", "65535"}};
    const Loaded l = load(1, {0, 0, 1}, s);
    ASSERT_EQ(l.set.instances.size(), 1u);
    ASSERT_TRUE(l.set.instances[0].pixelError) << rows;
    EXPECT_TRUE(l.set.files[0].error);
  }
}

void appendU32(std::string& s, std::uint32_t v) {
  for (int b = 0; b < 4; ++b) s += static_cast<char>(v >> (8 * b));
}
// A valid object, and behind its last element before the pixels whatever `middle` says.
fs::path hostile(const TempDir& dir, const std::string& middle) {
  DicomSlice s;
  s.erase = {"7FE0,0010"};
  writeDicom(dir.path() / "h.dcm", s);
  std::ofstream(dir.path() / "h.dcm", std::ios::binary | std::ios::app) << middle;
  return dir.path() / "h.dcm";
}

TEST(Stability, A18_SequencesNested15000DeepAreRefused) {
  std::string deep;
  for (int i = 0; i < 15000; ++i) {
    deep += std::string("\x40\x00\x75\xA0SQ\0\0", 8);
    appendU32(deep, 0xFFFFFFFF);
    deep += std::string("\xFE\xFF\x00\xE0", 4);
    appendU32(deep, 0xFFFFFFFF);
  }
  for (int i = 0; i < 15000; ++i) {
    deep += std::string("\xFE\xFF\x0D\xE0\0\0\0\0", 8);
    deep += std::string("\xFE\xFF\xDD\xE0\0\0\0\0", 8);
  }
  const TempDir dir;
  const StudySet set = scan(hostile(dir, deep));
  ASSERT_EQ(set.files.size(), 1u);
  ASSERT_TRUE(set.files[0].error);
  EXPECT_EQ(set.files[0].error->code, ErrorCode::LimitExceeded);
}

TEST(Stability, A19_DeclaredLengthOf4GBInASmallFileAllocatesNothing) {
  std::string lie("\x41\x00\x02\x10OB\0\0", 8);
  appendU32(lie, 0xFFFFFFFE);
  lie += "abcd";
  const TempDir dir;
  const fs::path file = hostile(dir, lie);
  ASSERT_LT(fs::file_size(file), 2048u);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const StudySet set = scan(file);
  getrusage(RUSAGE_SELF, &after);
  ASSERT_TRUE(set.files.at(0).error);
  EXPECT_EQ(set.files[0].error->code, ErrorCode::FileDamaged);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 64 << 10);  // kB
}

}  // namespace
}  // namespace vernier
