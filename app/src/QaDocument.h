// SPDX-License-Identifier: GPL-3.0-or-later
// What a run of quality assurance found, as one JSON document (schema "vernier-qa/1", docs/qa.md), and what
// is made of it: a page, a JUnit file. The page is made of the document and its pictures alone, so that it
// can be made again. No path of the machine stands in any of them.
#pragma once
#include <functional>

#include "QaRun.h"

namespace vernier::app {

using QaJson = nlohmann::ordered_json;

// Program, plugins, machine, driver. `gl`: OpenGL is looked for.
QaJson qaIdentity(Session&, bool gl, const std::string& operatorName);
std::string utcNow();  // "2026-01-31T12:00:00Z"

struct QaRunFacts {
  std::string suite;  // name of the folder
  std::vector<std::string> engines;
  std::string started_utc;
  double seconds = 0;
};
QaJson qaDocument(const QaRunFacts&, const QaJson& identity, const std::vector<QaCaseResult>&);

// Pictures of the results under the names that the document gives them.
std::vector<std::pair<std::string, const Picture*>> qaPictures(const std::vector<QaCaseResult>&);

// 0 all passed, 4 a case failed or an engine drew nothing, 3 only inputs were damaged or missing.
int qaExitCode(const std::vector<QaCaseResult>&);

// PNG bytes by the document's name; empty where the file is not there.
using QaPictureBytes = std::function<std::vector<std::byte>(const std::string& name)>;
// One self-contained page; it states the hash of the document's file. FileDamaged when the document is none
// of this schema.
Result<std::string> qaHtml(const QaJson& document, const std::string& jsonSha256, const QaPictureBytes&);
Result<std::string> qaJunit(const QaJson& document);

// Text of a number, text or null of a row, for people.
std::string qaText(const QaJson& value);

}  // namespace vernier::app
