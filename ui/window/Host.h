// SPDX-License-Identifier: GPL-3.0-or-later
// Host: the window itself (GLFW, OpenGL 3.3) around Gui and Desk. Everything on the main thread; only wake()
// may be called from others. Draws when something has changed and sleeps otherwise.
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "Gui.h"
#include "Input.h"

struct GLFWwindow;

namespace vernier::ui {

struct HostOptions {
  app::SessionOptions session;
  int width = 1280, height = 800;  // of the window at 100 %
  double scale = 0;                // 1..3; 0: the monitor's
  bool visible = true;
  bool notice = false;                          // show the notice of the first start
  std::function<std::string()> noticeAccepted;  // returns what is to be shown, if anything
};

class Host {
 public:
  // WindowUnavailable with a sentence: no display, no OpenGL 3.3.
  static Result<std::unique_ptr<Host>> make(const HostOptions&);
  ~Host();

  Desk& desk() { return *desk_; }
  Gui& gui() { return *gui_; }
  double scale() const { return theme_.scale; }

  void add(InputEvent e) { input_.add(std::move(e)); }
  // Takes what is ready, lets the input of one frame act, draws.
  void frame();
  // Until nothing is loading, drawn or waiting; false after `limit_s`.
  bool settle(double limit_s);
  Picture screenshot();  // of the last frame
  // Until the window is closed, or `goOn` (asked after each event) says no.
  void run(const std::function<bool()>& goOn = {});

 private:
  Host() = default;
  Result<void> openWindow(const HostOptions&);
  void applyScale(float);
  void feed(const InputEvent&);
  void layOut();  // what the frame shows, without drawing it
  void callbacks();

  GLFWwindow* window_ = nullptr;
  bool glfw_ = false, imguiGl_ = false;
  Theme theme_;
  float fixedScale_ = 0;
  double lastFrame_s_ = 0;
  int framesWanted_ = 2;
  std::atomic<bool> woken_ = false;  // by a thread that has something ready
  std::uint64_t drawnChanges_ = 0;   // Desk::changes() that the last frame has drawn
  std::string fontText_;             // characters that the fonts have beyond the usual ones
  InputQueue input_;
  std::unique_ptr<Textures> textures_;
  std::unique_ptr<Desk> desk_;
  std::unique_ptr<Gui> gui_;
};

}  // namespace vernier::ui
