// SPDX-License-Identifier: GPL-3.0-or-later
// The one place that maps "vernier-info/1" onto the keys of data/expected/*.json (its README has their
// schema).
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace vernier::test {
using Json = nlohmann::json;

struct Facts {
  Json expected, info;

  // Files whose verdict is "either": tools disagree whether they can be read at all.
  bool undecided(const std::string& file) const;
  // Objects and files of info by name.
  const Json* object(const std::string& file) const;
  const Json* file(const std::string& file) const;
  // All findings of a code: of the set, of series and of stacks; those of series carry "series".
  std::vector<Json> findings(const std::string& code) const;
  const Json* series(const std::string& studyUid, const std::string& seriesUid) const;
};

// Scans and decodes the folder, with the probes that the expected file asks for.
Facts factsOf(const std::string& folder);

// `expected`'s objects that its `totals` count, without the undecided ones when asked for; and ours likewise.
struct Totals {
  std::size_t files = 0, objects = 0, images = 0, frames = 0, distinctUids = 0, notDicom = 0, directories = 0;
  friend bool operator==(const Totals&, const Totals&) = default;
};
Totals expectedTotals(const Facts&, bool withUndecided);
Totals infoTotals(const Facts&, bool withUndecided);

}  // namespace vernier::test
