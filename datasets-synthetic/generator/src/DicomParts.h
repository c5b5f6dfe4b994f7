// SPDX-License-Identifier: GPL-3.0-or-later
// What the writers of single-frame and multi-frame objects share. Internal: shows DCMTK.
#pragma once
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <filesystem>
#include <string>

#include "Plan.h"
#include "vernier/base/Result.h"

namespace vernier::phantoms {

// Throws std::runtime_error: what DCMTK refuses here is a mistake of ours.
void check(const OFCondition& condition, const char* what);

struct Data {
  DcmItem& item;
  void text(const DcmTagKey& tag, const std::string& value) const;
  void number(const DcmTagKey& tag, int value) const;  // US
  // The first item of a sequence, made where it is not there yet.
  Data in(const DcmTagKey& sequence) const;
  // One more item of a sequence.
  Data add(const DcmTagKey& sequence) const;
  void code(const DcmTagKey& sequence, const char* value, const char* scheme, const char* meaning) const;
};

std::string vectorDs(glm::dvec3 v);

// One dimension by which frames are ordered (PS3.3 C.7.6.17).
struct DimensionPlan {
  DcmTagKey pointer, group;
  const char* label;
};
void putDimensions(const Data& d, const std::string& organisation,
                   const std::vector<DimensionPlan>& dimensions);
void putUl(const Data& d, const DcmTagKey& tag, const std::vector<std::uint32_t>& v);

void putPatientAndStudy(const Data& d, const StudyPlan& study);
// Modality, series, frame of reference and equipment.
void putSeriesCommon(const Data& d, const StudyPlan& study, const std::string& modality,
                     const std::string& seriesUid, int number, const std::string& description);
void putMeta(DcmMetaInfo& meta, const char* sopClass, const std::string& sopUid,
             const std::string& transferSyntaxUid);
Result<void> saved(DcmFileFormat& format, E_TransferSyntax xfer, const std::filesystem::path& file);

}  // namespace vernier::phantoms
