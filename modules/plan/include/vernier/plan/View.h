// SPDX-License-Identifier: GPL-3.0-or-later
// How a Scene is asked for: size of the picture, quality, and what the machine offers.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace vernier {

struct View {
  int width_px = 512, height_px = 512;
  bool wantValues = false;  // also keep modality values before the window (Images::values)
};

enum class QualityLevel { Draft, Review, Reference };
enum class Engine { Native, Gl };
enum class EngineChoice { Auto, Native, Gl };

struct Quality {
  QualityLevel level = QualityLevel::Review;
  EngineChoice engine = EngineChoice::Auto;
  std::string technique;           // "" = the planner's choice
  std::optional<double> maxError;  // levels of 255, asked for by the user
  std::optional<double> minFps;
  double step = 1.0;  // sampling step along rays and slabs, in smallest voxel spacings: 1 .. 1/32
};

// What runs here. Filled by the session (doctor prints it); plain data, so that plans can be made for any
// machine.
struct Capabilities {
  bool native = true;
  std::string simd;  // Highway target
  int threads = 1;
  bool gl = false;
  bool glIsSoftware = true;  // llvmpipe and the like
  std::string glRenderer, glVersion, glWhyNot;
  int max3dTexture = 0, maxTexture = 0;
  std::uint64_t glTextureBudget_bytes = 1ull << 30;  // textures that GL may keep between frames
};

}  // namespace vernier
