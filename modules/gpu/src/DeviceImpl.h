// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of Device share.
#pragma once
#include <map>

#include "GlCore.h"
#include "vernier/gpu/Device.h"

namespace vernier::gpu {

inline constexpr int kMaxUnits = 16;  // texture units that a draw may use; every GL 3.3 has as many

struct Device::Impl {
  explicit Impl(std::uint64_t cacheLimit_bytes) : cache(cacheLimit_bytes) {}
  std::shared_ptr<Core> core;
  Limits limits;
  Counters counters;
  DeviceCache cache;
  std::map<std::string, std::shared_ptr<const Program>> programs;
  unsigned samplers[2][2] = {};  // [Filter][Wrap]
  unsigned fragmentQuery = 0;
};

}  // namespace vernier::gpu
