// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/measure/MeasurementList.h"

namespace vernier::measure {

std::size_t MeasurementList::indexOf(const std::string& id) const {
  for (std::size_t n = 0; n < now_.size(); ++n)
    if (now_[n]->what.id == id) return n;
  return now_.size();
}

const Entry* MeasurementList::find(const std::string& id) const {
  const std::size_t n = indexOf(id);
  return n < now_.size() ? now_[n].get() : nullptr;
}

std::vector<Entry> MeasurementList::entries() const {
  std::vector<Entry> out;
  for (const auto& e : now_) out.push_back(*e);
  return out;
}

void MeasurementList::step() {
  before_.push_back(now_);
  if (before_.size() > kMostSteps) before_.erase(before_.begin());
  after_.clear();
  dragged_.clear();
}

std::string MeasurementList::add(Measurement m) {
  step();
  while (m.id.empty() || find(m.id)) m.id = "m" + std::to_string(nextId_++);
  now_.push_back(std::make_shared<const Entry>(Entry{m, {}, ""}));
  return m.id;
}

bool MeasurementList::change(const Measurement& m, bool goesOn) {
  const std::size_t n = indexOf(m.id);
  if (n == now_.size() || now_[n]->what == m) return false;
  if (!goesOn || dragged_ != m.id || !after_.empty()) step();
  dragged_ = m.id;
  now_[n] = std::make_shared<const Entry>(Entry{m, {}, ""});
  return true;
}

bool MeasurementList::remove(const std::string& id) {
  const std::size_t n = indexOf(id);
  if (n == now_.size()) return false;
  step();
  now_.erase(now_.begin() + static_cast<std::ptrdiff_t>(n));
  return true;
}

void MeasurementList::clear() {
  if (now_.empty()) return;
  step();
  now_.clear();
}

void MeasurementList::load(std::vector<Entry> entries) {
  now_.clear();
  before_.clear();
  after_.clear();
  dragged_.clear();
  for (Entry& e : entries) {
    while (e.what.id.empty() || find(e.what.id)) e.what.id = "m" + std::to_string(nextId_++);
    now_.push_back(std::make_shared<const Entry>(std::move(e)));
  }
}

void MeasurementList::undo() {
  if (before_.empty()) return;
  after_.push_back(std::move(now_));
  now_ = std::move(before_.back());
  before_.pop_back();
  dragged_.clear();
}

void MeasurementList::redo() {
  if (after_.empty()) return;
  before_.push_back(std::move(now_));
  now_ = std::move(after_.back());
  after_.pop_back();
  dragged_.clear();
}

void MeasurementList::setResult(const std::string& id, const Result<Measured>& r) {
  const std::size_t n = indexOf(id);
  if (n == now_.size()) return;
  Entry e{now_[n]->what, {}, ""};
  if (r)
    e.said = *r;
  else
    e.refused =
        r.error().sentence.empty() ? std::string(generalSentence(r.error().code)) : r.error().sentence;
  now_[n] = std::make_shared<const Entry>(std::move(e));
}

}  // namespace vernier::measure
