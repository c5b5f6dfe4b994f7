// SPDX-License-Identifier: GPL-3.0-or-later
// vernier qa run | accept | report: golden-image quality assurance (docs/qa.md).
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "Clock.h"
#include "InstallPlace.h"
#include "OptionChecks.h"
#include "OptionText.h"
#include "QaAccept.h"
#include "QaDocument.h"
#include "Sha256.h"
#include "vernier/picture/Png.h"
#include "vernier/picture/WriteFile.h"

namespace vernier::app {
namespace {
namespace fs = std::filesystem;

struct Options {
  std::string dir, out, engine = "both", caseName, reason, operatorName;
  std::vector<std::string> only;
  bool json = false;
};

std::string dumped(const QaJson& j) { return j.dump(2, ' ', false, QaJson::error_handler_t::replace) + "\n"; }

std::string sha256Of(const std::string& text) {
  Sha256 hash;
  hash.add(text.data(), text.size());
  return hash.hex();
}

// The last part of what the user named: a report states no folders of the machine.
std::string suiteName(const std::string& dir) {
  std::error_code ec;
  const std::string name = fs::weakly_canonical(dir, ec).filename().string();
  return ec || name.empty() ? "suite" : name;
}

Result<void> makeFolder(const std::string& path) {
  std::error_code ec;
  fs::create_directories(path, ec);
  if (!fs::is_directory(path, ec))
    return makeError(ErrorCode::WriteFailed, "The folder cannot be made; name one that can be written.",
                     path);
  return {};
}

// JSON and JUnit before the page: whoever finds the page finds all.
Result<void> writeReport(const std::string& out, const QaJson& document,
                         const std::vector<QaCaseResult>& results) {
  if (const Result<void> r = makeFolder(out + "/pictures"); !r) return r;
  std::map<std::string, std::vector<std::byte>> pngs;
  for (const auto& [name, picture] : qaPictures(results)) {
    Result<std::vector<std::byte>> png = encodePng(*picture);
    if (!png) return png.error();
    if (const Result<void> r = writeFileWhole(out + "/" + name, *png); !r) return r;
    pngs[name] = std::move(*png);
  }
  const std::string json = dumped(document);
  const Result<std::string> html = qaHtml(document, sha256Of(json), [&](const std::string& name) {
    return pngs.contains(name) ? pngs[name] : std::vector<std::byte>();
  });
  if (!html) return html.error();
  const Result<std::string> junit = qaJunit(document);
  if (!junit) return junit.error();
  if (const Result<void> r = writeFileWhole(out + "/report.json", json); !r) return r;
  if (const Result<void> r = writeFileWhole(out + "/junit.xml", *junit); !r) return r;
  return writeFileWhole(out + "/report.html", *html);
}

void printResult(const QaCaseResult& r) {
  for (const QaEngineResult& e : r.engines) {
    std::printf("%-5s %-6s %s\n", nameOf(e.verdict), e.engine.c_str(), r.name.c_str());
    for (const QaRow& row : e.rows)
      if (!row.pass)
        std::printf("             %s: %s, expected %s, tolerance %s %s\n", row.quantity.c_str(),
                    qaText(row.measured).c_str(), qaText(row.expected).c_str(), qaText(row.tolerance).c_str(),
                    row.unit.c_str());
  }
  std::fflush(stdout);
}

// One sentence for each case and engine that did not pass.
void reportProblems(const QaCaseResult& r) {
  for (const QaEngineResult& e : r.engines) {
    if (e.verdict == QaVerdict::Pass) continue;
    std::string names;
    for (const QaRow& row : e.rows)
      if (!row.pass && names.find(row.quantity) == std::string::npos)
        names += (names.empty() ? "" : ", ") + row.quantity;
    Error error = !names.empty()
                      ? makeError(ErrorCode::OutOfTolerance, "Out of tolerance: " + names + ".", r.name)
                      : *e.error;
    error.where = e.engine + ": " + error.where;
    (void)report(error);
  }
}

// "clinic" is the suite that comes with the program, unless a folder of that name lies here.
std::string suiteFolder(const std::string& dir) {
  std::error_code ec;
  return dir == "clinic" && !fs::exists(dir, ec) ? clinicSuiteFolder() : dir;
}

std::vector<std::string> enginesOf(const std::string& option) {
  return option == "both" ? std::vector<std::string>{"native", "gl"} : std::vector<std::string>{option};
}

int runSuite(const GlobalOptions& global, const Options& o) {
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) return report(settings.error());
  const auto first = makeSession(global);
  if (!first) return 2;
  const std::string suite = suiteFolder(o.dir);
  Result<std::vector<std::string>> found = findQaCases(suite);
  if (!found)
    return report(
        makeError(found.error().code, found.error().sentence, o.dir));  // no path of the installation
  std::vector<std::string> names = *found;
  if (!o.only.empty()) {
    for (const std::string& name : o.only)
      if (std::find(names.begin(), names.end(), name) == names.end())
        return report(invalid("--only", "The suite has no case '" + name + "'."));
    names = o.only;
  }
  if (!o.out.empty())  // before the work, not after it
    if (const Result<void> r = makeFolder(o.out + "/pictures"); !r) return report(r.error());
  const std::stop_token stop = interruptToken();
  QaRunFacts facts{suiteName(o.dir), enginesOf(o.engine), utcNow(), 0};
  const auto begin = Clock::now();
  QaRunner runner(
      *settings, [&] { return makeSession(global); }, stop);
  std::vector<QaCaseResult> results;
  for (const std::string& name : names) {
    if (stop.stop_requested())
      return report(makeError(ErrorCode::Cancelled, "The run was cancelled; no report."));
    results.push_back(runner.run(suite + "/" + name, name, facts.engines));
    if (!o.json) printResult(results.back());
    reportProblems(results.back());
  }
  facts.seconds = std::round(msSince(begin) / 10) / 100;
  const bool gl = o.engine != "native";
  const QaJson document = qaDocument(facts, qaIdentity(*first, gl, o.operatorName), results);
  int code = qaExitCode(results);
  if (!o.out.empty())
    if (const Result<void> r = writeReport(o.out, document, results); !r) code = report(r.error());
  if (o.json)
    std::cout << dumped(document);
  else
    for (const QaJson& s : document["summary"])
      std::printf("%s: %d of %d cases pass\n", s["engine"].get<std::string>().c_str(), s["passed"].get<int>(),
                  s["cases"].get<int>());
  return code;
}

int accept(const GlobalOptions& global, const Options& o) {
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) return report(settings.error());
  if (!makeSession(global)) return 2;
  QaRunner runner(
      *settings, [&] { return makeSession(global); }, interruptToken());
  const Result<QaAccepted> a = acceptQaCase(runner, suiteFolder(o.dir), o.caseName, o.reason);
  if (!a) return report(a.error());
  if (!a->changed)
    std::printf("%s: the baseline is this picture already; nothing was changed\n", o.caseName.c_str());
  else
    std::printf("%s: new baseline %s%s\n", o.caseName.c_str(), a->sha256.c_str(),
                a->kept.empty() ? "" : (", the old one is " + a->kept).c_str());
  return 0;
}

int rebuild(const Options& o) {
  Result<std::string> text = textOf(o.dir + "/report.json", "The report");
  if (!text)
    return report(makeError(ErrorCode::FileNotFound,
                            "There is no report.json here; name the --out folder of a run.", o.dir));
  const QaJson document = QaJson::parse(*text, nullptr, false);
  if (document.is_discarded())
    return report(makeError(ErrorCode::FileDamaged, "The report is not valid JSON.", o.dir + "/report.json"));
  const Result<std::string> html = qaHtml(document, sha256Of(*text), [&](const std::string& name) {
    std::vector<std::byte> bytes;
    // Names come from the file: only those that a run gives are opened.
    if (!name.starts_with("pictures/") || name.find("..") != std::string::npos) return bytes;
    if (const Result<std::string> png = textOf(o.dir + "/" + name, "The picture")) {
      const auto view = std::as_bytes(std::span(*png));
      bytes.assign(view.begin(), view.end());
    }
    return bytes;
  });
  if (!html) return report(makeError(html.error().code, html.error().sentence, o.dir + "/report.json"));
  const std::string out = (o.out.empty() ? o.dir : o.out) + "/report.html";
  if (!o.out.empty())
    if (const Result<void> r = makeFolder(o.out); !r) return report(r.error());
  if (const Result<void> r = writeFileWhole(out, *html); !r) return report(r.error());
  return 0;
}

}  // namespace

Command addQa(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand("qa", "Golden-image quality assurance: run a suite, accept a picture");
  sub->require_subcommand(1);
  CLI::App* run =
      sub->add_subcommand("run", "Run every case of a suite; exit 4 when one fails, 3 when one is damaged");
  run->add_option("DIR", o->dir, "Suite: a folder of cases, or clinic: the one that comes with the program")
      ->required();
  run->add_option("--out", o->out, "Folder for report.html, report.json, junit.xml and pictures");
  run->add_option("--engine", o->engine, "native gl both")
      ->check(CLI::IsMember({"native", "gl", "both"}))
      ->capture_default_str();
  run->add_option("--only", o->only, "Only these cases")->delimiter(',');
  run->add_option("--operator", o->operatorName, "Who ran it, for the report");
  run->add_flag("--json", o->json, "The report on standard output");
  CLI::App* acceptSub =
      sub->add_subcommand("accept", "Make the picture of one case, as drawn natively now, its baseline");
  acceptSub->add_option("DIR", o->dir, "Suite")->required();
  acceptSub->add_option("CASE", o->caseName, "Name of the case")->required();
  acceptSub->add_option("--reason", o->reason, "Why the new picture is right")->required();
  CLI::App* reportSub = sub->add_subcommand("report", "Make report.html again from report.json and pictures");
  reportSub->add_option("DIR", o->dir, "The --out folder of a run")->required();
  reportSub->add_option("--out", o->out, "Another folder for report.html");
  sub->footer(
      "Examples:\n"
      "  vernier qa run clinic --out report     is this installation right?\n"
      "  vernier qa run suite --out report\n"
      "  vernier qa run suite --engine native --only axial,mip\n"
      "  vernier qa accept suite axial --reason \"slices are now cubic; looked at beside the old one\"\n"
      "  vernier qa report report");
  return {
      sub, [&global, o, run, acceptSub, reportSub] {
        for (const CLI::App* given : {run, acceptSub, reportSub})
          if (const Result<void> values = noEmptyValues(*given); !values) return report(values.error());
        return run->parsed() ? runSuite(global, *o) : acceptSub->parsed() ? accept(global, *o) : rebuild(*o);
      }};
}

}  // namespace vernier::app
