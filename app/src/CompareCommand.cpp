// SPDX-License-Identifier: GPL-3.0-or-later
// vernier compare: how far two picture files are apart.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "Cli.h"
#include "OptionChecks.h"
#include "vernier/picture/Compare.h"
#include "vernier/picture/Png.h"

namespace vernier::app {
namespace {
struct Options {
  std::string a, b, heatmap;
  bool json = false;
  std::optional<double> maxError;
};

int run(const Options& o) {
  if (const Result<void> r = keepSources(nullptr, {o.a, o.b}, o.heatmap, "--heatmap"); !r)
    return report(r.error());
  const Result<Picture> a = readPng(o.a);
  if (!a) return report(a.error());
  const Result<Picture> b = readPng(o.b);
  if (!b) return report(b.error());
  const Result<Difference> d = comparePictures(*a, *b);
  if (!d) return report(d.error());
  if (!o.heatmap.empty()) {
    const Result<Picture> map = heatmap(*a, *b);
    if (!map) return report(map.error());
    if (const Result<void> r = writePng(o.heatmap, *map); !r) return report(r.error());
  }
  if (o.json) {
    const nlohmann::ordered_json j = {{"schema", "vernier-compare/1"},
                                      {"unit", "level/255"},
                                      {"max", d->max},
                                      {"mean", d->mean},
                                      {"rmse", d->rmse},
                                      {"differing", d->differing},
                                      {"worst", {d->worstX, d->worstY}}};
    std::cout << j.dump(2) << "\n";
  } else {
    std::printf("max %d, mean %.4g, RMSE %.4g levels of 255; %.3g %% of the pixels differ; worst at %d,%d\n",
                d->max, d->mean, d->rmse, 100 * d->differing, d->worstX, d->worstY);
  }
  if (o.maxError && d->max > *o.maxError)
    return report(
        makeError(ErrorCode::OutOfTolerance,
                  "The pictures differ by " + std::to_string(d->max) + " levels, more than was asked for.",
                  "--max-error"));
  return 0;
}
}  // namespace

Command addCompare(CLI::App& app, GlobalOptions&) {
  const auto o = std::make_shared<Options>();
  CLI::App* sub = app.add_subcommand("compare", "How far two pictures are apart, in levels of 255");
  sub->add_option("A", o->a, "Picture, PNG")->required();
  sub->add_option("B", o->b, "Picture of the same size, PNG")->required();
  sub->add_option("--heatmap", o->heatmap, "Write the differences as a picture, PNG");
  sub->add_flag("--json", o->json, "JSON on standard output");
  sub->add_option("--max-error", o->maxError, "Exit 4 when any pixel differs by more")
      ->check(finiteFrom(0, 255));
  sub->footer("Example:\n  vernier compare before.png after.png --heatmap diff.png --max-error 1");
  return {sub, [o] { return run(*o); }};
}

}  // namespace vernier::app
