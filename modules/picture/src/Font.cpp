// SPDX-License-Identifier: GPL-3.0-or-later
#include "Font.h"

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier {

// Made at build time from DejaVuSans.ttf (EmbedFont.cmake).
extern const unsigned char kFontFile[];

namespace {

const stbtt_fontinfo& font() {
  static const stbtt_fontinfo info = [] {
    stbtt_fontinfo f;
    VERNIER_ASSERT(stbtt_InitFont(&f, kFontFile, 0) != 0);
    return f;
  }();
  return info;
}

// The next code point; a malformed byte counts as U+FFFD.
int nextCodePoint(std::string_view& s) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const unsigned char lead = byte(0);
  int length = lead < 0x80 ? 1 : (lead >> 5) == 6 ? 2 : (lead >> 4) == 14 ? 3 : (lead >> 3) == 30 ? 4 : 0;
  int code = length == 1 ? lead : length == 0 ? 0xFFFD : lead & (0xFF >> (length + 1));
  if (static_cast<std::size_t>(length) > s.size()) length = 0, code = 0xFFFD;
  for (int k = 1; k < length; ++k) {
    if ((byte(static_cast<std::size_t>(k)) & 0xC0) != 0x80) {
      length = 0, code = 0xFFFD;
      break;
    }
    code = (code << 6) | (byte(static_cast<std::size_t>(k)) & 0x3F);
  }
  s.remove_prefix(static_cast<std::size_t>(std::max(length, 1)));
  return code;
}

template <class Fn>
void forEachGlyph(std::string_view text, float scale, Fn&& fn) {
  int x = 0;
  while (!text.empty()) {
    const int code = nextCodePoint(text);
    if (code < 0x20 || code == 0x7F) continue;
    const int glyph = stbtt_FindGlyphIndex(&font(), code);
    int advance = 0, bearing = 0;
    stbtt_GetGlyphHMetrics(&font(), glyph, &advance, &bearing);
    fn(glyph, x);
    x += static_cast<int>(std::lround(static_cast<double>(advance) * static_cast<double>(scale)));
  }
  fn(-1, x);  // the end
}

float scaleFor(int size_px) { return stbtt_ScaleForMappingEmToPixels(&font(), static_cast<float>(size_px)); }

double reach(int size_px) { return std::max(1.5, size_px / 9.0); }

// Coverage 0..1 of a text, with a border for the outline.
struct Mask {
  int x0 = 0, y0 = 0, width = 0, height = 0;  // relative to the start of the baseline
  std::vector<float> coverage;
  float at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return 0;
    return coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)];
  }
};

Mask maskOf(std::string_view text, int size_px) {
  const float scale = scaleFor(size_px);
  const TextSize size = measureText(text, size_px);
  const int border = 2 * outlineReach_px(size_px) + size_px / 2;  // glyphs may lean out of their advance
  Mask m{
      -border, -size.ascent - border, size.width + 2 * border, size.ascent + size.descent + 2 * border, {}};
  m.coverage.assign(static_cast<std::size_t>(m.width) * static_cast<std::size_t>(m.height), 0);
  std::vector<unsigned char> bitmap;
  forEachGlyph(text, scale, [&](int glyph, int x) {
    if (glyph < 0) return;
    int gx0, gy0, gx1, gy1;
    stbtt_GetGlyphBitmapBox(&font(), glyph, scale, scale, &gx0, &gy0, &gx1, &gy1);
    const int w = gx1 - gx0, h = gy1 - gy0;
    if (w <= 0 || h <= 0) return;
    bitmap.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0);
    stbtt_MakeGlyphBitmap(&font(), bitmap.data(), w, h, w, scale, scale, glyph);
    for (int y = 0; y < h; ++y)
      for (int k = 0; k < w; ++k) {
        const int tx = x + gx0 + k - m.x0, ty = gy0 + y - m.y0;
        if (tx < 0 || ty < 0 || tx >= m.width || ty >= m.height) continue;
        float& c = m.coverage[static_cast<std::size_t>(ty) * static_cast<std::size_t>(m.width) +
                              static_cast<std::size_t>(tx)];
        c = std::max(c, static_cast<float>(bitmap[static_cast<std::size_t>(y) * static_cast<std::size_t>(w) +
                                                  static_cast<std::size_t>(k)]) /
                            255.0f);
      }
  });
  return m;
}

// How dark the surroundings become: solid within the outline's reach, then fading over as much again.
Mask shadowOf(const Mask& m, int size_px) {
  const double solid = reach(size_px);
  const int n = static_cast<int>(std::ceil(2 * solid));
  Mask shadow = m;
  std::fill(shadow.coverage.begin(), shadow.coverage.end(), 0.0f);
  std::vector<float> stamp;
  for (int dy = -n; dy <= n; ++dy)
    for (int dx = -n; dx <= n; ++dx) {
      const double away = std::sqrt(static_cast<double>(dx * dx + dy * dy)) - solid;
      stamp.push_back(static_cast<float>(std::clamp(1 - away / solid, 0.0, 1.0)));
    }
  for (int y = 0; y < m.height; ++y)
    for (int x = 0; x < m.width; ++x) {
      const float c = m.at(x, y);
      if (c < 0.25f) continue;  // faint edges cast no shadow
      for (int dy = -n, k = 0; dy <= n; ++dy)
        for (int dx = -n; dx <= n; ++dx, ++k) {
          const int tx = x + dx, ty = y + dy;
          if (tx < 0 || ty < 0 || tx >= m.width || ty >= m.height) continue;
          float& s = shadow.coverage[static_cast<std::size_t>(ty) * static_cast<std::size_t>(m.width) +
                                     static_cast<std::size_t>(tx)];
          s = std::max(s, stamp[static_cast<std::size_t>(k)] * c);
        }
    }
  return shadow;
}

void blend(std::uint8_t* pixel, Rgb8 colour, float alpha) {
  const std::uint8_t c[3] = {colour.r, colour.g, colour.b};
  for (int k = 0; k < 3; ++k)
    pixel[k] = static_cast<std::uint8_t>(std::floor(pixel[k] * (1.0f - alpha) + c[k] * alpha + 0.5f));
}

void blendMask(Picture& picture, int x, int baseline, const Mask& m, Rgb8 colour, float strength) {
  for (int my = 0; my < m.height; ++my)
    for (int mx = 0; mx < m.width; ++mx) {
      const int px = x + m.x0 + mx, py = baseline + m.y0 + my;
      if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
      if (const float c = m.at(mx, my); c > 0) blend(picture.at(px, py), colour, strength * c);
    }
}

}  // namespace

int outlineReach_px(int size_px) { return static_cast<int>(std::ceil(reach(size_px))); }

TextSize measureText(std::string_view utf8, int size_px) {
  const float scale = scaleFor(size_px);
  int ascent = 0, descent = 0, gap = 0;
  stbtt_GetFontVMetrics(&font(), &ascent, &descent, &gap);
  TextSize size;
  // DejaVu's own ascent leaves room for stacked accents; capitals and digits need 0.76 em.
  size.ascent = static_cast<int>(std::ceil(0.78 * size_px));
  size.descent = static_cast<int>(std::ceil(-descent * scale));
  forEachGlyph(utf8, scale, [&](int, int x) { size.width = x; });
  return size;
}

void drawOutline(Picture& picture, int x, int baseline, std::string_view utf8, int size_px) {
  blendMask(picture, x, baseline, shadowOf(maskOf(utf8, size_px), size_px), {}, 0.9f);
}

void drawText(Picture& picture, int x, int baseline, std::string_view utf8, int size_px, Rgb8 colour) {
  blendMask(picture, x, baseline, maskOf(utf8, size_px), colour, 1.0f);
}

void fillBox(Picture& picture, int x, int y, int width, int height, Rgb8 colour) {
  for (int py = std::max(y, 0); py < std::min(y + height, picture.height); ++py)
    for (int px = std::max(x, 0); px < std::min(x + width, picture.width); ++px)
      blend(picture.at(px, py), colour, 1);
}

}  // namespace vernier
