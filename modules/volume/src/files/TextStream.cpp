// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers written out, as bytes of their type: what other packings give too.
#include <algorithm>
#include <cstring>
#include <vector>

#include "files/LoadVoxels.h"
#include "files/TextParts.h"

namespace vernier {
namespace {

constexpr std::size_t kLongestNumber = 512;

class TextStream final : public ByteStream {
 public:
  TextStream(InputFilePtr file, std::uint64_t offset, FileType type)
      : text_(rawStream(std::move(file), offset)), type_(type), piece_(std::size_t{256} << 10) {}

  // to.size() is a multiple of the type's width.
  Result<std::size_t> read(std::span<std::byte> to) override {
    const std::size_t width = bytesOf(type_);
    std::size_t done = 0;
    for (; done + width <= to.size(); done += width) {
      const auto word = nextWord();
      if (!word) return word.error();
      if (word->empty()) break;
      if (!put(*word, to.data() + done))
        return makeError(ErrorCode::FileDamaged, std::string("The text holds something that is no ") +
                                                     nameOf(type_) + " where a voxel is expected.");
    }
    return done;
  }

 private:
  static bool blank(char c) { return c == ' ' || c == ',' || (c >= '\t' && c <= '\r'); }

  // Empty at the end of the file. The view holds until the next call.
  Result<std::string_view> nextWord() {
    while (true) {
      while (at_ < end_ && blank(piece_[at_])) ++at_;
      std::size_t stop = at_;
      while (stop < end_ && !blank(piece_[stop])) ++stop;
      if (at_ < end_ && (stop < end_ || ended_)) {
        const std::string_view word(piece_.data() + at_, stop - at_);
        at_ = stop;
        return word;
      }
      if (ended_) return std::string_view();
      if (end_ - at_ > kLongestNumber)
        return makeError(ErrorCode::FileDamaged, "The text holds something that is no number.");
      if (auto r = refill(); !r) return r.error();
    }
  }

  Result<void> refill() {
    std::memmove(piece_.data(), piece_.data() + at_, end_ - at_);
    end_ -= at_;
    at_ = 0;
    const auto n = text_->read(std::as_writable_bytes(std::span(piece_).subspan(end_)));
    if (!n) return n.error();
    ended_ = *n == 0;
    end_ += *n;
    return {};
  }

  template <class T>
  static bool putAs(std::string_view word, std::byte* to) {
    const auto x = numberIn<T>(word);
    if (!x) return false;
    std::memcpy(to, &*x, sizeof(T));
    return true;
  }
  bool put(std::string_view word, std::byte* to) const {
    switch (type_) {
      case FileType::U8:
        return putAs<std::uint8_t>(word, to);
      case FileType::I8:
        return putAs<std::int8_t>(word, to);
      case FileType::U16:
        return putAs<std::uint16_t>(word, to);
      case FileType::I16:
        return putAs<std::int16_t>(word, to);
      case FileType::U32:
        return putAs<std::uint32_t>(word, to);
      case FileType::I32:
        return putAs<std::int32_t>(word, to);
      case FileType::U64:
        return putAs<std::uint64_t>(word, to);
      case FileType::I64:
        return putAs<std::int64_t>(word, to);
      case FileType::F32:
        return putAs<float>(word, to);
      case FileType::F64:
        return putAs<double>(word, to);
    }
    return false;
  }

  std::unique_ptr<ByteStream> text_;
  FileType type_;
  std::vector<char> piece_;
  std::size_t at_ = 0, end_ = 0;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<ByteStream> textStream(InputFilePtr file, std::uint64_t offset, FileType type) {
  return std::make_unique<TextStream>(std::move(file), offset, type);
}

}  // namespace vernier
