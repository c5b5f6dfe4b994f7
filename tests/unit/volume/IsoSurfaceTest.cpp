// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/IsoSurface.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "Grids.h"
#include "vernier/base/Threads.h"
#include "vernier/volume/MeshFacts.h"
#include "vernier/volume/Sampling.h"

namespace vernier {
namespace {

constexpr std::uint64_t kCache = std::uint64_t{1} << 28;

std::shared_ptr<const Mesh> surfaceOf(const Volume& volume, double level) {
  DerivedCache cache(kCache);
  const auto out = isoSurfaces(volume, std::array{level}, cache);
  EXPECT_TRUE(out.ok()) << out.error().text();
  return out.ok() ? out->meshes[0] : nullptr;
}

std::int64_t eulerOf(const Mesh& m) {
  return static_cast<std::int64_t>(m.vertices().size() + m.triangles().size()) -
         static_cast<std::int64_t>(meshFacts(m).distinctEdges);
}

// Distance from the middle of the grid, in voxels.
std::vector<float> ball(const GridGeometry& g) {
  std::vector<float> v;
  const glm::dvec3 middle(0.5 * (g.columns - 1), 0.5 * (g.rows - 1), 0.5 * (g.slices - 1));
  for (int k = 0; k < g.slices; ++k)
    for (int j = 0; j < g.rows; ++j)
      for (int i = 0; i < g.columns; ++i)
        v.push_back(static_cast<float>(100 - glm::length(glm::dvec3(i, j, k) - middle)));
  return v;
}

std::shared_ptr<const Volume> ballVolume(const GridGeometry& g) {
  VolumeInfo info;
  info.grid = g;
  return test::volumeOf(info, ball(g));
}

// Counts of the pieces of a pattern of inside voxels that hang together along edges: vertices - edges +
// squares - cube. The surface around it has twice this Euler number.
int solidEuler(int pattern) {
  const auto in = [&](int i, int j, int k) { return (pattern >> (i + 2 * j + 4 * k) & 1) != 0; };
  int n = 0;
  bool all = true;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) n += in(i, j, k), all = all && in(i, j, k);
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b)
      n -= (in(0, a, b) && in(1, a, b)) + (in(a, 0, b) && in(a, 1, b)) + (in(a, b, 0) && in(a, b, 1));
  for (int a = 0; a < 2; ++a) {
    n += in(a, 0, 0) && in(a, 1, 0) && in(a, 0, 1) && in(a, 1, 1);
    n += in(0, a, 0) && in(1, a, 0) && in(0, a, 1) && in(1, a, 1);
    n += in(0, 0, a) && in(1, 0, a) && in(0, 1, a) && in(1, 1, a);
  }
  // Two outside corners across the cube leave its middle inside: a disc in the ring of the six others.
  const bool ring = pattern == 126 || pattern == 189 || pattern == 219 || pattern == 231;
  return n - all + ring;
}

TEST(IsoSurface, D7_All256CasesAreClosedManifoldsWithTheRightEulerNumber) {
  for (int pattern = 1; pattern < 256; ++pattern) {
    VolumeInfo info;
    info.grid = test::unitGrid(4, 4, 4);
    std::vector<float> values(64, 0.0f);
    for (int n = 0; n < 8; ++n)
      if (pattern >> n & 1)
        values[static_cast<std::size_t>((1 + (n & 1)) + 4 * (1 + (n >> 1 & 1)) + 16 * (1 + (n >> 2)))] = 1;
    const auto mesh = surfaceOf(*test::volumeOf(info, values), 0.4);
    ASSERT_TRUE(mesh) << pattern;
    const MeshFacts facts = meshFacts(*mesh);
    EXPECT_TRUE(facts.closed) << pattern;
    EXPECT_EQ(facts.edgesUsedOverTwice, 0u) << pattern;
    EXPECT_GT(facts.signedVolume_mm3, 0) << pattern;
    EXPECT_EQ(eulerOf(*mesh), 2 * solidEuler(pattern)) << pattern;
  }
}

TEST(IsoSurface, VerticesLieWhereTheValueIsTheLevel) {
  for (bool leftHanded : {false, true}) {
    GridGeometry g = test::unitGrid(21, 19, 17);
    g.patientFromVoxel.linear = {{0.7, 0.1, 0}, {-0.1, 0.8, 0.2}, {0.3, -0.2, leftHanded ? -1.5 : 1.5}};
    g.patientFromVoxel.translation = {-20, 30, 500};
    const auto volume = ballVolume(g);
    const auto mesh = surfaceOf(*volume, 94.5);  // 5.5 voxels from the middle
    ASSERT_TRUE(mesh);
    for (const MeshPoint& p : mesh->vertices())
      EXPECT_NEAR(sampleModality(*volume, PatientPoint(p.p)).value(), 94.5, 1e-4);
    const MeshFacts facts = meshFacts(*mesh);
    EXPECT_TRUE(facts.closed);
    EXPECT_EQ(eulerOf(*mesh), 2);
    const double volume_mm3 =
        4 * std::numbers::pi / 3 * std::pow(5.5, 3) * std::abs(glm::determinant(g.patientFromVoxel.linear));
    EXPECT_NEAR(facts.signedVolume_mm3, volume_mm3, 0.03 * volume_mm3);  // above 0: turned outwards
  }
}

TEST(IsoSurface, TrueSlicePositionsOfAnUnevenStack) {
  GridGeometry g = test::unitGrid(9, 9, 5);
  g.sliceOrigin_vox = {{0, 0, 0}, {0.25, 0, 1}, {0.5, -0.5, 2.5}, {0.75, 0, 3}, {1, 0, 6}};
  const auto volume = ballVolume(g);
  const auto mesh = surfaceOf(*volume, 98.5);
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(meshFacts(*mesh).closed);
  // Along the middle column 98, 99, 100, 99, 98: halfway between the first two slices and the last two, each
  // at its own place.
  EXPECT_NEAR(mesh->lowest().p.z, 0.5, 1e-6);
  EXPECT_NEAR(mesh->highest().p.z, 4.5, 1e-6);
  for (const MeshPoint& p : mesh->vertices())
    if (p.p.z < 0.5 + 1e-6 || p.p.z > 4.5 - 1e-6) {
      EXPECT_NEAR(p.p.x, p.p.z < 1 ? 4 + 0.125 : 4 + 0.875, 1e-6);
    }
}

TEST(IsoSurface, WhatReachesTheBorderEndsAtTheOutermostVoxelCentres) {
  VolumeInfo info;
  info.grid = test::unitGrid(5, 6, 7);
  const auto mesh = surfaceOf(*test::volumeOf(info, std::vector<std::int16_t>(5 * 6 * 7, 100)), 50);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->lowest(), MeshPoint(0, 0, 0));
  EXPECT_EQ(mesh->highest(), MeshPoint(4, 5, 6));
  const MeshFacts facts = meshFacts(*mesh);
  EXPECT_TRUE(facts.closed);
  EXPECT_EQ(eulerOf(*mesh), 2);
  EXPECT_NEAR(facts.signedVolume_mm3, 4 * 5 * 6, 1e-9);
  EXPECT_NEAR(facts.area_mm2, 2 * (4 * 5 + 4 * 6 + 5 * 6), 1e-9);
}

TEST(IsoSurface, NoDataAndGapsAreOutside) {
  VolumeInfo info;
  info.grid = test::unitGrid(7, 7, 7);
  info.noData = NoDataRange{-2000, -2000};
  std::vector<std::int16_t> values(343, 100);
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 7; ++j) values[static_cast<std::size_t>(3 + 7 * (j + 7 * k))] = -2000;  // a wall
  const auto walled = surfaceOf(*test::volumeOf(info, values), 50);
  ASSERT_TRUE(walled);
  EXPECT_TRUE(meshFacts(*walled).closed);
  EXPECT_EQ(eulerOf(*walled), 4);  // two boxes
  EXPECT_NEAR(meshFacts(*walled).signedVolume_mm3, 2 * 2 * 36, 1e-9);

  VolumeInfo gap;
  gap.grid = test::unitGrid(7, 7, 5);
  gap.grid.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 4}, {0, 0, 5}, {0, 0, 6}};
  gap.grid.gapAfter = {1};
  const auto parted = surfaceOf(*test::volumeOf(gap, std::vector<std::int16_t>(7 * 7 * 5, 100)), 50);
  ASSERT_TRUE(parted);
  EXPECT_TRUE(meshFacts(*parted).closed);
  EXPECT_NEAR(meshFacts(*parted).signedVolume_mm3, 36 * (1 + 2), 1e-9);
}

TEST(IsoSurface, D2_ASingleBrightVoxelHasASurface) {
  VolumeInfo info;
  info.grid = test::unitGrid(9, 9, 9);
  std::vector<std::uint8_t> values(729, 0);
  values[4 + 9 * (4 + 9 * 4)] = 200;
  const auto mesh = surfaceOf(*test::volumeOf(info, values), 100);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->triangles().size(), 8u);  // an octahedron
  EXPECT_NEAR(meshFacts(*mesh).signedVolume_mm3, 4.0 / 3 * 0.125, 1e-6);
}

TEST(IsoSurface, D3_AVoxelAtTheLevelIsInsideAndAPlateauHasNoHoles) {
  VolumeInfo info;
  info.grid = test::unitGrid(10, 10, 10);
  info.rescale = {{0.1, 0}};
  std::vector<std::int16_t> values(1000, 0);
  for (int k = 2; k < 8; ++k)
    for (int j = 2; j < 8; ++j)
      for (int i = 2; i < 8; ++i) values[static_cast<std::size_t>(i + 10 * (j + 10 * k))] = 3;
  // 0.1 * 3 is a hair above 0.3 in double; as floats they are equal, from above and from below.
  for (const double level : {0.3, 0.1 * 3}) {
    const auto mesh = surfaceOf(*test::volumeOf(info, values), level);
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(meshFacts(*mesh).closed);
    EXPECT_EQ(eulerOf(*mesh), 2);
    EXPECT_NEAR(meshFacts(*mesh).signedVolume_mm3, 125, 1e-4);
  }
  EXPECT_FALSE(surfaceOf(*test::volumeOf(info, values), 0.30001));
}

TEST(IsoSurface, OnlyMissingLevelsAreExtracted) {
  const auto volume = ballVolume(test::unitGrid(16, 16, 16));
  DerivedCache cache(kCache);
  const auto first = isoSurfaces(*volume, std::array{92.0, 95.0, 200.0}, cache);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(first->extracted, 3u);
  EXPECT_FALSE(first->meshes[2]);  // nothing is as high
  const auto second = isoSurfaces(*volume, std::array{92.0, 93.0, 95.0, 200.0}, cache);
  EXPECT_EQ(second->extracted, 1u);
  EXPECT_EQ(second->meshes[0], first->meshes[0]);
  EXPECT_EQ(second->meshes[2], first->meshes[1]);
  EXPECT_EQ(isoSurfaces(*volume, std::array{95.0}, cache)->extracted, 0u);
}

TEST(IsoSurface, TheSameBitsForAnyNumberOfThreads) {
  VolumeInfo info;
  info.grid = test::unitGrid(30, 25, 40);
  const auto volume = test::volumeOf(info, test::randomValues<std::int16_t>(30 * 25 * 40, 7, -100, 100));
  setThreads(1);
  const auto one = surfaceOf(*volume, 11);
  setThreads(0);
  const auto all = surfaceOf(*volume, 11);
  ASSERT_TRUE(one && all);
  // Where voxels equal the level, surfaces may touch themselves along an edge; they are closed all the same.
  EXPECT_EQ(meshFacts(*one).edgesUsedOnce, 0u);
  EXPECT_TRUE(std::ranges::equal(one->vertices(), all->vertices()));
  EXPECT_TRUE(std::ranges::equal(one->triangles(), all->triangles()));
}

TEST(IsoSurface, CancelledAndReported) {
  const auto volume = ballVolume(test::unitGrid(16, 16, 40));
  DerivedCache cache(kCache);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(isoSurfaces(*volume, std::array{92.0}, cache, stop.get_token()).error().code,
            ErrorCode::Cancelled);
  EXPECT_EQ(cache.bytes(), 0u);
  std::uint64_t calls = 0, last = 0, total = 0;
  const auto done = isoSurfaces(*volume, std::array{92.0, 95.0}, cache, {},
                                [&](std::string_view, std::uint64_t n, std::uint64_t of) {
                                  ++calls, total = of;
                                  EXPECT_EQ(n, last + 1);
                                  last = n;
                                });
  ASSERT_TRUE(done.ok());
  EXPECT_EQ(last, total);
  EXPECT_EQ(calls, 3u + 2);  // slabs of 16 layers, and levels
}

TEST(IsoSurface, TheEstimateIsOfTheRightSize) {
  const auto volume = ballVolume(test::unitGrid(40, 40, 40));
  const std::array levels{85.0, 92.0, 99.0, 150.0};
  const auto estimate = estimateIsoTriangles(*volume, levels);
  for (std::size_t i = 0; i < 2; ++i) {
    const double truth = static_cast<double>(surfaceOf(*volume, levels[i])->triangles().size());
    EXPECT_NEAR(static_cast<double>(estimate[i]), truth, 0.35 * truth);
  }
  EXPECT_EQ(estimate[3], 0u);
}

}  // namespace
}  // namespace vernier
