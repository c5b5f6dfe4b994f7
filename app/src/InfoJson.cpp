// SPDX-License-Identifier: GPL-3.0-or-later
#include "InfoJson.h"

#include <map>

#include "InfoParts.h"

namespace vernier {
namespace {
using vernier::toJson;  // beside those below

Json toJson(const StudySet& set, const PresentationState& p) {
  Json j{{"file", set.files[set.instances[p.instance].file].shown},
         {"sop_instance_uid", p.sopInstanceUid},
         {"label", p.label},
         {"description", p.description}};
  j["images"] = Json::array();
  for (const ReferencedImage& r : p.images)
    j["images"].push_back({{"sop_instance_uid", r.sopInstanceUid}, {"frames", r.frames}});
  if (!p.whyNot.empty()) j["why_not"] = p.whyNot;
  j["not_applied"] = p.notApplied;
  return j;
}

Json surfaceJson(const SurfaceRecord& s) {
  if (s.error) return {{"file", s.shown}, {"error", toJson(*s.error)}};
  Json j{{"file", s.shown}, {"format", s.file.format}, {"bytes", s.file.bytes}};
  if (s.file.declaredTriangles) j["triangles_declared"] = *s.file.declaredTriangles;
  if (s.file.bytesExpected) j["bytes_expected"] = *s.file.bytesExpected;
  j["triangles"] = s.file.triangles;
  j["zero_area_triangles"] = s.file.dropped.zeroArea;
  j["not_finite_triangles"] = s.file.dropped.notFinite;
  j["duplicate_triangles"] = s.facts.duplicateTriangles;
  j["unit"] = "mm (assumed)";
  j["lowest_mm"] = toJson(s.lowest.p);
  j["highest_mm"] = toJson(s.highest.p);
  j["extent_mm"] = toJson(s.facts.extent_mm.v);
  j["extent_along_principal_axis_mm"] = s.facts.extentAlongPrincipalAxis_mm;
  j["distinct_vertices"] = s.vertices;
  j["distinct_edges"] = s.facts.distinctEdges;
  j["edges_used_once"] = s.facts.edgesUsedOnce;
  j["edges_used_over_twice"] = s.facts.edgesUsedOverTwice;
  j["directed_edges_used_over_once"] = s.facts.directedEdgesUsedTwice;
  j["closed"] = s.facts.closed;
  j["area_mm2"] = s.facts.area_mm2;
  j["signed_volume_mm3"] = s.facts.closed ? Json(s.facts.signedVolume_mm3) : Json(nullptr);
  j["findings"] = toJson(s.file.findings);
  return j;
}

Json totalsJson(const StudySet& set, const std::vector<SurfaceRecord>& surfaces) {
  std::map<std::string, std::size_t> kinds;
  for (const FileRecord& f : set.files) ++kinds[surfaceNamed(surfaces, f.shown) ? "surface" : nameOf(f.kind)];
  std::map<std::string, std::size_t> uids;
  std::size_t images = 0, frames = 0, repeating = 0;
  for (const Instance& i : set.instances) {
    images += i.isImage;
    if (i.isImage) frames += i.framesDeclared;
    if (!i.sopInstanceUid.empty() && ++uids[i.sopInstanceUid] > 1) ++repeating;
  }
  return {{"files", set.files.size()},
          {"files_by_kind", kinds},
          {"patients", patientIds(set)},
          {"studies", set.studies.size()},
          {"series", set.series.size()},
          {"objects", set.instances.size()},
          {"images", images},
          {"frames", frames},
          {"distinct_sop_instance_uids", uids.size()},
          {"files_repeating_a_sop_instance_uid", repeating}};
}

}  // namespace

std::string infoJson(const StudySet& set, const InfoOptions& options,
                     const std::vector<VolumeFile>& volumes) {
  Json j{{"schema", "vernier-info/1"}, {"totals", totalsJson(set, options.surfaces)}};
  j["patients"] = Json::array();
  for (const Patient& p : set.patients)
    j["patients"].push_back({{"id", p.id},
                             {"issuer", p.issuer},
                             {"name", p.name},
                             {"birth_date", p.birthDate},
                             {"sex", p.sex},
                             {"studies", p.studies}});
  j["studies"] = Json::array();
  for (const Study& s : set.studies)
    j["studies"].push_back({{"study_uid", s.studyUid},
                            {"date", s.date},
                            {"time", s.time},
                            {"description", s.description},
                            {"accession", s.accession},
                            {"series", s.series}});
  j["series"] = Json::array();
  for (const Series& s : set.series) j["series"].push_back(seriesJson(set, s));
  j["presentations"] = Json::array();
  for (const PresentationState& p : set.presentations) j["presentations"].push_back(toJson(set, p));
  j["findings"] = toJson(set.findings);
  j["objects"] = objectsJson(set, options);
  j["volume_files"] = volumeFilesJson(set, volumes, options);
  j["surfaces"] = Json::array();
  for (const SurfaceRecord& s : options.surfaces) j["surfaces"].push_back(surfaceJson(s));
  j["files"] = Json::array();
  for (const FileRecord& f : set.files) {
    const SurfaceRecord* surface = surfaceNamed(options.surfaces, f.shown);
    Json file{{"file", f.shown}, {"bytes", f.bytes}, {"kind", surface ? "surface" : nameOf(f.kind)}};
    if (const auto& error = surface ? surface->error : f.error) file["error"] = toJson(*error);
    j["files"].push_back(std::move(file));
  }
  // File names may hold any byte; what is not UTF-8 shows as the replacement character.
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vernier
