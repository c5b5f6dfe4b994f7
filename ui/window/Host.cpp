// SPDX-License-Identifier: GPL-3.0-or-later
#include "Host.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace vernier::ui {
namespace {

constexpr std::chrono::milliseconds kDraftWait(6);

Error unavailable(const std::string& sentence) {
  return makeError(ErrorCode::WindowUnavailable, sentence, "window");
}

std::string reason() {
  const char* text = nullptr;
  glfwGetError(&text);
  std::string s = text ? text : "";
  while (!s.empty() && (s.back() == '.' || s.back() == '\n')) s.pop_back();
  return s;
}

Host& hostOf(GLFWwindow* w) { return *static_cast<Host*>(glfwGetWindowUserPointer(w)); }

// GLFW counts the pointer in its own units; everything here is framebuffer pixels.
double pixelsPerUnit(GLFWwindow* w) {
  int wide = 0, high = 0, pixels = 0, rows = 0;
  glfwGetWindowSize(w, &wide, &high);
  glfwGetFramebufferSize(w, &pixels, &rows);
  return wide > 0 && pixels > 0 ? static_cast<double>(pixels) / wide : 1;
}

// Every text that a document brings to the screen; bounded, since each character costs room in the atlas.
std::string textsOf(const Document& d) {
  std::string all;
  all += d.title;
  for (const Patient& p : d.session->study().patients) all += p.name;
  for (const Study& s : d.session->study().studies) all += s.description;
  for (const Series& s : d.session->study().series) all += s.description;
  for (const PresentationState& p : d.session->study().presentations) all += p.label + p.description;
  for (const VolumeFile& v : d.session->volumeFiles()) all += titleOf(*d.session, v);
  return all.substr(0, 20'000);
}

}  // namespace

Result<std::unique_ptr<Host>> Host::make(const HostOptions& o) {
  std::unique_ptr<Host> host(new Host());
  if (const Result<void> opened = host->openWindow(o); !opened) return opened.error();
  host->desk_ = std::make_unique<Desk>(o.session, [h = host.get()] {
    h->woken_ = true;
    glfwPostEmptyEvent();
  });
  host->gui_ = std::make_unique<Gui>(*host->desk_, *host->textures_);
  host->applyScale(host->theme_.scale);
  if (o.notice) host->gui_->showNotice(o.noticeAccepted);
  return host;
}

Result<void> Host::openWindow(const HostOptions& o) {
  glfwSetErrorCallback(nullptr);
  if (!glfwInit()) {
    const bool none = !std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY");
    return unavailable((none ? std::string("There is no display (DISPLAY is not set)")
                             : "No display could be opened (" + reason() + ")") +
                       "; `vernier render` and `vernier sheet` make pictures without one.");
  }
  glfw_ = true;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_VISIBLE, o.visible ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  float monitor = 1;
  if (GLFWmonitor* m = glfwGetPrimaryMonitor()) glfwGetMonitorContentScale(m, &monitor, nullptr);
  fixedScale_ = static_cast<float>(o.scale);
  const float scale = std::clamp(fixedScale_ > 0 ? fixedScale_ : monitor, 1.0f, 3.0f);
  window_ =
      glfwCreateWindow(static_cast<int>(static_cast<float>(o.width) * scale),
                       static_cast<int>(static_cast<float>(o.height) * scale), "Vernier", nullptr, nullptr);
  if (!window_)
    return unavailable("The display offers no OpenGL 3.3 (" + reason() +
                       "); install libgl1-mesa-dri, or use `vernier render`, which needs none.");
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  textures_ = std::make_unique<Textures>();
  if (!textures_->load())
    return unavailable("The display's OpenGL lacks functions of version 3.3; `vernier render` needs none.");
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  io.LogFilename = nullptr;
  io.ConfigInputTextCursorBlink = false;  // nothing is redrawn while nothing moves
  const std::pair<ImGuiKey_, int> map[] = {{ImGuiKey_Tab, GLFW_KEY_TAB},
                                           {ImGuiKey_LeftArrow, GLFW_KEY_LEFT},
                                           {ImGuiKey_RightArrow, GLFW_KEY_RIGHT},
                                           {ImGuiKey_UpArrow, GLFW_KEY_UP},
                                           {ImGuiKey_DownArrow, GLFW_KEY_DOWN},
                                           {ImGuiKey_Home, GLFW_KEY_HOME},
                                           {ImGuiKey_End, GLFW_KEY_END},
                                           {ImGuiKey_Delete, GLFW_KEY_DELETE},
                                           {ImGuiKey_Backspace, GLFW_KEY_BACKSPACE},
                                           {ImGuiKey_Space, GLFW_KEY_SPACE},
                                           {ImGuiKey_Enter, GLFW_KEY_ENTER},
                                           {ImGuiKey_KeyPadEnter, GLFW_KEY_KP_ENTER},
                                           {ImGuiKey_Escape, GLFW_KEY_ESCAPE},
                                           {ImGuiKey_A, GLFW_KEY_A},
                                           {ImGuiKey_C, GLFW_KEY_C},
                                           {ImGuiKey_V, GLFW_KEY_V},
                                           {ImGuiKey_X, GLFW_KEY_X},
                                           {ImGuiKey_Y, GLFW_KEY_Y},
                                           {ImGuiKey_Z, GLFW_KEY_Z}};
  for (const auto& [ours, theirs] : map) io.KeyMap[ours] = theirs;
  io.ClipboardUserData = window_;
  io.GetClipboardTextFn = [](void* w) { return glfwGetClipboardString(static_cast<GLFWwindow*>(w)); };
  io.SetClipboardTextFn = [](void* w, const char* text) {
    glfwSetClipboardString(static_cast<GLFWwindow*>(w), text);
  };
  theme_ = makeTheme(scale, "");
  imguiGl_ = ImGui_ImplOpenGL3_Init("#version 330");
  if (!imguiGl_) return unavailable("The window's OpenGL could not be set up; `vernier render` needs none.");
  callbacks();
  return {};
}

Host::~Host() {
  gui_.reset();
  desk_.reset();  // joins the threads, which may still wake the window
  if (imguiGl_) ImGui_ImplOpenGL3_Shutdown();
  textures_.reset();
  if (ImGui::GetCurrentContext()) ImGui::DestroyContext();
  if (window_) glfwDestroyWindow(window_);
  if (glfw_) glfwTerminate();
}

void Host::callbacks() {
  using Kind = InputEvent::Kind;
  glfwSetWindowUserPointer(window_, this);
  glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
    const double s = pixelsPerUnit(w);
    hostOf(w).add({Kind::Pointer, x * s, y * s, 0, false, {}});
  });
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* w, int in) {
    if (!in) hostOf(w).add({Kind::PointerLeft, 0, 0, 0, false, {}});
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int) {
    if (button < 3) hostOf(w).add({Kind::Button, 0, 0, button, action == GLFW_PRESS, {}});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double x, double y) {
    hostOf(w).add({Kind::Wheel, x, y, 0, false, {}});
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int) {
    if (key >= 0 && key < 512 && action != GLFW_REPEAT)
      hostOf(w).add({Kind::Key, 0, 0, key, action == GLFW_PRESS, {}});
    if (action == GLFW_REPEAT) hostOf(w).framesWanted_ = 2;
  });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned c) {
    hostOf(w).add({Kind::Text, 0, 0, static_cast<int>(c), false, {}});
  });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int n, const char** paths) {
    InputEvent e{Kind::Drop, 0, 0, 0, false, {}};
    for (int k = 0; k < n; ++k) e.paths.emplace_back(paths[k]);
    hostOf(w).add(std::move(e));
  });
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { hostOf(w).framesWanted_ = 2; });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* w, int, int) { hostOf(w).framesWanted_ = 2; });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* w, int focused) {
    if (focused) return;  // keys let go elsewhere are not seen here
    ImGuiIO& io = ImGui::GetIO();
    std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
    hostOf(w).framesWanted_ = 2;
  });
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* w, float s, float) {
    Host& host = hostOf(w);
    if (host.fixedScale_ <= 0) host.applyScale(std::clamp(s, 1.0f, 3.0f));
  });
}

void Host::applyScale(float scale) {
  theme_ = makeTheme(scale, fontText_);
  if (imguiGl_) {
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
  gui_->setTheme(theme_);
  desk_->setScale(scale);
  framesWanted_ = 2;
}

void Host::feed(const InputEvent& e) {
  using Kind = InputEvent::Kind;
  ImGuiIO& io = ImGui::GetIO();
  switch (e.kind) {
    case Kind::Pointer:
      io.MousePos = {static_cast<float>(e.x), static_cast<float>(e.y)};
      break;
    case Kind::PointerLeft:
      io.MousePos = {-FLT_MAX, -FLT_MAX};
      break;
    case Kind::Button:
      io.MouseDown[e.code] = e.down;
      break;
    case Kind::Wheel:
      io.MouseWheel += static_cast<float>(e.y);
      io.MouseWheelH += static_cast<float>(e.x);
      break;
    case Kind::Key:
      io.KeysDown[e.code] = e.down;
      break;
    case Kind::Text:
      io.AddInputCharacter(static_cast<unsigned>(e.code));
      break;
    case Kind::Drop:
      desk_->open(e.paths);
      break;
  }
  io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL] || io.KeysDown[GLFW_KEY_RIGHT_CONTROL];
  io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT] || io.KeysDown[GLFW_KEY_RIGHT_SHIFT];
  io.KeyAlt = io.KeysDown[GLFW_KEY_LEFT_ALT] || io.KeysDown[GLFW_KEY_RIGHT_ALT];
}

void Host::frame() {
  const std::size_t documents = desk_->documents().size();
  desk_->update();
  if (desk_->documents().size() > documents) {  // names may need characters that the fonts lack
    std::string text;
    for (const auto& d : desk_->documents()) text += textsOf(*d);
    if (std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; })) {
      fontText_ = text;
      applyScale(theme_.scale);
    }
  }
  for (const InputEvent& e : input_.next()) feed(e);
  gui_->setWay(input_.way());
  const std::uint64_t posted = desk_->posted();
  layOut();
  desk_->update();  // scenes that were edited go to the renderer at once
  // A draft often takes less time than drawing the window: then the same frame shows it.
  if (desk_->posted() != posted && desk_->waitForDrafts(kDraftWait)) {
    desk_->update();
    layOut();
    desk_->update();
  }
  int w = 0, h = 0;
  glfwGetFramebufferSize(window_, &w, &h);
  textures_->beginFrame(w, h, 0.067f, 0.075f, 0.086f);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  textures_->sweep();
  glfwSwapBuffers(window_);
}

void Host::layOut() {
  drawnChanges_ = desk_->changes();
  ImGuiIO& io = ImGui::GetIO();
  int w = 0, h = 0;
  glfwGetFramebufferSize(window_, &w, &h);
  io.DisplaySize = {static_cast<float>(w), static_cast<float>(h)};
  const double now_s = glfwGetTime();
  io.DeltaTime = static_cast<float>(std::clamp(now_s - lastFrame_s_, 1e-4, 1.0));
  lastFrame_s_ = now_s;
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  gui_->frame();
  ImGui::Render();
}

bool Host::settle(double limit_s) {
  const double end_s = glfwGetTime() + limit_s;
  int quiet = 0;
  while (glfwGetTime() < end_s) {
    glfwPollEvents();
    frame();
    // Three quiet frames: what the last picture or event has changed is drawn, too.
    quiet = input_.empty() && desk_->idle() ? quiet + 1 : 0;
    if (quiet >= 3) return true;
    if (input_.empty() && !desk_->idle()) glfwWaitEventsTimeout(0.02);
  }
  return false;
}

Picture Host::screenshot() {
  int w = 0, h = 0;
  glfwGetFramebufferSize(window_, &w, &h);
  // The back buffer is not defined after a swap: draw the same again and read before it.
  textures_->beginFrame(w, h, 0.067f, 0.075f, 0.086f);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return textures_->readBack(w, h);
}

void Host::run(const std::function<bool()>& goOn) {
  while (!glfwWindowShouldClose(window_) && !gui_->wantsToQuit() && (!goOn || goOn())) {
    if (framesWanted_ > 0 || !input_.empty() || woken_)
      glfwPollEvents();
    else
      glfwWaitEvents();
    if (!input_.empty()) framesWanted_ = 2;
    const bool woken = woken_.exchange(false);
    if (woken) desk_->update();
    // What counts is what the last frame has drawn: it may have taken a picture after it drew.
    if (desk_->changes() != drawnChanges_ || (woken && desk_->progress()))
      framesWanted_ = std::max(framesWanted_, 2);
    if (framesWanted_ <= 0) continue;
    --framesWanted_;
    frame();
  }
}

}  // namespace vernier::ui
