// SPDX-License-Identifier: GPL-3.0-or-later
// What a window manager does to the windows of other programs. X11 only; functions open a connection of their
// own.
#pragma once
#include <string>

namespace vernier::ui::test {

// The shown top window whose title is `title`, waited for; 0 when none came.
unsigned long findWindow(const std::string& display, const std::string& title, double limit_s);

// The message that a click on the title bar's cross sends (ICCCM 4.2.8.1). False without a connection.
bool askToClose(const std::string& display, unsigned long window);

}  // namespace vernier::ui::test
