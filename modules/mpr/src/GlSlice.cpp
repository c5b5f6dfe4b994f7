// SPDX-License-Identifier: GPL-3.0-or-later
#include "GlSlice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "SamplingError.h"
#include "vernier/volume/Voi.h"

namespace vernier::mpr {
namespace {

constexpr double kLargestVoxel = 4194304.0;  // 2^22: whole numbers stay exact in float, with room to add

double floatBits(double v, int bits) {
  // v with `bits` significant bits, the rest cut off.
  if (v == 0) return 0;
  int exponent = 0;
  std::frexp(v, &exponent);
  const double unit = std::ldexp(1.0, exponent - bits);
  return std::trunc(v / unit) * unit;
}

struct Split {
  glm::vec3 head, tail;
};
// The head times any whole number up to `largest` is exact in float.
Split splitFor(glm::dvec3 v, int largest) {
  const int bits = 24 - static_cast<int>(std::ceil(std::log2(std::max(largest, 2) + 1.0)));
  Split s{};
  for (int axis = 0; axis < 3; ++axis) {
    const double head = floatBits(v[axis], bits);
    s.head[axis] = static_cast<float>(head);
    s.tail[axis] = static_cast<float>(v[axis] - head);
  }
  return s;
}

struct WindowUniforms {
  int sigmoid = 0;
  double low = 0, high = 0, perWidth = 0;
};
WindowUniforms windowUniforms(const VoiWindow& w) {
  if (w.function == VoiFunction::Sigmoid) return {1, w.center, w.center, 4 / w.width};
  const VoiRamp ramp = rampOf(w);
  return {0, ramp.lo, ramp.hi, ramp.hi > ramp.lo ? 1 / (ramp.hi - ramp.lo) : 0.0};
}

constexpr std::array<float, 28> wholePicture(float w, float h) {
  return {0, 0, 0, 0, 0, 0, 0, w, 0, 0, 0, 0, 0, 0, 0, h, 0, 0, 0, 0, 0, w, h, 0, 0, 0, 0, 0};
}

}  // namespace

std::string shaderOf(std::string_view defines, std::initializer_list<std::string_view> fileNames) {
  std::string text = "#version 330 core\n";
  text += defines;
  for (const std::string_view name : fileNames)
    text += name == "texels.glsl" ? gpu::texelShader() : shaderText(name);
  return text;
}

VoxelPlane voxelPlane(const SliceParams& p, int slabSample) {
  const double offset_mm = p.slab.thickness_mm * ((slabSample + 0.5) / p.slabSamples - 0.5);
  const VoxelFromPatient& toVoxel = p.volume->voxelFromPatient();
  VoxelPlane plane;
  plane.origin = (toVoxel * (p.picture.origin + offset_mm * p.picture.normal)).p;
  plane.right = (toVoxel * p.picture.right).v;
  plane.down = (toVoxel * p.picture.down).v;
  return plane;
}

Result<void> checkDrawable(const SliceParams& p, const Capabilities& c) {
  if (p.interpolation == Interpolation::Cubic)
    return makeError(ErrorCode::NoTechnique,
                     "Cubic interpolation is drawn by the native engine; GL has nearest and linear.");
  const auto limit = [](int v) { return v > 0 ? v : 16384; };
  const int largest = std::max(p.view.width_px, p.view.height_px);
  if (largest > limit(c.maxTexture))
    return makeError(ErrorCode::NoTechnique, "The picture has " + std::to_string(largest) +
                                                 " pixels on a side; GL here draws up to " +
                                                 std::to_string(limit(c.maxTexture)) + ".");
  for (const int sample : {0, p.slabSamples - 1}) {
    const VoxelPlane plane = voxelPlane(p, sample);
    const double w = p.view.width_px, h = p.view.height_px;
    for (const glm::dvec2 corner : {glm::dvec2(0, 0), {w, 0}, {0, h}, {w, h}})
      for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(plane.at(corner)[axis]) <= kLargestVoxel))
          return makeError(
              ErrorCode::NoTechnique,
              "The picture reaches more than 4 million voxels beyond the volume; GL draws nearer views.");
  }
  return {};
}

void addPositionUniforms(std::vector<gpu::Uniform>& u, const VoxelPlane& plane, int width_px, int height_px) {
  const glm::dvec3 origin = plane.at({0.5, 0.5});  // of the first pixel's centre
  const glm::dvec3 whole = glm::floor(origin);
  const Split right = splitFor(plane.right, width_px), down = splitFor(plane.down, height_px);
  u.push_back({"originWhole", glm::vec3(whole)});
  u.push_back({"originPart", glm::vec3(origin - whole)});
  u.push_back({"rightHead", right.head});
  u.push_back({"rightTail", right.tail});
  u.push_back({"downHead", down.head});
  u.push_back({"downTail", down.tail});
}

// 2^k with range / 2^k <= 4096: 4096 sums of 12-bit multiples stay within a float's 24 bits.
float meanQuantum(const TexelCode& code) {
  return code.modalityRange > 0 ? static_cast<float>(std::exp2(std::ceil(std::log2(code.modalityRange)) - 12))
                                : 1.0f;
}

void addDeeperUniforms(std::vector<gpu::Uniform>& u, glm::dvec3 deeper, int samples) {
  const Split split = splitFor(deeper, samples);
  u.push_back({"deeperHead", split.head});
  u.push_back({"deeperTail", split.tail});
}

glm::vec2 wholeAndPart(double v) {
  const double whole = std::floor(v);
  return {static_cast<float>(whole), static_cast<float>(v - whole)};
}

Result<gpu::Target> accumulationTarget(gpu::Device& device, const SliceParams& p) {
  const std::array formats{gpu::Format::Rgba32F};
  Result<gpu::Target> target = device.target(p.view.width_px, p.view.height_px, formats);
  if (!target) return target;
  // Alpha 0 is "nothing yet"; the value must lose against any other.
  constexpr float kHuge = std::numeric_limits<float>::max();
  const bool mean = p.slab.mode == SlabMode::Mean;
  const float worst = mean ? 0.0f : p.slab.mode == SlabMode::Min ? kHuge : -kHuge;
  if (Result<void> r = device.clear(*target, 0, {worst, 0, 0, 0}); !r) return r.error();
  return target;
}

namespace {

// Device values count from modalityAtBias; no-data came as a number far outside.
void takeValues(const std::vector<float>& values, double modalityAtBias, Images& images) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    const bool data = values[n] < 1e38f;
    images.depth[n] = data ? 0.0f : kNothing_mm;
    if (!images.values.empty())
      images.values[n] =
          data ? static_cast<float>(values[n] + modalityAtBias) : std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace

Result<void> resolve(gpu::Device& device, const gpu::Target& accumulator, const SliceParams& p,
                     const TexelCode& code, Images& images) {
  const int w = p.view.width_px, h = p.view.height_px;
  Result<std::shared_ptr<const gpu::Program>> program =
      device.program("mpr resolve", shaderOf("", {"picture.vert.glsl"}), shaderOf("", {"resolve.frag.glsl"}));
  if (!program) return program.error();
  const std::array formats{gpu::Format::Rgba32F, gpu::Format::R32F};
  Result<gpu::Target> target = device.target(w, h, formats);
  if (!target) return target.error();
  const std::array layout{2, 1, 2, 2};
  Result<gpu::VertexData> quad =
      device.vertices(wholePicture(static_cast<float>(w), static_cast<float>(h)), layout);
  if (!quad) return quad.error();

  const WindowUniforms window = windowUniforms(p.window);
  gpu::Draw draw;
  draw.program = program->get();
  draw.vertices = &*quad;
  draw.count = 4;
  draw.primitive = gpu::Primitive::TriangleStrip;
  draw.textures = {{"accumulator", &accumulator.colour(0)}};
  draw.uniforms = {{"size_px", glm::vec2(w, h)},
                   {"sigmoid", window.sigmoid},
                   {"invert", p.invert ? 1 : 0},
                   {"low", static_cast<float>(window.low - code.modalityAtBias)},
                   {"high", static_cast<float>(window.high - code.modalityAtBias)},
                   {"perWidth", static_cast<float>(window.perWidth)},
                   {"background", glm::vec3(p.background.r, p.background.g, p.background.b)}};
  if (Result<void> r = device.draw(*target, {&draw, 1}); !r) return r;

  fitImages(images, p.view);
  std::vector<float> values(images.depth.size());
  if (Result<void> r = device.read(*target, 0, images.colour); !r) return r;
  if (Result<void> r = device.read(*target, 1, values); !r) return r;
  takeValues(values, code.modalityAtBias, images);
  return {};
}

double predictedError(const SliceParams& p, double step, bool fixedFunction) {
  const auto range = p.volume->modalityRange();
  const double contrast = range ? (range->max - range->min) / p.window.width : 1.0;
  const double filter = std::min(255.0, 255.0 * (fixedFunction ? 3.0 / 512.0 : 1e-6) * contrast);
  return filter + samplingError(p, step);
}

void addCounters(Counters& counters, const Counters& before, const Counters& after) {
  counters.triangles += after.triangles - before.triangles;
  counters.bytesUploaded += after.bytesUploaded - before.bytesUploaded;
  counters.texturesCreated += after.texturesCreated - before.texturesCreated;
  counters.textures3dCreated += after.textures3dCreated - before.textures3dCreated;
}

Error cancelled() { return makeError(ErrorCode::Cancelled, "The slice was cancelled."); }

}  // namespace vernier::mpr
