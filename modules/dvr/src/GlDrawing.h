// SPDX-License-Identifier: GPL-3.0-or-later
// What drawing volumes on OpenGL has in common: tables and lights as uniforms and textures, ray images, and
// how what was drawn becomes the picture. Render thread.
#pragma once
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "GlRayImages.h"
#include "vernier/gpu/Device.h"

namespace vernier::dvr {

std::string_view shaderText(std::string_view fileName);  // the files of shaders/
// "#version 330 core", the defines, then the files one after the other.
std::string shaderOf(const std::string& defines, std::initializer_list<std::string_view> files);
// A program's name, for error sentences, from what its defines switch on.
std::string programName(std::string kind, const std::string& defines);
Error drawingCancelled();

// Samples that one draw takes before the stop token is looked at again.
inline constexpr std::uint64_t kBatchReads = 400000;

// What a part of all rays came to, as it was read back: 4 floats a pixel.
struct DrawnPart {
  std::vector<float> seen;    // colour, what is left of light from behind
  std::vector<float> found;   // mm from the part's entry (-1: nothing), samples, value in texels, cells
  std::uint64_t samples = 0;  // more than stand in `found`
};

// The uniforms and textures of one job. The textures live as long as it.
class GlInputs {
 public:
  // Tables are of steps of `table_mm`.
  static Result<GlInputs> make(gpu::Device&, const GlVolumeJob&, double table_mm);
  // RGBA, NEAREST, PRE, PREINTEGRATED, FIXED, LINEAR_OPACITY, SHADED, CLASSIFY as the job needs them.
  const std::string& defines() const { return defines_; }
  void addTo(gpu::Draw&) const;  // tables, lights, values, the camera; not ray images and volume
  double table_mm() const { return table_mm_; }

 private:
  std::string defines_;
  double table_mm_ = 1;
  std::vector<gpu::Uniform> uniforms_;
  std::shared_ptr<gpu::Texture> table_, preIntegrated_;
};

// Ray images on the device.
struct RayTextures {
  gpu::Texture start, lattice;
  static Result<RayTextures> make(gpu::Device&, const GlVolumeJob&, const RayImages&);
  void addTo(gpu::Draw&) const;
};

// 1 where the greatest texel value is wanted, of extremes and of levels to be reached; -1 where the least.
float signOfExtreme(const GlVolumeJob&);

// Four vertices that cover the picture, as a strip.
Result<gpu::VertexData> wholePicture(gpu::Device&, const GlVolumeJob&);
Result<DrawnPart> readBack(gpu::Device&, const gpu::Target&);

// Joins the parts of all rays, front to back, with the tools between them. take() each part in order.
class PictureMaker {
 public:
  PictureMaker(const GlVolumeJob&, const RayParts&);
  void take(std::size_t n, const RayImages&, const DrawnPart&);
  const std::vector<float>& through() const { return through_; }
  void finish(Images&);

 private:
  void takeExtreme(std::size_t pixel, const RayImages&, const DrawnPart&);
  const GlVolumeJob& job_;
  const RayParts& parts_;
  std::vector<float> through_;
  std::vector<glm::dvec3> colour_;
  std::vector<float> depth_, values_;
  std::vector<bool> covered_;  // by a colour volume's extreme: the background does not show
  std::uint64_t samples_ = 0, cells_ = 0;
};

// What the device did since `before`, added to the picture's counters; samples are the technique's to count.
void addCounters(Counters&, const Counters& before, const Counters& after);

}  // namespace vernier::dvr
