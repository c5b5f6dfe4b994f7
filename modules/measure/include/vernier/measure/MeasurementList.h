// SPDX-License-Identifier: GPL-3.0-or-later
// The measurements of a window or of a file, in order, with undo and redo. Results stand beside them and are
// no steps of their own. For one thread.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vernier/measure/Measured.h"
#include "vernier/measure/Measurement.h"

namespace vernier::measure {

struct Entry {
  Measurement what;
  std::optional<Measured> said;
  std::string refused;  // why there is no result, one sentence; empty when there is one or none was asked for
  friend bool operator==(const Entry&, const Entry&) = default;
};

class VERNIER_API MeasurementList {
 public:
  static constexpr std::size_t kMostSteps = 500;

  std::size_t size() const { return now_.size(); }
  const Entry& at(std::size_t n) const { return *now_[n]; }
  const Entry* find(const std::string& id) const;  // nullptr: none of this name
  std::vector<Entry> entries() const;

  // Gives it an id where it has none or one that is taken; returns the id.
  std::string add(Measurement);
  // `goesOn`: the same drag as the step before, so that undo takes both back at once. false: no such id, or
  // nothing changed.
  bool change(const Measurement&, bool goesOn = false);
  bool remove(const std::string& id);
  void clear();
  // From a file: the steps before are forgotten.
  void load(std::vector<Entry>);

  bool canUndo() const { return !before_.empty(); }
  bool canRedo() const { return !after_.empty(); }
  void undo();
  void redo();

  // Of the measurement as it stands now; lost by the next change of it.
  void setResult(const std::string& id, const Result<Measured>&);

 private:
  using List = std::vector<std::shared_ptr<const Entry>>;
  void step();
  std::size_t indexOf(const std::string& id) const;
  List now_;
  std::vector<List> before_, after_;
  std::string dragged_;  // id of the last change, for goesOn
  std::uint64_t nextId_ = 1;
};

}  // namespace vernier::measure
