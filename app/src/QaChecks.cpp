// SPDX-License-Identifier: GPL-3.0-or-later
#include "QaChecks.h"

#include <cmath>

namespace vernier::app {

const std::map<std::string, QaCheckFn>& qaCheckKinds() {
  static const std::map<std::string, QaCheckFn> kinds = {
      {"angle", checkAngle},       {"area", checkArea},
      {"centroid", checkCentroid}, {"depth", checkDepth},
      {"distance", checkDistance}, {"error", checkError},
      {"letters", checkLetters},   {"measurement", checkMeasurement},
      {"pixel", checkPixel},       {"probe", checkProbe},
      {"reload", checkReload},     {"statistics", checkStatistics},
      {"text", checkText},         {"two-patients", checkTwoPatients},
      {"value", checkValue},
  };
  return kinds;
}

QaRow within(std::string quantity, std::string unit, double measured, double expected, double tolerance,
             std::string why) {
  QaRow row;
  row.quantity = std::move(quantity), row.unit = std::move(unit), row.why = std::move(why);
  row.measured = measured, row.expected = expected, row.tolerance = tolerance;
  row.pass = std::abs(measured - expected) <= tolerance;
  return row;
}

QaRow equalText(std::string quantity, const std::string& measured, const std::string& expected) {
  QaRow row;
  row.quantity = std::move(quantity);
  row.measured = measured, row.expected = expected, row.tolerance = "equal";
  row.pass = measured == expected;
  return row;
}

Result<void> needsPicture(const QaContext& c) {
  if (c.rendered && c.picture && c.request) return {};
  return makeError(ErrorCode::FileDamaged, "The check looks at a picture; give the case a view or a scene.",
                   c.qaCase.name + "/case.json#/checks");
}

Result<std::vector<QaRow>> runQaChecks(const QaContext& c) {
  std::vector<QaRow> rows;
  for (std::size_t i = 0; i < c.qaCase.checks.size(); ++i) {
    const nlohmann::ordered_json& check = c.qaCase.checks[i];
    const std::string place = c.qaCase.name + "/case.json#/checks/" + std::to_string(i);
    JsonReader reader(check, place);
    const std::string kind = reader.text("kind");
    const auto found = qaCheckKinds().find(kind);
    if (found == qaCheckKinds().end()) {
      std::string names;
      for (const auto& [name, fn] : qaCheckKinds()) names += (names.empty() ? "" : ", ") + name;
      return makeError(ErrorCode::FileDamaged,
                       "There is no check of the kind '" + kind + "'; there are " + names + ".", place);
    }
    Result<std::vector<QaRow>> some = found->second(c, reader);
    if (reader.fault()) return *reader.fault();  // it says more than what followed from it
    if (!some) return some.error();
    if (const Result<void> done = reader.done(); !done) return done.error();
    if (some->empty()) return makeError(ErrorCode::Internal, "The check measured nothing.", place);
    rows.insert(rows.end(), some->begin(), some->end());
  }
  return rows;
}

}  // namespace vernier::app
