// SPDX-License-Identifier: GPL-3.0-or-later
// What CLI11's own checks let through: NaN, wrapped numbers, empty values, outputs that are inputs.
#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "Session.h"

namespace vernier::app {

// A finite number from least to most, both included; NaN is none.
CLI::Validator finiteFrom(double least, double most);
CLI::Validator finiteAboveZero();
// A whole number from 0 to 2^64 - 1, not one that would wrap.
CLI::Validator wholeNumber64();

// Refuses an option that was given an empty text: it would silently count as not given.
Result<void> noEmptyValues(const CLI::App&);

// No output file may be one of the files that were read; without a session those are `inputs` alone.
Result<void> keepSources(const Session*, const std::vector<std::string>& inputs, const std::string& output,
                         const char* option);

}  // namespace vernier::app
