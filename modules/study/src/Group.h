// SPDX-License-Identifier: GPL-3.0-or-later
// Records -> patients, studies, series; and what objects with one SOP Instance UID are to each other. Pure.
#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "Record.h"

namespace vernier {

struct Grouping {
  std::vector<Series> series;  // instances filled, stacks not
  std::vector<Study> studies;
  std::vector<Patient> patients;
  std::vector<Finding> findings;
};
// Sets Instance::series. Objects of one (study, series) pair are one series, whatever else differs; without a
// Series or Study UID an object stands alone; a study without Patient ID is a patient of its own.
Grouping groupRecords(std::vector<Record>& records);

// Whether the decoded values of two records are equal; nullopt: it cannot be said.
using SameValues = std::function<std::optional<bool>(std::size_t a, std::size_t b)>;
// Sets Instance::identity of records that share a SOP Instance UID and reports them. `fileName(record)` for
// findings.
std::vector<Finding> settleIdentity(std::vector<Record>& records, const SameValues& sameValues,
                                    const std::function<std::string(std::size_t)>& fileName);

}  // namespace vernier
