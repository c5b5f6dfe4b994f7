// SPDX-License-Identifier: GPL-3.0-or-later
// The reference with lenses: closed forms, intervals, what changes nothing.
#include <cmath>

#include "LensScenes.h"
#include "VolumeBrute.h"

namespace vernier::quality {
namespace {

using namespace vernier::test;

// In front of the lens, inside and behind: exponentials, with faces anywhere.
TEST(LensReference, AConstantVolumeIsThreeExponentials) {
  for (const auto& [from, to] :
       {std::pair(0.5, 1.25), {-1.0, 0.7}, {1.1, 7.0}, {-2.0, 9.0}, {1.5, 1.5000001}}) {
    LensScene s(fourVoxels(blendOf({1, 0, 0}, 0.3), kOne));
    s.scene.background = {0.1, 0.2, 0.3};
    s.sheetLens(from, to, blendOf({0, 1, 0}, 0.8));
    const double a = std::max(0.0, from), b = std::min(3.0, to);
    const double first = std::pow(0.7, a), in = std::pow(0.2, b - a), last = std::pow(0.7, 3 - b);
    const double left = first * in * last;
    s.expect({1 - first + first * in * (1 - last) + 0.1 * left, first * (1 - in) + 0.2 * left, 0.3 * left},
             1e-12);
  }
}

TEST(LensReference, ARampInParts) {
  // Sum of the outside over [0, 1] and [2.5, 3], of the inside (twice the gain) over [1, 2.5].
  LensScene sum(fourVoxels(projectionOf(ProjectionMode::Sum), kRamp));
  sum.sheetLens(1, 2.5, projectionOf(ProjectionMode::Sum, 0.2));
  const double out = (0.5 + (9 - 6.25) / 2) / 4 * 0.1, in = (6.25 - 1) / 2 / 4 * 0.2;
  sum.expect(glm::dvec3(out + in), 1e-12);
  LensScene mean(fourVoxels(projectionOf(ProjectionMode::Mean), kRamp));
  mean.sheetLens(1, 2.5, CutOut{});
  mean.expect(glm::dvec3((0.5 + (9 - 6.25) / 2) / 1.5 / 4), 1e-12);
  // Maxima: of the outside 1/4 and, behind the lens, 3/4.
  LensScene max(fourVoxels(projectionOf(ProjectionMode::Max), kRamp));
  max.sheetLens(1, 2.5, CutOut{});
  max.expect(glm::dvec3(0.75), 1e-12);
  max.scene.layers.pop_back(), max.options.lenses->clear();
  max.sheetLens(1, 5, CutOut{});
  max.expect(glm::dvec3(0.25), 1e-12);
  max.sheetLens(0.25, 0.625, projectionOf(ProjectionMode::Max));
  max.sheetLens(0.5, 4, CutOut{});  // the later wins
  max.expect(glm::dvec3(0.125), 1e-12);
}

TEST(LensReference, TheLaterOfTwoLensesWins) {
  LensScene s(fourVoxels(blendOf({1, 0, 0}, 0.3), kOne));
  s.sheetLens(0.5, 2, blendOf({0, 1, 0}, 0.8));
  s.sheetLens(1, 2.5, blendOf({0, 0, 1}, 0.6));
  const double a = std::pow(0.7, 0.5), b = std::pow(0.2, 0.5), c = std::pow(0.4, 1.5), d = a;
  s.expect({1 - a + a * b * c * (1 - d), a * (1 - b), a * b * (1 - c)}, 1e-12);
  // A small one inside a large one, and hidden when the large one is the later.
  LensScene nested(fourVoxels(blendOf({1, 0, 0}, 0.3), kOne));
  nested.sheetLens(-1, 4, CutOut{});
  nested.sheetLens(1, 2, blendOf({0, 1, 0}, 0.8));
  nested.expect({0, 0.8, 0}, 1e-12);
  std::swap((*nested.options.lenses)[0].region, (*nested.options.lenses)[1].region);
  std::swap(std::get<LensLayer>(nested.scene.layers[1]).inner,
            std::get<LensLayer>(nested.scene.layers[2]).inner);
  nested.expect({0, 0, 0}, 1e-12);
}

// An iso-surface inside is cut open by the lens; where the outside's begins again behind it too.
TEST(LensReference, PartsOfAnIsosurfaceBeginWithFaces) {
  const auto iso = [](double level, Rgb own) {
    IsosurfaceLayer i;
    i.source = "v", i.level = level;
    i.material = {1, 0, 0, 1, own, own};
    return i;
  };
  LensScene s(fourVoxels(iso(2, {1, 0, 0}), kRamp));
  s.sheetLens(1, 2.5, iso(0.5, {0, 1, 0}));
  s.expect({0, 1, 0});
  LensScene behind(fourVoxels(iso(2, {1, 0, 0}), kRamp));
  behind.sheetLens(1, 2.5, blendOf({0, 0, 1}, 0.5));
  const double left = std::pow(0.5, 1.5);
  behind.expect({left, 0, 1 - left}, 1e-12);
  // Faces are turned to the eye whatever the field does: diffuse light from there is full.
  LensScene face(fourVoxels(iso(2, {1, 0, 0}), kRamp));
  IsosurfaceLayer lit = iso(0.5, {0, 1, 0});
  lit.material.ambient = 0, lit.material.diffuse = 1;
  face.lens(std::make_shared<ConvexRegion>(
                ConvexRegion{{{PatientVec(glm::normalize(glm::dvec3(1, -1, 0))), -0.1}}, {}, {}, {}, {}}),
            lit);
  face.expect({0, 1, 0});
}

ShellsLayer shellsOf(ShellsMode mode, std::vector<double> levels) {
  ShellsLayer l;
  l.source = "v", l.mode = mode, l.levels = std::move(levels);
  l.window = VoiWindow{2, 4, VoiFunction::LinearExact, ""};
  return l;
}

TEST(LensReference, CapsOfShells) {
  // Levels 1 and 2 of a ramp: crossed at 1 and 2, left at 3 where the volume ends.
  LensScene s(fourVoxels(shellsOf(ShellsMode::Sum, {1, 2}), kRamp));
  const double whole = 2 * (0.25 + 0.5);
  s.expect(glm::dvec3(whole));
  // Cut out from 1.5 to 2.5: level 1 is left and entered again, 2 is entered at 2.5 instead of 2.
  s.sheetLens(1.5, 2.5, CutOut{});
  s.expect(glm::dvec3(whole + 2 * 0.25));
  // The same shells inside: nothing is cut open.
  LensScene same(fourVoxels(shellsOf(ShellsMode::Sum, {1, 2}), kRamp));
  same.sheetLens(1.5, 2.5, shellsOf(ShellsMode::Sum, {1, 2}));
  same.expect(glm::dvec3(whole));
  // Lit ones: the cap has the normal of the face that cuts, 45 degrees to the ray.
  LensScene lit(fourVoxels(shellsOf(ShellsMode::Lit, {2.9}), kRamp));
  lit.lens(std::make_shared<ConvexRegion>(
               ConvexRegion{{{PatientVec(glm::normalize(glm::dvec3(1, -1, 0))), -0.8}}, {}, {}, {}, {}}),
           shellsOf(ShellsMode::Lit, {0.1}));
  lit.expect(glm::dvec3(0.2 + 0.8 * std::sqrt(0.5)));
}

// Whatever it is, a lens whose inside is the outside changes nothing; any number of faces.
TEST(LensReference, AnInsideLikeTheOutsideChangesNothing) {
  int compared = 0;
  for (std::uint64_t n = 0; n < 260; ++n) {
    const auto draw = [&](std::uint64_t k) { return randomUnit(900 + n, k); };
    LensInner inner;
    switch (n % 12) {
      case 0:
      case 1: {
        VolumeLayer v = blendOf({0, 0, 0}, 0);
        v.transfer->colours = {{0.2, {1, 0.5, 0}}, {0.8, {0, 0.5, 1}}};
        v.transfer->opacities = {{0.2, 0}, {0.5, 0.3}, {0.5, 0.6}, {0.9, 0.7}};
        if (n % 12 == 1) v.shading = ShadingModel::ColourPerVoxel;
        inner = v;
        break;
      }
      case 2: {
        IsosurfaceLayer i;
        i.source = "v", i.level = 0.3 + 0.5 * draw(1);
        inner = i;
        break;
      }
      case 3:
      case 4:
      case 5:
      case 6:
      case 7: {
        ProjectionLayer p = projectionOf(static_cast<ProjectionMode>(n % 12 - 3));
        p.window = unitWindow();
        if (p.mode == ProjectionMode::Max) p.cue = draw(2);
        inner = p;
        break;
      }
      default: {
        ShellsLayer l = shellsOf(n % 12 == 8   ? ShellsMode::Lit
                                 : n % 12 == 9 ? ShellsMode::Sum
                                               : ShellsMode::Max,
                                 {0.3, 0.5, 0.7});
        l.window = unitWindow(), l.a = draw(3), l.beta0 = 0.1, l.phi0 = 0.5;
        if (n % 12 == 11) l.surfaceBlend = SurfaceBlend::Max;
        inner = l;
      }
    }
    const Layer base = std::visit(
        [](const auto& l) -> Layer {
          if constexpr (requires { l.source; })
            return l;
          else
            return CustomLayer{};
        },
        inner);
    BruteCase c = randomCase(n, base);
    LensScene s(std::move(c.s));
    s.scene.background = {0.1, 0.3, 0.2};
    std::vector<std::size_t> at;
    for (std::size_t p = 0; p < 1200; p += 37) at.push_back(p);
    const auto before = s.pixels(at);
    ASSERT_TRUE(before.ok()) << before.error().text();
    const glm::dvec3 middle = s.sources.volumes["v"]->grid().centre().p;
    for (std::uint64_t w = 0; w < 1 + n % 3; ++w) {
      auto region = std::make_shared<ConvexRegion>();
      const auto faces = static_cast<std::uint64_t>(4 + 60 * draw(4 + w));
      for (std::uint64_t f = 0; f < faces; ++f) {
        const glm::dvec3 normal =
            glm::normalize(glm::dvec3(randomUnit(n + 1000 * w, 3 * f), randomUnit(n + 1000 * w, 3 * f + 1),
                                      randomUnit(n + 1000 * w, 3 * f + 2)) -
                           0.5);
        region->planes.push_back({PatientVec(normal), glm::dot(normal, middle) + 0.2 + 0.6 * draw(8 + w)});
      }
      s.lens(region, inner);
    }
    const auto after = s.pixels(at);
    ASSERT_TRUE(after.ok()) << after.error().text();
    // What is integrated to 1e-7 of each stretch is not cut in the same places (lit at gaps, where the normal
    // turns is not known: 0.03 levels); next to no-data the field is
    // a ratio of cubics.
    const double within = n % 12 == 1 ? 1e-4 : n % 12 == 0 ? 3e-7 : n % 5 == 3 ? 1e-7 : 1e-9;
    for (std::size_t k = 0; k < at.size(); ++k, ++compared)
      EXPECT_LT(glm::length((*after)[k].rgba - (*before)[k].rgba), within)
          << "kind " << n % 12 << ", scene " << n << ", pixel " << at[k];
  }
  EXPECT_EQ(compared, 260 * 33);
}

// A wheel of ten thousand faces around the ray's axis; one thinner than a voxel; one that lies beside the
// ray, behind the eye, around everything.
TEST(LensReference, AwkwardLenses) {
  const double plain = 1 - std::pow(0.7, 3);
  const auto around = [](int faces, double from, double to, double radius) {
    auto r = std::make_shared<ConvexRegion>();
    for (int f = 0; f < faces; ++f) {
      const double a = 2 * 3.14159265358979 * f / faces;
      const glm::dvec3 n(std::cos(a), 0, std::sin(a));
      r->planes.push_back({PatientVec(n), glm::dot(n, glm::dvec3(0.5, 0, 0.5)) + radius});
    }
    r->planes.push_back({PatientVec(0, -1, 0), -from});
    r->planes.push_back({PatientVec(0, 1, 0), to});
    return r;
  };
  const auto with = [&](std::shared_ptr<const ConvexRegion> region) {
    LensScene s(fourVoxels(blendOf({1, 1, 1}, 0.3), kOne));
    s.lens(std::move(region), CutOut{});
    return s;
  };
  with(around(9998, 1, 2, 0.2)).expect(glm::dvec3(1 - 0.49), 1e-12);
  with(around(48, 1, 1.001, 0.2)).expect(glm::dvec3(1 - std::pow(0.7, 2.999)), 1e-12);
  with(around(48, -1e6, 1e6, 1e6)).expect(glm::dvec3(0), 1e-12);
  with(boxRegion({0.8, -9, -9}, {9, 9, 9})).expect(glm::dvec3(plain), 1e-12);
  with(boxRegion({-9, -30, -9}, {9, -20, 9})).expect(glm::dvec3(plain), 1e-12);
  with(boxRegion({-9, 4, -9}, {9, 20, 9})).expect(glm::dvec3(plain), 1e-12);
  // Exactly the box of voxel centres, and a face that the ray runs along: closed.
  with(boxRegion({0, 0, 0}, {1, 3, 1})).expect(glm::dvec3(0), 1e-12);
  with(boxRegion({0.5, 1, 0}, {9, 2, 1})).expect(glm::dvec3(1 - 0.49), 1e-12);
}

// Samples of the lattice do not move: an inside like the outside is bit for bit the same algorithm, but for
// steps that are split by exponent.
TEST(LensReference, TheLatticeOfSamples) {
  VolumeLayer ramp = blendOf({1, 0, 0}, 0);
  ramp.classification = Classification::Post;
  ramp.transfer->opacities = {{0, 0}, {3, 0.9}};
  VolumeLayer other = ramp;
  other.transfer->colours = {{0, {0, 1, 0}}};
  LensScene s(fourVoxels(ramp, kRamp));
  s.options.kind = ErrorKind::Implementation;
  const auto before = s.pixels({0});
  s.sheetLens(0.3, 2.2, ramp);
  const auto after = s.pixels({0});
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_NEAR((*before)[0].rgba.x, (*after)[0].rgba.x, 1e-14);
  // Samples at 0.5, 1.5, 2.5 mm: opacities 0.15, 0.45, 0.75 of a step, split at 0.3 and 2.2.
  std::get<LensLayer>(s.scene.layers[1]).inner = other;
  const double a = std::pow(0.85, 0.3), b = std::pow(0.85, 0.7) * 0.55 * std::pow(0.25, 0.2),
               c = std::pow(0.25, 0.8);
  s.expect({1 - a + a * b * (1 - c), a * (1 - b), 0}, 1e-12);
  std::get<LensLayer>(s.scene.layers[1]).inner = projectionOf(ProjectionMode::Max);
  EXPECT_EQ(s.pixels({0}).error().code, ErrorCode::NotBuiltYet);
}

}  // namespace
}  // namespace vernier::quality
