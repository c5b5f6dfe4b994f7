// SPDX-License-Identifier: GPL-3.0-or-later
// vernier bench: times whole frames (plan, draw, 8-bit picture) while the view moves, and measures the error
// of one of them. One JSON line per run, so that runs can be collected and compared as ratios.
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "Clock.h"
#include "Report.h"
#include "vernier/base/Units.h"
#include "vernier/picture/Quantise.h"

namespace vernier::app {
namespace {

struct Options {
  ViewOptions view;
  int frames = 22, loads = 1;
  bool turn = false;
};

// The slice through the centre with the axes right and up of the 3-D camera (DESIGN 9).
Plane cameraPlane(const Volume& volume, double azimuth_deg, double elevation_deg) {
  const double a = Radians(Degrees(azimuth_deg)).rad, e = Radians(Degrees(elevation_deg)).rad;
  Plane p;
  p.point = volume.grid().centre();
  p.normal = PatientVec(std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e));
  p.up = PatientVec(-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e));
  return p;
}

// Frame i of n: oblique planes and slabs turn by 4 degrees, orthogonal slices walk through the middle 37 % of
// their axis, stored frames through the whole stack. Frame -1 is the canonical one (azimuth 30, the middle).
void moveTo(int i, int n, const std::string& viewName, Session& session, RenderRequest& r) {
  for (Layer& layer : r.scene.layers) {
    if (auto* image = std::get_if<ImageLayer>(&layer)) {
      const Result<std::int64_t> count = session.imageCount("");
      if (count && i >= 0) image->index = i % *count;
    }
    auto* slice = std::get_if<SliceLayer>(&layer);
    const std::shared_ptr<const Volume> volume = session.builtVolume();
    if (!slice || !volume) continue;
    if (viewName == "oblique" || viewName == "slab") {
      slice->plane = cameraPlane(*volume, i < 0 ? 30.0 : 4.0 * i, 20.0);
    } else if (i >= 0) {
      const GridGeometry& g = volume->grid();
      const PatientVec n_unit = normalize(slice->plane.normal);
      const double extent_mm = std::abs(dot(n_unit, g.corner(7) - g.corner(0)));
      const double t = n > 1 ? static_cast<double>(i) / (n - 1) - 0.5 : 0.0;
      slice->plane.point = g.centre() + (0.37 * t * extent_mm) * n_unit;
    }
  }
}

int run(const GlobalOptions& global, const Options& o) {
  const Result<Settings> settings = readSettings(global.flags);
  if (!settings) return report(settings.error());
  const auto session = makeSession(global);
  if (!session) return 2;
  const std::stop_token stop = interruptToken();
  std::vector<double> loads_ms;
  Result<RenderRequest> request = RenderRequest{};
  for (int i = 0; i < o.loads; ++i) {  // open() drops what was loaded before
    const auto begin = Clock::now();
    if (const Result<void> opened = session->open(o.view.inputs, terminalProgress(global), stop); !opened)
      return report(opened.error());
    request = makeRequest(*session, o.view, *settings, terminalProgress(global), stop);
    if (!request) return report(request.error());
    loads_ms.push_back(msSince(begin));
  }

  moveTo(-1, 0, request->viewName, *session, *request);
  Result<Rendered> measured =
      session->render(request->scene, request->view, request->quality, request->options, stop);
  if (!measured) return report(measured.error());
  Quality timed = request->quality;  // the closed loop has found its step; the timed frames use it
  timed.step = measured->step;
  RenderOptions noMeasuring = request->options;
  noMeasuring.measure = false;

  const int frames = o.turn ? 90 : o.frames;
  std::vector<double> ms;
  double first_ms = 0;
  Frame buffers;
  Picture picture;
  Counters counters;
  for (int i = 0; i <= frames; ++i) {
    const auto begin = Clock::now();
    moveTo(i, frames + 1, request->viewName, *session, *request);
    Result<Rendered> r =
        session->render(request->scene, request->view, timed, noMeasuring, stop, std::move(buffers));
    if (!r) return report(r.error());
    picture = quantise(r->frame.images, std::move(picture));
    (i == 0 ? first_ms : ms.emplace_back()) = msSince(begin);
    counters = r->frame.images.counters;
    buffers = std::move(r->frame);
  }
  std::sort(ms.begin(), ms.end());
  const auto quantile = [&](double q) {
    return ms[static_cast<std::size_t>(q * static_cast<double>(ms.size() - 1))];
  };
  nlohmann::ordered_json j;
  j["schema"] = "vernier-bench/1";
  j["view"] = request->viewName;
  j["size"] = o.view.size;
  if (const auto volume = session->builtVolume())
    j["dims"] = {volume->grid().columns, volume->grid().rows, volume->grid().slices};
  j["engine"] = measured->frame.engine;
  j["technique"] = measured->frame.technique;
  j["renderer"] = measured->frame.renderer;
  j["threads"] = session->threadCount();
  j["step"] = measured->step;
  j["frames"] = ms.size();
  j["first_frame_ms"] = first_ms;
  j["median_ms"] = median(ms);
  j["q1_ms"] = quantile(0.25);
  j["q3_ms"] = quantile(0.75);
  j["min_ms"] = ms.front();
  j["max_ms"] = ms.back();
  j["samples"] = counters.samples;
  if (measured->error)
    j["error"] = {
        {"unit", "level/255"},
        {"bound", measured->error->bound ? nlohmann::ordered_json(*measured->error->bound) : nullptr},
        {"max", measured->error->max},
        {"rms", measured->error->rms},
        {"kind", quality::nameOf(measured->error->kind)}};
  j["load_ms"] = median(loads_ms);
  j["peak_rss_mb"] = peakRss_mb();
  std::cout << j.dump() << "\n";
  return 0;
}
}  // namespace

Command addBench(CLI::App& app, GlobalOptions& global) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand("bench", "Time frames while the view moves; one JSON line per run");
  addViewOptions(*sub, o->view);
  sub->add_option("--frames", o->frames, "Timed frames, at 4-degree steps")->check(CLI::Range(1, 10000));
  sub->add_option("--loads", o->loads, "Load this often; load_ms is the median")->check(CLI::Range(1, 1000));
  sub->add_flag("--turn", o->turn, "A full turn: 90 frames");
  sub->footer(
      "Examples:\n  vernier bench STUDY --view oblique --window 500,1400\n"
      "  vernier bench head.mhd --view slab --slab 10 --turn --threads 1");
  return {sub, [&global, o] { return run(global, *o); }};
}

}  // namespace vernier::app
