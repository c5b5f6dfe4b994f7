// SPDX-License-Identifier: GPL-3.0-or-later
// A volume as marching cubes want it: float modality values in layers, with a border of one voxel all around
// that lies below every level, so that surfaces close. A gap between slices is such a layer too, and no-data
// is such a voxel. A vertex between a voxel and what is outside falls on the voxel's centre: the border is
// so far below that nothing is left of it in a float.
#pragma once
#include <vector>

#include "vernier/volume/Mesh.h"
#include "vernier/volume/Volume.h"

namespace vernier::iso {

inline constexpr float kOutside = -3.0e38f;
// What a level is held against: both are rounded to float alike, so that a voxel that equals a level is
// inside.
float asField(double modality);

class IsoField {
 public:
  explicit IsoField(const Volume&);
  int columns() const { return columns_; }  // borders included
  int rows() const { return rows_; }
  int layers() const { return static_cast<int>(slices_.size()); }

  struct Block {
    std::vector<float> values;  // columns x rows x layers
    float least = 0, most = 0;  // of what is inside; least > most: nothing
  };
  void fill(int firstLayer, int count, Block&) const;
  // Of a vertex in columns, rows and layers of the field. True places of the slices.
  PatientPoint place(double column, double row, double layer) const;

 private:
  glm::dvec3 originOf(std::int64_t slice) const;
  const Volume& volume_;
  int columns_, rows_;
  std::vector<std::int64_t> slices_;  // of each layer; -1: outside
};

}  // namespace vernier::iso
