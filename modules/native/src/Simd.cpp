// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/native/Simd.h"

#include <hwy/highway.h>

namespace vernier::native {
namespace {
// SupportedTargets() lists what the processor can, HWY_TARGETS what was compiled. Lower bits are better
// targets.
std::vector<std::int64_t> usable() {
  std::vector<std::int64_t> targets;
  for (std::int64_t bits = hwy::SupportedTargets() & HWY_TARGETS; bits != 0; bits &= bits - 1)
    targets.push_back(bits & -bits);
  return targets;
}
}  // namespace

std::string simdTarget() {
  const auto targets = usable();
  return targets.empty() ? std::string("scalar") : hwy::TargetName(targets.front());
}

std::vector<std::string> simdTargets() {
  std::vector<std::string> names;
  for (const std::int64_t target : usable()) names.emplace_back(hwy::TargetName(target));
  return names;
}

bool useSimdTarget(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  if (name.empty()) return true;
  for (const std::int64_t target : usable()) {
    if (name != hwy::TargetName(target)) continue;
    hwy::SetSupportedTargetsForTest(target);
    return true;
  }
  return false;
}

}  // namespace vernier::native
