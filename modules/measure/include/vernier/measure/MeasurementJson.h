// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of measurements as JSON (every key: docs/measurements.md). Keys stand in a fixed order and numbers in
// the shortest form that reads back as the same double, in every locale: parse(write(x)) == x bit for bit.
//
// OptionInvalid with the JSON path ("/measurements/0/points/1") in Error::where: bad syntax, unknown or
// repeated keys, wrong types, numbers that are not finite, a newer schema, text over 16 MiB, over 10,000
// measurements, nesting deeper than 32. Pure; safe on any thread.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "vernier/measure/MeasurementList.h"

namespace vernier::measure {

inline constexpr int kMeasurementSchema = 1;
inline constexpr std::size_t kMostMeasurements = 10'000;

// Numbers must be finite.
VERNIER_API std::string writeMeasurements(const std::vector<Entry>&);
VERNIER_API Result<std::vector<Entry>> parseMeasurements(std::string_view json);

}  // namespace vernier::measure
