// SPDX-License-Identifier: GPL-3.0-or-later
// vernier measure: what a list of measurements says of an input.
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "Cli.h"
#include "MeasureSources.h"
#include "OptionChecks.h"
#include "OptionText.h"
#include "vernier/measure/MeasurementJson.h"
#include "vernier/picture/WriteFile.h"

namespace vernier::app {
namespace {

struct Options {
  std::vector<std::string> inputs, surfaces;
  std::string spec, series, out, sr;
  bool json = false;
};

Result<void> openAll(Session& session, const Options& o, const GlobalOptions& global) {
  const std::stop_token stop = interruptToken();
  if (Result<void> r = session.open(o.inputs, terminalProgress(global), stop); !r) return r;
  const bool surfacesOnly =
      std::all_of(o.inputs.begin(), o.inputs.end(), [](const std::string& p) { return looksLikeSurface(p); });
  std::vector<std::string> surfaces = o.surfaces;
  if (surfacesOnly) surfaces.insert(surfaces.begin(), o.inputs.begin(), o.inputs.end());
  for (const std::string& path : surfaces)
    if (const auto added = session.addSurface(path, stop); !added) return added.error();
  if (surfacesOnly) return {};
  const Result<StackChoice> choice = session.choose(o.series);
  if (!choice) return choice.error();
  session.use(*choice);
  return {};
}

Result<std::vector<measure::Entry>> readSpec(const std::string& path) {
  const Result<std::string> text = textOf(path, "The list of measurements");
  if (!text) return text.error();
  Result<std::vector<measure::Entry>> list = measure::parseMeasurements(*text);
  if (list) return list;
  Error e = list.error();
  e.where = "--spec" + (e.where.empty() ? "" : " " + e.where);
  return e;
}

void print(const measure::Entry& e) {
  const std::string name = e.what.id + " " + measure::kindOf(e.what.shape) +
                           (e.what.label.empty() ? "" : " \"" + e.what.label + "\"");
  if (!e.said) {
    std::printf("%s: refused: %s\n", name.c_str(), e.refused.c_str());
    return;
  }
  std::string line = name + ":";
  for (std::size_t n = 0; n < e.said->quantities.size(); ++n) {
    const measure::Quantity& q = e.said->quantities[n];
    line += (n > 0 ? ", " : " ") + q.name + " " + measure::displayText(q);
  }
  if (e.said->values) line += ", " + measure::displayStatistics(*e.said);
  if (!e.said->quantities.empty()) line += "; " + e.said->originText;
  for (const std::string& note : e.said->notes) line += "; " + note;
  std::printf("%s\n", line.c_str());
}

int run(const GlobalOptions& global, const Options& o) {
  if (!o.sr.empty())
    return report(makeError(ErrorCode::NotBuiltYet,
                            "Structured reports are not built yet; --out writes the measurements as JSON.",
                            "--sr"));
  // The list first: a mistake in it needs no study to be found.
  const Result<std::vector<measure::Entry>> spec = readSpec(o.spec);
  if (!spec) return report(spec.error());
  const auto session = makeSession(global);
  if (!session) return 2;
  if (const Result<void> r = measuringPlugin(*session); !r) return report(r.error());
  if (const Result<void> r = openAll(*session, o, global); !r) return report(r.error());
  for (const std::string& file : o.inputs)
    if (const Result<void> r = keepSources(session.get(), {file}, o.out, "--out"); !r)
      return report(r.error());
  measure::MeasurementList list;
  list.load(*spec);
  const measure::Sources sources = measureSources(*session, interruptToken());
  std::optional<Error> first;
  for (std::size_t n = 0; n < list.size(); ++n) {
    const Result<measure::Measured> said = measure::measure(list.at(n).what, sources, interruptToken());
    if (!said && said.error().code == ErrorCode::Cancelled) return report(said.error());
    if (!said && !first) {
      first = said.error();
      first->where = list.at(n).what.id + (first->where.empty() ? "" : " " + first->where);
    }
    list.setResult(list.at(n).what.id, said);
  }
  const std::string json = measure::writeMeasurements(list.entries());
  if (!o.out.empty())
    if (const Result<void> r = writeFileWhole(o.out, json); !r) return report(r.error());
  if (o.json)
    std::cout << json << std::flush;
  else
    for (std::size_t n = 0; n < list.size(); ++n) print(list.at(n));
  if (!o.json && list.size() > 0)
    std::printf("+/- is expanded uncertainty, k = 2; %s\n", measure::kNotIncluded);
  return first ? report(*first) : 0;
}

}  // namespace

Command addMeasure(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand(
      "measure", "Lengths, angles, regions, distances and volumes, each with its uncertainty");
  sub->add_option("INPUT", o->inputs, "Files or folders: DICOM, volume files, surfaces (docs/files.md)")
      ->required();
  sub->add_option("--spec", o->spec, "What to measure, JSON (docs/measurements.md)")->required();
  sub->add_option("--series", o->series,
                  "Which series a source of \"\" means: UID, name or number in `vernier info`");
  sub->add_option("--surface", o->surfaces, "Surface file that measurements name (repeatable)");
  sub->add_option("--out", o->out, "Write the list with its results, JSON");
  sub->add_flag("--json", o->json, "The same on standard output");
  sub->add_option("--sr", o->sr, "Write a DICOM structured report (not built yet)");
  sub->footer(
      "Example of a list:\n"
      "  {\"schema\": 1, \"measurements\": [\n"
      "    {\"kind\": \"length\", \"space\": \"patient\", \"points\": [[-30, -30, -30], [30, -30, -30]]},\n"
      "    {\"kind\": \"ellipse\", \"space\": \"image\", \"frame\": 11, \"points\": [[20, 20], [40, 32]]}]}\n"
      "Examples:\n"
      "  vernier measure STUDY --spec list.json\n"
      "  vernier measure STUDY --series 2 --spec list.json --json\n"
      "  vernier measure head.nrrd --surface screw.stl --spec distances.json --out measured.json");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
