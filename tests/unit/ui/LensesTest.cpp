// SPDX-License-Identifier: GPL-3.0-or-later
// Lenses by hand on slices: circles on pictures, looks, and edits with their undo.
#include "Lenses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "Facts.h"
#include "vernier/plan/LensEdits.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

const View kView{200, 160};

Workspace withMpr() {
  Workspace w;
  w.know(test::axialFacts(1, "a"));
  w.open({1, "a"}, 0);
  EXPECT_TRUE(w.openMpr());
  return w;
}
Place placeOfTile(const Workspace& w, int t) {
  return *placeOf(w.tile(t).scene, *w.factsOfTile(t), &*w.factsOfTile(t)->grid, kView);
}
LensLook bone() {
  return {"Bone", SliceLook{Interpolation::Linear, VoiWindow{400, 1800, VoiFunction::Linear, ""}, false}};
}

std::size_t lensesIn(const Scene& s) {
  std::size_t n = 0;
  for (const Layer& l : s.layers) n += std::holds_alternative<LensLayer>(l);
  return n;
}

TEST(Lenses, ThePlaneCutsTheSphereInACircle) {
  Workspace w = withMpr();
  const Place axial = placeOfTile(w, 0);
  const PatientPoint on = axial.patientAt({70, 50});
  for (const double away : {0.0, 3.0, -4.0, 4.97, 4.98, 9.0}) {
    const LensLayer lens =
        lensAt(LensPreset::Bone, *layerBehindLens(w.tile(0).scene), on + away * axial.normal, 5);
    const auto disc = discOf(lens, axial);
    ASSERT_EQ(disc.has_value(), std::abs(away) < 4.975) << away;
    EXPECT_EQ(cuts(sliceOf(w.tile(0).scene)->plane, lens), disc.has_value()) << away;
    if (!disc) continue;
    EXPECT_LT(glm::length(disc->centre_px - glm::dvec2(70, 50)), 1e-9);
    // A point on the circle lies on the sphere.
    const PatientPoint rim = axial.patientAt(disc->centre_px + disc->radius_px * glm::dvec2(0.6, -0.8));
    EXPECT_NEAR(length(rim - middleOf(lens)), 5, 1e-9) << away;
  }
}

TEST(Lenses, TheHandTakesOutlineOrInside) {
  const LensDisc d{{50, 50}, 30, 0, 10};
  EXPECT_EQ(partOf(d, {50, 50}, 6), LensPart::Inside);
  EXPECT_EQ(partOf(d, {73, 50}, 6), LensPart::Inside);
  EXPECT_EQ(partOf(d, {75, 50}, 6), LensPart::Outline);
  EXPECT_EQ(partOf(d, {85, 50}, 6), LensPart::Outline);
  EXPECT_FALSE(partOf(d, {87, 50}, 6));
  const LensDisc small{{50, 50}, 5, 0, 10};
  EXPECT_EQ(partOf(small, {52, 50}, 6), LensPart::Inside);
}

TEST(Lenses, ItIsMovedAcrossThePictureAndItsCircleScaled) {
  Workspace w = withMpr();
  const Place coronal = placeOfTile(w, 1);
  const LensLayer lens = lensAt(LensPreset::Bone, *layerBehindLens(w.tile(1).scene),
                                coronal.patientAt({70, 50}) + 2.0 * coronal.normal, 5);
  const LensLayer moved = movedLens(lens, coronal, {13, -7});
  EXPECT_LT(glm::length(discOf(moved, coronal)->centre_px - glm::dvec2(83, 43)), 1e-9);
  EXPECT_NEAR(discOf(moved, coronal)->away_mm, 2, 1e-9) << "it keeps its depth";
  const LensLayer wide = lensWithRadius(lens, coronal, 44);
  EXPECT_NEAR(discOf(wide, coronal)->radius_px, 44, 1e-9);
  EXPECT_LT(glm::length(discOf(wide, coronal)->centre_px - glm::dvec2(70, 50)), 1e-9);
  EXPECT_NEAR(discOf(lensWithRadius(lens, coronal, -50), coronal)->radius_px, 4, 1e-9);
  EXPECT_NEAR(discOf(scaledLens(lens, 1.5), coronal)->sphere_mm, 7.5, 1e-9);
  EXPECT_NEAR(discOf(scaledLens(lens, 1e9), coronal)->sphere_mm, 500, 1e-9);
  EXPECT_EQ(moved.inner, lens.inner);
}

TEST(Lenses, LooksAreThoseThatMakeSenseOnSlices) {
  WindowFacts ct;
  ct.unit = "HU";
  ct.windows = {{600, 1200, VoiFunction::Linear, "WINDOW1"}};
  const std::vector<LensLook> looks = lensLooks(ct);
  ASSERT_EQ(looks.size(), 6u);
  EXPECT_EQ(looks[0].name, "Bone");
  EXPECT_EQ(std::get<SliceLook>(looks[0].inner).window->width, 1800);
  EXPECT_TRUE(std::get<SliceLook>(looks[4].inner).invert);
  EXPECT_TRUE(std::holds_alternative<CutOut>(looks[5].inner));
  WindowFacts mr;
  mr.unit = "stored value";
  mr.windows = ct.windows;
  mr.automatic = {0, 100, VoiFunction::LinearExact, ""};
  const std::vector<LensLook> of = lensLooks(mr);
  ASSERT_EQ(of.size(), 4u);
  EXPECT_EQ(of[0].name, "Inverted");
  EXPECT_EQ(of[1].name, "WINDOW1");
  EXPECT_EQ(of[3].name, "Cut out");
  for (const auto& all : {looks, of}) {
    std::set<std::string> names;
    for (const LensLook& l : all) EXPECT_TRUE(names.insert(l.name).second) << l.name;
  }
}

TEST(Lenses, ItShowsInAllSlicesOfItsPlaceAndInNothingElse) {
  Workspace w = withMpr();
  SourceFacts same = test::axialFacts(1, "b"), pet = test::axialFacts(1, "c");
  pet.modality = "PT";
  w.know(same), w.know(pet), w.know(test::axialFacts(1, "d", "9.9"));
  const auto n = w.addLens(0, PatientPoint(0, 0, 30), 6, bone());
  ASSERT_EQ(n, 0u);
  for (int t = 0; t < 4; ++t) EXPECT_EQ(lensesIn(w.sceneOf(t)), 1u) << t;
  w.scroll(0, 4);
  EXPECT_EQ(lensesIn(w.sceneOf(0)), 0u) << "not where its plane misses it";
  w.scroll(0, -4);
  EXPECT_EQ(lensesIn(w.sceneOf(0)), 1u);
  EXPECT_EQ(lensesIn(w.tile(0).scene), 0u) << "views and windows are edited without it";
  w.replaceSource(1, {1, "b"});  // the next time point
  w.replaceSource(2, {1, "c"});
  w.replaceSource(3, {1, "d"});
  EXPECT_EQ(lensesIn(w.sceneOf(1)), 1u);
  EXPECT_EQ(lensesIn(w.sceneOf(2)), 0u) << "a window of HU on another modality";
  EXPECT_EQ(lensesIn(w.sceneOf(3)), 0u) << "another frame of reference";
  SourceFacts colour = test::axialFacts(1, "e");
  colour.colour = true;
  w.know(colour);
  w.replaceSource(3, {1, "e"});
  EXPECT_EQ(lensesIn(w.sceneOf(3)), 0u) << "no technique draws lenses in colours";
  EXPECT_FALSE(w.addLens(3, PatientPoint(0, 0, 30), 6, bone()));
  w.openStack();
  EXPECT_EQ(w.sceneOf(0), w.tile(0).scene) << "stored frames have none";
  EXPECT_FALSE(w.addLens(0, PatientPoint(0, 0, 30), 6, bone()));
  ASSERT_TRUE(w.openMpr());
  EXPECT_EQ(lensesIn(w.sceneOf(2)), 1u) << "it outlives a change of view";
  w.forget(1);
  EXPECT_TRUE(w.now().lenses.empty());
}

TEST(Lenses, InsideIsOtherThanAround) {
  Workspace w = withMpr();
  w.setWindow(0, {40, 80, VoiFunction::Linear, ""});
  w.addLens(0, PatientPoint(0, 0, 30), 6, bone());
  w.addLens(0, PatientPoint(5, 0, 30), 6, {"Inverted", SliceLook{Interpolation::Linear, std::nullopt, true}});
  for (const bool inverted : {false, true}) {
    const Scene s = w.sceneOf(0);
    ASSERT_EQ(s.layers.size(), 3u);
    const auto look = [&](std::size_t l) {
      return std::get<SliceLook>(std::get<LensLayer>(s.layers[l]).inner);
    };
    EXPECT_EQ(look(1).window->width, 1800);
    EXPECT_EQ(look(1).invert, inverted);
    EXPECT_EQ(look(2).window->width, 80) << "the window around it";
    EXPECT_EQ(look(2).invert, !inverted);
    w.invert(0);
  }
}

TEST(Lenses, EveryEditIsAStepOfUndo) {
  Workspace w = withMpr();
  const Place axial = placeOfTile(w, 0);
  std::vector<Arrangement> seen{w.now()};
  const auto step = [&] { seen.push_back(w.now()); };
  const std::size_t n = *w.addLens(0, axial.patientAt({70, 50}), 6, bone());
  step();
  w.beginDrag();  // a drag is one step
  const LensLayer before = w.now().lenses[n].layer;
  for (int k = 1; k < 9; ++k) w.changeLens(n, movedLens(before, axial, {3.0 * k, 0}));
  EXPECT_TRUE(w.endDrag());
  step();
  for (int k = 0; k < 4; ++k) w.sizeLens(n, 1.1);  // notches in a row are one step
  step();
  w.setLensLook(n, {"Cut out", CutOut{}}), step();
  w.addLens(1, PatientPoint(0, 0, 30), 4, bone()), step();
  w.removeLens(n), step();
  EXPECT_EQ(w.now().lenses.size(), 1u);
  EXPECT_EQ(w.now().lenses[0].look, "Bone");
  for (std::size_t k = seen.size(); k-- > 1;) {
    EXPECT_EQ(w.now(), seen[k]) << k;
    w.undo();
  }
  EXPECT_EQ(w.now(), seen[0]);
  for (std::size_t k = 1; k < seen.size(); ++k) w.redo();
  EXPECT_EQ(w.now(), seen.back());
  w.beginDrag();  // a drag that moves nothing is none
  w.changeLens(0, w.now().lenses[0].layer);
  EXPECT_FALSE(w.endDrag());
}

}  // namespace
}  // namespace vernier::ui
