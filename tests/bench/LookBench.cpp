// SPDX-License-Identifier: GPL-3.0-or-later
// vernier_bench_looks STUDY [WIDTHxHEIGHT]: looks through a volume as the desktop draws them, without a
// window. A JSON line for each look: turns of 2 degrees, each waited for (what it took, and pixels of the
// screen for one drafted pixel); from the last turn to the picture with all pixels and to the measured one;
// and a turn that comes while the picture is being refined, which must give way.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "Desk.h"
#include "Looks.h"
#include "SceneEdits.h"

namespace vernier::ui {
namespace {
using Clock = std::chrono::steady_clock;

constexpr int kTile = 3, kTurns = 60, kInterrupts = 9;
constexpr glm::dvec2 kTurn_px(4, 0);

double msSince(Clock::time_point t) {
  return std::chrono::duration<double, std::milli>(Clock::now() - t).count();
}
double part(std::vector<double> v, double share) {
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(share * static_cast<double>(v.size() - 1))];
}

template <class Test>
bool waitUntil(Desk& desk, Test done) {
  const auto begin = Clock::now();
  while (!done()) {
    if (msSince(begin) > 120'000) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    desk.update();
  }
  return true;
}

const FinishedPicture* shown(const Desk& desk) {
  const auto& p = desk.tileView(kTile).picture;
  return p && !p->error && p->scene == desk.workspace().tile(kTile).scene ? &*p : nullptr;
}
// Turns a little and waits for the picture of it; ms.
double turn(Desk& desk) {
  const auto begin = Clock::now();
  Workspace& w = desk.workspace();
  w.setScene(kTile, Gesture::WheelTurn, turned(w.tile(kTile).scene, kTurn_px));
  desk.update();
  return waitUntil(desk, [&] { return shown(desk); }) ? msSince(begin) : -1;
}

void measure(Desk& desk, const VolumeLook& look) {
  desk.workspace().setLook(kTile, look);
  if (!waitUntil(desk, [&] { return shown(desk) && desk.idle(); })) return;
  std::vector<double> turns_ms, coarse;
  for (int k = 0; k < kTurns; ++k) {
    turns_ms.push_back(turn(desk));
    coarse.push_back(shown(desk) ? shown(desk)->depths.perPixel : 0);
  }
  const auto last = Clock::now();
  double sharp_ms = 0;
  if (!waitUntil(desk, [&] {
        const FinishedPicture* p = shown(desk);
        if (p && p->depths.perPixel == 1 && sharp_ms == 0) sharp_ms = msSince(last);
        return p && p->measured;
      }))
    return;
  const double measured_ms = msSince(last);
  const std::string error = shown(desk)->errorLine;
  std::vector<double> interrupts_ms;
  for (int k = 0; k < kInterrupts; ++k) {
    turn(desk);
    const auto begin = Clock::now();  // the more of the refining is done, the later
    waitUntil(desk, [&] { return msSince(begin) > kIdle_ms + 40 * (k + 1); });
    interrupts_ms.push_back(turn(desk));
  }
  std::printf(
      "{\"look\": \"%s\", \"turn_ms\": {\"median\": %.1f, \"q90\": %.1f}, \"coarse\": %.1f, \"sharp_ms\": "
      "%.0f, "
      "\"measured_ms\": %.0f, \"interrupt_ms\": {\"median\": %.1f, \"max\": %.1f}, \"error\": \"%s\"}\n",
      look.name.c_str(), part(turns_ms, 0.5), part(turns_ms, 0.9), part(coarse, 0.5), sharp_ms, measured_ms,
      part(interrupts_ms, 0.5), part(interrupts_ms, 1), error.c_str());
  std::fflush(stdout);
}

int run(const char* study, int width, int height) {
  Desk desk({}, [] {});
  for (int t = 0; t < kTiles; ++t) desk.setTileSize(t, t == kTile ? width : 0, t == kTile ? height : 0);
  desk.setTileSize(0, 64, 64);
  desk.open({study});
  if (!waitUntil(desk, [&] { return desk.tileView(0).picture && desk.idle(); })) return 1;
  if (const Result<void> r = desk.workspace().open3d(); !r)
    return std::fprintf(stderr, "%s\n", r.error().sentence.c_str()), 1;
  desk.workspace().toggleMaximised(kTile);
  for (const VolumeLook& look : volumeLooks(*desk.workspace().factsOfTile(kTile))) measure(desk, look);
  return 0;
}

}  // namespace
}  // namespace vernier::ui

int main(int argc, char** argv) {
  int width = 984, height = 700;
  const bool sized = argc == 3 && std::sscanf(argv[2], "%dx%d", &width, &height) == 2;
  if (argc != 2 && !sized)
    return std::fprintf(stderr, "usage: vernier_bench_looks STUDY [WIDTHxHEIGHT]\n"), 2;
  return vernier::ui::run(argv[1], width, height);
}
