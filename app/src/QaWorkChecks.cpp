// SPDX-License-Identifier: GPL-3.0-or-later
// Checks that do what a user does with a study: measure, read what stands on the picture, lay another patient
// beside it, save and open again.
#include <cmath>

#include "Annotations.h"
#include "Compare.h"
#include "MeasureSources.h"
#include "OptionText.h"
#include "QaChecks.h"
#include "vernier/measure/MeasurementJson.h"
#include "vernier/picture/Png.h"
#include "vernier/picture/Quantise.h"
#include "vernier/picture/WriteFile.h"
#include "vernier/plan/SceneJson.h"

namespace vernier::app {
namespace {
using Rows = std::vector<QaRow>;
using Json = nlohmann::ordered_json;

Result<std::vector<measure::Entry>> listOf(const Json& measurements, const std::string& place) {
  Result<std::vector<measure::Entry>> list = measure::parseMeasurements(
      Json{{"schema", measure::kMeasurementSchema}, {"measurements", measurements}}.dump());
  if (list && !list->empty()) return list;
  return makeError(ErrorCode::FileDamaged, list ? "A measurement was expected here." : list.error().sentence,
                   place + (list ? "" : " " + list.error().where));
}

struct Figure {
  double value = NAN;
  std::string unit = "1";
  std::optional<double> expanded;
};

// A quantity by its name, or one of the values of a region.
std::optional<Figure> figureOf(const measure::Measured& said, const std::string& name) {
  for (const measure::Quantity& q : said.quantities)
    if (q.name == name) return Figure{q.value, q.unit, q.expanded};
  if (!said.values) return std::nullopt;
  const measure::Statistics& s = *said.values;
  const std::pair<const char*, double> values[] = {
      {"min", s.min}, {"max", s.max}, {"median", s.median}, {"sd", s.sd.value_or(NAN)}};
  for (const auto& [key, value] : values)
    if (name == key) return Figure{value, "of the values", {}};
  return std::nullopt;
}

// Writes, reads back, and says whether every byte came back.
Result<bool> comesBack(const std::string& path, const std::string& text) {
  if (const Result<void> r = writeFileWhole(path, text); !r) return r.error();
  const Result<std::string> back = textOf(path, "What was written");
  if (!back) return back.error();
  return *back == text;
}

QaRow sameRow(const std::string& quantity, bool same) {
  return equalText(quantity, same ? "same" : "differs", "same");
}

Result<Rows> reloadScene(const QaContext& c) {
  const std::string text = writeScene(c.request->scene);
  const Result<bool> bytes = comesBack(c.workFolder + "/scene.json", text);
  if (!bytes) return bytes.error();
  const Result<Scene> scene = parseScene(text);
  if (!scene) return scene.error();
  Rows rows{sameRow("saved scene", *bytes && writeScene(*scene) == text && *scene == c.request->scene)};
  const Result<Rendered> again =
      c.session.render(*scene, c.request->view, c.request->quality, c.request->options);
  if (!again) return again.error();
  rows.push_back(
      sameRow("picture of the saved scene", again->frame.images.colour == c.rendered->frame.images.colour));
  const std::string png = c.workFolder + "/picture.png";
  if (const Result<void> r = writePng(png, *c.picture); !r) return r.error();
  const Result<Picture> back = readPng(png);
  if (!back) return back.error();
  rows.push_back(sameRow("saved picture", *back == *c.picture));
  return rows;
}

// Measured, saved, opened, measured again.
Result<Rows> reloadMeasurements(const QaContext& c, std::vector<measure::Entry> entries) {
  if (const Result<void> r = measuringPlugin(c.session); !r) return r.error();
  const measure::Sources sources = measureSources(c.session, {});
  const auto measureAll = [&](std::vector<measure::Entry> all) {
    measure::MeasurementList list;
    list.load(all);
    for (std::size_t n = 0; n < list.size(); ++n)
      list.setResult(list.at(n).what.id, measure::measure(list.at(n).what, sources));
    return measure::writeMeasurements(list.entries());
  };
  const std::string first = measureAll(std::move(entries));
  const Result<bool> bytes = comesBack(c.workFolder + "/measurements.json", first);
  if (!bytes) return bytes.error();
  const Result<std::vector<measure::Entry>> back = measure::parseMeasurements(first);
  if (!back) return back.error();
  return Rows{sameRow("saved measurements", *bytes && measure::writeMeasurements(*back) == first),
              sameRow("saved measurements, measured again", measureAll(*back) == first)};
}

}  // namespace

// {"kind": "measurement", "measurement": as in a list (docs/measurements.md), "quantity": "length",
// "expected": 60, "tolerance": 0.1 (absent: its own +/-), "why"}
Result<Rows> checkMeasurement(const QaContext& c, JsonReader& check) {
  const Json* what = check.object("measurement", true);
  const std::string quantity = check.text("quantity");
  const double expected = check.number("expected", -1e12, 1e12).value_or(NAN);
  const std::optional<double> tolerance = check.number("tolerance", 0, 1e12, false);
  std::string why = check.text("why", false);
  if (check.fault()) return *check.fault();
  const Result<std::vector<measure::Entry>> list = listOf(Json::array({*what}), check.placeOf("measurement"));
  if (!list) return list.error();
  if (const Result<void> r = measuringPlugin(c.session); !r) return r.error();
  const Result<measure::Measured> said = measure::measure(list->front().what, measureSources(c.session, {}));
  if (!said) return said.error();
  const std::optional<Figure> figure = figureOf(*said, quantity);
  if (!figure) {
    check.fail("quantity", "The measurement says nothing of this name.");
    return *check.fault();
  }
  if (!tolerance && !figure->expanded)
    check.fail("tolerance", "The measurement states no +/- of its own; say how far off it may be.");
  if (!tolerance && why.empty()) why = "the +/- that the measurement states";
  const std::string& label = list->front().what.label;
  return Rows{within(label.empty() ? quantity : quantity + ", " + label, figure->unit, figure->value,
                     expected, tolerance ? *tolerance : figure->expanded.value_or(NAN), why)};
}

// {"kind": "text", "says": "slice missing"}: a line of the picture holds it; "silent": true: none does.
Result<Rows> checkText(const QaContext& c, JsonReader& check) {
  if (const Result<void> picture = needsPicture(c); !picture) return picture.error();
  const std::string says = check.text("says");
  const Json* silent = check.any("silent", false);
  if (silent && !silent->is_boolean()) check.fail("silent", "true or false was expected here.");
  check.text("why", false);
  const Result<Annotations> a = annotationsFor(c.session, c.request->scene, c.request->view, *c.rendered, {});
  if (!a) return a.error();
  std::string all;
  for (const auto* lines : {&a->what, &a->status})
    for (const TextLine& line : *lines) all += (all.empty() ? "" : "; ") + line.text;
  QaRow row;
  const bool wanted = !silent || *silent != Json(true);
  row.quantity = "what stands on the picture", row.measured = all;
  row.expected = (wanted ? "with: " : "without: ") + says, row.tolerance = "equal";
  row.pass = (all.find(says) != std::string::npos) == wanted;
  return Rows{row};
}

// {"kind": "two-patients", "other": data, "answer": "refused" or "allowed"}: a difference of the case's study
// and another one.
Result<Rows> checkTwoPatients(const QaContext& c, JsonReader& check) {
  const Json* data = check.object("other", true);
  const std::string answer = check.text("answer");
  check.text("why", false);
  if (answer != "refused" && answer != "allowed") check.fail("answer", "There are refused and allowed.");
  if (check.fault()) return *check.fault();
  const Result<QaData> other = readQaData(*data, check.placeOf("other"));
  if (!other) return other.error();
  const Result<std::string> path = c.fetch(*other);
  if (!path) return path.error();
  const std::unique_ptr<Session> beside = c.newSession();
  if (!beside) return makeError(ErrorCode::Internal, "No session could be made.");
  if (const Result<void> r = beside->open({*path}); !r) return r.error();
  const Result<StackChoice> a = c.session.choose(""), b = beside->choose("");
  if (!a) return a.error();
  if (!b) return b.error();
  const bool allowed = samePatient(c.session, *a, *beside, *b).ok();
  return Rows{equalText("difference of the two studies", allowed ? "allowed" : "refused", answer)};
}

// {"kind": "reload"}: scene and picture are saved and opened again; "measurements": a list of them too.
Result<Rows> checkReload(const QaContext& c, JsonReader& check) {
  const Json* list = check.array("measurements");
  check.text("why", false);
  if (check.fault()) return *check.fault();
  Rows rows;
  if (c.rendered) {
    Result<Rows> scene = reloadScene(c);
    if (!scene) return scene.error();
    rows = std::move(*scene);
  }
  if (list) {
    const Result<std::vector<measure::Entry>> entries = listOf(*list, check.placeOf("measurements"));
    if (!entries) return entries.error();
    const Result<Rows> measured = reloadMeasurements(c, *entries);
    if (!measured) return measured.error();
    rows.insert(rows.end(), measured->begin(), measured->end());
  }
  if (rows.empty()) check.fail("measurements", "There is nothing to save: give a view, or measurements.");
  return rows;
}

}  // namespace vernier::app
