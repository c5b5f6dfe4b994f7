// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cstring>
#include <numeric>
#include <vector>

#include "GlForTest.h"
#include "GpuTestShaders.h"

namespace vernier::gpu {
namespace {
using namespace vernier::gpu::test;
using testing::HasSubstr;

template <class T>
std::span<const std::byte> bytesOf(const std::vector<T>& v) {
  return std::as_bytes(std::span(v));
}

template <class T>
void roundTrip(Device& d, Format format, int w, int h, const std::vector<T>& texels) {
  auto t = d.texture2d(format, w, h, bytesOf(texels));
  ASSERT_TRUE(t.ok()) << t.error().text();
  EXPECT_EQ(t->bytes(), texels.size() * sizeof(T));
  std::vector<T> back(texels.size());
  ASSERT_TRUE(d.readTexture(*t, std::as_writable_bytes(std::span(back))).ok());
  EXPECT_EQ(std::memcmp(back.data(), texels.data(), texels.size() * sizeof(T)), 0);
}

TEST(Texture, EveryFormatComesBackBitByBit) {
  VERNIER_NEEDS_GL(device);
  std::vector<std::uint8_t> r8(256);
  std::iota(r8.begin(), r8.end(), std::uint8_t{0});
  roundTrip(*device, Format::R8, 16, 16, r8);
  roundTrip(*device, Format::Rgba8, 8, 8, r8);
  std::vector<std::uint16_t> r16(65536);
  std::iota(r16.begin(), r16.end(), std::uint16_t{0});
  roundTrip(*device, Format::R16, 256, 256, r16);
  roundTrip(*device, Format::R16, 3, 5, std::vector<std::uint16_t>(15, 40000));  // rows of odd length
  // -32768 and -32767 are the same number in this format, so it is left out.
  std::vector<std::int16_t> snorm(65535);
  for (std::size_t n = 0; n < snorm.size(); ++n)
    snorm[n] = static_cast<std::int16_t>(static_cast<int>(n) - 32767);
  roundTrip(*device, Format::R16Snorm, 257, 255, snorm);
  roundTrip(*device, Format::R32F, 2, 2, std::vector<float>{1.0e-30f, -3.0e38f, 16777215.0f, 0.1f});
  roundTrip(*device, Format::Rgba32F, 1, 1, std::vector<float>{0.1f, -2.0f, 3.0e7f, 1.0e-9f});
}

TEST(Texture, ThreeDimensionsBySlices) {
  VERNIER_NEEDS_GL(device);
  const Counters before = device->counters();
  auto t = device->texture3d(Format::R16, 5, 3, 4);
  ASSERT_TRUE(t.ok());
  std::vector<std::uint16_t> all(60), slice(15), back(60);
  std::iota(all.begin(), all.end(), std::uint16_t{7});
  for (int k = 0; k < 4; ++k) {
    std::copy_n(all.begin() + 15 * k, 15, slice.begin());
    ASSERT_TRUE(device->uploadSlices(*t, k, 1, bytesOf(slice)).ok());
  }
  ASSERT_TRUE(device->readTexture(*t, std::as_writable_bytes(std::span(back))).ok());
  EXPECT_EQ(back, all);
  EXPECT_EQ(device->counters().textures3dCreated - before.textures3dCreated, 1u);
  EXPECT_EQ(device->counters().bytesUploaded - before.bytesUploaded, 120u);
  EXPECT_FALSE(device->uploadSlices(*t, 4, 1, bytesOf(slice)).ok());
  EXPECT_FALSE(device->uploadSlices(*t, 0, 2, bytesOf(slice)).ok());
}

TEST(Texture, TooLargeIsRefusedWithTheLimit) {
  VERNIER_NEEDS_GL(device);
  const int over = device->limits().max3d + 1;
  const auto t = device->texture3d(Format::R8, over, 1, 1);
  ASSERT_FALSE(t.ok());
  EXPECT_EQ(t.error().code, ErrorCode::GlFailed);
  EXPECT_THAT(t.error().sentence, HasSubstr(std::to_string(device->limits().max3d)));
  EXPECT_FALSE(device->texture2d(Format::R8, device->limits().max2d + 1, 1, {}).ok());
  EXPECT_FALSE(device->texture2d(Format::R8, 0, 1, {}).ok());
  EXPECT_TRUE(device->finish().ok());
}

TEST(DeviceCache, KeepsWithinItsLimitAndDropsTheOldest) {
  VERNIER_NEEDS_GL(device);
  DeviceCache cache(3 * 100);
  int made = 0;
  const auto get = [&](std::int64_t index) {
    const auto t = cache.get({"test", 1, index}, [&] {
      ++made;
      return device->texture2d(Format::R8, 10, 10, bytesOf(std::vector<std::uint8_t>(100, 1)));
    });
    EXPECT_TRUE(t.ok());
    return *t;
  };
  const auto first = get(0);
  get(1), get(2);
  EXPECT_EQ(made, 3);
  EXPECT_EQ(get(0), first);  // and it is now the youngest
  get(3);                    // drops 1
  EXPECT_EQ(made, 4);
  EXPECT_EQ(cache.bytes(), 300u);
  get(0), get(2);
  EXPECT_EQ(made, 4);
  get(1);
  EXPECT_EQ(made, 5);
  cache.setLimit(99);
  EXPECT_EQ(cache.bytes(), 0u);
  get(1);  // larger than the limit: given, not kept
  EXPECT_EQ(cache.bytes(), 0u);
  EXPECT_EQ(first->width(), 10);  // still held by us
}

TEST(DeviceCache, AFailureIsNotKept) {
  DeviceCache cache(100);
  const auto failed =
      cache.get({"test", 1, 1}, []() -> Result<Texture> { return makeError(ErrorCode::GlFailed, "no"); });
  EXPECT_FALSE(failed.ok());
  EXPECT_EQ(cache.bytes(), 0u);
}

}  // namespace
}  // namespace vernier::gpu
