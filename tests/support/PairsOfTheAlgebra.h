// SPDX-License-Identifier: GPL-3.0-or-later
// Every pair of what can be gathered outside and inside a lens (RayIntervals.h, quality/Reference.h), with
// the lens alone, with a clip plane, an opaque and a translucent tool: scenes of four voxels along the ray
// whose pixels can be worked out by hand. For the reference and the engines alike.
//
// Looking along y from y = -10 mm. Voxels at y = 0, 2, 4, 6 mm have 0.2, 0.8, 0.4, 0.6, the same along x and
// z (1 mm apart). The lens holds y from 1 to 5 for x above 0.5. Tools stand at y = 3, the clip plane leaves
// y from 2. So the ray falls into five stretches, of which all that follows is made:
//
//   y          0 .. 1  1 .. 2  2 .. 3  3 .. 5  5 .. 6
//   value      0.2-0.5 0.5-0.8 0.8-0.6 0.6-0.4-0.5 0.5-0.6
//   appearance outside inside  inside  inside  outside
//
// Steps of 1 mm have their middles at 0.5, 1.5, ...: the value bends and the ray is cut between them only, so
// that samples give the integrals exactly.
#pragma once
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "ConvexBox.h"
#include "vernier/plan/MakePlan.h"

namespace vernier::test::algebra {

enum class Kind { Blend, Iso, Max, Min, Mean, Sum, Attenuation, ShellsMax, ShellsSum, ShellsLit, CutOut };
inline constexpr const char* kKinds[] = {"blend",       "iso",        "max",        "min", "mean",   "sum",
                                         "attenuation", "shells max", "shells sum", "lit", "cut-out"};
enum class With { Nothing, Clip, Opaque, Translucent };
inline constexpr const char* kWith[] = {"", " with a clip plane", " with an opaque tool",
                                        " with a translucent tool"};

struct Case {
  std::string name;
  Kind outside, inside;
  With with;
  Scene scene;  // layer 0: outside; the lens last
  View view{4, 4};
  Sources sources;
  std::vector<PlacedLens> lenses;  // as lens shapes of this scene must come out
  struct Pixel {
    std::size_t index = 0;  // x + width * y
    glm::dvec3 colour{0};
    // The same where shells show their levels only, as level sets that are drawn do, not every value.
    glm::dvec3 ofLevels{0};
  };
  std::vector<Pixel> pixels;  // one through the lens, one beside it
};

// What is known of a stretch by hand: least and greatest value, integral over y, length, and how many
// crossings there are of the level 0.55 of the outside, of the levels 0.45 and 0.7 of the inside. The inside
// is cut open where it begins (0.5 at y = 1) and ends (0.5 at y = 5): 0.45 is crossed there too. The outside
// ends at y = 6 within 0.55.
struct Stretch {
  double least, most, integral, length;
  int of55, of45, of70;
};
inline constexpr Stretch kStretches[5] = {{0.2, 0.5, 0.35, 1, 0, 0, 0},
                                          {0.5, 0.8, 0.65, 1, 1, 1, 1},   // 1.17; cap; 1.67
                                          {0.6, 0.8, 0.70, 1, 0, 0, 1},   // 2.5
                                          {0.4, 0.6, 0.95, 2, 1, 3, 0},   // 3.25; 3.75, 4.5, cap
                                          {0.5, 0.6, 0.55, 1, 2, 0, 0}};  // 5.5, cap
// At y = 2 the clip plane cuts all levels open.
inline constexpr Stretch kClippedFirst{0.6, 0.8, 0.70, 1, 1, 1, 2};

inline constexpr double kGain = 0.1, kShellSum = 0.2;  // per mm; brightness of a crossing of level 1
inline constexpr glm::dvec3 kBackground{0.1, 0.2, 0.3}, kTool{0.2, 0.4, 0.9};

// One side of the lens: greys are value times `grey`, blended opacity is per mm.
struct Look {
  double grey, opacity, iso;
  glm::dvec3 blend, surface, shells;
};
inline constexpr Look kLooks[2] = {{1, 0.25, 0.55, {1, 0.5, 0}, {0, 1, 0}, {1, 1, 1}},
                                   {1.25, 0.5, 0.7, {0, 0.5, 1}, {1, 1, 0}, {1, 0.5, 0.25}}};

// The part of the answer that is gathered of one side.
struct Gathered {
  Kind kind = Kind::CutOut;
  bool covered = false;
  glm::dvec3 value{0};
  std::array<double, 5> before{1, 1, 1, 1, 1};  // Attenuation: what is left of light at a stretch's beginning
};

inline Gathered gathered(Kind kind, int side, const std::vector<int>& stretches, With with, bool ofLevels) {
  const Look& look = kLooks[side];
  Gathered g;
  g.kind = kind;
  double most = 0, least = 1, integral = 0, length = 0, seen = 0, emission = 0, shells = 0, brightest = 0;
  bool reaches = false;
  for (int n : stretches) {
    const Stretch& s = n == 2 && with == With::Clip ? kClippedFirst : kStretches[static_cast<std::size_t>(n)];
    const double tool = with == With::Translucent && n > 2 ? 0.5 : 1;
    most = std::max(most, tool * look.grey * s.most), least = std::min(least, tool * look.grey * s.least);
    integral += s.integral, length += s.length, seen += tool * s.length;
    emission += tool * look.grey * s.integral;
    const double weighed = tool * look.grey * kShellSum;
    shells += side == 0 ? weighed * 0.55 * s.of55 : weighed * (0.45 * s.of45 + 0.7 * s.of70);
    const double level = side == 0        ? (s.most >= 0.55 ? 0.55 : 0)
                         : s.most >= 0.7  ? 0.7
                         : s.most >= 0.45 ? 0.45
                                          : 0;
    reaches = reaches || level > 0;
    brightest = std::max(brightest, tool * look.grey * level);
    for (std::size_t after = static_cast<std::size_t>(n) + 1; after < 5; ++after)
      g.before[after] *= std::exp(-kGain * look.grey * s.integral);
  }
  g.covered = length > 0;
  if (!g.covered) return g;
  switch (kind) {
    case Kind::Max:
      g.value = glm::dvec3(most);
      break;
    case Kind::Min:
      g.value = glm::dvec3(least);
      break;
    case Kind::Mean:
      g.value = glm::dvec3(look.grey * integral / length * seen / length);
      break;
    case Kind::Sum:
      g.value = glm::dvec3(kGain * emission);
      break;
    case Kind::Attenuation:
      g.value = glm::dvec3(std::exp(-kGain * look.grey * integral));
      break;
    case Kind::ShellsMax:
      // The paper's rule: a level that is reached replaces the tool behind it, what reaches none does not.
      if (ofLevels || with == With::Opaque) g.covered = reaches;
      g.value = (ofLevels ? brightest : most) * look.shells;
      break;
    case Kind::ShellsSum:
      g.covered = shells > 0;
      g.value = shells * look.shells;
      break;
    default:
      g.covered = false;
  }
  return g;
}

// The pixel, for the ray through the lens or beside it.
inline glm::dvec3 answer(Kind outside, Kind inside, With with, bool through, bool ofLevels = false) {
  std::vector<int> order, of[2];
  for (int n = with == With::Clip ? 2 : 0; n < (with == With::Opaque ? 3 : 5); ++n) {
    order.push_back(n);
    of[through && n >= 1 && n <= 3 ? 1 : 0].push_back(n);
  }
  const Gathered a = gathered(outside, 0, of[0], with, ofLevels),
                 b = gathered(inside, 1, of[1], with, ofLevels);
  const auto sort = [](Kind k) {
    return k == Kind::ShellsMax ? Kind::Max : k == Kind::ShellsSum ? Kind::Sum : k;
  };
  const bool together = a.covered && b.covered && sort(a.kind) == sort(b.kind) && a.kind != Kind::Mean;
  const Gathered& last = b.covered ? b : a;
  // The tool weighed with what attenuates before it, stretches of ordered appearances from front to back.
  double reaching = 1;
  if (sort(last.kind) == Kind::Attenuation && last.covered) reaching = last.before[3];
  if (together && a.kind == Kind::Attenuation) reaching = a.before[3] * b.before[3];
  glm::dvec3 sum(0);
  double light = 1, ordered = 1;
  for (int n : order) {
    const int side = through && n >= 1 && n <= 3 ? 1 : 0;
    const Kind kind = side ? inside : outside;
    const Look& look = kLooks[side];
    const Stretch& s = kStretches[static_cast<std::size_t>(n)];
    if (with == With::Translucent && n == 3) sum += light * reaching * 0.5 * kTool, light *= 0.5;
    double left = 1;
    glm::dvec3 own(0);
    if (kind == Kind::Blend) own = look.blend, left = std::pow(1 - look.opacity, s.length);
    if (kind == Kind::Iso && s.most >= look.iso) own = look.surface, left = 0;
    if (kind == Kind::ShellsLit && s.most >= (side ? 0.45 : 0.55)) own = look.shells, left = 0;
    sum += light * (1 - left) * own;
    light *= left, ordered *= left;
  }
  // What ends the ray, behind the translucent tool.
  const double tools = with == With::Translucent ? 0.5 : 1;
  const bool opaque = with == With::Opaque;
  glm::dvec3 end = opaque ? kTool : glm::dvec3(0);
  if (!a.covered && !b.covered) {
    if (!opaque) end = outside == Kind::Attenuation ? glm::dvec3(1) : kBackground;
    return sum + ordered * tools * end;
  }
  const auto is = [&](Kind k) { return last.kind == k || (together && a.kind == k); };
  if (opaque && is(Kind::ShellsMax)) end = glm::dvec3(0);
  if (!opaque && is(Kind::Sum)) end = kBackground;
  if (!opaque && is(Kind::Attenuation)) end = glm::dvec3(1);
  end *= tools;
  glm::dvec3 shown(0);
  switch (sort(last.kind)) {
    case Kind::Max:
      shown = glm::max(together ? glm::max(a.value, b.value) : last.value, end);
      break;
    case Kind::Min:
      shown = glm::max(together ? glm::min(a.value, b.value) : last.value, end);
      break;
    case Kind::Sum:
      shown = (together ? a.value + b.value : last.value) + end;
      break;
    case Kind::Attenuation:
      shown = (together ? a.value * b.value : last.value) * end;
      break;
    default:
      shown = glm::max(last.value, end);
  }
  return sum + ordered * shown;
}

inline ShellsLayer shellsOf(int side, ShellsMode mode) {
  ShellsLayer l;
  l.source = "v", l.mode = mode;
  l.levels = side ? std::vector<double>{0.45, 0.7} : std::vector<double>{0.55};
  l.window = VoiWindow{0.5 / kLooks[side].grey, 1 / kLooks[side].grey, VoiFunction::LinearExact, ""};
  const glm::dvec3 c = kLooks[side].shells;
  l.colour = {c.x, c.y, c.z};
  if (mode == ShellsMode::Sum) l.betaM = kShellSum;
  return l;
}

// `Any`: Layer, or the inside of a lens.
template <class Any>
Any lookOf(Kind kind, int side) {
  const Look& look = kLooks[side];
  ProjectionLayer p;
  p.source = "v", p.gain_perMm = kGain;
  p.window = VoiWindow{0.5 / look.grey, 1 / look.grey, VoiFunction::LinearExact, ""};
  switch (kind) {
    case Kind::Blend: {
      VolumeLayer v;
      v.source = "v";
      v.classification = Classification::Post;
      v.transfer = TransferFunction{{{0, look.blend}}, {{0, look.opacity}}, 1};
      return v;
    }
    case Kind::Iso: {
      IsosurfaceLayer i;
      i.source = "v", i.level = look.iso;
      const Rgb own{look.surface.x, look.surface.y, look.surface.z};
      i.material = {1, 0, 0, 1, own, own};
      return i;
    }
    case Kind::ShellsMax:
      return shellsOf(side, ShellsMode::Max);
    case Kind::ShellsSum:
      return shellsOf(side, ShellsMode::Sum);
    case Kind::ShellsLit:
      return shellsOf(side, ShellsMode::Lit);
    case Kind::Min:
      p.mode = ProjectionMode::Min;
      return p;
    case Kind::Mean:
      p.mode = ProjectionMode::Mean;
      return p;
    case Kind::Sum:
      p.mode = ProjectionMode::Sum;
      return p;
    case Kind::Attenuation:
      p.mode = ProjectionMode::Attenuation;
      return p;
    default:
      return p;
  }
}

inline std::shared_ptr<const Volume> fourVoxels() {
  VolumeInfo info;
  info.grid.columns = 2, info.grid.rows = 4, info.grid.slices = 2;
  info.grid.patientFromVoxel.linear[1][1] = 2;
  info.type = VoxelType::F32;
  std::vector<float> v;
  for (int k = 0; k < 2; ++k)
    for (float along : {0.2f, 0.8f, 0.4f, 0.6f})
      for (int i = 0; i < 2; ++i) v.push_back(along);
  auto buffer = Buffer::make(v.size() * sizeof(float));
  std::memcpy(buffer->data(), v.data(), v.size() * sizeof(float));
  return *Volume::make(std::move(info), std::move(*buffer));
}

inline Case makeCase(Kind outside, Kind inside, With with, const std::shared_ptr<const Volume>& volume) {
  Case c{std::string(kKinds[static_cast<std::size_t>(outside)]) + " around " +
             kKinds[static_cast<std::size_t>(inside)] + kWith[static_cast<std::size_t>(with)],
         outside,
         inside,
         with,
         {},
         {4, 4},
         {},
         {},
         {}};
  c.sources.volumes["v"] = volume;
  Scene& s = c.scene;
  s.background = {kBackground.x, kBackground.y, kBackground.z};
  s.camera.height_mm = 0.8, s.camera.distance_mm = 13;
  s.layers.push_back(lookOf<Layer>(outside, 0));
  if (with == With::Clip) s.clip.push_back({PatientVec(0, -1, 0), -2});
  if (with == With::Opaque || with == With::Translucent) {
    MeshBuilder b;
    const std::uint32_t v[4] = {b.vertex({-9, 3, -9}), b.vertex({9, 3, -9}), b.vertex({9, 3, 9}),
                                b.vertex({-9, 3, 9})};
    b.triangle(v[0], v[1], v[2]);
    b.triangle(v[0], v[2], v[3]);
    c.sources.meshes["sheet"] = *b.finish();
    SurfaceLayer tool;
    tool.source = "sheet", tool.colour = {kTool.x, kTool.y, kTool.z};
    tool.opacity = with == With::Opaque ? 1 : 0.5;
    s.layers.push_back(tool);
  }
  LensLayer lens;
  lens.shape = BoxShape{MeshPoint(5.5, 3, 0), {10, 4, 20}};
  if (inside != Kind::CutOut) lens.inner = lookOf<LensInner>(inside, 1);
  s.layers.push_back(lens);
  c.lenses = {{boxRegion({0.5, 1, -10}, {10.5, 5, 10}), s.layers.size() - 1}};
  for (const bool through : {true, false})
    c.pixels.push_back({through ? std::size_t{6} : std::size_t{5}, answer(outside, inside, with, through),
                        answer(outside, inside, with, through, true)});
  return c;
}

inline std::vector<Case> pairs() {
  const std::shared_ptr<const Volume> volume = fourVoxels();
  std::vector<Case> out;
  for (int a = 0; a <= static_cast<int>(Kind::ShellsLit); ++a)
    for (int b = 0; b <= static_cast<int>(Kind::CutOut); ++b)
      for (With with : {With::Nothing, With::Clip, With::Opaque, With::Translucent})
        out.push_back(makeCase(static_cast<Kind>(a), static_cast<Kind>(b), with, volume));
  return out;
}

}  // namespace vernier::test::algebra
