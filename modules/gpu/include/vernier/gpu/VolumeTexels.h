// SPDX-License-Identifier: GPL-3.0-or-later
// How voxels become texels, the same for every technique, so that they share textures in the device's cache.
// 8 and 16-bit voxels are R16 textures (on software renderers R8 is slower and filters in 8 bits); 32-bit
// integers and floats are R32F, counted from the least value, NaN and padding as a number far outside. Colour
// volumes are RGBA8. Render thread only, but for the pure functions.
#pragma once
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

// Of a grey volume: value = texel * scale - bias, rounded to a whole number first where scale > 0; modality =
// slope * value + modalityAtBias.
struct TexelCode {
  Format format = Format::R16;
  float scale = 65535.0f, bias = 0.0f;
  double storedBias = 0;  // the stored value that becomes 0
  double modalityAtBias = 0, slope = 1;
  double modalityRange = 0;
  float noDataFirst = 3.2e38f, noDataLast = 3.3e38f;  // none
  // Of the whole volume as textures.
  VERNIER_API std::uint64_t bytes(const GridGeometry& g) const;
};
// NoTechnique, with the sentence, where GL textures cannot hold these voxels exactly. Pure.
VERNIER_API Result<TexelCode> texelCode(const Volume&);
// One slice as texels; `scratch` may hold them. Pure.
VERNIER_API std::span<const std::byte> slicedTexels(const Volume&, const TexelCode&, std::int64_t slice,
                                                    std::vector<std::byte>& scratch);
// The card's filter has weights of 8 bits and knows neither padding nor shifted slices. Pure.
VERNIER_API bool mayUseFixedFunction(const Volume&, Interpolation);

// GLSL that turns texels of grey volumes into values (weighed(texel, weight): .x weighted value, .y weight),
// and what it needs.
VERNIER_API std::string_view texelShader();
VERNIER_API void addTexelUniforms(std::vector<Uniform>&, const TexelCode&);

// Why one 3-D texture cannot hold this grey volume, in one sentence; "" when it can. Pure.
VERNIER_API std::string whyNotTexture3d(const Volume&, const TexelCode&, const Capabilities&);

// Slices first .. first + count - 1 as a 3-D texture, of a colour volume as RGBA8 (then `code` takes no
// part). Kept in the device's cache. OutOfMemory, with the numbers, where it exceeds what the cache may hold;
// Cancelled.
VERNIER_API Result<std::shared_ptr<const Texture>> volumeTexture(Device&, const Volume&, const TexelCode&,
                                                                 std::int64_t first, std::int64_t count,
                                                                 std::stop_token);
inline Result<std::shared_ptr<const Texture>> volumeTexture(Device& device, const Volume& volume,
                                                            const TexelCode& code, std::stop_token stop) {
  return volumeTexture(device, volume, code, 0, volume.grid().slices, std::move(stop));
}
// The plane `at` across axis 0, 1 or 2 (columns, rows, slices), kept in the cache likewise. Width and height
// are the extents along the axes that follow in the order x, y, z: (y, z), (x, z) or (x, y).
VERNIER_API Result<std::shared_ptr<const Texture>> planeTexture(Device&, const Volume&, const TexelCode&,
                                                                int axis, std::int64_t at);

}  // namespace vernier::gpu
