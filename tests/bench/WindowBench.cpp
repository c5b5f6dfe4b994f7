// SPDX-License-Identifier: GPL-3.0-or-later
// vernier_bench_window STUDY: the window as a person would feel it, on the display that DISPLAY names (run.sh
// gives it a virtual one). One JSON line: start to the first picture, a series chosen to its first slice,
// slices scrolled one after the other (each waits for its picture to be on the screen), and the share of a
// core that goes while nothing moves.
#include <GLFW/glfw3.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "Host.h"

namespace vernier::ui {
namespace {
using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point t) {
  return std::chrono::duration<double, std::milli>(Clock::now() - t).count();
}
double cpu_ms() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  const auto ms = [](timeval t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  return ms(u.ru_utime) + ms(u.ru_stime);
}

// Frames, asleep between events as in the real loop, until `done`.
template <class Test>
bool framesUntil(Host& host, Test done) {
  const auto begin = Clock::now();
  while (!done()) {
    if (msSince(begin) > 60'000) return false;
    host.frame();
    if (!done()) glfwWaitEventsTimeout(0.05);
  }
  return true;
}

bool shows(Host& host, const Scene& scene) {
  const auto& p = host.desk().tileView(0).picture;
  return p && !p->error && p->scene == scene;
}

int run(const char* study) {
  const auto start = Clock::now();
  HostOptions options;
  options.scale = 1;
  Result<std::unique_ptr<Host>> made = Host::make(options);
  if (!made) return std::fprintf(stderr, "%s\n", made.error().text().c_str()), 1;
  Host& host = **made;
  const double window_ms = msSince(start);
  host.desk().open({study});
  const auto first = [&] { return host.desk().tileView(0).picture.has_value(); };
  if (!framesUntil(host, first)) return 1;
  host.frame();
  const double first_ms = msSince(start);

  Workspace& w = host.desk().workspace();
  const SourceId source = w.tile(0).source;
  // The series again while its volume loads, as choosing another one would be.
  const auto chosen = Clock::now();
  w.scroll(0, 3);
  host.desk().openSource(source, 0);
  host.frame();
  if (!framesUntil(host, [&] { return shows(host, w.tile(0).scene); })) return 1;
  host.frame();
  const double choose_ms = msSince(chosen);

  host.settle(120);
  w.scroll(0, -1'000'000);
  host.settle(10);
  const int slices = static_cast<int>(std::min<std::int64_t>(200, w.factsOfTile(0)->count() - 1));
  std::vector<double> times_ms;
  const auto scrolling = Clock::now();
  InputEvent wheel;
  wheel.kind = InputEvent::Kind::Wheel, wheel.y = -1;
  InputEvent pointer;
  pointer.x = 780, pointer.y = 420;
  host.add(pointer);
  host.frame();
  for (int k = 0; k < slices; ++k) {
    const auto notch = Clock::now();
    host.add(wheel);
    host.frame();
    if (!framesUntil(host, [&] { return shows(host, w.tile(0).scene); })) return 1;
    host.frame();
    times_ms.push_back(msSince(notch));
  }
  const double rate = slices / (msSince(scrolling) / 1000);
  std::sort(times_ms.begin(), times_ms.end());

  host.settle(10);
  std::atomic<bool> over = false;
  std::thread clock([&] {
    std::this_thread::sleep_for(std::chrono::seconds(5));
    over = true;
    glfwPostEmptyEvent();
  });
  const double cpuBefore = cpu_ms();
  const auto idle = Clock::now();
  host.run([&] { return !over; });
  const double share = (cpu_ms() - cpuBefore) / msSince(idle);
  clock.join();
  std::printf(
      "{\"window_ms\": %.0f, \"start_to_first_picture_ms\": %.0f, \"series_to_first_slice_ms\": %.0f, "
      "\"scrolled\": %d, \"pictures_per_second\": %.1f, \"notch_ms\": {\"median\": %.1f, \"q90\": %.1f}, "
      "\"picture\": \"%dx%d\", \"idle_share_of_a_core\": %.4f}\n",
      window_ms, first_ms, choose_ms, slices, rate, times_ms[times_ms.size() / 2],
      times_ms[times_ms.size() * 9 / 10], host.desk().tileView(0).view.width_px,
      host.desk().tileView(0).view.height_px, share);
  return 0;
}

}  // namespace
}  // namespace vernier::ui

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: vernier_bench_window STUDY\n"), 2;
  return vernier::ui::run(argv[1]);
}
