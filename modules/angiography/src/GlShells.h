// SPDX-License-Identifier: GPL-3.0-or-later
// Shells on OpenGL, as W. Heidrich draws them (Hardware Accelerated Rendering of Emissive Volumes, 1996).
//
// The depth buffer is the maximum: each shell is drawn with z replaced by z* = a_i z' + b_i, its brightness
// but for a factor, so that the brightest fragment is in front. Without a cue (a = 0) z* is the shell's rank
// plus a share of z' that never reaches the next rank: the same winners, and tools are resolved. A tool is
// drawn into the depth under the rule of each shell that it overlaps, before that shell.
//
// The other way, for what 24 bits of depth do not resolve and for translucent tools, is a float image under
// the maximum, and tools as images that each fragment reads.
#pragma once
#include <optional>

#include "vernier/gpu/Device.h"
#include "vernier/native/Shells.h"

namespace vernier::angiography {

enum class Maximum { DepthBuffer, Blending };
// The paper's two ways to brightness, of the maximum: colour of each shell, or full brightness and linear
// fog.
enum class Route { ColourPerShell, Fog };

struct GlShellsOptions {
  Maximum maximum = Maximum::DepthBuffer;
  Route route = Route::ColourPerShell;
};

Result<void> drawGlShells(gpu::Device&, const native::ShellsJob&, const GlShellsOptions&, Images&,
                          std::stop_token);

// Planes that cut the volume's box: GL has room for kMostCuts of them beside the near distance.
inline constexpr std::size_t kMostCuts = gpu::kMostClipDistances - 1;
std::vector<HalfSpace> cuttingPlanes(const native::ShellsJob&);
// Whether 24 bits hold the order of brightness: with a cue the darkest shell must not lie below 2^-10 of the
// brightest point.
bool depthResolves(const native::ShellsJob&);

}  // namespace vernier::angiography
