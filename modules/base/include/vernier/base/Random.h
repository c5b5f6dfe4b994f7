// SPDX-License-Identifier: GPL-3.0-or-later
// The one random generator: counter-based (a 64-bit mix of seed and counter), so that draw n is the same
// whatever the thread or order. Stateless and thread-safe.
#pragma once
#include <cstdint>

namespace vernier {

inline std::uint64_t randomBits(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed * 0xD1342543DE82EF95ull + (counter + 1) * 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  z ^= z >> 31;
  z = (z ^ (z >> 33)) * 0xFF51AFD7ED558CCDull;
  return z ^ (z >> 33);
}
// Uniform in [0, 1) with 53 bits.
inline double randomUnit(std::uint64_t seed, std::uint64_t counter) {
  return static_cast<double>(randomBits(seed, counter) >> 11) * 0x1.0p-53;
}

}  // namespace vernier
