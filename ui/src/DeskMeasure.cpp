// SPDX-License-Identifier: GPL-3.0-or-later
// What the desktop's measurements say, and their files.
#include "Desk.h"
#include "MeasureSources.h"
#include "OptionChecks.h"
#include "OptionText.h"
#include "PluginHost.h"
#include "vernier/measure/MeasurementJson.h"
#include "vernier/picture/WriteFile.h"

namespace vernier::ui {

const Result<measure::Measured>* Desk::said(const Drawn& d) {
  if (const auto it = said_.find(d.what.id); it != said_.end() && it->second.of == d)
    return &it->second.result;
  const Document* document = this->document(d.document);
  if (!document) return nullptr;
  if (d.what.on.space == measure::Space::Patient && !document->session->readyVolume(d.what.on.source))
    return nullptr;
  Result<measure::Measured> result = measure::measure(d.what, app::measureSources(*document->session, {}));
  return &said_.insert_or_assign(d.what.id, Said{d, std::move(result)}).first->second.result;
}

Result<void> Desk::mayMeasure(int number) const {
  const Document* d = document(number);
  if (!d) return makeError(ErrorCode::NothingToLoad, "Open a series first.");
  return app::measuringPlugin(*d->session);
}

Result<void> Desk::mayLens(int number) const {
  const Document* d = document(number);
  if (!d) return makeError(ErrorCode::NothingToLoad, "Open a series first.");
  for (const app::PluginInfo& p : d->session->plugins())
    if (p.name == "lens" && p.state == app::PluginState::Loaded) return {};
  return makeError(ErrorCode::PluginMissing,
                   "Lenses need the plugin `lens`; `vernier plugins` tells where plugins are looked for.",
                   "lens");
}

Result<void> Desk::saveMeasurements(int number, const std::string& path) {
  Document* d = document(number);
  if (!d) return makeError(ErrorCode::NothingToLoad, "Open a series first.");
  std::vector<measure::Entry> entries;
  for (const Drawn& m : workspace_.now().measurements) {
    if (m.document != number) continue;
    measure::Entry e{m.what, {}, ""};
    const Result<measure::Measured>* result = said(m);
    if (result && *result)
      e.said = **result;
    else if (result)
      e.refused = result->error().sentence;
    entries.push_back(std::move(e));
  }
  if (Result<void> r = app::keepSources(d->session.get(), {}, path, "Save"); !r) return r;
  return writeFileWhole(path, measure::writeMeasurements(entries));
}

Result<void> Desk::loadMeasurements(int number, const std::string& path) {
  if (Result<void> r = mayMeasure(number); !r) return r;
  const Result<std::string> text = app::textOf(path, "The list of measurements");
  if (!text) return text.error();
  const Result<std::vector<measure::Entry>> entries = measure::parseMeasurements(*text);
  if (!entries) return entries.error();
  workspace_.beginDrag();  // one step of undo for all
  for (const measure::Entry& e : *entries) {
    measure::Measurement m = e.what;
    if (m.on.source.empty()) m.on.source = workspace_.tile(workspace_.now().active).source.name;
    workspace_.addMeasurement(number, std::move(m));
  }
  workspace_.endDrag();
  return {};
}

}  // namespace vernier::ui
