// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of `vernier info --json` share.
#pragma once
#include <nlohmann/json.hpp>

#include "InfoJson.h"

namespace vernier {
using Json = nlohmann::ordered_json;

const char* nameOf(FileKind);

// By Patient ID and issuer; without an ID each entry is one. Fewer than StudySet::patients where one ID
// stands with several birth dates or sexes.
std::size_t patientIds(const StudySet&);

Json toJson(const glm::dvec3&);
Json toJson(const PatientFromVoxel&);  // rows of a 4x4 matrix
Json toJson(const std::vector<Finding>&);
Json toJson(const Error&);
Json seriesJson(const StudySet&, const Series&);        // with its stacks
Json objectsJson(const StudySet&, const InfoOptions&);  // a list, in the order of set.instances
Json volumeFilesJson(const StudySet&, const std::vector<VolumeFile>&, const InfoOptions&);

}  // namespace vernier
