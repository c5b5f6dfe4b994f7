// SPDX-License-Identifier: GPL-3.0-or-later
// Phantoms: synthetic studies whose right answers are known in closed form, written as real DICOM (or, on
// request, as MetaImage). A recipe (datasets-synthetic/recipes/*.json) states solids or formulas in Patient
// millimetres (LPS) and the grid that samples them; the pixel of a voxel is the formula at that voxel's
// centre, rounded, plus integer-hash noise where the recipe asks for it. The same recipe and options give the
// same bytes on every run, with any number of threads and on any machine: no library random numbers, no fused
// multiply-add, no sin/cos/exp of the C library, no clock. UIDs lie under 2.25 and come from name, options
// and seed; dates are fixed. Errors: OptionInvalid (unknown recipe or setting), WriteFailed, Cancelled.
// Thread-safe; writes with threads(). Sources: DICOM PS3.3 (CT, MR, SC Image IODs), PS3.5 annexes A and B,
// PS3.10; datasets-synthetic/README.md.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "vernier/base/Progress.h"
#include "vernier/base/Result.h"

namespace vernier {

struct PhantomSetting {
  std::string name, defaultValue, about;  // about: one line, with the values it takes
};
struct PhantomRecipe {
  std::string name;
  std::string summary;  // one line
  std::vector<PhantomSetting> settings;
  bool isSurface = false;  // one STL file in place of a study
};

// All recipes, by name.
const std::vector<PhantomRecipe>& phantomRecipes();

enum class PhantomFormat {
  Dicom,      // outDir/NAME/*.dcm; recipes of surfaces are written as outDir/NAME.stl
  MetaImage,  // outDir/NAME.mhd + NAME.raw, int16 or uint8, stored values; one-series recipes on an even
              // lattice only
};

struct PhantomOptions {
  PhantomFormat format = PhantomFormat::Dicom;
  std::map<std::string, std::string> settings;  // those that the recipe lists, such as {"scale", "0.25"}
  std::stop_token stop;
};

struct PhantomInfo {
  std::filesystem::path data;  // the folder of DICOM files, or the .mhd or .stl
  std::filesystem::path
      answers;  // outDir/NAME.answers.json, beside the data so that a study folder holds DICOM only
  std::uint64_t files = 0, bytes = 0;
};

// Writes the phantom and its answers below outDir (made when absent). Files of the same name are replaced;
// other files of outDir/NAME are left alone, except old *.dcm of an earlier run, which would mix with the new
// study.
Result<PhantomInfo> writePhantom(const std::string& name, const std::filesystem::path& outDir,
                                 const PhantomOptions& options = {}, const ProgressFn& progress = {});

}  // namespace vernier
