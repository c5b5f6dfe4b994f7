// SPDX-License-Identifier: GPL-3.0-or-later
// Where left, posterior and head are, by value: three blocks of different value towards L, P and H of the
// patient's centre, acquired in each of 3 planes x 8 row and column flips x both slice orders, must stand at
// the same place of each view with the right letters. Nothing here asks the product where a point should
// fall: the expected pixels are written down from the convention (axial from the feet with the patient's
// right on screen left, coronal from the front, sagittal from the patient's left with anterior on screen
// left; head up).
#include <cmath>
#include <set>

#include "../unit/volume/Grids.h"
#include "RenderForTest.h"
#include "vernier/plan/PictureGeometry.h"
#include "vernier/plan/Presets.h"

namespace vernier {
namespace {

using namespace vernier::test;

constexpr double kTissue = 10, kLeft = 100, kPosterior = 200, kHead = 300;
constexpr double kReach_mm = 12;  // blocks lie this far from the centre, 4 mm to each side
const glm::dvec3 kCentre_mm(30, -20, 150);

double phantomAt(glm::dvec3 patient_mm) {
  const glm::dvec3 p = patient_mm - kCentre_mm;
  const auto in = [&](glm::dvec3 c) {
    const glm::dvec3 d = glm::abs(p - c);
    return d.x <= 4 && d.y <= 4 && d.z <= 4;
  };
  if (in({kReach_mm, 0, 0})) return kLeft;
  if (in({0, kReach_mm, 0})) return kPosterior;
  if (in({0, 0, kReach_mm})) return kHead;
  return kTissue;
}

struct Acquisition {
  std::string name;
  glm::dvec3 row, column, slice;  // directions of increasing column, row and slice index
};

std::vector<Acquisition> acquisitions() {
  const glm::dvec3 L(1, 0, 0), P(0, 1, 0), H(0, 0, 1);
  struct Orientation {
    const char* name;
    glm::dvec3 a, b;
  };
  std::vector<Acquisition> all;
  for (const Orientation& o :
       {Orientation{"axial", L, P}, Orientation{"coronal", L, H}, Orientation{"sagittal", P, H}})
    for (int flip = 0; flip < 8; ++flip)
      for (double order : {1.0, -1.0}) {
        glm::dvec3 row = flip & 1 ? -o.a : o.a, column = flip & 2 ? -o.b : o.b;
        if (flip & 4) std::swap(row, column);
        all.push_back(
            {std::string(o.name) + " flip " + std::to_string(flip) + (order > 0 ? "" : " left-handed"), row,
             column, order * glm::cross(row, column)});
      }
  return all;
}

GridGeometry gridOf(const Acquisition& a) {
  GridGeometry g = unitGrid(33, 35, 21);
  const glm::dvec3 spacing(1.25, 1.2, 2.0);
  g.patientFromVoxel.linear = glm::dmat3(spacing.x * a.row, spacing.y * a.column, spacing.z * a.slice);
  g.patientFromVoxel.translation = kCentre_mm - g.patientFromVoxel.linear * glm::dvec3(16, 17, 10);
  return g;
}

std::vector<std::int16_t> acquire(const GridGeometry& g) {
  std::vector<std::int16_t> v;
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i)
        v.push_back(static_cast<std::int16_t>(
            phantomAt((g.patientFromVoxel *
                       VoxelPoint(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)))
                          .p)));
  return v;
}

// What stands 12 mm to the right of, left of, below and above the middle of the picture.
struct Expected {
  const char* view;
  double right, left, below, above;
  EdgeLetters letters;
};
const Expected kViews[] = {
    {"axial", kLeft, kTissue, kPosterior, kTissue, {"R", "L", "A", "P"}},
    {"coronal", kLeft, kTissue, kTissue, kHead, {"R", "L", "H", "F"}},
    {"sagittal", kPosterior, kTissue, kTissue, kHead, {"A", "P", "H", "F"}},
};

TEST(Orientation, EachBlockStandsWhereItShouldInEachView) {
  std::set<std::string> drawnBy;
  for (const Acquisition& a : acquisitions()) {
    SCOPED_TRACE(a.name);
    const GridGeometry g = gridOf(a);
    VolumeInfo info;
    info.grid = g;
    const auto v = volumeOf<std::int16_t>(info, acquire(g));
    Sources sources;
    sources.volumes["v"] = v;
    for (const Expected& e : kViews) {
      SCOPED_TRACE(e.view);
      PresetOptions options;
      options.window = VoiWindow{200, 400, VoiFunction::LinearExact, ""};
      options.camera.height_mm = 41;
      const auto scene = presetScene(e.view, "v", *v, options);
      ASSERT_TRUE(scene.ok()) << scene.error().text();
      const View view{41, 41, true};  // 1 mm a pixel, pixel (20, 20) in the middle
      const auto picture = slicePicture(std::get<SliceLayer>(scene->layers[0]), scene->camera, view, *v);
      ASSERT_TRUE(picture.ok());
      EXPECT_EQ(edgeLetters(*picture), e.letters);
      for (const std::string& technique : sliceTechniques()) {
        SCOPED_TRACE(technique);
        const auto r = renderWith(technique, *scene, view, sources);
        ASSERT_TRUE(r.ok()) << r.error().text();
        drawnBy.insert(technique);
        const auto expect = [&](int x, int y, double value) {
          EXPECT_NEAR(valueOf(*r, x, y), value, 0.5) << x << "," << y;
          EXPECT_NEAR(r->frame.images.colour[4 * static_cast<std::size_t>(x + 41 * y)], value / 400,
                      0.5 / 400);
        };
        expect(20, 20, kTissue);
        expect(32, 20, e.right);
        expect(8, 20, e.left);
        expect(20, 32, e.below);
        expect(20, 8, e.above);
      }
    }
  }
  EXPECT_TRUE(drawnBy.contains("mpr.native"));
}

// The stack view shows the file's own rows and columns: the block towards a letter must stand at that
// letter's edge.
TEST(Orientation, LettersOfTheStackStandBesideTheirBlocks) {
  const auto valueTowards = [](const std::string& letters) {
    return letters == "L" ? kLeft : letters == "P" ? kPosterior : letters == "H" ? kHead : kTissue;
  };
  for (const Acquisition& a : acquisitions())
    for (int flips = 0; flips < 4; ++flips) {
      SCOPED_TRACE(a.name + " shown with flips " + std::to_string(flips));
      const GridGeometry g = gridOf(a);
      const auto all = acquire(g);
      ImageFrameInfo info;
      info.columns = g.columns;
      info.rows = g.rows;
      info.type = VoxelType::I16;
      info.windows = {VoiWindow{200, 400, VoiFunction::LinearExact, ""}};
      info.plane =
          FramePlane{g.patientFromVoxel * VoxelPoint(0, 0, 10), PatientVec(a.row), PatientVec(a.column)};
      info.pixelSpacing_mm = {1.2, 1.25};
      const auto first = all.begin() + static_cast<std::ptrdiff_t>(10 * g.columns * g.rows);
      auto frame =
          ImageFrame::make(info, bufferOf(std::vector<std::int16_t>(
                                     first, first + static_cast<std::ptrdiff_t>(g.columns * g.rows))));
      ASSERT_TRUE(frame.ok());
      Sources sources;
      sources.images[{"i", 10}] = *frame;
      Scene scene = stackScene("i", 10, {});
      auto& layer = std::get<ImageLayer>(scene.layers[0]);
      layer.flipHorizontal = flips & 1;
      layer.flipVertical = flips & 2;
      scene.camera.height_mm = 41;
      const auto r = renderWith("image.native", scene, View{41, 41, true}, sources);
      ASSERT_TRUE(r.ok()) << r.error().text();
      const EdgeLetters letters = edgeLetters(layer, info);
      EXPECT_NEAR(valueOf(*r, 32, 20), valueTowards(letters.right), 0.5);
      EXPECT_NEAR(valueOf(*r, 8, 20), valueTowards(letters.left), 0.5);
      EXPECT_NEAR(valueOf(*r, 20, 32), valueTowards(letters.bottom), 0.5);
      EXPECT_NEAR(valueOf(*r, 20, 8), valueTowards(letters.top), 0.5);
      // Each axis of the plane is named, and opposite edges have opposite letters.
      const std::set<std::string> named{letters.left, letters.right, letters.top, letters.bottom};
      EXPECT_EQ(named.size(), 4u);
      EXPECT_FALSE(named.contains(""));
    }
}

}  // namespace
}  // namespace vernier
