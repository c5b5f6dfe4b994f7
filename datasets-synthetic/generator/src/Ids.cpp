// SPDX-License-Identifier: GPL-3.0-or-later
// UIDs and decimal strings.
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "Plan.h"
#include "vernier/base/Random.h"

namespace vernier::phantoms {

std::string uidOf(const std::string& name, std::uint64_t seed, const std::string& role) {
  std::uint64_t high = 0x56524e5048414e54ull, low = 0x4f4d2d5549443031ull;
  const std::string text = name + '\n' + std::to_string(seed) + '\n' + role;
  for (const char c : text) {
    high = randomBits(high, static_cast<unsigned char>(c));
    low = randomBits(low ^ high, static_cast<unsigned char>(c));
  }
  // The form of a name-based UUID (version and variant bits), as PS3.5 B.2 wants below 2.25.
  high = (high & ~0xF000ull) | 0x5000ull;
  low = (low & ~(3ull << 62)) | (2ull << 62);
  // The 128 bits as a decimal number: long division by ten, 32 bits at a time.
  std::uint32_t limbs[4] = {static_cast<std::uint32_t>(high >> 32), static_cast<std::uint32_t>(high),
                            static_cast<std::uint32_t>(low >> 32), static_cast<std::uint32_t>(low)};
  std::string digits;
  while ((limbs[0] | limbs[1] | limbs[2] | limbs[3]) != 0) {
    std::uint64_t rest = 0;
    for (std::uint32_t& limb : limbs) {
      rest = (rest << 32) | limb;
      limb = static_cast<std::uint32_t>(rest / 10);
      rest %= 10;
    }
    digits.insert(digits.begin(), static_cast<char>('0' + static_cast<int>(rest)));
  }
  return "2.25." + digits;
}

std::string dsOf(double v) {
  if (v == 0.0) return "0";
  char buffer[64];
  auto end = std::to_chars(buffer, buffer + sizeof buffer, v, std::chars_format::fixed).ptr;
  for (int digits = 15; end - buffer > 16 && digits >= 0; --digits)
    end = std::to_chars(buffer, buffer + sizeof buffer, v, std::chars_format::fixed, digits).ptr;
  std::string text(buffer, end);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

double dsRounded(double v) {
  const std::string text = dsOf(v);
  double back = 0;
  std::from_chars(text.data(), text.data() + text.size(), back);
  return back;
}

}  // namespace vernier::phantoms
