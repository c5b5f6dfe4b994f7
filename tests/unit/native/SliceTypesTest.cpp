// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of every sample type on every grid, against the truth in double.
#include "SliceVolumes.h"
#include "vernier/native/Slice.h"

namespace vernier::test {
namespace {

template <class T>
class SliceOfType : public testing::Test {};
using Types = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                             std::int32_t, float>;
TYPED_TEST_SUITE(SliceOfType, Types);

TYPED_TEST(SliceOfType, RandomPlanesAreWithinTheBoundOnEveryGrid) {
  std::uint64_t seed = 0;
  std::vector<NamedGrid> grids = evenGrids();
  for (const NamedGrid& g : everyGrid())
    if (!g.grid.even()) grids.push_back(g);
  for (const NamedGrid& g : grids) {
    const auto volume = randomVolume<TypeParam>(g.grid, ++seed);
    for (const Interpolation i : {Interpolation::Linear, Interpolation::Cubic, Interpolation::Nearest}) {
      if (i != Interpolation::Cubic) ++seed;  // cubic: the plane of linear again
      native::SliceJob job = randomJob(*volume, seed, 67, 45);
      job.interpolation = i;
      expectWithinBound(job, g.name);
      job.picture.right = 0.2 * job.picture.right;  // magnified: less than a voxel per pixel
      job.picture.down = 0.2 * job.picture.down;
      job.picture.origin =
          PatientPoint(g.grid.centre().p - 30.0 * job.picture.right.v - 20.0 * job.picture.down.v);
      expectWithinBound(job, g.name + " magnified");
    }
  }
}

TYPED_TEST(SliceOfType, SlabsAreTheSamplesPutTogether) {
  std::uint64_t seed = 100;
  for (const NamedGrid& g : everyGrid()) {
    const auto volume = randomVolume<TypeParam>(g.grid, ++seed);
    for (const SlabMode mode : {SlabMode::Max, SlabMode::Min, SlabMode::Mean}) {
      native::SliceJob job = randomJob(*volume, ++seed, 40, 37);
      job.slab = {6.0, mode};
      job.slabSamples = 11;
      expectWithinBound(job, g.name);
      job.interpolation = Interpolation::Cubic;
      expectWithinBound(job, g.name + " cubic");
      job.interpolation = Interpolation::Nearest;
      expectWithinBound(job, g.name + " nearest");
    }
  }
}

TYPED_TEST(SliceOfType, PaddingIsLeftOutAndItsNeighboursRenormalised) {
  using T = TypeParam;
  std::uint64_t seed = 200;
  for (const NamedGrid& g : everyGrid()) {
    VolumeInfo info;
    info.grid = g.grid;
    info.rescale = {{2, -100}};
    const auto n = static_cast<std::size_t>(g.grid.columns * g.grid.rows * g.grid.slices);
    std::vector<T> values = randomValues<T>(n, ++seed, 20, 120);
    for (std::size_t i = 0; i < n; ++i)
      if (randomUnit(seed, 1000 + i) < 0.3)
        values[i] = std::is_floating_point_v<T> && i % 2 ? static_cast<T>(NAN) : static_cast<T>(5 + i % 3);
    info.noData = NoDataRange{5, 7};
    const auto volume = volumeOf<T>(info, values);
    native::SliceJob job = randomJob(*volume, ++seed, 61, 48);
    expectWithinBound(job, g.name);
    job.interpolation = Interpolation::Nearest;
    expectWithinBound(job, g.name + " nearest");
    job.interpolation = Interpolation::Cubic;
    expectWithinBound(job, g.name + " cubic");
    job.interpolation = Interpolation::Linear;
    job.slabSamples = 5;
    for (const SlabMode mode : {SlabMode::Max, SlabMode::Min, SlabMode::Mean}) {
      job.slab = {4.0, mode};
      expectWithinBound(job, g.name + " slab");
    }
  }
}

// C1: a plane through voxel centres shows the stored values bit by bit, in all three directions and both
// senses.
TYPED_TEST(SliceOfType, AxisAlignedAtVoxelCentresIsBitEqual) {
  for (const NamedGrid& g : evenGrids()) {
    const auto volume = randomVolume<TypeParam>(g.grid, 7);
    const glm::dmat3& m = g.grid.patientFromVoxel.linear;
    const glm::ivec3 n(g.grid.columns, g.grid.rows, g.grid.slices);
    for (int axis = 0; axis < 3; ++axis) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      for (int slice = 0; slice < n[axis]; ++slice) {
        native::SliceJob job;
        job.volume = volume.get();
        job.width_px = n[a];
        job.height_px = n[b];
        job.picture.right = PatientVec(m[a]);
        job.picture.down = PatientVec(-m[b]);
        glm::dvec3 corner(0);
        corner[axis] = slice;
        corner[a] = -0.5;
        corner[b] = n[b] - 0.5;
        job.picture.origin = g.grid.patientFromVoxel * Point<VoxelFrame>(corner);
        job.window = {0, 100, VoiFunction::LinearExact, ""};
        job.interpolation = slice % 2 ? Interpolation::Linear : Interpolation::Cubic;
        Images images = imagesFor(job);
        ASSERT_TRUE(native::drawSlice(job, images).ok());
        for (int y = 0; y < n[b]; ++y)
          for (int x = 0; x < n[a]; ++x) {
            glm::ivec3 voxel;
            voxel[axis] = slice, voxel[a] = x, voxel[b] = n[b] - 1 - y;
            ASSERT_EQ(images.values[static_cast<std::size_t>(y * n[a] + x)],
                      static_cast<float>(volume->modality(voxel.x, voxel.y, voxel.z)))
                << g.name << " axis " << axis << " slice " << slice << " pixel " << x << "," << y;
          }
      }
    }
  }
}

}  // namespace
}  // namespace vernier::test
