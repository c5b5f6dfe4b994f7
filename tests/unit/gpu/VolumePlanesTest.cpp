// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/gpu/VolumePlanes.h"

#include <gmock/gmock.h>

#include "../volume/Grids.h"
#include "GlForTest.h"

namespace vernier::gpu {
namespace {
using namespace vernier::test;
using testing::HasSubstr;

std::int64_t place(int axis, std::int64_t at, std::int64_t u, std::int64_t v, const GridGeometry& g) {
  const std::int64_t i = axis == 0 ? at : u, j = axis == 1 ? at : axis == 0 ? u : v, k = axis == 2 ? at : v;
  return i + g.columns * (j + g.rows * k);
}

// Planes across each axis hold the voxels that lie there, of types that are converted and such that are not.
template <class T>
void planesOf(Device& device) {
  VolumeInfo info;
  info.grid = unitGrid(5, 4, 3);
  const auto values = randomValues<T>(60, 9, 0, 100);
  const auto volume = volumeOf(info, values);
  const TexelCode code = *texelCode(*volume);
  const std::int64_t size[] = {5, 4, 3};
  for (int axis = 0; axis < 3; ++axis)
    for (std::int64_t at = 0; at < size[axis]; ++at) {
      const auto t = planeTexture(device, *volume, code, axis, at);
      ASSERT_TRUE(t.ok()) << t.error().text();
      const int w = (*t)->width(), h = (*t)->height();
      ASSERT_EQ(w, size[axis == 0 ? 1 : 0]);
      ASSERT_EQ(h, size[axis == 2 ? 1 : 2]);
      std::vector<std::uint16_t> texels(static_cast<std::size_t>(w * h));
      ASSERT_TRUE(device.readTexture(**t, std::as_writable_bytes(std::span(texels))).ok());
      for (int v = 0; v < h; ++v)
        for (int u = 0; u < w; ++u) {
          const double texel = texels[static_cast<std::size_t>(u + w * v)];
          EXPECT_EQ(texel - static_cast<double>(code.bias) + code.storedBias,
                    static_cast<double>(values[static_cast<std::size_t>(place(axis, at, u, v, info.grid))]));
        }
    }
}

TEST(VolumePlanes, HoldTheVoxelsThatLieThere) {
  VERNIER_NEEDS_GL(device);
  planesOf<std::int16_t>(*device);
  planesOf<std::uint16_t>(*device);
  planesOf<std::uint8_t>(*device);
}

TEST(VolumePlanes, ColoursAndSlabs) {
  VERNIER_NEEDS_GL(device);
  VolumeInfo info;
  info.grid = unitGrid(5, 4, 3);
  std::vector<std::byte> bytes(240);
  for (std::size_t n = 0; n < bytes.size(); ++n) bytes[n] = static_cast<std::byte>(n);
  const auto colours = *Volume::makeColour(info, 4, bytes);
  EXPECT_EQ(bytesOfTexel(*colours, {}), 4u);
  const auto plane = planeTexture(*device, *colours, {}, 1, 2);
  std::vector<std::byte> back(60);
  ASSERT_TRUE(device->readTexture(**plane, back).ok());
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 5; ++i)
      EXPECT_EQ(back[static_cast<std::size_t>(4 * (i + 5 * k))],
                bytes[static_cast<std::size_t>(4 * place(1, 2, i, k, info.grid))]);
  const std::uint64_t before = device->counters().textures3dCreated;
  const auto slab = slabTexture(*device, *colours, {}, 1, 2, {});
  std::vector<std::byte> two(160);
  ASSERT_TRUE(device->readTexture(**slab, two).ok());
  EXPECT_TRUE(std::equal(two.begin(), two.end(), bytes.begin() + 80));
  EXPECT_TRUE(slabTexture(*device, *colours, {}, 1, 2, {}).ok());
  EXPECT_EQ(device->counters().textures3dCreated - before, 1u);  // the cache has it
  const std::uint64_t limit = device->cache().limit();
  device->cache().setLimit(100);
  const auto refused = slabTexture(*device, *colours, {}, 0, 2, {});
  device->cache().setLimit(limit);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::OutOfMemory);
}

}  // namespace
}  // namespace vernier::gpu
