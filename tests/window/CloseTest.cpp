// SPDX-License-Identifier: GPL-3.0-or-later
// The program as its user runs it: closed at any moment and in any state it ends with exit code 0 and without
// a word; where it cannot run it says why in one sentence, the same that `vernier doctor` says.
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "VirtualDisplay.h"
#include "WindowStudies.h"
#include "XWindow.h"
#include "vernier/base/Result.h"

namespace vernier::ui {
namespace {

namespace fs = std::filesystem;
using test::study;
using vernier::test::ProgramRun;
using vernier::test::runProgram;
using vernier::test::TempDir;
using vernier::test::VirtualDisplay;

bool here(const VirtualDisplay& display) {
  if (!display.display().empty()) return true;
  std::cout << "[  NOTE    ] no virtual display here: not checked\n";
  const char* required = std::getenv("VERNIER_REQUIRE_GL");
  EXPECT_FALSE(required && *required == '1') << "the set-up should have brought Xvfb";
  return false;
}

// `vernier view`, and what is done to it meanwhile.
class Viewer {
 public:
  Viewer(std::vector<std::string> inputs, std::vector<std::string> environment) {
    inputs.insert(inputs.begin(), {VERNIER_PROGRAM, "view"});
    thread_ = std::thread([this, inputs, environment] { run_ = runProgram(inputs, 60, environment); });
  }
  const ProgramRun& end() {
    if (thread_.joinable()) thread_.join();
    return run_;
  }
  ~Viewer() { end(); }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

 private:
  ProgramRun run_;
  std::thread thread_;
};

void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

void expectSilentEnd(const ProgramRun& run) {
  EXPECT_EQ(run.exitCode, 0) << "signal " << run.signal << (run.timedOut ? ", still there after 60 s" : "");
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(run.out, "");
}

class Close : public ::testing::Test {
 protected:
  // A home of its own in which the notice was seen.
  Close() { write(home_.path() / "vernier", "{\"notice_seen\": true}"); }
  static void write(const fs::path& folder, const std::string& config) {
    fs::create_directories(folder);
    std::ofstream(folder / "config.json") << config;
  }
  std::vector<std::string> environment() const { return {"XDG_CONFIG_HOME=" + home_.path().string()}; }
  void xdotool(const std::vector<std::string>& words) {
    std::vector<std::string> all{"/usr/bin/xdotool"};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_EQ(runProgram(all, 20).exitCode, 0);
  }
  TempDir home_, dir_;
  VirtualDisplay display_;
};

TEST_F(Close, AtAnyMomentOfLoading) {
  if (!here(display_)) return;
  const std::string path = study(dir_, "ct-head", {"--set", "scale=0.5"});
  for (int moment = 0; moment < 20; ++moment) {
    SCOPED_TRACE(moment);
    Viewer viewer({path}, environment());
    const auto window = test::findWindow(display_.display(), "Vernier", 20);
    ASSERT_NE(window, 0u);
    sleep_ms(25 * moment);
    EXPECT_TRUE(test::askToClose(display_.display(), window));
    expectSilentEnd(viewer.end());
  }
}

TEST_F(Close, InAnyState) {
  if (!here(display_)) return;
  const std::string path = study(dir_, "small-ct");
  const std::vector<std::vector<std::string>> states = {
      {"key", "F4"},  // four pictures, the volume not yet there
      {"key", "F1"},  // help
      {"mousemove", "120", "64", "click", "1", "type", "/a/path"},
      {"mousemove", "780", "420", "mousedown", "1", "mousemove_relative", "30", "10"},  // in a drag
      {"mousemove", "740", "20", "mousedown", "1", "mouseup", "1"},                     // the menu open
      {"mousemove", "780", "420", "click", "5", "click", "5", "key", "i", "key", "F3"}};
  for (std::size_t s = 0; s < states.size(); ++s)
    for (const int settled_ms : {0, 700}) {
      SCOPED_TRACE(s);
      Viewer viewer({path}, environment());
      const auto window = test::findWindow(display_.display(), "Vernier", 20);
      ASSERT_NE(window, 0u);
      sleep_ms(settled_ms);
      xdotool({"windowfocus", std::to_string(window)});
      xdotool(states[s]);
      EXPECT_TRUE(test::askToClose(display_.display(), window));
      expectSilentEnd(viewer.end());
      xdotool({"mouseup", "1"});
    }
}

TEST_F(Close, BehindTheNoticeAndWithoutAnInput) {
  if (!here(display_)) return;
  write(home_.path() / "vernier", "{}");
  Viewer viewer({}, environment());
  const auto window = test::findWindow(display_.display(), "Vernier", 20);
  ASSERT_NE(window, 0u);
  sleep_ms(200);
  EXPECT_TRUE(test::askToClose(display_.display(), window));
  expectSilentEnd(viewer.end());
}

TEST_F(Close, CtrlQ) {
  if (!here(display_)) return;
  Viewer viewer({study(dir_, "small-ct")}, environment());
  const auto window = test::findWindow(display_.display(), "Vernier", 20);
  ASSERT_NE(window, 0u);
  xdotool({"windowfocus", std::to_string(window), "key", "ctrl+q"});
  expectSilentEnd(viewer.end());
}

// The folder goes, or a file of it is cut short, while it is being read.
TEST_F(Close, WhatIsReadGoesAway) {
  if (!here(display_)) return;
  for (int moment = 0; moment < 10; ++moment) {
    SCOPED_TRACE(moment);
    const fs::path path = study(dir_, "ct-head", {"--set", "scale=0.5"});
    Viewer viewer({path.string()}, environment());
    const auto window = test::findWindow(display_.display(), "Vernier", 20);
    ASSERT_NE(window, 0u);
    sleep_ms(30 * (moment / 2));
    if (moment % 2 == 0)
      fs::rename(path, dir_.path() / ("elsewhere" + std::to_string(moment)));
    else
      for (const auto& file : fs::directory_iterator(path)) fs::resize_file(file, 700);
    sleep_ms(250);
    xdotool({"windowfocus", std::to_string(window), "mousemove", "780", "420", "click", "5", "key", "F4"});
    sleep_ms(100);
    EXPECT_TRUE(test::askToClose(display_.display(), window));
    expectSilentEnd(viewer.end());
    fs::remove_all(path);
  }
}

// One sentence, exit code 1, and doctor says the same sentence.
void expectNoWindow(const std::vector<std::string>& environment, const std::string& says) {
  const ProgramRun view = runProgram({VERNIER_PROGRAM, "view"}, 30, environment);
  EXPECT_EQ(view.exitCode, 1);
  EXPECT_EQ(view.lines(view.err), 1) << view.err;
  EXPECT_NE(view.err.find(says), std::string::npos) << view.err;
  const ProgramRun doctor = runProgram({VERNIER_PROGRAM, "doctor"}, 30, environment);
  EXPECT_EQ(doctor.exitCode, 0);
  const std::size_t at = view.err.find("window: ");
  ASSERT_NE(at, std::string::npos) << view.err;
  const std::string sentence = view.err.substr(at + 8, view.err.size() - at - 9);
  EXPECT_NE(doctor.out.find("no: " + sentence), std::string::npos) << doctor.out;
}

TEST(CannotOpen, WithoutADisplay) { expectNoWindow({"DISPLAY=", "WAYLAND_DISPLAY="}, "There is no display"); }

TEST(CannotOpen, ADisplayThatIsNotThere) {
  expectNoWindow({"DISPLAY=:7654", "WAYLAND_DISPLAY="}, "cannot be opened");
}

TEST(CannotOpen, WithoutOpenGl33) {
  const VirtualDisplay display;
  if (!here(display)) return;
  expectNoWindow({"MESA_GL_VERSION_OVERRIDE=2.1"}, "no OpenGL 3.3");
}

TEST(CannotOpen, ADisplayWithoutOpenGl) {
  const VirtualDisplay display("1300x900x24", false);
  if (!here(display)) return;
  expectNoWindow({}, "no OpenGL 3.3");
}

// A home that cannot be written costs the settings, not the window; doctor and window say the same.
TEST_F(Close, AHomeThatCannotBeWritten) {
  if (!here(display_)) return;
  const std::vector<std::string> environment{"XDG_CONFIG_HOME=/dev/null/home"};
  Viewer viewer({}, environment);
  const auto window = test::findWindow(display_.display(), "Vernier", 20);
  ASSERT_NE(window, 0u);
  sleep_ms(200);
  xdotool({"windowfocus", std::to_string(window), "key", "Return"});
  sleep_ms(200);
  EXPECT_TRUE(test::askToClose(display_.display(), window));
  expectSilentEnd(viewer.end());
  const ProgramRun doctor = runProgram({VERNIER_PROGRAM, "doctor"}, 30, environment);
  EXPECT_EQ(doctor.exitCode, 0);
  EXPECT_NE(doctor.out.find("no: The settings folder cannot be written"), std::string::npos) << doctor.out;
}

}  // namespace
}  // namespace vernier::ui
