// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/CompareVolumes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

namespace vernier::measure {
namespace {

using Field = std::function<double(double, double, double)>;

// Stored values are the field at the voxel's place, rounded; slope 2, intercept -100.
std::shared_ptr<const Volume> volume(const Field& f, glm::dvec3 origin = {0, 0, 0},
                                     glm::dvec3 spacing = {0.8, 1.25, 3}, const std::string& unit = "HU") {
  VolumeInfo info;
  info.grid.columns = 12, info.grid.rows = 10, info.grid.slices = 7;
  info.grid.patientFromVoxel.linear = glm::dmat3(spacing.x, 0, 0, 0, spacing.y, 0, 0, 0, spacing.z);
  info.grid.patientFromVoxel.translation = origin;
  info.rescale = {ModalityRescale{2, -100}};
  info.noData = NoDataRange{-2000, -2000};
  info.unit = unit;
  auto buffer = Buffer::make(12 * 10 * 7 * 2);
  EXPECT_TRUE(buffer.ok());
  std::size_t n = 0;
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 12; ++i, ++n) {
        const glm::dvec3 p = origin + spacing * glm::dvec3(i, j, k);
        const auto v = static_cast<std::int16_t>(std::lround(f(p.x, p.y, p.z)));
        std::memcpy(buffer->data() + 2 * n, &v, 2);
      }
  auto made = Volume::make(info, std::move(*buffer));
  EXPECT_TRUE(made.ok());
  return *made;
}

double smooth(double x, double y, double z) { return 10 * x + 7 * y + 20 * z + 100; }

TEST(CompareVolumes, IdenticalIsExactlyZero) {
  const auto a = volume(smooth), b = volume(smooth);
  const auto d = compareVolumes(*a, *b);
  ASSERT_TRUE(d.ok());
  EXPECT_FALSE(d->resampled);
  EXPECT_EQ(d->all.compared, 840u);
  EXPECT_EQ(d->all.max, 0);
  EXPECT_EQ(d->all.rmse, 0);
  EXPECT_EQ(d->all.unmatched, 0u);
}

TEST(CompareVolumes, EachSliceAgainstLongDouble) {
  const auto f = [](double x, double y, double z) { return 300 * std::sin(x * y + z); };
  const auto g = [](double x, double y, double z) { return 300 * std::cos(x + y * z); };
  const auto a = volume(f), b = volume(g);
  const auto d = compareVolumes(*a, *b);
  ASSERT_TRUE(d.ok());
  ASSERT_EQ(d->slices.size(), 7u);
  for (int k = 0; k < 7; ++k) {
    long double sum = 0, squares = 0, most = 0, bias = 0;
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 12; ++i) {
        const double x = 0.8 * i, y = 1.25 * j, z = 3 * k;
        const long double e =
            2 * (static_cast<long double>(std::lround(g(x, y, z))) - std::lround(f(x, y, z)));
        sum += std::fabs(e), squares += e * e, bias += e, most = std::max(most, std::fabs(e));
      }
    const VoxelDifference& s = d->slices[static_cast<std::size_t>(k)];
    EXPECT_EQ(s.compared, 120u);
    EXPECT_EQ(s.max, static_cast<double>(most));
    EXPECT_NEAR(s.mean, static_cast<double>(sum / 120), 1e-9);
    EXPECT_NEAR(s.bias, static_cast<double>(bias / 120), 1e-9);
    EXPECT_NEAR(s.rmse, static_cast<double>(std::sqrt(squares / 120)), 1e-9);
  }
}

TEST(CompareVolumes, PaddingIsCountedNotCompared) {
  const auto hole = [](double x, double y, double z) { return x < 1 && z < 1 ? -2000 : smooth(x, y, z); };
  const auto d = compareVolumes(*volume(smooth), *volume(hole));
  ASSERT_TRUE(d.ok());
  EXPECT_EQ(d->all.unmatched, 20u);  // two columns of ten in the first slice
  EXPECT_EQ(d->slices[0].unmatched, 20u);
  EXPECT_EQ(d->all.max, 0);
}

TEST(CompareVolumes, AnOffsetOfWholeVoxelsAndAnotherOriginAreExact) {
  // The same field of the patient on a lattice that begins elsewhere: where both have data nothing differs.
  const glm::dvec3 spacing{0.8, 1.25, 3};
  const auto a = volume(smooth), b = volume(smooth, spacing * glm::dvec3(2, -1, 1));
  const auto d = compareVolumes(*a, *b);
  ASSERT_TRUE(d.ok());
  EXPECT_TRUE(d->resampled);
  EXPECT_LT(d->all.max, 1e-9);
  EXPECT_EQ(d->all.compared, 10u * 9 * 6);
  EXPECT_EQ(d->all.unmatched, 840u - 540);
  // What stands 1.5 mm further along z in B is found by its offset.
  const auto moved = volume([](double x, double y, double z) { return smooth(x, y, z - 3); });
  const auto e = compareVolumes(*a, *moved, PatientVec(0, 0, 3));
  ASSERT_TRUE(e.ok());
  EXPECT_LT(e->all.max, 1e-9);
  EXPECT_GT(compareVolumes(*a, *moved)->all.max, 100);
}

TEST(CompareVolumes, OtherUnitsAreRefused) {
  EXPECT_FALSE(compareVolumes(*volume(smooth), *volume(smooth, {0, 0, 0}, {0.8, 1.25, 3}, "BQML")).ok());
}

}  // namespace
}  // namespace vernier::measure
