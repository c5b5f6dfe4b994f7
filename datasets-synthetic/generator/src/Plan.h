// SPDX-License-Identifier: GPL-3.0-or-later
// From a recipe with its settings applied to the list of files to write: pure, no pixels, no DICOM.
#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "Field.h"
#include "vernier/base/Result.h"

namespace vernier::phantoms {

enum class Storage { Ct, Mr, SecondaryCapture, EnhancedCt, EnhancedMr };

// "CT", "MR" or "OT".
const char* modalityOf(Storage);

struct Window {
  std::string center, width, explanation;  // as written (DS), valid or not
};

struct SlicePlan {
  glm::dvec3 origin_mm{0}, rowDirection{1, 0, 0},
      columnDirection{0, 1, 0};  // as the file's DS say, to the last digit
  std::int64_t noiseKey = 0;     // slices with the same key and place have the same noise
  int instanceNumber = 1;
  std::string sopUid, fileName;
  double valueOffset = 0;  // modality units; tells two objects of one place apart
  // Frames of multi-frame objects: their number in their file, and what their contrast does to the values.
  int frame = 0;                              // from 1; 0: the file has one frame
  double factor = 1;                          // modality value = factor * field
  double slope = 0;                           // 0: the series' own
  double echoTime_ms = 0, bValue_s_mm2 = -1;  // 0 and below 0: none
  std::size_t position = 0;                   // of the slice along the normal, from 0
  std::vector<Window> windows;
  std::string windowFunction;
};

// One multi-frame file of a series: which slices are its frames, in the order of the file.
struct ObjectPlan {
  std::string fileName, sopUid;
  std::vector<std::size_t> slices;
  std::size_t firstFrame = 0;  // in its concatenation
};

struct SeriesPlan {
  std::string description, seriesUid;
  int number = 1;
  Storage storage = Storage::Ct;
  std::int64_t columns = 0, rows = 0;
  double columnSpacing_mm = 1, rowSpacing_mm = 1;  // between neighbouring columns; between neighbouring rows
  double step_mm = 1, thickness_mm = 1;
  int bitsAllocated = 16, bitsStored = 16;
  bool isSigned = true;
  double slope = 1, intercept = 0;
  std::optional<int> padding;
  double fieldOfView_mm = 0;  // with padding: pixels farther than this from the image's centre are padding
  int samples = 1;            // 3: RGB, interleaved by pixel
  std::vector<std::array<std::uint16_t, 3>>
      palette;  // red, green, blue of each stored value; empty: grey or RGB
  int paletteBits = 16;
  bool paletteSegmented = false;
  std::string transferSyntaxUid = "1.2.840.10008.1.2.1";
  int quality = 0;          // lossy JPEG; or the allowed error of JPEG-LS near-lossless
  std::string lossyMethod;  // empty: lossless
  double storedBound = 0;   // largest difference of a decoded stored value from the uncompressed one
  std::vector<SlicePlan> slices;
  std::vector<ObjectPlan> objects;  // empty: each slice is a file of its own
  std::string concatenationUid;     // with more than one object
};

// A greyscale softcopy presentation state for one slice of the first series.
struct PresentationPlan {
  std::string sopUid, seriesUid, fileName = "PR0001.dcm", label;
  std::size_t slice = 0;
  double center = 0, width = 1;
  bool inverse = false, flip = false;
  int rotation_deg = 0;
  std::array<int, 4> shutter{};  // left, right, upper, lower edge: columns and rows from 1
  int shutterValue = 0;          // P-Value of 16 bits
  std::string text;
};

struct StudyPlan {
  std::string name, title, bodyPart, studyUid, frameOfReferenceUid;
  std::uint64_t seed = 0;
  std::vector<SeriesPlan> series;
  Json findings = Json::array();  // what a loader should say, with numbers
  std::optional<PresentationPlan> presentation;
};

// "2.25." and a 128-bit number made of name, seed and role (PS3.5 B.2).
std::string uidOf(const std::string& name, std::uint64_t seed, const std::string& role);

// A double as DICOM's DS (at most 16 characters), and the number that a reader gets back.
std::string dsOf(double);
double dsRounded(double);

// Checks the settings and writes them into a copy of the recipe. `variant` names them: it goes into the UIDs.
Result<Json> applySettings(Json recipe, const std::map<std::string, std::string>& settings,
                           std::string& variant);
StudyPlan makeStudyPlan(const Json& recipe, const std::string& variant);
std::uint64_t seedOf(const Json& recipe);

}  // namespace vernier::phantoms
