// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlGradients.h"

#include <algorithm>
#include <cmath>

#include "vernier/base/Threads.h"

namespace vernier::dvr {
namespace {

constexpr float kNoDataTexel = 3.25e38f;  // as gpu's textures of floats have it
constexpr std::size_t kGrain = 8;         // rows
// A gradient below this part of the volume's range per voxel has no direction.
constexpr double kFlat = 1e-5;

// A plane of texels: voxel = origin + u * along + v * across.
struct PlaneOfVoxels {
  glm::i64vec3 origin{0}, along{0}, across{0};
  std::int64_t width = 0, height = 0;
};
PlaneOfVoxels planeOf(const GridGeometry& g, int axis, std::int64_t at) {
  const std::int64_t size[] = {g.columns, g.rows, g.slices};
  PlaneOfVoxels p;
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  p.origin[axis] = at, p.along[u] = 1, p.across[v] = 1, p.width = size[u], p.height = size[v];
  return p;
}

class Gradients {
 public:
  Gradients(const Volume& v, const gpu::TexelCode& code, GradientLength length)
      : v_(v),
        code_(code),
        length_(length),
        toPatient_(glm::transpose(v.voxelFromPatient().linear)),
        size_(v.grid().columns, v.grid().rows, v.grid().slices),
        flat_(kFlat * code.modalityRange / std::abs(code.slope)) {}

  glm::vec4 at(glm::i64vec3 p) const {
    const double own = v_.stored(p.x, p.y, p.z);
    const bool small = code_.format == gpu::Format::R16;
    if (v_.isNoData(own)) return {0, 0, 0, small ? static_cast<float>(own - code_.storedBias) : kNoDataTexel};
    glm::dvec3 d;
    for (int axis = 0; axis < 3; ++axis)
      d[axis] = 0.5 * (besides(p, axis, 1, own) - besides(p, axis, -1, own));
    glm::dvec3 gradient = toPatient_ * d;
    if (length_ == GradientLength::Unit)
      gradient = glm::length(d) > flat_ ? -std::copysign(1.0, code_.slope) * glm::normalize(gradient)
                                        : glm::dvec3(0);
    return {glm::vec3(gradient), static_cast<float>(own - code_.storedBias)};
  }

 private:
  double besides(glm::i64vec3 p, int axis, int step, double own) const {
    p[axis] = std::clamp<std::int64_t>(p[axis] + step, 0, size_[axis] - 1);
    const double value = v_.stored(p.x, p.y, p.z);
    return v_.isNoData(value) ? own : value;
  }
  const Volume& v_;
  const gpu::TexelCode& code_;
  const GradientLength length_;
  const glm::dmat3 toPatient_;
  const glm::i64vec3 size_;
  const double flat_;
};

const char* suffixOf(GradientLength l) { return l == GradientLength::Unit ? " of normals" : " of gradients"; }

}  // namespace

std::vector<float> gradientTexels(const Volume& volume, const gpu::TexelCode& code, int axis, std::int64_t at,
                                  GradientLength length) {
  const PlaneOfVoxels plane = planeOf(volume.grid(), axis, at);
  const Gradients gradients(volume, code, length);
  std::vector<float> out(static_cast<std::size_t>(4 * plane.width * plane.height));
  parallelFor(static_cast<std::size_t>(plane.height), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      for (std::int64_t u = 0; u < plane.width; ++u) {
        const glm::vec4 g =
            gradients.at(plane.origin + u * plane.along + static_cast<std::int64_t>(v) * plane.across);
        float* const to =
            out.data() + 4 * (static_cast<std::size_t>(u) + v * static_cast<std::size_t>(plane.width));
        for (int c = 0; c < 4; ++c) to[c] = g[c];
      }
  });
  return out;
}

Result<std::shared_ptr<const gpu::Texture>> gradientPlane(gpu::Device& device, const Volume& volume,
                                                          const gpu::TexelCode& code, int axis,
                                                          std::int64_t at, GradientLength length) {
  constexpr const char* kinds[] = {"column plane", "row plane", "slice"};
  return device.cache().get({std::string(kinds[axis]) + suffixOf(length), volume.revision(), at}, [&] {
    const PlaneOfVoxels plane = planeOf(volume.grid(), axis, at);
    const std::vector<float> texels = gradientTexels(volume, code, axis, at, length);
    return device.texture2d(gpu::Format::Rgba32F, static_cast<int>(plane.width),
                            static_cast<int>(plane.height), std::as_bytes(std::span(texels)));
  });
}

Result<std::shared_ptr<const gpu::Texture>> gradientVolume(gpu::Device& device, const Volume& volume,
                                                           const gpu::TexelCode& code, std::int64_t first,
                                                           std::int64_t count, GradientLength length,
                                                           std::stop_token stop) {
  const GridGeometry& g = volume.grid();
  const std::string kind = "slab of " + std::to_string(count) + suffixOf(length);
  return device.cache().get({kind, volume.revision(), first}, [&]() -> Result<gpu::Texture> {
    Result<gpu::Texture> t = device.texture3d(gpu::Format::Rgba32F, static_cast<int>(g.columns),
                                              static_cast<int>(g.rows), static_cast<int>(count));
    if (!t) return t;
    for (std::int64_t k = 0; k < count; ++k) {
      if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "Drawing the volume was cancelled.");
      const std::vector<float> texels = gradientTexels(volume, code, 2, first + k, length);
      if (Result<void> r = device.uploadSlices(*t, static_cast<int>(k), 1, std::as_bytes(std::span(texels)));
          !r)
        return r.error();
    }
    return t;
  });
}

}  // namespace vernier::dvr
