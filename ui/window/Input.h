// SPDX-License-Identifier: GPL-3.0-or-later
// Events of pointer and keyboard, in the order they came. The window's callbacks and the tests feed the same
// queue. Each frame takes as many as can be seen by one frame: a button that goes down and up, or a pointer
// that moves on after a click, waits for the next one, so that no click is lost however slow frames are.
#pragma once
#include <deque>
#include <string>
#include <utility>
#include <vector>

namespace vernier::ui {

struct InputEvent {
  enum class Kind { Pointer, PointerLeft, Button, Wheel, Key, Text, Drop } kind = Kind::Pointer;
  double x = 0, y = 0;  // Pointer: framebuffer px; Wheel: notches, y up
  int code = 0;         // Button: 0 left, 1 right, 2 middle; Key: GLFW's number; Text: Unicode
  bool down = false;
  std::vector<std::string> paths;  // Drop
};

class InputQueue {
 public:
  void add(InputEvent e) { events_.push_back(std::move(e)); }
  bool empty() const { return events_.empty(); }
  // Those of the next frame.
  std::vector<InputEvent> next();
  // Where the pointer went on its way through the last next(), in order, its last place included: an outline
  // that is drawn by hand keeps its curves however slow frames are.
  const std::vector<std::pair<double, double>>& way() const { return way_; }

 private:
  std::vector<std::pair<double, double>> way_;
  std::deque<InputEvent> events_;
};

}  // namespace vernier::ui
