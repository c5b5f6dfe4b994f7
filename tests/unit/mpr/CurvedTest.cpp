// SPDX-License-Identifier: GPL-3.0-or-later
// mpr.curved through the planner: against planes, closed forms and the reference, and on a vessel whose
// radius is known.
#include <chrono>
#include <cmath>
#include <cstring>
#include <numbers>
#include <thread>

#include "../volume/Grids.h"
#include "RenderForTest.h"
#include "vernier/base/Threads.h"
#include "vernier/native/Curved.h"
#include "vernier/plan/LinkedViews.h"
#include "vernier/quality/Badge.h"

namespace vernier {
namespace {

using namespace vernier::test;
constexpr double kPi = std::numbers::pi;

struct Case {
  Scene scene;
  View view{120, 60, true};
  Sources sources;
  CurvedLayer& layer() { return std::get<CurvedLayer>(scene.layers[0]); }
  const Volume& volume() const { return *sources.volumes.at("v"); }
};

Case caseOf(std::shared_ptr<const Volume> volume, std::vector<PatientPoint> path, double width_mm) {
  Case c;
  CurvedLayer layer;
  layer.source = "v";
  layer.path = std::move(path);
  layer.width_mm = width_mm;
  layer.window = VoiWindow{0, 100, VoiFunction::LinearExact, ""};
  c.scene.layers.emplace_back(layer);
  c.scene.background = {0.25, 0.5, 0.75};
  c.sources.volumes["v"] = std::move(volume);
  return c;
}

Rendered drawn(const Case& c, double step = 1) {
  auto r = renderWith("mpr.curved", c.scene, c.view, c.sources, step);
  EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
  return r.ok() ? std::move(*r) : Rendered{};
}

template <class T>
std::shared_ptr<const Volume> randomVolume(const GridGeometry& g, std::uint64_t seed, bool padded) {
  VolumeInfo info;
  info.grid = g;
  info.rescale = {{0.37, -12.5}};
  if (padded) info.noData = NoDataRange{0, 60};
  const auto n = static_cast<std::size_t>(g.columns * g.rows * g.slices);
  return volumeOf<T>(std::move(info), randomValues<T>(n, seed, 0, sizeof(T) == 1 ? 250 : 1000));
}

template <class Fn>
std::shared_ptr<const Volume> floatVolume(const GridGeometry& g, const Fn& valueAt) {
  VolumeInfo info;
  info.grid = g;
  std::vector<float> values;
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i)
        values.push_back(
            static_cast<float>(valueAt((g.patientFromVoxel * VoxelPoint(glm::dvec3(i, j, k))).p)));
  return volumeOf<float>(std::move(info), values);
}

// A path through the middle of the volume with a few bends.
std::vector<PatientPoint> pathThrough(const GridGeometry& g, std::uint64_t seed, int points) {
  std::vector<PatientPoint> path;
  const glm::dvec3 centre = g.centre().p, half = 0.5 * (g.corner(7).p - g.corner(0).p);
  for (int n = 0; n < points; ++n) {
    const double t = 2.0 * n / (points - 1) - 1;
    const auto u = [&](std::uint64_t a) {
      return 2 * randomUnit(seed, 3 * static_cast<std::uint64_t>(n) + a) - 1;
    };
    path.emplace_back(centre + 0.8 * t * half + 0.15 * glm::length(half) * glm::dvec3(u(0), u(1), u(2)));
  }
  return path;
}

// A straight path is a slice of the same plane, whatever the points on it.
TEST(Curved, AlongAStraightPathItIsTheSlice) {
  std::uint64_t seed = 1;
  double worst = 0;
  for (const NamedGrid& named : everyGrid())
    for (const Interpolation how : {Interpolation::Linear, Interpolation::Cubic})
      for (const double slab_mm : {0.0, 3.0}) {
        const GridGeometry& g = named.grid;
        const glm::dvec3 a = g.centre().p + 0.9 * (g.corner(0).p - g.centre().p) + glm::dvec3(0.3, -0.2, 0.7),
                         b = g.centre().p + 0.8 * (g.corner(7).p - g.centre().p);
        Case c = caseOf(randomVolume<std::int16_t>(g, ++seed, false),
                        {PatientPoint(a), PatientPoint(a + 0.2 * (b - a)), PatientPoint(a + 0.55 * (b - a)),
                         PatientPoint(b)},
                        6);
        // Across the path, so that the slice's picture has the same directions.
        const glm::dvec3 along = glm::normalize(b - a), wanted(0.2, 0.9, -0.1);
        c.layer().up = PatientVec(wanted - glm::dot(wanted, along) * along);
        c.layer().interpolation = how;
        c.layer().slab = {slab_mm, SlabMode::Mean};
        c.layer().form = seed % 2 ? CurvedForm::Straightened : CurvedForm::Stretched;
        c.scene.camera.height_mm = 60 * glm::length(b - a) / 120;
        SliceLayer slice;
        slice.source = "v";
        slice.plane = *planeThrough(PatientPoint(a), PatientPoint(b), *c.layer().up);
        slice.interpolation = how;
        slice.slab = c.layer().slab;
        slice.window = c.layer().window;
        Scene flat = c.scene;
        flat.layers = {slice};
        const auto want = renderWith("mpr.native", flat, c.view, c.sources);
        ASSERT_TRUE(want.ok());
        const Rendered got = drawn(c);
        const auto range = c.volume().modalityRange();
        const auto p = curvedPicture(c.layer(), c.scene.camera, c.view);
        int compared = 0, differ = 0;
        for (int y = p->firstRow(60); y < p->endRow(60); ++y)
          for (int x = 0; x < 120; ++x) {
            const double w = valueOf(*want, x, y), v = valueOf(got, x, y);
            if (std::isnan(w) != std::isnan(v)) {
              ++differ;
              continue;
            }
            if (std::isnan(w)) continue;
            ++compared;
            worst = std::max(worst, std::abs(v - w) / (range->max - range->min));
          }
        EXPECT_GT(compared, 300) << named.name;
        EXPECT_LE(differ, 2) << named.name;  // pixels on a border to the last bit
        EXPECT_LT(worst, 1e-4) << named.name;
      }
  std::printf("straight path against the slice: at most %.2g of the range\n", worst);
}

// A linear field has no interpolation error: every pixel shows it at its own place.
TEST(Curved, ALinearRampComesOutExactly) {
  const auto ramp = [](glm::dvec3 p) { return 3 * p.x - 2 * p.y + 5 * p.z + 40; };
  GridGeometry g = everyGrid()[2].grid;  // oblique and sheared
  g.columns = 60, g.rows = 40, g.slices = 30;
  const auto v = floatVolume(g, ramp);
  const auto range = v->modalityRange();
  for (const Interpolation how : {Interpolation::Linear, Interpolation::Cubic})
    for (const CurvedForm form : {CurvedForm::Straightened, CurvedForm::Stretched}) {
      Case c = caseOf(v, pathThrough(g, 5, 6), 12);
      c.layer().interpolation = how;
      c.layer().form = form;
      const Rendered r = drawn(c);
      const auto p = curvedPicture(c.layer(), c.scene.camera, c.view);
      int inside = 0;
      for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 120; ++x) {
          const auto at = patientAt(*p, {x + 0.5, y + 0.5});
          if (!at) {
            EXPECT_TRUE(std::isnan(valueOf(r, x, y)));
            continue;
          }
          const glm::dvec3 q = (v->voxelFromPatient() * *at).p;
          if (q.x < 0 || q.y < 0 || q.z < 0 || q.x > 59 || q.y > 39 || q.z > 29) continue;
          ++inside;
          ASSERT_NEAR(valueOf(r, x, y), ramp(at->p), 1e-6 * (range->max - range->min) + 2e-3)
              << x << "," << y;
        }
      EXPECT_GT(inside, 800);
    }
}

// Every voxel type, grid, interpolation and slab, against a reference that finds the path's length and frame
// in other ways.
template <class T>
void againstTheReference(bool padded) {
  std::uint64_t seed = 40 + sizeof(T);
  double worst = 0;
  for (const NamedGrid& named : everyGrid()) {
    const auto v = randomVolume<T>(named.grid, ++seed, padded);
    for (const Interpolation how : {Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic})
      for (const double slab_mm : {0.0, 2.5}) {
        Case c = caseOf(v, pathThrough(named.grid, ++seed, 5), 5);
        c.layer().interpolation = how;
        c.layer().form = seed % 3 ? CurvedForm::Straightened : CurvedForm::Stretched;
        c.layer().slab = {slab_mm, static_cast<SlabMode>(seed % 3)};
        Rendered r = drawn(c, 0.7);
        quality::ErrorOptions options;
        options.samples = 7200;
        options.reference = {quality::ErrorKind::Implementation, 0.7};
        const auto e = quality::measureError(r.frame, c.scene, c.view, c.sources, options);
        ASSERT_TRUE(e.ok()) << e.error().text();
        ASSERT_TRUE(e->values);
        EXPECT_TRUE(e->exhaustive);
        EXPECT_GT(e->values->n, 300u) << named.name;
        EXPECT_LE(e->values->coverageDiffersInside, how == Interpolation::Nearest ? 1u : 0u) << named.name;
        // The nearest voxel may change within a hair; the others keep the bound of slices.
        if (how != Interpolation::Nearest) {
          EXPECT_LE(e->values->worstOfBound, 1.0) << named.name << " " << static_cast<int>(how);
          worst = std::max(worst, e->values->worstOfBound);
        } else {
          EXPECT_LE(e->p99, 1.0) << named.name;
        }
      }
  }
  std::printf("curved against the reference: at most %.3f of the bound\n", worst);
}

TEST(Curved, KeepsTheBoundOfSlicesForI16) { againstTheReference<std::int16_t>(false); }
TEST(Curved, KeepsTheBoundOfSlicesForU8) { againstTheReference<std::uint8_t>(false); }
TEST(Curved, KeepsTheBoundOfSlicesForFloat) { againstTheReference<float>(false); }
TEST(Curved, KeepsTheBoundOfSlicesForI32) { againstTheReference<std::int32_t>(false); }
TEST(Curved, KeepsTheBoundOfSlicesBesidePadding) { againstTheReference<std::int16_t>(true); }

// A vessel of radius 2 mm along a helix: straightened it is a straight band of constant width.
TEST(Curved, AHelicalVesselBecomesAStraightOneOfItsWidth) {
  constexpr double kRadius = 18, kRise = 5, kVessel = 2, kEdge = 0.3, kTurns = 1.25;
  std::vector<PatientPoint> path;
  for (int n = 0; n <= 45; ++n) {
    const double a = 2 * kPi * kTurns * n / 45;
    path.emplace_back(kRadius * std::cos(a), kRadius * std::sin(a), kRise * a);
  }
  // Distance to the helix: the nearest of its points, by Newton from the angle that the point has.
  const auto distance = [&](glm::dvec3 p) {
    double best = 1e9;
    const double turn = std::atan2(p.y, p.x);
    for (int k = -1; k <= 2; ++k) {
      double a = turn + 2 * kPi * k;
      for (int n = 0; n < 12; ++n) {
        const double s = std::sin(a), c = std::cos(a);
        const double slope = kRadius * (p.x * s - p.y * c) - kRise * (p.z - kRise * a);
        a -= slope / (kRadius * (p.x * c + p.y * s) + kRise * kRise);
      }
      best = std::min(best,
                      glm::length(p - glm::dvec3(kRadius * std::cos(a), kRadius * std::sin(a), kRise * a)));
    }
    return best;
  };
  GridGeometry g = unitGrid(90, 90, 100);
  g.patientFromVoxel.linear = glm::dmat3(0.5);
  g.patientFromVoxel.translation = {-22.25, -22.25, -5};
  const auto v =
      floatVolume(g, [&](glm::dvec3 p) { return 100 / (1 + std::exp((distance(p) - kVessel) / kEdge)); });
  for (const Interpolation how : {Interpolation::Linear, Interpolation::Cubic}) {
    Case c = caseOf(v, path, 10);
    c.view = {600, 80, true};
    c.layer().interpolation = how;
    const Rendered r = drawn(c);
    const auto p = curvedPicture(c.layer(), c.scene.camera, c.view);
    const double speed = std::hypot(kRadius, kRise);
    EXPECT_NEAR(p->length_mm, 2 * kPi * kTurns * speed, 0.02);
    double least = 1e9, greatest = 0, sum = 0, off = 0;
    int columns = 0;
    for (int x = 20; x < 580; ++x) {
      // Where the values pass the half height, interpolated between rows.
      double first = -1, last = -1;
      for (int y = 1; y < 80; ++y) {
        const double a = valueOf(r, x, y - 1), b = valueOf(r, x, y);
        if (std::isnan(a) || std::isnan(b)) continue;
        if (a < 50 && b >= 50) first = y - 0.5 + (50 - a) / (b - a);
        if (a >= 50 && b < 50) last = y - 0.5 + (50 - a) / (b - a);
      }
      ASSERT_TRUE(first > 0 && last > first) << x;
      const double width = (last - first) * p->mmPerPixel;
      least = std::min(least, width), greatest = std::max(greatest, width);
      sum += width, ++columns;
      off = std::max(off, std::abs(0.5 * (first + last) - p->centreRow_px) * p->mmPerPixel);
    }
    std::printf("helical vessel of 4 mm, %s: width %.3f..%.3f mm, mean %.4f, axis off by at most %.3f mm\n",
                how == Interpolation::Cubic ? "cubic" : "linear", least, greatest, sum / columns, off);
    EXPECT_NEAR(sum / columns, 2 * kVessel, 0.03);
    EXPECT_GT(least, 2 * kVessel - 0.12);  // voxels of 0.5 mm
    EXPECT_LT(greatest, 2 * kVessel + 0.12);
    EXPECT_LT(off, 0.06);
  }
}

TEST(Curved, CountsItsSamplesAndNothingElse) {
  const auto v = randomVolume<std::int16_t>(unitGrid(40, 40, 40), 3, false);
  Case c = caseOf(v, {{5, 20, 20}, {20, 25, 18}, {34, 20, 20}}, 8);
  c.layer().slab = {3, SlabMode::Max};
  const Rendered r = drawn(c);
  const auto p = curvedPicture(c.layer(), c.scene.camera, c.view);
  const auto rows = static_cast<std::uint64_t>(p->endRow(60) - p->firstRow(60));
  EXPECT_EQ(r.frame.images.counters.samples, rows * 120 * 3);  // all inside, 3 samples of a slab of 3 mm
  EXPECT_EQ(r.frame.images.counters.texturesCreated, 0u);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 120; ++x) {
      const std::size_t n = static_cast<std::size_t>(y * 120 + x);
      const bool on = y >= p->firstRow(60) && y < p->endRow(60);
      ASSERT_EQ(std::isnan(valueOf(r, x, y)), !on);
      ASSERT_EQ(r.frame.images.depth[n], on ? 0.0f : kNothing_mm);
      if (!on) {
        ASSERT_EQ(r.frame.images.colour[4 * n + 2], 0.75f);
      }
    }
}

TEST(Curved, SameBitsForOneTwoAndThreeThreads) {
  const auto v = randomVolume<std::int16_t>(everyGrid()[2].grid, 9, true);
  Case c = caseOf(v, pathThrough(everyGrid()[2].grid, 6, 7), 6);
  c.view = {211, 133, true};
  c.layer().interpolation = Interpolation::Cubic;
  c.layer().slab = {2, SlabMode::Mean};
  std::vector<Rendered> all;
  for (const int n : {1, 2, 3}) {
    setThreads(n);
    all.push_back(drawn(c));
  }
  setThreads(0);
  for (std::size_t n = 1; n < all.size(); ++n) {
    const Images &a = all[0].frame.images, &b = all[n].frame.images;
    EXPECT_EQ(0, std::memcmp(a.colour.data(), b.colour.data(), 4 * a.colour.size()));
    EXPECT_EQ(0, std::memcmp(a.values.data(), b.values.data(), 4 * a.values.size()));
    EXPECT_EQ(a.counters.samples, b.counters.samples);
  }
}

TEST(Curved, StopsWhenAsked) {
  const auto v = randomVolume<std::int16_t>(unitGrid(64, 64, 64), 6, false);
  Case c = caseOf(v, {{5, 20, 20}, {30, 45, 30}, {60, 20, 50}}, 40);
  c.layer().slab = {1000, SlabMode::Max};
  const auto p = curvedPicture(c.layer(), c.scene.camera, {512, 512});
  native::CurvedJob job;
  job.volume = v.get();
  job.picture = &*p;
  job.width_px = job.height_px = 512;
  job.slab = c.layer().slab;
  job.slabSamples = 100000;
  job.window = {0, 100, VoiFunction::LinearExact, ""};
  Images images;
  images.allocate(512, 512, false);
  std::stop_source source;
  std::jthread asker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    source.request_stop();
  });
  const Result<void> r = native::drawCurved(job, images, source.get_token());
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::Cancelled);
  EXPECT_LT(images.counters.samples, 400'000'000u);
  images.allocate(512, 511, false);
  EXPECT_EQ(native::drawCurved(job, images).error().code, ErrorCode::Internal);
}

TEST(Curved, WhatAReaderMustKnowStandsInThePlan) {
  const auto v = randomVolume<std::int16_t>(unitGrid(40, 40, 40), 3, false);
  Case c = caseOf(v, {{10, 10, 20}, {20, 14, 20}, {20, 14, 20}, {28, 10, 20}}, 60);
  c.layer().up = PatientVec(0, 1, 0);
  TestHost& host = TestHost::instance();
  const auto plan = makePlan(c.scene, c.view, {}, Capabilities{}, CostTable{}, c.sources, host.registry);
  ASSERT_TRUE(plan.ok());
  ASSERT_EQ(plan->notes.size(), 2u);
  EXPECT_TRUE(plan->notes[0].starts_with("overlaps itself: radius ")) << plan->notes[0];
  const std::string text = dumpPlan(*plan);
  EXPECT_NE(text.find("pass 0: curved 0\n  engine: native\n  technique: mpr.curved\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("parameters: curved 120x60 straightened "), std::string::npos) << text;
  EXPECT_NE(text.find("note: overlaps itself"), std::string::npos) << text;
  EXPECT_EQ(plan->notes[1], "1 coincident point left out");
  // A path that cannot be drawn is a fault of the scene, whatever the technique.
  c.layer().path.resize(1);
  const auto refused =
      makePlan(c.scene, c.view, {}, host.capabilities, CostTable{}, c.sources, host.registry);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::PathDegenerate);
}

TEST(Cubic, OpenGlAndExactSlabsSayThatTheyHaveNone) {
  Case c = caseOf(randomVolume<std::int16_t>(unitGrid(20, 20, 20), 3, false), {{5, 10, 10}, {15, 10, 10}}, 8);
  SliceLayer slice;
  slice.source = "v";
  slice.plane.point = c.volume().grid().centre();
  slice.interpolation = Interpolation::Cubic;
  slice.slab = {4, SlabMode::Max};
  slice.window = c.layer().window;
  c.scene.layers = {slice};
  Capabilities machine;
  machine.gl = true;
  TestHost& host = TestHost::instance();
  const auto plan = makePlan(c.scene, c.view, {}, machine, CostTable{}, c.sources, host.registry);
  ASSERT_TRUE(plan.ok());
  EXPECT_EQ(plan->passes[0].technique, "mpr.native");
  EXPECT_NE(plan->passes[0].params->dump().find(" cubic slab 4 mm max of 4"), std::string::npos);
  int said = 0;
  for (const Rejected& r : plan->rejected) {
    if (r.what == "mpr.exact") said += r.why == "It follows the linear field, and cubic was asked for.";
    if (r.what == "mpr.strips" || r.what == "mpr.polygon")
      said += r.why == "Cubic interpolation is drawn by the native engine; GL has nearest and linear.";
  }
  EXPECT_EQ(said, 3);
}

}  // namespace
}  // namespace vernier
