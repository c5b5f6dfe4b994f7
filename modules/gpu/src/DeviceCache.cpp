// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/gpu/DeviceCache.h"

namespace vernier::gpu {

Result<std::shared_ptr<const Texture>> DeviceCache::get(const Key& key,
                                                        const std::function<Result<Texture>()>& make) {
  if (const auto hit = index_.find(key); hit != index_.end()) {
    entries_.splice(entries_.begin(), entries_, hit->second);
    return entries_.front().texture;
  }
  Result<Texture> made = make();
  if (!made) return made.error();
  auto texture = std::make_shared<const Texture>(std::move(*made));
  if (texture->bytes() > limit_) return std::shared_ptr<const Texture>(texture);  // used once, not kept
  trim(limit_ - texture->bytes());
  entries_.push_front({key, texture});
  index_[key] = entries_.begin();
  bytes_ += texture->bytes();
  return std::shared_ptr<const Texture>(texture);
}

void DeviceCache::setLimit(std::uint64_t limit_bytes) {
  limit_ = limit_bytes;
  trim(limit_);
}

void DeviceCache::trim(std::uint64_t toBytes) {
  while (bytes_ > toBytes && !entries_.empty()) {
    bytes_ -= entries_.back().texture->bytes();
    index_.erase(entries_.back().key);
    entries_.pop_back();
  }
}

}  // namespace vernier::gpu
