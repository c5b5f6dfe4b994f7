// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that look at the picture, at what it was drawn from, and at what stands on it.
#include <cmath>

#include "Annotations.h"
#include "QaChecks.h"

namespace vernier::app {
namespace {
using Rows = std::vector<QaRow>;
using Json = nlohmann::ordered_json;

std::string at(int x, int y) { return " at " + std::to_string(x) + "," + std::to_string(y) + " px"; }

// The pixel of "at_px": [x, y].
Result<glm::ivec2> pixelOf(const QaContext& c, JsonReader& check) {
  if (const Result<void> picture = needsPicture(c); !picture) return picture.error();
  const std::vector<double> p = check.numbers("at_px", 2);
  const bool inside = p[0] >= 0 && p[0] < c.picture->width && p[1] >= 0 && p[1] < c.picture->height;
  if (!inside || p[0] != std::floor(p[0]) || p[1] != std::floor(p[1]))
    check.fail("at_px", "Two whole numbers of a pixel of the picture were expected here.");
  if (check.fault()) return *check.fault();
  return glm::ivec2(static_cast<int>(p[0]), static_cast<int>(p[1]));
}

struct Wanted {
  double expected = 0, tolerance = 0;
  std::string why;
};
Wanted wanted(JsonReader& check, const char* key = "expected") {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  return {check.number(key, -kAny, kAny).value_or(NAN), check.number("tolerance", 0, kAny).value_or(NAN),
          check.text("why", false)};
}

}  // namespace

// {"kind": "pixel", "at_px": [x, y], "expected": 200 or [r, g, b], "tolerance": levels, "why"}
Result<Rows> checkPixel(const QaContext& c, JsonReader& check) {
  const Result<glm::ivec2> p = pixelOf(c, check);
  if (!p) return p.error();
  Rows rows;
  const std::uint8_t* rgb = c.picture->at(p->x, p->y);
  const Json* expected = check.any("expected");
  const double tolerance = check.number("tolerance", 0, 255).value_or(NAN);
  const std::string why = check.text("why", false);
  if (expected && expected->is_number()) {
    const int grey = rgb[1];
    rows.push_back(
        within("grey" + at(p->x, p->y), "level/255", grey, expected->get<double>(), tolerance, why));
    rows.back().pass = rows.back().pass && rgb[0] == grey && rgb[2] == grey;
    if (rgb[0] != grey || rgb[2] != grey) rows.back().measured = Json{rgb[0], rgb[1], rgb[2]}.dump();
  } else {
    const std::vector<double> colour = check.numbers("expected", 3);
    constexpr const char* kNames[] = {"red", "green", "blue"};
    for (std::size_t i = 0; i < 3; ++i)
      rows.push_back(within(kNames[i] + at(p->x, p->y), "level/255", rgb[i], colour[i], tolerance, why));
  }
  return rows;
}

// {"kind": "value", "at_px": [x, y], "expected": 40, "tolerance": 0.5, "why"}; expected null: no data there.
Result<Rows> checkValue(const QaContext& c, JsonReader& check) {
  const Result<glm::ivec2> p = pixelOf(c, check);
  if (!p) return p.error();
  const Images& images = c.rendered->frame.images;
  if (images.values.empty())
    return makeError(ErrorCode::FileDamaged, "This layer keeps no values before the window; use slices.",
                     check.placeOf("kind"));
  const double measured = static_cast<double>(
      images.values[static_cast<std::size_t>(p->y) * static_cast<std::size_t>(images.width) +
                    static_cast<std::size_t>(p->x)]);
  const auto volume = c.session.builtVolume();
  const std::string unit = volume ? volume->info().unit : "stored value";
  const Json* expected = check.any("expected");
  if (expected && expected->is_null()) {
    check.text("why", false);
    QaRow row = equalText("value" + at(p->x, p->y), std::isnan(measured) ? "no data" : "data", "no data");
    if (!std::isnan(measured)) row.measured = measured;
    return Rows{row};
  }
  const Wanted w = wanted(check);
  return Rows{within("value" + at(p->x, p->y), unit, measured, w.expected, w.tolerance, w.why)};
}

// {"kind": "depth", "at_px": [x, y], "expected": mm along the pixel's ray, "tolerance": mm, "why"}
Result<Rows> checkDepth(const QaContext& c, JsonReader& check) {
  const Result<glm::ivec2> p = pixelOf(c, check);
  if (!p) return p.error();
  const Images& images = c.rendered->frame.images;
  const double measured = static_cast<double>(
      images.depth[static_cast<std::size_t>(p->y) * static_cast<std::size_t>(images.width) +
                   static_cast<std::size_t>(p->x)]);
  const Wanted w = wanted(check);
  QaRow row = within("depth" + at(p->x, p->y), "mm", measured, w.expected, w.tolerance, w.why);
  if (!std::isfinite(measured)) row.measured = "nothing was hit";
  return Rows{row};
}

// {"kind": "probe", "voxel": [i, j, k], "expected": 40, "tolerance": 0, "stored": 1064, "why"}: modality
// value of the voxel in double, and the stored one; expected null: padding.
Result<Rows> checkProbe(const QaContext& c, JsonReader& check) {
  const auto volume = c.session.volume("");
  if (!volume) return volume.error();
  if ((*volume)->isColour())
    return makeError(ErrorCode::FileDamaged, "A colour volume has no values to probe.",
                     check.placeOf("kind"));
  const std::vector<double> v = check.numbers("voxel", 3);
  const GridGeometry& g = (*volume)->grid();
  const double size[] = {static_cast<double>(g.columns), static_cast<double>(g.rows),
                         static_cast<double>(g.slices)};
  for (std::size_t i = 0; i < 3; ++i)
    if (!(v[i] >= 0 && v[i] < size[i]) || v[i] != std::floor(v[i]))
      check.fail("voxel", "Three whole numbers of a voxel of the volume were expected here.");
  if (check.fault()) return *check.fault();
  const VoxelValue value = (*volume)->probe(static_cast<std::int64_t>(v[0]), static_cast<std::int64_t>(v[1]),
                                            static_cast<std::int64_t>(v[2]));
  const std::string name = "voxel " + Json(std::vector<std::int64_t>(v.begin(), v.end())).dump();
  Rows rows;
  if (const Json* expected = check.any("expected"); expected && expected->is_null()) {
    check.text("why", false);
    rows.push_back(equalText("value of " + name, value.noData ? "no data" : "data", "no data"));
  } else {
    const Wanted w = wanted(check);
    rows.push_back(within("value of " + name, (*volume)->info().unit, value.noData ? NAN : value.modality,
                          w.expected, w.tolerance, w.why));
    if (value.noData) rows.back().measured = "no data";
  }
  if (check.has("stored"))
    rows.push_back(within("stored value of " + name, "stored value", value.stored,
                          check.number("stored", -1e12, 1e12).value_or(NAN), 0, "stored values are exact"));
  return rows;
}

// {"kind": "error", "figure": "bound", "at_most": 2, "why"}: the measured error of the picture; figures max,
// rms, p99 and bound.
Result<Rows> checkError(const QaContext& c, JsonReader& check) {
  if (const Result<void> picture = needsPicture(c); !picture) return picture.error();
  const std::string figure = check.text("figure");
  const double most = check.number("at_most", 0, 255).value_or(NAN);
  const std::string why = check.text("why");
  if (!c.rendered->error)
    return makeError(ErrorCode::Internal, "The picture's error was not measured.", check.placeOf("figure"));
  const quality::ErrorReport& e = *c.rendered->error;
  double measured = NAN;
  if (figure == "max")
    measured = e.max;
  else if (figure == "rms")
    measured = e.rms;
  else if (figure == "p99")
    measured = e.p99;
  else if (figure == "bound")
    measured = e.bound.value_or(NAN);
  else
    check.fail("figure", "There are the figures max, rms, p99 and bound.");
  QaRow row = within("error, " + figure, "level/255", measured, 0, most, why);
  if (std::isnan(measured)) row.measured = "too few samples";
  return Rows{row};
}

// {"kind": "letters", "left": "R", "right": "L", "top": "A", "bottom": "P", "flipped": false}
Result<Rows> checkLetters(const QaContext& c, JsonReader& check) {
  if (const Result<void> picture = needsPicture(c); !picture) return picture.error();
  const Result<Annotations> a =
      annotationsFor(c.session, c.request->scene, c.request->view, *c.rendered, std::nullopt);
  if (!a) return a.error();
  Rows rows;
  for (const auto& [edge, letters] : {std::pair{"left", &a->letters.left},
                                      {"right", &a->letters.right},
                                      {"top", &a->letters.top},
                                      {"bottom", &a->letters.bottom}})
    if (check.has(edge))
      rows.push_back(equalText(std::string("letters on the ") + edge, *letters, check.text(edge, false)));
  if (const Json* flipped = check.any("flipped", false)) {
    if (!flipped->is_boolean()) check.fail("flipped", "true or false was expected here.");
    rows.push_back(equalText("the picture says FLIPPED", a->flipped ? "yes" : "no",
                             *flipped == Json(true) ? "yes" : "no"));
  }
  check.text("why", false);
  if (rows.empty()) check.fail("left", "Say what stands at one edge or more.");
  return rows;
}

// {"kind": "statistics", "of": "covered", "expected": 0.31, "tolerance": 0.01, "why"}: of the whole picture;
// covered (share of the pixels that are not of the commonest colour), colours (how many), sd (levels).
Result<Rows> checkStatistics(const QaContext& c, JsonReader& check) {
  if (const Result<void> picture = needsPicture(c); !picture) return picture.error();
  const std::string of = check.text("of");
  const Wanted w = wanted(check);
  const PictureFacts facts = factsOf(*c.picture);
  if (of == "covered") return Rows{within("covered", "share", facts.covered, w.expected, w.tolerance, w.why)};
  if (of == "colours")
    return Rows{within("different colours", "1", facts.colours, w.expected, w.tolerance, w.why)};
  if (of == "sd")
    return Rows{within("standard deviation", "level/255", facts.sd, w.expected, w.tolerance, w.why)};
  check.fail("of", "There are covered, colours and sd.");
  return Rows{};
}

}  // namespace vernier::app
