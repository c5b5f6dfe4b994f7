// SPDX-License-Identifier: GPL-3.0-or-later
#include "XWindow.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <chrono>
#include <memory>
#include <thread>

namespace vernier::ui::test {
namespace {

struct CloseDisplay {
  void operator()(Display* d) const { XCloseDisplay(d); }
};
using Connection = std::unique_ptr<Display, CloseDisplay>;

// Windows may go while they are asked about.
int ignored(Display*, XErrorEvent*) { return 0; }

bool isIt(Display* d, Window w, const std::string& title) {
  XWindowAttributes a;
  char* name = nullptr;
  if (!XGetWindowAttributes(d, w, &a) || a.map_state != IsViewable || !XFetchName(d, w, &name)) return false;
  const bool same = name && title == name;
  if (name) XFree(name);
  return same;
}

Window look(Display* d, const std::string& title) {
  Window root = 0, parent = 0, *children = nullptr;
  unsigned n = 0;
  if (!XQueryTree(d, DefaultRootWindow(d), &root, &parent, &children, &n)) return 0;
  Window found = 0;
  for (unsigned k = 0; k < n && !found; ++k)
    if (isIt(d, children[k], title)) found = children[k];
  if (children) XFree(children);
  return found;
}

}  // namespace

unsigned long findWindow(const std::string& display, const std::string& title, double limit_s) {
  XSetErrorHandler(ignored);
  const Connection d(XOpenDisplay(display.c_str()));
  if (!d) return 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  while (std::chrono::steady_clock::now() < end) {
    if (const Window w = look(d.get(), title)) return w;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return 0;
}

bool askToClose(const std::string& display, unsigned long window) {
  const Connection d(XOpenDisplay(display.c_str()));
  if (!d) return false;
  XEvent e{};
  e.xclient.type = ClientMessage;
  e.xclient.window = window;
  e.xclient.message_type = XInternAtom(d.get(), "WM_PROTOCOLS", False);
  e.xclient.format = 32;
  e.xclient.data.l[0] = static_cast<long>(XInternAtom(d.get(), "WM_DELETE_WINDOW", False));
  e.xclient.data.l[1] = CurrentTime;
  return XSendEvent(d.get(), window, False, NoEventMask, &e) != 0 && XFlush(d.get()) != 0;
}

}  // namespace vernier::ui::test
