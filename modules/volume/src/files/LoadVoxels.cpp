// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/LoadVoxels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "Keep.h"
#include "files/Channels.h"
#include "vernier/base/Checked.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier {
namespace {

constexpr std::size_t kPiece = std::size_t{4} << 20;
// What a packed byte can become at most: deflate's bound, and one for bzip2 that no image comes near.
constexpr std::uint64_t kMostDeflate = 1032, kMostBzip2 = 1 << 16;

// Bytes of voxels that so many bytes of a file can hold.
std::uint64_t mostBytes(const VoxelPlace& place, std::uint64_t left) {
  const std::uint64_t n = std::min(left, std::uint64_t{1} << 46);
  switch (place.packing) {
    case Packing::Raw:
      return left;
    case Packing::Gzip:
      return n * kMostDeflate;
    case Packing::Bzip2:
      return n * kMostBzip2;
    case Packing::Text:
      return (n + 1) / 2 * bytesOf(place.type);  // a digit and a blank
    case Packing::Other:
      return place.mostBytes;
  }
  return 0;
}

Error shortData(std::uint64_t need, std::uint64_t has, const std::string& where) {
  return makeError(ErrorCode::PixelDataShort,
                   "The header's sizes need " + std::to_string(need) + " bytes of voxels, the file holds " +
                       std::to_string(has) + "; the file is cut short or the header is wrong.",
                   where);
}

template <class T>
T swapped(T x) {
  if constexpr (sizeof(T) == 1) return x;
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(x);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
void swapAll(std::byte* data, std::size_t n) {
  T* const v = reinterpret_cast<T*>(data);
  for (std::size_t i = 0; i < n; ++i) v[i] = swapped(v[i]);
}

void swapBytes(std::span<std::byte> bytes, std::size_t width) {
  if (width == 1) return;
  parallelFor(bytes.size() / width, std::size_t{1} << 20, [&](std::size_t begin, std::size_t end) {
    std::byte* const at = bytes.data() + begin * width;
    if (width == 2) swapAll<std::uint16_t>(at, end - begin);
    if (width == 4) swapAll<std::uint32_t>(at, end - begin);
    if (width == 8) swapAll<std::uint64_t>(at, end - begin);
  });
}

// What conversion to 32 bits did to the values so far.
struct Converted {
  std::uint64_t rounded = 0, unfit = 0;
  double largest = 0;  // difference of a value to what became of it
};

void convert(const double* from, float* to, std::size_t n, Converted& c) {
  for (std::size_t i = 0; i < n; ++i) {
    to[i] = static_cast<float>(from[i]);
    if (!std::isfinite(from[i])) continue;
    const double off = std::abs(static_cast<double>(to[i]) - from[i]);
    c.unfit += !std::isfinite(off);
    if (off > 0 && std::isfinite(off)) {
      ++c.rounded;
      c.largest = std::max(c.largest, off);
    }
  }
}

template <class T>
void convert(const T* from, std::int32_t* to, std::size_t n, Converted& c) {
  for (std::size_t i = 0; i < n; ++i) {
    to[i] = static_cast<std::int32_t>(from[i]);
    c.unfit += !std::in_range<std::int32_t>(from[i]);
  }
}

class Loader {
 public:
  Loader(ParsedVolume parsed, const BuildOptions& options) : parsed_(std::move(parsed)), options_(options) {}

  Result<std::shared_ptr<const Volume>> load(const ProgressFn& progress, const std::stop_token& stop) {
    const TraceSpan span("read volume file");
    Result<void> ok = prepare();
    if (ok) ok = colour() ? readColours(progress, stop) : fast() ? readRaw(stop) : readStream(progress, stop);
    if (ok) ok = judge();
    if (!ok) return located(ok.error());
    auto volume = colour() ? Volume::makeColour(std::move(info()), std::move(planes_))
                           : Volume::make(std::move(info()), std::move(voxels_));
    if (!volume) return located(volume.error());
    return keepReservation(std::move(volume).value(), std::move(reservation_));
  }

 private:
  VolumeInfo& info() { return parsed_.facts.info; }
  VoxelPlace& place() { return parsed_.place; }
  bool same() { return bytesOf(place().type) == vernier::bytesOf(info().type); }
  bool colour() { return place().channels > 1; }
  bool fast() { return place().packing == Packing::Raw && same(); }
  Error located(Error e) {
    if (e.where.empty()) e.where = place().file.shown;
    return e;
  }

  Result<void> prepare() {
    const GridGeometry& g = info().grid;
    const auto n = checkedProduct({static_cast<std::uint64_t>(g.columns), static_cast<std::uint64_t>(g.rows),
                                   static_cast<std::uint64_t>(g.slices)});
    const auto inFile = n ? checkedProduct({*n, bytesPerVoxel(place())}) : std::nullopt;
    if (!inFile || *inFile > std::uint64_t{1} << 62)
      return makeError(ErrorCode::LimitExceeded, "The header's sizes ask for more than 2^62 bytes.");
    count_ = *n;
    auto file = openInput(place().file);
    if (!file) return file.error();
    file_ = *file;
    if (auto r = passLines(); !r) return r;
    if (auto r = checkRoom(*inFile); !r) return r;
    const auto channels = static_cast<std::size_t>(place().channels);
    const std::uint64_t plane = count_ * vernier::bytesOf(info().type);
    if (options_.budget) {
      auto r = options_.budget->reserve(plane * channels, "the volume");
      if (!r) return r.error();
      reservation_ = std::move(r).value();
    }
    for (std::size_t c = 0; c < channels; ++c) {
      auto made = Buffer::make(static_cast<std::size_t>(plane));
      if (!made) return made.error();
      planes_.push_back(std::move(made).value());
    }
    if (!colour()) voxels_ = std::move(planes_.front());
    return {};
  }

  // No memory before this has passed: raw data must be there in full, packed data must be able to hold it.
  Result<void> checkRoom(std::uint64_t need) {
    VoxelPlace& p = place();
    const std::uint64_t has = file_->size();
    if (p.atEnd) p.offset = has >= need ? has - need : 0;
    if (p.offset > has) return shortData(need, 0, p.file.shown);
    const std::uint64_t left = has - p.offset;
    const bool raw = p.packing == Packing::Raw;
    const std::uint64_t most = mostBytes(p, left);
    if (p.skip > most || most - p.skip < need)
      return shortData(need, raw && left > p.skip ? left - p.skip : left, p.file.shown);
    if (raw && left - p.skip > need) bytesAfter(left - p.skip - need);
    return {};
  }

  Result<void> passLines() {
    VoxelPlace& p = place();
    std::vector<std::byte> piece(std::size_t{64} << 10);
    for (std::uint64_t lines = p.skipLines; lines > 0;) {
      const auto n = rawStream(file_, p.offset)->read(piece);
      if (!n) return n.error();
      if (*n == 0) return shortData(1, 0, p.file.shown);
      std::size_t at = 0;
      while (at < *n && lines > 0) lines -= piece[at++] == std::byte{'\n'};
      p.offset += at;
    }
    return {};
  }

  void bytesAfter(std::uint64_t n) {
    info().findings.push_back({"bytes-after-voxels",
                               Severity::Info,
                               std::to_string(n) + " bytes follow the voxels in the file and are not used.",
                               {{"bytes", static_cast<double>(n)}}});
  }

  Result<void> readRaw(const std::stop_token& stop) {
    std::atomic<bool> ok{true};
    const std::uint64_t offset = place().offset + place().skip;
    parallelFor(voxels_.size(), kPiece, [&](std::size_t begin, std::size_t end) {
      if (stop.stop_requested()) return;
      if (!file_->read(offset + begin, voxels_.bytes().subspan(begin, end - begin))) ok = false;
    });
    if (stop.stop_requested()) return cancelled();
    if (!ok)
      return makeError(ErrorCode::FileDamaged,
                       "The file could not be read to its end; check the disk or network and open it again.");
    if (swaps()) swapBytes(voxels_.bytes(), bytesOf(place().type));
    return {};
  }

  Result<void> readStream(const ProgressFn& progress, const std::stop_token& stop) {
    const auto stream = openStream(file_, place());
    if (auto r = skipExactly(*stream, place().skip); !r) return r;
    const std::size_t width = bytesOf(place().type);
    const std::uint64_t perPiece = kPiece / width;
    std::vector<std::byte> piece(same() ? 0 : static_cast<std::size_t>(std::min(count_, perPiece)) * width);
    for (std::uint64_t done = 0; done < count_;) {
      if (stop.stop_requested()) return cancelled();
      const std::size_t n = static_cast<std::size_t>(std::min(perPiece, count_ - done));
      const std::span<std::byte> to =
          same() ? voxels_.bytes().subspan(done * width, n * width) : std::span(piece).first(n * width);
      const auto got = stream->read(to);
      if (!got) return got.error();
      if (*got < to.size()) return shortData(count_ * width, done * width + *got, place().file.shown);
      if (swaps()) swapBytes(to, width);
      if (!same()) convertPiece(to.data(), done, n);
      done += n;
      if (progress) progress("read", done, count_);
    }
    return stream->finish();
  }

  // Colours are bytes, in a file as in memory: nothing is converted.
  Result<void> readColours(const ProgressFn& progress, const std::stop_token& stop) {
    const auto stream = openStream(file_, place());
    if (auto r = skipExactly(*stream, place().skip); !r) return r;
    const std::uint64_t samples = count_ * bytesPerVoxel(place());
    const std::uint64_t stride = bytesPerVoxel(place()), perPiece = kPiece / stride * stride;
    std::vector<std::byte> piece(static_cast<std::size_t>(std::min(samples, perPiece)));
    for (std::uint64_t done = 0; done < samples;) {
      if (stop.stop_requested()) return cancelled();
      const std::uint64_t inPlane = place().planar ? count_ - done % count_ : samples;
      const auto to =
          std::span(piece).first(static_cast<std::size_t>(std::min({perPiece, samples - done, inPlane})));
      const auto got = stream->read(to);
      if (!got) return got.error();
      if (*got < to.size()) return shortData(samples, done + *got, place().file.shown);
      if (place().planar)
        std::memcpy(planes_[done / count_].data() + done % count_, to.data(), to.size());
      else
        spreadChannels(to, planes_, done / stride);
      done += to.size();
      if (progress) progress("read", done, samples);
    }
    judgeAlpha(planes_, info().findings);
    return stream->finish();
  }

  void convertPiece(const std::byte* from, std::uint64_t at, std::size_t n) {
    std::byte* const to = voxels_.data() + at * 4;
    if (place().type == FileType::F64)
      convert(reinterpret_cast<const double*>(from), reinterpret_cast<float*>(to), n, converted_);
    else if (place().type == FileType::I64)
      convert(reinterpret_cast<const std::int64_t*>(from), reinterpret_cast<std::int32_t*>(to), n,
              converted_);
    else
      convert(reinterpret_cast<const std::uint64_t*>(from), reinterpret_cast<std::int32_t*>(to), n,
              converted_);
  }

  // What the conversion means for a reader.
  Result<void> judge() {
    if (same()) return {};
    const std::string from = nameOf(place().type);
    if (place().type != FileType::F64) {
      if (converted_.unfit > 0)
        return makeError(ErrorCode::PixelDescriptionInvalid,
                         std::to_string(converted_.unfit) + " values of type " + from +
                             " do not fit in 32 bits; convert the file to a type of at most 32 bits.");
      info().findings.push_back({"values-converted",
                                 Severity::Info,
                                 "The values are " + from + " and all fit in 32 bits; none changed.",
                                 {}});
      return {};
    }
    if (converted_.unfit > 0)
      return makeError(
          ErrorCode::PixelDescriptionInvalid,
          std::to_string(converted_.unfit) +
              " values of type float64 are beyond the range of 32-bit floats; rescale the file.");
    Finding f{"double-pixels-rounded", converted_.rounded > 0 ? Severity::Notice : Severity::Info, "", {}};
    f.sentence = converted_.rounded > 0
                     ? "The values are 64-bit floats; they are shown and measured as 32-bit floats."
                     : "The values are 64-bit floats that 32-bit floats hold exactly; none changed.";
    f.numbers = {{"rounded_voxels", static_cast<double>(converted_.rounded)},
                 {"largest_difference_val", std::abs(info().rescale[0].slope) * converted_.largest}};
    info().findings.push_back(std::move(f));
    return {};
  }

  bool swaps() { return place().bigEndian == (std::endian::native == std::endian::little); }
  static Error cancelled() { return makeError(ErrorCode::Cancelled, "Loading was cancelled."); }

  ParsedVolume parsed_;
  const BuildOptions& options_;
  std::uint64_t count_ = 0;
  InputFilePtr file_;
  MemoryBudget::Reservation reservation_;
  Buffer voxels_;
  std::vector<Buffer> planes_;  // of colours, instead of voxels_
  Converted converted_;
};

}  // namespace

std::size_t bytesOf(FileType t) {
  switch (t) {
    case FileType::U8:
    case FileType::I8:
      return 1;
    case FileType::U16:
    case FileType::I16:
      return 2;
    case FileType::U32:
    case FileType::I32:
    case FileType::F32:
      return 4;
    default:
      return 8;
  }
}

const char* nameOf(FileType t) {
  static constexpr const char* kNames[] = {"uint8", "int8",   "uint16", "int16",   "uint32",
                                           "int32", "uint64", "int64",  "float32", "float64"};
  return kNames[static_cast<int>(t)];
}

VoxelType voxelTypeOf(FileType t) {
  switch (t) {
    case FileType::U8:
      return VoxelType::U8;
    case FileType::I8:
      return VoxelType::I8;
    case FileType::U16:
      return VoxelType::U16;
    case FileType::I16:
      return VoxelType::I16;
    case FileType::U32:
      return VoxelType::U32;
    case FileType::I32:
    case FileType::U64:
    case FileType::I64:
      return VoxelType::I32;
    default:
      return VoxelType::F32;
  }
}

std::unique_ptr<ByteStream> openStream(const InputFilePtr& file, const VoxelPlace& p) {
  switch (p.packing) {
    case Packing::Gzip:
      return gzipStream(file, p.offset);
    case Packing::Bzip2:
      return bzip2Stream(file, p.offset);
    case Packing::Text:
      return textStream(file, p.offset, p.type);
    case Packing::Other:
      return p.open(file);
    case Packing::Raw:
      break;
  }
  return rawStream(file, p.offset);
}

Result<std::shared_ptr<const Volume>> loadVoxels(ParsedVolume parsed, const BuildOptions& options,
                                                 const ProgressFn& progress, std::stop_token stop) {
  return Loader(std::move(parsed), options).load(progress, stop);
}

}  // namespace vernier
