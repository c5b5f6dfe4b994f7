// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Annotate.h"

#include <algorithm>
#include <cmath>

#include "Font.h"
#include "Millimetres.h"

namespace vernier {
namespace {

enum class Side { Left, Right };
enum class End { Top, Bottom };

bool overlap(const Box& a, const Box& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

// Places texts one after the other; what was placed stays.
class Placer {
 public:
  Placer(int width, int height, double scale) : width_(width), height_(height) {
    const int side = std::min(width, height);
    const double base = side < 200 ? 11 : side < 400 ? 12 : 14;
    size_ = static_cast<int>(std::lround(base * std::clamp(scale, 1.0, 3.0)));
    letterSize_ = static_cast<int>(std::lround(1.2 * size_));
    margin_ = std::max(4, size_ / 2);
  }

  void letters(const EdgeLetters& l) {
    const auto place = [&](const std::string& text, double fx, double fy) {
      if (text.empty()) return;
      const TextSize s = measureText(text, letterSize_);
      const int x = static_cast<int>(std::lround(margin_ + fx * (width_ - 2 * margin_ - s.width)));
      const int y =
          static_cast<int>(std::lround(margin_ + s.ascent + fy * (height_ - 2 * margin_ - s.ascent)));
      if (!add(laid(text, x, y, letterSize_, Tone::Normal))) layout_.dropped.push_back(text);
    };
    place(l.left, 0, 0.5);
    place(l.right, 1, 0.5);
    place(l.top, 0.5, 0);
    place(l.bottom, 0.5, 1);
  }

  // As many of the lines as there is room for, the first being the most important; in full if that helps by
  // going one row away from the edge, else in their short forms.
  void block(const std::vector<TextLine>& lines, Side side, End end) {
    std::vector<TextLine> usable;
    for (const TextLine& line : lines)
      if (!line.text.empty()) usable.push_back(line);
    for (std::size_t n = usable.size(); n > 0; --n) {
      const std::vector<TextLine> first(usable.begin(), usable.begin() + static_cast<std::ptrdiff_t>(n));
      for (bool shortForms : {false, true})
        for (int row : {0, 1, 2})
          if (tryBlock(first, side, end, row, shortForms)) {
            for (std::size_t k = n; k < usable.size(); ++k) layout_.dropped.push_back(usable[k].text);
            return;
          }
    }
    for (const TextLine& line : usable) layout_.dropped.push_back(line.text);
  }

  void scaleBar(double mmPerPixel) {
    if (!(mmPerPixel > 0) || !std::isfinite(mmPerPixel)) {
      block({{"lengths in px", "px", Tone::Normal}}, Side::Right, End::Bottom);
      return;
    }
    const double length_mm = scaleBarLength_mm(mmPerPixel, 0.25 * width_);
    const int length_px = std::max(1, static_cast<int>(std::lround(length_mm / mmPerPixel)));
    const std::string label = millimetres(length_mm);
    const TextSize s = measureText(label, size_);
    for (int row : {0, 1}) {
      LaidBar bar;
      bar.length_mm = length_mm;
      bar.thickness = std::max(1, size_ / 8);
      bar.tick = size_ / 3;
      bar.x1 = width_ - margin_;
      bar.x0 = bar.x1 - length_px;
      bar.y = height_ - margin_ - bar.thickness - row * lineHeight();
      const int r = outlineReach_px(size_);
      bar.box = {bar.x0 - r, bar.y - bar.tick - r, length_px + 2 * r, bar.tick + bar.thickness + 2 * r};
      const int textX = std::min(bar.x0 + (length_px - s.width) / 2, width_ - margin_ - s.width);
      const LaidText text = laid(label, textX, bar.y - bar.tick - r, size_, Tone::Normal);
      if (!fits(text.box) || !fits(bar.box)) continue;
      taken_.push_back(bar.box);
      layout_.bar = bar;
      // The label belongs to the bar: they may touch.
      taken_.push_back(text.box);
      layout_.texts.push_back(text);
      return;
    }
    layout_.dropped.push_back(label);
  }

  int letter_px() const { return size_; }

  Layout finished() && { return std::move(layout_); }

 private:
  int lineHeight() const { return size_ + size_ / 2; }

  LaidText laid(const std::string& text, int x, int baseline, int size, Tone tone) const {
    const TextSize s = measureText(text, size);
    const int r = outlineReach_px(size);
    return {text, x,    baseline,
            size, tone, {x - r, baseline - s.ascent - r, s.width + 2 * r, s.ascent + s.descent / 2 + 2 * r}};
  }
  bool fits(const Box& b) const {
    if (b.x < 0 || b.y < 0 || b.x + b.width > width_ || b.y + b.height > height_) return false;
    return std::none_of(taken_.begin(), taken_.end(), [&](const Box& t) { return overlap(b, t); });
  }
  bool add(LaidText text) {
    if (!fits(text.box)) return false;
    taken_.push_back(text.box);
    layout_.texts.push_back(std::move(text));
    return true;
  }

  // Lines of one block are a row apart; their outlines may touch each other but nothing else.
  bool tryBlock(const std::vector<TextLine>& lines, Side side, End end, int row, bool shortForms) {
    std::vector<LaidText> placed;
    const int n = static_cast<int>(lines.size());
    for (int k = 0; k < n; ++k) {
      const TextLine& line = lines[static_cast<std::size_t>(k)];
      const TextSize ascent = measureText("H", size_);
      const int baseline = end == End::Top ? margin_ + ascent.ascent + (row + k) * lineHeight()
                                           : height_ - margin_ - (row + n - 1 - k) * lineHeight();
      const auto at = [&](const std::string& text) {
        const int x = side == Side::Left ? margin_ : width_ - margin_ - measureText(text, size_).width;
        return laid(text, x, baseline, size_, line.tone);
      };
      LaidText text = at(line.text);
      if (shortForms && !fits(text.box) && !line.shortText.empty()) text = at(line.shortText);
      if (!fits(text.box)) return false;
      placed.push_back(std::move(text));
    }
    for (LaidText& text : placed) {
      taken_.push_back(text.box);
      layout_.texts.push_back(std::move(text));
    }
    return true;
  }

  int width_, height_, size_ = 0, letterSize_ = 0, margin_ = 0;
  std::vector<Box> taken_;
  Layout layout_;
};

Rgb8 colourOf(Tone tone) { return tone == Tone::Amber ? Rgb8{255, 190, 60} : Rgb8{240, 240, 240}; }

void drawBar(Picture& picture, const LaidBar& bar) {
  const auto lines = [&](int grow, Rgb8 colour) {
    const int t = bar.thickness + 2 * grow;
    fillBox(picture, bar.x0 - grow, bar.y - grow, bar.x1 - bar.x0 + 2 * grow, t, colour);
    for (int x : {bar.x0, bar.x1 - bar.thickness})
      fillBox(picture, x - grow, bar.y - bar.tick - grow, t, bar.tick + 2 * grow, colour);
  };
  lines(1, {});
  lines(0, colourOf(Tone::Normal));
}

}  // namespace

double scaleBarLength_mm(double mmPerPixel, double most_px) {
  const double most_mm = mmPerPixel * most_px * (1 + 1e-9);  // 50 mm in exactly 50 mm of room is taken
  const double decade = std::pow(10.0, std::floor(std::log10(most_mm)));
  for (double step : {5.0, 2.0})
    if (step * decade <= most_mm) return step * decade;
  return decade;
}

Layout layoutAnnotations(const Annotations& a, int width, int height, double scale) {
  Placer placer(width, height, scale);
  placer.letters(a.letters);
  if (a.flipped) placer.block({{"FLIPPED", "", Tone::Amber}}, Side::Right, End::Top);
  placer.block(a.what, Side::Left, End::Top);
  placer.block(a.status, Side::Left, End::Bottom);
  if (a.scaleBar) placer.scaleBar(a.mmPerPixel);
  const int letter_px = placer.letter_px();
  Layout layout = std::move(placer).finished();
  layout.letter_px = letter_px;
  layout.graphics = a.graphics;
  return layout;
}

void drawLayout(Picture& picture, const Layout& layout) {
  drawGraphics(picture, layout.graphics, layout.letter_px);
  for (const LaidText& t : layout.texts) drawOutline(picture, t.x, t.baseline, t.text, t.size_px);
  if (layout.bar) drawBar(picture, *layout.bar);
  for (const LaidText& t : layout.texts)
    drawText(picture, t.x, t.baseline, t.text, t.size_px, colourOf(t.tone));
}

void annotate(Picture& picture, const Annotations& a, double scale) {
  drawLayout(picture, layoutAnnotations(a, picture.width, picture.height, scale));
}

}  // namespace vernier
