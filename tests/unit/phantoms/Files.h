// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests read back from a phantom: with DCMTK (and OpenJPEG for JPEG 2000), none of the generator's
// code.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "vernier/phantoms/Phantoms.h"

namespace vernier::test {

struct ReadFile {
  std::string name, sopClass, sopUid, seriesUid, frameUid, transferSyntax, modality, description;
  std::string windowCenter, windowWidth, windowFunction;
  int instanceNumber = 0, rows = 0, columns = 0, bitsStored = 0;
  bool isSigned = false, hasPadding = false;
  int padding = 0;
  double slope = 1, intercept = 0;
  double origin[3] = {}, orientation[6] = {}, spacing[2] = {};
  std::vector<int> stored;

  double normal(int axis) const;
  double positionAlongNormal() const;
  int at(int column, int row) const { return stored[static_cast<std::size_t>(row * columns + column)]; }
};

// Recipes with multi-frame objects, which readFolder() does not read: MultiFrameTest.cpp does.
// Recipes with three samples a pixel, palettes or presentation states beside the images.
inline bool hasColoursOrStates(const std::string& recipe) {
  return recipe == "palette" || recipe == "presentation" || recipe == "rgba-spheres";
}

inline bool isMultiFrame(const std::string& recipe) {
  return recipe == "dose" || recipe == "enhanced-ct" || recipe == "enhanced-mr" || recipe == "segmentation";
}

// Decodes all *.dcm of a folder, by file name. Fails the test on any error.
std::vector<ReadFile> readFolder(const std::filesystem::path& folder);

struct Written {
  std::filesystem::path folder;
  nlohmann::json answers;
  std::vector<ReadFile> files;
};
// Writes a phantom into dir and reads it back.
Written writeAndRead(const std::filesystem::path& dir, const std::string& name,
                     const std::map<std::string, std::string>& settings = {});
Result<PhantomInfo> writeOnly(const std::filesystem::path& dir, const std::string& name,
                              const std::map<std::string, std::string>& settings = {});

}  // namespace vernier::test
