// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/ImageList.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/Affine.h"
#include "files/Channels.h"
#include "files/Pictures.h"
#include "files/TextParts.h"
#include "vernier/base/Checked.h"
#include "vernier/study/Limits.h"

namespace vernier {
namespace {

Error damaged(const std::string& sentence) {
  return makeError(ErrorCode::FileDamaged, "The list of images cannot be used: " + sentence);
}

std::string_view nextLine(std::string_view& text) {
  const std::size_t eol = std::min(text.find('\n'), text.size());
  const std::string_view line = trimmed(text.substr(0, eol));
  text.remove_prefix(std::min(eol + 1, text.size()));
  return line;
}
bool says(std::string_view line) { return !line.empty() && line.front() != '#'; }

struct List {
  std::vector<std::string> names;
  double width = 1, height = 1;  // of a pixel
  std::optional<double> zSpan;
  bool sized = false;
  std::string unit;
};

bool length(double x) { return std::isfinite(x) && x > 0; }

Result<void> readDirective(std::string_view line, List& list) {
  const auto parts = words(line);
  const auto numbers = numbersIn<double>(line.substr(parts[0].size()));
  if (parts[0] == "@z-span" && numbers && numbers->size() == 1 && length((*numbers)[0])) {
    list.zSpan = (*numbers)[0];
    return {};
  }
  if (parts[0] == "@pixel-size" && numbers && numbers->size() == 2 && length((*numbers)[0]) &&
      length((*numbers)[1])) {
    list.width = (*numbers)[0];
    list.height = (*numbers)[1];
    list.sized = true;
    return {};
  }
  if (parts[0] == "@unit" && parts.size() > 1) {
    list.unit = std::string(trimmed(line.substr(parts[0].size())));
    return {};
  }
  return damaged(
      "a line that begins with @ is none of '@z-span S', '@pixel-size W H' (numbers above 0), '@unit TEXT'.");
}

Result<List> parseList(std::string_view text) {
  List list;
  while (!text.empty()) {
    const std::string_view line = nextLine(text);
    if (!says(line)) continue;
    if (line.front() == '@') {
      if (auto r = readDirective(line, list); !r) return r.error();
      continue;
    }
    list.names.emplace_back(line);
    if (list.names.size() > limits::kMaxFrames)
      return makeError(ErrorCode::LimitExceeded,
                       "The list names more than " + std::to_string(limits::kMaxFrames) + " images.");
  }
  if (list.names.empty()) return damaged("it names no image.");
  return list;
}

Error inPicture(Error e, const FileRecord& picture) {
  e.where = picture.shown;
  return e;
}

// Slice after slice, each picture opened when its turn comes.
class ListStream final : public ByteStream {
 public:
  ListStream(std::vector<FileRecord> pictures, const PictureFacts& facts)
      : pictures_(std::move(pictures)),
        facts_(facts),
        slice_(static_cast<std::size_t>(facts.columns * facts.rows) * bytesOf(facts.type) *
               static_cast<std::size_t>(facts.channels)),
        at_(slice_.size()) {}

  Result<std::size_t> read(std::span<std::byte> to) override {
    std::size_t done = 0;
    while (done < to.size()) {
      if (at_ == slice_.size()) {
        if (next_ == pictures_.size()) break;
        if (auto r = open(pictures_[next_]); !r) return inPicture(r.error(), pictures_[next_]);
        ++next_;
        at_ = 0;
      }
      const std::size_t n = std::min(to.size() - done, slice_.size() - at_);
      std::memcpy(to.data() + done, slice_.data() + at_, n);
      done += n;
      at_ += n;
    }
    return done;
  }

 private:
  Result<void> open(const FileRecord& picture) {
    auto file = openInput(picture);
    if (!file) return file.error();
    const auto facts = pictureFacts(*file);
    if (!facts) return facts.error();
    if (*facts != facts_)
      return damaged("this image has another size, depth or kind than the first one; all must be alike.");
    return readPicture(*file, facts_, slice_);
  }

  std::vector<FileRecord> pictures_;
  PictureFacts facts_;
  std::vector<std::byte> slice_;
  std::size_t at_, next_ = 0;
};

FileType fileTypeOf(VoxelType t) {
  switch (t) {
    case VoxelType::U8:
      return FileType::U8;
    case VoxelType::I8:
      return FileType::I8;
    case VoxelType::U16:
      return FileType::U16;
    case VoxelType::I16:
      return FileType::I16;
    default:
      return FileType::F32;
  }
}

Result<std::vector<FileRecord>> picturesOf(const FileRecord& file, const List& list) {
  std::vector<FileRecord> pictures;
  for (const std::string& name : list.names) {
    auto picture = besideFile(file, name);
    if (!picture)
      return makeError(
          picture.error().code,
          "The list names an image outside its own folder, which is refused; put the images beside it.");
    if (picture->bytes == 0)
      return makeError(ErrorCode::FileNotFound, "An image of the list is not there or is empty.",
                       picture->shown);
    pictures.push_back(std::move(*picture));
  }
  return pictures;
}

void describe(const List& list, const PictureFacts& facts, VolumeInfo& info) {
  GridGeometry& g = info.grid;
  g.columns = facts.columns;
  g.rows = facts.rows;
  g.slices = static_cast<std::int64_t>(list.names.size());
  g.patientFromVoxel.linear = glm::dmat3(0);
  g.patientFromVoxel.linear[0][0] = list.width;
  g.patientFromVoxel.linear[1][1] = list.height;
  g.patientFromVoxel.linear[2][2] = list.width;
  if (list.zSpan) spanSlices(g, *list.zSpan);
  info.findings.push_back(axesUnknown("A list of images does not say how they lie in a patient."));
  if (!list.sized || !list.zSpan)
    info.findings.push_back(
        {"spacing-assumed",
         Severity::Warning,
         std::string("The list does not state ") +
             (list.sized ? "the span of its slices; they are taken to be as far apart as columns."
                         : "the size of a pixel; 1 mm is taken and lengths mean nothing."),
         {}});
  info.inverted = facts.whiteIsZero;
  if (!list.unit.empty()) info.unit = list.unit;
  info.modality = "OT";
}

}  // namespace

bool looksLikeImageList(const FileRecord& file, std::string_view text) {
  for (int lines = 0; !text.empty() && lines < 200; ++lines) {
    const std::string_view line = nextLine(text);
    if (line.size() > 4096 || line.find('\0') != std::string_view::npos) return false;
    if (!says(line) || line.front() == '@') continue;
    const auto picture = besideFile(file, std::string(line));
    if (!picture || picture->bytes == 0) return false;
    const auto input = openInput(*picture);
    std::byte head[8]{};
    return input && (*input)->read(0, head) && pictureKindOf(head) != PictureKind::None;
  }
  return false;
}

Result<ParsedVolume> parseImageList(const FileRecord& file, const InputFilePtr& input) {
  if (input->size() > kMaxImageListBytes)
    return makeError(ErrorCode::LimitExceeded, "The list of images is longer than 8 MiB.");
  std::string text(static_cast<std::size_t>(input->size()), '\0');
  if (!input->read(0, std::as_writable_bytes(std::span(text)))) return damaged("it could not be read.");
  const auto list = parseList(text);
  if (!list) return list.error();
  auto pictures = picturesOf(file, *list);
  if (!pictures) return pictures.error();
  const auto first = openInput(pictures->front());
  if (!first) return first.error();
  const auto facts = pictureFacts(*first);
  if (!facts) return inPicture(facts.error(), pictures->front());
  ParsedVolume p;
  p.facts.format = "image list";
  describe(*list, *facts, p.facts.info);
  if (auto ok = settleAxes(p.facts.info.grid); !ok) return ok.error();
  p.place.file = file;
  p.place.type = fileTypeOf(facts->type);
  p.place.bigEndian = std::endian::native == std::endian::big;
  p.facts.storedType = nameOf(p.place.type);
  p.facts.info.type = voxelTypeOf(p.place.type);
  if (facts->channels > 1 && !list->unit.empty())
    return damaged("it states a unit, which colours do not have.");
  if (auto ok = setChannels(p, facts->channels); !ok) return inPicture(ok.error(), pictures->front());
  for (const FileRecord& r : *pictures) p.place.mostBytes += std::min(r.bytes, std::uint64_t{1} << 40) * 1032;
  p.place.packing = Packing::Other;
  p.place.open = [pictures = std::move(*pictures), facts = *facts](const InputFilePtr&) {
    return std::make_unique<ListStream>(pictures, facts);
  };
  return p;
}

void spanSlices(GridGeometry& g, double zSpan) {
  glm::dvec3& step = g.patientFromVoxel.linear[2];
  step = glm::normalize(step) * (zSpan / static_cast<double>(g.slices));
}

}  // namespace vernier
