// SPDX-License-Identifier: GPL-3.0-or-later
// 64-bit arithmetic that says when it overflows: used for every size that a file declares.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <optional>

namespace vernier {

inline std::optional<std::uint64_t> checkedAdd(std::uint64_t a, std::uint64_t b) {
  std::uint64_t r = 0;
  if (__builtin_add_overflow(a, b, &r)) return std::nullopt;
  return r;
}
inline std::optional<std::uint64_t> checkedProduct(std::initializer_list<std::uint64_t> factors) {
  std::uint64_t r = 1;
  for (std::uint64_t f : factors)
    if (__builtin_mul_overflow(r, f, &r)) return std::nullopt;
  return r;
}

}  // namespace vernier
