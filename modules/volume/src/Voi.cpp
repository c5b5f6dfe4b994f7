// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Voi.h"

#include <algorithm>
#include <cmath>

namespace vernier {

bool usableWindow(const VoiWindow& w) {
  return std::isfinite(w.center) && std::isfinite(w.width) && w.width > 0;
}

VoiWindow normalised(VoiWindow w) {
  if (w.function == VoiFunction::Linear && w.width > 0 && w.width < 1) w.function = VoiFunction::LinearExact;
  return w;
}

VoiRamp rampOf(const VoiWindow& w) {
  if (w.function == VoiFunction::LinearExact) return {w.center - w.width / 2, w.center + w.width / 2};
  return {w.center - 0.5 - (w.width - 1) / 2, w.center - 0.5 + (w.width - 1) / 2};
}

double applyVoi(const VoiWindow& w, double x) {
  if (std::isnan(x)) return x;
  if (w.function == VoiFunction::Sigmoid) return 1 / (1 + std::exp(-4 * (x - w.center) / w.width));
  const VoiRamp ramp = rampOf(w);
  if (x <= ramp.lo) return 0;
  if (x > ramp.hi) return 1;
  const double y = w.function == VoiFunction::LinearExact ? (x - w.center) / w.width + 0.5
                                                          : (x - (w.center - 0.5)) / (w.width - 1) + 0.5;
  return std::clamp(y, 0.0, 1.0);
}

double lookUp(const LutTable& lut, double value) {
  if (lut.data.empty() || std::isnan(value)) return lut.data.empty() ? 0 : value;
  const double last = static_cast<double>(lut.data.size() - 1);
  return lut.data[static_cast<std::size_t>(std::clamp(std::floor(value - lut.firstMapped), 0.0, last))];
}

double applyVoi(const LutTable& lut, double modality) {
  const double full = std::exp2(std::clamp<double>(lut.bits, 1, 16)) - 1;
  return std::isnan(modality) ? modality : std::clamp(lookUp(lut, modality) / full, 0.0, 1.0);
}

}  // namespace vernier
