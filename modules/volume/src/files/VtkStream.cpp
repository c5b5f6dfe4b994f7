// SPDX-License-Identifier: GPL-3.0-or-later
// The binary form of VTK's XML files: [bytes][data], or with a compressor [blocks][block bytes][last block
// bytes] [packed bytes of each block][packed blocks]; either as it is or in base64 (where the header is
// padded for itself).
#include <zlib.h>

#include <algorithm>
#include <array>
#include <vector>

#include "files/Vti.h"

namespace vernier {
namespace {

Error damaged(const char* what) {
  return makeError(ErrorCode::FileDamaged, std::string("The VTK data array is damaged: ") + what + ".");
}

// Groups of four characters; a padded group ends a run, and another may follow. Ends at "<" or the end of the
// file.
class Base64Stream final : public ByteStream {
 public:
  Base64Stream(InputFilePtr file, std::uint64_t offset) : text_(rawStream(std::move(file), offset)) {}

  Result<std::size_t> read(std::span<std::byte> to) override {
    std::size_t done = 0;
    while (done < to.size()) {
      if (at_ == have_) {
        const auto more = group();
        if (!more) return more.error();
        if (!*more) break;
      }
      to[done++] = out_[at_++];
    }
    return done;
  }

 private:
  static int valueOf(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  }
  // The next character that is no blank; 0 at the end.
  Result<char> next() {
    while (true) {
      if (textAt_ == textHave_) {
        const auto n = text_->read(std::as_writable_bytes(std::span(chars_)));
        if (!n) return n.error();
        if (*n == 0) return '\0';
        textHave_ = *n;
        textAt_ = 0;
      }
      const char c = chars_[textAt_];
      if (c == '<') return '\0';
      ++textAt_;
      if (c != ' ' && (c < '\t' || c > '\r')) return c;
    }
  }
  Result<bool> group() {
    std::array<int, 4> v{};
    std::size_t real = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto c = next();
      if (!c) return c.error();
      if (*c == '\0' && i == 0) return false;
      if (*c == '=') continue;
      v[i] = valueOf(*c);
      if (v[i] < 0 || real < i) return damaged("it holds a character that is no base64");
      ++real;
    }
    if (real < 2) return damaged("a group of base64 is too short");
    const unsigned bits = static_cast<unsigned>(v[0] << 18 | v[1] << 12 | v[2] << 6 | v[3]);
    out_ = {static_cast<std::byte>(bits >> 16), static_cast<std::byte>(bits >> 8),
            static_cast<std::byte>(bits)};
    at_ = 0;
    have_ = real - 1;
    return true;
  }

  std::unique_ptr<ByteStream> text_;
  std::array<char, 64 << 10> chars_{};
  std::size_t textAt_ = 0, textHave_ = 0;
  std::array<std::byte, 3> out_{};
  std::size_t at_ = 0, have_ = 0;
};

class VtkStream final : public ByteStream {
 public:
  VtkStream(InputFilePtr file, const VtkArray& array)
      : array_(array),
        fileBytes_(file->size()),
        bytes_(array.base64 ? std::make_unique<Base64Stream>(file, array.offset)
                            : rawStream(std::move(file), array.offset)) {}

  Result<std::size_t> read(std::span<std::byte> to) override {
    if (!begun_) {
      begun_ = true;
      if (auto r = readHeader(); !r) return r.error();
    }
    if (!array_.compressed) {
      const std::size_t n =
          static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), array_.bytes - done_));
      const auto got = bytes_->read(to.first(n));
      if (got) done_ += *got;
      return got;
    }
    std::size_t done = 0;
    while (done < to.size() && done_ < array_.bytes) {
      if (blockAt_ == block_.size())
        if (auto r = nextBlock(); !r) return r.error();
      const std::size_t n = std::min(to.size() - done, block_.size() - blockAt_);
      std::copy_n(block_.begin() + static_cast<std::ptrdiff_t>(blockAt_), n,
                  to.begin() + static_cast<std::ptrdiff_t>(done));
      done += n;
      blockAt_ += n;
      done_ += n;
    }
    return done;
  }

 private:
  Result<std::uint64_t> word() {
    std::array<std::byte, 8> raw{};
    if (auto r = readExactly(*bytes_, std::span(raw).first(array_.wordBytes)); !r) return r.error();
    std::uint64_t x = 0;
    for (std::size_t i = 0; i < array_.wordBytes; ++i)
      x |= std::to_integer<std::uint64_t>(raw[i]) << 8 * (array_.bigEndian ? array_.wordBytes - 1 - i : i);
    return x;
  }

  Result<void> readHeader() {
    const auto first = word();
    if (!first) return first.error();
    if (!array_.compressed) {
      // A header of 32 bits counts modulo 2^32.
      const std::uint64_t mask = array_.wordBytes == 4 ? 0xffffffffu : ~std::uint64_t{0};
      if (*first != (array_.bytes & mask))
        return damaged("it does not have the bytes that its extent asks for");
      return {};
    }
    const auto full = word(), last = word();
    if (!full) return full.error();
    if (!last) return last.error();
    const std::uint64_t blocks = *first;
    if (blocks < 1 || blocks > fileBytes_ / array_.wordBytes || *full < 1 ||
        *full > array_.bytes + (1 << 20) || *last > *full)
      return damaged("the sizes of its blocks cannot be");
    blockBytes_ = *full;
    const std::uint64_t tail = *last == 0 ? *full : *last;
    if (blocks - 1 > array_.bytes / *full || (blocks - 1) * *full + tail != array_.bytes)
      return damaged("its blocks do not add up to the bytes that its extent asks for");
    lastBytes_ = tail;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const auto packed = word();
      if (!packed) return packed.error();
      if (*packed > fileBytes_) return damaged("a block is longer than the file");
      packed_.push_back(*packed);
    }
    return {};
  }

  Result<void> nextBlock() {
    if (next_ >= packed_.size()) return damaged("it has too few blocks");
    std::vector<std::byte> packed(static_cast<std::size_t>(packed_[next_]));
    if (auto r = readExactly(*bytes_, packed); !r) return r;
    ++next_;
    const std::size_t bytes = static_cast<std::size_t>(next_ == packed_.size() ? lastBytes_ : blockBytes_);
    if (bytes > (packed.size() + 16) * 1032) return damaged("a block cannot hold what it says");
    block_.resize(bytes);
    uLongf n = bytes;
    const int state = uncompress(reinterpret_cast<Bytef*>(block_.data()), &n,
                                 reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (state != Z_OK || n != bytes) return damaged("a block cannot be unpacked");
    blockAt_ = 0;
    return {};
  }

  VtkArray array_;
  std::uint64_t fileBytes_;
  std::unique_ptr<ByteStream> bytes_;
  bool begun_ = false;
  std::uint64_t blockBytes_ = 0, lastBytes_ = 0;
  std::vector<std::uint64_t> packed_;  // bytes of each packed block
  std::size_t next_ = 0, blockAt_ = 0;
  std::vector<std::byte> block_;
  std::uint64_t done_ = 0;
};

}  // namespace

std::unique_ptr<ByteStream> vtkStream(InputFilePtr file, const VtkArray& array) {
  return std::make_unique<VtkStream>(std::move(file), array);
}

}  // namespace vernier
