// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/TransferFunction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vernier {
namespace {

Error invalid(const std::string& where, const std::string& sentence) {
  return makeError(ErrorCode::SceneInvalid, sentence, where);
}

bool within01(double x) { return x >= 0 && x <= 1; }
bool within01(glm::dvec3 c) { return within01(c.x) && within01(c.y) && within01(c.z); }

template <class Point>
Result<void> checkValues(const std::vector<Point>& points, const std::string& name) {
  if (points.empty())
    return invalid("/" + name, "The transfer function has no " + name + "; give it at least one point.");
  if (points.size() > kMostTransferPoints)
    return invalid("/" + name, "The transfer function has " + std::to_string(points.size()) + " " + name +
                                   "; at most " + std::to_string(kMostTransferPoints) + " are taken.");
  for (std::size_t n = 0; n < points.size(); ++n) {
    const std::string where = "/" + name + "/" + std::to_string(n);
    if (!std::isfinite(points[n].value))
      return invalid(where, "The value of a point must be a finite number.");
    if (n > 0 && points[n].value < points[n - 1].value)
      return invalid(where, "The values of the points must ascend.");
    if (n > 1 && points[n].value == points[n - 2].value)
      return invalid(where, "Two points of one value make a step; a third has no meaning.");
  }
  return {};
}

// The segment that holds at `value`: index of its upper point, 0 before the first, size() from the last on.
template <class Point>
std::size_t upperPoint(const std::vector<Point>& points, double value) {
  return static_cast<std::size_t>(std::upper_bound(points.begin(), points.end(), value,
                                                   [](double v, const Point& p) { return v < p.value; }) -
                                  points.begin());
}

template <class Point>
double fraction(const std::vector<Point>& points, std::size_t upper, double value) {
  return (value - points[upper - 1].value) / (points[upper].value - points[upper - 1].value);
}

}  // namespace

Result<void> checkTransferFunction(const TransferFunction& f) {
  if (Result<void> ok = checkValues(f.colours, "colours"); !ok) return ok;
  if (Result<void> ok = checkValues(f.opacities, "opacities"); !ok) return ok;
  for (std::size_t n = 0; n < f.colours.size(); ++n)
    if (!within01(f.colours[n].colour))
      return invalid("/colours/" + std::to_string(n), "The parts of a colour lie between 0 and 1.");
  for (std::size_t n = 0; n < f.opacities.size(); ++n)
    if (!within01(f.opacities[n].opacity))
      return invalid("/opacities/" + std::to_string(n), "An opacity lies between 0 and 1.");
  if (!(f.opacityLength_mm > 0) || !std::isfinite(f.opacityLength_mm))
    return invalid("/opacity_length_mm", "The length that the opacities are of must be a number above 0.");
  return {};
}

glm::dvec3 colourAt(const TransferFunction& f, double value) {
  if (std::isnan(value)) return glm::dvec3(0);
  const std::size_t upper = upperPoint(f.colours, value);
  if (upper == 0) return f.colours.front().colour;
  if (upper == f.colours.size()) return f.colours.back().colour;
  return glm::mix(f.colours[upper - 1].colour, f.colours[upper].colour, fraction(f.colours, upper, value));
}

double opacityAt(const TransferFunction& f, double value) {
  if (std::isnan(value)) return 0;
  const std::size_t upper = upperPoint(f.opacities, value);
  if (upper == 0) return f.opacities.front().opacity;
  if (upper == f.opacities.size()) return f.opacities.back().opacity;
  return std::lerp(f.opacities[upper - 1].opacity, f.opacities[upper].opacity,
                   fraction(f.opacities, upper, value));
}

double extinctionAt_perMm(const TransferFunction& f, double value) {
  return -std::log1p(-opacityAt(f, value)) / f.opacityLength_mm;
}

double opacityOver(double opacity, double lengths) {
  if (!(lengths > 0)) return 0;
  return opacity >= 1 ? 1 : -std::expm1(lengths * std::log1p(-opacity));
}

double opacityOverLinear(double opacity, double lengths) { return std::clamp(opacity * lengths, 0.0, 1.0); }

double greatestOpacity(const TransferFunction& f, double least, double greatest) {
  if (!(least <= greatest)) return 0;
  double most = std::max(opacityAt(f, least), opacityAt(f, greatest));
  const auto begin = std::lower_bound(f.opacities.begin(), f.opacities.end(), least,
                                      [](const OpacityPoint& p, double v) { return p.value < v; });
  for (auto p = begin; p != f.opacities.end() && p->value <= greatest; ++p) most = std::max(most, p->opacity);
  return most;
}

std::vector<double> knotsOf(const TransferFunction& f) {
  std::vector<double> knots;
  for (const ColourPoint& p : f.colours) knots.push_back(p.value);
  for (const OpacityPoint& p : f.opacities) knots.push_back(p.value);
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  return knots;
}

}  // namespace vernier
