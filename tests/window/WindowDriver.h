// SPDX-License-Identifier: GPL-3.0-or-later
// Drives the real window on a virtual display: events go in between frames, as people would make them.
#pragma once
#include <imgui.h>

#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "Host.h"
#include "VirtualDisplay.h"

namespace vernier::ui::test {

class WindowDriver {
 public:
  explicit WindowDriver(HostOptions options = {}) {
    if (display_.display().empty()) return;
    if (options.scale == 0) options.scale = 1;
    Result<std::unique_ptr<Host>> made = Host::make(options);
    if (made)
      host_ = std::move(*made);
    else
      std::cout << made.error().text() << "\n";
  }
  // Without Xvfb or OpenGL 3.3 a test says so and passes, unless they are required.
  bool here() const {
    if (!host_) {
      std::cout << "[  NOTE    ] no virtual display with OpenGL 3.3 here: not checked\n";
      const char* required = std::getenv("VERNIER_REQUIRE_GL");
      EXPECT_FALSE(required && *required == '1') << "the set-up should have brought Xvfb and OpenGL";
    }
    return host_ != nullptr;
  }
  Host& host() { return *host_; }
  Desk& desk() { return host_->desk(); }
  Workspace& workspace() { return host_->desk().workspace(); }

  bool settle(double limit_s = 30) { return host_->settle(limit_s); }
  void open(const std::string& path) { open(std::vector<std::string>{path}); }
  void open(const std::vector<std::string>& paths) {
    InputEvent e;
    e.kind = InputEvent::Kind::Drop;
    e.paths = paths;
    host_->add(e);
    EXPECT_TRUE(settle(60));
  }
  void move(double x, double y) { send({InputEvent::Kind::Pointer, x, y, 0, false, {}}); }
  void button(int b, bool down) { send({InputEvent::Kind::Button, 0, 0, b, down, {}}); }
  void wheel(double notches) { send({InputEvent::Kind::Wheel, 0, notches, 0, false, {}}); }
  void key(int k, bool ctrl = false) {
    if (ctrl) send({InputEvent::Kind::Key, 0, 0, GLFW_KEY_LEFT_CONTROL, true, {}});
    send({InputEvent::Kind::Key, 0, 0, k, true, {}});
    send({InputEvent::Kind::Key, 0, 0, k, false, {}});
    if (ctrl) send({InputEvent::Kind::Key, 0, 0, GLFW_KEY_LEFT_CONTROL, false, {}});
  }
  void hold(int k, bool down) { send({InputEvent::Kind::Key, 0, 0, k, down, {}}); }
  void type(const std::string& ascii) {
    for (const char c : ascii) send({InputEvent::Kind::Text, 0, 0, c, false, {}});
  }
  void click(double x, double y, int b = 0) {
    move(x, y);
    button(b, true);
    button(b, false);
  }
  // Frames of a software renderer on a busy machine are slow: the two clicks may be far apart in time. Two
  // double clicks must be some pixels apart, else the third click belongs to the first two.
  void doubleClick(double x, double y) {
    ImGui::GetIO().MouseDoubleClickTime = 10;
    click(x, y);
    click(x, y);
  }
  void dragBy(double x, double y, double dx, double dy, int b = 0, int steps = 5) {
    move(x, y);
    button(b, true);
    for (int k = 1; k <= steps; ++k) move(x + dx * k / steps, y + dy * k / steps);
    button(b, false);
  }
  // The window's own loop, until nothing has been loaded, drawn or put in for so long.
  void runUntilIdleFor(double quiet_s) {
    std::atomic<bool> over = false;
    std::thread clock([&] {
      for (double idle_s = 0; idle_s < quiet_s; idle_s = host_->desk().idle() ? idle_s + 0.05 : 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      over = true;
      glfwPostEmptyEvent();
    });
    // The measured picture is taken here, as at the end of a frame that has drawn: the loop must see it.
    int turns = 0;
    host_->run([&] {
      for (++turns; turns > 2 && !host_->desk().idle(); host_->desk().update())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return !over;
    });
    clock.join();
  }
  Picture screenshot() {
    EXPECT_TRUE(settle());
    return host_->screenshot();
  }

 private:
  void send(InputEvent e) {
    host_->add(std::move(e));
    host_->frame();
  }
  vernier::test::VirtualDisplay display_;
  std::unique_ptr<Host> host_;
};

}  // namespace vernier::ui::test
