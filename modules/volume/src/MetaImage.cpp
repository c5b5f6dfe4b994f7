// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <filesystem>

#include "Keep.h"
#include "MetaHeader.h"
#include "vernier/base/Checked.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"
#include "vernier/volume/Build.h"

namespace vernier {
namespace {

// What an error may say of a path.
std::string nameOnly(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// A regular file opened for reading.
class File {
 public:
  static Result<File> open(const std::string& path) {
    File f;
    f.fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe must not block us
    if (f.fd_ < 0)
      return makeError(ErrorCode::FileNotFound, "The file does not exist or cannot be read.", nameOnly(path));
    struct stat s {};
    if (fstat(f.fd_, &s) != 0 || !S_ISREG(s.st_mode))
      return makeError(ErrorCode::NotAFile, "This is not a regular file; name a .mhd or .mha file.",
                       nameOnly(path));
    f.bytes_ = static_cast<std::uint64_t>(s.st_size);
    return f;
  }
  File() = default;
  File(File&& o) noexcept : fd_(std::exchange(o.fd_, -1)), bytes_(o.bytes_) {}
  File& operator=(File&& o) noexcept {
    std::swap(fd_, o.fd_);
    std::swap(bytes_, o.bytes_);
    return *this;
  }
  ~File() {
    if (fd_ >= 0) ::close(fd_);
  }
  std::uint64_t bytes() const { return bytes_; }

  bool readAt(std::uint64_t offset, std::byte* out, std::size_t n) const {
    while (n > 0) {
      const ssize_t got = pread(fd_, out, n, static_cast<off_t>(offset));
      if (got <= 0) return false;
      out += got;
      offset += static_cast<std::uint64_t>(got);
      n -= static_cast<std::size_t>(got);
    }
    return true;
  }

 private:
  int fd_ = -1;
  std::uint64_t bytes_ = 0;
};

Error shortData(std::uint64_t need, std::uint64_t has, const std::string& where) {
  return makeError(ErrorCode::PixelDataShort,
                   "The header's sizes need " + std::to_string(need) + " bytes of voxels, the file holds " +
                       std::to_string(has) + "; the file is cut short or the header is wrong.",
                   where);
}

Result<void> readRaw(const File& file, std::uint64_t offset, Buffer& out, const std::string& where) {
  constexpr std::size_t kPiece = std::size_t{4} << 20;
  std::atomic<bool> ok{true};
  parallelFor(out.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    if (!file.readAt(offset + begin, out.data() + begin, end - begin)) ok = false;
  });
  if (!ok) return makeError(ErrorCode::FileDamaged, "The file could not be read to its end.", where);
  return {};
}

class Inflater {
 public:
  Inflater() { ok_ = inflateInit2(&z_, 15 + 32) == Z_OK; }  // zlib or gzip wrapping
  ~Inflater() { inflateEnd(&z_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  bool ok() const { return ok_; }
  z_stream& stream() { return z_; }

 private:
  z_stream z_{};
  bool ok_ = false;
};

Result<void> readDeflated(const File& file, std::uint64_t offset, Buffer& out, const std::string& where) {
  Inflater inflater;
  if (!inflater.ok())
    return makeError(ErrorCode::OutOfMemory, "The decompressor could not be started.", where);
  z_stream& z = inflater.stream();
  std::vector<std::byte> piece(std::size_t{1} << 20);
  std::uint64_t written = 0;
  int state = Z_OK;
  while (written < out.size() && state == Z_OK) {
    if (z.avail_in == 0) {
      const std::size_t n =
          static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), file.bytes() - offset));
      if (n == 0 || !file.readAt(offset, piece.data(), n)) break;
      offset += n;
      z.next_in = reinterpret_cast<Bytef*>(piece.data());
      z.avail_in = static_cast<uInt>(n);
    }
    const std::uint64_t room = std::min<std::uint64_t>(out.size() - written, std::uint64_t{1} << 30);
    z.next_out = reinterpret_cast<Bytef*>(out.data() + written);
    z.avail_out = static_cast<uInt>(room);
    state = inflate(&z, Z_NO_FLUSH);
    written += room - z.avail_out;
  }
  if (written == out.size()) return {};
  if (state == Z_OK || state == Z_STREAM_END || state == Z_BUF_ERROR)
    return shortData(out.size(), written, where);
  return makeError(ErrorCode::FileDamaged, "The compressed voxels are damaged; fetch the file again.", where);
}

void swapBytes(Buffer& b, std::size_t width) {
  if (width == 1) return;
  parallelFor(b.size() / width, std::size_t{1} << 20, [&](std::size_t begin, std::size_t end) {
    if (width == 2) {
      std::uint16_t* const v = reinterpret_cast<std::uint16_t*>(b.data());
      for (std::size_t i = begin; i < end; ++i) v[i] = static_cast<std::uint16_t>(v[i] << 8 | v[i] >> 8);
    } else {
      std::uint32_t* const v = reinterpret_cast<std::uint32_t*>(b.data());
      for (std::size_t i = begin; i < end; ++i) v[i] = __builtin_bswap32(v[i]);
    }
  });
}

// Where the voxels stand: the header's own file, or a file in or below its folder.
Result<std::string> dataPath(const std::string& headerPath, const MetaHeader& h) {
  if (h.dataFile == "LOCAL") return headerPath;
  const std::filesystem::path named(h.dataFile);
  const bool up = std::any_of(named.begin(), named.end(), [](const auto& part) { return part == ".."; });
  if (named.is_absolute() || up)
    return makeError(
        ErrorCode::FileDamaged,
        "ElementDataFile names a file outside the header's folder, which is refused; put both files in one "
        "folder and name the data file alone.",
        nameOnly(headerPath));
  return (std::filesystem::path(headerPath).parent_path() / named).string();
}

// First byte of the voxels in the data file. No allocation before this has passed: raw data must be there in
// full, and deflate cannot grow anything by more than 1032.
Result<std::uint64_t> voxelOffset(const MetaHeader& h, std::uint64_t need, std::uint64_t has,
                                  const std::string& where) {
  std::uint64_t offset = h.dataFile == "LOCAL" ? h.dataOffset : 0;
  if (h.headerSize > 0) offset += static_cast<std::uint64_t>(h.headerSize);
  if (h.headerSize < 0 && !h.compressed) offset = has >= need ? has - need : has;
  if (offset > has) return shortData(need, 0, where);
  const std::uint64_t left = has - offset;
  const std::uint64_t most = h.compressed ? left * 1032 : left;
  if (most < need) return shortData(need, left, where);
  return offset;
}

GridGeometry gridOf(const MetaHeader& h) {
  GridGeometry g;
  g.columns = h.size[0];
  g.rows = h.size[1];
  g.slices = h.size[2];
  for (int axis = 0; axis < 3; ++axis)
    g.patientFromVoxel.linear[axis] =
        h.spacing_mm[static_cast<std::size_t>(axis)] * h.direction[static_cast<std::size_t>(axis)];
  g.patientFromVoxel.translation = {h.offset_mm[0], h.offset_mm[1], h.offset_mm[2]};
  return g;
}

Result<MetaHeader> readHeader(const std::string& path) {
  Result<File> file = File::open(path);
  if (!file) return file.error();
  std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(file->bytes(), kMaxMetaHeaderBytes)),
                   '\0');
  if (!file->readAt(0, reinterpret_cast<std::byte*>(text.data()), text.size()))
    return makeError(ErrorCode::FileNotFound, "The file cannot be read.", nameOnly(path));
  return parseMetaHeader(text, nameOnly(path));
}

Result<std::shared_ptr<const Volume>> readWith(const std::string& path, const BuildOptions& options) {
  const TraceSpan span("read MetaImage");
  const Result<MetaHeader> h = readHeader(path);
  if (!h) return h.error();
  const Result<std::string> data = dataPath(path, *h);
  if (!data) return data.error();
  const Result<File> file = File::open(*data);
  if (!file) return file.error();
  const auto need =
      checkedProduct({static_cast<std::uint64_t>(h->size[0]), static_cast<std::uint64_t>(h->size[1]),
                      static_cast<std::uint64_t>(h->size[2]), bytesOf(h->type)});
  if (!need)
    return makeError(ErrorCode::LimitExceeded, "DimSize asks for more than 2^64 bytes.", nameOnly(path));
  const Result<std::uint64_t> offset = voxelOffset(*h, *need, file->bytes(), nameOnly(*data));
  if (!offset) return offset.error();

  MemoryBudget::Reservation reservation;
  if (options.budget) {
    Result<MemoryBudget::Reservation> r = options.budget->reserve(*need, "the volume");
    if (!r) return r.error();
    reservation = std::move(r).value();
  }
  Result<Buffer> made = Buffer::make(static_cast<std::size_t>(*need));
  if (!made) return made.error();
  Buffer voxels = std::move(made).value();
  const Result<void> read = h->compressed ? readDeflated(*file, *offset, voxels, nameOnly(*data))
                                          : readRaw(*file, *offset, voxels, nameOnly(*data));
  if (!read) return read.error();
  if (h->bigEndian) swapBytes(voxels, bytesOf(h->type));

  VolumeInfo info;
  info.grid = gridOf(*h);
  info.type = h->type;
  info.rescale = {{h->slope, h->intercept}};
  info.modality = h->modality;
  info.title = std::filesystem::path(path).stem().string();
  Result<std::shared_ptr<const Volume>> volume = Volume::make(std::move(info), std::move(voxels));
  if (!volume) return makeError(volume.error().code, volume.error().sentence, nameOnly(path));
  return keepReservation(std::move(volume).value(), std::move(reservation));
}

}  // namespace

Result<std::shared_ptr<const Volume>> readMetaImage(const std::string& path, const BuildOptions& options) {
  return guarded("readMetaImage", [&] { return readWith(path, options); });
}

}  // namespace vernier
