// SPDX-License-Identifier: GPL-3.0-or-later
// Device: an OpenGL 3.3 core context that draws into float targets, without a window. Software contexts come
// from OSMesa, whose library is loaded only when a Device is made; nothing of Vernier links GL.
//
// Threads: a Device belongs to the thread that made it, or to the one that called adopt() after release();
// any other call is refused. Errors: GlUnavailable (no library, no context, no float images), GlFailed (the
// driver refused something; checked after every batch), GlLost (the driver was reset: make a new Device; what
// the old one owned is gone), OutOfMemory, ShaderInvalid with the driver's own log.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"
#include "vernier/gpu/DeviceCache.h"
#include "vernier/gpu/Draw.h"
#include "vernier/gpu/Resources.h"
#include "vernier/plan/Frame.h"
#include "vernier/plan/View.h"

namespace vernier::gpu {

struct DeviceOptions {
  std::string osmesaLibrary;                    // "" = the system's; a path is taken as it is
  std::uint64_t cacheLimit_bytes = 1ull << 30;  // textures kept between frames
};

struct Limits {
  int max2d = 0, max3d = 0, maxColours = 0;
  std::string renderer, version, vendor;
  bool software = true;
  std::uint64_t cacheLimit_bytes = 0;  // of DeviceOptions
};

class GlContext;  // src/GlContext.h

class VERNIER_API Device {
 public:
  // VERNIER_GL=off in the environment refuses, so that a machine without GL can be played.
  static Result<std::unique_ptr<Device>> make(const DeviceOptions& = {});
  // The same on a context that the caller brings. A driver that cannot draw into float images is refused.
  static Result<std::unique_ptr<Device>> makeOn(std::unique_ptr<GlContext>, const DeviceOptions& = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const Limits& limits() const;
  Result<void> release();  // by the owning thread
  Result<void> adopt();    // by the new one

  // texels: rows from the top, tightly packed, in the format's own type (uint8, uint16, int16, float).
  Result<Texture> texture2d(Format, int width, int height, std::span<const std::byte> texels);
  Result<Texture> texture3d(Format, int width, int height, int depth);
  Result<void> uploadSlices(const Texture& texture3d, int first, int count,
                            std::span<const std::byte> texels);
  // With indices a draw takes the vertices that they name; each must name one that is there.
  Result<VertexData> vertices(std::span<const float> interleaved, std::span<const int> components,
                              std::span<const std::uint32_t> indices = {});
  // GLSL 3.30. `name` stands in error sentences. Compiled once per name: a second call gives the same
  // program.
  Result<std::shared_ptr<const Program>> program(const std::string& name, std::string_view vertexText,
                                                 std::string_view fragmentText);
  Result<Target> target(int width, int height, std::span<const Format> colours, bool depth = false);

  Result<void> clear(const Target&, int colour, glm::vec4 value);
  Result<void> clearDepth(const Target&, float value);
  // Draws in order; one error check at the end. A texture of the target itself cannot be read.
  Result<void> draw(const Target&, std::span<const Draw>);
  Result<void> finish();  // waits until all is drawn: bounds the delay of a cancel on software renderers
  // out: width x height x components floats, components 1 for R32F, 4 for Rgba32F.
  Result<void> read(const Target&, int colour, std::span<float> out);
  Result<void> readTexture(const Texture&, std::span<std::byte> out);  // in the texture's own format

  DeviceCache& cache();
  const Counters& counters() const;  // since the Device was made; samples counts fragments that were written
  void setOddStateForTest(unsigned seed);  // leaves GL in a state that no pass would choose

 private:
  Device();
  Result<void> enter(const char* where);
  Result<void> check(const char* where);
  Result<void> one(const Target&, const Draw&);
  Result<void> bindInputs(const Target&, const Draw&);
  Result<void> applyUniforms(const Draw&);
  Result<Texture> makeTexture(Format, int width, int height, int depth, const void* texels);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Is GL available here, and if not, why: fills gl, glIsSoftware, glRenderer, glVersion, glWhyNot,
// max3dTexture, maxTexture. Makes a context and drops it again (tens of ms).
VERNIER_API void probe(Capabilities&, const DeviceOptions& = {});
VERNIER_API void describe(const Limits&, Capabilities&);  // the same from a Device that is there already

}  // namespace vernier::gpu
