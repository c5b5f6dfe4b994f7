// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes, frames and sources for the tests of measuring.
#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "vernier/base/Random.h"
#include "vernier/measure/Measure.h"

namespace vernier::measure::test {

inline Buffer bytesOfFloats(const std::vector<float>& values) {
  Buffer b = std::move(Buffer::make(values.size() * sizeof(float))).value();
  std::memcpy(b.data(), values.data(), values.size() * sizeof(float));
  return b;
}

// value(patient mm) at every voxel centre of the grid, as floats.
template <class Fn>
std::shared_ptr<const Volume> volumeOf(const GridGeometry& grid, Fn&& value) {
  VolumeInfo info;
  info.grid = grid;
  info.type = VoxelType::F32;
  info.seriesUid = "2.25.1";
  std::vector<float> values;
  for (std::int64_t k = 0; k < grid.slices; ++k)
    for (std::int64_t j = 0; j < grid.rows; ++j)
      for (std::int64_t i = 0; i < grid.columns; ++i) {
        const glm::dvec3 first = grid.even() ? glm::dvec3(0, 0, static_cast<double>(k))
                                             : grid.sliceOrigin_vox[static_cast<std::size_t>(k)];
        values.push_back(
            static_cast<float>(value((grid.patientFromVoxel * VoxelPoint(first + glm::dvec3(i, j, 0))).p)));
      }
  auto made = Volume::make(std::move(info), bytesOfFloats(values));
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().text());
  return *made;
}

inline GridGeometry gridOf(glm::i64vec3 size, glm::dvec3 spacing, glm::dvec3 centre = {0, 0, 0}) {
  GridGeometry g;
  g.columns = size.x, g.rows = size.y, g.slices = size.z;
  g.patientFromVoxel.linear = glm::dmat3(spacing.x, 0, 0, 0, spacing.y, 0, 0, 0, spacing.z);
  g.patientFromVoxel.translation = centre - 0.5 * spacing * (glm::dvec3(size) - 1.0);
  return g;
}

inline Sources sourcesOf(std::shared_ptr<const Volume> v) {
  Sources s;
  s.volume = [v](const std::string&) -> Result<std::shared_ptr<const Volume>> {
    if (v) return v;
    return makeError(ErrorCode::SeriesNotFound, "There is no volume.");
  };
  return s;
}

inline std::shared_ptr<const ImageFrame> frameOf(std::int64_t columns, std::int64_t rows,
                                                 const std::vector<std::int16_t>& values,
                                                 ImageFrameInfo info = {}) {
  info.columns = columns, info.rows = rows, info.type = VoxelType::I16;
  Buffer b = std::move(Buffer::make(values.size() * 2)).value();
  std::memcpy(b.data(), values.data(), values.size() * 2);
  auto made = ImageFrame::make(std::move(info), std::move(b));
  EXPECT_TRUE(made.ok());
  return *made;
}
inline Sources sourcesOf(std::shared_ptr<const ImageFrame> f, PixelCalibration c = {}) {
  Sources s;
  s.image = [f, c](const std::string&, std::int64_t) -> Result<Image> { return Image{f, c, "2.25.9"}; };
  return s;
}

inline Measurement inImage(Shape shape) {
  Measurement m;
  m.on.space = Space::Image;
  m.shape = std::move(shape);
  return m;
}
inline Measurement inPatient(Shape shape) {
  Measurement m;
  m.shape = std::move(shape);
  return m;
}

// Draws that are the same on every machine.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}
  double unit() { return randomUnit(seed_, n_++); }
  double within(double low, double high) { return low + (high - low) * unit(); }
  double normal() {
    const double u = 1 - unit();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * unit());
  }
  glm::dvec3 direction() { return glm::normalize(glm::dvec3(normal(), normal(), normal())); }

 private:
  std::uint64_t seed_, n_ = 0;
};

// A plane's axes at random.
inline Placement::Axes randomAxes(Draws& d) {
  const glm::dvec3 n = d.direction(), other = d.direction();
  return {PatientVec(n), PatientVec(glm::normalize(other - glm::dot(other, n) * n))};
}
inline glm::dvec3 rightOf(const Placement::Axes& a) { return glm::cross(a.up.v, a.normal.v); }

}  // namespace vernier::measure::test
