// SPDX-License-Identifier: GPL-3.0-or-later
// The desktop without its window, on real studies and threads.
#include "Desk.h"

#include <gtest/gtest.h>

#include <thread>

#include "WindowStudies.h"

namespace vernier::ui {
namespace {

std::string sourceOf(const Scene& scene) {
  if (const ImageLayer* image = imageOf(scene)) return image->source;
  const SliceLayer* slice = sliceOf(scene);
  return slice ? slice->source : "";
}

bool waitUntil(Desk& desk, const std::function<bool()>& done) {
  for (int k = 0; k < 20'000 && !done(); ++k) {
    desk.update();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return done();
}

// A picture that was under way when another series was chosen belongs to nothing that is shown.
TEST(Desk, NeverShowsAPictureOfAnotherSeries) {
  vernier::test::TempDir dir;
  Desk desk({}, [] {});
  desk.setTileSize(0, 900, 700);
  desk.open({test::study(dir, "syntaxes")});
  ASSERT_TRUE(waitUntil(desk, [&] { return desk.tileView(0).picture && desk.idle(); }));
  const Document& d = *desk.documents()[0];
  const std::size_t series = d.session->study().series.size();
  ASSERT_GE(series, 2u);
  std::size_t shown = 0;
  for (std::size_t round = 0; round < 60; ++round) {
    desk.openSource({d.number, d.session->sourceName({round % series, 0})}, 0);
    // Some rounds wait for their picture, however slow the machine is.
    if (round % 7 == 6) {
      EXPECT_TRUE(waitUntil(desk, [&] { return desk.tileView(0).picture.has_value(); }));
    }
    for (int k = 0; k < static_cast<int>(round % 7); ++k) {
      desk.update();
      if (const auto& p = desk.tileView(0).picture) {
        EXPECT_EQ(sourceOf(p->scene), desk.workspace().tile(0).source.name);
        ++shown;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  ASSERT_TRUE(waitUntil(desk, [&] { return desk.idle(); }));
  EXPECT_EQ(sourceOf(desk.tileView(0).picture->scene), desk.workspace().tile(0).source.name);
  EXPECT_GE(shown, 8u);
}

// A state is listed with its own name, and no image of the study is lost by it.
TEST(Desk, OpensAStudyWithAPresentationState) {
  vernier::test::TempDir dir;
  Desk desk({}, [] {});
  desk.setTileSize(0, 300, 300);
  desk.open({test::study(dir, "presentation")});
  ASSERT_TRUE(waitUntil(desk, [&] { return desk.tileView(0).picture && desk.idle(); }));
  EXPECT_TRUE(desk.messages().empty());
  EXPECT_EQ(desk.documents()[0]->session->study().presentations.size(), 1u);
  EXPECT_FALSE(desk.tileView(0).picture->error);
}

}  // namespace
}  // namespace vernier::ui
