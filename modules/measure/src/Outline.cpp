// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/Outline.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vernier::measure {
namespace {

constexpr double kOnEdge = 1e-9;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }
// Twice the signed area of a, b, c.
double side(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { return cross(b - a, c - a); }

struct Edge {
  glm::dvec2 a, b;
  double low() const { return std::min(a.y, b.y); }
  double high() const { return std::max(a.y, b.y); }
};
std::vector<Edge> edgesOf(std::span<const glm::dvec2> o) {
  std::vector<Edge> out;
  for (std::size_t i = 0; i < o.size(); ++i) out.push_back({o[i], o[(i + 1) % o.size()]});
  return out;
}

bool within(glm::dvec2 p, const Edge& e) {
  return p.x >= std::min(e.a.x, e.b.x) && p.x <= std::max(e.a.x, e.b.x) && p.y >= e.low() && p.y <= e.high();
}
bool touch(const Edge& e, const Edge& f) {
  const double a = side(e.a, e.b, f.a), b = side(e.a, e.b, f.b), c = side(f.a, f.b, e.a),
               d = side(f.a, f.b, e.b);
  if (((a > 0 && b < 0) || (a < 0 && b > 0)) && ((c > 0 && d < 0) || (c < 0 && d > 0))) return true;
  return (a == 0 && within(f.a, e)) || (b == 0 && within(f.b, e)) || (c == 0 && within(e.a, f)) ||
         (d == 0 && within(e.b, f));
}

// Pairs of edges whose heights overlap.
template <class Fn>
void forNearPairs(const std::vector<Edge>& edges, Fn&& fn) {
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return edges[i].low() < edges[j].low(); });
  for (std::size_t n = 0; n < order.size(); ++n)
    for (std::size_t m = n + 1; m < order.size() && edges[order[m]].low() <= edges[order[n]].high(); ++m)
      if (!fn(std::min(order[n], order[m]), std::max(order[n], order[m]))) return;
}

double shoelace(std::span<const glm::dvec2> o) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < o.size(); ++i) twice += side(o[0], o[i], o[i + 1]);
  return std::abs(twice) / 2;
}

double xAt(const Edge& e, double y) { return e.a.x + (y - e.a.y) * ((e.b.x - e.a.x) / (e.b.y - e.a.y)); }

// Heights between which no two edges cross.
std::vector<double> strips(const std::vector<Edge>& edges) {
  std::vector<double> ys;
  for (const Edge& e : edges) ys.push_back(e.a.y);
  forNearPairs(edges, [&](std::size_t i, std::size_t j) {
    const glm::dvec2 u = edges[i].b - edges[i].a, v = edges[j].b - edges[j].a;
    const double d = cross(u, v);
    if (d == 0) return true;
    const double t = cross(edges[j].a - edges[i].a, v) / d, s = cross(edges[j].a - edges[i].a, u) / d;
    if (t > 0 && t < 1 && s > 0 && s < 1) ys.push_back(edges[i].a.y + t * u.y);
    return true;
  });
  std::sort(ys.begin(), ys.end());
  ys.erase(std::unique(ys.begin(), ys.end()), ys.end());
  return ys;
}

double evenOddArea(std::span<const glm::dvec2> outline) {
  std::vector<Edge> edges = edgesOf(outline);
  for (Edge& e : edges) e.a -= outline[0], e.b -= outline[0];
  const std::vector<double> ys = strips(edges);
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.low() < f.low(); });
  double area = 0;
  std::vector<double> xs;
  for (std::size_t n = 0; n + 1 < ys.size(); ++n) {
    const double middle = ys[n] + (ys[n + 1] - ys[n]) / 2;
    xs.clear();
    for (const Edge& e : edges) {
      if (e.low() > middle) break;
      if (e.low() < middle && e.high() > middle) xs.push_back(xAt(e, middle));
    }
    std::sort(xs.begin(), xs.end());
    for (std::size_t i = 0; i + 1 < xs.size(); i += 2) area += (xs[i + 1] - xs[i]) * (ys[n + 1] - ys[n]);
  }
  return area;
}

}  // namespace

bool crossesItself(std::span<const glm::dvec2> outline) {
  const std::vector<Edge> edges = edgesOf(outline);
  const std::size_t n = edges.size();
  bool found = false;
  forNearPairs(edges, [&](std::size_t i, std::size_t j) {
    if (j == i + 1 || (i == 0 && j + 1 == n)) {  // neighbours share a corner; folded back they share more
      const Edge &e = j == i + 1 ? edges[i] : edges[j], &f = j == i + 1 ? edges[j] : edges[i];
      found = side(e.a, e.b, f.b) == 0 && glm::dot(e.b - e.a, f.b - f.a) < 0;
    } else {
      found = touch(edges[i], edges[j]);
    }
    return !found;
  });
  return found;
}

double areaOf(std::span<const glm::dvec2> outline) {
  if (outline.size() < 3) return 0;
  return crossesItself(outline) ? evenOddArea(outline) : shoelace(outline);
}

double lengthOf(std::span<const glm::dvec2> outline) {
  double sum = 0;
  for (const Edge& e : edgesOf(outline)) sum += glm::length(e.b - e.a);
  return sum;
}

RowSpans::RowSpans(std::span<const glm::dvec2> outline) : corners_(outline.begin(), outline.end()) {}

std::vector<RowSpans::Span> RowSpans::at(double y) const {
  std::vector<Span> spans;
  std::vector<double> xs;
  for (const double h : {y - kOnEdge, y, y + kOnEdge}) {
    xs.clear();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Edge e{corners_[i], corners_[(i + 1) % corners_.size()]};
      if ((e.a.y <= h) != (e.b.y <= h)) xs.push_back(xAt(e, h));
      // Corners and edges that lie in the row itself.
      if (h == y && std::abs(e.a.y - y) <= kOnEdge)
        spans.push_back(std::abs(e.b.y - y) <= kOnEdge
                            ? Span{std::min(e.a.x, e.b.x) - kOnEdge, std::max(e.a.x, e.b.x) + kOnEdge}
                            : Span{e.a.x - kOnEdge, e.a.x + kOnEdge});
    }
    std::sort(xs.begin(), xs.end());
    for (std::size_t i = 0; i + 1 < xs.size(); i += 2)
      spans.push_back({xs[i] - kOnEdge, xs[i + 1] + kOnEdge});
  }
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) { return a.from < b.from; });
  std::vector<Span> joined;
  for (const Span& s : spans) {
    if (!joined.empty() && s.from <= joined.back().to)
      joined.back().to = std::max(joined.back().to, s.to);
    else
      joined.push_back(s);
  }
  return joined;
}

}  // namespace vernier::measure
