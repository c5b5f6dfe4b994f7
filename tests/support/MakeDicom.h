// SPDX-License-Identifier: GPL-3.0-or-later
// Tiny DICOM files for tests: one call writes one object. Every field has a usable default; `set` overrides
// or adds any attribute as text, `erase` takes one out. Lengths mm, positions LPS. Throws std::runtime_error
// when writing fails.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace vernier::test {

struct DicomSlice {
  std::string patientId = "TEST-1", patientName = "Test^Slice";
  std::string studyUid = "2.25.1001", seriesUid = "2.25.1002", frameOfReferenceUid = "2.25.1003";
  std::string sopInstanceUid;  // empty: made from the series UID and the instance number
  std::string sopClassUid = "1.2.840.10008.5.1.4.1.1.2";  // CT Image Storage
  std::string modality = "CT";
  int instanceNumber = 1;

  int rows = 4, columns = 4, frames = 1, samplesPerPixel = 1;
  int bitsAllocated = 16, bitsStored = 16;  // HighBit = bitsStored - 1
  bool isSigned = true;
  std::string photometric = "MONOCHROME2";
  // Stored values, row by row (low bitsAllocated bits are written); empty: all zero. Missing ones are zero.
  std::vector<std::int64_t> pixels;

  bool hasGeometry = true;
  std::array<double, 3> position{0, 0, 0};
  std::array<double, 6> orientation{1, 0, 0, 0, 1, 0};
  std::array<double, 2> spacing{1, 1};  // row\column: first = distance between rows
  double slope = 1, intercept = 0;

  // {"0018,0081", "90"}: text of any attribute, values divided by a backslash; applied last.
  std::vector<std::pair<std::string, std::string>> set;
  std::vector<std::string> erase;  // {"0020,0032"}
  // {"0028,1201", {0, 65535}}: words of an attribute of VR US or OW, as palettes and their descriptors are.
  std::vector<std::pair<std::string, std::vector<std::uint16_t>>> words;
  // "VOILUTSequence[0].LUTDescriptor=256\\0\\8": any attribute by its path, as in MakePresentation.h.
  std::vector<std::string> sequences;

  // Implicit LE, Explicit LE (default), Explicit BE, Deflated, or RLE lossless.
  std::string transferSyntaxUid = "1.2.840.10008.1.2.1";
};

void writeDicom(const std::filesystem::path& file, const DicomSlice&);

// One functional group macro: the path of its sequence ("0020,9113", or "0018,9117/0018,9076" for a sequence
// in a sequence) and attributes of its one item.
struct Macro {
  std::string sequence;
  std::vector<std::pair<std::string, std::string>> set;
};
using Groups = std::vector<Macro>;
// An object that describes its frames one by one.
struct EnhancedObject : DicomSlice {
  std::optional<Groups> shared;
  std::vector<Groups> perFrame;
  Groups sequences;  // of the root
};
void writeEnhanced(const std::filesystem::path& file, const EnhancedObject&);

// An Enhanced CT, one axial frame of 4 x 4 pixels of 1 mm at each z; stored value = 100 frame + pixel.
EnhancedObject enhancedStack(const std::vector<double>& z);

// n slices of one series in `folder` (000.dcm...), slice k at position + k * (dx, dy, dz), instance number k
// + 1, all stored values = k * 10.
void writeSeries(const std::filesystem::path& folder, int n, std::array<double, 3> step_mm,
                 const DicomSlice& first = {});

}  // namespace vernier::test
