// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of a case that are no pictures: numbers and texts with an expected value. A kind of check is one
// function; qaCheckKinds() lists them all, and a new kind is one line there and one function. docs/qa.md says
// what each needs. Called on one thread at a time.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "JsonReader.h"
#include "QaCase.h"
#include "ViewOptions.h"

namespace vernier::app {

// One line of the report's table. measured, expected and tolerance are numbers, texts or null.
struct QaRow {
  std::string quantity, unit;
  nlohmann::ordered_json measured, expected, tolerance;
  bool pass = false;
  std::string why;  // of the tolerance
};

// What a check may look at. The session has the case's data open; request, rendered and picture are nullptr
// for a case that draws nothing.
struct QaContext {
  const QaCase& qaCase;
  std::string engine;  // "native" or "gl"
  Session& session;
  const RenderRequest* request = nullptr;
  const Rendered* rendered = nullptr;
  const Picture* picture = nullptr;  // 8 bits, without letters
  std::vector<std::string> inputs;   // the files and folders that are open
  std::string workFolder;            // exists, empty at the case's beginning, gone after it
  // Data that a check names beside the case's own, as a file or folder; and a session of its own for it.
  std::function<Result<std::string>(const QaData&)> fetch;
  std::function<std::unique_ptr<Session>()> newSession;
};

// `check` reads the JSON object and is finished by the caller: what it did not ask for is refused. An Error
// (FileDamaged: of case.json; others: of the work) fails the case with its sentence.
using QaCheckFn = Result<std::vector<QaRow>> (*)(const QaContext&, JsonReader& check);
const std::map<std::string, QaCheckFn>& qaCheckKinds();

// All checks of a case, in order. FileDamaged names the check.
Result<std::vector<QaRow>> runQaChecks(const QaContext&);

// A row whose measured number must lie within `tolerance` of `expected`; NaN never does.
QaRow within(std::string quantity, std::string unit, double measured, double expected, double tolerance,
             std::string why);
// A row whose text must be equal.
QaRow equalText(std::string quantity, const std::string& measured, const std::string& expected);
// "there is no picture" unless the case draws.
Result<void> needsPicture(const QaContext&);

// Kinds that look at the picture or the volume (QaPictureChecks.cpp).
Result<std::vector<QaRow>> checkPixel(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkValue(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkDepth(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkProbe(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkError(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkLetters(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkStatistics(const QaContext&, JsonReader&);
// Kinds that find something in the picture and say where it is, or how large (QaFeatureChecks.cpp).
Result<std::vector<QaRow>> checkCentroid(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkDistance(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkAngle(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkArea(const QaContext&, JsonReader&);
// Kinds that do what a user does: measure, read, compare, save (QaWorkChecks.cpp).
Result<std::vector<QaRow>> checkMeasurement(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkText(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkTwoPatients(const QaContext&, JsonReader&);
Result<std::vector<QaRow>> checkReload(const QaContext&, JsonReader&);

}  // namespace vernier::app
