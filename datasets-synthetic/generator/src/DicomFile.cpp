// SPDX-License-Identifier: GPL-3.0-or-later
// Attributes follow PS3.3 A.3 (CT), A.4 (MR), A.8.1 (Secondary Capture): every Type 1 and 2 attribute of the
// mandatory modules, dates and times fixed.
#include "DicomFile.h"

#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>

#include "DicomParts.h"
#include "Encode.h"
#include "Sample.h"

namespace vernier::phantoms {

const char* classOf(Storage s) {
  switch (s) {
    case Storage::Ct:
      return UID_CTImageStorage;
    case Storage::Mr:
      return UID_MRImageStorage;
    case Storage::SecondaryCapture:
      return UID_SecondaryCaptureImageStorage;
    case Storage::EnhancedCt:
    case Storage::EnhancedMr:
      break;  // MultiFrame.cpp
  }
  return "";
}

namespace {

// The patient letter of a direction's largest component.
const char* letterOf(glm::dvec3 v) {
  const glm::dvec3 a = glm::abs(v);
  if (a.x >= a.y && a.x >= a.z) return v.x > 0.0 ? "L" : "R";
  if (a.y >= a.z) return v.y > 0.0 ? "P" : "A";
  return v.z > 0.0 ? "H" : "F";
}

void putSeries(const Data& d, const StudyPlan& study, const SeriesPlan& series) {
  const bool secondary = series.storage == Storage::SecondaryCapture;
  putSeriesCommon(d, study, modalityOf(series.storage), series.seriesUid, series.number, series.description);
  d.text(DCM_PatientPosition, "HFS");
  if (secondary) d.text(DCM_ConversionType, "SYN");
  d.text(DCM_BodyPartExamined, study.bodyPart);
}

void putAcquisition(const Data& d, const SeriesPlan& series) {
  if (series.storage == Storage::Ct) {
    d.text(DCM_KVP, "120");
    d.text(DCM_AcquisitionNumber, "1");
  } else if (series.storage == Storage::Mr) {
    d.text(DCM_ScanningSequence, "GR");
    d.text(DCM_SequenceVariant, "SP");
    d.text(DCM_ScanOptions, "");
    d.text(DCM_MRAcquisitionType, "3D");
    d.text(DCM_RepetitionTime, "25");
    d.text(DCM_EchoTime, "3.5");
    d.text(DCM_EchoTrainLength, "1");
  }
}

void putImage(const Data& d, const SeriesPlan& series, const SlicePlan& slice) {
  const bool lossy = !series.lossyMethod.empty();
  d.text(DCM_SOPClassUID, classOf(series.storage));
  d.text(DCM_SOPInstanceUID, slice.sopUid);
  d.text(DCM_ImageType, std::string(lossy ? "DERIVED" : "ORIGINAL") + "\\PRIMARY\\" +
                            (series.storage == Storage::Mr ? "OTHER" : "AXIAL"));
  if (lossy) d.text(DCM_DerivationDescription, "Lossy compression");
  d.text(DCM_InstanceNumber, std::to_string(slice.instanceNumber));
  d.text(DCM_ContentDate, "20260101");
  d.text(DCM_ContentTime, "120000");
  d.text(DCM_AcquisitionDate, "20260101");
  d.text(DCM_AcquisitionTime, "120000");
  d.text(DCM_BurnedInAnnotation, "NO");
  d.text(DCM_ImagePositionPatient, vectorDs(slice.origin_mm));
  d.text(DCM_ImageOrientationPatient, vectorDs(slice.rowDirection) + "\\" + vectorDs(slice.columnDirection));
  d.text(DCM_PatientOrientation,
         std::string(letterOf(slice.rowDirection)) + "\\" + letterOf(slice.columnDirection));
  d.text(DCM_PixelSpacing, dsOf(series.rowSpacing_mm) + "\\" + dsOf(series.columnSpacing_mm));
  d.text(DCM_SliceThickness, dsOf(series.thickness_mm));
}

// Red and green run evenly and are one linear segment behind their first entry; blue is listed.
std::vector<Uint16> segmentsOf(const std::vector<Uint16>& entries, bool even) {
  const auto count = static_cast<Uint16>(entries.size());
  if (even) return {0, 1, entries.front(), 1, static_cast<Uint16>(count - 1), entries.back()};
  std::vector<Uint16> all{0, count};
  all.insert(all.end(), entries.begin(), entries.end());
  return all;
}

void putPalette(const Data& d, const SeriesPlan& series) {
  const DcmTagKey descriptors[] = {DCM_RedPaletteColorLookupTableDescriptor,
                                   DCM_GreenPaletteColorLookupTableDescriptor,
                                   DCM_BluePaletteColorLookupTableDescriptor};
  const DcmTagKey tables[] = {DCM_RedPaletteColorLookupTableData, DCM_GreenPaletteColorLookupTableData,
                              DCM_BluePaletteColorLookupTableData};
  const DcmTagKey segments[] = {DCM_SegmentedRedPaletteColorLookupTableData,
                                DCM_SegmentedGreenPaletteColorLookupTableData,
                                DCM_SegmentedBluePaletteColorLookupTableData};
  for (std::size_t c = 0; c < 3; ++c) {
    const Uint16 descriptor[3] = {static_cast<Uint16>(series.palette.size()), 0,
                                  static_cast<Uint16>(series.paletteBits)};
    check(d.item.putAndInsertUint16Array(DcmTag(descriptors[c], EVR_US), descriptor, 3), "palette");
    std::vector<Uint16> words;
    for (const auto& entry : series.palette) words.push_back(entry[c]);
    if (series.paletteBits == 8) {  // two entries in each word
      for (std::size_t n = 0; n < words.size() / 2; ++n)
        words[n] = static_cast<Uint16>(words[2 * n] | words[2 * n + 1] << 8);
      words.resize(words.size() / 2);
    }
    if (series.paletteSegmented) words = segmentsOf(words, c < 2);
    check(d.item.putAndInsertUint16Array(series.paletteSegmented ? segments[c] : tables[c], words.data(),
                                         static_cast<unsigned long>(words.size())),
          "palette");
  }
}

void putPixelDescription(const Data& d, const SeriesPlan& series) {
  d.number(DCM_SamplesPerPixel, series.samples);
  d.text(DCM_PhotometricInterpretation, series.samples == 3      ? "RGB"
                                        : series.palette.empty() ? "MONOCHROME2"
                                                                 : "PALETTE COLOR");
  if (series.samples == 3) d.number(DCM_PlanarConfiguration, 0);
  d.number(DCM_Rows, static_cast<int>(series.rows));
  d.number(DCM_Columns, static_cast<int>(series.columns));
  d.number(DCM_BitsAllocated, series.bitsAllocated);
  d.number(DCM_BitsStored, series.bitsStored);
  d.number(DCM_HighBit, series.bitsStored - 1);
  d.number(DCM_PixelRepresentation, series.isSigned ? 1 : 0);
  if (series.padding) {
    if (series.isSigned)
      check(d.item.putAndInsertSint16(DCM_PixelPaddingValue, static_cast<Sint16>(*series.padding)),
            "padding");
    else
      d.number(DCM_PixelPaddingValue, *series.padding);
  }
  if (!series.palette.empty()) putPalette(d, series);
  if (series.storage != Storage::Mr && series.samples == 1 && series.palette.empty()) {
    d.text(DCM_RescaleIntercept, dsOf(series.intercept));
    d.text(DCM_RescaleSlope, dsOf(series.slope));
    d.text(DCM_RescaleType, "HU");
  }
}

void putWindows(const Data& d, const SlicePlan& slice) {
  if (slice.windows.empty()) return;
  std::string centers, widths, names;
  for (const Window& w : slice.windows) {
    const char* separator = centers.empty() ? "" : "\\";
    centers += separator + w.center;
    widths += separator + w.width;
    names += separator + w.explanation;
  }
  d.text(DCM_WindowCenter, centers);
  d.text(DCM_WindowWidth, widths);
  d.text(DCM_WindowCenterWidthExplanation, names);
  if (!slice.windowFunction.empty()) d.text(DCM_VOILUTFunction, slice.windowFunction);
}

void putPlainPixels(DcmItem& item, const SeriesPlan& series, const std::vector<std::int32_t>& stored) {
  if (series.bitsAllocated == 8) {
    std::vector<Uint8> narrow(stored.size());
    for (std::size_t n = 0; n < stored.size(); ++n) narrow[n] = static_cast<Uint8>(stored[n]);
    check(
        item.putAndInsertUint8Array(DCM_PixelData, narrow.data(), static_cast<unsigned long>(narrow.size())),
        "pixels");
    return;
  }
  const std::uint32_t mask = (1u << series.bitsStored) - 1;
  std::vector<Uint16> wide(stored.size());
  for (std::size_t n = 0; n < stored.size(); ++n)
    wide[n] = static_cast<Uint16>(static_cast<std::uint32_t>(stored[n]) & mask);
  check(item.putAndInsertUint16Array(DCM_PixelData, wide.data(), static_cast<unsigned long>(wide.size())),
        "pixels");
}

void putEncodedPixels(const Data& d, const SeriesPlan& series, E_TransferSyntax xfer,
                      const std::vector<std::int32_t>& stored) {
  std::vector<std::uint8_t> bytes = encodeFrame(series, stored);
  if (!series.lossyMethod.empty()) {
    d.text(DCM_LossyImageCompression, "01");
    const double ratio =
        static_cast<double>(stored.size()) * series.bitsAllocated / 8.0 / static_cast<double>(bytes.size());
    d.text(DCM_LossyImageCompressionRatio,
           dsOf(static_cast<double>(static_cast<int>(ratio * 100.0)) / 100.0));
    d.text(DCM_LossyImageCompressionMethod, series.lossyMethod);
  }
  auto* sequence = new DcmPixelSequence(DCM_PixelSequenceTag);
  auto* offsets = new DcmPixelItem(DCM_PixelItemTag);
  sequence->insert(offsets);
  DcmOffsetList list;
  check(sequence->storeCompressedFrame(list, bytes.data(), static_cast<Uint32>(bytes.size()), 0), "fragment");
  check(offsets->createOffsetTable(list), "offset table");
  auto* pixels = new DcmPixelData(DCM_PixelData);
  pixels->putOriginalRepresentation(xfer, nullptr, sequence);  // owns the sequence from here
  check(d.item.insert(pixels, true), "pixels");
}

}  // namespace

Result<void> writeDicom(const StudyPlan& study, const SeriesPlan& series, const SlicePlan& slice,
                        const std::vector<std::int32_t>& stored, const std::filesystem::path& file) {
  DcmFileFormat format;
  DcmDataset& dataset = *format.getDataset();
  const Data d{dataset};
  const E_TransferSyntax xfer = DcmXfer(series.transferSyntaxUid.c_str()).getXfer();
  putPatientAndStudy(d, study);
  putSeries(d, study, series);
  putAcquisition(d, series);
  putImage(d, series, slice);
  putPixelDescription(d, series);
  putWindows(d, slice);
  if (isEncapsulated(series.transferSyntaxUid))
    putEncodedPixels(d, series, xfer, stored);
  else
    putPlainPixels(dataset, series, stored);
  putMeta(*format.getMetaInfo(), classOf(series.storage), slice.sopUid, series.transferSyntaxUid);
  return saved(format, xfer, file);
}

}  // namespace vernier::phantoms
