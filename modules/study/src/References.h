// SPDX-License-Identifier: GPL-3.0-or-later
// What objects say of each other: real-world mappings of images that lie in other files, series that were
// converted from others, concatenations. Pure functions over records.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "AttributeReader.h"
#include "Record.h"

namespace vernier {

// Of a Real World Value Mapping object (PS3.3 A.46).
std::vector<RealWorldReference> readRealWorldReferences(const AttributeReader& root);

// Hands the mappings of all records to the frames that they name; returns what to say of it.
std::vector<Finding> attachRealWorld(std::vector<Record>& records);

// "converted-copy" in both series where one holds a Legacy Converted object and the other what it was made
// of.
void linkConverted(const std::vector<Record>& records, std::vector<Series>& series);

// Of one series: parts of concatenations that are missing or overlap, or that all are there.
std::vector<Finding> concatenationFindings(const std::vector<Record>& records,
                                           const std::vector<std::size_t>& members,
                                           const std::function<std::string(std::size_t)>& fileName);

}  // namespace vernier
