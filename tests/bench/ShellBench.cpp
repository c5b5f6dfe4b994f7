// SPDX-License-Identifier: GPL-3.0-or-later
// Times shells of a volume, one JSON line per technique and case: vernier_bench_shells VOLUME [levels]
// [frames]. 512 x 512, orthographic, 4 degrees a frame; the first frame, which makes the surfaces, apart.
// Numbers are medians.
#include <algorithm>
#include <chrono>
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
    const auto plan = makePlan(scene, View{512, 512}, quality, machine, CostTable{}, sources, host.registry);
    if (!plan) {
      std::cerr << plan.error().text() << "\n";
      return;
    }
    images.counters = {};
    for (const Pass& pass : plan->passes)
      if (const auto done = host.registry.find(pass.technique)->execute(pass, images, {}); !done) {
        std::cerr << done.error().text() << "\n";
        return;
      }
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
  if (argc < 2) {
    std::cerr << "vernier_bench_shells VOLUME [levels] [frames]\n";
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
  for (Technique t : {angiography::nativeShellsTechnique(store), angiography::glShellsTechnique(host, store),
                      angiography::glMaxShellsTechnique(host, store)})
    if (!host.addTechnique(std::move(t))) return 1;
  Capabilities machine;
  gpu::probe(machine);
  ShellsLayer layer;
  layer.source = "v";
  layer.count = argc > 2 ? std::atoi(argv[2]) : 12;
  for (const char* technique : {"shells.native", "shells.gl", "shells.glmax"})
    for (const ShellsMode mode : {ShellsMode::Max, ShellsMode::Sum, ShellsMode::Lit})
      for (const double a : {0.0, 0.8}) {
        if (a > 0 && mode != ShellsMode::Max) continue;
        layer.mode = mode, layer.a = a;
        run(host, technique, layer, sources, machine, argc > 3 ? std::atoi(argv[3]) : 9);
      }
  return 0;
}
