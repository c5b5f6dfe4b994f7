// SPDX-License-Identifier: GPL-3.0-or-later
#include "Input.h"

#include <algorithm>

namespace vernier::ui {

std::vector<InputEvent> InputQueue::next() {
  using Kind = InputEvent::Kind;
  std::vector<InputEvent> out;
  way_.clear();
  const auto taken = [&](auto&& test) { return std::any_of(out.begin(), out.end(), test); };
  while (!events_.empty()) {
    const InputEvent& e = events_.front();
    const bool moves = e.kind == Kind::Pointer || e.kind == Kind::PointerLeft;
    const bool waits =
        (moves &&
         taken([](const InputEvent& o) { return o.kind == Kind::Button || o.kind == Kind::Wheel; })) ||
        ((e.kind == Kind::Button || e.kind == Kind::Key) &&
         taken([&](const InputEvent& o) { return o.kind == e.kind && o.code == e.code; })) ||
        // Keys go up after what was done while they were down: Ctrl must be seen with the key that it
        // changes.
        (e.kind == Kind::Key && !e.down &&
         taken([](const InputEvent& o) { return o.kind == Kind::Key && o.down; })) ||
        (e.kind == Kind::Key &&
         taken([](const InputEvent& o) { return o.kind == Kind::Button || o.kind == Kind::Wheel; })) ||
        (e.kind == Kind::Wheel && taken([](const InputEvent& o) { return o.kind == Kind::Button; })) ||
        (e.kind == Kind::Drop && !out.empty());
    if (waits) break;
    if (e.kind == Kind::Pointer) way_.emplace_back(e.x, e.y);
    if (e.kind == Kind::Pointer && !out.empty() && out.back().kind == Kind::Pointer)
      out.back() = e;
    else
      out.push_back(e);
    events_.pop_front();
  }
  return out;
}

}  // namespace vernier::ui
