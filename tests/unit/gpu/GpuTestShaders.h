// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "vernier/gpu/Device.h"

namespace vernier::gpu::test {

inline constexpr const char* kVertex = R"(#version 330 core
layout(location = 0) in vec2 position;
layout(location = 1) in vec3 colour;
out vec3 vertexColour;
void main() {
  vertexColour = colour;
  gl_Position = vec4(position, 0.0, 1.0);
})";
inline constexpr const char* kColour = R"(#version 330 core
in vec3 vertexColour;
uniform float gain;
layout(location = 0) out vec4 colour;
void main() { colour = vec4(vertexColour * gain, 0.5); })";
inline constexpr const char* kFetch = R"(#version 330 core
in vec3 vertexColour;
uniform sampler2D image;
uniform vec2 size;
layout(location = 0) out vec4 colour;
void main() { colour = vec4(texture(image, gl_FragCoord.xy / size).r, vertexColour.xy, 1.0); })";

// Two triangles over the whole target, red grows to the right and green downwards.
inline constexpr std::array<float, 30> kQuad{-1, -1, 0, 0, 1, 1, -1, 1, 0, 1, -1, 1, 0, 1, 1,
                                             1,  -1, 1, 0, 1, 1, 1,  1, 1, 1, -1, 1, 0, 1, 1};
inline constexpr std::array<int, 2> kQuadLayout{2, 3};
inline constexpr std::array<Format, 1> kFloat4{Format::Rgba32F};

}  // namespace vernier::gpu::test
