// SPDX-License-Identifier: GPL-3.0-or-later
// What both GL techniques for slices share: the exact position of a pixel as
// uniforms, the accumulation target and its resolution into the Images.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "SliceParams.h"
#include "StripGeometry.h"
#include "vernier/gpu/Device.h"
#include "vernier/gpu/VolumeTexels.h"

namespace vernier::mpr {

std::string_view shaderText(std::string_view fileName);  // the files of shaders/
// "#version 330 core", the defines, then the files one after the other; "texels.glsl" is gpu's.
std::string shaderOf(std::string_view defines, std::initializer_list<std::string_view> fileNames);

VoxelPlane voxelPlane(const SliceParams&, int slabSample);

using gpu::TexelCode, gpu::texelCode;

// Why GL cannot draw this slice at all: picture or coordinates beyond what its numbers hold.
Result<void> checkDrawable(const SliceParams&, const Capabilities&);

// `deeper`: the step to the next slab sample, for shaders that loop over them.
void addPositionUniforms(std::vector<gpu::Uniform>&, const VoxelPlane&, int width_px, int height_px);
void addDeeperUniforms(std::vector<gpu::Uniform>&, glm::dvec3 deeper, int samples);
glm::vec2 wholeAndPart(double);

// The multiple whose sums in float are exact for up to 4096 samples of this range.
float meanQuantum(const TexelCode&);

Result<gpu::Target> accumulationTarget(gpu::Device&, const SliceParams&);
// Window, inversion and background on the device; reads colour and values back and sets the depth.
Result<void> resolve(gpu::Device&, const gpu::Target& accumulator, const SliceParams&, const TexelCode&,
                     Images&);

// Predicted levels of 255, as the native engine predicts: the bound of the filter, and what a slab misses
// between its samples.
double predictedError(const SliceParams&, double step, bool fixedFunction);

// What the device did since `before`, added to the picture's counters. Samples are the technique's own to
// count.
void addCounters(Counters&, const Counters& before, const Counters& after);

Error cancelled();

}  // namespace vernier::mpr
