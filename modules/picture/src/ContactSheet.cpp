// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/ContactSheet.h"

#include <algorithm>
#include <cmath>

#include "Font.h"
#include "vernier/base/Threads.h"
#include "vernier/picture/Png.h"

namespace vernier {
namespace {

constexpr int kGap = 16, kTitleSize = 22, kCaptionSize = 16, kLineSize = 14, kLeading = 6;
constexpr Rgb8 kPaper{32, 33, 36}, kFrame{70, 72, 78}, kInk{240, 240, 240}, kFaintInk{190, 192, 198};

// Weights of the old pixels under one new pixel along one axis.
struct Span {
  int first = 0;
  std::vector<double> weights;  // sum to 1
};
std::vector<Span> spansOf(int from, int to) {
  std::vector<Span> spans(static_cast<std::size_t>(to));
  const double step = static_cast<double>(from) / to;
  for (int k = 0; k < to; ++k) {
    const double begin = k * step, end = std::min<double>((k + 1) * step, from);
    Span& s = spans[static_cast<std::size_t>(k)];
    s.first = static_cast<int>(begin);
    for (int p = s.first; p < from && p < end; ++p)
      s.weights.push_back((std::min<double>(end, p + 1) - std::max<double>(begin, p)) / (end - begin));
  }
  return spans;
}

void paste(Picture& sheet, const Picture& picture, int x, int y) {
  for (int row = 0; row < picture.height; ++row)
    std::copy_n(picture.at(0, row), 3 * static_cast<std::size_t>(picture.width), sheet.at(x, y + row));
}

// The text, or as much of it as fits, ending in an ellipsis.
std::string cut(std::string text, int size_px, int width) {
  if (measureText(text, size_px).width <= width) return text;
  while (!text.empty() && measureText(text + "\xE2\x80\xA6", size_px).width > width) {
    do text.pop_back();
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80);
    // A lead byte without its followers would show as a fault.
    if (!text.empty() && static_cast<unsigned char>(text.back()) >= 0xC0) text.pop_back();
  }
  return text + "\xE2\x80\xA6";
}

}  // namespace

Picture shrunk(const Picture& picture, int width, int height) {
  const double factor = std::min(
      {1.0, static_cast<double>(width) / picture.width, static_cast<double>(height) / picture.height});
  if (factor >= 1) return picture;
  Picture out(std::max(1, static_cast<int>(std::floor(picture.width * factor + 1e-9))),
              std::max(1, static_cast<int>(std::floor(picture.height * factor + 1e-9))));
  const std::vector<Span> columns = spansOf(picture.width, out.width),
                          rows = spansOf(picture.height, out.height);
  const auto shrinkRow = [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      const Span &c = columns[static_cast<std::size_t>(x)], &r = rows[static_cast<std::size_t>(y)];
      double sum[3] = {0, 0, 0};
      for (std::size_t j = 0; j < r.weights.size(); ++j)
        for (std::size_t i = 0; i < c.weights.size(); ++i) {
          const std::uint8_t* p = picture.at(c.first + static_cast<int>(i), r.first + static_cast<int>(j));
          for (int k = 0; k < 3; ++k) sum[k] += r.weights[j] * c.weights[i] * p[k];
        }
      for (int k = 0; k < 3; ++k)
        out.at(x, y)[k] = static_cast<std::uint8_t>(std::lround(std::clamp(sum[k], 0.0, 255.0)));
    }
  };
  parallelFor(static_cast<std::size_t>(out.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) shrinkRow(static_cast<int>(y));
  });
  return out;
}

Result<Picture> contactSheet(const std::string& title, const std::vector<SheetEntry>& entries, int columns,
                             int cell_px) {
  if (entries.empty() || columns < 1 || cell_px < 16)
    return makeError(ErrorCode::OptionInvalid,
                     "A contact sheet needs at least one picture, one column and cells of 16 pixels.");
  std::size_t mostLines = 0;
  for (const SheetEntry& e : entries) {
    if (e.picture.channels != 3 || e.picture.width < 1 || e.picture.height < 1)
      return makeError(ErrorCode::OptionInvalid, "A contact sheet takes RGB pictures only.", e.caption);
    mostLines = std::max(mostLines, e.lines.size());
  }
  const int count = static_cast<int>(entries.size());
  columns = std::min(columns, count);
  const int rows = (count + columns - 1) / columns;
  const int textHeight = kCaptionSize + kLeading + static_cast<int>(mostLines) * (kLineSize + kLeading);
  const std::int64_t cellHeight = cell_px + kLeading + textHeight;
  const int top = kGap + (title.empty() ? 0 : kTitleSize + kGap);
  const std::int64_t width = kGap + static_cast<std::int64_t>(columns) * (cell_px + kGap);
  const std::int64_t height = top + rows * (cellHeight + kGap);
  if (width > kMaxPictureSide || height > kMaxPictureSide ||
      static_cast<std::uint64_t>(width * height) > kMaxPicturePixels)
    return makeError(ErrorCode::LimitExceeded, "The contact sheet would have " + std::to_string(width) +
                                                   " x " + std::to_string(height) +
                                                   " pixels; use smaller cells.");
  Picture sheet(static_cast<int>(width), static_cast<int>(height), kPaper);
  if (!title.empty())
    drawText(sheet, kGap, kGap + kTitleSize - 4, cut(title, kTitleSize, static_cast<int>(width) - 2 * kGap),
             kTitleSize, kInk);
  for (int n = 0; n < count; ++n) {
    const SheetEntry& e = entries[static_cast<std::size_t>(n)];
    const int x = kGap + (n % columns) * (cell_px + kGap);
    const int y = top + (n / columns) * (static_cast<int>(cellHeight) + kGap);
    fillBox(sheet, x - 1, y - 1, cell_px + 2, cell_px + 2, kFrame);
    fillBox(sheet, x, y, cell_px, cell_px, {});
    const Picture small = shrunk(e.picture, cell_px, cell_px);
    paste(sheet, small, x + (cell_px - small.width) / 2, y + (cell_px - small.height) / 2);
    int baseline = y + cell_px + kLeading + kCaptionSize;
    drawText(sheet, x, baseline, cut(e.caption, kCaptionSize, cell_px), kCaptionSize, kInk);
    for (const std::string& line : e.lines) {
      baseline += kLineSize + kLeading;
      drawText(sheet, x, baseline, cut(line, kLineSize, cell_px), kLineSize, kFaintInk);
    }
  }
  return sheet;
}

}  // namespace vernier
