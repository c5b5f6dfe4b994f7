// SPDX-License-Identifier: GPL-3.0-or-later
#include "MakePresentation.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dcpath.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstdio>
#include <stdexcept>

namespace vernier::test {

std::string lutWords(const std::vector<unsigned>& entries) {
  std::string s;
  for (const unsigned e : entries) {
    char text[8];
    std::snprintf(text, sizeof text, "%s%04x", s.empty() ? "" : "\\", e & 0xFFFF);
    s += text;
  }
  return s;
}

void writePresentation(const std::filesystem::path& file, const PresentationFile& p) {
  DcmFileFormat format;
  DcmDataset& d = *format.getDataset();
  DcmPathProcessor paths;
  const auto set = [&](const std::string& assignment) {
    const OFCondition c = paths.applyPathWithValue(&d, assignment.c_str());
    if (c.bad()) throw std::runtime_error("MakePresentation: " + assignment + ": " + c.text());
  };
  set("SOPClassUID=" + p.sopClassUid);
  set("SOPInstanceUID=" + p.sopInstanceUid);
  set("Modality=PR");
  set("PatientID=" + p.patientId);
  set("StudyInstanceUID=" + p.studyUid);
  set("SeriesInstanceUID=" + p.seriesUid);
  set("ContentLabel=" + p.label);
  for (std::size_t n = 0; n < p.imageUids.size(); ++n) {
    const std::string image =
        "ReferencedSeriesSequence[0].ReferencedImageSequence[" + std::to_string(n) + "].";
    set(image + "ReferencedSOPClassUID=1.2.840.10008.5.1.4.1.1.2");
    set(image + "ReferencedSOPInstanceUID=" + p.imageUids[n]);
  }
  for (const std::string& s : p.set) set(s);
  if (const OFCondition c = format.saveFile(file.c_str(), EXS_LittleEndianExplicit); c.bad())
    throw std::runtime_error(std::string("MakePresentation: ") + c.text());
}

}  // namespace vernier::test
