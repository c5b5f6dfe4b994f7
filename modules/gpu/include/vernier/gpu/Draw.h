// SPDX-License-Identifier: GPL-3.0-or-later
// What one GL draw states: all of it, every time. Nothing is inherited from the draw before, so the order of
// passes cannot change a picture. No GL types here. Row 0 of every image, target and rectangle is the top
// row: clip y = -1 is the top edge, and gl_FragCoord.xy is the Pixel frame.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

namespace vernier::gpu {

class Texture;
class VertexData;
class Program;

enum class Format { R8, R16, R16Snorm, R32F, Rgba8, Rgba32F };
enum class Filter { Nearest, Linear };
enum class Wrap { Edge, Zero };  // Zero: outside 0..1 reads 0
enum class DepthTest { Off, Less, LessEqual, Greater, GreaterEqual };
// Over: premultiplied colour. Remaining: alpha is what is left of what lies behind, (ONE, SRC_ALPHA); the
// target's alpha is multiplied by it.
enum class Blend { Off, Over, Add, Max, Min, Remaining };
enum class Cull { Off, Back, Front };  // Front faces are counter-clockwise in the picture as one sees it
enum class Primitive { Triangles, TriangleStrip, TriangleFan };

struct Rect {
  int x = 0, y = 0, width = 0, height = 0;
};

inline constexpr int kMostClipDistances = 8;  // what every GL 3.3 has

struct DrawState {
  DepthTest depth = DepthTest::Off;
  bool depthWrite = false;  // only together with a depth test
  Blend blend = Blend::Off;
  Cull cull = Cull::Off;
  std::optional<Rect> scissor;
  std::optional<Rect> viewport;  // absent: the whole target
  std::array<bool, 4> colourMask{true, true, true, true};
  // gl_ClipDistance[0 .. n - 1] cut, at most kMostClipDistances. A program that writes more of them must
  // write what cuts nothing: Mesa 22.3's software renderer heeds all that are written.
  int clipDistances = 0;
  bool depthClamp = false;  // depth beyond 0..1 is held there instead of being cut off
};

struct TextureBinding {
  const char* sampler;  // name in the program
  const Texture* texture;
  Filter filter = Filter::Nearest;
  Wrap wrap = Wrap::Edge;
};

using UniformValue =
    std::variant<int, float, glm::vec2, glm::vec3, glm::vec4, glm::ivec2, glm::ivec3, glm::mat4>;
struct Uniform {
  const char* name;
  UniformValue value;
};

// Every uniform and sampler that the program uses must be given; values for names that it does not use are
// ignored.
struct Draw {
  const Program* program = nullptr;
  const VertexData* vertices = nullptr;
  int first = 0, count = 0;  // vertices, or indices where the vertex data has them
  Primitive primitive = Primitive::Triangles;
  DrawState state;
  std::vector<TextureBinding> textures;
  std::vector<Uniform> uniforms;
};

}  // namespace vernier::gpu
