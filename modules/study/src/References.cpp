// SPDX-License-Identifier: GPL-3.0-or-later
#include "References.h"

#include <algorithm>
#include <map>
#include <set>

#include "FrameReading.h"
#include "vernier/study/Limits.h"

namespace vernier {

std::vector<RealWorldReference> readRealWorldReferences(const AttributeReader& root) {
  std::vector<RealWorldReference> out;
  for (const AttributeReader& item : root.items(0x00409094)) {
    const auto mappings = readRealWorld(item, false);
    if (!mappings) continue;
    for (const AttributeReader& image : item.items(0x00081140)) {
      RealWorldReference r{shortCode(image, 0x00081155), {}, mappings};
      for (const double f : image.decimals(0x00081160))
        if (f >= 1 && f <= static_cast<double>(limits::kMaxFrames))
          r.frames.push_back(static_cast<std::uint64_t>(f) - 1);
      if (!r.sopInstanceUid.empty()) out.push_back(std::move(r));
    }
  }
  return out;
}

namespace {

// The unit too, where the mapping says the same numbers as the rescale.
void giveTo(FrameAttributes& a, const FrameKeys& k, const Instance& i, const RealWorldReference& r) {
  a.realWorld = r.mappings;
  if (a.unit == "stored value" && !i.modalityLut) a.unit = unitOf(i, a, k, std::nullopt);
}

void give(const std::vector<const RealWorldReference*>& references, Record& record) {
  Instance& i = record.instance;
  std::vector<FrameAttributes> frames = i.frames ? *i.frames : std::vector<FrameAttributes>{i};
  for (const RealWorldReference* r : references) {
    // Without frames of its own an object is named whole.
    if (r->frames.empty() || !i.frames)
      for (std::size_t f = 0; f < frames.size(); ++f) giveTo(frames[f], record.keys(f), i, *r);
    else
      for (const std::uint64_t f : r->frames)
        if (f < frames.size()) giveTo(frames[f], record.keys(f), i, *r);
  }
  static_cast<FrameAttributes&>(i) = frames.front();
  if (i.frames) i.frames = std::make_shared<const std::vector<FrameAttributes>>(std::move(frames));
}

}  // namespace

std::vector<Finding> attachRealWorld(std::vector<Record>& records) {
  std::map<std::string, std::vector<std::size_t>> byUid;
  std::size_t named = 0, found = 0;
  for (std::size_t n = 0; n < records.size(); ++n)
    if (records[n].instance.isImage) byUid[records[n].instance.sopInstanceUid].push_back(n);
  std::map<std::size_t, std::vector<const RealWorldReference*>> forRecord;
  for (const Record& mapper : records)
    for (const RealWorldReference& r : mapper.realWorldOf) {
      ++named;
      const auto at = byUid.find(r.sopInstanceUid);
      if (at == byUid.end()) continue;
      ++found;
      for (const std::size_t n : at->second) forRecord[n].push_back(&r);
    }
  for (const auto& [n, references] : forRecord) give(references, records[n]);
  if (named == 0) return {};
  return {{"real-world-mapping",
           Severity::Info,
           "A real-world value mapping names " + std::to_string(named) + " images, " + std::to_string(found) +
               " of which are here.",
           {{"images", static_cast<double>(named)}, {"images_present", static_cast<double>(found)}}}};
}

void linkConverted(const std::vector<Record>& records, std::vector<Series>& series) {
  std::map<std::string, std::size_t> seriesOf;
  for (const Record& r : records)
    if (!r.instance.sopInstanceUid.empty())
      seriesOf.try_emplace(r.instance.sopInstanceUid, r.instance.series);
  std::map<std::pair<std::size_t, std::size_t>, std::set<std::string>> links;  // converted, source
  for (const Record& r : records)
    for (const std::string& uid : r.convertedFrom)
      if (const auto at = seriesOf.find(uid); at != seriesOf.end() && at->second != r.instance.series)
        links[{r.instance.series, at->second}].insert(uid);
  for (const auto& [pair, uids] : links) {
    const auto& [converted, source] = pair;
    const double n = static_cast<double>(uids.size());
    const std::string images = std::to_string(uids.size()) + (uids.size() == 1 ? " image" : " images");
    series[converted].findings.push_back(
        {"converted-copy",
         Severity::Info,
         "This series was converted from " + images + " of another series of this study.",
         {{"source_series", series[source].seriesUid}, {"images", n}}});
    series[source].findings.push_back(
        {"converted-copy",
         Severity::Info,
         images + " of this series are here once more, converted to one object.",
         {{"converted_series", series[converted].seriesUid}, {"images", n}}});
  }
}

std::vector<Finding> concatenationFindings(const std::vector<Record>& records,
                                           const std::vector<std::size_t>& members,
                                           const std::function<std::string(std::size_t)>& fileName) {
  std::map<std::string, std::vector<std::size_t>> byUid;
  for (const std::size_t m : members)
    if (const Instance& i = records[m].instance; i.concatenation && i.identity != Identity::Repeated)
      byUid[i.concatenation->uid].push_back(m);
  std::vector<Finding> out;
  for (auto& [uid, parts] : byUid) {
    const auto partOf = [&](std::size_t m) -> const Concatenation& {
      return *records[m].instance.concatenation;
    };
    std::sort(parts.begin(), parts.end(),
              [&](std::size_t a, std::size_t b) { return partOf(a).frameOffset < partOf(b).frameOffset; });
    std::uint64_t end = 0, missing = 0, frames = 0;
    bool overlap = false;
    std::int64_t total = 0;
    std::vector<std::string> files;
    for (const std::size_t m : parts) {
      const Concatenation& c = partOf(m);
      overlap |= c.frameOffset < end;
      if (c.frameOffset > end) missing += c.frameOffset - end;
      end = std::max(end, c.frameOffset + records[m].instance.framesDeclared);
      frames += records[m].instance.framesDeclared;
      total = std::max(total, c.total);
      files.push_back(fileName(m));
    }
    const bool tooFew = total > static_cast<std::int64_t>(parts.size());
    const std::string have = std::to_string(parts.size()) + (parts.size() == 1 ? " part" : " parts");
    Finding f{"concatenation", Severity::Info, "", {}};
    if (overlap) {
      f.code = "concatenation-overlap";
      f.severity = Severity::Warning;
      f.sentence = "The " + have + " of a concatenation claim the same frames; each part is kept as it is.";
    } else if (missing > 0 || tooFew) {
      f.code = "concatenation-incomplete";
      f.severity = Severity::Warning;
      f.sentence = "Of a concatenation only " + have +
                   (total > 0 ? " of " + std::to_string(total) : std::string()) +
                   " are here; fetch the others.";
    } else {
      f.sentence =
          have + " of a concatenation with " + std::to_string(frames) + " frames in all were joined.";
    }
    f.numbers = {{"parts", static_cast<double>(parts.size())},
                 {"frames", static_cast<double>(frames)},
                 {"missing_frames_between", static_cast<double>(missing)},
                 {"files", std::move(files)}};
    if (total > 0) f.numbers["parts_declared"] = static_cast<double>(total);
    out.push_back(std::move(f));
  }
  return out;
}

}  // namespace vernier
