// SPDX-License-Identifier: GPL-3.0-or-later
// The bound on slices, per technique, against the double reference, on random oblique planes through every
// voxel type and every kind of grid: before the window |engine - double| <= 1e-4 of the local range + 1e-6 of
// the stored range, or 3/512 of the local range where the card filters; native also <= 1e-4 of windows of 10
// units and more.
#include <cmath>
#include <limits>
#include <type_traits>

#include "../unit/volume/Grids.h"
#include "RenderForTest.h"
#include "vernier/quality/Reference.h"

namespace vernier {
namespace {

using namespace vernier::test;

struct Case {
  Scene scene;
  View view{56, 48, true};
  Sources sources;
  SliceLayer& layer() { return std::get<SliceLayer>(scene.layers[0]); }
  const Volume& volume() const { return *sources.volumes.at("v"); }
};

// A random plane near the middle, in a picture that also shows the border.
Case randomCase(std::shared_ptr<const Volume> volume, std::uint64_t seed) {
  const auto unit = [&](std::uint64_t n) { return 2 * randomUnit(seed, n) - 1; };
  const GridGeometry& g = volume->grid();
  const double diagonal_mm = glm::length(g.corner(7).p - g.corner(0).p) + g.spacing_mm().x;
  Case c;
  SliceLayer layer;
  layer.source = "v";
  layer.plane.normal = PatientVec(unit(0), unit(1), unit(2));
  layer.plane.up = PatientVec(unit(3), unit(4), unit(5));
  layer.plane.point = PatientPoint(g.centre().p + 0.15 * diagonal_mm * glm::dvec3(unit(6), unit(7), unit(8)));
  layer.window = VoiWindow{0, 100, VoiFunction::LinearExact, ""};
  c.scene.layers.emplace_back(layer);
  c.scene.camera.height_mm = 0.8 * diagonal_mm;
  c.sources.volumes["v"] = std::move(volume);
  return c;
}

struct Tally {
  int compared = 0, borderline = 0;
  double worst = 0;  // of the bound
};

// Values of the reference around a pixel: where they jump, or the pixel has data or not, depends on rounding.
struct Around {
  double min = std::numeric_limits<double>::infinity(), max = -min;
  bool some = false, all = true;
};
Around around(const Case& c, glm::dvec2 p, double reach_px, const quality::ReferenceOptions& options) {
  std::vector<glm::dvec2> points;
  for (double dx : {-reach_px, 0.0, reach_px})
    for (double dy : {-reach_px, 0.0, reach_px}) points.push_back(p + glm::dvec2(dx, dy));
  const auto values = quality::sliceValues(c.scene, 0, c.view, c.sources, points, options);
  Around a;
  for (const auto& v : *values) {
    a.some = a.some || v;
    a.all = a.all && v;
    if (v) a.min = std::min(a.min, v->value), a.max = std::max(a.max, v->value);
  }
  return a;
}

void compare(const Case& c, const Rendered& r, double step, Tally& tally) {
  const quality::ReferenceOptions options{quality::ErrorKind::Implementation, step};
  std::vector<glm::dvec2> points;
  for (int y = 0; y < c.view.height_px; ++y)
    for (int x = 0; x < c.view.width_px; ++x) points.emplace_back(x + 0.5, y + 0.5);
  const auto truth = quality::sliceValues(c.scene, 0, c.view, c.sources, points, options);
  ASSERT_TRUE(truth.ok());
  const auto range = c.volume().modalityRange();
  const double whole = range->max - range->min;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const double got = r.frame.images.values[n];
    const auto& t = (*truth)[n];
    if (!t && std::isnan(got)) continue;
    if (t && !std::isnan(got)) {
      ++tally.compared;
      // The last term: the value itself is kept as a float.
      const double bound = (r.fixedFunction ? 3.0 / 512 : 1e-4) * t->localRange() + 1e-6 * whole +
                           std::ldexp(std::abs(t->value), -24);
      const double difference = std::abs(got - t->value);
      if (difference <= bound) {
        tally.worst = std::max(tally.worst, difference / bound);
        continue;
      }
      // Next to no-data a renormalised value, and everywhere the nearest voxel, may jump within a hair.
      const Around a = around(c, points[n], 1e-4, options);
      ++tally.borderline;
      ASSERT_TRUE(got >= a.min - bound && got <= a.max + bound)
          << "pixel " << points[n].x << "," << points[n].y << ": " << got << " instead of " << t->value
          << ", bound " << bound << ", within a hair " << a.min << ".." << a.max;
      continue;
    }
    const Around a = around(c, points[n], 1e-3, options);
    ++tally.borderline;
    ASSERT_TRUE(a.some && !a.all) << "pixel " << points[n].x << "," << points[n].y << " has "
                                  << (t ? "no data, but should" : "data, but should not");
  }
}

template <class T>
void everyPlane(double low, double high, bool withNoData) {
  Tally tally;
  std::uint64_t seed = 100 * sizeof(T) + (std::is_signed_v<T> ? 50 : 0);
  for (const NamedGrid& named : everyGrid()) {
    VolumeInfo info;
    info.grid = named.grid;
    info.rescale = {{0.37, -12.5}};
    if (withNoData) info.noData = NoDataRange{low, low + 0.05 * (high - low)};
    const auto v = volumeOf<T>(std::move(info), randomValues<T>(7 * 6 * 9, seed, low, high));
    for (int plane = 0; plane < 4; ++plane) {
      ++seed;
      Case c = randomCase(v, seed);
      const double step = 0.7;
      if (plane >= 2) c.layer().slab = Slab{3.5, plane == 2 ? SlabMode::Max : SlabMode::Mean};
      for (const std::string& technique : sliceTechniques()) {
        SCOPED_TRACE(technique + " " + named.name + " plane " + std::to_string(plane));
        const auto r = renderWith(technique, c.scene, c.view, c.sources, step);
        if (!r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique) continue;
        ASSERT_TRUE(r.ok()) << r.error().text();
        compare(c, *r, step, tally);
      }
    }
  }
  EXPECT_GT(tally.compared, 10000);
  EXPECT_LT(tally.borderline, tally.compared / 500);
  std::cout << "[  NOTE    ] worst " << tally.worst << " of the bound over " << tally.compared << " pixels, "
            << tally.borderline << " at a jump\n";
}

TEST(SliceError, U8) { everyPlane<std::uint8_t>(0, 255, false); }
TEST(SliceError, I8) { everyPlane<std::int8_t>(-128, 127, false); }
TEST(SliceError, U16) { everyPlane<std::uint16_t>(0, 65535, false); }
TEST(SliceError, I16) { everyPlane<std::int16_t>(-32768, 32767, false); }
TEST(SliceError, U32) { everyPlane<std::uint32_t>(0, 4294967295.0, false); }
TEST(SliceError, I32) { everyPlane<std::int32_t>(-2147483648.0, 2147483647.0, false); }
TEST(SliceError, F32) { everyPlane<float>(-1e-3, 1e-3, false); }
TEST(SliceError, I16WithPadding) { everyPlane<std::int16_t>(-2000, 2000, true); }
TEST(SliceError, F32WithPadding) { everyPlane<float>(-1, 1, true); }

TEST(SliceError, F32WithNan) {
  Tally tally;
  for (const NamedGrid& named : everyGrid()) {
    auto values = randomValues<float>(7 * 6 * 9, 8, -100, 100);
    for (std::size_t n = 0; n < values.size(); n += 17) values[n] = std::numeric_limits<float>::quiet_NaN();
    VolumeInfo info;
    info.grid = named.grid;
    Case c = randomCase(volumeOf<float>(std::move(info), values), 77);
    for (const std::string& technique : sliceTechniques()) {
      SCOPED_TRACE(technique + " " + named.name);
      const auto r = renderWith(technique, c.scene, c.view, c.sources);
      if (!r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique) continue;
      ASSERT_TRUE(r.ok()) << r.error().text();
      compare(c, *r, 1, tally);
    }
  }
  EXPECT_GT(tally.compared, 1000);
}

TEST(SliceError, SlopePerSlice) {
  Tally tally;
  VolumeInfo info;
  info.grid = everyGrid()[1].grid;
  info.rescale.clear();
  for (int k = 0; k < 9; ++k) info.rescale.push_back({0.01 * (k + 1), -5.0 * k});
  Case c = randomCase(
      volumeOf<std::int16_t>(std::move(info), randomValues<std::int16_t>(7 * 6 * 9, 8, 0, 4000)), 5);
  for (const std::string& technique : sliceTechniques()) {
    SCOPED_TRACE(technique);
    const auto r = renderWith(technique, c.scene, c.view, c.sources);
    if (!r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique) continue;
    ASSERT_TRUE(r.ok()) << r.error().text();
    compare(c, *r, 1, tally);
  }
  EXPECT_GT(tally.compared, 200);
}

TEST(SliceError, NearestIsTheStoredValue) {
  Tally tally;
  for (const NamedGrid& named : everyGrid()) {
    VolumeInfo info;
    info.grid = named.grid;
    Case c = randomCase(
        volumeOf<std::int16_t>(std::move(info), randomValues<std::int16_t>(7 * 6 * 9, 3, -1000, 1000)), 31);
    c.layer().interpolation = Interpolation::Nearest;
    for (const std::string& technique : sliceTechniques()) {
      SCOPED_TRACE(technique + " " + named.name);
      const auto r = renderWith(technique, c.scene, c.view, c.sources);
      if (!r && technique != "mpr.native" && r.error().code == ErrorCode::NoTechnique) continue;
      ASSERT_TRUE(r.ok()) << r.error().text();
      compare(c, *r, 1, tally);
    }
  }
  EXPECT_GT(tally.compared, 1000);
  EXPECT_LT(tally.borderline, tally.compared / 200);
}

// CT values, the narrowest window that is promised, inside and at the border.
TEST(SliceError, NativeIsWithinTenThousandthsOfAWindowOfTen) {
  for (const NamedGrid& named : everyGrid()) {
    SCOPED_TRACE(named.name);
    VolumeInfo info;
    info.grid = named.grid;
    const auto v =
        volumeOf<std::int16_t>(std::move(info), randomValues<std::int16_t>(7 * 6 * 9, 21, -1024, 3071));
    Case c = randomCase(v, 9);
    c.layer().window = VoiWindow{1000, 10, VoiFunction::LinearExact, ""};
    const auto r = renderWith("mpr.native", c.scene, c.view, c.sources);
    ASSERT_TRUE(r.ok());
    std::vector<std::size_t> all(static_cast<std::size_t>(c.view.width_px * c.view.height_px));
    for (std::size_t n = 0; n < all.size(); ++n) all[n] = n;
    const auto truth = quality::referencePixels(c.scene, c.view, c.sources, all);
    ASSERT_TRUE(truth.ok());
    int grey = 0;
    for (std::size_t n : all) {
      if ((*truth)[n].covered != !std::isnan(r->frame.images.values[n])) continue;  // judged above
      ASSERT_NEAR(r->frame.images.colour[4 * n], (*truth)[n].rgba.x, 1e-4) << n;
      // In the value itself, also where the window is saturated.
      if ((*truth)[n].covered) {
        ASSERT_NEAR(r->frame.images.values[n], (*truth)[n].value, 1e-4 * 10) << n;
      }
      grey += (*truth)[n].covered;
    }
    EXPECT_GT(grey, 100);
  }
}

}  // namespace
}  // namespace vernier
