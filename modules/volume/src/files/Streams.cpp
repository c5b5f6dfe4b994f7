// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/Streams.h"

#include <bzlib.h>
#include <zlib.h>

#include <algorithm>
#include <vector>

namespace vernier {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;
// What may stand between the last voxel and the end of packed data and is still looked through for a
// checksum.
constexpr std::size_t kMostRest = std::size_t{16} << 20;

class RawStream final : public ByteStream {
 public:
  RawStream(InputFilePtr file, std::uint64_t offset) : file_(std::move(file)), at_(offset) {}
  Result<std::size_t> read(std::span<std::byte> to) override {
    const std::uint64_t left = file_->size() > at_ ? file_->size() - at_ : 0;
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(left, to.size()));
    if (!file_->read(at_, to.first(n)))
      return makeError(ErrorCode::FileDamaged,
                       "The file could not be read to its end; check the disk or network and open it again.");
    at_ += n;
    return n;
  }

 private:
  InputFilePtr file_;
  std::uint64_t at_;
};

class GzipStream final : public ByteStream {
 public:
  GzipStream(InputFilePtr file, std::uint64_t offset) : packed_(std::move(file), offset), piece_(kPiece) {
    ready_ = inflateInit2(&z_, 15 + 32) == Z_OK;  // zlib or gzip wrapping, checksums verified
  }
  ~GzipStream() override {
    if (ready_) inflateEnd(&z_);
  }
  GzipStream(const GzipStream&) = delete;
  GzipStream& operator=(const GzipStream&) = delete;

  Result<std::size_t> read(std::span<std::byte> to) override {
    if (!ready_) return makeError(ErrorCode::OutOfMemory, "The decompressor could not be started.");
    std::size_t done = 0;
    while (done < to.size() && !ended_) {
      if (z_.avail_in == 0) {
        const auto n = packed_.read(piece_);
        if (!n) return n.error();
        if (*n == 0) {  // cut short, unless a member has just ended
          ended_ = true;
          break;
        }
        z_.next_in = reinterpret_cast<Bytef*>(piece_.data());
        z_.avail_in = static_cast<uInt>(*n);
      }
      if (memberEnded_ && !nextMember()) break;
      const std::size_t room = std::min(to.size() - done, std::size_t{1} << 30);
      z_.next_out = reinterpret_cast<Bytef*>(to.data() + done);
      z_.avail_out = static_cast<uInt>(room);
      const int state = inflate(&z_, Z_NO_FLUSH);
      done += room - z_.avail_out;
      if (state == Z_STREAM_END)
        memberEnded_ = true;
      else if (state != Z_OK && state != Z_BUF_ERROR)
        return makeError(ErrorCode::FileDamaged, "The compressed data is damaged; fetch the file again.");
    }
    return done;
  }

  // The checksum stands at the end of the data: without it a flipped bit would pass for a voxel.
  Result<void> finish() override {
    std::vector<std::byte> rest(std::size_t{64} << 10);
    for (std::size_t passed = 0; !memberEnded_ && passed < kMostRest;) {
      const auto n = read(rest);
      if (!n) return n.error();
      if (*n == 0 && !memberEnded_)
        return makeError(
            ErrorCode::FileDamaged,
            "The compressed data ends before its checksum; the file is cut short, fetch it again.");
      passed += *n;
    }
    return {};
  }

 private:
  // gzip members may follow each other; anything else behind the end is ignored, as gzip does.
  bool nextMember() {
    const bool more = z_.avail_in > 0 && z_.next_in[0] == 0x1f && inflateReset(&z_) == Z_OK;
    ended_ = !more;
    memberEnded_ = ended_;
    return more;
  }

  RawStream packed_;
  std::vector<std::byte> piece_;
  z_stream z_{};
  bool ready_ = false, memberEnded_ = false, ended_ = false;
};

class Bzip2Stream final : public ByteStream {
 public:
  Bzip2Stream(InputFilePtr file, std::uint64_t offset) : packed_(std::move(file), offset), piece_(kPiece) {
    ready_ = BZ2_bzDecompressInit(&z_, 0, 0) == BZ_OK;
  }
  ~Bzip2Stream() override {
    if (ready_) BZ2_bzDecompressEnd(&z_);
  }
  Bzip2Stream(const Bzip2Stream&) = delete;
  Bzip2Stream& operator=(const Bzip2Stream&) = delete;

  // Each block has its checksum and is verified before its bytes come out.
  Result<std::size_t> read(std::span<std::byte> to) override {
    if (!ready_) return makeError(ErrorCode::OutOfMemory, "The decompressor could not be started.");
    std::size_t done = 0;
    while (done < to.size() && !ended_) {
      if (z_.avail_in == 0) {
        const auto n = packed_.read(piece_);
        if (!n) return n.error();
        if (*n == 0) break;
        z_.next_in = reinterpret_cast<char*>(piece_.data());
        z_.avail_in = static_cast<unsigned>(*n);
      }
      const std::size_t room = std::min(to.size() - done, std::size_t{1} << 30);
      z_.next_out = reinterpret_cast<char*>(to.data() + done);
      z_.avail_out = static_cast<unsigned>(room);
      const int state = BZ2_bzDecompress(&z_);
      done += room - z_.avail_out;
      ended_ = state == BZ_STREAM_END;
      if (state != BZ_OK && state != BZ_STREAM_END)
        return makeError(ErrorCode::FileDamaged, "The compressed data is damaged; fetch the file again.");
    }
    return done;
  }

 private:
  RawStream packed_;
  std::vector<std::byte> piece_;
  bz_stream z_{};
  bool ready_ = false, ended_ = false;
};

}  // namespace

std::unique_ptr<ByteStream> bzip2Stream(InputFilePtr file, std::uint64_t offset) {
  return std::make_unique<Bzip2Stream>(std::move(file), offset);
}
std::unique_ptr<ByteStream> rawStream(InputFilePtr file, std::uint64_t offset) {
  return std::make_unique<RawStream>(std::move(file), offset);
}
std::unique_ptr<ByteStream> gzipStream(InputFilePtr file, std::uint64_t offset) {
  return std::make_unique<GzipStream>(std::move(file), offset);
}

Result<void> readExactly(ByteStream& stream, std::span<std::byte> to) {
  const auto n = stream.read(to);
  if (!n) return n.error();
  if (*n == to.size()) return {};
  return makeError(ErrorCode::PixelDataShort, "The file ends " + std::to_string(to.size() - *n) +
                                                  " bytes early; it is cut short, fetch it again.");
}

Result<void> skipExactly(ByteStream& stream, std::uint64_t n) {
  std::vector<std::byte> passed(static_cast<std::size_t>(std::min<std::uint64_t>(n, kPiece)));
  while (n > 0) {
    const std::size_t now = static_cast<std::size_t>(std::min<std::uint64_t>(n, passed.size()));
    if (const auto r = readExactly(stream, std::span(passed).first(now)); !r) return r;
    n -= now;
  }
  return {};
}

}  // namespace vernier
