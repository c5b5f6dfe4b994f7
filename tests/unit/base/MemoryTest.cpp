// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "TestData.h"
#include "vernier/base/Budget.h"
#include "vernier/base/Cache.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier {
namespace {

TEST(MemoryBudget, RefusesWithNumbersAndReleases) {
  MemoryBudget budget(100 << 20);
  {
    auto a = budget.reserve(60 << 20, "A volume");
    ASSERT_TRUE(a.ok());
    auto b = budget.reserve(60 << 20, "Another volume");
    ASSERT_FALSE(b.ok());
    EXPECT_EQ(b.error().code, ErrorCode::OutOfMemory);
    EXPECT_NE(b.error().sentence.find("60 MiB"), std::string::npos);
    EXPECT_NE(b.error().sentence.find("100"), std::string::npos);
  }
  EXPECT_EQ(budget.used(), 0u);
  EXPECT_FALSE(budget.reserve(~0ull, "Everything").ok());
  EXPECT_GT(MemoryBudget::halfOfFreeBytes(), 0u);
}

TEST(MemoryBudget, AReservationMayOutliveItsBudget) {
  std::optional<MemoryBudget> budget(std::in_place, 100);
  auto kept = budget->reserve(60, "A volume");
  ASSERT_TRUE(kept.ok());
  MemoryBudget::Reservation moved = std::move(*kept);
  EXPECT_EQ(budget->used(), 60u);
  budget.reset();
  EXPECT_EQ(moved.bytes(), 60u);  // its end, after the budget's, is what the sanitizers watch
}

TEST(DerivedCache, KeepsUntilTheLimitAndDropsTheOldest) {
  DerivedCache cache(100);
  int made = 0;
  const auto get = [&](Revision r) {
    return cache.get<int>({"bricks", r, "8"}, [&]() -> Result<DerivedCache::Made<int>> {
      ++made;
      return DerivedCache::Made<int>{std::make_shared<int>(static_cast<int>(r)), 40};
    });
  };
  EXPECT_EQ(**get(1), 1);
  EXPECT_EQ(**get(2), 2);
  EXPECT_EQ(**get(1), 1);
  EXPECT_EQ(made, 2);
  (void)get(3);  // drops 2, which was used longest ago
  EXPECT_EQ(cache.bytes(), 80u);
  (void)get(1);
  EXPECT_EQ(made, 3);
  (void)get(2);
  EXPECT_EQ(made, 4);
  auto failed = cache.get<int>({"mesh", 9, ""}, []() -> Result<DerivedCache::Made<int>> {
    return makeError(ErrorCode::OutOfMemory, "no");
  });
  EXPECT_FALSE(failed.ok());
}

TEST(Threads, ParallelForCoversEachIndexOnce) {
  for (int t : {1, 2, 3}) {
    setThreads(t);
    EXPECT_EQ(threads(), t);
    std::vector<int> hits(1000, 0);
    parallelFor(hits.size(), 7, [&](std::size_t b, std::size_t e) {
      for (std::size_t i = b; i < e; ++i) ++hits[i];
    });
    EXPECT_EQ(std::count(hits.begin(), hits.end(), 1), 1000);
  }
  setThreads(0);
}

TEST(Trace, WritesSpans) {
  test::TempDir dir;
  traceStart();
  { TraceSpan span("load"); }
  const std::string path = (dir.path() / "t.json").string();
  ASSERT_TRUE(traceWrite(path).ok());
  std::ifstream f(path);
  const std::string text((std::istreambuf_iterator<char>(f)), {});
  EXPECT_NE(text.find("\"name\":\"load\""), std::string::npos);
  EXPECT_EQ(traceWrite("/nonexistent-folder/x").error().code, ErrorCode::WriteFailed);
}

}  // namespace
}  // namespace vernier
