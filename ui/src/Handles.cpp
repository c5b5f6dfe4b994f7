// SPDX-License-Identifier: GPL-3.0-or-later
#include "Handles.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace vernier::ui {
namespace {

using measure::Spot;

// A line's own coordinates: x along it as a share of its length, y across it in pixels.
struct AlongLine {
  glm::dvec2 a, u;
  AlongLine(glm::dvec2 from, glm::dvec2 to) : a(from), u(to - from) {}
  bool line() const { return glm::dot(u, u) > 0; }
  glm::dvec2 across() const { return glm::dvec2(-u.y, u.x) / glm::length(u); }
  glm::dvec2 of(glm::dvec2 p) const {
    return {glm::dot(p - a, u) / glm::dot(u, u), glm::dot(p - a, across())};
  }
  glm::dvec2 at(glm::dvec2 c) const { return a + c.x * u + c.y * across(); }
};

void moveDiameter(measure::Bidirectional& b, std::size_t n, Spot to, const Place& place,
                  measure::Space space) {
  const auto px = [&](const Spot& s) { return pixelOf(place, space, s); };
  const AlongLine before(px(b.longAxis[0]), px(b.longAxis[1]));
  if (n < 2) {
    b.longAxis[n] = to;
    const AlongLine after(px(b.longAxis[0]), px(b.longAxis[1]));
    if (!before.line() || !after.line()) return;
    for (Spot& s : b.shortAxis) s = spotAt(place, space, after.at(before.of(px(s))));
    return;
  }
  Spot& other = b.shortAxis[3 - n];
  b.shortAxis[n - 2] = to;
  if (before.line()) other = spotAt(place, space, before.at({before.of(px(to)).x, before.of(px(other)).y}));
}

void moveOutline(std::vector<Spot>& outline, std::size_t n, Spot to) {
  const auto size = static_cast<std::ptrdiff_t>(outline.size());
  const Spot way = to - outline[n];
  const std::ptrdiff_t reach =
      size > static_cast<std::ptrdiff_t>(kMostGrips) ? size / static_cast<std::ptrdiff_t>(kMostGrips) : 1;
  for (std::ptrdiff_t k = 1 - reach; k < reach; ++k) {
    const double share =
        0.5 * (1 + std::cos(std::numbers::pi * static_cast<double>(k) / static_cast<double>(reach)));
    outline[static_cast<std::size_t>((static_cast<std::ptrdiff_t>(n) + k + size) % size)] += share * way;
  }
}

}  // namespace

std::vector<std::size_t> gripsOf(const measure::Shape& shape) {
  const std::size_t all = measure::handlesOf(shape).size();
  const bool few = std::holds_alternative<measure::FreehandRegion>(shape) && all > kMostGrips;
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < (few ? kMostGrips : all); ++k) out.push_back(few ? k * all / kMostGrips : k);
  return out;
}

void moveGrip(measure::Shape& shape, std::size_t n, Spot to, const Place& place, measure::Space space) {
  if (auto* b = std::get_if<measure::Bidirectional>(&shape)) return moveDiameter(*b, n, to, place, space);
  if (auto* f = std::get_if<measure::FreehandRegion>(&shape)) return moveOutline(f->outline, n, to);
  measure::setHandle(shape, n, to);
}

glm::dvec2 acrossLongAxis(glm::dvec2 a, glm::dvec2 b, glm::dvec2 third, glm::dvec2 px) {
  const AlongLine line(a, b);
  return line.line() ? third + glm::dot(px - third, line.across()) * line.across() : px;
}

void settleGrips(measure::Shape& shape, const Place& place, measure::Space space) {
  auto* b = std::get_if<measure::Bidirectional>(&shape);
  if (!b) return;
  const auto length = [&](const std::array<Spot, 2>& ends) {
    return glm::length(pixelOf(place, space, ends[1]) - pixelOf(place, space, ends[0]));
  };
  if (length(b->shortAxis) > length(b->longAxis)) std::swap(b->longAxis, b->shortAxis);
}

}  // namespace vernier::ui
