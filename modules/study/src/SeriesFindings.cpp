// SPDX-License-Identifier: GPL-3.0-or-later
#include "SeriesFindings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "vernier/study/Limits.h"

namespace vernier {
namespace {

using Members = std::vector<std::size_t>;
using FileName = std::function<std::string(std::size_t)>;

class Collector {
 public:
  Collector(const std::vector<Record>& records, const Members& members, const FileName& fileName)
      : records_(records), members_(members), fileName_(fileName) {}

  Members where(const std::function<bool(const Record&)>& test) const {
    Members hit;
    std::copy_if(members_.begin(), members_.end(), std::back_inserter(hit),
                 [&](std::size_t m) { return test(records_[m]); });
    return hit;
  }
  // One finding for all members that pass the test; `numbers` from the first of them.
  void report(const char* code, Severity severity, const std::function<bool(const Record&)>& test,
              const std::string& sentence,
              const std::function<std::map<std::string, FindingValue>(const Record&)>& numbers = {}) {
    const Members hit = where(test);
    if (hit.empty()) return;
    Finding f{code, severity, sentence, {}};
    if (numbers) f.numbers = numbers(records_[hit[0]]);
    std::vector<std::string> files;
    for (const std::size_t m : hit) files.push_back(fileName_(m));
    f.numbers["number_of_files"] = static_cast<double>(hit.size());
    f.numbers["files"] = std::move(files);
    out.push_back(std::move(f));
  }
  std::vector<Finding> out;

 private:
  const std::vector<Record>& records_;
  const Members& members_;
  const FileName& fileName_;
};

bool near(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) <= 0.1 * 3.14159265358979323846 / 180;
}

std::size_t countOrientations(const std::vector<Record>& records, const Members& members) {
  std::vector<FramePlane> seen;
  const auto add = [&](const std::optional<FramePlane>& p) {
    const bool known = !p || std::any_of(seen.begin(), seen.end(), [&](const FramePlane& q) {
      return near(p->rowDirection.v, q.rowDirection.v) && near(p->columnDirection.v, q.columnDirection.v);
    });
    if (!known && seen.size() < limits::kMaxStacksPerSeries) seen.push_back(*p);
  };
  for (const std::size_t m : members) {
    const Instance& i = records[m].instance;
    add(i.plane);
    if (i.frames)
      for (const FrameAttributes& f : *i.frames) add(f.plane);
  }
  return seen.size();
}

template <class Key>
std::size_t countDistinct(const std::vector<Record>& records, const Members& members, Key key) {
  std::set<decltype(key(records[0]))> seen;
  for (const std::size_t m : members) seen.insert(key(records[m]));
  return seen.size();
}

void reportDifferences(const std::vector<Record>& records, Collector& c) {
  const Members images = c.where([](const Record& r) { return r.instance.isImage; });
  const std::size_t orientations = countOrientations(records, images);
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  if (orientations > 1)
    c.out.push_back({"several-orientations-in-series",
                     Severity::Info,
                     "The series has images in " + std::to_string(orientations) +
                         " orientations; each is a stack of its own.",
                     {{"orientations", count(orientations)}}});
  const Members windowed =
      c.where([](const Record& r) { return r.instance.isImage && !r.windowCenters.empty(); });
  const std::size_t windows = countDistinct(
      records, windowed, [](const Record& r) { return std::pair(r.windowCenters, r.windowWidths); });
  if (windows > 1)
    c.out.push_back({"window-differs-within-series",
                     Severity::Info,
                     "The images carry " + std::to_string(windows) +
                         " different windows; the middle slice's is used for all.",
                     {{"different", count(windows)}}});
  const std::size_t rescales = countDistinct(records, images, [](const Record& r) {
    return std::pair(r.instance.rescale.slope, r.instance.rescale.intercept);
  });
  if (rescales > 1)
    c.out.push_back(
        {"rescale-differs-within-series",
         Severity::Info,
         "The images have " + std::to_string(rescales) + " different rescale slopes or intercepts.",
         {{"different", count(rescales)}}});
}

}  // namespace

std::vector<Finding> seriesFindings(const std::vector<Record>& records, const Members& members,
                                    const FileName& fileName) {
  Collector c(records, members, fileName);
  reportDifferences(records, c);
  for (const std::size_t m : members)
    for (Finding f : records[m].findings) {
      f.numbers["file"] = fileName(m);
      c.out.push_back(std::move(f));
    }
  for (const std::size_t m : members)
    if (records[m].frameWindows > 1)
      c.out.push_back({"window-differs-per-frame",
                       Severity::Info,
                       "The frames of one object carry " + std::to_string(records[m].frameWindows) +
                           " different windows.",
                       {{"file", fileName(m)}, {"different", static_cast<double>(records[m].frameWindows)}}});
  c.report(
      "window-width-not-positive", Severity::Info,
      [](const Record& r) { return r.instance.isImage && !r.badWindowWidths.empty(); },
      "A window of width zero or less, or that is not a number, was left out.",
      [](const Record& r) {
        return std::map<std::string, FindingValue>{{"first_window_center", r.badWindowCenters},
                                                   {"first_window_width", r.badWindowWidths}};
      });
  c.report(
      "padding-declared", Severity::Info,
      [](const Record& r) { return r.instance.isImage && r.instance.paddingFirst.has_value(); },
      "The images declare a padding value; such pixels are no data and left out of windows, statistics and "
      "projections.",
      [](const Record& r) {
        return std::map<std::string, FindingValue>{{"first_padding", *r.instance.paddingFirst},
                                                   {"first_padding_last", *r.instance.paddingLast}};
      });
  c.report(
      "lossy", Severity::Info, [](const Record& r) { return r.instance.isImage && r.instance.lossy; },
      "The images were compressed with loss.",
      [](const Record& r) {
        return std::map<std::string, FindingValue>{{"first_transfer_syntax", r.instance.transferSyntaxUid},
                                                   {"first_lossy_tag", r.lossyTag}};
      });
  c.report(
      "no-part10-header", Severity::Info, [](const Record& r) { return !r.part10; },
      "The file has no DICOM mark at byte 128 and was read by its content.");
  c.report(
      "image-object-without-pixel-data", Severity::Notice,
      [](const Record& r) { return r.imageClass && !r.instance.isImage; },
      "The object is of an image class but holds no pixel data; it is incomplete.");
  c.report(
      "pixels-unusable", Severity::Refusal, [](const Record& r) { return r.instance.pixelError.has_value(); },
      "The pixels of these images cannot be shown; they are left out of stacks.",
      [](const Record& r) {
        return std::map<std::string, FindingValue>{{"first_reason", r.instance.pixelError->sentence}};
      });
  c.report(
      "pixels-corrected", Severity::Notice,
      [](const Record& r) { return r.instance.isImage && !r.instance.pixels.corrected.empty(); },
      "The description of the pixels contradicts itself and was settled.",
      [](const Record& r) {
        return std::map<std::string, FindingValue>{{"first_reason", r.instance.pixels.corrected}};
      });
  c.report(
      "rescale-invalid", Severity::Warning, [](const Record& r) { return r.instance.rescaleInvalid; },
      "The rescale slope or intercept is zero or not a number; stored values are shown, marked unscaled.");
  c.report(
      "identity-conflict", Severity::Warning,
      [](const Record& r) { return r.instance.identity == Identity::Conflict && r.instance.isImage; },
      "These images share their SOP Instance UID with others that differ; they are kept out of volumes.");
  c.report(
      "text-undecodable", Severity::Info, [](const Record& r) { return r.textDamaged; },
      "Some text has bytes that its character set does not have; they show as the replacement character.");
  c.report(
      "syntax-contradicted", Severity::Info, [](const Record& r) { return r.contradictsSyntax; },
      "The file is encoded otherwise than it declares; it was read as it is.");
  c.report(
      "stray-delimiters", Severity::Info, [](const Record& r) { return r.strayDelimiters; },
      "Item or delimiter tags stand outside of any sequence and were skipped.");
  return c.out;
}

}  // namespace vernier
