// SPDX-License-Identifier: GPL-3.0-or-later
// Table 1 of Ropinski, Steinicke and Hinrichs 2005: frames with and without a lens, here of three volumes of
// 256^3, at 512^2 and 1024^2 pixels; one JSON line each. The lens is a sphere of 1,280 facets about the
// middle of the volume, of 0.3 of its edge, that shows what stands around it too. Both frames of a pair look
// from the same side and follow one another; pairs are 4 degrees apart.
//   vernier_bench_lens table [pairs] [technique]      technique: dvr.native (absent), or another that draws
//   parts vernier_bench_lens write DIR                      the volumes as MetaImages, for other programs
//   vernier_bench_lens move [moves]                   planning anew while a lens moves: spheres, hulls of
//                                                     100,000 and 1,000,000 points
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "vernier/base/Random.h"
#include "vernier/base/Threads.h"
#include "vernier/dvr/Dvr.h"
#include "vernier/lens/Lens.h"
#include "vernier/plan/MakePlan.h"

namespace {

using namespace vernier;
using Clock = std::chrono::steady_clock;

constexpr int kEdge = 256;

class BenchHost final : public Host {
 public:
  Result<void> addTechnique(Technique t) override { return registry.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override { return makeError(ErrorCode::GlUnavailable, "no GL here"); }
  DerivedCache& derivedData() override { return derived; }
  TechniqueRegistry registry;
  DerivedCache derived{std::uint64_t{4} << 30};
};

double bump(double d, double width) { return std::exp(-d * d / (width * width)); }

// In the place of the paper's seismic data, skull and foot; over a cube of side 2 about the origin, HU.
double layers(glm::dvec3 p) {
  const double fold = 0.12 * std::sin(3 * p.x + 1) * std::cos(2 * p.y) + (p.x > 0.2 ? 0.1 : 0.0);
  return 40 + 300 * std::sin(18 * (p.z + fold)) + 120 * std::sin(41 * (p.z + fold));
}
double skull(glm::dvec3 p) {
  const double r = glm::length(p / glm::dvec3(0.8, 0.9, 0.85));
  if (r > 1) return -1000;
  const double vessel = std::hypot(p.x - 0.3 * std::sin(4 * p.z), p.y - 0.3 * std::cos(4 * p.z));
  return 40 + 1400 * bump(r - 0.93, 0.04) + 500 * bump(vessel, 0.05) +
         60 * std::sin(9 * p.x) * std::sin(7 * p.y);
}
double foot(glm::dvec3 p) {
  double bone = 0, flesh = 0;
  for (int n = 0; n < 5; ++n) {
    const double x = 0.28 * (n - 2) * (0.6 + 0.4 * p.y), z = -0.3 + 0.35 * (1 - p.y * p.y) - 0.03 * n;
    const double from = std::hypot(p.x - x, p.z - z), joint = 0.02 * std::cos(9 * p.y + n);
    bone = std::max(bone, bump(from, 0.07 + joint)), flesh = std::max(flesh, bump(from, 0.3));
  }
  return std::abs(p.y) > 0.9 || flesh < 0.2 ? -1000 : -100 + 250 * flesh + 1200 * bone;
}

struct Field {
  const char* name;
  double (*at)(glm::dvec3);
};
constexpr Field kFields[] = {{"layers", layers}, {"skull", skull}, {"foot", foot}};

std::shared_ptr<const Volume> makeVolume(const Field& field, int edge) {
  VolumeInfo info;
  info.grid.columns = info.grid.rows = info.grid.slices = edge;
  info.grid.patientFromVoxel.linear = glm::dmat3(200.0 / edge);
  info.type = VoxelType::I16;
  const auto side = static_cast<std::size_t>(edge), plane = side * side;
  Buffer voxels = std::move(Buffer::make(2 * plane * side)).value();
  auto* out = reinterpret_cast<std::int16_t*>(voxels.data());
  parallelFor(side, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin * plane; n < end * plane; ++n) {
      const glm::dvec3 p = (glm::dvec3(n % side, n / side % side, n / plane) + 0.5) / double(edge);
      out[n] = static_cast<std::int16_t>(field.at(2.0 * p - 1.0) + 20 * randomUnit(3, n));
    }
  });
  return *Volume::make(std::move(info), std::move(voxels));
}

Scene plainScene(const Volume& volume) {
  Scene scene;
  scene.camera.elevation_deg = 20;
  VolumeLayer layer;
  layer.source = "v", layer.transfer = *transferPreset("ct", volume);
  scene.layers.emplace_back(layer);
  return scene;
}

LensLayer lensOver(const Scene& scene, const Volume& volume, LensShape shape) {
  LensLayer lens;
  lens.shape = std::move(shape);
  const GridGeometry& g = volume.grid();
  lens.pose.translation = 0.5 * (g.corner(0).p + g.corner(7).p);
  lens.inner = std::get<VolumeLayer>(scene.layers.front());
  return lens;
}

struct Quartiles {
  double low = 0, median = 0, high = 0;
};
Quartiles quartiles(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return {v[v.size() / 4], v[v.size() / 2], v[3 * v.size() / 4]};
}

struct Frame1 {
  double ms = 0;
  Images images;
};

class Bench {
 public:
  explicit Bench(std::string technique) : technique_(std::move(technique)) {
    machine_.threads = threads();
    if (!dvr::registerDvr(host_) || !lens::registerLens(host_)) std::exit(1);
  }

  Result<Plan> plan(const Scene& scene, int edge_px, const Sources& sources) {
    Quality quality;
    quality.level = QualityLevel::Draft;
    quality.technique = technique_;
    quality.engine = EngineChoice::Native;
    return makePlan(scene, View{edge_px, edge_px}, quality, machine_, CostTable{}, sources, host_.registry);
  }

  Frame1 draw(const Scene& scene, int edge_px, const Sources& sources) {
    Frame1 out;
    const auto begin = Clock::now();
    const auto made = plan(scene, edge_px, sources);
    if (!made) fail(made.error());
    out.images = std::move(kept_);
    out.images.counters = {};
    for (const Pass& pass : made->passes)
      if (const auto done = host_.registry.find(pass.technique)->execute(pass, out.images, {}); !done)
        fail(done.error());
    out.ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    return out;
  }
  void keep(Images images) { kept_ = std::move(images); }

  [[noreturn]] static void fail(const Error& e) {
    std::cerr << e.text() << "\n";
    std::exit(1);
  }

 private:
  std::string technique_;
  BenchHost host_;
  Capabilities machine_;
  Images kept_;
};

double largestDifference(const Images& a, const Images& b) {
  float most = 0;
  for (std::size_t n = 0; n < a.colour.size(); ++n)
    most = std::max(most, std::abs(a.colour[n] - b.colour[n]));
  return 255 * static_cast<double>(most);
}

void tableRow(Bench& bench, const Field& field, const Sources& sources, int edge_px, int pairs) {
  const Volume& volume = *sources.volumes.at("v");
  Scene plain = plainScene(volume), lensed = plain;
  lensed.layers.emplace_back(lensOver(plain, volume, SphereShape{{}, 60, 3}));
  std::vector<double> without, with, ratio;
  double apart = 0, samples = 0;
  Images first = bench.draw(plain, edge_px, sources).images;  // bricks and tables are made
  bench.keep(bench.draw(lensed, edge_px, sources).images);
  for (int n = 0; n < pairs; ++n) {
    plain.camera.azimuth_deg = lensed.camera.azimuth_deg = 4.0 * n;
    bench.keep(std::move(first));
    Frame1 a = bench.draw(plain, edge_px, sources);
    Frame1 b = bench.draw(lensed, edge_px, sources);
    without.push_back(a.ms), with.push_back(b.ms), ratio.push_back(b.ms / a.ms);
    apart = std::max(apart, largestDifference(a.images, b.images));
    samples = static_cast<double>(b.images.counters.samples) / static_cast<double>(a.images.counters.samples);
    first = std::move(a.images);
  }
  const Quartiles p = quartiles(without), l = quartiles(with), r = quartiles(ratio);
  std::printf(
      "{\"volume\": \"%s\", \"edge_px\": %d, \"plain_ms\": [%.2f, %.2f, %.2f], \"lens_ms\": [%.2f, %.2f, "
      "%.2f], "
      "\"ratio\": [%.3f, %.3f, %.3f], \"samples_ratio\": %.5f, \"largest_difference\": %.4f}\n",
      field.name, edge_px, p.low, p.median, p.high, l.low, l.median, l.high, r.low, r.median, r.high, samples,
      apart);
  std::fflush(stdout);
}

int table(int pairs, const std::string& technique) {
  Bench bench(technique);
  for (const Field& field : kFields) {
    Sources sources;
    sources.volumes["v"] = makeVolume(field, kEdge);
    for (const int edge_px : {512, 1024}) tableRow(bench, field, sources, edge_px, pairs);
  }
  return 0;
}

int write(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const Field& field : kFields) {
    const auto volume = makeVolume(field, kEdge);
    const std::string raw = std::string(field.name) + ".raw";
    std::ofstream(folder / raw, std::ios::binary)
        .write(reinterpret_cast<const char*>(volume->data()), std::streamsize{2} * kEdge * kEdge * kEdge);
    std::ofstream header(folder / (std::string(field.name) + ".mhd"));
    header << "ObjectType = Image\nNDims = 3\nDimSize = " << kEdge << ' ' << kEdge << ' ' << kEdge
           << "\nElementType = MET_SHORT\nElementSpacing = " << 200.0 / kEdge << ' ' << 200.0 / kEdge << ' '
           << 200.0 / kEdge << "\nElementByteOrderMSB = False\nElementDataFile = " << raw << "\n";
    if (!header.flush()) {
      std::cerr << "Nothing can be written to " << folder.string()
                << "; give a folder that can be written to.\n";
      return 1;
    }
  }
  return 0;
}

// Points in a ball, or on a sphere.
HullShape pointsOf(std::size_t count, bool onSphere) {
  HullShape hull;
  std::vector<MeshPoint> points;
  for (std::size_t n = 0, k = 0; n < count; ++k) {
    const glm::dvec3 p(2 * randomUnit(5, 3 * k) - 1, 2 * randomUnit(5, 3 * k + 1) - 1,
                       2 * randomUnit(5, 3 * k + 2) - 1);
    const double r = glm::length(p);
    if (r > 1 || r < 1e-3) continue;
    points.emplace_back(60.0 * (onSphere ? p / r : p));
    ++n;
  }
  hull.points = std::move(points);
  return hull;
}

int move(int moves) {
  Bench bench("");
  Sources sources;
  sources.volumes["v"] = makeVolume(kFields[1], 64);
  const Scene plain = plainScene(*sources.volumes["v"]);
  const std::pair<const char*, LensShape> shapes[] = {
      {"sphere, 1,280 facets", SphereShape{{}, 60, 3}},
      {"sphere, 20,480 facets", SphereShape{{}, 60, 5}},
      {"hull of 100,000 points in a ball", pointsOf(100000, false)},
      {"hull of 100,000 points on a sphere", pointsOf(100000, true)},
      {"hull of 1,000,000 points in a ball", pointsOf(1000000, false)},
      {"hull of 1,000,000 points on a sphere", pointsOf(1000000, true)}};
  for (const auto& [name, shape] : shapes) {
    Scene scene = plain;
    scene.layers.emplace_back(lensOver(plain, *sources.volumes["v"], shape));
    std::vector<double> ms;
    double first = 0;
    for (int n = 0; n <= moves; ++n) {
      const auto begin = Clock::now();
      Scene edited = scene;  // an edit posts a snapshot of its own
      std::get<LensLayer>(edited.layers.back()).pose.translation.x += 0.1 * n;
      if (const auto plan = bench.plan(edited, 512, sources); !plan) Bench::fail(plan.error());
      const double took = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
      n == 0 ? void(first = took) : ms.push_back(took);
    }
    const Quartiles q = quartiles(ms);
    std::printf("{\"shape\": \"%s\", \"first_ms\": %.2f, \"move_ms\": [%.3f, %.3f, %.3f]}\n", name, first,
                q.low, q.median, q.high);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "table")
    return table(argc > 2 ? std::max(1, std::atoi(argv[2])) : 9, argc > 3 ? argv[3] : "dvr.native");
  if (what == "write" && argc == 3) return write(argv[2]);
  if (what == "move") return move(argc > 2 ? std::max(1, std::atoi(argv[2])) : 31);
  std::cerr << "vernier_bench_lens table [pairs] [technique] | write DIR | move [moves]\n";
  return 2;
}
