// SPDX-License-Identifier: GPL-3.0-or-later
// Times native slices on a MetaImage volume beside their measured error, one JSON line per case:
//   vernier_bench_slices VOLUME.mhd [frames] [threads] [case]
// The planes are those of the peer benchmark: 512 x 512 over a square as long as the longest edge, through
// the centre; axial moves along z, oblique turns by 4 degrees a frame at elevation 20, the slab is 10 mm
// thick. A frame is a new plane, the float picture with window, and 8 bits of it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "vernier/base/Random.h"
#include "vernier/base/Threads.h"
#include "vernier/native/Simd.h"
#include "vernier/native/Slice.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"
#include "vernier/volume/VolumeFile.h"

namespace {

using namespace vernier;
using Clock = std::chrono::steady_clock;

struct Case {
  const char* name;
  bool axial;
  double slab_mm;
};

native::SliceJob jobFor(const Volume& v, const Case& c, int frame, int frames) {
  const GridGeometry& g = v.grid();
  const glm::dvec3 spacing = g.spacing_mm();
  const glm::dvec3 size = spacing * glm::dvec3(g.columns - 1, g.rows - 1, g.slices - 1);
  const double side = std::max({size.x, size.y, size.z});
  const double smallest = std::min({spacing.x, spacing.y, spacing.z});
  const double a = 4.0 * frame * std::numbers::pi / 180, e = 20 * std::numbers::pi / 180;
  glm::dvec3 eye(std::sin(a) * std::cos(e), -std::cos(a) * std::cos(e), std::sin(e));
  glm::dvec3 right(std::cos(a), std::sin(a), 0);
  glm::dvec3 up(-std::sin(a) * std::sin(e), std::cos(a) * std::sin(e), std::cos(e));
  glm::dvec3 centre = g.centre().p;
  if (c.axial) {
    eye = {0, 0, -1}, right = {1, 0, 0}, up = {0, -1, 0};
    centre.z += size.z * (0.18 - 0.37 * frame / (frames + 1));
  }
  native::SliceJob job;
  job.volume = &v;
  job.width_px = job.height_px = 512;
  job.picture.mmPerPixel = side / 512;
  job.picture.normal = PatientVec(eye);
  job.picture.right = PatientVec(right * job.picture.mmPerPixel);
  job.picture.down = PatientVec(up * -job.picture.mmPerPixel);
  job.picture.origin = PatientPoint(centre - 256.0 * job.picture.right.v - 256.0 * job.picture.down.v);
  job.slab.thickness_mm = c.slab_mm;
  job.slabSamples = c.slab_mm > 0 ? static_cast<int>(std::ceil(c.slab_mm / smallest)) : 1;
  job.window = {500, 1400, VoiFunction::LinearExact, ""};
  return job;
}

// Largest difference to double arithmetic on the same samples, in levels of 255, over 1,024 pixels.
double errorLevels(const native::SliceJob& job, const Images& images) {
  double worst = 0;
  for (std::uint64_t n = 0; n < 1024; ++n) {
    const auto x = static_cast<int>(randomUnit(1, 2 * n) * job.width_px),
               y = static_cast<int>(randomUnit(1, 2 * n + 1) * job.height_px);
    double grey = -1;
    for (int k = 0; k < job.slabSamples; ++k) {
      const double offset = (k + 0.5) * job.slab.thickness_mm / job.slabSamples - 0.5 * job.slab.thickness_mm;
      const auto value =
          sampleModality(*job.volume, job.picture.origin + (x + 0.5) * job.picture.right +
                                          (y + 0.5) * job.picture.down + offset * job.picture.normal);
      if (value) grey = std::max(grey, applyVoi(job.window, *value));
    }
    worst =
        std::max(worst, 255 * std::abs(std::max(grey, 0.0) -
                                       images.colour[4 * static_cast<std::size_t>(y * job.width_px + x)]));
  }
  return worst;
}

void quantise(const Images& images, std::vector<std::uint8_t>& out) {
  out.resize(images.colour.size());
  parallelFor(static_cast<std::size_t>(images.height), 32, [&](std::size_t begin, std::size_t end) {
    const std::size_t row = 4 * static_cast<std::size_t>(images.width);
    const float* in = images.colour.data();
    std::uint8_t* to = out.data();
    for (std::size_t i = begin * row; i < end * row; ++i)
      to[i] = static_cast<std::uint8_t>(std::clamp(in[i], 0.0f, 1.0f) * 255.0f + 0.5f);
  });
}

double msSince(Clock::time_point t) {
  return std::chrono::duration<double, std::milli>(Clock::now() - t).count();
}

void run(const Volume& v, const Case& c, int frames) {
  Images images;
  images.allocate(512, 512, false);
  std::vector<std::uint8_t> eightBit;
  std::vector<double> draw, whole;
  for (int i = 0; i <= frames; ++i) {
    const auto start = Clock::now();
    const native::SliceJob job = jobFor(v, c, i, frames);
    if (!native::drawSlice(job, images)) std::exit(1);
    const double drawn = msSince(start);
    quantise(images, eightBit);
    if (i == 0) continue;
    draw.push_back(drawn);
    whole.push_back(msSince(start));
  }
  std::sort(draw.begin(), draw.end());
  std::sort(whole.begin(), whole.end());
  const native::SliceJob last = jobFor(v, c, frames, frames);
  images.counters = {};
  if (!native::drawSlice(last, images)) std::exit(1);
  const double error = errorLevels(last, images);
  std::printf(
      "{\"case\":\"%s\",\"simd\":\"%s\",\"threads\":%d,\"frames\":%d,\"draw_ms\":%.3f,\"frame_ms\":%.3f,"
      "\"min_ms\":%.3f,"
      "\"max_ms\":%.3f,\"slab_samples\":%d,\"samples\":%llu,\"error_levels\":%.5f}\n",
      c.name, native::simdTarget().c_str(), threads(), frames, draw[draw.size() / 2], whole[whole.size() / 2],
      whole.front(), whole.back(), last.slabSamples, static_cast<unsigned long long>(images.counters.samples),
      error);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2)
    return std::fprintf(stderr, "usage: vernier_bench_slices VOLUME.mhd [frames] [threads] [case]\n"), 2;
  const int frames = argc > 2 ? std::max(1, std::atoi(argv[2])) : 90;
  setThreads(argc > 3 ? std::atoi(argv[3]) : 0);
  const std::string only = argc > 4 ? argv[4] : "";
  const auto volume = readVolumeFile(std::string(argv[1]));
  if (!volume) return std::fprintf(stderr, "%s\n", volume.error().text().c_str()), 1;
  for (const Case& c : {Case{"axial", true, 0}, Case{"oblique", false, 0}, Case{"slab", false, 10}})
    if (only.empty() || only == c.name) run(**volume, c, frames);
  return 0;
}
