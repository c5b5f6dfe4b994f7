// SPDX-License-Identifier: GPL-3.0-or-later
#include "RenderThread.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace vernier::app {
namespace {

TEST(RenderThread, RunsInOrderOnOneOtherThread) {
  std::vector<int> order;
  std::set<std::thread::id> ids;
  {
    RenderThread thread;
    for (int i = 0; i < 50; ++i)
      thread.run([&, i] {
        order.push_back(i);
        ids.insert(std::this_thread::get_id());
      });
  }
  ASSERT_EQ(order.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(ids.size(), 1u);
  EXPECT_EQ(ids.count(std::this_thread::get_id()), 0u);
}

}  // namespace
}  // namespace vernier::app
