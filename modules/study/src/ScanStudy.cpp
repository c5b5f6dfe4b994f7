// SPDX-License-Identifier: GPL-3.0-or-later
// The pipeline: walk -> read headers (in parallel) -> records -> group -> identity -> stacks -> findings.
#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>

#include "Attributes.h"
#include "DicomDir.h"
#include "FileWalk.h"
#include "Group.h"
#include "PresentationFrom.h"
#include "References.h"
#include "SeriesFindings.h"
#include "SopClasses.h"
#include "Stacks.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"
#include "vernier/study/Archive.h"
#include "vernier/study/Load.h"

namespace vernier {
namespace {

constexpr std::string_view kDirectoryClass = "1.2.840.10008.1.3.10";

struct Scanned {
  std::optional<Record> record;  // an object
  std::optional<DicomDirIndex> directory;
};

bool isDirectory(const Header& h) {
  if (const Element* e = h.find(0x00080016); e && rawText(h, *e) == kDirectoryClass) return true;
  const Element* media = findIn(h.meta, 0x00020002);
  return media && rawText(h, *media) == kDirectoryClass;
}

// An archive is opened when it is named itself; what stands in a folder or in another archive may be a bomb
// of many.
Error leftPacked(const FileRecord& file) {
  if (file.archive)
    return makeError(
        ErrorCode::FormatUnknown,
        "An archive inside an archive is not opened; unpack the outer one and open this one by itself.");
  return makeError(ErrorCode::FormatUnknown, "An archive in a folder is not opened; open it by itself.");
}

Result<void> readInto(FileRecord& file, Scanned& out, bool resolveDirectory) {
  auto source = openSource(file);
  if (!source) {
    file.kind = FileKind::Unreadable;
    return source.error();
  }
  if ((*source)->ensure(4) && looksLikeArchive((*source)->bytes())) return leftPacked(file);
  auto header = readHeader(**source);
  if (!header) {
    file.kind = header.error().code == ErrorCode::NotDicom ? FileKind::NotDicom : FileKind::Unreadable;
    return header.error();
  }
  const Header& h = *header;
  if (isDirectory(h)) {
    file.kind = FileKind::DicomDir;
    out.directory =
        readDicomDir(h, std::filesystem::path(file.path).parent_path().string(), resolveDirectory);
    if (h.damage) return *h.damage;
    return {};
  }
  if (h.damage && !h.find(0x00080016) && !h.pixels) {
    file.kind = FileKind::Unreadable;  // too little was read to say what object it is
    return *h.damage;
  }
  Record r = recordFrom(h);
  r.presentation = presentationFrom(h);
  if (r.presentation && r.presentation->whyNot.empty())
    r.instance.notShown = "applied on request: presentation state";
  if (r.instance.sopClassUid.empty() && !r.instance.isImage) {
    file.kind = FileKind::NoSopClass;
    return makeError(ErrorCode::NotDicom,
                     "The file reads as DICOM but does not say what object it is (no SOP Class); "
                     "it is left out.");
  }
  file.kind = r.instance.isImage ? FileKind::Image : FileKind::NonImage;
  if (r.instance.pixelError) r.instance.pixelError->where = file.shown;
  std::optional<Error> error = h.damage;
  if (h.damage && !r.instance.isImage && r.imageClass && !r.instance.pixelError)
    r.instance.pixelError = h.damage;
  if (!error && r.instance.pixelError) error = r.instance.pixelError;
  out.record = std::move(r);
  if (error) return *error;
  return {};
}

void scanFile(FileRecord& file, Scanned& out, bool resolveDirectory) {
  if (file.error) return;
  Result<void> done = guarded("scan", [&] { return readInto(file, out, resolveDirectory); });
  if (done) return;
  file.error = done.error();
  file.error->where = file.shown;
}

// Reads all headers; false when cancelled.
bool scanAll(std::vector<FileRecord>& files, std::vector<Scanned>& scanned, bool resolveDirectory,
             const ProgressFn& progress, const std::stop_token& stop) {
  scanned.resize(files.size());
  std::mutex mutex;
  std::uint64_t done = 0;
  parallelFor(files.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i)
      scanFile(files[i], scanned[i], resolveDirectory);
    if (!progress) return;
    const std::lock_guard lock(mutex);
    done += end - begin;
    progress("scan", done, files.size());
  });
  return !stop.stop_requested();
}

// What the decoded values of an object are, for comparison with a namesake: 128 bits over all frames.
struct ValuesDigest {
  std::uint64_t a = 1, b = 2;
  friend bool operator==(const ValuesDigest&, const ValuesDigest&) = default;
  void add(std::span<const std::byte> bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += 8) {
      std::uint64_t v = 0;
      std::memcpy(&v, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
      a = std::rotl(a ^ v, 27) * 0x9E3779B97F4A7C15ull;
      b = std::rotl(b + v, 31) * 0xD1342543DE82EF95ull ^ a >> 32;
    }
  }
};
std::optional<ValuesDigest> digestOf(const StudySet& set, std::size_t n) {
  const Instance& i = set.instances[n];
  const auto bytes = i.pixels.frameBytes();
  if (!i.isImage || i.pixelError || !bytes) return std::nullopt;
  std::vector<std::byte> frame(*bytes);
  ValuesDigest digest;
  FrameReader reader(set);
  for (std::uint64_t f = 0; f < i.pixels.framesDeclared; ++f) {
    if (!reader.read({n, f}, frame)) return std::nullopt;
    digest.add(frame);
  }
  return digest;
}

// Digests of the objects that share their SOP Instance UID with another; only these are decoded by a scan.
std::vector<std::optional<ValuesDigest>> digestsOfNamesakes(const StudySet& set) {
  std::map<std::string_view, std::size_t> uses;
  for (const Instance& i : set.instances) ++uses[i.sopInstanceUid];
  std::vector<std::size_t> namesakes;
  for (std::size_t n = 0; n < set.instances.size(); ++n)
    if (!set.instances[n].sopInstanceUid.empty() && uses[set.instances[n].sopInstanceUid] > 1)
      namesakes.push_back(n);
  std::vector<std::optional<ValuesDigest>> digests(set.instances.size());
  parallelFor(namesakes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t n = namesakes[k];
      (void)guarded("digest", [&]() -> Result<void> {
        digests[n] = digestOf(set, n);
        return {};
      });
    }
  });
  return digests;
}

// Whether all frames of two instances decode to equal stored values; nullopt when that cannot be said.
std::optional<bool> sameValues(const StudySet& set, const std::vector<std::optional<ValuesDigest>>& digests,
                               std::size_t a, std::size_t b) {
  if (!digests[a] || !digests[b]) return std::nullopt;
  const FrameSpec &p = set.instances[a].pixels, &q = set.instances[b].pixels;
  if (p.rows != q.rows || p.columns != q.columns || p.samplesPerPixel != q.samplesPerPixel ||
      p.sample != q.sample || p.framesDeclared != q.framesDeclared)
    return false;
  // Two photometric interpretations: equal numbers are not equal colours, and the reverse.
  if (p.samplesPerPixel > 1 && p.photometric != q.photometric) return std::nullopt;
  return *digests[a] == *digests[b];
}

bool drawable(const Record& r) {
  const Instance& i = r.instance;
  return i.isImage && i.notShown.empty() && !i.pixelError && i.identity != Identity::Repeated;
}

void fillStacks(const std::vector<Record>& records, Series& series) {
  std::vector<std::size_t> members, conflicting;
  for (const std::size_t m : series.instances)
    if (drawable(records[m]))
      (records[m].instance.identity == Identity::Conflict ? conflicting : members).push_back(m);
  SplitResult split = makeStacks(records, members);
  series.stacks = std::move(split.stacks);
  for (const std::size_t m : conflicting) {
    SplitResult one = makeStacks(records, {m});
    Stack& stack = one.stacks.front();
    stack.label = "conflicting copy";
    stack.volume3d = false;
    stack.why2d =
        "Another file with the same SOP Instance UID differs; it can be viewed but is kept out of 3-D.";
    series.stacks.push_back(std::move(stack));
  }
  for (Finding& f : split.findings) series.findings.push_back(std::move(f));
}

// One line for all directories of a scan. `present`: how many of the files that they name are there, when
// looked up.
void reportDirectories(const std::vector<const DicomDirIndex*>& directories, bool resolved, StudySet& set) {
  if (directories.empty()) return;
  std::map<std::string, double> records;
  double referenced = 0, present = 0, outside = 0;
  for (const DicomDirIndex* d : directories) {
    for (const auto& [type, n] : d->records) records[type] += static_cast<double>(n);
    referenced += static_cast<double>(d->referenced);
    present += static_cast<double>(d->present);
    outside += static_cast<double>(d->outside);
  }
  const auto text = [](double n) { return std::to_string(static_cast<std::uint64_t>(n)); };
  Finding f{"dicomdir", Severity::Info, "", {}};
  f.sentence =
      (directories.size() == 1 ? "A DICOMDIR names "
                               : text(static_cast<double>(directories.size())) + " DICOMDIRs name ") +
      text(referenced) + " files" +
      (resolved ? ", " + text(present) + " of which are there." : "; in a folder the files themselves rule.");
  if (outside > 0) f.sentence += " " + text(outside) + " lie outside its folder and were not looked for.";
  for (const auto& [type, n] : records) f.numbers["records_" + type] = n;
  f.numbers["directories"] = static_cast<double>(directories.size());
  f.numbers["referenced_files"] = referenced;
  if (resolved) {
    f.numbers["referenced_files_present"] = present;
    f.numbers["referenced_files_outside"] = outside;
  }
  set.findings.push_back(std::move(f));
}

Result<StudySet> scanGuarded(const std::vector<std::string>& paths, const ProgressFn& progress,
                             const std::stop_token& stop) {
  const TraceSpan span("scan");
  auto files = walkFiles(paths);
  if (!files) return files.error();
  StudySet set;
  set.files = std::move(*files);
  std::vector<Scanned> scanned;
  const auto cancelled = makeError(ErrorCode::Cancelled, "The scan was cancelled.");
  const bool single =
      set.files.size() == 1 && !set.files[0].archive && !std::filesystem::is_directory(paths[0]);
  if (!scanAll(set.files, scanned, single, progress, stop)) return cancelled;
  if (single && scanned[0].directory) {
    // A DICOMDIR opened by itself: its files are the study.
    const DicomDirIndex index = *scanned[0].directory;
    auto named = walkFiles(index.files, false);
    if (!named) return named.error();
    const std::string base = std::filesystem::path(set.files[0].path).parent_path().string();
    for (FileRecord& f : *named) f.shown = std::filesystem::path(f.path).lexically_relative(base).string();
    reportDirectories({&index}, true, set);
    std::vector<Scanned> more;
    if (!scanAll(*named, more, false, progress, stop)) return cancelled;
    for (std::size_t i = 0; i < named->size(); ++i) {
      set.files.push_back(std::move((*named)[i]));
      scanned.push_back(std::move(more[i]));
    }
  } else {
    std::vector<const DicomDirIndex*> directories;
    for (const Scanned& one : scanned)
      if (one.directory) directories.push_back(&*one.directory);
    reportDirectories(directories, false, set);
  }

  std::vector<Record> records;
  for (std::size_t i = 0; i < scanned.size(); ++i)
    if (scanned[i].record) {
      scanned[i].record->instance.file = i;
      records.push_back(std::move(*scanned[i].record));
    }
  Grouping grouping = groupRecords(records);
  set.series = std::move(grouping.series);
  set.studies = std::move(grouping.studies);
  set.patients = std::move(grouping.patients);
  for (Finding& f : grouping.findings) set.findings.push_back(std::move(f));

  const auto fileName = [&](std::size_t r) { return set.files[records[r].instance.file].shown; };
  for (Finding& f : attachRealWorld(records)) set.findings.push_back(std::move(f));
  for (const Record& r : records) set.instances.push_back(r.instance);
  const auto digests = digestsOfNamesakes(set);
  for (Finding& f : settleIdentity(
           records, [&](std::size_t a, std::size_t b) { return sameValues(set, digests, a, b); }, fileName))
    set.findings.push_back(std::move(f));
  for (std::size_t n = 0; n < records.size(); ++n) {
    set.instances[n] = records[n].instance;
    if (!records[n].presentation) continue;
    set.presentations.push_back(std::move(*records[n].presentation));
    set.presentations.back().instance = n;
  }
  for (Series& s : set.series) {
    fillStacks(records, s);
    for (Finding& f : seriesFindings(records, s.instances, fileName)) s.findings.push_back(std::move(f));
    for (Finding& f : concatenationFindings(records, s.instances, fileName))
      s.findings.push_back(std::move(f));
  }
  linkConverted(records, set.series);
  return set;
}

}  // namespace

Result<StudySet> scanStudy(const std::vector<std::string>& paths, const ProgressFn& progress,
                           std::stop_token stop) {
  return guarded("scanStudy", [&] { return scanGuarded(paths, progress, stop); });
}

}  // namespace vernier
