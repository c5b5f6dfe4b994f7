// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/mman.h>

#include <cstring>
#include <string>
#include <utility>

#include "vernier/base/Checked.h"
#include "vernier/volume/Volume.h"

namespace vernier {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kHugePage = std::size_t{2} << 20;

std::size_t roundUp(std::size_t n, std::size_t unit) { return (n + unit - 1) / unit * unit; }

Error outOfMemory(std::size_t bytes) {
  return makeError(ErrorCode::OutOfMemory,
                   "The system gave no " + std::to_string(bytes >> 20) +
                       " MiB for voxels; close other volumes or programs and try again.");
}

}  // namespace

Result<Buffer> Buffer::make(std::size_t bytes) {
  if (!checkedAdd(bytes, kSlack + 2 * kHugePage)) return outOfMemory(bytes);
  const bool huge = bytes >= kHugePage;
  const std::size_t length = roundUp(bytes + kSlack, huge ? kHugePage : kPage);
  // A huge page must begin at a multiple of its size: map one more than needed and give back the two ends.
  const std::size_t asked = huge ? length + kHugePage : length;
  void* const mapped = mmap(nullptr, asked, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) return outOfMemory(bytes);
  std::byte* begin = static_cast<std::byte*>(mapped);
  if (huge) {
    const std::size_t address = reinterpret_cast<std::size_t>(mapped);
    const std::size_t head = roundUp(address, kHugePage) - address;
    const std::size_t tail = asked - head - length;
    if (head > 0) munmap(begin, head);
    begin += head;
    if (tail > 0) munmap(begin + length, tail);
    madvise(begin, length, MADV_HUGEPAGE);  // a wish: without huge pages it is only slower
  }
  Buffer b;
  b.data_ = begin;
  b.size_ = bytes;
  b.mapped_ = length;
  return b;
}

void Buffer::shrink(std::size_t bytes) {
  VERNIER_ASSERT(bytes <= size_);
  const std::size_t needed = roundUp(bytes + kSlack, kPage);
  size_ = bytes;
  if (needed >= mapped_) return;
  munmap(data_ + needed, mapped_ - needed);
  mapped_ = needed;
}

Buffer::Buffer(Buffer&& o) noexcept
    : data_(std::exchange(o.data_, nullptr)),
      size_(std::exchange(o.size_, 0)),
      mapped_(std::exchange(o.mapped_, 0)) {}

Buffer& Buffer::operator=(Buffer&& o) noexcept {
  std::swap(data_, o.data_);
  std::swap(size_, o.size_);
  std::swap(mapped_, o.mapped_);
  return *this;
}

Buffer::~Buffer() {
  if (data_) munmap(data_, mapped_);
}

}  // namespace vernier
