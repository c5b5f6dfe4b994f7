// SPDX-License-Identifier: GPL-3.0-or-later
#include "decode/InflatingSource.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "vernier/study/Limits.h"

namespace vernier::study {
namespace {
constexpr std::size_t kPiece = 64 << 10;
}  // namespace

struct InflatingSource::Stream {
  z_stream z{};
  bool ready = false;
  Stream() { ready = inflateInit2(&z, -MAX_WBITS) == Z_OK; }
  ~Stream() {
    if (ready) inflateEnd(&z);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
};

InflatingSource::InflatingSource(Source& file, std::uint64_t dataSet) : file_(file), dataSet_(dataSet) {
  restart();
}
InflatingSource::~InflatingSource() = default;

std::uint64_t InflatingSource::size() const { return end_.value_or(limits::kMaxInflatedBytes); }

void InflatingSource::restart() {
  stream_ = std::make_unique<Stream>();
  packedAt_ = dataSet_;
  packed_.clear();
  window_.clear();
  windowStart_ = 0;
  ended_ = false;
  if (!stream_->ready)
    failure_ = makeError(ErrorCode::OutOfMemory, "There is no memory to inflate the data set.");
}

bool InflatingSource::more() {
  if (failure_ || ended_) return false;
  z_stream& z = stream_->z;
  if (z.avail_in == 0) {
    const std::uint64_t left = file_.size() - std::min(file_.size(), packedAt_);
    packed_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(left, kPiece)));
    if (packed_.empty() || !file_.read(packedAt_, packed_)) {
      failure_ =
          makeError(ErrorCode::FileDamaged,
                    "The deflated data is cut short or damaged; fetch the file again from its source.");
      return false;
    }
    packedAt_ += packed_.size();
    z.next_in = reinterpret_cast<Bytef*>(packed_.data());
    z.avail_in = static_cast<uInt>(packed_.size());
  }
  // What was read last stays: headers are read in overlapping pieces.
  if (window_.size() >= 2 * kPiece) {
    window_.erase(window_.begin(), window_.begin() + kPiece);
    windowStart_ += kPiece;
  }
  const std::size_t have = window_.size();
  window_.resize(have + kPiece);
  z.next_out = reinterpret_cast<Bytef*>(window_.data() + have);
  z.avail_out = kPiece;
  const int code = ::inflate(&z, Z_NO_FLUSH);
  window_.resize(have + kPiece - z.avail_out);
  const std::uint64_t out = windowStart_ + window_.size(), in = packedAt_ - dataSet_ - z.avail_in;
  if (code == Z_STREAM_END) {
    ended_ = true;
    end_ = out;
  } else if (code != Z_OK && code != Z_BUF_ERROR) {
    failure_ = makeError(ErrorCode::FileDamaged,
                         "The deflated data is cut short or damaged; fetch the file again from its source.");
    return false;
  }
  if (out > limits::kMaxInflatedBytes ||
      out > std::max(limits::kAlwaysInflatedBytes, in * limits::kMaxInflateRatio)) {
    failure_ = makeError(ErrorCode::LimitExceeded, "The deflated data set grows beyond " +
                                                       std::to_string(limits::kMaxInflateRatio) +
                                                       " times its size, or beyond 2 GiB; it is refused.");
    return false;
  }
  return true;
}

bool InflatingSource::read(std::uint64_t offset, std::span<std::byte> to) {
  if (!inside(offset, to.size())) return false;
  if (offset < windowStart_) restart();
  while (!to.empty()) {
    const std::uint64_t end = windowStart_ + window_.size();
    if (offset >= end) {
      if (!more()) return false;
      continue;
    }
    const std::uint64_t n = std::min<std::uint64_t>(to.size(), end - offset);
    std::memcpy(to.data(), window_.data() + (offset - windowStart_), n);
    to = to.subspan(n);
    offset += n;
  }
  return true;
}

std::span<const std::byte> InflatingSource::view(std::uint64_t offset, std::uint64_t n,
                                                 std::vector<std::byte>& scratch) {
  if (!inside(offset, n)) return {};
  scratch.resize(n);
  return read(offset, scratch) ? std::span<const std::byte>(scratch) : std::span<const std::byte>{};
}

}  // namespace vernier::study
