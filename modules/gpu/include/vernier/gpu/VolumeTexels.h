// SPDX-License-Identifier: GPL-3.0-or-later
// Voxels as GL textures, for every technique that samples a volume on GL: exact values, one texture per
// volume in the device's cache.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/gpu/Device.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Volume.h"

namespace vernier::gpu {

// 8 and 16-bit voxels are R16 textures (on software renderers R8 is slower and filters in 8 bits); 32-bit
// integers and floats are R32F, counted from the least value, NaN and padding as a number far outside.
struct VERNIER_API TexelCode {
  Format format = Format::R16;
  float scale = 65535.0f, bias = 0.0f;  // value = texel * scale - bias
  double storedBias = 0;                // the stored value that becomes 0
  double modalityAtBias = 0, slope = 1;
  double modalityRange = 0;
  float noDataFirst = 3.2e38f, noDataLast = 3.3e38f;  // none
  std::uint64_t bytes(const GridGeometry& g) const;   // of the whole volume as textures
};
// An Error says why GL textures cannot hold these voxels exactly.
VERNIER_API Result<TexelCode> texelCode(const Volume&);
// n stored values from `from` on as texels; `scratch` may hold them.
VERNIER_API std::span<const std::byte> convertedTexels(const Volume&, const TexelCode&, const std::byte* from,
                                                       std::size_t n, std::vector<std::byte>& scratch);
// One slice as texels; `scratch` may hold them.
VERNIER_API std::span<const std::byte> slicedTexels(const Volume&, const TexelCode&, std::int64_t slice,
                                                    std::vector<std::byte>& scratch);
// 8-bit weights of the card's own filter; no padding, no shifted slices.
VERNIER_API bool mayUseFixedFunction(const Volume&, Interpolation);

// GLSL that turns texels into values (weighed(texel, weight): .x weighted value, .y weight), and what it
// needs.
VERNIER_API std::string_view texelShader();
VERNIER_API void addTexelUniforms(std::vector<Uniform>&, const TexelCode&);

// Why a 3-D texture cannot hold this volume, in one sentence; "" when it can.
VERNIER_API std::string whyNotTexture3d(const Volume&, const TexelCode&, const Capabilities&);
// The whole volume, from the cache or uploaded slice by slice. OutOfMemory with numbers; Cancelled.
VERNIER_API Result<std::shared_ptr<const Texture>> volumeTexture(Device&, const Volume&, const TexelCode&,
                                                                 std::stop_token);

}  // namespace vernier::gpu
