// SPDX-License-Identifier: GPL-3.0-or-later
// What lies beside a CT: a segmentation of single bits (PS3.3 A.51) and a dose grid (A.18). Both are sampled
// from sources of their own in the recipe, so that their answers do not come from the CT's pixels.
#include <algorithm>

#include "Answers.h"
#include "DicomParts.h"
#include "MultiFrame.h"
#include "Sample.h"

namespace vernier::phantoms {
namespace {

Json jsonOf(glm::dvec3 v) { return Json::array({v.x, v.y, v.z}); }

struct SegmentFrame {
  std::size_t segment = 0, slice = 0;
  std::vector<std::int32_t> bits;
};

// Frames by segment, then by place; those in which a segment is empty are left out.
std::vector<SegmentFrame> framesOf(const Json& segments, const SeriesPlan& ct, std::uint64_t seed) {
  std::vector<SegmentFrame> frames;
  SeriesPlan plan = ct;
  plan.slope = 1;
  plan.intercept = 0;
  plan.padding.reset();
  for (std::size_t n = 0; n < segments.size(); ++n) {
    const Json recipe{
        {"source", {{"kind", "solids"}, {"background", 0}, {"solids", segments[n].at("solids")}}}};
    const std::vector<Solid> solids = solidsOf(recipe, seed);
    const auto field = makeField(recipe, seed, solids);
    for (std::size_t k = 0; k < ct.slices.size(); ++k) {
      SegmentFrame f{n, k, sampleSlice(*field, plan, ct.slices[k], seed)};
      if (std::any_of(f.bits.begin(), f.bits.end(), [](std::int32_t v) { return v != 0; }))
        frames.push_back(std::move(f));
    }
  }
  return frames;
}

void putSegments(const Data& d, const Json& segments) {
  for (std::size_t n = 0; n < segments.size(); ++n) {
    const Json& s = segments[n];
    const Data item = d.add(DCM_SegmentSequence);
    item.number(DCM_SegmentNumber, static_cast<int>(n) + 1);
    item.text(DCM_SegmentLabel, s.at("label"));
    item.text(DCM_SegmentAlgorithmType, "AUTOMATIC");
    item.text(DCM_SegmentAlgorithmName, "closed form");
    const auto coded = [&](const DcmTagKey& sequence, const Json& code) {
      item.code(sequence, code.at(0).get<std::string>().c_str(), "SCT",
                code.at(1).get<std::string>().c_str());
    };
    coded(DCM_SegmentedPropertyCategoryCodeSequence, s.at("category"));
    coded(DCM_SegmentedPropertyTypeCodeSequence, s.at("type"));
    Uint16 lab[3];
    for (std::size_t c = 0; c < 3; ++c) lab[c] = s.at("cielab").at(c);
    check(item.item.putAndInsertUint16Array(DCM_RecommendedDisplayCIELabValue, lab, 3), "colour");
  }
}

void putSource(const Data& frame, const SlicePlan& slice) {
  const Data derivation = frame.in(DCM_DerivationImageSequence);
  derivation.code(DCM_DerivationCodeSequence, "113076", "DCM", "Segmentation");
  const Data source = derivation.in(DCM_SourceImageSequence);
  source.text(DCM_ReferencedSOPClassUID, UID_CTImageStorage);
  source.text(DCM_ReferencedSOPInstanceUID, slice.sopUid);
  source.code(DCM_PurposeOfReferenceCodeSequence, "121322", "DCM",
              "Source image for image processing operation");
}

// Frames follow each other bit by bit, the first pixel in the lowest bit (PS3.5 8.1.1).
void putBits(const Data& d, const std::vector<SegmentFrame>& frames) {
  std::vector<Uint8> bytes;
  std::size_t bit = 0;
  for (const SegmentFrame& f : frames)
    for (const std::int32_t v : f.bits) {
      if (bit % 8 == 0) bytes.push_back(0);
      bytes.back() = static_cast<Uint8>(bytes.back() | (v & 1) << bit++ % 8);
    }
  if (bytes.size() % 2) bytes.push_back(0);
  check(d.item.putAndInsertUint8Array(DCM_PixelData, bytes.data(), static_cast<unsigned long>(bytes.size())),
        "pixels");
}

void putGrid(const Data& d, std::int64_t rows, std::int64_t columns, std::size_t frames, int bits) {
  d.number(DCM_SamplesPerPixel, 1);
  d.text(DCM_PhotometricInterpretation, "MONOCHROME2");
  d.text(DCM_NumberOfFrames, std::to_string(frames));
  d.number(DCM_Rows, static_cast<int>(rows));
  d.number(DCM_Columns, static_cast<int>(columns));
  d.number(DCM_BitsAllocated, bits);
  d.number(DCM_BitsStored, bits);
  d.number(DCM_HighBit, bits - 1);
  d.number(DCM_PixelRepresentation, 0);
}

struct Identity {
  std::string seriesUid, sopUid;
};

Json segmentationAnswers(const Json& segments, const std::vector<SegmentFrame>& frames, const SeriesPlan& ct,
                         const Identity& id) {
  Json out{{"file", "SEG0001.dcm"},
           {"series_uid", id.seriesUid},
           {"sop_instance_uid", id.sopUid},
           {"segments", Json::array()},
           {"frames", Json::array()}};
  for (std::size_t n = 0; n < segments.size(); ++n) {
    std::int64_t voxels = 0;
    for (const SegmentFrame& f : frames)
      if (f.segment == n) voxels += sumsOf(f.bits).sum;
    out["segments"].push_back({{"number", n + 1}, {"label", segments[n].at("label")}, {"voxels", voxels}});
  }
  for (const SegmentFrame& f : frames)
    out["frames"].push_back({{"segment", f.segment + 1},
                             {"origin_mm", jsonOf(ct.slices[f.slice].origin_mm)},
                             {"image", ct.slices[f.slice].fileName},
                             {"set_pixels", sumsOf(f.bits).sum}});
  return out;
}

Result<Json> writeSegmentation(const Json& spec, const StudyPlan& study, const Identity& id,
                               const std::filesystem::path& folder) {
  const SeriesPlan& ct = study.series.front();
  const Json& segments = spec.at("segments");
  const std::vector<SegmentFrame> frames = framesOf(segments, ct, study.seed);
  DcmFileFormat format;
  const Data d{*format.getDataset()};
  putPatientAndStudy(d, study);
  putSeriesCommon(d, study, "SEG", id.seriesUid, 2, study.title);
  for (const auto& [tag, value] :
       std::initializer_list<std::pair<DcmTagKey, std::string>>{{DCM_SOPClassUID, UID_SegmentationStorage},
                                                                {DCM_SOPInstanceUID, id.sopUid},
                                                                {DCM_InstanceNumber, "1"},
                                                                {DCM_ImageType, "DERIVED\\PRIMARY"},
                                                                {DCM_ContentDate, "20260101"},
                                                                {DCM_ContentTime, "120000"},
                                                                {DCM_ContentLabel, "SEGMENTATION"},
                                                                {DCM_ContentDescription, ""},
                                                                {DCM_ContentCreatorName, ""},
                                                                {DCM_SegmentationType, "BINARY"},
                                                                {DCM_LossyImageCompression, "00"},
                                                                {DCM_DeviceSerialNumber, "1"},
                                                                {DCM_SoftwareVersions, "1"}})
    d.text(tag, value);
  putSegments(d, segments);
  putDimensions(d, uidOf(study.name, study.seed, "dimensions"),
                {{DCM_ReferencedSegmentNumber, DCM_SegmentIdentificationSequence, "Segment"},
                 {DCM_ImagePositionPatient, DCM_PlanePositionSequence, "Position"}});
  const Data shared = d.in(DCM_SharedFunctionalGroupsSequence);
  shared.in(DCM_PlaneOrientationSequence)
      .text(DCM_ImageOrientationPatient,
            vectorDs(ct.slices.front().rowDirection) + "\\" + vectorDs(ct.slices.front().columnDirection));
  const Data measures = shared.in(DCM_PixelMeasuresSequence);
  measures.text(DCM_PixelSpacing, dsOf(ct.rowSpacing_mm) + "\\" + dsOf(ct.columnSpacing_mm));
  measures.text(DCM_SliceThickness, dsOf(ct.thickness_mm));
  measures.text(DCM_SpacingBetweenSlices, dsOf(ct.step_mm));
  for (const SegmentFrame& f : frames) {
    const Data frame = d.add(DCM_PerFrameFunctionalGroupsSequence);
    putUl(frame.in(DCM_FrameContentSequence), DCM_DimensionIndexValues,
          {static_cast<std::uint32_t>(f.segment) + 1, static_cast<std::uint32_t>(f.slice) + 1});
    frame.in(DCM_PlanePositionSequence)
        .text(DCM_ImagePositionPatient, vectorDs(ct.slices[f.slice].origin_mm));
    frame.in(DCM_SegmentIdentificationSequence)
        .number(DCM_ReferencedSegmentNumber, static_cast<int>(f.segment) + 1);
    putSource(frame, ct.slices[f.slice]);
  }
  const Data reference = d.in(DCM_ReferencedSeriesSequence);
  reference.text(DCM_SeriesInstanceUID, ct.seriesUid);
  for (const SlicePlan& slice : ct.slices) {
    const Data image = reference.add(DCM_ReferencedInstanceSequence);
    image.text(DCM_ReferencedSOPClassUID, UID_CTImageStorage);
    image.text(DCM_ReferencedSOPInstanceUID, slice.sopUid);
  }
  putGrid(d, ct.rows, ct.columns, frames.size(), 1);
  putBits(d, frames);
  putMeta(*format.getMetaInfo(), UID_SegmentationStorage, id.sopUid, UID_LittleEndianExplicitTransferSyntax);
  if (Result<void> ok = saved(format, EXS_LittleEndianExplicit, folder / "SEG0001.dcm"); !ok)
    return ok.error();
  return Json{{"segmentation", segmentationAnswers(segments, frames, ct, id)}};
}

// The dose grid as a series of planes; stored values fit 30 bits whatever is written.
SeriesPlan dosePlan(const Json& spec) {
  const Json& grid = spec.at("grid");
  SeriesPlan s;
  s.columns = grid.at("columns");
  s.rows = grid.at("rows");
  const glm::dvec3 spacing = vecOf(grid.at("spacing_mm")), first = vecOf(grid.at("first_mm"));
  s.columnSpacing_mm = spacing.x;
  s.rowSpacing_mm = spacing.y;
  s.step_mm = spacing.z;
  s.isSigned = false;
  s.bitsStored = spec.at("bits") == "32" ? 30 : 16;
  s.slope = spec.at("bits") == "32" ? 1e-6 : 1e-3;
  for (std::int64_t k = 0; k < grid.at("slices").get<std::int64_t>(); ++k) {
    SlicePlan plane;
    plane.origin_mm = first + glm::dvec3(0, 0, static_cast<double>(k) * spacing.z);
    s.slices.push_back(plane);
  }
  return s;
}

Json doseProbe(const Json& p, const SeriesPlan& s, const Field& field,
               const std::vector<std::vector<std::int32_t>>& stored) {
  const glm::dvec3 q = vecOf(p.at("at_mm")) - s.slices.front().origin_mm;
  const auto index = [](double mm, double spacing_mm, std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(std::max(0.0, mm / spacing_mm + 0.5)));
  };
  const std::size_t i = index(q.x, s.columnSpacing_mm, static_cast<std::size_t>(s.columns)),
                    j = index(q.y, s.rowSpacing_mm, static_cast<std::size_t>(s.rows)),
                    k = index(q.z, s.step_mm, s.slices.size());
  const glm::dvec3 centre = s.slices[k].origin_mm + glm::dvec3(static_cast<double>(i) * s.columnSpacing_mm,
                                                               static_cast<double>(j) * s.rowSpacing_mm, 0);
  const std::int32_t v = stored[k][j * static_cast<std::size_t>(s.columns) + i];
  return {{"name", p.at("name")},
          {"frame", k + 1},
          {"column", i},
          {"row", j},
          {"patient_mm", jsonOf(centre)},
          {"stored", v},
          {"dose_gy", s.slope * v},
          {"dose_gy_unrounded", idealAt(field, centre)}};
}

Result<Json> writeDose(const Json& spec, const StudyPlan& study, const Identity& id,
                       const std::filesystem::path& folder) {
  const SeriesPlan s = dosePlan(spec);
  const auto field = makeField(spec, study.seed, {});
  std::vector<std::vector<std::int32_t>> stored;
  for (const SlicePlan& plane : s.slices) stored.push_back(sampleSlice(*field, s, plane, study.seed));

  DcmFileFormat format;
  const Data d{*format.getDataset()};
  putPatientAndStudy(d, study);
  putSeriesCommon(d, study, "RTDOSE", id.seriesUid, 2, study.title);
  std::string offsets;
  const bool absolute = spec.at("offsets") == "absolute";
  for (const SlicePlan& plane : s.slices)
    offsets += (offsets.empty() ? "" : "\\") +
               dsOf(absolute ? plane.origin_mm.z : plane.origin_mm.z - s.slices.front().origin_mm.z);
  for (const auto& [tag, value] : std::initializer_list<std::pair<DcmTagKey, std::string>>{
           {DCM_SOPClassUID, UID_RTDoseStorage},
           {DCM_SOPInstanceUID, id.sopUid},
           {DCM_InstanceNumber, "1"},
           {DCM_ContentDate, "20260101"},
           {DCM_ContentTime, "120000"},
           {DCM_OperatorsName, ""},
           {DCM_ImagePositionPatient, vectorDs(s.slices.front().origin_mm)},
           {DCM_ImageOrientationPatient, "1\\0\\0\\0\\1\\0"},
           {DCM_PixelSpacing, dsOf(s.rowSpacing_mm) + "\\" + dsOf(s.columnSpacing_mm)},
           {DCM_SliceThickness, ""},
           {DCM_GridFrameOffsetVector, offsets},
           {DCM_DoseUnits, "GY"},
           {DCM_DoseType, "PHYSICAL"},
           {DCM_DoseSummationType, "PLAN"},
           {DCM_DoseGridScaling, dsOf(s.slope)}})
    d.text(tag, value);
  check(d.item.putAndInsertTagKey(DCM_FrameIncrementPointer, DCM_GridFrameOffsetVector), "attribute");
  const Data plan = d.in(DCM_ReferencedRTPlanSequence);
  plan.text(DCM_ReferencedSOPClassUID, UID_RTPlanStorage);
  plan.text(DCM_ReferencedSOPInstanceUID, uidOf(study.name, study.seed, "plan"));
  const int bits = spec.at("bits") == "32" ? 32 : 16;
  putGrid(d, s.rows, s.columns, stored.size(), bits);
  std::vector<Uint16> words;
  for (const auto& plane : stored)
    for (const std::int32_t v : plane) {
      words.push_back(static_cast<Uint16>(v & 0xFFFF));
      if (bits == 32) words.push_back(static_cast<Uint16>(v >> 16));
    }
  check(d.item.putAndInsertUint16Array(DCM_PixelData, words.data(), static_cast<unsigned long>(words.size())),
        "pixels");
  putMeta(*format.getMetaInfo(), UID_RTDoseStorage, id.sopUid, UID_LittleEndianExplicitTransferSyntax);
  if (Result<void> ok = saved(format, EXS_LittleEndianExplicit, folder / "DOSE0001.dcm"); !ok)
    return ok.error();

  Json out{{"file", "DOSE0001.dcm"},       {"series_uid", id.seriesUid}, {"sop_instance_uid", id.sopUid},
           {"dose_grid_scaling", s.slope}, {"step_mm", s.step_mm},       {"planes", Json::array()},
           {"probes", Json::array()}};
  for (std::size_t k = 0; k < stored.size(); ++k)
    out["planes"].push_back(
        {{"origin_mm", jsonOf(s.slices[k].origin_mm)}, {"stored_sum", sumsOf(stored[k]).sum}});
  for (const Json& p : spec.at("probes")) out["probes"].push_back(doseProbe(p, s, *field, stored));
  return Json{{"dose", std::move(out)}};
}

}  // namespace

Result<Json> writeBeside(const Json& recipe, const std::string& variant, const StudyPlan& study,
                         const std::filesystem::path& folder) {
  if (!recipe.contains("multi_frame")) return Json();
  const Json& spec = recipe["multi_frame"];
  const std::string kind = spec.at("kind"), name = study.name + ":" + variant;
  const Identity id{uidOf(name, study.seed, kind + " series"), uidOf(name, study.seed, kind)};
  if (kind == "segmentation") return writeSegmentation(spec, study, id, folder);
  if (kind == "dose") return writeDose(spec, study, id, folder);
  return Json();
}

}  // namespace vernier::phantoms
