// SPDX-License-Identifier: GPL-3.0-or-later
#include "InfoJson.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "InfoParts.h"
#include "PixelFacts.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {
using vernier::toJson;  // beside those below

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
const char* nameOf(StackShape s) {
  switch (s) {
    case StackShape::NoGeometry:
      return "no geometry";
    case StackShape::Single:
      return "single";
    case StackShape::Uniform:
      return "uniform";
    case StackShape::Sheared:
      return "sheared";
    case StackShape::Uneven:
      return "uneven";
  }
  return "";
}
const char* nameOf(Identity i) {
  switch (i) {
    case Identity::Unique:
      return "unique";
    case Identity::Kept:
      return "kept";
    case Identity::Repeated:
      return "repeated";
    case Identity::Conflict:
      return "conflict";
  }
  return "";
}

Json rangeOf(const std::vector<double>& v) {
  if (v.empty()) return nullptr;
  return {{"min", *std::min_element(v.begin(), v.end())}, {"max", *std::max_element(v.begin(), v.end())}};
}

double medianOf(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

// Where a slice lies; empty frames of a segmentation have no place of their own.
glm::dvec3 originOf(const StudySet& set, const Stack& s, std::size_t k) {
  const Instance& i = set.instances[s.slices[k].instance];
  if (s.slices[k].frame != SliceRef::kEmptyFrame) return i.frame(s.slices[k].frame).plane->origin.p;
  const GridGeometry& g = s.grid;
  return (g.patientFromVoxel *
          VoxelPoint(g.even() ? glm::dvec3(0, 0, static_cast<double>(k)) : g.sliceOrigin_vox[k]))
      .p;
}

// The file of a slice, with the number of its frame where the file has several.
std::string nameOf(const StudySet& set, SliceRef r) {
  const Instance& i = set.instances[r.instance];
  const std::string& file = set.files[i.file].shown;
  if (r.frame == SliceRef::kEmptyFrame) return file + "#empty";
  return i.framesDeclared > 1 ? file + "#" + std::to_string(r.frame + 1) : file;
}

// Steps between neighbouring slices: along the normal, straight, and the angle between both.
void addSteps(const StudySet& set, const Stack& s, Json& j) {
  std::vector<double> along, straight, shear;
  for (std::size_t k = 1; k < s.positions_mm.size(); ++k) {
    along.push_back(s.positions_mm[k] - s.positions_mm[k - 1]);
    straight.push_back(glm::length(originOf(set, s, k) - originOf(set, s, k - 1)));
    const double side =
        std::sqrt(std::max(0.0, straight.back() * straight.back() - along.back() * along.back()));
    shear.push_back(std::atan2(side, along.back()) * 180 / 3.14159265358979323846);
  }
  if (along.empty()) return;
  j["step_mm"] = rangeOf(along);
  j["step_mm"]["median"] = medianOf(along);
  j["distance_between_origins_mm"] = rangeOf(straight);
  j["distance_between_origins_mm"]["median"] = medianOf(straight);
  j["shear_between_neighbours_deg"] = rangeOf(shear);
}

Json toJson(const StudySet& set, const Stack& s) {
  const Instance& object = set.instances[s.slices.front().instance];
  const FrameAttributes& first = object.frame(s.slices.front().frame);
  Json j{{"label", s.label}, {"shape", nameOf(s.shape)}, {"slices", s.slices.size()}};
  j["rows"] = object.pixels.rows;
  j["columns"] = object.pixels.columns;
  j["pixel_spacing_row_col_mm"] = {first.pixelSpacing_mm.x, first.pixelSpacing_mm.y};
  if (first.echoTime_ms) j["echo_time_ms"] = *first.echoTime_ms;
  j["volume_3d"] = s.volume3d;
  if (!s.why2d.empty()) j["why_2d"] = s.why2d;
  Json files = Json::array();
  for (const SliceRef& r : s.slices) files.push_back(nameOf(set, r));
  j["order"] = std::move(files);
  if (!s.positions_mm.empty()) {
    j["positions_along_normal_mm"] = s.positions_mm;
    addSteps(set, s, j);
    j["shear_deg"] = s.shear_deg;
    j["max_deviation_of_origins_mm"] = s.deviation_mm;
    j["max_deviation_along_normal_mm"] = s.deviationAlongNormal_mm;
    j["first_origin_lps_mm"] = toJson(originOf(set, s, 0));
    j["last_origin_lps_mm"] = toJson(originOf(set, s, s.slices.size() - 1));
    j["row_direction_lps"] = toJson(first.plane->rowDirection.v);
    j["column_direction_lps"] = toJson(first.plane->columnDirection.v);
  }
  if (s.shape != StackShape::NoGeometry) {
    j["patient_from_voxel"] = toJson(s.grid.patientFromVoxel);
    j["gap_after_slice"] = s.grid.gapAfter;
    j["true_positions_kept"] = !s.grid.even();
  }
  j["orientation_fixed"] = s.orientationFixed;
  j["findings"] = toJson(s.findings);
  return j;
}

Json toJson(const StudySet& set, const Series& s) {
  std::size_t images = 0, frames = 0;
  Json files = Json::array();
  for (const std::size_t i : s.instances) {
    const Instance& o = set.instances[i];
    images += o.isImage;
    if (o.isImage) frames += o.framesDeclared;
    files.push_back(set.files[o.file].shown);
  }
  Json j{{"series_uid", s.seriesUid}, {"study_uid", s.studyUid}, {"modality", s.modality}};
  if (s.number) j["number"] = *s.number;
  j["description"] = s.description;
  j["objects"] = s.instances.size();
  j["images"] = images;
  j["frames"] = frames;
  j["files"] = std::move(files);
  j["stacks"] = Json::array();
  for (const Stack& stack : s.stacks) j["stacks"].push_back(toJson(set, stack));
  j["findings"] = toJson(s.findings);
  return j;
}

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

Json coloursJson(const StudySet& set, std::size_t n, const std::vector<PixelPlace>& places) {
  const auto facts = colourFacts(set, n, places);
  if (!facts) return {{"error", toJson(facts.error())}};
  Json j{{"rgb_mean", facts->rgbMean}};
  j["probes"] = Json::array();
  for (std::size_t p = 0; p < places.size(); ++p)
    j["probes"].push_back({{"row", places[p].row},
                           {"column", places[p].column},
                           {"stored", facts->stored[p]},
                           {"rgb", facts->rgb[p]}});
  return j;
}

Json pixelsJson(const StudySet& set, std::size_t n, const std::vector<PixelPlace>& places) {
  const Instance& i = set.instances[n];
  if (!i.pixelError && i.pixels.samplesPerPixel > 1) return coloursJson(set, n, places);
  const auto facts = pixelFacts(set, n, places);
  if (!facts) return {{"error", toJson(facts.error())}};
  Json j{
      {"stored_min", facts->storedMin}, {"stored_max", facts->storedMax}, {"stored_sum", facts->storedSum}};
  if (!facts->sha256Int32le.empty()) j["stored_sha256_int32le"] = facts->sha256Int32le;
  const auto range = [&](const std::optional<PixelFacts::Range>& r, const char* low, const char* high) {
    if (!r) return;
    j[low] = r->min;
    j[high] = r->max;
  };
  if (i.palette)
    if (const auto colours = colourFacts(set, n, {})) j["rgb_mean"] = colours->rgbMean;
  if (i.paddingFirst) j["padding_pixels"] = facts->paddingPixels;
  range(facts->modality, "modality_min", "modality_max");
  range(facts->modalityValid, "modality_min_without_padding", "modality_max_without_padding");
  j["probes"] = Json::array();
  for (std::size_t p = 0; p < places.size(); ++p) {
    Json probe{{"row", places[p].row}, {"column", places[p].column}, {"stored", facts->probes[p]}};
    if (facts->modality) probe["modality"] = i.rescale.slope * facts->probes[p] + i.rescale.intercept;
    if (i.filePlane && i.pixelSpacing_mm.x > 0)
      probe["lps_mm"] =
          toJson(i.filePlane->origin.p +
                 i.filePlane->rowDirection.v * (static_cast<double>(places[p].column) * i.pixelSpacing_mm.y) +
                 i.filePlane->columnDirection.v * (static_cast<double>(places[p].row) * i.pixelSpacing_mm.x));
    j["probes"].push_back(std::move(probe));
  }
  return j;
}

Json toJson(const std::vector<RealWorldMapping>& mappings) {
  Json list = Json::array();
  for (const RealWorldMapping& m : mappings) {
    Json j{{"stored", {m.first, m.last}}, {"unit", m.unit}, {"label", m.label}, {"meaning", m.meaning}};
    if (m.table.empty())
      j["slope_intercept"] = {m.slope, m.intercept};
    else
      j["table_entries"] = m.table.size();
    list.push_back(std::move(j));
  }
  return list;
}

Json segmentsJson(const Instance& i) {
  Json list = Json::array();
  for (const Segment& s : i.segments) {
    Json j{{"number", s.number},
           {"label", s.label},
           {"category", s.category},
           {"type", s.type},
           {"algorithm", s.algorithm}};
    if (s.colour) j["rgb"] = {(*s.colour)[0], (*s.colour)[1], (*s.colour)[2]};
    list.push_back(std::move(j));
  }
  return list;
}

// What differs from frame to frame, in the order of the file.
Json framesJson(const Instance& i) {
  Json list = Json::array();
  for (const FrameAttributes& f : *i.frames) {
    Json j;
    if (f.plane) j["origin_lps_mm"] = toJson(f.plane->origin.p);
    if (f.rescaleInvalid)
      j["rescale"] = nullptr;
    else
      j["rescale"] = {f.rescale.slope, f.rescale.intercept};
    j["unit"] = f.unit;
    if (!f.windows.empty()) j["window"] = {f.windows[0].center, f.windows[0].width};
    if (f.echoTime_ms) j["echo_time_ms"] = *f.echoTime_ms;
    if (f.temporalPosition) j["temporal_position"] = *f.temporalPosition;
    if (!f.dimensionIndex.empty()) j["dimension_index"] = f.dimensionIndex;
    if (!f.segments.empty()) j["segment"] = f.segments[0];
    list.push_back(std::move(j));
  }
  return list;
}

Json objectJson(const StudySet& set, std::size_t n) {
  const Instance& i = set.instances[n];
  Json j{{"file", set.files[i.file].shown},
         {"kind", nameOf(set.files[i.file].kind)},
         {"sop_class_uid", i.sopClassUid},
         {"sop_class_name", i.sopClassName},
         {"sop_instance_uid", i.sopInstanceUid},
         {"transfer_syntax_uid", i.transferSyntaxUid},
         {"series_index", i.series},
         {"identity", nameOf(i.identity)},
         {"modality", i.modality}};
  if (i.instanceNumber) j["instance_number"] = *i.instanceNumber;
  j["names"] = Json::array();
  for (const NamedText& t : i.names) j["names"].push_back({{"at", t.at}, {"text", t.text}});
  if (!i.notShown.empty()) j["not_shown"] = i.notShown;
  if (!i.isImage) return j;
  j["frames"] = i.framesDeclared;
  j["photometric"] = i.photometric;
  if (i.pixelError) {
    j["pixel_error"] = toJson(*i.pixelError);
  } else {
    j["rows"] = i.pixels.rows;
    j["columns"] = i.pixels.columns;
    j["samples_per_pixel"] = i.pixels.samplesPerPixel;
    j["bits_allocated"] = i.pixels.bitsAllocated;
    j["bits_stored"] = i.pixels.bitsStored;
    j["signed"] = i.pixels.isSigned;
  }
  if (i.pixelSpacing_mm.x > 0) j["pixel_spacing_row_col_mm"] = {i.pixelSpacing_mm.x, i.pixelSpacing_mm.y};
  if (i.plane) j["origin_lps_mm"] = toJson(i.plane->origin.p);
  if (!i.frameOfReferenceUid.empty()) j["frame_of_reference_uid"] = i.frameOfReferenceUid;
  if (!i.modalityLut) j["rescale"] = {i.rescale.slope, i.rescale.intercept};
  j["modality_lut"] = i.modalityLut.has_value();
  j["voi_luts"] = i.voiLuts.size();
  j["unit"] = i.unit;
  Json windows = Json::array();
  for (const VoiWindow& w : i.windows)
    windows.push_back({{"center", w.center}, {"width", w.width}, {"explanation", w.explanation}});
  j["windows"] = std::move(windows);
  if (i.paddingFirst) j["padding"] = {*i.paddingFirst, *i.paddingLast};
  j["lossy"] = i.lossy;
  if (i.realWorld) j["real_world"] = toJson(*i.realWorld);
  if (i.concatenation)
    j["concatenation"] = {{"uid", i.concatenation->uid},
                          {"part", i.concatenation->number},
                          {"parts", i.concatenation->total},
                          {"first_frame", i.concatenation->frameOffset}};
  if (!i.frameTimes_ms.empty())
    j["frame_times_ms"] = {{"first", i.frameTimes_ms.front()}, {"last", i.frameTimes_ms.back()}};
  if (i.segmentation != SegmentationKind::None) j["segments"] = segmentsJson(i);
  if (i.frames) j["frame_attributes"] = framesJson(i);
  return j;
}

Json objectsJson(const StudySet& set, const InfoOptions& options) {
  std::vector<Json> objects(set.instances.size());
  parallelFor(objects.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      objects[n] = objectJson(set, n);
      const Instance& i = set.instances[n];
      if (!options.pixels || !i.isImage) continue;
      std::vector<PixelPlace> places;
      for (const InfoProbe& p : options.probes)
        if ((p.file.empty() || p.file == set.files[i.file].shown) && p.row < i.pixels.rows &&
            p.column < i.pixels.columns)
          places.push_back({p.row, p.column});
      objects[n]["pixels"] = pixelsJson(set, n, places);
    }
  });
  return Json(std::move(objects));
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
          {"patients", set.patients.size()},
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
  for (const Series& s : set.series) j["series"].push_back(toJson(set, s));
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
