// SPDX-License-Identifier: GPL-3.0-or-later
// TransferFunction: how a modality value looks in volume rendering. Two lists of points, each piecewise
// linear in the value and held beyond its ends; two points of one value are a step, at which the later one
// holds. Colour is display-referred 0..1, not multiplied by opacity. Opacity is of a piece of ray
// `opacityLength_mm` long: over d mm it is 1 - (1 - a)^(d / opacityLength_mm), so the extinction per mm is
// -ln(1 - a) / opacityLength_mm, without bound where a = 1. Pure functions in double, safe on any thread.
#pragma once
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/base/Result.h"
#include "vernier/volume/Volume.h"

namespace vernier {

inline constexpr std::size_t kMostTransferPoints = 65536;

struct ColourPoint {
  double value = 0;
  glm::dvec3 colour{1};
  friend bool operator==(const ColourPoint&, const ColourPoint&) = default;
};
struct OpacityPoint {
  double value = 0, opacity = 0;
  friend bool operator==(const OpacityPoint&, const OpacityPoint&) = default;
};

struct TransferFunction {
  std::vector<ColourPoint> colours;
  std::vector<OpacityPoint> opacities;
  double opacityLength_mm = 1;
  friend bool operator==(const TransferFunction&, const TransferFunction&) = default;
};

// SceneInvalid with the sentence, `where` the place in its JSON ("/opacities/3"): no points, more than
// kMostTransferPoints, numbers that are not finite, values that descend or stand three times, colours or
// opacities outside 0..1, a length not above 0.
VERNIER_API Result<void> checkTransferFunction(const TransferFunction&);

// Of a checked function. A value that is NaN (no data): no opacity, black.
VERNIER_API glm::dvec3 colourAt(const TransferFunction&, double value);
VERNIER_API double opacityAt(const TransferFunction&, double value);
// -ln(1 - opacity) / opacityLength_mm; +inf where the opacity is 1.
VERNIER_API double extinctionAt_perMm(const TransferFunction&, double value);

// 1 - (1 - opacity)^lengths, `lengths` in multiples of opacityLength_mm; exact for small opacities too.
VERNIER_API double opacityOver(double opacity, double lengths);
// The papers' approximation, min(1, opacity * lengths).
VERNIER_API double opacityOverLinear(double opacity, double lengths);

// The greatest opacity over values in [least, greatest]: 0 tells that the range shows nothing.
VERNIER_API double greatestOpacity(const TransferFunction&, double least, double greatest);
// All values at which either list bends, ascending, each once.
VERNIER_API std::vector<double> knotsOf(const TransferFunction&);

// The names of transferPreset: ct, ct-bone, ct-soft, ct-lung, ct-angio, mr, mr-angio, ramp.
VERNIER_API const std::vector<std::string>& transferPresets();
// What fits the volume where nobody chose: ct where its values reach below -500 and above 700, else ramp.
VERNIER_API std::string defaultTransferPreset(const Volume&);
// ct...: fixed HU. mr, mr-angio and ramp: fractions of the volume's range of modality values; their opacity
// is that of one step of the smallest spacing. OptionInvalid for an unknown name.
VERNIER_API Result<TransferFunction> transferPreset(const std::string& name, const Volume&);

// The level of an iso-surface where nobody chose: 300 where the default preset is ct, else the middle of the
// range.
VERNIER_API double defaultIsoLevel(const Volume&);

}  // namespace vernier
