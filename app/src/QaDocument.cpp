// SPDX-License-Identifier: GPL-3.0-or-later
#include "QaDocument.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "vernier/base/Result.h"

namespace vernier::app {
namespace {

// "pictures/007-axial.native.png": the number keeps names apart that differ in their slashes only.
std::string pictureName(std::size_t index, const std::string& caseName, const std::string& what) {
  char number[16];
  std::snprintf(number, sizeof number, "%03zu", index + 1);
  std::string plain = caseName;
  for (char& c : plain)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '-';
  return std::string("pictures/") + number + "-" + plain + "." + what + ".png";
}

// NaN and infinities have no number in JSON.
QaJson plain(const QaJson& j) {
  if (j.is_number_float() && !std::isfinite(j.get<double>()))
    return std::isnan(j.get<double>()) ? "not a number" : j.get<double>() > 0 ? "infinite" : "minus infinite";
  return j;
}

QaJson rowFacts(const QaRow& r) {
  return {{"quantity", r.quantity},
          {"unit", r.unit},
          {"measured", plain(r.measured)},
          {"expected", plain(r.expected)},
          {"tolerance", plain(r.tolerance)},
          {"verdict", r.pass ? "pass" : "fail"},
          {"why", r.why}};
}

QaJson engineFacts(const QaEngineResult& e, std::size_t index, const std::string& name) {
  QaJson j = {{"engine", e.engine}, {"verdict", nameOf(e.verdict)}};
  j["sentence"] =
      e.error ? QaJson((e.error->where.empty() ? "" : e.error->where + ": ") + e.error->sentence) : QaJson();
  if (e.error) j["code"] = std::string(errorName(e.error->code));
  j["renderer"] = e.renderer, j["technique"] = e.technique;
  j["rows"] = QaJson::array();
  for (const QaRow& r : e.rows) j["rows"].push_back(rowFacts(r));
  if (e.picture) j["picture"] = pictureName(index, name, e.engine);
  if (e.heat) {
    j["heat"] = pictureName(index, name, e.engine + "-difference");
    std::size_t last = 0;
    for (std::size_t i = 0; i < e.histogram.size(); ++i)
      if (e.histogram[i]) last = i;
    j["histogram"] = std::vector<std::uint64_t>(e.histogram.begin(), e.histogram.begin() + last + 1);
  }
  return j;
}

QaJson dataFacts(const QaCase& c, const std::string& sha256) {
  QaJson j = {{"what", ""}, {"sha256", sha256}};
  std::string what;
  const auto add = [&](const QaData& d) {
    what += (what.empty() ? "" : ", ") + (d.recipe.empty() ? d.path : "phantom " + d.recipe);
    for (const auto& [name, value] : d.settings) what += " " + name + "=" + value;
  };
  if (c.data) add(*c.data);
  for (const QaData& d : c.surfaces) add(d);
  j["what"] = what;
  return j;
}

QaJson caseFacts(const QaCaseResult& r, std::size_t index) {
  QaJson j = {{"name", r.name}};
  if (r.qaCase) {
    const QaCase& c = *r.qaCase;
    j["title"] = c.title, j["why"] = c.why, j["requirement"] = c.requirement, j["hazard"] = c.hazard;
    j["sha256"] = r.caseSha256;
    j["data"] = dataFacts(c, r.dataSha256);
    QaJson exempt = QaJson::object();
    for (const auto& [mutant, why] : c.exempt) exempt[nameOf(mutant)] = why;
    j["mutants"] = {{"caught", r.caught}, {"exempt", exempt}};
  }
  if (r.expected)
    j["expected"] = {{"picture", pictureName(index, r.name, "expected")}, {"sha256", r.expectedSha256}};
  j["engines"] = QaJson::array();
  for (const QaEngineResult& e : r.engines) j["engines"].push_back(engineFacts(e, index, r.name));
  return j;
}

QaJson summaryOf(const std::vector<std::string>& engines, const std::vector<QaCaseResult>& results) {
  QaJson list = QaJson::array();
  for (const std::string& engine : engines) {
    QaJson failed = QaJson::array(), other = QaJson::array();
    int cases = 0, passed = 0;
    for (const QaCaseResult& r : results) {
      const auto e = std::find_if(r.engines.begin(), r.engines.end(),
                                  [&](const QaEngineResult& x) { return x.engine == engine; });
      if (e == r.engines.end()) {
        other.push_back(r.name);
        continue;
      }
      ++cases;
      if (e->verdict == QaVerdict::Pass)
        ++passed;
      else
        failed.push_back(r.name);
    }
    list.push_back({{"engine", engine},
                    {"cases", cases},
                    {"passed", passed},
                    {"not_passed", failed},
                    {"not_meant_for_it", other},
                    {"verdict", passed == cases && cases > 0 ? "pass" : "fail"}});
  }
  return list;
}

}  // namespace

std::string qaText(const QaJson& v) {
  if (v.is_string()) return v.get<std::string>();
  if (v.is_null()) return "";
  if (!v.is_number()) return v.dump();
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v.get<double>());
  return text;
}

QaJson qaDocument(const QaRunFacts& facts, const QaJson& identity, const std::vector<QaCaseResult>& results) {
  QaJson j;
  j["schema"] = "vernier-qa/1";
  j["purpose"] = "not for primary diagnosis";
  j["scope"] =
      "This run tests the software chain from the files to the values in the framebuffer. It does not test "
      "the "
      "display: the luminance of the panel needs a photometer.";
  j["suite"] = facts.suite;
  j["started_utc"] = facts.started_utc;
  j["seconds"] = facts.seconds;
  j["verdict"] = qaExitCode(results) == 0 ? "pass" : "fail";
  j["summary"] = summaryOf(facts.engines, results);
  j["identity"] = identity;
  j["cases"] = QaJson::array();
  for (std::size_t i = 0; i < results.size(); ++i) j["cases"].push_back(caseFacts(results[i], i));
  return j;
}

std::vector<std::pair<std::string, const Picture*>> qaPictures(const std::vector<QaCaseResult>& results) {
  std::vector<std::pair<std::string, const Picture*>> out;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const QaCaseResult& r = results[i];
    if (r.expected) out.emplace_back(pictureName(i, r.name, "expected"), &*r.expected);
    for (const QaEngineResult& e : r.engines) {
      if (e.picture) out.emplace_back(pictureName(i, r.name, e.engine), &*e.picture);
      if (e.heat) out.emplace_back(pictureName(i, r.name, e.engine + "-difference"), &*e.heat);
    }
  }
  return out;
}

int qaExitCode(const std::vector<QaCaseResult>& results) {
  int code = results.empty() ? 3 : 0;
  for (const QaCaseResult& r : results)
    for (const QaEngineResult& e : r.engines) {
      if (e.verdict == QaVerdict::Pass) continue;
      const bool input = e.verdict == QaVerdict::Error && e.error && exitCode(e.error->code) != 1;
      code = input && code != 4 ? 3 : 4;
    }
  return code;
}

}  // namespace vernier::app
