// SPDX-License-Identifier: GPL-3.0-or-later
// What is particular to strips: counters, the cache, and the paper's own interpolation.
#include "GlCases.h"

namespace vernier::mpr {
namespace {
using namespace vernier::mpr::test;
using vernier::test::everyGrid;
using vernier::test::unitGrid;

TEST(GlStrips, UploadOnlyCrossedSlicesAndNo3dTexture) {
  VERNIER_NEEDS_GL(device);
  GlHost host(device);
  const Technique strips = stripsTechnique(host);
  const auto volume = noiseVolume<std::int16_t>(unitGrid(32, 32, 40), -1000, 3000);
  // k from 10.3 to 14.8: six slices; each 2 KB.
  const SliceParams p = alignedSlice(volume, {1, 1, 10.3}, {0.5, 0, 4.5 / 59}, {0, 0.5, 0}, 60, 60);
  const std::uint64_t cached = device->cache().bytes();
  const Images first = drawn(strips, p);
  EXPECT_EQ(first.counters.textures3dCreated, 0u);
  EXPECT_EQ(device->cache().bytes() - cached, 6u * 32 * 32 * 2);
  EXPECT_GE(first.counters.bytesUploaded, 6u * 32 * 32 * 2);
  EXPECT_GE(first.counters.triangles, 2u * 5);
  EXPECT_EQ(first.counters.samples, 3600u);  // each pixel belongs to one strip

  const Images again = drawn(strips, p);
  EXPECT_EQ(again.colour, first.colour);
  EXPECT_LT(again.counters.bytesUploaded, 4096u);  // vertices only
  EXPECT_EQ(first.counters.texturesCreated - again.counters.texturesCreated, 6u);

  const Images one = drawn(strips, alignedSlice(volume, {1, 1, 20}, {0.5, 0, 0}, {0, 0.5, 0}, 60, 60));
  EXPECT_EQ(one.counters.texturesCreated - again.counters.texturesCreated, 1u);
}

TEST(GlStrips, ASlabReadsEachSliceOnceWhateverTheCacheHolds) {
  VERNIER_NEEDS_GL(device);
  GlHost host(device);
  const Technique strips = stripsTechnique(host);
  SliceParams p = randomSlice(noiseVolume<std::int16_t>(unitGrid(32, 32, 40), -1000, 3000), 3, 60, 60);
  p.slab = {5, SlabMode::Max}, p.slabSamples = 6;
  const std::uint64_t limit = device->cache().limit();
  device->cache().setLimit(4 * 32 * 32 * 2);  // four slices
  const Images tight = drawn(strips, p);
  EXPECT_LE(device->cache().bytes(), device->cache().limit());
  EXPECT_LE(tight.counters.texturesCreated, 40u + 3);  // each slice once, and the targets
  device->cache().setLimit(limit);
  const Images roomy = drawn(strips, p);
  EXPECT_EQ(tight.colour, roomy.colour);
  expectExact(strips, p, "slab");
}

TEST(GlStrips, GouraudAlphaIsTheExactAlphaUpToTheRasteriser) {
  VERNIER_NEEDS_GL(device);
  GlHost host(device);
  const Technique strips = stripsTechnique(host);
  // Voxels that count their own slice: the picture is k itself.
  VolumeInfo info;
  info.grid = unitGrid(64, 64, 16);
  std::vector<std::int16_t> v;
  for (int k = 0; k < 16; ++k) v.insert(v.end(), 64 * 64, static_cast<std::int16_t>(100 * k));
  SliceParams p =
      alignedSlice(vernier::test::volumeOf(info, v), {2, 2, 0.5}, {0.2, 0, 0.05}, {0, 0.2, 0.0}, 280, 64);
  const Images paper = drawn(strips, p, true), exact = drawn(strips, p, false);
  double worst = 0;
  for (std::size_t n = 0; n < exact.values.size(); ++n) {
    const double k = 0.5 + 0.05 * static_cast<double>(n % 280);
    EXPECT_NEAR(exact.values[n], 100 * k, 2e-3);
    worst = std::max(worst, std::abs(static_cast<double>(paper.values[n]) - 100 * k));
  }
  EXPECT_LT(worst, 100 * 0.05 / 128);  // a step of 100, 0.05 steps per pixel, 1/256 pixel
}

}  // namespace
}  // namespace vernier::mpr
