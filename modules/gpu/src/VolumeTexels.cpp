// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/gpu/VolumeTexels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier::gpu {

std::string_view embeddedShader(std::string_view fileName);  // the files of shaders/

namespace {

constexpr double kExactInFloat = 16777216.0;  // 2^24
constexpr double kLargestFloat = 1e37;
constexpr float kNoDataTexel = 3.25e38f;

struct StoredRange {
  double first = 0, last = 0;
};

// Stored values without padding, from the modality range.
std::optional<StoredRange> storedRange(const Volume& v) {
  const auto m = v.modalityRange();
  if (!m) return std::nullopt;
  const ModalityRescale& r = v.rescaleOf(0);
  const double a = (m->min - r.intercept) / r.slope, b = (m->max - r.intercept) / r.slope;
  return StoredRange{std::min(a, b), std::max(a, b)};
}

double leastOfType(VoxelType t) {
  switch (t) {
    case VoxelType::I8:
      return -128;
    case VoxelType::I16:
      return -32768;
    default:
      return 0;
  }
}

bool isSmall(VoxelType t) {
  return t == VoxelType::U8 || t == VoxelType::I8 || t == VoxelType::U16 || t == VoxelType::I16;
}

// The type's least value becomes texel 0.
template <class T>
void toR16(const std::byte* from, std::size_t n, std::uint16_t* to) {
  constexpr int kLeast = std::numeric_limits<T>::min();
  const T* v = reinterpret_cast<const T*>(from);
  for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<std::uint16_t>(static_cast<int>(v[i]) - kLeast);
}

template <class T>
void toR32F(const Volume& volume, double storedBias, const std::byte* from, std::size_t n, float* to) {
  const T* v = reinterpret_cast<const T*>(from);
  for (std::size_t i = 0; i < n; ++i) {
    const double stored = static_cast<double>(v[i]);
    to[i] = volume.isNoData(stored) ? kNoDataTexel : static_cast<float>(stored - storedBias);
  }
}

}  // namespace

std::uint64_t TexelCode::bytes(const GridGeometry& g) const {
  return static_cast<std::uint64_t>(g.columns) * static_cast<std::uint64_t>(g.rows) *
         static_cast<std::uint64_t>(g.slices) * (format == Format::R16 ? 2u : 4u);
}

Result<TexelCode> texelCode(const Volume& v) {
  if (v.info().rescale.size() > 1)
    return makeError(ErrorCode::NoTechnique,
                     "The slices have different slopes, which GL textures do not keep apart.");
  const ModalityRescale& r = v.rescaleOf(0);
  const StoredRange range = storedRange(v).value_or(StoredRange{});
  TexelCode code;
  code.slope = r.slope;
  code.modalityRange = std::abs(r.slope) * (range.last - range.first);
  if (isSmall(v.type())) {
    const double least = leastOfType(v.type());
    code.storedBias = std::clamp(std::nearbyint(range.first), least, least + 65535.0);
    code.bias = static_cast<float>(code.storedBias - least);
    if (v.info().noData) {
      code.noDataFirst = static_cast<float>(std::max(v.info().noData->first, -1e6) - code.storedBias);
      code.noDataLast = static_cast<float>(std::min(v.info().noData->last, 1e6) - code.storedBias);
    }
  } else {
    if (v.type() != VoxelType::F32 && range.last - range.first > kExactInFloat)
      return makeError(ErrorCode::NoTechnique,
                       "The 32-bit values span more than 2^24, which GL textures cannot hold exactly.");
    if (!(std::abs(range.first) <= kLargestFloat && std::abs(range.last) <= kLargestFloat))
      return makeError(ErrorCode::NoTechnique, "The values are too large for GL textures (above 1e37).");
    code.format = Format::R32F;
    code.scale = 0.0f;
    code.storedBias = v.type() == VoxelType::F32 ? range.first : std::nearbyint(range.first);
    code.noDataFirst = 1e38f, code.noDataLast = std::numeric_limits<float>::max();
  }
  code.modalityAtBias = r.slope * code.storedBias + r.intercept;
  if (!(std::abs(r.slope) <= kLargestFloat && code.modalityRange <= kLargestFloat))
    return makeError(ErrorCode::NoTechnique, "The modality values are too large for GL (above 1e37).");
  return code;
}

std::span<const std::byte> convertedTexels(const Volume& v, const TexelCode& code, const std::byte* from,
                                           std::size_t n, std::vector<std::byte>& scratch) {
  if (v.type() == VoxelType::U16) return {from, 2 * n};
  scratch.resize(n * (code.format == Format::R16 ? 2 : 4));
  auto* r16 = reinterpret_cast<std::uint16_t*>(scratch.data());
  auto* r32f = reinterpret_cast<float*>(scratch.data());
  switch (v.type()) {
    case VoxelType::U8:
      toR16<std::uint8_t>(from, n, r16);
      break;
    case VoxelType::I8:
      toR16<std::int8_t>(from, n, r16);
      break;
    case VoxelType::I16:
      toR16<std::int16_t>(from, n, r16);
      break;
    case VoxelType::U32:
      toR32F<std::uint32_t>(v, code.storedBias, from, n, r32f);
      break;
    case VoxelType::I32:
      toR32F<std::int32_t>(v, code.storedBias, from, n, r32f);
      break;
    case VoxelType::F32:
      toR32F<float>(v, code.storedBias, from, n, r32f);
      break;
    case VoxelType::U16:
      break;
  }
  return scratch;
}

std::span<const std::byte> slicedTexels(const Volume& v, const TexelCode& code, std::int64_t slice,
                                        std::vector<std::byte>& scratch) {
  const std::size_t n = static_cast<std::size_t>(v.grid().columns) * static_cast<std::size_t>(v.grid().rows);
  return convertedTexels(v, code, v.data() + static_cast<std::size_t>(slice) * n * bytesOf(v.type()), n,
                         scratch);
}

bool mayUseFixedFunction(const Volume& v, Interpolation interpolation) {
  if (interpolation != Interpolation::Linear || !isSmall(v.type()) || v.info().noData) return false;
  return std::all_of(v.grid().sliceOrigin_vox.begin(), v.grid().sliceOrigin_vox.end(),
                     [](const glm::dvec3& o) { return std::abs(o.x) + std::abs(o.y) < 1e-9; });
}

std::string_view texelShader() { return embeddedShader("texels.glsl"); }

void addTexelUniforms(std::vector<Uniform>& u, const TexelCode& code) {
  u.push_back({"texelScale", code.scale});
  u.push_back({"texelBias", code.bias});
  u.push_back({"noDataFirst", code.noDataFirst});
  u.push_back({"noDataLast", code.noDataLast});
  u.push_back({"slope", static_cast<float>(code.slope)});
}

std::string whyNotTexture3d(const Volume& volume, const TexelCode& code, const Capabilities& c) {
  const GridGeometry& g = volume.grid();
  if (!g.even())
    return "The slices are unevenly spaced or have gaps, and a 3-D texture knows even spacing only.";
  const std::int64_t largest = std::max({g.columns, g.rows, g.slices});
  if (largest > c.max3dTexture)
    return "The volume has " + std::to_string(largest) + " voxels on a side; 3-D textures here take up to " +
           std::to_string(c.max3dTexture) + ".";
  if (code.bytes(g) > c.glTextureBudget_bytes)
    return "The volume needs " + std::to_string(code.bytes(g) >> 20) + " MB as a texture and GL may hold " +
           std::to_string(c.glTextureBudget_bytes >> 20) + " MB.";
  return {};
}

Result<std::shared_ptr<const Texture>> volumeTexture(Device& device, const Volume& volume,
                                                     const TexelCode& code, std::stop_token stop) {
  const GridGeometry& g = volume.grid();
  if (code.bytes(g) > device.cache().limit())
    return makeError(ErrorCode::OutOfMemory, "The volume needs " + std::to_string(code.bytes(g) >> 20) +
                                                 " MB as a texture and GL may hold " +
                                                 std::to_string(device.cache().limit() >> 20) + " MB.");
  const char* kind = code.format == Format::R16 ? "volume r16" : "volume r32f";
  return device.cache().get({kind, volume.revision(), 0}, [&]() -> Result<Texture> {
    Result<Texture> t = device.texture3d(code.format, static_cast<int>(g.columns), static_cast<int>(g.rows),
                                         static_cast<int>(g.slices));
    if (!t) return t;
    std::vector<std::byte> scratch;
    for (std::int64_t k = 0; k < g.slices; ++k) {
      if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The volume's upload was cancelled.");
      Result<void> r =
          device.uploadSlices(*t, static_cast<int>(k), 1, slicedTexels(volume, code, k, scratch));
      if (!r) return r.error();
    }
    return t;
  });
}

}  // namespace vernier::gpu
