// SPDX-License-Identifier: GPL-3.0-or-later
// From stored numbers to what is displayed: rescale, windows and lookup tables as files hold them (PS3.3
// C.11).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace vernier {

struct ModalityRescale {
  double slope = 1, intercept = 0;
  friend bool operator==(const ModalityRescale&, const ModalityRescale&) = default;
};

enum class VoiFunction { Linear, LinearExact, Sigmoid };
struct VoiWindow {
  double center = 0, width = 0;  // modality values
  VoiFunction function = VoiFunction::Linear;
  std::string explanation;
  friend bool operator==(const VoiWindow&, const VoiWindow&) = default;
};
// LUT Descriptor and data of a modality, VOI or presentation LUT (PS3.3 C.11.1, C.11.2, C.11.6).
struct LutTable {
  double firstMapped = 0;
  std::uint32_t bits = 0;
  std::vector<std::uint16_t> data;
  std::string explanation;
};

}  // namespace vernier
