// SPDX-License-Identifier: GPL-3.0-or-later
#include "InfoParts.h"

#include <set>

#include "VolumeFacts.h"

namespace vernier {
namespace {

const char* nameOf(Severity s) {
  switch (s) {
    case Severity::Info:
      return "info";
    case Severity::Notice:
      return "notice";
    case Severity::Warning:
      return "warning";
    case Severity::Refusal:
      return "refusal";
  }
  return "";
}
Json toJson(const FindingValue& v) {
  return std::visit([](const auto& x) { return Json(x); }, v);
}
Json toJson(const Finding& f) {
  Json j{{"code", f.code}, {"severity", nameOf(f.severity)}, {"sentence", f.sentence}};
  for (const auto& [key, value] : f.numbers) j[key] = toJson(value);
  return j;
}

// Of the voxels, whose findings stand in for those of the header.
Json voxelsJson(const StudySet& set, const VolumeFile& v, Json& findings) {
  const auto facts = volumeFacts(set.files[v.file]);
  if (!facts) return {{"error", toJson(facts.error())}};
  findings = toJson(facts->findings);
  Json j{{"stored_sha256", facts->sha256}};
  for (const auto& [key, value] : {std::pair{"stored_min", &VolumeFacts::Channel::min},
                                   std::pair{"stored_max", &VolumeFacts::Channel::max},
                                   std::pair{"stored_sum", &VolumeFacts::Channel::sum}}) {
    if (facts->channels.size() == 1) {
      j[key] = facts->channels[0].*value;
      continue;
    }
    for (const VolumeFacts::Channel& c : facts->channels) j[key].push_back(c.*value);
  }
  return j;
}

Json volumeFileJson(const StudySet& set, const VolumeFile& v, const InfoOptions& options) {
  Json j{{"file", set.files[v.file].shown}};
  if (v.error) j["error"] = toJson(*v.error);
  if (!v.facts) return j;
  const VolumeInfo& i = v.facts->info;
  const glm::dvec3 spacing = i.grid.spacing_mm();
  j["format"] = v.facts->format;
  j["dims"] = {i.grid.columns, i.grid.rows, i.grid.slices};
  j["frames"] = v.facts->frames;
  j["stored_type"] = v.facts->storedType;
  j["type_in_memory"] = nameOf(i.type);
  j["channels"] = i.channels;
  j["spacing_mm"] = {spacing.x, spacing.y, spacing.z};
  j["patient_from_voxel"] = toJson(i.grid.patientFromVoxel);
  j["left_handed"] = glm::determinant(i.grid.patientFromVoxel.linear) < 0;
  j["modality"] = i.modality;
  j["unit"] = i.unit;
  if (i.channels == 1) j["rescale"] = {i.rescale[0].slope, i.rescale[0].intercept};
  j["windows"] = Json::array();
  for (const VoiWindow& w : i.windows)
    j["windows"].push_back({{"center", w.center}, {"width", w.width}, {"explanation", w.explanation}});
  j["findings"] = toJson(i.findings);
  if (options.pixels) j["voxels"] = voxelsJson(set, v, j["findings"]);
  return j;
}

}  // namespace

const char* nameOf(FileKind k) {
  switch (k) {
    case FileKind::Image:
      return "image";
    case FileKind::NonImage:
      return "non-image";
    case FileKind::DicomDir:
      return "DICOMDIR";
    case FileKind::NoSopClass:
      return "no SOP class";
    case FileKind::Unreadable:
      return "unreadable";
    case FileKind::NotDicom:
      return "not DICOM";
    case FileKind::Volume:
      return "volume file";
  }
  return "";
}

Json toJson(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }
Json toJson(const PatientFromVoxel& map) {
  const glm::dmat4 m = map.matrix();
  Json rows = Json::array();
  for (int r = 0; r < 4; ++r) rows.push_back({m[0][r], m[1][r], m[2][r], m[3][r]});
  return rows;
}
Json toJson(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& f : findings) list.push_back(toJson(f));
  return list;
}
Json toJson(const Error& e) {
  return {{"code", std::string(errorName(e.code))}, {"sentence", e.sentence}, {"where", e.where}};
}

Json volumeFilesJson(const StudySet& set, const std::vector<VolumeFile>& volumes,
                     const InfoOptions& options) {
  Json list = Json::array();
  for (const VolumeFile& v : volumes) list.push_back(volumeFileJson(set, v, options));
  return list;
}

std::size_t patientIds(const StudySet& set) {
  std::set<std::pair<std::string, std::string>> ids;
  std::size_t without = 0;
  for (const Patient& p : set.patients)
    if (p.id.empty())
      ++without;
    else
      ids.emplace(p.issuer, p.id);
  return ids.size() + without;
}

}  // namespace vernier
