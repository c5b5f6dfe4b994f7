// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/picture/Graphics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "Font.h"

namespace vernier {
namespace {

constexpr std::size_t kMostPoints = 100'000, kMostTextLines = 1'000, kLongestLine = 500;
constexpr double kFar_px = 1e6;  // coordinates beyond are a fault of the file

// From the units of a graphic to the picture.
struct Place {
  const ImagePicture& picture;
  glm::dvec2 areaLeast{0}, areaGreatest{0};  // of the displayed area, in picture coordinates

  glm::dvec2 operator()(glm::dvec2 p, GraphicUnits units) const {
    if (units == GraphicUnits::Display) return areaLeast + p * (areaGreatest - areaLeast);
    return pictureFromFrame(picture, p - 0.5);  // the first pixel's corner is 0\0
  }
};

Place placeOf(const FramePresentation& f, const ImagePicture& picture, const ImageFrameInfo& info) {
  glm::dvec2 least(-0.5),
      greatest(static_cast<double>(info.columns) - 0.5, static_cast<double>(info.rows) - 0.5);
  if (f.area) {
    least = glm::min(f.area->topLeft, f.area->bottomRight) - 1.5;
    greatest = glm::max(f.area->topLeft, f.area->bottomRight) - 0.5;
  }
  const glm::dvec2 a = pictureFromFrame(picture, least), b = pictureFromFrame(picture, greatest);
  return {picture, glm::min(a, b), glm::max(a, b)};
}

bool near(glm::dvec2 p) { return std::abs(p.x) < kFar_px && std::abs(p.y) < kFar_px; }

std::vector<glm::dvec2> ellipse(glm::dvec2 centre, glm::dvec2 u, glm::dvec2 v) {
  const double reach = std::max(glm::length(u), glm::length(v));
  const int n = static_cast<int>(std::clamp(4 * std::sqrt(reach), 16.0, 2000.0));
  std::vector<glm::dvec2> out;
  for (int k = 0; k <= n; ++k) {
    const double a = 2 * std::numbers::pi * k / n;
    out.push_back(centre + std::cos(a) * u + std::sin(a) * v);
  }
  return out;
}

// Through all points, by Catmull and Rom's splines.
std::vector<glm::dvec2> curve(const std::vector<glm::dvec2>& p) {
  std::vector<glm::dvec2> out{p.front()};
  for (std::size_t n = 0; n + 1 < p.size(); ++n) {
    const glm::dvec2 a = p[n == 0 ? 0 : n - 1], b = p[n], c = p[n + 1], d = p[std::min(n + 2, p.size() - 1)];
    const int steps = static_cast<int>(std::clamp(glm::length(c - b) / 3, 1.0, 200.0));
    for (int k = 1; k <= steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      out.push_back(0.5 * (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) +
                           t * t * t * (3.0 * b - a - 3.0 * c + d)));
    }
  }
  return out;
}

void addGraphic(const Graphic& g, double grey, const Place& place, std::size_t& points, Graphics& out) {
  std::vector<glm::dvec2> p;
  for (const glm::dvec2& q : g.points) p.push_back(place(q, g.units));
  points += p.size();
  if (points > kMostPoints || !std::all_of(p.begin(), p.end(), near)) return;
  switch (g.shape) {
    case GraphicShape::Point:
      for (const glm::dvec2 arm : {glm::dvec2(4, 0), glm::dvec2(0, 4)})
        out.lines.push_back({{p[0] - arm, p[0] + arm}, false, grey});
      return;
    case GraphicShape::Circle: {  // its centre and a point on it; a circle of the image, not of the screen
      const glm::dvec2 centre = g.points[0], r = g.points[1] - centre;
      const double radius = glm::length(r);
      p = ellipse(p[0], place(centre + glm::dvec2(radius, 0), g.units) - p[0],
                  place(centre + glm::dvec2(0, radius), g.units) - p[0]);
      break;
    }
    case GraphicShape::Ellipse:  // the ends of its major and of its minor axis
      p = ellipse(0.5 * (p[0] + p[1]), 0.5 * (p[1] - p[0]), 0.5 * (p[3] - p[2]));
      break;
    case GraphicShape::Interpolated:
      p = curve(p);
      break;
    case GraphicShape::Polyline:
      break;
  }
  out.lines.push_back({std::move(p), g.filled, grey});
}

void addText(const GraphicText& t, double grey, const Place& place, Graphics& out) {
  DrawnText text{t.text, {}, false, grey};
  std::optional<glm::dvec2> anchor;
  if (t.anchor) anchor = place(*t.anchor, t.anchorUnits);
  if (t.boxTopLeft && t.boxBottomRight) {
    const glm::dvec2 a = place(*t.boxTopLeft, t.boxUnits), b = place(*t.boxBottomRight, t.boxUnits);
    text.corner_px = glm::min(a, b);
    if (anchor && t.anchorVisible && near(*anchor) && near(a) && near(b))
      out.lines.push_back({{*anchor, glm::clamp(*anchor, glm::min(a, b), glm::max(a, b))}, false, grey});
  } else if (anchor) {
    text.corner_px = *anchor;
    text.atAnchor = true;
  } else {
    return;
  }
  if (near(text.corner_px)) out.texts.push_back(std::move(text));
}

// Calls fn(line, x, baseline) for each line of a text.
template <class Fn>
void eachLine(const DrawnText& t, int letter_px, Fn&& fn) {
  glm::dvec2 corner = t.corner_px;
  if (t.atAnchor) corner += glm::dvec2(0.5, -0.5) * static_cast<double>(letter_px);
  const int ascent = measureText("H", letter_px).ascent;
  std::size_t lines = 0;
  for (std::size_t begin = 0; begin <= t.text.size() && lines < kMostTextLines; ++lines) {
    const std::size_t end = std::min(t.text.find('\n', begin), t.text.size());
    fn(t.text.substr(begin, std::min(end - begin, kLongestLine)), static_cast<int>(std::lround(corner.x)),
       static_cast<int>(std::lround(corner.y)) + ascent);
    corner.y += 1.35 * letter_px;
    begin = end + 1;
  }
}

// Coverage of a line `width` pixels wide, in the part of the picture that it meets.
void drawSegment(Picture& picture, glm::dvec2 a, glm::dvec2 b, double width, std::uint8_t grey) {
  const double reach = 0.5 * width + 1;
  const auto range = [&](double p, double q, int size) {
    return std::pair{
        static_cast<int>(std::clamp(std::floor(std::min(p, q) - reach), 0.0, static_cast<double>(size))),
        static_cast<int>(std::clamp(std::ceil(std::max(p, q) + reach), 0.0, static_cast<double>(size)))};
  };
  const auto [y0, y1] = range(a.y, b.y, picture.height);
  const glm::dvec2 ab = b - a;
  const double l2 = glm::dot(ab, ab);
  for (int y = y0; y < y1; ++y) {
    // Where the line passes this row, with its width: the rest of a long line's box is never looked at.
    glm::dvec2 ends(a.x, b.x);
    if (std::abs(ab.y) > 1e-12) {
      const double t0 = std::clamp((y - reach - a.y) / ab.y, 0.0, 1.0);
      const double t1 = std::clamp((y + 1 + reach - a.y) / ab.y, 0.0, 1.0);
      ends = {a.x + t0 * ab.x, a.x + t1 * ab.x};
    }
    const auto [x0, x1] = range(ends.x, ends.y, picture.width);
    for (int x = x0; x < x1; ++x) {
      const glm::dvec2 p(x + 0.5, y + 0.5), ap = p - a;
      const double t = l2 > 0 ? std::clamp(glm::dot(ap, ab) / l2, 0.0, 1.0) : 0;
      const double cover = std::clamp(0.5 * width + 0.5 - glm::length(ap - t * ab), 0.0, 1.0);
      if (cover <= 0) continue;
      std::uint8_t* const pixel = picture.at(x, y);
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(std::floor(pixel[c] * (1 - cover) + grey * cover + 0.5));
    }
  }
}

void fillArea(Picture& picture, const std::vector<glm::dvec2>& p, std::uint8_t grey) {
  for (int y = 0; y < picture.height; ++y) {
    std::vector<double> crossings;
    const double at = y + 0.5;
    for (std::size_t n = 0; n < p.size(); ++n) {
      const glm::dvec2 a = p[n], b = p[(n + 1) % p.size()];
      if ((a.y > at) != (b.y > at)) crossings.push_back(a.x + (at - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t n = 0; n + 1 < crossings.size(); n += 2) {
      const double w = picture.width;
      const int from = static_cast<int>(std::clamp(std::ceil(crossings[n] - 0.5), 0.0, w));
      const int to = static_cast<int>(std::clamp(std::floor(crossings[n + 1] - 0.5) + 1, 0.0, w));
      for (int x = from; x < to; ++x) std::fill_n(picture.at(x, y), 3, grey);
    }
  }
}

std::uint8_t level(double grey) {
  return static_cast<std::uint8_t>(std::floor(255 * std::clamp(grey, 0.0, 1.0) + 0.5));
}

}  // namespace

Graphics graphicsOf(const FramePresentation& f, const ImagePicture& picture, const ImageFrameInfo& info) {
  Graphics out;
  const Place place = placeOf(f, picture, info);
  std::size_t points = 0;
  for (const GraphicAnnotation& a : f.annotations) {
    for (const Graphic& g : a.graphics) addGraphic(g, a.grey, place, points, out);
    for (const GraphicText& t : a.texts) addText(t, a.grey, place, out);
  }
  return out;
}

void drawGraphics(Picture& picture, const Graphics& graphics, int letter_px) {
  const double width = std::max(1.0, letter_px / 12.0);
  const auto segments = [&](const DrawnLine& line, double w, std::uint8_t grey) {
    for (std::size_t n = 0; n + 1 < line.points_px.size(); ++n)
      drawSegment(picture, line.points_px[n], line.points_px[n + 1], w, grey);
    if (line.filled && line.points_px.size() > 2)
      drawSegment(picture, line.points_px.back(), line.points_px.front(), w, grey);
  };
  for (const DrawnLine& line : graphics.lines) {
    // Light lines stand on a dark edge and dark ones on a light edge, so that both are seen on any image.
    segments(line, width + 2, line.grey >= 0.5 ? 0 : 255);
    if (line.filled) fillArea(picture, line.points_px, level(line.grey));
    segments(line, width, level(line.grey));
  }
  for (const DrawnText& t : graphics.texts)
    eachLine(t, letter_px,
             [&](const std::string& line, int x, int y) { drawOutline(picture, x, y, line, letter_px); });
  for (const DrawnText& t : graphics.texts) {
    const std::uint8_t v = std::max<std::uint8_t>(level(t.grey), 160);  // the outline is dark
    eachLine(t, letter_px, [&](const std::string& line, int x, int y) {
      drawText(picture, x, y, line, letter_px, {v, v, v});
    });
  }
}

}  // namespace vernier
