// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include "vernier/base/Budget.h"
#include "vernier/base/Cache.h"

namespace vernier {

Revision nextRevision() {
  static std::atomic<Revision> next{1};
  return next++;
}

MemoryBudget::MemoryBudget(std::uint64_t limit_bytes) : limit_(limit_bytes) {}

std::uint64_t MemoryBudget::halfOfFreeBytes() {
  std::ifstream f("/proc/meminfo");
  std::string key, unit;
  std::uint64_t kib = 0;
  while (f >> key >> kib && std::getline(f, unit))
    if (key == "MemAvailable:") return kib * 1024 / 2;
  return std::uint64_t{1} << 30;
}

Result<MemoryBudget::Reservation> MemoryBudget::reserve(std::uint64_t bytes, const std::string& what) {
  std::uint64_t used = used_->load();
  do {
    if (bytes > limit_ || used > limit_ - bytes)
      return makeError(ErrorCode::OutOfMemory,
                       what + " needs " + std::to_string(bytes >> 20) + " MiB, but " +
                           std::to_string(used >> 20) + " of the " + std::to_string(limit_ >> 20) +
                           " MiB budget are in use; close a study or raise VERNIER_MEMORY_MB.");
  } while (!used_->compare_exchange_weak(used, used + bytes));
  Reservation r;
  r.used_ = used_;
  r.bytes_ = bytes;
  return r;
}

MemoryBudget::Reservation::Reservation(Reservation&& o) noexcept
    : used_(std::move(o.used_)), bytes_(std::exchange(o.bytes_, 0)) {}
MemoryBudget::Reservation& MemoryBudget::Reservation::operator=(Reservation&& o) noexcept {
  std::swap(used_, o.used_);
  std::swap(bytes_, o.bytes_);
  return *this;
}
MemoryBudget::Reservation::~Reservation() {
  if (used_) *used_ -= bytes_;
}

DerivedCache::DerivedCache(std::uint64_t limit_bytes) : limit_(limit_bytes) {}

std::shared_ptr<const void> DerivedCache::find(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto it = index_.find(key);
  if (it == index_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, it->second);
  return it->second->value;
}

std::shared_ptr<const void> DerivedCache::insert(const Key& key, std::shared_ptr<const void> value,
                                                 std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  ++made_;
  if (const auto it = index_.find(key); it != index_.end())
    return it->second->value;  // another thread was first
  entries_.push_front({key, value, bytes});
  index_[key] = entries_.begin();
  bytes_ += bytes;
  while (bytes_ > limit_ && entries_.size() > 1) {
    const Entry& last = entries_.back();
    bytes_ -= last.bytes;
    index_.erase(last.key);
    entries_.pop_back();
  }
  return value;
}

std::uint64_t DerivedCache::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

std::uint64_t DerivedCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace vernier
