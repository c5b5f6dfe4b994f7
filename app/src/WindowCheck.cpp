// SPDX-License-Identifier: GPL-3.0-or-later
// GLFW's few entry points are declared here and looked up with dlsym, so that neither building nor starting
// Vernier needs it. Values from GLFW 3's published header.
#include "WindowCheck.h"

#include <dlfcn.h>

#include <cstdlib>
#include <functional>

namespace vernier::app {
namespace {

constexpr int kVisible = 0x00020004, kMajor = 0x00022002, kMinor = 0x00022003, kProfile = 0x00022008;
constexpr int kForwardCompatible = 0x00022006, kCoreProfile = 0x00032001, kFalse = 0, kTrue = 1;
constexpr unsigned kGlVersion = 0x1F02, kGlRenderer = 0x1F01;

using Window = struct GlfwWindow*;
struct Glfw {
  int (*init)() = nullptr;
  void (*terminate)() = nullptr;
  void (*windowHint)(int, int) = nullptr;
  Window (*createWindow)(int, int, const char*, void*, Window) = nullptr;
  void (*destroyWindow)(Window) = nullptr;
  void (*makeContextCurrent)(Window) = nullptr;
  void (*getWindowContentScale)(Window, float*, float*) = nullptr;
  void (*(*getProcAddress)(const char*))() = nullptr;
};

Error noWindow(const std::string& why) { return makeError(ErrorCode::WindowUnavailable, why, "window"); }

const char* const kWithout = "; `vernier render` and `vernier sheet` draw without a window.";

template <class Fn>
bool entry(void* library, const char* name, Fn& fn) {
  fn = reinterpret_cast<Fn>(::dlsym(library, name));
  return fn != nullptr;
}

// The library stays loaded: the window that may follow takes it from here.
Result<Glfw> loadGlfw(const std::string& wanted) {
  const char* name = wanted.empty() ? "libglfw.so.3" : wanted.c_str();
  void* library = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);
  Glfw g;
  if (!library)
    return noWindow(
        std::string("The window needs the library GLFW, which cannot be loaded; install libglfw3") +
        kWithout);
  if (!entry(library, "glfwInit", g.init) || !entry(library, "glfwTerminate", g.terminate) ||
      !entry(library, "glfwWindowHint", g.windowHint) ||
      !entry(library, "glfwCreateWindow", g.createWindow) ||
      !entry(library, "glfwDestroyWindow", g.destroyWindow) ||
      !entry(library, "glfwMakeContextCurrent", g.makeContextCurrent) ||
      !entry(library, "glfwGetWindowContentScale", g.getWindowContentScale) ||
      !entry(library, "glfwGetProcAddress", g.getProcAddress))
    return noWindow("The library GLFW that is installed is too old: 3.3 or later is needed.");
  return g;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// What the environment says of the display; "" when it says nothing.
std::string displayName() {
  if (const std::string x = variable("DISPLAY"); !x.empty()) return "X11 " + x;
  if (const std::string w = variable("WAYLAND_DISPLAY"); !w.empty()) return "Wayland " + w;
  return "";
}

struct AtEnd {
  std::function<void()> run;
  ~AtEnd() { run(); }
};

Result<WindowFacts> lookAt(const Glfw& glfw, const std::string& display) {
  glfw.windowHint(kVisible, kFalse);
  glfw.windowHint(kMajor, 3);
  glfw.windowHint(kMinor, 3);
  glfw.windowHint(kProfile, kCoreProfile);
  glfw.windowHint(kForwardCompatible, kTrue);
  const Window window = glfw.createWindow(16, 16, "vernier", nullptr, nullptr);
  if (!window)
    return makeError(
        ErrorCode::GlUnavailable,
        "The display " + display +
            " offers no OpenGL 3.3, which the window needs; install the graphics driver or libgl1-mesa-dri" +
            kWithout,
        "window");
  const AtEnd destroy{[&] { glfw.destroyWindow(window); }};
  glfw.makeContextCurrent(window);
  const auto getString =
      reinterpret_cast<const unsigned char* (*)(unsigned)>(glfw.getProcAddress("glGetString"));
  const auto text = [&](unsigned what) {
    const unsigned char* s = getString ? getString(what) : nullptr;
    return std::string(s ? reinterpret_cast<const char*>(s) : "");
  };
  WindowFacts facts;
  facts.display = display;
  facts.version = text(kGlVersion), facts.renderer = text(kGlRenderer);
  facts.software = facts.renderer.find("llvmpipe") != std::string::npos ||
                   facts.renderer.find("softpipe") != std::string::npos;
  float x = 1, y = 1;
  glfw.getWindowContentScale(window, &x, &y);
  facts.scale = static_cast<double>(x);
  glfw.makeContextCurrent(nullptr);
  return facts;
}

}  // namespace

Result<WindowFacts> checkWindow(const WindowCheckOptions& options) {
  const std::string display = displayName();
  if (display.empty())
    return noWindow(
        std::string("There is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); start Vernier in a "
                    "desktop session") +
        kWithout);
  const Result<Glfw> glfw = loadGlfw(options.glfwLibrary);
  if (!glfw) return glfw.error();
  if (!glfw->init())
    return noWindow("The display " + display + " cannot be opened; check that it runs and lets this user in" +
                    kWithout);
  const AtEnd terminate{glfw->terminate};
  return lookAt(*glfw, display);
}

}  // namespace vernier::app
