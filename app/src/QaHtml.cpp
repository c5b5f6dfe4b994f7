// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a quality assurance run: verdict, scope, identity, table of all tests, pictures of each case.
#include <map>

#include "QaDocument.h"
#include "QaEscape.h"
#include "QaHtmlParts.h"

namespace vernier::app {
namespace {

std::string text(const QaJson& j, const char* key) { return escaped(qaText(j.at(key))); }
std::string badge(const std::string& verdict) {
  return "<span class=\"" + escaped(verdict) + "\">" + escaped(verdict) + "</span>";
}

std::string head(const QaJson& d) {
  std::string out = "<h1>Quality assurance of Vernier " + text(d.at("identity").at("program"), "version") +
                    ": " + text(d, "suite") + "</h1>\n<p class=\"soft\">Begun " + text(d, "started_utc") +
                    " (UTC), took " + text(d, "seconds") + " s. Not for primary diagnosis.</p>\n";
  const std::string verdict = d.at("verdict").get<std::string>();
  out += "<div class=\"verdict " + escaped(verdict) + "\">" + (verdict == "pass" ? "PASSED" : "NOT PASSED") +
         "</div>\n<ul>";
  for (const QaJson& s : d.at("summary")) {
    out += "<li>" + text(s, "engine") + ": " + text(s, "passed") + " of " + text(s, "cases") + " cases pass";
    std::string failed;
    for (const QaJson& name : s.at("not_passed"))
      failed += (failed.empty() ? "" : ", ") + escaped(qaText(name));
    if (!failed.empty()) out += "; <span class=\"fail\">not: " + failed + "</span>";
    if (!s.at("not_meant_for_it").empty())
      out += "; " + std::to_string(s.at("not_meant_for_it").size()) + " not meant for it";
    out += "</li>";
  }
  return out + "</ul>\n<div class=\"scope\"><b>Scope.</b> " + text(d, "scope") + "</div>\n";
}

std::string row(const std::string& name, const std::string& value) {
  return "<tr><th>" + name + "</th><td>" + value + "</td></tr>\n";
}
std::string hash(const std::string& sha256) { return " <span class=\"hash\">" + sha256 + "</span>"; }

std::string identity(const QaJson& d, const std::string& jsonSha256) {
  const QaJson& i = d.at("identity");
  const QaJson& program = i.at("program");
  const QaJson& machine = i.at("machine");
  std::string out = "<h2>What was tested, and where</h2>\n<table>\n";
  out += row("Program", "Vernier " + text(program, "version") + ", SHA-256" + hash(text(program, "sha256")));
  if (program.contains("library"))
    out += row("Library", text(program.at("library"), "name") + ", SHA-256" +
                              hash(text(program.at("library"), "sha256")));
  std::string plugins;
  for (const QaJson& p : i.at("plugins"))
    plugins += "<div>" + text(p, "name") + " " + text(p, "version") + " (" + text(p, "state") + ")" +
               hash(text(p, "sha256")) + "</div>";
  out += row("Plugins", plugins);
  out +=
      row("Machine", text(machine, "name") + ": " + text(machine, "system") + ", " + text(machine, "kernel"));
  out += row("Processor", text(machine, "processor") + ", " + text(machine, "cores") + " cores, " +
                              text(machine, "threads") + " threads used, " + text(machine, "memory_mb") +
                              " MB memory, locale " + text(machine, "locale"));
  out += row("Native engine", text(i.at("native"), "simd"));
  const QaJson& gl = i.at("gl");
  out += row("OpenGL engine", gl.is_string() ? escaped(qaText(gl))
                                             : text(gl, "renderer") + ", version " + text(gl, "version") +
                                                   (gl.at("software") == true ? " (software)" : ""));
  out += row("Image library", text(program, "image_library"));
  out += row("Operator", i.at("operator") == "" ? "not stated" : text(i, "operator"));
  out += row("Record", "report.json, SHA-256" + hash(escaped(jsonSha256)));
  return out + "</table>\n";
}

const QaJson* engineOf(const QaJson& c, const std::string& engine) {
  for (const QaJson& e : c.at("engines"))
    if (e.at("engine") == engine) return &e;
  return nullptr;
}

// Numbers stand to the right, texts to the left.
std::string valueCell(const QaJson& row, const char* key) {
  return (row.at(key).is_number() ? "<td class=\"n\">" : "<td>") + text(row, key) + "</td>";
}

std::string cells(const QaJson* engineRow) {
  if (!engineRow) return "<td class=\"n\"></td><td class=\"soft\">&ndash;</td>";
  return valueCell(*engineRow, "measured") + "<td>" + badge(engineRow->at("verdict").get<std::string>()) +
         "</td>";
}

// The rows of a case, those of all engines side by side: by quantity, and in the order of the first.
std::string caseRows(const QaJson& c, const std::vector<std::string>& engines, const std::string& link) {
  std::vector<std::string> order;
  std::map<std::string, std::map<std::string, const QaJson*>> rows;
  std::string errors;
  for (const std::string& engine : engines) {
    const QaJson* e = engineOf(c, engine);
    if (!e) continue;
    std::map<std::string, int> seen;
    for (const QaJson& r : e->at("rows")) {
      const std::string quantity = r.at("quantity").get<std::string>();
      const std::string key = quantity + "#" + std::to_string(seen[quantity]++);
      if (!rows.contains(key)) order.push_back(key);
      rows[key][engine] = &r;
    }
    if (e->at("sentence").is_string())
      errors += "<tr class=\"bad\"><td>" + link + "</td><td colspan=\"" +
                std::to_string(4 + 2 * engines.size()) + "\">" + escaped(engine) + ": " +
                text(*e, "sentence") + "</td></tr>\n";
  }
  std::string out;
  for (const std::string& key : order) {
    const QaJson& any = *rows[key].begin()->second;
    bool bad = false;
    std::string values;
    for (const std::string& engine : engines) {
      const auto found = rows[key].find(engine);
      if (found == rows[key].end() && !engineOf(c, engine)) {
        values += "<td class=\"n\"></td><td class=\"soft\">not meant for it</td>";
        continue;
      }
      const QaJson* r = found == rows[key].end() ? nullptr : found->second;
      bad = bad || (r && r->at("verdict") != "pass");
      values += cells(r);
    }
    std::string tolerance = text(any, "tolerance");
    for (const auto& [engine, r] : rows[key])
      if (r->at("tolerance") != any.at("tolerance"))
        tolerance += " (" + escaped(engine) + ": " + text(*r, "tolerance") + ")";
    out += std::string("<tr") + (bad ? " class=\"bad\"" : "") + "><td>" + link + "</td><td>" +
           text(any, "quantity") + "</td><td>" + text(any, "unit") + "</td>" + valueCell(any, "expected") +
           "<td class=\"n\" title=\"" + text(any, "why") + "\">" + tolerance + "</td>" + values + "</tr>\n";
  }
  return out + errors;
}

// What the suite is for: for each requirement the hazards behind it, and how its cases went on each engine.
std::string requirements(const QaJson& d, const std::vector<std::string>& engines) {
  struct Went {
    std::string hazards;
    std::map<std::string, std::pair<int, int>> passed;  // of how many
  };
  std::vector<std::string> order;
  std::map<std::string, Went> all;
  for (const QaJson& c : d.at("cases")) {
    const std::string name = c.value("requirement", "");
    if (name.empty()) continue;
    if (!all.contains(name)) order.push_back(name);
    Went& went = all[name];
    if (const std::string hazard = c.value("hazard", "");
        !hazard.empty() && went.hazards.find(hazard) == std::string::npos)
      went.hazards += (went.hazards.empty() ? "" : "; ") + hazard;
    for (const QaJson& e : c.at("engines")) {
      auto& [passed, of] = went.passed[e.at("engine").get<std::string>()];
      ++of, passed += e.at("verdict") == "pass" ? 1 : 0;
    }
  }
  if (order.empty()) return "";
  std::string out = "<h2>Requirements</h2>\n<table>\n<tr><th>Requirement</th><th>Hazard</th>";
  for (const std::string& e : engines) out += "<th>Cases that pass, " + escaped(e) + "</th>";
  out += "</tr>\n";
  for (const std::string& name : order) {
    out += "<tr><td>" + escaped(name) + "</td><td>" + escaped(all[name].hazards) + "</td>";
    for (const std::string& e : engines) {
      const auto [passed, of] = all[name].passed[e];
      out += "<td class=\"" + std::string(passed == of ? "pass" : "fail") + "\">" +
             (of == 0 ? "&ndash;" : std::to_string(passed) + " of " + std::to_string(of)) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</table>\n";
}

std::string allRows(const QaJson& d, const std::vector<std::string>& engines) {
  std::string out =
      "<h2>All tests</h2>\n<table>\n<tr><th>Test</th><th>Quantity</th><th>Unit</th><th>Expected</th>"
      "<th>Tolerance</th>";
  for (const std::string& e : engines) out += "<th>Measured, " + escaped(e) + "</th><th>Verdict</th>";
  out += "</tr>\n";
  std::size_t i = 0;
  for (const QaJson& c : d.at("cases")) {
    const std::string name = text(c, "name");
    out += caseRows(c, engines, "<a href=\"#case" + std::to_string(i++) + "\">" + name + "</a>");
  }
  return out +
         "</table>\n<p class=\"soft small\">Tolerances are on the absolute difference from what is expected, "
         "unless they say otherwise.</p>\n";
}

std::string reasons(const QaJson& c) {
  std::string out;
  std::map<std::string, bool> seen;
  for (const QaJson& e : c.at("engines"))
    for (const QaJson& r : e.at("rows")) {
      const std::string why = r.at("why").get<std::string>();
      if (!why.empty() && !seen[why]) out += "<li>" + escaped(why) + "</li>";
      seen[why] = true;
    }
  return out.empty() ? "" : "<div class=\"small\">Tolerances, why:<ul>" + out + "</ul></div>\n";
}

// Expected, drawn, what differs and how much: one line for each engine. Without a baseline all in one line.
std::string enginePictures(const QaJson& c, const QaJson& e, const QaPictureBytes& bytes) {
  if (!e.contains("picture")) return "";
  const std::string engine = e.at("engine").get<std::string>();
  std::string out;
  if (c.contains("expected"))
    out += imageTag(bytes(c.at("expected").at("picture").get<std::string>()), "expected");
  out += imageTag(bytes(e.at("picture").get<std::string>()), engine + ", " + qaText(e.at("technique")));
  if (e.contains("heat")) {
    out += imageTag(bytes(e.at("heat").get<std::string>()), engine + ", difference (black: none)");
    out += histogramSvg(e.at("histogram").get<std::vector<std::uint64_t>>());
  }
  return c.contains("expected") ? "<div class=\"pictures\">\n" + out + "</div>\n" : out;
}

std::string caseBlock(const QaJson& c, std::size_t index, const QaPictureBytes& bytes) {
  bool good = !c.at("engines").empty();
  std::string verdicts, pictures;
  for (const QaJson& e : c.at("engines")) {
    const std::string verdict = e.at("verdict").get<std::string>(),
                      engine = e.at("engine").get<std::string>();
    good = good && verdict == "pass";
    verdicts += " &nbsp; " + escaped(engine) + ": " + badge(verdict);
    if (e.at("sentence").is_string()) verdicts += "<div class=\"fail\">" + text(e, "sentence") + "</div>";
    pictures += enginePictures(c, e, bytes);
  }
  std::string out = std::string("<div class=\"case") + (good ? "" : " notpassed") + "\" id=\"case" +
                    std::to_string(index) + "\"><h3>" + text(c, "name") +
                    (c.contains("title") ? ": " + text(c, "title") : "") + verdicts + "</h3>\n";
  if (c.contains("why")) out += "<p>" + text(c, "why") + "</p>\n";
  for (const auto& [key, label] : {std::pair{"requirement", "Requirement"}, {"hazard", "Hazard"}})
    if (c.contains(key) && c.at(key) != "")
      out += std::string("<div>") + label + ": " + text(c, key) + "</div>\n";
  if (c.contains("data") && c.at("data").at("what") != "")
    out += "<div class=\"small\">Data: " + text(c.at("data"), "what") + hash(text(c.at("data"), "sha256")) +
           "</div>\n";
  out += reasons(c);
  if (c.contains("expected")) {
    std::string caught;
    for (const QaJson& m : c.at("mutants").at("caught"))
      caught += (caught.empty() ? "" : ", ") + escaped(qaText(m));
    out += "<div class=\"small\">Spoilt on purpose, the baseline is told when: " + caught + ".";
    for (const auto& [mutant, why] : c.at("mutants").at("exempt").items())
      out += " Not told: " + escaped(mutant) + " (" + escaped(qaText(why)) + ").";
    out += "</div>\n";
  }
  if (!c.contains("expected")) pictures = "<div class=\"pictures\">\n" + pictures + "</div>\n";
  return out + pictures + "</div>\n";
}

}  // namespace

Result<std::string> qaHtml(const QaJson& d, const std::string& jsonSha256, const QaPictureBytes& bytes) {
  try {
    if (d.at("schema") != "vernier-qa/1")
      return makeError(ErrorCode::FileDamaged, "The report is of another schema than vernier-qa/1.");
    std::vector<std::string> engines;
    for (const QaJson& s : d.at("summary")) engines.push_back(s.at("engine").get<std::string>());
    std::string out =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Quality assurance: " +
        text(d, "suite") + "</title>\n<style>" + kQaStyle + "</style></head><body>\n";
    out += head(d) + identity(d, jsonSha256) + requirements(d, engines) + allRows(d, engines) +
           "<h2>Cases</h2>\n";
    std::size_t index = 0;
    for (const QaJson& c : d.at("cases")) out += caseBlock(c, index++, bytes);
    return out +
           "<table class=\"signed\"><tr><td>Reviewed by</td><td>Date</td><td>Remarks</td></tr></table>\n"
           "</body></html>\n";
  } catch (const QaJson::exception&) {
    return makeError(ErrorCode::FileDamaged,
                     "This is no report of `vernier qa run`: something is missing in it.");
  }
}

}  // namespace vernier::app
