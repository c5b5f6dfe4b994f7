// SPDX-License-Identifier: GPL-3.0-or-later
// Shells of a volume, 512 x 512, orthographic, one JSON line per technique and case.
//   vernier_bench_shells VOLUME [levels] [frames]   times: 4 degrees a frame; the first frame, which makes
//   the
//                                                   surfaces, apart; numbers are medians
//   vernier_bench_shells VOLUME iso VALUE [frames]  times of one surface, for a peer that draws the same mesh
//   vernier_bench_shells VOLUME error               the maximum of 6, 12, 32, 64 levels against the true one
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>

#include "AngiographyTechniques.h"
#include "ShellParams.h"
#include "vernier/gpu/Device.h"
#include "vernier/plan/MakePlan.h"
#include "vernier/volume/VolumeFile.h"

namespace {

using namespace vernier;
using Clock = std::chrono::steady_clock;

class BenchHost final : public Host {
 public:
  Result<void> addTechnique(Technique t) override { return registry.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override {
    if (!device) {
      auto made = gpu::Device::make();
      if (!made) return made.error();
      device = std::move(*made);
    }
    return device.get();
  }
  DerivedCache& derivedData() override { return derived; }
  TechniqueRegistry registry;
  DerivedCache derived{std::uint64_t{4} << 30};
  std::unique_ptr<gpu::Device> device;
};

double msSince(Clock::time_point t) {
  return std::chrono::duration<double, std::milli>(Clock::now() - t).count();
}

bool draw(BenchHost& host, const Scene& scene, const Sources& sources, const Quality& quality,
          const Capabilities& machine, Images& images) {
  const auto plan = makePlan(scene, View{512, 512}, quality, machine, CostTable{}, sources, host.registry);
  if (!plan) {
    std::cerr << plan.error().text() << "\n";
    return false;
  }
  images.counters = {};
  for (const Pass& pass : plan->passes)
    if (const auto done = host.registry.find(pass.technique)->execute(pass, images, {}); !done) {
      std::cerr << done.error().text() << "\n";
      return false;
    }
  return true;
}

// Both pictures have the same rays and window; the true maximum is exact to 0.01 levels. Lit: a level or the
// truth shows there. `above`: by more than half a level of 255; `below`: by more than a step between levels.
void error(BenchHost& host, ShellsLayer layer, const Sources& sources, const Capabilities& machine) {
  Scene scene;
  scene.camera.azimuth_deg = 30, scene.camera.elevation_deg = 20;
  ProjectionLayer truth;
  truth.source = layer.source;
  scene.layers = {truth};
  Quality quality;
  quality.technique = "projection.exact";
  Images exact, shells;
  if (!draw(host, scene, sources, quality, machine, exact)) return;
  quality.technique = "shells.native";
  for (const int levels : {6, 12, 32, 64}) {
    layer.count = levels;
    scene.layers = {layer};
    if (!draw(host, scene, sources, quality, machine, shells)) return;
    const double spacing = 255.0 / (levels + 1);
    std::vector<double> off;
    double sum = 0;
    std::size_t lit = 0, above = 0, below = 0;
    for (std::size_t n = 0; n < exact.colour.size(); n += 4) {
      const double d = 255 * (static_cast<double>(shells.colour[n]) - static_cast<double>(exact.colour[n]));
      if (!(exact.colour[n] > 0 || shells.colour[n] > 0)) continue;
      ++lit, above += d > 0.5, below += d < -spacing;
      off.push_back(std::abs(d)), sum += d * d;
    }
    std::sort(off.begin(), off.end());
    const double count = static_cast<double>(std::max<std::size_t>(1, lit));
    std::printf(
        "{\"levels\": %d, \"lit\": %zu, \"max\": %.1f, \"p99\": %.1f, \"rmse\": %.2f, \"above\": %.4f, "
        "\"below\": %.4f}\n",
        levels, lit, off.empty() ? 0.0 : off.back(), off.empty() ? 0.0 : off[off.size() * 99 / 100],
        std::sqrt(sum / count), static_cast<double>(above) / count, static_cast<double>(below) / count);
  }
}

void run(BenchHost& host, const std::string& technique, ShellsLayer layer, const Sources& sources,
         const Capabilities& machine, int frames) {
  Scene scene;
  scene.camera.elevation_deg = 20;
  scene.layers.emplace_back(layer);
  Quality quality;
  quality.technique = technique;
  std::vector<double> ms;
  double first = 0;
  Images images;
  for (int n = 0; n <= frames; ++n) {
    scene.camera.azimuth_deg = 4.0 * n;
    const auto begin = Clock::now();
    if (!draw(host, scene, sources, quality, machine, images)) return;
    n == 0 ? void(first = msSince(begin)) : ms.push_back(msSince(begin));
  }
  std::sort(ms.begin(), ms.end());
  const double median = ms[ms.size() / 2];
  const char* modes[] = {"max", "sum", "lit"};
  std::printf(
      "{\"technique\": \"%s\", \"mode\": \"%s\", \"a\": %g, \"triangles\": %llu, \"first_ms\": %.1f, "
      "\"frame_ms\": {\"q1\": %.2f, \"median\": %.2f, \"q3\": %.2f}, \"mtriangles_per_s\": %.1f}\n",
      technique.c_str(), modes[static_cast<int>(layer.mode)], layer.a,
      static_cast<unsigned long long>(images.counters.triangles), first, ms[ms.size() / 4], median,
      ms[3 * ms.size() / 4], static_cast<double>(images.counters.triangles) / median / 1000);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 2 ? argv[2] : "12";
  if (argc < 2 || (what == "iso" && argc < 4)) {
    std::cerr << "vernier_bench_shells VOLUME [levels] [frames] | iso VALUE [frames] | error\n";
    return 2;
  }
  auto volume = readVolumeFile(std::string(argv[1]));
  if (!volume) {
    std::cerr << volume.error().text() << "\n";
    return 3;
  }
  Sources sources;
  sources.volumes["v"] = *volume;
  BenchHost host;
  const auto store = std::make_shared<angiography::ShellStore>(host);
  for (Technique t :
       {angiography::exactProjectionTechnique(host), angiography::nativeShellsTechnique(store),
        angiography::glShellsTechnique(host, store), angiography::glMaxShellsTechnique(host, store)})
    if (!host.addTechnique(std::move(t))) return 1;
  Capabilities machine;
  gpu::probe(machine);
  ShellsLayer layer;
  layer.source = "v";
  if (what == "error") return error(host, layer, sources, machine), 0;
  if (what == "iso") {
    layer.levels = {std::atof(argv[3])}, layer.mode = ShellsMode::Lit;
    for (const char* technique : {"shells.native", "shells.gl"})
      run(host, technique, layer, sources, machine, argc > 4 ? std::atoi(argv[4]) : 9);
    return 0;
  }
  layer.count = std::atoi(what.c_str());
  for (const char* technique : {"shells.native", "shells.gl", "shells.glmax"})
    for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit})
      for (const double a : {0.0, 0.8}) {
        if (a > 0 && mode != ShellsMode::Max) continue;
        layer.mode = mode, layer.a = a;
        run(host, technique, layer, sources, machine, argc > 3 ? std::atoi(argv[3]) : 9);
      }
  return 0;
}
