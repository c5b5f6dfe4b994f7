// SPDX-License-Identifier: GPL-3.0-or-later
#include "InfoParts.h"
#include "PixelFacts.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {
using vernier::toJson;  // beside those below

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

}  // namespace

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

}  // namespace vernier
