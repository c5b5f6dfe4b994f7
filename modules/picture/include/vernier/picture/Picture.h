// SPDX-License-Identifier: GPL-3.0-or-later
// Picture: 8-bit pixels as people see and store them, RGB or RGBA interleaved, row 0 on top, no padding.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vernier {

struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

struct Picture {
  int width = 0, height = 0;
  int channels = 3;  // 3 or 4
  std::vector<std::uint8_t> pixels;

  Picture() = default;
  Picture(int w, int h, Rgb8 colour = {}) : width(w), height(h) {
    pixels.resize(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    for (std::size_t i = 0; i < pixels.size(); i += 3)
      pixels[i] = colour.r, pixels[i + 1] = colour.g, pixels[i + 2] = colour.b;
  }
  std::uint8_t* at(int x, int y) { return pixels.data() + offset(x, y); }
  const std::uint8_t* at(int x, int y) const { return pixels.data() + offset(x, y); }
  friend bool operator==(const Picture&, const Picture&) = default;

 private:
  std::size_t offset(int x, int y) const {
    return static_cast<std::size_t>(channels) *
           (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

}  // namespace vernier
