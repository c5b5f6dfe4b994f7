// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/gpu/DeviceCache.h"

namespace vernier::gpu {

template <class T>
Result<std::shared_ptr<const T>> DeviceCache::any(const Key& key, const std::function<Result<T>()>& make) {
  if (const auto hit = index_.find(key); hit != index_.end()) {
    entries_.splice(entries_.begin(), entries_, hit->second);
    return std::static_pointer_cast<const T>(entries_.front().thing);
  }
  Result<T> made = make();
  if (!made) return made.error();
  auto thing = std::make_shared<const T>(std::move(*made));
  const std::uint64_t bytes = thing->bytes();
  if (bytes > limit_) return std::shared_ptr<const T>(thing);  // used once, not kept
  trim(limit_ - bytes);
  entries_.push_front({key, thing, bytes});
  index_[key] = entries_.begin();
  bytes_ += bytes;
  return std::shared_ptr<const T>(thing);
}

Result<std::shared_ptr<const Texture>> DeviceCache::get(const Key& key,
                                                        const std::function<Result<Texture>()>& make) {
  return any<Texture>(key, make);
}

Result<std::shared_ptr<const VertexData>> DeviceCache::vertices(
    const Key& key, const std::function<Result<VertexData>()>& make) {
  return any<VertexData>(key, make);
}

void DeviceCache::setLimit(std::uint64_t limit_bytes) {
  limit_ = limit_bytes;
  trim(limit_);
}

void DeviceCache::trim(std::uint64_t toBytes) {
  while (bytes_ > toBytes && !entries_.empty()) {
    bytes_ -= entries_.back().bytes;
    index_.erase(entries_.back().key);
    entries_.pop_back();
  }
}

}  // namespace vernier::gpu
