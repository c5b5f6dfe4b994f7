// SPDX-License-Identifier: GPL-3.0-or-later
// Images of a frame under work, and the finished Frame. Row 0 on top, pixel centres at half-integers.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/plan/RayIntervals.h"

namespace vernier {

// A count of what was really done; tests assert these, never times.
struct Counters {
  std::uint64_t samples = 0;  // interpolated reads of the volume
  std::uint64_t cells = 0;
  std::uint64_t triangles = 0;
  std::uint64_t passes = 0;         // of the plan that were drawn; counted by whoever executes it
  std::uint64_t bytesUploaded = 0;  // to GL textures and buffers
  std::uint64_t texturesCreated = 0;
  std::uint64_t textures3dCreated = 0;
  Counters& operator+=(const Counters& o) {
    samples += o.samples, cells += o.cells, triangles += o.triangles, passes += o.passes;
    bytesUploaded += o.bytesUploaded, texturesCreated += o.texturesCreated;
    textures3dCreated += o.textures3dCreated;
    return *this;
  }
};

inline constexpr float kNothing_mm = std::numeric_limits<float>::infinity();

struct Images {
  int width = 0, height = 0;
  std::vector<float> colour;  // RGBA, 4 floats a pixel, display-referred 0..1, before quantisation
  std::vector<float> depth;   // mm along the pixel's ray, kNothing_mm where nothing was hit
  std::vector<float>
      values;  // empty, or the modality value before the window, NaN = no data (View::wantValues)
  std::shared_ptr<RayIntervals> rays;  // while a picture with lenses is drawn, else null
  Counters counters;

  void allocate(int w, int h, bool wantValues) {
    width = w, height = h;
    const std::size_t n = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
    colour.assign(4 * n, 0.0f);
    depth.assign(n, kNothing_mm);
    if (wantValues) values.assign(n, std::numeric_limits<float>::quiet_NaN());
  }
};

struct Frame {
  Images images;
  std::string engine;     // "native" or "gl"
  std::string technique;  // of the first drawn layer
  std::string renderer;   // GL renderer string or SIMD target
  double prepare_ms = 0, render_ms = 0;
};

}  // namespace vernier
