// SPDX-License-Identifier: GPL-3.0-or-later
// Which format a file is of, from its first bytes, and the one way from there to a Volume.
#include "vernier/volume/VolumeFile.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "files/Affine.h"
#include "files/ImageList.h"
#include "files/LoadVoxels.h"
#include "files/MetaHeader.h"
#include "files/Nifti.h"
#include "files/Nrrd.h"
#include "files/Sidecar.h"
#include "files/TextParts.h"
#include "files/Vti.h"
#include "vernier/base/Checked.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {
namespace fs = std::filesystem;

std::string_view textOf(const std::vector<std::byte>& b) {
  return {reinterpret_cast<const char*>(b.data()), b.size()};
}

bool isGzip(std::span<const std::byte> b) {
  return b.size() > 2 && b[0] == std::byte{0x1f} && b[1] == std::byte{0x8b};
}

// "brain.nii.gz" -> "brain".
std::string titleOf(const FileRecord& file) {
  fs::path name(file.shown);
  if (name.extension() == ".gz") name.replace_extension();
  return name.stem().string();
}

Error formatUnknown(const FileRecord& file) {
  return makeError(
      ErrorCode::FormatUnknown,
      "The file is neither DICOM nor of a volume format that is read (NIfTI, NRRD, MetaImage, VTK image, "
      "raw with a JSON file, list of images).",
      file.shown);
}

// The file of a pair with the other extension: .hdr and .img, .hdr.gz and .img.gz, in the same case.
Result<FileRecord> otherOfPair(const FileRecord& file, const char* lower, const char* upper) {
  fs::path name = fs::path(file.shown).filename();
  std::string gz;
  if (const std::string e = name.extension().string(); e == ".gz" || e == ".GZ") {
    gz = e;
    name.replace_extension();
  }
  const std::string own = name.extension().string();
  const bool isUpper = own.size() > 1 && own[1] >= 'A' && own[1] <= 'Z';
  name.replace_extension(isUpper ? upper : lower);
  return besideFile(file, name.string() + gz);
}

Result<ParsedVolume> parseNiftiFile(const FileRecord& file, std::span<const std::byte> head, bool packed) {
  auto h = parseNifti(head);
  if (!h) return h.error();
  ParsedVolume& p = h->parsed;
  p.place.file = file;
  p.place.packing = packed ? Packing::Gzip : Packing::Raw;
  if (h->pair) {
    auto data = otherOfPair(file, ".img", ".IMG");
    if (!data) return data.error();
    p.place.file = std::move(*data);
    const auto image = openInput(p.place.file);
    if (!image) return image.error();
    std::byte first[3]{};
    p.place.packing = (*image)->read(0, first) && isGzip(first) ? Packing::Gzip : Packing::Raw;
  }
  return std::move(p);
}

Result<std::vector<std::byte>> firstBytes(const InputFilePtr& file, bool packed, std::size_t n) {
  std::vector<std::byte> head(n);
  const auto got = (packed ? gzipStream(file, 0) : rawStream(file, 0))->read(head);
  if (!got) return got.error();
  head.resize(*got);
  return head;
}

Result<ParsedVolume> parsePart(const FileRecord& file);

Result<ParsedVolume> parseAny(const FileRecord& file) {
  auto input = openInput(file);
  if (!input) return input.error();
  auto head = firstBytes(*input, false, kMaxMetaHeaderBytes);
  if (!head) return head.error();
  if (isGzip(*head)) {
    auto inner = firstBytes(*input, true, kNiftiHeaderBytes);
    if (inner && looksLikeNifti(*inner)) return parseNiftiFile(file, *inner, true);
    return formatUnknown(file);
  }
  if (looksLikeNifti(*head)) return parseNiftiFile(file, *head, false);
  if (looksLikeNrrd(textOf(*head))) return parseNrrd(file, textOf(*head));
  if (looksLikeVti(textOf(*head))) return parseVti(file, *input);
  auto meta = parseMetaImage(file, textOf(*head));
  if (meta || meta.error().code != ErrorCode::FormatUnknown) return meta;
  if (looksLikeSidecar(textOf(*head))) return parseSidecar(file, textOf(*head));
  if (looksLikeImageList(file, textOf(*head))) return parseImageList(file, *input);
  return parsePart(file);
}

// Voxels have no mark of their own: the header of a NIfTI pair or a JSON file beside them may speak of them.
Result<ParsedVolume> parsePart(const FileRecord& file) {
  const std::string name = fs::path(file.shown).filename().string();
  const std::string ending = lowerCase(fs::path(name).extension().string());
  std::vector<Result<FileRecord>> headers;
  if (ending == ".img") headers.push_back(otherOfPair(file, ".hdr", ".HDR"));
  if (ending == ".raw" || ending == ".bin" || ending == ".dat")
    headers.push_back(besideFile(file, name + ".json"));
  for (const auto& header : headers) {
    if (!header || header->bytes == 0) continue;
    auto whole = parseAny(*header);
    if (whole || whole.error().code != ErrorCode::FormatUnknown) return whole;
  }
  return formatUnknown(file);
}

Result<ParsedVolume> parse(const FileRecord& file) {
  auto p = guarded("read volume file", [&] { return parseAny(file); });
  if (!p) {
    Error e = p.error();
    if (e.where.empty()) e.where = file.shown;
    return e;
  }
  p->facts.info.title = titleOf(file);
  p->facts.dataFile = p->place.file;
  return p;
}

Result<void> chooseFrame(ParsedVolume& p, const std::optional<std::int64_t>& frame,
                         const std::string& where) {
  const std::int64_t n = p.facts.frames;
  if (n == 1 && frame.value_or(0) == 0) return {};
  const std::string range = "0 to " + std::to_string(n - 1);
  if (!frame)
    return makeError(
        ErrorCode::OptionInvalid,
        "The file holds " + std::to_string(n) + " volumes; choose one with --frame, " + range + ".", where);
  if (*frame < 0 || *frame >= n)
    return makeError(ErrorCode::OptionInvalid,
                     "The file has frames " + range + ", got " + std::to_string(*frame) + ".", "--frame");
  const GridGeometry& g = p.facts.info.grid;
  const auto skip = checkedProduct({static_cast<std::uint64_t>(g.columns), static_cast<std::uint64_t>(g.rows),
                                    static_cast<std::uint64_t>(g.slices), bytesPerVoxel(p.place),
                                    static_cast<std::uint64_t>(*frame)});
  const auto total = skip ? checkedAdd(*skip, p.place.skip) : std::nullopt;
  if (!total)
    return makeError(ErrorCode::LimitExceeded, "The header's sizes ask for more than 2^64 bytes.", where);
  p.place.skip = *total;
  return {};
}

Result<void> chooseSpan(ParsedVolume& p, const std::optional<double>& zSpan) {
  if (!zSpan) return {};
  if (p.facts.format != "image list")
    return makeError(ErrorCode::OptionInvalid,
                     "It is said of lists of images; other files state their own geometry.", "--z-span");
  spanSlices(p.facts.info.grid, *zSpan);
  std::erase_if(p.facts.info.findings, [](const Finding& f) { return f.code == "spacing-assumed"; });
  return settleAxes(p.facts.info.grid);
}

}  // namespace

Result<VolumeFileFacts> readVolumeFacts(const FileRecord& file) {
  auto p = parse(file);
  if (!p) return p.error();
  return std::move(p->facts);
}

Result<std::shared_ptr<const Volume>> readVolumeFile(const FileRecord& file, const BuildOptions& options,
                                                     const ProgressFn& progress, std::stop_token stop) {
  auto p = parse(file);
  if (!p) return p.error();
  if (auto ok = chooseFrame(*p, options.frame, file.shown); !ok) return ok.error();
  if (auto ok = chooseSpan(*p, options.zSpan); !ok) return ok.error();
  return guarded("read volume file", [&] { return loadVoxels(std::move(*p), options, progress, stop); });
}

Result<std::shared_ptr<const Volume>> readVolumeFile(const std::string& path, const BuildOptions& options) {
  const auto record = recordOf(path);
  if (!record) return record.error();
  return readVolumeFile(*record, options);
}

std::vector<VolumeFile> findVolumeFiles(StudySet& set) {
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < set.files.size(); ++i)
    if (set.files[i].kind == FileKind::NotDicom) candidates.push_back(i);
  std::vector<VolumeFile> all(candidates.size());
  parallelFor(candidates.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      VolumeFile& v = all[c];
      v.file = candidates[c];
      auto facts = readVolumeFacts(set.files[v.file]);
      if (facts)
        v.facts = std::move(*facts);
      else
        v.error = facts.error();
    }
  });
  // The .img of a pair is a part of its .hdr, which stands in the list too.
  const auto isPart = [&](const VolumeFile& v) {
    return std::any_of(all.begin(), all.end(), [&](const VolumeFile& o) {
      if (o.file == v.file || !o.facts) return false;
      const FileRecord &data = o.facts->dataFile, &own = set.files[v.file];
      return data.path == own.path && data.archive == own.archive && data.entry == own.entry;
    });
  };
  std::vector<bool> drop(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    drop[i] = (all[i].error && all[i].error->code == ErrorCode::FormatUnknown) || isPart(all[i]);
  std::vector<VolumeFile> found;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!drop[i]) found.push_back(std::move(all[i]));
  for (const VolumeFile& v : found) {
    set.files[v.file].kind = FileKind::Volume;
    set.files[v.file].error = v.error;
  }
  return found;
}

}  // namespace vernier
