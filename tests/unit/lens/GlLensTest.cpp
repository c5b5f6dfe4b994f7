// SPDX-License-Identifier: GPL-3.0-or-later
// The images of a lens on GL against half-spaces in double, pictures with lenses drawn by both engines, and
// what GL refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../volume/Grids.h"
#include "GlHost.h"
#include "GlLensImages.h"
#include "LensTechniques.h"
#include "vernier/angiography/Angiography.h"
#include "vernier/base/Random.h"
#include "vernier/lens/Lens.h"
#include "vernier/plan/MakePlan.h"

namespace vernier::lens {
namespace {

constexpr double kNear_mm = 1e-4;  // of a face: float may be of two minds
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Numbers from one seed.
struct Dice {
  std::uint64_t seed, next = 0;
  double operator()(double low, double high) { return low + (high - low) * randomUnit(seed, next++); }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 v((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
      if (const double d = glm::length(v); d > 0.1 && d < 1) return v / d;
    }
  }
};

struct RandomCase {
  std::shared_ptr<const Volume> volume;
  CameraPicture camera;
  std::vector<HalfSpace> region;
  ConvexRegion lens;  // planes alone
};

// Some lenses hold the eye, some reach beyond the volume, some miss it.
RandomCase randomCase(std::uint64_t seed) {
  Dice dice{seed};
  VolumeInfo info;
  info.grid = test::unitGrid(100, 90, 80);
  info.grid.patientFromVoxel.translation = {dice(-200, 200), dice(-200, 200), dice(-200, 200)};
  RandomCase c;
  c.volume = test::volumeOf(info, std::vector<std::uint8_t>(100 * 90 * 80, 1));
  const GridGeometry& grid = c.volume->grid();
  Scene scene;
  if (seed % 3 == 0) {
    const glm::dvec3 n = dice.direction();
    scene.clip.push_back({PatientVec(n), glm::dot(n, grid.centre().p) + dice(-20, 40)});
  }
  c.region = *keptRegion(scene, grid);
  Camera camera;
  camera.azimuth_deg = dice(-180, 180), camera.elevation_deg = dice(-80, 80),
  camera.roll_deg = dice(-180, 180);
  camera.zoom = dice(0.7, 2.5);
  if (seed % 2) camera.projection = Projection::Perspective;
  if (seed % 4 == 3) camera.distance_mm = dice(5, 60);  // within the volume
  if (seed % 5 == 0) camera.near_mm = dice(0, 100);
  c.camera = *cameraPicture(camera, {64, 48}, cameraBox(grid));
  const PatientPoint about = seed % 8 == 3 ? c.camera.eye : grid.centre();
  const glm::dvec3 middle = about.p + dice(0, seed % 8 == 3 ? 3 : 45) * dice.direction();
  const int faces = 4 + static_cast<int>(dice(0, 40));
  for (int n = 0; n < faces; ++n) {
    const glm::dvec3 normal = dice.direction();
    c.lens.planes.push_back({PatientVec(normal), glm::dot(normal, middle) + dice(5, 45)});
  }
  return c;
}

struct LineSpan {
  double entry = -kInfinite, exit = kInfinite;
  bool empty() const { return !(entry < exit); }
};
LineSpan through(const std::vector<HalfSpace>& planes, const PatientRay& ray) {
  LineSpan s;
  for (const HalfSpace& h : planes) {
    const double along = dot(h.normal, ray.direction), outside = h.distance_mm(ray.origin);
    if (along < 0) s.entry = std::max(s.entry, -outside / along);
    if (along > 0) s.exit = std::min(s.exit, -outside / along);
    if (along == 0 && outside > 0) return {kInfinite, -kInfinite};
  }
  return s;
}

// How far a point is from the nearest face of a body that it lies at or in: 0 on the face.
double fromFace(const std::vector<HalfSpace>& planes, PatientPoint p) {
  double most = -kInfinite;
  for (const HalfSpace& h : planes) most = std::max(most, h.distance_mm(p));
  return std::abs(most);
}

TEST(GlLens, ImagesAgainstHalfSpacesInDouble) {
  VERNIER_NEEDS_GL(device);
  std::size_t rays = 0, throughLens = 0, inFront = 0, misses = 0, far = 0, eyesInside = 0;
  double worst_mm = 0;
  for (std::uint64_t seed = 1; seed <= 36; ++seed) {
    const RandomCase c = randomCase(seed);
    eyesInside += c.lens.contains(c.camera.eye) ? 1 : 0;
    Result<GlLensImages> drawing = GlLensImages::make(*device, c.camera, c.region, {});
    ASSERT_TRUE(drawing.ok()) << drawing.error().text();
    const Result<LensImages> images = drawing->draw(c.lens, true);
    ASSERT_TRUE(images.ok()) << images.error().text();
    for (int y = 0; y < c.camera.height_px; ++y)
      for (int x = 0; x < c.camera.width_px; ++x) {
        ++rays;
        const std::size_t texel = 4 * static_cast<std::size_t>(x + c.camera.width_px * y);
        const PatientRay ray = c.camera.ray(x + 0.5, y + 0.5);
        const double near_mm = c.camera.near_mm * c.camera.rayPerDepth(x + 0.5, y + 0.5);
        const RaySpan box = spanOf(ray, c.region, near_mm);
        const LineSpan lens = through(c.lens.planes, ray);
        const LineSpan both{std::max(lens.entry, box.entry_mm), std::min(lens.exit, box.exit_mm)};
        const auto has = [&](const std::vector<float>& image) { return image[texel + 3] != 0; };
        const auto at = [&](const std::vector<float>& image) {
          return drawing->along_mm(x, y, image.data() + texel);
        };
        // Wrong ones must be near a face where it is decided.
        const auto judge = [&](bool got, bool wanted, double t, const std::vector<HalfSpace>& decides) {
          if (got == wanted) return;
          ++misses;
          const double nearEnd = std::abs(t - near_mm);
          if (fromFace(decides, ray.at(t)) > kNear_mm && nearEnd > kNear_mm) ++far;
        };
        const bool inside = !box.empty() && !both.empty();
        throughLens += inside ? 1 : 0;
        judge(has(images->boxFront), !box.empty(), 0.5 * (box.entry_mm + box.exit_mm), c.region);
        std::vector<HalfSpace> closed = c.region;
        closed.insert(closed.end(), c.lens.planes.begin(), c.lens.planes.end());
        judge(has(images->lensFront), inside, 0.5 * (both.entry + both.exit), closed);
        ASSERT_EQ(has(images->lensFront), has(images->lensBack));
        if (!has(images->lensFront)) {  // region 0 beside the lens begins with the box
          ASSERT_EQ(has(images->transition0), has(images->boxFront));
          if (has(images->boxFront)) {
            ASSERT_EQ(at(images->transition0), at(images->boxFront));
          }
          ASSERT_FALSE(has(images->transition1));
          continue;
        }
        if (!inside) continue;
        const bool front = lens.entry > box.entry_mm, behind = lens.exit < box.exit_mm;
        inFront += front ? 1 : 0;
        judge(has(images->transition1), front, both.entry, c.region);
        judge(has(images->transition0), behind, both.exit, c.region);
        // Places: on the body's faces, or at the near distance.
        for (const auto* image : {&images->lensFront, &images->lensBack}) {
          const double t = at(*image);
          const double off = std::min(fromFace(closed, ray.at(t)), std::abs(t - near_mm));
          worst_mm = std::max(worst_mm, off);
        }
      }
  }
  EXPECT_GE(rays, 100000u);
  EXPECT_GT(throughLens, 20000u);
  EXPECT_GT(inFront, 10000u);
  EXPECT_GT(eyesInside, 1u);
  EXPECT_LE(misses, rays / 10000);
  EXPECT_EQ(far, 0u);
  EXPECT_LT(worst_mm, kNear_mm);
  RecordProperty("misses", static_cast<int>(misses));
  std::cout << "  " << rays << " rays, " << throughLens << " through a lens, " << misses
            << " of another class, faces to " << worst_mm << " mm\n";
}

TEST(GlLens, SpansAreThoseOfNative) {
  VERNIER_NEEDS_GL(device);
  std::size_t segments = 0, other = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const RandomCase c = randomCase(seed);
    Result<GlLensImages> drawing = GlLensImages::make(*device, c.camera, c.region, {});
    ASSERT_TRUE(drawing.ok());
    const Result<LensImages> images = drawing->draw(c.lens);
    ASSERT_TRUE(images.ok());
    const std::vector<native::LensSpans> spans{drawing->spans(*images)};
    native::LensRaysJob job;
    job.camera = c.camera, job.region = c.region;
    job.lenses = {std::make_shared<const ConvexRegion>(c.lens)};
    const std::vector<native::LensSpans> exact{[&] {
      native::LensSpans all{0, 0, 64, 48, {}};
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
          const LineSpan s = through(c.lens.planes, c.camera.ray(x + 0.5, y + 0.5));
          all.spans.push_back(s.empty() ? RaySpan{kInfinite, -kInfinite} : RaySpan{s.entry, s.exit});
        }
      return all;
    }()};
    Images gl, native;
    job.known = &spans;
    ASSERT_TRUE(native::cutRays(job, gl).ok());
    job.known = &exact;
    ASSERT_TRUE(native::cutRays(job, native).ok());
    for (std::size_t p = 0; p < 64 * 48; ++p) {
      const auto a = gl.rays->of(p), b = native.rays->of(p);
      bool same = a.size() == b.size();
      for (std::size_t n = 0; same && n < a.size(); ++n)
        same = a[n].appearance == b[n].appearance && a[n].beginsInside == b[n].beginsInside &&
               a[n].endsInside == b[n].endsInside && std::abs(a[n].from_mm - b[n].from_mm) < 0.02f &&
               std::abs(a[n].to_mm - b[n].to_mm) < 0.02f;
      ++segments, other += same ? 0 : 1;
    }
  }
  EXPECT_LE(other, segments / 1000) << segments;
}

test::GlHost& lensHost() {
  static test::GlHost host({angiography::registerAngiography, registerLens});
  return host;
}

struct PictureCase {
  Scene scene;
  View view{72, 60};
  Sources sources;

  explicit PictureCase(ProjectionMode mode) {
    VolumeInfo info;
    info.grid = test::unitGrid(40, 36, 30);
    std::vector<std::int16_t> v;
    for (int k = 0; k < 30; ++k)
      for (int j = 0; j < 36; ++j)
        for (int i = 0; i < 40; ++i)
          v.push_back(static_cast<std::int16_t>(500 + 300 * std::sin(0.4 * i + 0.1 * k) * std::cos(0.3 * j) +
                                                200 * std::sin(0.5 * k)));
    sources.volumes["v"] = test::volumeOf(info, v);
    scene.layers.emplace_back(projection(mode));
    scene.camera.azimuth_deg = 25, scene.camera.elevation_deg = 15;
  }
  static ProjectionLayer projection(ProjectionMode mode) {
    ProjectionLayer layer;
    layer.source = "v", layer.mode = mode;
    layer.window = VoiWindow{600, 900, VoiFunction::LinearExact, ""};
    return layer;
  }
  void addLens(LensInner inner, glm::dvec3 shift = glm::dvec3(0), double radius_mm = 9) {
    LensLayer lens;
    SphereShape sphere;
    sphere.radius_mm = radius_mm, sphere.divisions = 2;
    lens.shape = sphere;
    lens.pose.translation = sources.volumes["v"]->grid().centre().p + shift;
    lens.inner = std::move(inner);
    scene.layers.emplace_back(lens);
  }
  Result<Plan> plan(EngineChoice engine) const {
    Quality quality;
    quality.engine = engine;
    // The lattice of GL: at review native would take exact maxima.
    if (engine == EngineChoice::Native) quality.technique = "projection.native";
    test::GlHost& host = lensHost();
    return makePlan(scene, view, quality, host.capabilities, CostTable{}, sources, host.registry);
  }
  Images draw(EngineChoice engine) const {
    Images images;
    const Result<Plan> p = plan(engine);
    EXPECT_TRUE(p.ok()) << (p.ok() ? "" : p.error().text());
    if (!p) return images;
    images.allocate(view.width_px, view.height_px, false);
    for (const Pass& pass : p->passes) {
      EXPECT_EQ(pass.engine, engine == EngineChoice::Gl ? Engine::Gl : Engine::Native);
      const auto done = lensHost().registry.find(pass.technique)->execute(pass, images, {});
      EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().text());
    }
    EXPECT_FALSE(images.rays);
    return images;
  }
};

// Pixels that differ by more than `levels` of 255.
std::size_t different(const Images& a, const Images& b, double levels) {
  std::size_t n = 0;
  EXPECT_EQ(a.colour.size(), b.colour.size());
  for (std::size_t p = 0; p < a.colour.size(); p += 4)
    n += std::abs(a.colour[p] - b.colour[p]) * 255 > levels ? 1 : 0;
  return n;
}

TEST(GlLens, PicturesAsNative) {
  VERNIER_NEEDS_GL(device);
  for (const ProjectionMode mode : {ProjectionMode::Max, ProjectionMode::Sum}) {
    PictureCase c(mode);
    const Images without = c.draw(EngineChoice::Gl);
    c.addLens(PictureCase::projection(ProjectionMode::Mean));
    c.addLens(CutOut{}, {6, 4, 2}, 7);
    for (const Projection projection : {Projection::Orthographic, Projection::Perspective}) {
      c.scene.camera.projection = projection;
      const Images gl = c.draw(EngineChoice::Gl), native = c.draw(EngineChoice::Native);
      EXPECT_GT(different(gl, without, 5), 200u);
      EXPECT_LE(different(gl, native, 0.25), 4u);
    }
  }
}

TEST(GlLens, ALensThatChangesNothingIsNotSeen) {
  VERNIER_NEEDS_GL(device);
  for (const ProjectionMode mode :
       {ProjectionMode::Max, ProjectionMode::Min, ProjectionMode::Sum, ProjectionMode::Attenuation}) {
    PictureCase c(mode);
    const Images without = c.draw(EngineChoice::Gl);
    c.addLens(PictureCase::projection(mode));
    EXPECT_EQ(different(c.draw(EngineChoice::Gl), without, 0.25), 0u) << static_cast<int>(mode);
  }
}

TEST(GlLens, RefusesMoreThanFourLensesAndTooManyFaces) {
  VERNIER_NEEDS_GL(device);
  PictureCase c(ProjectionMode::Max);
  for (int n = 0; n < 4; ++n) c.addLens(CutOut{}, {2.0 * n - 3, 0, 0});
  EXPECT_TRUE(c.plan(EngineChoice::Gl).ok());
  c.addLens(CutOut{}, {6, 0, 0});
  EXPECT_TRUE(c.plan(EngineChoice::Native).ok());
  const Result<Plan> five = c.plan(EngineChoice::Gl);
  ASSERT_FALSE(five.ok());
  EXPECT_NE(five.error().sentence.find("up to 4 lenses, and there are 5"), std::string::npos)
      << five.error().sentence;

  PictureCase fine(ProjectionMode::Max);
  fine.addLens(CutOut{});
  std::get<SphereShape>(std::get<LensLayer>(fine.scene.layers[1]).shape).divisions = 5;
  const Result<Plan> faces = fine.plan(EngineChoice::Gl);
  ASSERT_FALSE(faces.ok());
  EXPECT_NE(faces.error().sentence.find("one here has 20480"), std::string::npos) << faces.error().sentence;
}

TEST(GlLens, CancelsAndSaysSo) {
  VERNIER_NEEDS_GL(device);
  const RandomCase c = randomCase(1);
  std::stop_source stop;
  Result<GlLensImages> drawing = GlLensImages::make(*device, c.camera, c.region, stop.get_token());
  ASSERT_TRUE(drawing.ok());
  stop.request_stop();
  EXPECT_EQ(drawing->draw(c.lens).error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier::lens
