// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering in the sizes of Rezk-Salama 2000, section 10: 600 x 600 pixels, orthographic, 4 degrees a
// frame; one JSON line per volume, technique and way.
//   vernier_bench_volume [frames] [size...]    sizes: 128x128x64 256x256x128 256x256x256 512x512x106 (absent:
//   all)
// The volume is a field of its own (shells and tubes of different values), sampled at the size asked for.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include "DvrTechniques.h"
#include "vernier/base/Random.h"
#include "vernier/base/Threads.h"
#include "vernier/gpu/Device.h"
#include "vernier/plan/MakePlan.h"

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

// A skull-like shell with things inside, -1000 to about 1500, over a cube of side 2 about the origin.
double valueAt(glm::dvec3 p) {
  const double r = glm::length(p / glm::dvec3(0.8, 0.9, 0.85));
  const auto bump = [](double d, double width) { return std::exp(-d * d / (width * width)); };
  if (r > 1) return -1000;
  const double vessel = std::hypot(p.x - 0.3 * std::sin(4 * p.z), p.y - 0.3 * std::cos(4 * p.z));
  return 40 + 1400 * bump(r - 0.93, 0.04) + 500 * bump(vessel, 0.05) +
         60 * std::sin(9 * p.x) * std::sin(7 * p.y);
}

std::shared_ptr<const Volume> makeVolume(int columns, int rows, int slices) {
  VolumeInfo info;
  info.grid.columns = columns, info.grid.rows = rows, info.grid.slices = slices;
  info.grid.patientFromVoxel.linear =
      glm::dmat3(200.0 / columns, 0, 0, 0, 200.0 / rows, 0, 0, 0, 200.0 / slices);
  info.type = VoxelType::I16;
  const std::size_t plane = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  Buffer voxels = std::move(Buffer::make(2 * plane * static_cast<std::size_t>(slices))).value();
  auto* out = reinterpret_cast<std::int16_t*>(voxels.data());
  parallelFor(static_cast<std::size_t>(slices), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t n = 0; n < plane; ++n) {
        const glm::dvec3 p((static_cast<double>(n % static_cast<std::size_t>(columns)) + 0.5) / columns,
                           (static_cast<double>(n / static_cast<std::size_t>(columns)) + 0.5) / rows,
                           (static_cast<double>(k) + 0.5) / slices);
        out[k * plane + n] =
            static_cast<std::int16_t>(valueAt(2.0 * p - 1.0) + 20 * randomUnit(3, k * plane + n));
      }
  });
  return *Volume::make(std::move(info), std::move(voxels));
}

struct Way {
  const char* name;
  const char* technique;
  double step = 1;
  ShadingModel shading = ShadingModel::None;
  bool iso = false;
};

constexpr Way kWays[] = {
    {"native", "dvr.native"},
    {"native shaded", "dvr.native", 1, ShadingModel::ColourPerVoxel},
    {"native iso", "iso.native", 1, ShadingModel::None, true},
    {"GL rays", "dvr.rays"},
    {"stacks 100 %", "dvr.stacks"},
    {"stacks 200 %", "dvr.stacks", 0.5},
    {"stacks 400 %", "dvr.stacks", 0.25},
    {"stacks 800 %", "dvr.stacks", 0.125},
    {"two slices a polygon", "dvr.stacks2"},
    {"two slices, uncorrected", "dvr.stacks2-uncorrected"},
    {"four slices a polygon", "dvr.stacks4"},
    {"stacks shaded", "dvr.stacks", 1, ShadingModel::ColourPerVoxel},
    {"stacks iso", "dvr.stacks", 1, ShadingModel::None, true},
    {"slabs", "dvr.slabs"},
};

Scene sceneOf(const Way& way, const Volume& volume) {
  Scene scene;
  scene.camera.elevation_deg = 20;
  if (way.iso) {
    IsosurfaceLayer layer;
    layer.source = "v", layer.level = 300;
    scene.layers.emplace_back(layer);
  } else {
    VolumeLayer layer;
    layer.source = "v", layer.transfer = *transferPreset("ct", volume);
    layer.shading = way.shading;
    layer.classification = Classification::Post;
    scene.layers.emplace_back(layer);
  }
  return scene;
}

void run(BenchHost& host, const std::string& size, const Way& way, const Sources& sources,
         const Capabilities& machine, int frames) {
  Scene scene = sceneOf(way, *sources.volumes.at("v"));
  Quality quality;
  quality.technique = way.technique;
  quality.step = way.step;
  std::vector<double> ms;
  double first = 0;
  Images images;
  for (int n = 0; n <= frames; ++n) {
    scene.camera.azimuth_deg = 4.0 * n;
    const auto begin = Clock::now();
    const auto plan = makePlan(scene, View{600, 600}, quality, machine, CostTable{}, sources, host.registry);
    if (!plan) {
      std::printf("{\"size\": \"%s\", \"way\": \"%s\", \"refused\": \"%s\"}\n", size.c_str(), way.name,
                  plan.error().sentence.c_str());
      return;
    }
    images.counters = {};
    for (const Pass& pass : plan->passes)
      if (const auto done = host.registry.find(pass.technique)->execute(pass, images, {}); !done) {
        std::cerr << done.error().text() << "\n";
        return;
      }
    const double took = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    n == 0 ? void(first = took) : ms.push_back(took);
  }
  std::sort(ms.begin(), ms.end());
  std::printf(
      "{\"size\": \"%s\", \"way\": \"%s\", \"first_ms\": %.1f, \"frame_ms\": {\"q1\": %.1f, \"median\": "
      "%.1f, "
      "\"q3\": %.1f}, \"samples\": %llu}\n",
      size.c_str(), way.name, first, ms[ms.size() / 4], ms[ms.size() / 2], ms[3 * ms.size() / 4],
      static_cast<unsigned long long>(images.counters.samples));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  std::vector<std::string> sizes(argv + std::min(argc, 2), argv + argc);
  if (sizes.empty()) sizes = {"128x128x64", "256x256x128", "256x256x256", "512x512x106"};
  BenchHost host;
  for (Technique (*make)(Host&) :
       {dvr::nativeVolumeTechnique, dvr::nativeIsosurfaceTechnique, dvr::glRaysTechnique,
        dvr::glStacksTechnique, dvr::glStacks2Technique, dvr::glStacks4Technique,
        dvr::glUncorrectedStacksTechnique, dvr::glSlabsTechnique})
    if (!host.addTechnique(make(host))) return 1;
  Capabilities machine;
  gpu::probe(machine);
  machine.threads = threads();
  for (const std::string& size : sizes) {
    int c = 0, r = 0, s = 0;
    if (std::sscanf(size.c_str(), "%dx%dx%d", &c, &r, &s) != 3 || c < 2 || r < 2 || s < 2) {
      std::cerr << "vernier_bench_volume [frames] [WxHxD...]\n";
      return 2;
    }
    Sources sources;
    sources.volumes["v"] = makeVolume(c, r, s);
    for (const Way& way : kWays) run(host, size, way, sources, machine, frames);
  }
  return 0;
}
