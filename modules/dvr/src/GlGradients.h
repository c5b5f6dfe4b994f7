// SPDX-License-Identifier: GPL-3.0-or-later
// Gradient textures: made only where a scene shades, 16 bytes for each voxel. RGB is the gradient of plan's
// Scene.h at the voxel in the patient (of texel values: the slope's sign and size take no part), alpha the
// texel value or no-data. Unit: normals of length 1 that point to lower values, for combiners.
#pragma once
#include <memory>
#include <stop_token>
#include <vector>

#include "vernier/gpu/VolumePlanes.h"

namespace vernier::dvr {

inline constexpr std::uint64_t kGradientBytes = 16;
enum class GradientLength { PerMm, Unit };

// Slices or planes across an axis, as gpu::planeTexture lays them out. On all cores.
std::vector<float> gradientTexels(const Volume&, const gpu::TexelCode&, int axis, std::int64_t at,
                                  GradientLength);
Result<std::shared_ptr<const gpu::Texture>> gradientPlane(gpu::Device&, const Volume&, const gpu::TexelCode&,
                                                          int axis, std::int64_t at, GradientLength);
Result<std::shared_ptr<const gpu::Texture>> gradientVolume(gpu::Device&, const Volume&, const gpu::TexelCode&,
                                                           std::int64_t first, std::int64_t count,
                                                           GradientLength, std::stop_token);

}  // namespace vernier::dvr
