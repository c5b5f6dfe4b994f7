// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader should know of a series beside its geometry. Pure.
#pragma once
#include <functional>
#include <vector>

#include "Record.h"

namespace vernier {
std::vector<Finding> seriesFindings(const std::vector<Record>& records,
                                    const std::vector<std::size_t>& members,
                                    const std::function<std::string(std::size_t)>& fileName);
}  // namespace vernier
