// SPDX-License-Identifier: GPL-3.0-or-later
// Looks through a volume in the real window: chosen, turned, windowed, and a point of them found in the
// slices.
#include "Looks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "Lenses.h"
#include "WindowDriver.h"
#include "WindowStudies.h"
#include "vernier/plan/LensEdits.h"
#include "vernier/volume/Sampling.h"

namespace vernier::ui {
namespace {

using test::WindowDriver;

constexpr int kLook = 3;
constexpr double kX = 1030, kY = 600;  // near the middle of its tile

// Where its picture lies in the window.
glm::dvec2 corner(WindowDriver& w) {
  const View& v = w.desk().tileView(kLook).view;
  return {1280 - v.width_px, 800 - 28 - v.height_px};
}
glm::dvec2 inPicture(WindowDriver& w, double x, double y) { return glm::dvec2(x + 0.5, y + 0.5) - corner(w); }

glm::dvec2 seen(const CameraPicture& c, PatientPoint p) {
  const glm::dvec4 at = c.pixelFromPatient() * glm::dvec4(p.p, 1);
  return glm::dvec2(at) / at.w;
}
// The head with the look of this key (0: the first) beside its slices; false where there is no window.
bool openLook(const vernier::test::TempDir& dir, WindowDriver& w, int key = 0) {
  if (!test::openHead(dir, w)) return false;
  w.key(GLFW_KEY_F5);
  if (key != 0) w.key(key);
  return w.settle();
}
const Camera& camera(WindowDriver& w) { return w.workspace().tile(kLook).scene.camera; }

TEST(WindowLook, TheLeftButtonTurnsTheWheelMagnifiesAndEachIsUndone) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!openLook(dir, w)) return;
  ASSERT_NE(lookOf(w.workspace().tile(kLook).scene), nullptr);
  ASSERT_TRUE(w.desk().tileView(kLook).picture);
  EXPECT_TRUE(w.desk().tileView(kLook).picture->measured);
  const Camera first = camera(w);
  w.dragBy(kX, kY, 60, 40);
  EXPECT_DOUBLE_EQ(camera(w).azimuth_deg, first.azimuth_deg - 30);
  EXPECT_DOUBLE_EQ(camera(w).elevation_deg, first.elevation_deg + 20);
  w.key(GLFW_KEY_Z, true);
  EXPECT_EQ(camera(w), first) << "a drag is one step";
  w.key(GLFW_KEY_RIGHT);
  EXPECT_DOUBLE_EQ(camera(w).azimuth_deg, first.azimuth_deg - 15);
  // What lies under the pointer stays there.
  const double x = kX + 70, y = kY - 40;
  ASSERT_TRUE(w.settle());
  const auto before = w.desk().cameraOfTile(kLook);
  const PatientPoint under =
      before->ray(inPicture(w, x, y).x, inPicture(w, x, y).y).at(before->targetDistance_mm);
  w.move(x, y);
  w.wheel(3);
  EXPECT_GT(camera(w).zoom, 1.2 * first.zoom);
  EXPECT_LT(glm::length(seen(*w.desk().cameraOfTile(kLook), under) - inPicture(w, x, y)), 1.0);
  w.key(GLFW_KEY_R);
  EXPECT_EQ(camera(w), first);
}

TEST(WindowLook, ShiftWindowsWhatIsSeenAndLeavesTheSlicesAlone) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!openLook(dir, w, GLFW_KEY_1)) return;  // MIP
  const auto* mip = std::get_if<ProjectionLayer>(lookOf(w.workspace().tile(kLook).scene));
  ASSERT_NE(mip, nullptr);
  EXPECT_FALSE(mip->window);
  const VoiWindow whole = w.desk().tileView(kLook).picture->window;
  const auto slices = sliceOf(w.workspace().tile(0).scene)->window;
  w.hold(GLFW_KEY_LEFT_SHIFT, true);
  w.dragBy(kX, kY, -100, 0);
  w.hold(GLFW_KEY_LEFT_SHIFT, false);
  mip = std::get_if<ProjectionLayer>(lookOf(w.workspace().tile(kLook).scene));
  ASSERT_TRUE(mip->window);
  EXPECT_NEAR(mip->window->width, 0.8 * whole.width, 1e-9);
  EXPECT_EQ(sliceOf(w.workspace().tile(0).scene)->window, slices);
  w.key(GLFW_KEY_0);
  EXPECT_FALSE(std::get<ProjectionLayer>(*lookOf(w.workspace().tile(kLook).scene)).window);
  // Of a rendering it is the transfer function.
  w.key(GLFW_KEY_4);  // bone
  ASSERT_TRUE(w.settle());
  const auto shown = w.desk().tileView(kLook).picture->rgba;
  const Scene asPreset = w.workspace().tile(kLook).scene;
  w.hold(GLFW_KEY_LEFT_SHIFT, true);
  w.dragBy(kX, kY, 0, -60);
  w.hold(GLFW_KEY_LEFT_SHIFT, false);
  ASSERT_TRUE(w.settle());
  const auto* bone = std::get_if<VolumeLayer>(lookOf(w.workspace().tile(kLook).scene));
  ASSERT_TRUE(bone && bone->transfer);
  EXPECT_NE(w.desk().tileView(kLook).picture->rgba, shown);
  w.key(GLFW_KEY_0);
  EXPECT_EQ(w.workspace().tile(kLook).scene, asPreset);
}

// A click on a maximum brings the slices there: the value that is projected is the value at that point.
TEST(WindowLook, ThePointThatIsSeenIsFoundInTheSlices) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!openLook(dir, w, GLFW_KEY_1)) return;
  w.dragBy(kX, kY, 50, 30);
  ASSERT_TRUE(w.settle());
  for (const auto& [x, y] : {std::pair{1035.0, 640.0}, {1050.0, 690.0}, {1000.0, 560.0}}) {
    const auto picked = w.desk().pick(kLook, inPicture(w, x, y));
    ASSERT_TRUE(picked);
    // No sample of the ray is above the value at that point: a search of its own, ten to a voxel.
    const auto& volume = *w.desk().tileView(kLook).picture->volume;
    const CameraPicture& c = *w.desk().tileView(kLook).camera;
    const PatientRay ray =
        c.ray(std::floor(inPicture(w, x, y).x) + 0.5, std::floor(inPicture(w, x, y).y) + 0.5);
    double most = -1e9;
    for (double t = 0; t < 2 * c.targetDistance_mm; t += 0.1)
      most = std::max(most, sampleModality(volume, ray.at(t)).value_or(-1e9));
    EXPECT_GT(sampleModality(volume, *picked).value_or(-1e9), most - 1);
    w.hold(GLFW_KEY_LEFT_CONTROL, true);
    w.click(x, y);
    w.hold(GLFW_KEY_LEFT_CONTROL, false);
    const auto cross = w.workspace().crosshair(kLook);
    ASSERT_TRUE(cross);
    EXPECT_LT(length(*cross - *picked), 1e-9);
    for (int t = 0; t < 3; ++t) {
      const Plane& plane = sliceOf(w.workspace().tile(t).scene)->plane;
      EXPECT_NEAR(dot(*cross - plane.point, normalize(plane.normal)), 0, 1e-9) << t;
    }
    EXPECT_LT(glm::length(seen(*w.desk().cameraOfTile(kLook), *cross) - inPicture(w, x, y)), 1e-6)
        << "its mark stands where the click was";
    ASSERT_TRUE(w.settle());
  }
  // A mean has no place on the ray.
  w.key(GLFW_KEY_3);
  ASSERT_TRUE(w.settle());
  EXPECT_FALSE(w.desk().pick(kLook, inPicture(w, kX, kY)));
}

// G places a lens about the point that is seen; inside moves it across the picture, the outline scales it.
TEST(WindowLook, ALensIsPlacedMovedScaledAndTakenAway) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!openLook(dir, w)) return;
  w.dragBy(kX, kY, 50, 30);
  w.move(2, 2);
  ASSERT_TRUE(w.settle());
  const Picture without = w.desk().tileView(kLook).picture->rgba;
  const double x = kX + 20, y = kY - 60;
  const auto picked = w.desk().pick(kLook, inPicture(w, x, y));
  ASSERT_TRUE(picked);
  w.move(x, y);
  w.key(GLFW_KEY_G);
  ASSERT_EQ(w.workspace().now().lenses.size(), 1u) << w.host().gui().why();
  const auto lens = [&] { return w.workspace().now().lenses[0].layer; };
  EXPECT_LT(length(middleOf(lens()) - *picked), 1e-9);
  ASSERT_TRUE(w.settle());
  const Picture cut = w.desk().tileView(kLook).picture->rgba;
  EXPECT_NE(cut, without);
  EXPECT_FALSE(w.workspace().showsLens(0, 0)) << "slices have lenses of their own";

  // Outside of its disc nothing has changed, but for what another step along the rays does to an edge.
  const auto disc = [&] { return *discOf(lens(), *facing(*w.desk().cameraOfTile(kLook), lens())); };
  const LensDisc d = disc();
  std::size_t inside = 0, outside = 0;
  for (int py = 40; py < cut.height - 60; ++py)  // above and below are letters
    for (int px = 0; px < cut.width; ++px) {
      int most = 0;
      for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(cut.at(px, py)[c] - without.at(px, py)[c]));
      const double from = glm::length(glm::dvec2(px + 0.5, py + 0.5) - d.centre_px);
      inside += most > 8 && from < d.radius_px;
      outside += most > 8 && from > d.radius_px + 1;
    }
  EXPECT_LT(outside, 100u);
  EXPECT_GT(inside, 500u);

  w.dragBy(x, y, 40, 24);
  EXPECT_LT(glm::length(disc().centre_px - d.centre_px - glm::dvec2(40, 24)), 1e-6);
  EXPECT_NEAR(disc().radius_px, d.radius_px, 1e-6);
  EXPECT_EQ(camera(w), w.workspace().tile(kLook).scene.camera);
  ASSERT_TRUE(w.settle());
  w.dragBy(x + 40 + std::round(d.radius_px), y + 24, 15, 0);
  EXPECT_NEAR(disc().radius_px, d.radius_px + 15, 1e-6);
  // Ctrl + wheel scales it; the picture keeps its size.
  ASSERT_TRUE(w.settle());
  const double radius = disc().radius_px, zoom = camera(w).zoom;
  w.move(x + 40, y + 24);
  w.hold(GLFW_KEY_LEFT_CONTROL, true);
  w.wheel(2);
  w.hold(GLFW_KEY_LEFT_CONTROL, false);
  EXPECT_NEAR(disc().radius_px, 1.21 * radius, 1e-4);
  EXPECT_EQ(camera(w).zoom, zoom);
  // G again: the next look.
  ASSERT_TRUE(w.settle());
  w.move(x + 40, y + 24);
  w.key(GLFW_KEY_G);
  EXPECT_EQ(w.workspace().now().lenses[0].look, "Soft tissue");
  ASSERT_TRUE(w.settle());
  EXPECT_FALSE(w.desk().tileView(kLook).picture->error);
  w.key(GLFW_KEY_DELETE);
  EXPECT_TRUE(w.workspace().now().lenses.empty());
}

TEST(WindowLook, InversionAndLensesOfProjectionsExcludeEachOtherWithASentence) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!openLook(dir, w, GLFW_KEY_1)) return;  // MIP
  w.move(kX, kY);
  w.key(GLFW_KEY_G);
  ASSERT_EQ(w.workspace().now().lenses.size(), 1u);
  ASSERT_TRUE(w.settle());
  EXPECT_FALSE(w.desk().tileView(kLook).picture->error);
  w.key(GLFW_KEY_I);
  EXPECT_NE(w.host().gui().why().find("take the lens away"), std::string::npos);
  w.key(GLFW_KEY_DELETE);
  w.key(GLFW_KEY_I);
  ASSERT_TRUE(w.settle());
  EXPECT_TRUE(w.desk().tileView(kLook).picture->inverted);
  w.key(GLFW_KEY_G);
  EXPECT_NE(w.host().gui().why().find("take the inversion back"), std::string::npos);
  EXPECT_TRUE(w.workspace().now().lenses.empty());
}

TEST(WindowLook, AKeyWhileTheHandTurnsChangesNothingAndShiftDragsTheLevelOfASurface) {
  vernier::test::TempDir dir;
  WindowDriver w;
  if (!openLook(dir, w)) return;
  const std::string view = w.workspace().tile(kLook).view;
  w.move(kX, kY);
  w.button(0, true);
  w.move(kX + 20, kY);
  w.key(GLFW_KEY_1);
  w.key(GLFW_KEY_F4);
  w.move(kX + 40, kY);
  w.button(0, false);
  EXPECT_EQ(w.workspace().tile(kLook).view, view);
  EXPECT_DOUBLE_EQ(camera(w).azimuth_deg, -20);
  w.key(GLFW_KEY_8);
  ASSERT_TRUE(w.settle());
  const auto level = [&] {
    return std::get<IsosurfaceLayer>(*lookOf(w.workspace().tile(kLook).scene)).level;
  };
  EXPECT_FALSE(level());
  w.hold(GLFW_KEY_LEFT_SHIFT, true);
  w.dragBy(kX, kY, 0, -50);
  w.hold(GLFW_KEY_LEFT_SHIFT, false);
  ASSERT_TRUE(level());
  const auto range = w.desk().tileView(kLook).picture->volume->modalityRange();
  EXPECT_NEAR(*level(), 300 - 0.1 * (range->max - range->min), 1e-6) << "up: lower values show, too";
  w.key(GLFW_KEY_0);
  EXPECT_FALSE(level());
}

// While it moves there are fewer pixels, with the same picture in them; then all of them; then the error.
TEST(DeskLooks, ComeQuicklyThenSharpThenMeasured) {
  vernier::test::TempDir dir;
  // The renderer waits until each of its pictures has been seen.
  std::atomic<bool> unseen = false, watching = true;
  Desk desk({}, [&] {
    unseen = true;
    for (int k = 0; k < 5'000 && unseen && watching; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  for (int t = 0; t < kTiles; ++t) desk.setTileSize(t, t == kLook ? 701 : 60, t == kLook ? 533 : 50);
  desk.open({test::headStudy(dir)});
  const auto waitFor = [&](const auto& done) {
    for (int k = 0; k < 60'000; ++k) {
      const bool came = unseen;
      desk.update();
      if (done()) return true;
      if (came) unseen = false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  };
  ASSERT_TRUE(waitFor([&] { return desk.tileView(0).picture && desk.idle(); }));
  ASSERT_TRUE(desk.workspace().open3d());
  const auto shown = [&] {
    return desk.tileView(kLook).picture.has_value() && !desk.tileView(kLook).picture->error;
  };
  ASSERT_TRUE(waitFor(shown));
  const FinishedPicture draft = *desk.tileView(kLook).picture;
  EXPECT_GT(draft.depths.perPixel, 1.5) << "nothing is known of its time: half of the pixels each way";
  EXPECT_EQ(draft.rgba.width, 701);
  EXPECT_EQ(draft.rgba.height, 533);
  EXPECT_FALSE(draft.measured);
  std::vector<std::optional<PatientPoint>> before;
  std::vector<glm::dvec2> at;
  for (double y = 30; y < 533; y += 37)
    for (double x = 30; x < 701; x += 41)
      at.emplace_back(x, y), before.push_back(desk.pick(kLook, at.back()));
  bool sharp = false;
  ASSERT_TRUE(waitFor([&] {
    const FinishedPicture& p = *desk.tileView(kLook).picture;
    sharp = sharp || (p.depths.perPixel == 1 && !p.measured);
    return p.measured;
  }));
  EXPECT_TRUE(sharp) << "all pixels before the error";
  EXPECT_EQ(desk.tileView(kLook).picture->depths.perPixel, 1);
  watching = false;
  EXPECT_TRUE(waitFor([&] { return desk.idle(); }));
  // Where both see something, they see it in one place; where one does, the other does: but for the edges.
  const double mm = desk.cameraOfTile(kLook)->mmPerPixel();
  std::size_t both = 0, one = 0;
  for (std::size_t n = 0; n < at.size(); ++n) {
    const auto after = desk.pick(kLook, at[n]);
    if (after.has_value() != before[n].has_value()) ++one;
    if (!after || !before[n]) continue;
    ++both;
    const PatientVec off = *after - *before[n];
    const CameraPicture c = *desk.cameraOfTile(kLook);
    EXPECT_LT(std::hypot(dot(off, c.right), dot(off, c.up)),
              1.01 * mm * std::sqrt(2.0) * (0.5 * draft.depths.perPixel + 0.5))
        << n;
  }
  EXPECT_GT(both, 20u);
  EXPECT_LT(one, both / 5);
}

}  // namespace
}  // namespace vernier::ui
