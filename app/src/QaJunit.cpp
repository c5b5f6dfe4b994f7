// SPDX-License-Identifier: GPL-3.0-or-later
// The JUnit file that build servers read: one suite per engine.
#include "QaDocument.h"
#include "QaEscape.h"

namespace vernier::app {
namespace {

std::string sentenceOf(const QaJson& engine) {
  if (engine.at("sentence").is_string()) return engine.at("sentence").get<std::string>();
  std::string text;
  for (const QaJson& r : engine.at("rows"))
    if (r.at("verdict") != "pass")
      text += (text.empty() ? "" : "; ") + r.at("quantity").get<std::string>() + ": measured " +
              qaText(r.at("measured")) + ", expected " + qaText(r.at("expected")) + ", tolerance " +
              qaText(r.at("tolerance"));
  return text;
}

std::string suiteOf(const QaJson& document, const QaJson& summary) {
  const std::string engine = summary.at("engine").get<std::string>();
  const std::string suite = document.at("suite").get<std::string>() + "." + engine;
  std::string body;
  int failures = 0, errors = 0, tests = 0;
  for (const QaJson& c : document.at("cases"))
    for (const QaJson& e : c.at("engines")) {
      if (e.at("engine") != engine) continue;
      ++tests;
      body += "    <testcase classname=\"" + escaped(suite) + "\" name=\"" +
              escaped(c.at("name").get<std::string>()) + "\"";
      const std::string verdict = e.at("verdict").get<std::string>();
      if (verdict == "pass") {
        body += "/>\n";
        continue;
      }
      const char* tag = verdict == "fail" ? "failure" : "error";
      (verdict == "fail" ? failures : errors)++;
      body += std::string(">\n      <") + tag + " message=\"" + escaped(sentenceOf(e)) +
              "\"/>\n    </testcase>\n";
    }
  return "  <testsuite name=\"" + escaped(suite) + "\" tests=\"" + std::to_string(tests) + "\" failures=\"" +
         std::to_string(failures) + "\" errors=\"" + std::to_string(errors) +
         "\" skipped=\"0\" timestamp=\"" + escaped(document.at("started_utc").get<std::string>()) + "\">\n" +
         body + "  </testsuite>\n";
}

}  // namespace

Result<std::string> qaJunit(const QaJson& document) {
  try {
    std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
    for (const QaJson& s : document.at("summary")) xml += suiteOf(document, s);
    return xml + "</testsuites>\n";
  } catch (const QaJson::exception&) {
    return makeError(ErrorCode::FileDamaged, "This is no report of `vernier qa run`.");
  }
}

}  // namespace vernier::app
