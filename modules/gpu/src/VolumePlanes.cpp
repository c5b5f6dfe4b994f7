// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/gpu/VolumePlanes.h"

#include <cstring>

namespace vernier::gpu {
namespace {

constexpr std::size_t kColourBytes = 4;

const char* suffixOf(const Volume& v, const TexelCode& code) {
  return v.isColour() ? " rgba8" : code.format == Format::R16 ? " r16" : " r32f";
}

Format formatOf(const Volume& v, const TexelCode& code) { return v.isColour() ? Format::Rgba8 : code.format; }

std::span<const std::byte> texelsOf(const Volume& v, const TexelCode& code, std::int64_t slice,
                                    std::vector<std::byte>& scratch) {
  if (!v.isColour()) return slicedTexels(v, code, slice, scratch);
  const GridGeometry& g = v.grid();
  scratch.resize(static_cast<std::size_t>(g.columns * g.rows) * kColourBytes);
  std::size_t n = 0;
  for (std::int64_t j = 0; j < g.rows; ++j)
    for (std::int64_t i = 0; i < g.columns; ++i)
      for (const std::uint8_t c : v.rgba(i, j, slice)) scratch[n++] = static_cast<std::byte>(c);
  return scratch;
}

// Row `at` (axis 1) or column `at` (axis 0) of every slice, one slice after the other.
std::vector<std::byte> acrossSlices(const Volume& v, const TexelCode& code, int axis, std::int64_t at) {
  const GridGeometry& g = v.grid();
  const std::int64_t width = axis == 0 ? g.rows : g.columns;
  const auto size = static_cast<std::size_t>(width * g.slices);
  const auto place = [&](std::int64_t n) { return axis == 0 ? glm::i64vec2(at, n) : glm::i64vec2(n, at); };
  std::vector<std::byte> gathered, scratch;
  if (v.isColour()) {
    for (std::int64_t k = 0; k < g.slices; ++k)
      for (std::int64_t n = 0; n < width; ++n)
        for (const std::uint8_t c : v.rgba(place(n).x, place(n).y, k))
          gathered.push_back(static_cast<std::byte>(c));
    return gathered;
  }
  const std::size_t bytes = bytesOf(v.type());
  gathered.resize(size * bytes);
  std::byte* to = gathered.data();
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t n = 0; n < width; ++n, to += bytes)
      std::memcpy(
          to, v.data() + static_cast<std::size_t>(place(n).x + g.columns * (place(n).y + g.rows * k)) * bytes,
          bytes);
  if (v.type() == VoxelType::U16) return gathered;
  (void)convertedTexels(v, code, gathered.data(), size, scratch);
  return scratch;
}

Error tooLarge(const Device& device, const DeviceCache& cache, std::uint64_t bytes) {
  return makeError(ErrorCode::OutOfMemory,
                   "The volume needs " + std::to_string(bytes >> 20) + " MB as a texture and GL may hold " +
                       std::to_string(cache.limit() >> 20) + " MB.",
                   device.limits().renderer);
}

}  // namespace

std::uint64_t bytesOfTexel(const Volume& v, const TexelCode& code) {
  return v.isColour() ? kColourBytes : code.format == Format::R16 ? 2u : 4u;
}

Result<std::shared_ptr<const Texture>> slabTexture(Device& device, const Volume& volume,
                                                   const TexelCode& code, std::int64_t first,
                                                   std::int64_t count, std::stop_token stop) {
  const GridGeometry& g = volume.grid();
  const bool whole = first == 0 && count == g.slices;
  if (whole && !volume.isColour()) return volumeTexture(device, volume, code, stop);
  const std::uint64_t bytes = static_cast<std::uint64_t>(g.columns) * static_cast<std::uint64_t>(g.rows) *
                              static_cast<std::uint64_t>(count) * bytesOfTexel(volume, code);
  if (bytes > device.cache().limit()) return tooLarge(device, device.cache(), bytes);
  const std::string kind = (whole ? "volume" : "slab of " + std::to_string(count)) + suffixOf(volume, code);
  return device.cache().get({kind, volume.revision(), first}, [&]() -> Result<Texture> {
    Result<Texture> t = device.texture3d(formatOf(volume, code), static_cast<int>(g.columns),
                                         static_cast<int>(g.rows), static_cast<int>(count));
    if (!t) return t;
    std::vector<std::byte> scratch;
    for (std::int64_t k = 0; k < count; ++k) {
      if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The upload was cancelled.");
      Result<void> r =
          device.uploadSlices(*t, static_cast<int>(k), 1, texelsOf(volume, code, first + k, scratch));
      if (!r) return r.error();
    }
    return t;
  });
}

Result<std::shared_ptr<const Texture>> planeTexture(Device& device, const Volume& volume,
                                                    const TexelCode& code, int axis, std::int64_t at) {
  constexpr const char* kinds[] = {"column plane", "row plane", "slice"};
  const GridGeometry& g = volume.grid();
  return device.cache().get({std::string(kinds[axis]) + suffixOf(volume, code), volume.revision(), at}, [&] {
    std::vector<std::byte> scratch;
    if (axis != 2) scratch = acrossSlices(volume, code, axis, at);
    const std::span<const std::byte> texels =
        axis == 2 ? texelsOf(volume, code, at, scratch) : std::span<const std::byte>(scratch);
    return device.texture2d(formatOf(volume, code), static_cast<int>(axis == 0 ? g.rows : g.columns),
                            static_cast<int>(axis == 2 ? g.rows : g.slices), texels);
  });
}

}  // namespace vernier::gpu
