// SPDX-License-Identifier: GPL-3.0-or-later
// Tiny presentation states for tests: a base that refers to one image, and any attribute by its path, such as
// "SoftcopyVOILUTSequence[0].WindowCenter=40" (items are made as needed). OW values are hexadecimal words
// divided by backslashes. Throws std::runtime_error when writing fails.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace vernier::test {

struct PresentationFile {
  std::string sopClassUid = "1.2.840.10008.5.1.4.1.1.11.1";
  std::string sopInstanceUid = "2.25.7001", seriesUid = "2.25.7002", studyUid = "2.25.1001",
              patientId = "TEST-1";
  std::string label = "TEST";
  std::vector<std::string> imageUids{"2.25.1002.1"};
  std::vector<std::string> set;
};

void writePresentation(const std::filesystem::path&, const PresentationFile&);

// LUT Data of these entries, as `set` wants it.
std::string lutWords(const std::vector<unsigned>& entries);

}  // namespace vernier::test
