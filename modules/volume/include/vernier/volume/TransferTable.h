// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer functions made ready for steps of one length: a table over the value of a sample
// (post-classification), and one over the values at both ends of a step (pre-integrated; Engel, Kraus, Ertl,
// High-Quality Pre-Integrated Volume Rendering, 2001). Entries stand at evenly spread modality values from
// `least` to `greatest`; between entries a reader interpolates linearly, beyond them the outer ones hold.
// Both are RGBA in float. A step (two points of one value) is therefore as wide as the distance of two
// entries.
//
// Pure functions, safe on any thread; the pre-integrated table is made on all cores, bit-equal for any number
// of them. Errors: SceneInvalid by checkTransferFunction; Internal where least < greatest does not hold, for
// a step that is not above 0 or not finite, and for a number of entries outside 2..65536 (2..2048).
#pragma once
#include <vector>

#include "vernier/volume/TransferFunction.h"

namespace vernier {

inline constexpr int kTransferEntries = 4096, kMostTransferEntries = 65536;
inline constexpr int kPreIntegratedEntries = 512, kMostPreIntegratedEntries = 2048;

// Where a table over the value of a sample needs its entries: within `values`, from a little before the first
// knot to a little behind the last, so that what holds beyond is an entry. least < greatest always.
VERNIER_API Volume::Range transferTableRange(const TransferFunction&, const Volume::Range& values);
// The same of a pre-integrated table: as far beyond the knots as a step's ends may well lie, since an end
// that is moved to the range lengthens what the step has of the function. As far as the knots are apart, at
// least a quarter of all values.
VERNIER_API Volume::Range preIntegratedRange(const TransferFunction&, const Volume::Range& values);

struct TransferTable {
  double least = 0, greatest = 1, step_mm = 1;
  int size = 0;
  std::vector<float> rgba;  // 4 for each entry: colour, not multiplied; opacity of one step
  // Entry n speaks of this value.
  double valueOf(int n) const { return least + (greatest - least) * n / (size - 1); }
};
// `linear`: the papers' approximation of the opacity, instead of 1 - (1 - a)^(step / length).
VERNIER_API Result<TransferTable> makeTransferTable(const TransferFunction&, const Volume::Range&,
                                                    double step_mm, bool linear,
                                                    int entries = kTransferEntries);

// Entry (front, back) at 4 * (front + size * back): colour multiplied by opacity, and opacity, of a step
// along which the value goes evenly from the front's to the back's. Integrated in double, cut at all knots:
// optical depths are closed forms, colours right to 1e-6.
struct PreIntegratedTable {
  double least = 0, greatest = 1, step_mm = 1;
  int size = 0;
  std::vector<float> rgba;
  double valueOf(int n) const { return least + (greatest - least) * n / (size - 1); }
};
VERNIER_API Result<PreIntegratedTable> makePreIntegratedTable(const TransferFunction&, const Volume::Range&,
                                                              double step_mm,
                                                              int entries = kPreIntegratedEntries);

}  // namespace vernier
