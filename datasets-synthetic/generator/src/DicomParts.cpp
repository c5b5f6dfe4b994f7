// SPDX-License-Identifier: GPL-3.0-or-later
#include "DicomParts.h"

#include <dcmtk/dcmdata/dcostrmf.h>
#include <dcmtk/dcmdata/dcwcache.h>

#include <cctype>
#include <stdexcept>

namespace vernier::phantoms {

void check(const OFCondition& condition, const char* what) {
  if (condition.bad()) throw std::runtime_error(std::string(what) + ": " + condition.text());
}

void Data::text(const DcmTagKey& tag, const std::string& value) const {
  check(item.putAndInsertString(tag, value.c_str()), "attribute");
}
void Data::number(const DcmTagKey& tag, int value) const {
  check(item.putAndInsertUint16(tag, static_cast<Uint16>(value)), "attribute");
}
Data Data::in(const DcmTagKey& sequence) const {
  DcmItem* made = nullptr;
  check(item.findOrCreateSequenceItem(sequence, made, 0), "sequence");
  return {*made};
}
Data Data::add(const DcmTagKey& sequence) const {
  DcmItem* made = nullptr;
  check(item.findOrCreateSequenceItem(sequence, made, -2), "sequence");
  return {*made};
}
void Data::code(const DcmTagKey& sequence, const char* value, const char* scheme, const char* meaning) const {
  const Data c = add(sequence);
  c.text(DCM_CodeValue, value);
  c.text(DCM_CodingSchemeDesignator, scheme);
  c.text(DCM_CodeMeaning, meaning);
}

std::string vectorDs(glm::dvec3 v) { return dsOf(v.x) + "\\" + dsOf(v.y) + "\\" + dsOf(v.z); }

void putUl(const Data& d, const DcmTagKey& tag, const std::vector<std::uint32_t>& v) {
  std::vector<Uint32> longs(v.begin(), v.end());
  check(d.item.putAndInsertUint32Array(tag, longs.data(), static_cast<unsigned long>(longs.size())),
        "attribute");
}
void putDimensions(const Data& d, const std::string& organisation,
                   const std::vector<DimensionPlan>& dimensions) {
  d.in(DCM_DimensionOrganizationSequence).text(DCM_DimensionOrganizationUID, organisation);
  for (const DimensionPlan& p : dimensions) {
    const Data item = d.add(DCM_DimensionIndexSequence);
    item.text(DCM_DimensionOrganizationUID, organisation);
    check(item.item.putAndInsertTagKey(DCM_DimensionIndexPointer, p.pointer), "dimension");
    check(item.item.putAndInsertTagKey(DCM_FunctionalGroupPointer, p.group), "dimension");
    item.text(DCM_DimensionDescriptionLabel, p.label);
  }
}

void putPatientAndStudy(const Data& d, const StudyPlan& study) {
  std::string id = "VERNIER-" + study.name;
  for (char& c : id) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  d.text(DCM_PatientName, "Phantom^" + study.title);
  d.text(DCM_PatientID, id);
  d.text(DCM_PatientBirthDate, "");
  d.text(DCM_PatientSex, "O");
  d.text(DCM_StudyInstanceUID, study.studyUid);
  d.text(DCM_StudyDate, "20260101");
  d.text(DCM_StudyTime, "120000");
  d.text(DCM_ReferringPhysicianName, "");
  d.text(DCM_StudyID, "1");
  d.text(DCM_AccessionNumber, "");
  d.text(DCM_StudyDescription, "Vernier phantom " + study.name);
}

void putSeriesCommon(const Data& d, const StudyPlan& study, const std::string& modality,
                     const std::string& seriesUid, int number, const std::string& description) {
  d.text(DCM_Modality, modality);
  d.text(DCM_SeriesInstanceUID, seriesUid);
  d.text(DCM_SeriesNumber, std::to_string(number));
  d.text(DCM_SeriesDescription, description);
  d.text(DCM_SeriesDate, "20260101");
  d.text(DCM_SeriesTime, "120000");
  d.text(DCM_FrameOfReferenceUID, study.frameOfReferenceUid);
  d.text(DCM_PositionReferenceIndicator, "");
  d.text(DCM_Manufacturer, "Vernier phantoms");
  d.text(DCM_ManufacturerModelName, "datasets-synthetic");
}

void putMeta(DcmMetaInfo& meta, const char* sopClass, const std::string& sopUid,
             const std::string& transferSyntaxUid) {
  const Data d{meta};
  const Uint8 version[2] = {0, 1};
  check(meta.putAndInsertUint8Array(DCM_FileMetaInformationVersion, version, 2), "meta header");
  d.text(DCM_MediaStorageSOPClassUID, sopClass);
  d.text(DCM_MediaStorageSOPInstanceUID, sopUid);
  d.text(DCM_TransferSyntaxUID, transferSyntaxUid);
  // Ours, whatever library wrote the file: the bytes stay the same when the library moves on.
  d.text(DCM_ImplementationClassUID, uidOf("vernier", 1, "implementation"));
  d.text(DCM_ImplementationVersionName, "VERNIER_PHANTOM1");
  d.item.putAndInsertUint32(DCM_FileMetaInformationGroupLength, 0);
  check(meta.computeGroupLengthAndPadding(EGL_withGL, EPD_noChange, EXS_LittleEndianExplicit,
                                          EET_ExplicitLength),
        "meta header");
}

namespace {
// As DcmFileFormat::saveFile, which would put its own version into the meta header, or warn that it did not.
OFCondition save(DcmFileFormat& format, E_TransferSyntax xfer, const std::filesystem::path& file) {
  DcmOutputFileStream stream(OFFilename(file.c_str()));
  DcmMetaInfo& meta = *format.getMetaInfo();
  DcmDataset& dataset = *format.getDataset();
  meta.transferInit();
  OFCondition done = meta.write(stream, EXS_LittleEndianExplicit, EET_ExplicitLength, nullptr);
  meta.transferEnd();
  if (done.bad()) return done;
  DcmWriteCache cache;
  dataset.transferInit();
  done = dataset.write(stream, xfer, EET_UndefinedLength, &cache, EGL_withoutGL, EPD_noChange);
  dataset.transferEnd();
  if (done.bad()) return done;
  stream.flush();
  return stream.status();
}
}  // namespace

Result<void> saved(DcmFileFormat& format, E_TransferSyntax xfer, const std::filesystem::path& file) {
  const OFCondition done = save(format, xfer, file);
  if (done.good()) return {};
  return makeError(
      ErrorCode::WriteFailed,
      std::string("The file cannot be written (") + done.text() + "); check the folder and the disk.",
      file.filename().string());
}

}  // namespace vernier::phantoms
