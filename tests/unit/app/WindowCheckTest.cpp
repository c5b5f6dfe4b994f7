// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a window can be opened, told without one: each way in which it cannot has its sentence. The way in
// which it can is tested on a virtual display by tests/e2e.
#include "WindowCheck.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace vernier::app {
namespace {

using ::testing::HasSubstr;

class WindowCheck : public ::testing::Test {
 protected:
  WindowCheck() {
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
  }
  static void expectNoWindow(const WindowCheckOptions& options, const std::string& says) {
    const auto facts = checkWindow(options);
    ASSERT_FALSE(facts.ok());
    EXPECT_EQ(facts.error().code, ErrorCode::WindowUnavailable);
    EXPECT_EQ(exitCode(facts.error().code), 1);
    EXPECT_EQ(facts.error().where, "window");
    EXPECT_THAT(facts.error().sentence, HasSubstr(says));
  }
};

TEST_F(WindowCheck, NoDisplay) { expectNoWindow({}, "There is no display"); }

TEST_F(WindowCheck, NoGlfw) {
  ::setenv("DISPLAY", ":7", 1);
  expectNoWindow({"libno-such-glfw.so"}, "install libglfw3");
}

TEST_F(WindowCheck, ALibraryThatIsNoGlfw) {
  ::setenv("DISPLAY", ":7", 1);
  expectNoWindow({"libm.so.6"}, "too old");
}

TEST_F(WindowCheck, ADisplayThatCannotBeOpened) {
  ::setenv("DISPLAY", ":7654", 1);
  expectNoWindow({}, "X11 :7654 cannot be opened");
}

}  // namespace
}  // namespace vernier::app
