// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Volume.h"

#include <gmock/gmock.h>

#include <limits>

#include "Grids.h"

namespace vernier {
namespace {
using test::bufferOf;
using test::unitGrid;
using test::volumeOf;
using ::testing::HasSubstr;

TEST(Buffer, IsZeroedAlignedAndHasSlack) {
  for (std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{4096}, (std::size_t{2} << 20) - 1,
                            std::size_t{5} << 20}) {
    Result<Buffer> made = Buffer::make(bytes);
    ASSERT_TRUE(made.ok());
    const Buffer b = std::move(made).value();
    EXPECT_EQ(b.size(), bytes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(b.data()) % (bytes >= (2u << 20) ? 2u << 20 : 4096u), 0u);
    for (std::size_t i = 0; i < bytes + Buffer::kSlack; i += i < bytes ? 511 : 1)
      ASSERT_EQ(b.data()[i], std::byte{0});
  }
}

TEST(Buffer, TooMuchIsOutOfMemory) {
  for (std::size_t bytes : {std::size_t{1} << 60, std::numeric_limits<std::size_t>::max()}) {
    const Result<Buffer> made = Buffer::make(bytes);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().code, ErrorCode::OutOfMemory);
  }
}

TEST(Buffer, MovesItsMemory) {
  Buffer a = bufferOf<std::uint8_t>({1, 2, 3});
  const std::byte* const p = a.data();
  Buffer b = std::move(a);
  EXPECT_EQ(b.data(), p);
  EXPECT_EQ(a.data(), nullptr);  // NOLINT(bugprone-use-after-move)
  a = std::move(b);
  EXPECT_EQ(a.data(), p);
  EXPECT_EQ(a.size(), 3u);
}

VolumeInfo infoOf(const GridGeometry& g, VoxelType t = VoxelType::I16) {
  VolumeInfo i;
  i.grid = g;
  i.type = t;
  return i;
}

ErrorCode refusal(VolumeInfo info, std::size_t bytes) {
  auto made = Volume::make(std::move(info), bufferOf(std::vector<std::uint8_t>(bytes)));
  EXPECT_FALSE(made.ok());
  return made.ok() ? ErrorCode::Internal : made.error().code;
}

TEST(Volume, ChecksTheSize) {
  EXPECT_EQ(refusal(infoOf(unitGrid(4, 3, 2)), 47), ErrorCode::PixelDataShort);
  EXPECT_EQ(refusal(infoOf(unitGrid(4, 3, 2)), 49), ErrorCode::PixelDataShort);
  EXPECT_EQ(refusal(infoOf(unitGrid(0, 3, 2)), 0), ErrorCode::GeometryRefused);
  EXPECT_EQ(refusal(infoOf(unitGrid(4, -3, 2)), 0), ErrorCode::GeometryRefused);
  // 2^21 * 2^21 * 2^22 * 2 bytes overflow 64 bits to 2^65 = 0
  EXPECT_EQ(refusal(infoOf(unitGrid(1 << 21, 1 << 21, 1 << 22)), 0), ErrorCode::PixelDataShort);
}

TEST(Volume, ChecksTheMap) {
  GridGeometry g = unitGrid(2, 2, 2);
  const auto expectRefused = [&] { EXPECT_EQ(refusal(infoOf(g), 16), ErrorCode::GeometryRefused); };
  g.patientFromVoxel.linear[2] = {0, 0, 0};
  expectRefused();
  g.patientFromVoxel.linear[2] = {1, 1, 1e-9};
  g.patientFromVoxel.linear[0] = {1, 1, 0};
  expectRefused();
  g = unitGrid(2, 2, 2);
  g.patientFromVoxel.linear[1].x = std::nan("");
  expectRefused();
  g = unitGrid(2, 2, 2);
  g.patientFromVoxel.translation.x = INFINITY;
  expectRefused();
  g = unitGrid(2, 2, 2);
  g.patientFromVoxel.linear = glm::dmat3(1e-3, 0, 0, 0, 1e-3, 0, 0, 0, 1e-3);  // small is not flat
  EXPECT_TRUE(Volume::make(infoOf(g), bufferOf(std::vector<std::int16_t>(8))).ok());
}

TEST(Volume, ChecksSlicePositionsAndGaps) {
  GridGeometry g = unitGrid(1, 1, 3);
  const auto expectRefused = [&] { EXPECT_EQ(refusal(infoOf(g), 6), ErrorCode::GeometryRefused); };
  g.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}};
  expectRefused();
  g.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 1}};
  expectRefused();
  g.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 2}, {0, 0, 1}};
  expectRefused();
  g.sliceOrigin_vox = {{0, 0, 0}, {0, 0, 1}, {0, 0, 3}};
  for (const std::vector<std::int64_t>& gaps : {std::vector<std::int64_t>{2}, {-1}, {1, 1}, {1, 0}}) {
    g.gapAfter = gaps;
    expectRefused();
  }
  g.gapAfter = {1};
  EXPECT_TRUE(Volume::make(infoOf(g), bufferOf(std::vector<std::int16_t>(3))).ok());
  g.sliceOrigin_vox.clear();
  expectRefused();
}

TEST(Volume, ChecksRescaleAndPadding) {
  VolumeInfo i = infoOf(unitGrid(1, 1, 3));
  i.rescale = {{1, 0}, {1, 0}};
  EXPECT_EQ(refusal(i, 6), ErrorCode::RescaleInvalid);
  for (double slope : {0.0, std::nan(""), INFINITY * 1.0}) {
    i.rescale = {{slope, 0}};
    EXPECT_EQ(refusal(i, 6), ErrorCode::RescaleInvalid);
  }
  i.rescale = {{1, 0}};
  i.noData = NoDataRange{5, 4};
  EXPECT_EQ(refusal(i, 6), ErrorCode::PixelDescriptionInvalid);
}

template <class T>
class VolumeTypes : public ::testing::Test {};
using AllTypes = ::testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                  std::int32_t, float>;
TYPED_TEST_SUITE(VolumeTypes, AllTypes);

// Range against a plain loop in double, with and without padding, slices of their own slope, odd lengths.
TYPED_TEST(VolumeTypes, RangeEqualsThePlainLoop) {
  using T = TypeParam;
  const std::int64_t nx = 37, ny = 11, nz = 5;
  const double low = std::is_signed_v<T> ? -100 : 0, high = 120;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    std::vector<T> v = test::randomValues<T>(static_cast<std::size_t>(nx * ny * nz), seed, low, high);
    v[seed * 7] = std::numeric_limits<T>::lowest();
    v[seed * 31 + 400] = std::numeric_limits<T>::max();
    VolumeInfo info = infoOf(unitGrid(nx, ny, nz));
    if (seed & 1) info.rescale = {{1, 0}, {-2.5, 3}, {0.001, -7}, {1, 1}, {4, 0}};
    if (seed & 2)
      info.noData = NoDataRange{static_cast<double>(std::numeric_limits<T>::lowest()), low + 40.5};
    if (seed & 4) info.noData = NoDataRange{90, 1e300};
    double least = INFINITY, most = -INFINITY;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const double x = static_cast<double>(v[i]);
      if (info.noData && x >= info.noData->first && x <= info.noData->last) continue;
      const ModalityRescale r =
          info.rescale[info.rescale.size() == 1 ? 0 : i / static_cast<std::size_t>(nx * ny)];
      least = std::min(least, r.slope * x + r.intercept);
      most = std::max(most, r.slope * x + r.intercept);
    }
    const auto volume = volumeOf(info, v);
    ASSERT_TRUE(volume && volume->modalityRange());
    EXPECT_EQ(volume->modalityRange()->min, least) << seed;
    EXPECT_EQ(volume->modalityRange()->max, most) << seed;
    EXPECT_EQ(volume->stored(36, 10, 4), static_cast<double>(v.back()));
  }
}

TYPED_TEST(VolumeTypes, AllPaddingHasNoRange) {
  using T = TypeParam;
  VolumeInfo info = infoOf(unitGrid(5, 5, 5));
  info.noData = NoDataRange{3, 3};
  EXPECT_FALSE(volumeOf(info, std::vector<T>(125, T(3)))->modalityRange());
  EXPECT_EQ(volumeOf(info, std::vector<T>(125, T(4)))->modalityRange()->max, 4);
}

TEST(Volume, ExtremeOfTheTypeIsAValueLikeAnyOther) {
  VolumeInfo info = infoOf(unitGrid(2, 1, 1));
  info.noData = NoDataRange{0, 0};
  const auto v = volumeOf(info, std::vector<std::uint16_t>{0, 65535});
  EXPECT_EQ(v->modalityRange()->min, 65535);
  EXPECT_EQ(v->modalityRange()->max, 65535);
}

TEST(Volume, NonFiniteFloatsBecomeNaNAndAreCounted) {
  const float nan = std::nanf(""), inf = INFINITY;
  const auto v = volumeOf(infoOf(unitGrid(3, 2, 1)), std::vector<float>{1, nan, inf, -inf, inf, 5});
  ASSERT_TRUE(v);
  EXPECT_EQ(v->modalityRange()->min, 1);
  EXPECT_EQ(v->modalityRange()->max, 5);
  EXPECT_TRUE(v->isNoData(v->stored(2, 0, 0)));
  EXPECT_TRUE(v->isNoData(v->stored(0, 1, 0)));
  ASSERT_EQ(v->info().findings.size(), 1u);
  const Finding& f = v->info().findings[0];
  EXPECT_EQ(f.code, "non-finite-voxels");
  EXPECT_EQ(std::get<double>(f.numbers.at("nan")), 1);
  EXPECT_EQ(std::get<double>(f.numbers.at("plus_infinite")), 2);
  EXPECT_EQ(std::get<double>(f.numbers.at("minus_infinite")), 1);
}

TEST(Volume, ProbeGoesBackToTheOriginalStoredValues) {
  VolumeInfo info = infoOf(unitGrid(2, 1, 2), VoxelType::F32);
  OriginalVoxels original;
  original.type = VoxelType::U16;
  original.rescale = {{1.0 / 3, 0.1}, {1.0 / 7, -2}};
  original.noData = NoDataRange{9, 9};
  original.voxels = bufferOf<std::uint16_t>({1000, 9, 30001, 2});
  const float nan = std::nanf("");
  auto made = Volume::make(
      info, bufferOf<float>({float(1000 / 3.0 + 0.1), nan, float(30001 / 7.0 - 2), float(2 / 7.0 - 2)}),
      std::move(original));
  ASSERT_TRUE(made.ok());
  const Volume& v = **made;
  EXPECT_EQ(v.probe(0, 0, 0).stored, 1000);
  EXPECT_DOUBLE_EQ(v.probe(0, 0, 0).modality, 1000 / 3.0 + 0.1);
  EXPECT_TRUE(v.probe(1, 0, 0).noData);
  EXPECT_DOUBLE_EQ(v.probe(0, 0, 1).modality, 30001 / 7.0 - 2);
  EXPECT_TRUE(v.info().findings.empty());  // padding made NaN by the conversion is no finding
}

TEST(Volume, RevisionsDiffer) {
  const auto a = volumeOf(infoOf(unitGrid(1, 1, 1)), std::vector<std::uint8_t>{1});
  const auto b = volumeOf(infoOf(unitGrid(1, 1, 1)), std::vector<std::uint8_t>{1});
  EXPECT_NE(a->revision(), b->revision());
}

}  // namespace
}  // namespace vernier
