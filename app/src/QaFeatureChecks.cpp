// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that find bright things in the picture: where they are, how far apart, how large. In pixel
// coordinates centres lie at half-integers; millimetres are those of the scale bar.
#include <cmath>

#include "Annotations.h"
#include "QaChecks.h"

namespace vernier::app {
namespace {
using Rows = std::vector<QaRow>;
using Json = nlohmann::ordered_json;

struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // the last two are outside
};

std::optional<PixelBox> boxOf(const QaContext& c, const Json& j) {
  if (!j.is_array() || j.size() != 4) return std::nullopt;
  for (const Json& n : j)
    if (!n.is_number_integer()) return std::nullopt;
  const PixelBox b{j[0].get<int>(), j[1].get<int>(), j[2].get<int>(), j[3].get<int>()};
  const bool inside = b.x0 >= 0 && b.y0 >= 0 && b.x1 <= c.picture->width && b.y1 <= c.picture->height;
  return inside && b.x0 < b.x1 && b.y0 < b.y1 ? std::optional(b) : std::nullopt;
}

constexpr const char* kBoxWanted =
    "Four whole numbers of a part of the picture were expected here: from x, from y, to x, to y.";

// Boxes of "in_px": one, or a list of `count`.
std::vector<PixelBox> boxesOf(const QaContext& c, JsonReader& check, std::size_t count) {
  std::vector<PixelBox> boxes;
  const Json* all = check.any("in_px");
  if (!all) return {};
  for (std::size_t n = 0; n < count; ++n) {
    const bool there = count == 1 || (all->is_array() && all->size() == count);
    const auto box = there ? boxOf(c, count == 1 ? *all : (*all)[n]) : std::nullopt;
    if (!box) {
      check.fail(count == 1 ? "in_px" : "in_px/" + std::to_string(n), kBoxWanted);
      return {};
    }
    boxes.push_back(*box);
  }
  return boxes;
}

// Centre of what is brighter than `above`, each pixel weighing as much as it is brighter; nothing: NaN.
glm::dvec2 centroid(const Picture& picture, const PixelBox& box, double above) {
  double weight = 0;
  glm::dvec2 sum(0);
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      const double more = picture.at(x, y)[1] - above;
      if (more <= 0) continue;
      weight += more, sum += more * glm::dvec2(x + 0.5, y + 0.5);
    }
  return weight > 0 ? sum / weight : glm::dvec2(NAN);
}

struct Found {
  std::vector<glm::dvec2> at_px;
  double mmPerPixel = 0;
};

Result<double> mmPerPixelOf(const QaContext& c, JsonReader& check) {
  const Result<Annotations> a = annotationsFor(c.session, c.request->scene, c.request->view, *c.rendered, {});
  if (!a) return a.error();
  if (!(a->mmPerPixel > 0))
    return makeError(ErrorCode::FileDamaged, "The picture has no scale, so nothing has a size in mm.",
                     check.placeOf("kind"));
  return a->mmPerPixel;
}

// What "above" and "in_px" name.
Result<Found> find(const QaContext& c, JsonReader& check, std::size_t count) {
  if (const Result<void> picture = needsPicture(c); !picture) return picture.error();
  const double above = check.number("above", 0, 255).value_or(NAN);
  const std::vector<PixelBox> boxes = boxesOf(c, check, count);
  if (check.fault()) return *check.fault();
  const Result<double> scale = mmPerPixelOf(c, check);
  if (!scale) return scale.error();
  Found found{{}, *scale};
  for (const PixelBox& box : boxes) found.at_px.push_back(centroid(*c.picture, box, above));
  return found;
}

struct Wanted {
  double expected = 0, tolerance = 0;
  std::string why;
};
Wanted wanted(JsonReader& check) {
  return {check.number("expected", 0, 1e9).value_or(NAN), check.number("tolerance", 0, 1e9).value_or(NAN),
          check.text("why", false)};
}

QaRow judged(const std::string& quantity, const std::string& unit, double measured, const Wanted& w) {
  QaRow row = within(quantity, unit, measured, w.expected, w.tolerance, w.why);
  if (std::isnan(measured)) row.measured = "nothing is that bright";
  return row;
}

}  // namespace

// {"kind": "centroid", "above": 128, "in_px": [x0, y0, x1, y1], "expected_px": [x, y], "tolerance": px}
Result<Rows> checkCentroid(const QaContext& c, JsonReader& check) {
  const Result<Found> found = find(c, check, 1);
  if (!found) return found.error();
  const std::vector<double> expected = check.numbers("expected_px", 2);
  const double tolerance = check.number("tolerance", 0, 1024).value_or(NAN);
  const std::string why = check.text("why", false);
  return Rows{judged("centre, x", "px", found->at_px[0].x, {expected[0], tolerance, why}),
              judged("centre, y", "px", found->at_px[0].y, {expected[1], tolerance, why})};
}

// {"kind": "distance", "above": 128, "in_px": [box, box], "expected": mm, "tolerance": mm}: of two centres.
Result<Rows> checkDistance(const QaContext& c, JsonReader& check) {
  const Result<Found> found = find(c, check, 2);
  if (!found) return found.error();
  const double px = glm::distance(found->at_px[0], found->at_px[1]);
  return Rows{judged("distance of two centres", "mm", px * found->mmPerPixel, wanted(check))};
}

// {"kind": "angle", "above": 128, "in_px": [box, box, box], "expected": degrees, "tolerance"}: in the second.
Result<Rows> checkAngle(const QaContext& c, JsonReader& check) {
  const Result<Found> found = find(c, check, 3);
  if (!found) return found.error();
  const glm::dvec2 a = found->at_px[0] - found->at_px[1], b = found->at_px[2] - found->at_px[1];
  const double angle_rad = std::atan2(std::abs(a.x * b.y - a.y * b.x), glm::dot(a, b));
  return Rows{judged("angle of three centres", "deg", glm::degrees(angle_rad), wanted(check))};
}

// {"kind": "area", "above": 128, "in_px": box, "expected": mm2, "tolerance": mm2}: pixels brighter than that.
Result<Rows> checkArea(const QaContext& c, JsonReader& check) {
  if (const Result<void> picture = needsPicture(c); !picture) return picture.error();
  const double above = check.number("above", 0, 255).value_or(NAN);
  const std::vector<PixelBox> boxes = boxesOf(c, check, 1);
  if (check.fault()) return *check.fault();
  const Result<double> scale = mmPerPixelOf(c, check);
  if (!scale) return scale.error();
  std::int64_t count = 0;
  for (int y = boxes[0].y0; y < boxes[0].y1; ++y)
    for (int x = boxes[0].x0; x < boxes[0].x1; ++x) count += c.picture->at(x, y)[1] > above ? 1 : 0;
  return Rows{judged("area", "mm2", static_cast<double>(count) * *scale * *scale, wanted(check))};
}

}  // namespace vernier::app
