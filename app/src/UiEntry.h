// SPDX-License-Identifier: GPL-3.0-or-later
// The border between the program and the library of the window: libvernier_ui.so is opened only by the
// commands that show something, so that the program starts where GLFW, X or GL are absent. Both are of one
// build: the ABI id is compared before anything else is called. Nothing may be thrown across.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "Session.h"

namespace vernier::app {

struct UiStart {
  std::vector<std::string> paths;
  const SessionOptions* session = nullptr;
  int width = 0, height = 0;  // of the window at 100 %; 0: the usual
  double scale = 0;           // 1..3; 0: the monitor's
  bool notice = false;        // show the notice of the first start
  // Called when it is accepted; what it returns, if anything, is shown: why this will not be remembered.
  const std::function<std::string()>* noticeAccepted = nullptr;
  std::string screenshot;  // write the settled window as PNG and end
};

struct UiAnswer {
  int code = -1;  // an ErrorCode, or -1 when all went well
  char sentence[512] = "";
};

using UiAbiFn = const char* (*)();                    // vernierUiAbi
using UiRunFn = void (*)(const UiStart*, UiAnswer*);  // vernierUiRun: until the window is closed

}  // namespace vernier::app
