// SPDX-License-Identifier: GPL-3.0-or-later
// vernier_bench_window STUDY [WIDTHxHEIGHT]: the window as a person would feel it, on the display that
// DISPLAY names (run.sh gives it a virtual one). One JSON line: start of the process to the first picture,
// another series of the study chosen to its first slice (while volume and thumbnails of the first still load,
// so nothing of it is cached), slices scrolled one after the other (each waits for its picture to be on the
// screen), and the share of a core that goes while nothing moves. The size is that of the window; the
// picture's is printed.
#include <GLFW/glfw3.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
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

// Since the kernel made the process: loading of libraries is part of the wait. Counted in 10 ms by the
// kernel.
double msSinceExec() {
  std::ifstream in("/proc/self/stat");
  std::string line;
  std::getline(in, line);
  std::istringstream rest(line.substr(line.rfind(')') + 2));
  std::string word;
  for (int field = 3; field <= 22; ++field) rest >> word;
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  const double started_ms = 1e3 * std::stod(word) / static_cast<double>(sysconf(_SC_CLK_TCK));
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec) - started_ms;
}

// Another series of what was opened, if there is one.
std::optional<SourceId> another(Host& host, const SourceId& than) {
  const Document& d = *host.desk().documents().front();
  for (std::size_t s = 0; s < d.session->study().series.size(); ++s)
    if (const SourceId id{d.number, d.session->sourceName({s, 0})}; id != than) return id;
  return std::nullopt;
}

// As the real loop does: asleep until something has come, then a frame that shows it.
template <class Test>
bool framesUntil(Host& host, Test done) {
  const auto begin = Clock::now();
  while (!done()) {
    if (msSince(begin) > 60'000) return false;
    const std::uint64_t seen = host.desk().changes();
    glfwWaitEventsTimeout(0.05);
    host.desk().update();
    if (host.desk().changes() != seen) host.frame();
  }
  return true;
}

bool shows(Host& host, const Scene& scene) {
  const auto& p = host.desk().tileView(0).picture;
  return p && !p->error && p->scene == scene;
}

int run(const char* study, int width, int height) {
  const auto start = Clock::now();
  const double before_ms = msSinceExec();
  HostOptions options;
  if (width > 0) options.width = width, options.height = height;
  options.scale = 1;
  Result<std::unique_ptr<Host>> made = Host::make(options);
  if (!made) return std::fprintf(stderr, "%s\n", made.error().text().c_str()), 1;
  Host& host = **made;
  const double window_ms = before_ms + msSince(start);
  host.desk().open({study});
  const auto first = [&] { return host.desk().tileView(0).picture.has_value(); };
  host.frame();
  if (!framesUntil(host, first)) return 1;
  const double first_ms = before_ms + msSince(start);

  Workspace& w = host.desk().workspace();
  const SourceId source = w.tile(0).source;
  double choose_ms = 0;
  if (const auto other = another(host, source)) {
    const auto chosen = Clock::now();
    host.desk().openSource(*other, 0);
    host.frame();
    if (!framesUntil(host, [&] { return shows(host, w.tile(0).scene); })) return 1;
    choose_ms = msSince(chosen);
    host.desk().openSource(source, 0);
  }

  host.settle(120);
  w.scroll(0, -1'000'000);
  host.settle(10);
  const int slices = static_cast<int>(std::min<std::int64_t>(200, w.factsOfTile(0)->count() - 1));
  std::vector<double> times_ms;
  const auto scrolling = Clock::now();
  InputEvent wheel;
  wheel.kind = InputEvent::Kind::Wheel, wheel.y = -1;
  InputEvent pointer;
  pointer.x = 0.7 * options.width, pointer.y = 0.5 * options.height;
  host.add(pointer);
  host.frame();
  for (int k = 0; k < slices; ++k) {
    const auto notch = Clock::now();
    host.add(wheel);
    host.frame();
    if (!framesUntil(host, [&] { return shows(host, w.tile(0).scene); })) return 1;
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
  int width = 0, height = 0;
  const bool sized = argc == 3 && std::sscanf(argv[2], "%dx%d", &width, &height) == 2;
  if (argc != 2 && !sized)
    return std::fprintf(stderr, "usage: vernier_bench_window STUDY [WIDTHxHEIGHT]\n"), 2;
  return vernier::ui::run(argv[1], width, height);
}
