// SPDX-License-Identifier: GPL-3.0-or-later
// Can a window be opened here, and if not, why. `vernier view` asks before it opens one, `vernier doctor`
// tells: one function, so that both say the same sentence. Nothing is shown: the window that carries the
// context stays hidden and is gone when the function returns. GLFW is loaded on demand, so Vernier starts
// where it is absent.
#pragma once
#include <string>

#include "vernier/base/Result.h"

namespace vernier::app {

struct WindowFacts {
  std::string display;            // "X11 :0", "Wayland wayland-0"
  std::string version, renderer;  // of the window's OpenGL
  bool software = false;          // drawn by the processor (llvmpipe and the like)
  double scale = 1;               // pixels per point of the desktop's setting: 2 on a HiDPI screen
};

struct WindowCheckOptions {
  std::string glfwLibrary;  // "" = the system's; a path is taken as it is
};

// Main thread only. WindowUnavailable when there is no display, the display cannot be opened or GLFW is not
// installed; GlUnavailable when the display's OpenGL gives no 3.3 core context. Error::where is "window".
Result<WindowFacts> checkWindow(const WindowCheckOptions& = {});

}  // namespace vernier::app
