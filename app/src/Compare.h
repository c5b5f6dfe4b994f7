// SPDX-License-Identifier: GPL-3.0-or-later
// The three things that `vernier compare` compares, one file each; each prints its figures and returns the
// exit code.
#pragma once
#include <nlohmann/json.hpp>

#include "Cli.h"

namespace vernier::app {

struct CompareOptions {
  std::string a, b, seriesA, seriesB, offset, heatmap, mode, out;
  double wipe = 0.5;
  int tile_px = 32;
  bool json = false, align = false;
  std::optional<double> maxError;
};

// PNG, TIFF, SGI of one size, depth and colour.
int comparePictureFiles(const CompareOptions&);
// Series of DICOM or volume files. Different patients are refused.
int compareStacks(const GlobalOptions&, const CompareOptions&);
// Two files that `vernier render --report` wrote: plan, error, timing.
bool isReport(const std::string& path);
int compareReports(const CompareOptions&);

// May the difference of what these two sessions have chosen be made at all? OptionInvalid without any value
// of a patient: other Patient IDs or issuers, or one ID with different birth dates or sexes.
Result<void> samePatient(const Session& a, StackChoice, const Session& b, StackChoice);

// NaN and infinities as text, which JSON has no numbers for.
nlohmann::ordered_json jsonNumber(double);
// Exit 4 with a sentence when `error` is above what was asked for; else 0.
int judgeMaxError(const CompareOptions&, double error, const std::string& unit);

}  // namespace vernier::app
