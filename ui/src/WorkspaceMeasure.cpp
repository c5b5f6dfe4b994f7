// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements on the desktop: edits like all others, with the same undo.
#include <algorithm>

#include "Workspace.h"

namespace vernier::ui {

const Drawn* Workspace::measurement(const std::string& id) const {
  const auto& all = now_.measurements;
  const auto it = std::find_if(all.begin(), all.end(), [&](const Drawn& d) { return d.what.id == id; });
  return it == all.end() ? nullptr : &*it;
}

std::string Workspace::addMeasurement(int document, measure::Measurement m) {
  for (int n = 1; m.id.empty() || measurement(m.id); ++n) m.id = "m" + std::to_string(n);
  Arrangement& a = edit(Gesture::Measure, -1);
  a.measurements.push_back({document, m});
  return m.id;
}

void Workspace::changeMeasurement(const measure::Measurement& m) {
  const Drawn* before = measurement(m.id);
  if (!before || before->what == m) return;
  const auto n = static_cast<std::size_t>(before - now_.measurements.data());
  edit(Gesture::Measure, -1).measurements[n].what = m;
}

void Workspace::removeMeasurement(const std::string& id) {
  if (!measurement(id)) return;
  std::erase_if(edit(Gesture::Measure, -1).measurements, [&](const Drawn& d) { return d.what.id == id; });
}

}  // namespace vernier::ui
