// SPDX-License-Identifier: GPL-3.0-or-later
// Stacks by combiners: each that ships against the combiner's evaluation in double, on registers that are
// filled in double; and those that say what a stack does by itself against that stack.
#include <gmock/gmock.h>

#include "Combiner.h"
#include "GlCases.h"
#include "StackGeometry.h"

namespace vernier::test {
namespace {

using dvr::Combiner;
using dvr::Quantity;
using ::testing::HasSubstr;

class CombinedTruth {
 public:
  CombinedTruth(const DvrCase& c, const Combiner& combiner)
      : case_(c),
        combiner_(combiner),
        truth_(c),
        axis_(dvr::stackAxis(c.camera(), c.volume().grid())),
        perVoxel_(dvr::slicesPerVoxel(c.quality.step)) {}

  // One slice after the other, back to front; of combiners for one slice on a polygon.
  glm::dvec3 colour(double x, double y) const {
    const RaySpan s = truth_.span(x, y);
    glm::dvec3 seen = DvrTruth::rgb(case_.scene.background);
    if (s.empty()) return seen;
    const auto samples = truth_.stackSamples(x, y, s, axis_, perVoxel_);
    const bool level = combiner_.test == dvr::FragmentTest::Level;
    for (std::size_t n = samples.size(); n-- > 0;) {
      if (level && !samples[n].met) continue;
      const glm::dvec4 c = fragment(samples[n], -truth_.camera().ray(x, y).direction.v);
      if (level)
        seen = c.w < share(*std::get<IsosurfaceLayer>(case_.scene.layers[0]).level) ? seen : glm::dvec3(c);
      else
        seen = combiner_.blend == dvr::Blending::Over ? glm::dvec3(c) * c.w + seen * (1 - c.w)
                                                      : glm::dvec3(c) + seen * (1 - c.w);
    }
    return seen;
  }

 private:
  double share(double value) const {
    const Volume::Range r = *case_.volume().modalityRange();
    return (value - r.min) / (r.max - r.min);
  }
  // In the two planes that the slice lies between, or in the slice itself.
  glm::dvec3 placeOf(const DvrTruth::StackSample& s, std::size_t index) const {
    glm::dvec3 p = s.voxel;
    if (!uses(combiner_, Quantity::Interpolation)) return p;
    const double lower = std::floor(p[axis_]);
    p[axis_] = lower + (index == 1 && p[axis_] > lower ? 1 : 0);
    return p;
  }
  // Bilinear between unit normals of voxels, which point to lower values; along the axis too where the place
  // lies between two planes.
  glm::dvec3 normal(glm::dvec3 p) const {
    const GridGeometry& g = case_.volume().grid();
    p = glm::clamp(p, glm::dvec3(0), glm::dvec3(g.columns - 1, g.rows - 1, g.slices - 1));
    glm::dvec3 sum(0);
    for (int corner = 0; corner < 8; ++corner) {
      glm::dvec3 at = glm::floor(p);
      double w = 1;
      for (int n = 0; n < 3; ++n) {
        const double t = p[n] - at[n];
        w *= corner >> n & 1 ? t : 1 - t;
        at[n] += corner >> n & 1;
      }
      if (w < 1e-12) continue;
      const glm::dvec3 gradient = truth_.gradient(at, *truth_.field(at));
      if (glm::length(gradient) > 1e-3) sum -= w * glm::normalize(gradient);
    }
    return sum;
  }
  glm::dvec4 fragment(const DvrTruth::StackSample& s, glm::dvec3 eye) const {
    const Material& m = truth_.material();
    const auto light = [&](std::size_t n) {
      return n < case_.scene.lights.size() ? case_.scene.lights[n] : Light{};
    };
    const auto colourAt = [&](glm::dvec3 p) { return truth_.sampleAtVoxel(p, eye, s.length_mm); };
    return combine(combiner_, filledRegisters(combiner_, [&](const dvr::Input& in) {
                     const glm::dvec3 p = placeOf(s, in.index);
                     const glm::dvec3 lightColour = DvrTruth::rgb(light(in.index).colour);
                     switch (in.what) {
                       case Quantity::Colour:
                         return colourAt(p);
                       case Quantity::WeightedColour:
                         return glm::dvec4(glm::dvec3(colourAt(p)) * colourAt(p).w, colourAt(p).w);
                       case Quantity::NormalValue:
                         return glm::dvec4(normal(p), share(*truth_.field(p)));
                       case Quantity::NormalOpacity:
                         return glm::dvec4(normal(p), colourAt(p).w);
                       case Quantity::Normal:
                         return glm::dvec4(normal(p), 0);
                       case Quantity::Interpolation:
                         return glm::dvec4(s.voxel[axis_] - std::floor(s.voxel[axis_]));
                       case Quantity::LightDirection:
                         return glm::dvec4(
                             light(in.index).towards ? glm::normalize(light(in.index).towards->v) : eye, 0);
                       case Quantity::Diffuse:
                         return glm::dvec4(m.diffuse * DvrTruth::rgb(m.diffuseColour) * lightColour, 0);
                       case Quantity::OwnDiffuse:
                         return glm::dvec4(m.diffuse * lightColour, 0);
                       case Quantity::Ambient:
                         return glm::dvec4(m.ambient * DvrTruth::rgb(m.ambientColour), 0);
                       case Quantity::AmbientStrength:
                         return glm::dvec4(m.ambient);
                       case Quantity::Given:
                         break;
                     }
                     return in.given;
                   }));
  }
  const DvrCase& case_;
  const Combiner& combiner_;
  DvrTruth truth_;
  int axis_, perVoxel_;
};

void light(DvrCase& c) { c.scene.lights = {Light{}, Light{PatientVec(1, -2, 3), {0.7, 0.2, 0.1}}}; }

TEST(GlCombined, EachForOneSliceEqualsItsEvaluationInDouble) {
  VERNIER_NEEDS_GL(device);
  for (const char* name :
       {"intermediate-slice", "intermediate-slice-weighted", "shaded-global", "shaded-per-voxel",
        "shaded-own-colour", "iso", "iso-two-lights", "iso-two-colours"}) {
    SCOPED_TRACE(name);
    const Result<Combiner> combiner = dvr::findCombiner(name);
    ASSERT_TRUE(combiner.ok()) << combiner.error().text();
    const bool iso = combiner->test == dvr::FragmentTest::Level;
    for (const Projection projection : kBothProjections) {
      DvrCase c(bumpyVolume(tiltedGrid(30, 28, 22), {}, 30), iso);
      c.scene.camera.projection = projection, c.quality.step = 0.5, c.view = {40, 36};
      light(c);
      if (iso)
        c.iso().combiner = name, c.scene.camera.zoom = 2;
      else
        c.layer().combiner = name, c.layer().material.ambientColour = {0.3, 0.4, 0.9};
      c.scene.crop = CropBox{VoxelPoint(3.2, 2.7, 1.1), VoxelPoint(26.4, 25.1, 19.6)};
      const CombinedTruth truth(c, *combiner);
      expectClose(
          c, "dvr.combined", [&](double x, double y) { return truth.colour(x, y); }, iso ? 0.003 : 0.001);
    }
  }
}

// Figure 8 and its like for four slices are what stacks2 and stacks4 do.
TEST(GlCombined, CombinersOfSlicesEqualTheStacksThatNeedNone) {
  VERNIER_NEEDS_GL(device);
  struct Same {
    const char *combiner, *technique;
    double step;
  };
  for (const Same& same : {Same{"two-slices", "dvr.stacks2", 1}, Same{"four-slices", "dvr.stacks4", 1},
                           Same{"two-slices", "dvr.stacks", 0.5}})
    for (const Projection projection : kBothProjections) {
      DvrCase c;
      c.scene.camera.projection = projection, c.quality.step = same.step;
      c.scene.crop = CropBox{VoxelPoint(3.2, 2.7, 1.1), VoxelPoint(26.4, 25.1, 19.6)};
      const Result<Images> plain = c.draw(same.technique);
      c.layer().combiner = same.combiner;
      const Result<Images> combined = c.draw("dvr.combined");
      ASSERT_TRUE(combined.ok()) << combined.error().text();
      expectSomething(c, *combined);
      EXPECT_LT(offFrom(*combined, colourOf(*plain)).worst, 0.1) << same.combiner;
    }
}

TEST(GlCombined, EachThatShipsIsDrawn) {
  VERNIER_NEEDS_GL(device);
  const std::vector<std::string> names = dvr::combinerNames();
  EXPECT_GE(names.size(), 11u);
  for (const std::string& name : names) {
    const bool iso = dvr::findCombiner(name)->test == dvr::FragmentTest::Level;
    DvrCase c(bumpyVolume(), iso);
    c.view = {24, 20};
    (iso ? c.iso().combiner : c.layer().combiner) = name;
    const Result<Images> images = c.draw("dvr.combined");
    ASSERT_TRUE(images.ok()) << images.error().text();
    expectSomething(c, *images);
  }
}

TEST(GlCombined, WhatDoesNotFitIsRefused) {
  VERNIER_NEEDS_GL(device);
  const auto why = [](const DvrCase& c, const char* technique = "dvr.combined") {
    const Result<Plan> plan = c.plan(technique);
    return plan ? std::string("nothing") : plan.error().sentence;
  };
  DvrCase c;
  EXPECT_THAT(why(c), HasSubstr("names no combiner"));
  c.layer().combiner = "iso";
  EXPECT_THAT(why(c), HasSubstr("tests for a level"));
  EXPECT_THAT(why(c, "dvr.stacks"), HasSubstr("dvr.combined"));
  EXPECT_THAT(why(c, "dvr.slabs"), HasSubstr("stacks"));
  EXPECT_THAT(why(c, "dvr.rays"), HasSubstr("stacks"));
  c.layer().combiner = "no-such";
  EXPECT_THAT(why(c), HasSubstr("no-such"));
  c.layer().combiner = "two-slices", c.layer().mode = VolumeMode::Max;
  EXPECT_THAT(why(c), HasSubstr("extremes"));
  DvrCase iso(bumpyVolume(), true);
  iso.iso().combiner = "shaded-global";
  EXPECT_THAT(why(iso), HasSubstr("does not test"));
  DvrCase colours(colourVolume());
  colours.layer().combiner = "shaded-per-voxel";
  EXPECT_THAT(why(colours), HasSubstr("needs normals"));
}

TEST(GlCombined, AllStateIsStated) {
  VERNIER_NEEDS_GL(device);
  DvrCase c;
  c.layer().combiner = "shaded-per-voxel";
  const Result<Images> clean = c.draw("dvr.combined");
  for (const unsigned seed : {1u, 2u}) {
    device->setOddStateForTest(seed);
    EXPECT_EQ(c.draw("dvr.combined")->colour, clean->colour);
  }
}

}  // namespace
}  // namespace vernier::test
