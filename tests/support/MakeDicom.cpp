// SPDX-License-Identifier: GPL-3.0-or-later
#include "MakeDicom.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpath.h>
#include <dcmtk/dcmdata/dcrleerg.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstdio>
#include <stdexcept>

namespace vernier::test {
namespace {

void check(const OFCondition& c, const char* what) {
  if (c.bad()) throw std::runtime_error(std::string("MakeDicom: ") + what + ": " + c.text());
}

DcmTagKey keyOf(const std::string& text) {
  unsigned group = 0, element = 0;
  if (std::sscanf(text.c_str(), "%4x,%4x", &group, &element) != 2)
    throw std::runtime_error("MakeDicom: not a tag: " + text);
  return DcmTagKey(static_cast<Uint16>(group), static_cast<Uint16>(element));
}

template <std::size_t N>
std::string numbers(const std::array<double, N>& v) {
  std::string s;
  for (const double x : v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", x);
    if (!s.empty()) s += '\\';
    s += text;
  }
  return s;
}

void put(DcmItem& item, const DcmTagKey& key, const std::string& value) {
  check(item.putAndInsertString(key, value.c_str()), "attribute");
}
void putUs(DcmItem& item, const DcmTagKey& key, int value) {
  check(item.putAndInsertUint16(key, static_cast<Uint16>(value)), "attribute");
}

// Attributes that are US or SS by the sign of the pixels (padding, smallest and largest value) take an
// integer.
void putAny(DcmItem& item, const DcmTagKey& key, const std::string& value, bool isSigned) {
  DcmTag tag(key);
  if (tag.getEVR() != EVR_xs) return put(item, key, value);
  const int number = std::stoi(value);
  if (isSigned) {
    tag.setVR(DcmVR(EVR_SS));
    check(item.putAndInsertSint16(tag, static_cast<Sint16>(number)), "attribute");
  } else {
    tag.setVR(DcmVR(EVR_US));
    check(item.putAndInsertUint16(tag, static_cast<Uint16>(number)), "attribute");
  }
}

void putWords(DcmItem& item, const DcmTagKey& key, const std::vector<std::uint16_t>& values) {
  DcmTag tag(key);
  if (tag.getEVR() != EVR_OW) tag.setVR(DcmVR(tag.getEVR() == EVR_lt ? EVR_OW : EVR_US));
  check(item.putAndInsertUint16Array(tag, values.data(), static_cast<unsigned long>(values.size())), "words");
}

void putPixels(DcmDataset& d, const DicomSlice& s) {
  const auto count = static_cast<std::size_t>(s.rows) * static_cast<std::size_t>(s.columns) *
                     static_cast<std::size_t>(s.samplesPerPixel) * static_cast<std::size_t>(s.frames);
  const auto valueAt = [&](std::size_t i) { return i < s.pixels.size() ? s.pixels[i] : 0; };
  if (s.bitsAllocated == 1) {  // frames follow each other bit by bit (PS3.5 8.1.1)
    std::vector<Uint8> bytes((count + 15) / 16 * 2);
    for (std::size_t i = 0; i < count; ++i)
      bytes[i / 8] = static_cast<Uint8>(bytes[i / 8] | (valueAt(i) & 1) << i % 8);
    check(d.putAndInsertUint8Array(DCM_PixelData, bytes.data(), static_cast<unsigned long>(bytes.size())),
          "pixels");
    return;
  }
  if (s.bitsAllocated == 8) {
    std::vector<Uint8> bytes(count + count % 2);
    for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<Uint8>(valueAt(i));
    check(d.putAndInsertUint8Array(DCM_PixelData, bytes.data(), static_cast<unsigned long>(bytes.size())),
          "pixels");
    return;
  }
  const std::size_t words = static_cast<std::size_t>(s.bitsAllocated) / 16;
  std::vector<Uint16> data(count * words);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t w = 0; w < words; ++w)
      data[i * words + w] = static_cast<Uint16>(static_cast<std::uint64_t>(valueAt(i)) >> (16 * w));
  check(d.putAndInsertUint16Array(DCM_PixelData, data.data(), static_cast<unsigned long>(data.size())),
        "pixels");
}

void fill(DcmDataset& d, const DicomSlice& s) {
  put(d, DCM_SOPClassUID, s.sopClassUid);
  put(d, DCM_SOPInstanceUID,
      s.sopInstanceUid.empty() ? s.seriesUid + "." + std::to_string(s.instanceNumber) : s.sopInstanceUid);
  put(d, DCM_Modality, s.modality);
  put(d, DCM_PatientID, s.patientId);
  put(d, DCM_PatientName, s.patientName);
  put(d, DCM_StudyInstanceUID, s.studyUid);
  put(d, DCM_SeriesInstanceUID, s.seriesUid);
  put(d, DCM_FrameOfReferenceUID, s.frameOfReferenceUid);
  put(d, DCM_InstanceNumber, std::to_string(s.instanceNumber));
  if (s.hasGeometry) {
    put(d, DCM_ImagePositionPatient, numbers(s.position));
    put(d, DCM_ImageOrientationPatient, numbers(s.orientation));
    put(d, DCM_PixelSpacing, numbers(s.spacing));
  }
  putUs(d, DCM_SamplesPerPixel, s.samplesPerPixel);
  put(d, DCM_PhotometricInterpretation, s.photometric);
  if (s.samplesPerPixel > 1) putUs(d, DCM_PlanarConfiguration, 0);
  if (s.frames != 1) put(d, DCM_NumberOfFrames, std::to_string(s.frames));
  putUs(d, DCM_Rows, s.rows);
  putUs(d, DCM_Columns, s.columns);
  putUs(d, DCM_BitsAllocated, s.bitsAllocated);
  putUs(d, DCM_BitsStored, s.bitsStored);
  putUs(d, DCM_HighBit, s.bitsStored - 1);
  putUs(d, DCM_PixelRepresentation, s.isSigned ? 1 : 0);
  put(d, DCM_RescaleIntercept, numbers(std::array<double, 1>{s.intercept}));
  put(d, DCM_RescaleSlope, numbers(std::array<double, 1>{s.slope}));
  putPixels(d, s);
  for (const auto& [tag, value] : s.set) putAny(d, keyOf(tag), value, s.isSigned);
  for (const auto& [tag, values] : s.words) putWords(d, keyOf(tag), values);
  DcmPathProcessor paths;
  for (const std::string& path : s.sequences) check(paths.applyPathWithValue(&d, path.c_str()), "sequence");
  for (const std::string& tag : s.erase) d.findAndDeleteElement(keyOf(tag));
}

void save(DcmFileFormat& format, const std::filesystem::path& file, const DicomSlice& s) {
  DcmDataset& d = *format.getDataset();
  const E_TransferSyntax syntax = DcmXfer(s.transferSyntaxUid.c_str()).getXfer();
  if (syntax == EXS_RLELossless) {
    static const bool registered = (DcmRLEEncoderRegistration::registerCodecs(), true);
    (void)registered;
    check(d.chooseRepresentation(syntax, nullptr), "RLE");
  }
  check(format.saveFile(file.c_str(), syntax), "save");
}

// The item of the last of "0018,9117/0018,9076", made where it is not there yet.
DcmItem& itemAt(DcmItem& outer, const std::string& path) {
  const auto slash = path.find('/');
  DcmItem* item = nullptr;
  check(outer.findOrCreateSequenceItem(keyOf(path.substr(0, slash)), item, 0), "sequence");
  return slash == std::string::npos ? *item : itemAt(*item, path.substr(slash + 1));
}

void putGroups(DcmDataset& d, const DcmTagKey& sequence, long n, const Groups& groups) {
  DcmItem* item = nullptr;
  check(d.findOrCreateSequenceItem(sequence, item, n), "functional groups");
  for (const Macro& m : groups) {
    DcmItem& macro = itemAt(*item, m.sequence);
    for (const auto& [tag, value] : m.set) putAny(macro, keyOf(tag), value, false);
  }
}
}  // namespace

void writeDicom(const std::filesystem::path& file, const DicomSlice& s) {
  DcmFileFormat format;
  fill(*format.getDataset(), s);
  save(format, file, s);
}

void writeEnhanced(const std::filesystem::path& file, const EnhancedObject& o) {
  DcmFileFormat format;
  DcmDataset& d = *format.getDataset();
  fill(d, o);
  for (const Macro& m : o.sequences) {
    DcmItem& item = itemAt(d, m.sequence);
    for (const auto& [tag, value] : m.set) putAny(item, keyOf(tag), value, false);
  }
  if (o.shared) putGroups(d, DCM_SharedFunctionalGroupsSequence, 0, *o.shared);
  for (std::size_t f = 0; f < o.perFrame.size(); ++f)
    putGroups(d, DCM_PerFrameFunctionalGroupsSequence, static_cast<long>(f), o.perFrame[f]);
  save(format, file, o);
}

EnhancedObject enhancedStack(const std::vector<double>& z) {
  EnhancedObject o;
  o.sopClassUid = "1.2.840.10008.5.1.4.1.1.2.1";
  o.hasGeometry = false;
  o.erase = {"0028,1052", "0028,1053"};
  o.frames = static_cast<int>(z.size());
  o.set = {{"0028,0008", std::to_string(z.size())}};
  o.shared =
      Groups{{"0020,9116", {{"0020,0037", "1\\0\\0\\0\\1\\0"}}}, {"0028,9110", {{"0028,0030", "1\\1"}}}};
  for (std::size_t f = 0; f < z.size(); ++f) {
    o.perFrame.push_back({{"0020,9113", {{"0020,0032", numbers(std::array<double, 3>{0, 0, z[f]})}}}});
    for (int p = 0; p < o.rows * o.columns; ++p) o.pixels.push_back(100 * static_cast<std::int64_t>(f) + p);
  }
  return o;
}

void writeSeries(const std::filesystem::path& folder, int n, std::array<double, 3> step_mm,
                 const DicomSlice& first) {
  std::filesystem::create_directories(folder);
  for (int k = 0; k < n; ++k) {
    DicomSlice s = first;
    s.instanceNumber = k + 1;
    for (std::size_t a = 0; a < 3; ++a) s.position[a] += k * step_mm[a];
    if (s.pixels.empty()) s.pixels.assign(static_cast<std::size_t>(s.rows * s.columns), k * 10);
    char name[16];
    std::snprintf(name, sizeof name, "%03d.dcm", k);
    writeDicom(folder / name, s);
  }
}

}  // namespace vernier::test
