// SPDX-License-Identifier: GPL-3.0-or-later
// What of fast hands one frame may see.
#include "Input.h"

#include <gtest/gtest.h>

namespace vernier::ui {
namespace {

using Kind = InputEvent::Kind;
constexpr int kCtrl = 341, kQ = 81;

InputEvent event(Kind kind, int code = 0, bool down = false, double x = 0) {
  InputEvent e;
  e.kind = kind, e.code = code, e.down = down, e.x = x;
  return e;
}

// Events of each frame, as "kind code down".
std::vector<std::vector<InputEvent>> frames(const std::vector<InputEvent>& events) {
  InputQueue queue;
  for (const InputEvent& e : events) queue.add(e);
  std::vector<std::vector<InputEvent>> all;
  while (!queue.empty()) all.push_back(queue.next());
  return all;
}

TEST(InputQueue, AModifierIsDownInTheFrameOfItsKey) {
  const auto f = frames({event(Kind::Key, kCtrl, true), event(Kind::Key, kQ, true),
                         event(Kind::Key, kCtrl, false), event(Kind::Key, kQ, false)});
  ASSERT_EQ(f.size(), 2u);
  ASSERT_EQ(f[0].size(), 2u);
  EXPECT_EQ(f[0][1].code, kQ);
  EXPECT_TRUE(f[0][0].down && f[0][1].down);
}

TEST(InputQueue, AModifierIsDownInTheFrameOfItsClickAndNotBefore) {
  const auto held =
      frames({event(Kind::Key, kCtrl, true), event(Kind::Button, 0, true), event(Kind::Key, kCtrl, false)});
  ASSERT_EQ(held.size(), 2u);
  EXPECT_EQ(held[0].size(), 2u);
  const auto late = frames({event(Kind::Button, 0, true), event(Kind::Key, kCtrl, true)});
  EXPECT_EQ(late.size(), 2u);
}

TEST(InputQueue, AClickTakesTwoFramesAndMovesBeforeItOne) {
  const auto f = frames({event(Kind::Pointer, 0, false, 1), event(Kind::Pointer, 0, false, 2),
                         event(Kind::Button, 0, true), event(Kind::Button, 0, false),
                         event(Kind::Pointer, 0, false, 3)});
  ASSERT_EQ(f.size(), 3u);
  ASSERT_EQ(f[0].size(), 2u);
  EXPECT_EQ(f[0][0].x, 2);
  EXPECT_FALSE(f[1][0].down);
  EXPECT_EQ(f[2][0].x, 3);
}

TEST(InputQueue, TheWayOfAPointerIsKeptForOutlines) {
  InputQueue queue;
  for (const double x : {1.0, 2.0, 5.0}) queue.add(event(Kind::Pointer, 0, false, x));
  queue.add(event(Kind::Button, 0, true));
  queue.add(event(Kind::Pointer, 0, false, 7));
  (void)queue.next();
  ASSERT_EQ(queue.way().size(), 3u);
  for (const auto& [n, x] : {std::pair(0u, 1.0), {1u, 2.0}, {2u, 5.0}}) EXPECT_EQ(queue.way()[n].first, x);
  (void)queue.next();
  ASSERT_EQ(queue.way().size(), 1u);
  EXPECT_EQ(queue.way()[0].first, 7);
}

}  // namespace
}  // namespace vernier::ui
