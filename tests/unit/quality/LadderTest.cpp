// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/Ladder.h"

#include <gtest/gtest.h>

namespace vernier::quality {
namespace {

// A technique whose error is `factor` * step^2, and that marks its frames with the step.
struct Fake {
  double factor = 8;
  int drawn = 0;
  Result<Frame> render(double step) {
    ++drawn;
    Frame f;
    f.render_ms = step;
    return f;
  }
  Result<ErrorReport> measure(double step) const {
    ErrorReport e;
    e.n = 1024;
    e.bound = e.rms = e.max = factor * step * step;
    return e;
  }
  Result<LadderResult> climb(const LadderOptions& options, std::stop_token stop = {}) {
    return quality::climb([&](double step) { return render(step); },
                          [&](const Frame&, double step) { return measure(step); }, options, stop);
  }
};

TEST(Ladder, HalvesTheStepUntilTheGoal) {
  Fake fake;
  const auto r = fake.climb({.goal = 0.6});
  ASSERT_TRUE(r.ok());
  EXPECT_TRUE(r->goalReached);
  EXPECT_EQ(r->reached.step, 0.25);  // 8, 2, 0.5
  EXPECT_EQ(r->frame.render_ms, 0.25);
  EXPECT_EQ(fake.drawn, 3);
  EXPECT_EQ(r->rungs.size(), 3u);
  EXPECT_EQ(r->said, "");
}

TEST(Ladder, StopsAtTheLeastStepAndSaysSo) {
  Fake fake{.factor = 932.0};
  const auto r = fake.climb({.goal = 0.5});
  ASSERT_TRUE(r.ok());
  EXPECT_FALSE(r->goalReached);
  EXPECT_EQ(r->reached.step, 1.0 / 32);
  EXPECT_EQ(fake.drawn, 6);
  EXPECT_EQ(r->said, "goal not reached: 0.92") << "0.910, rounded up: what is said holds";
}

TEST(Ladder, StopsWhenHalvingChangesNothing) {
  int drawn = 0;
  const auto r = climb(
      [&](double) -> Result<Frame> {
        ++drawn;
        return Frame{};
      },
      [](const Frame&, double) -> Result<ErrorReport> {
        ErrorReport e;
        e.bound = 3;
        return e;
      },
      {.goal = 2});
  EXPECT_EQ(drawn, 2);
  EXPECT_EQ(r->said, "goal not reached: 3");
}

TEST(Ladder, StopsWhenTimeIsUpAndKeepsTheBest) {
  Fake fake{.factor = 100};
  const auto r = fake.climb({.goal = 0.5, .limit_ms = 0.0});
  EXPECT_EQ(fake.drawn, 1);
  EXPECT_TRUE(r->timeUp);
  EXPECT_EQ(r->said, "goal not reached: 1e+02");
}

TEST(Ladder, PassesErrorsAndCancelOn) {
  const auto r = climb([](double) -> Result<Frame> { return makeError(ErrorCode::GlFailed, "no"); },
                       [](const Frame&, double) -> Result<ErrorReport> { return ErrorReport{}; }, {});
  EXPECT_EQ(r.error().code, ErrorCode::GlFailed);
  std::stop_source stop;
  stop.request_stop();
  Fake fake;
  EXPECT_EQ(fake.climb({}, stop.get_token()).error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier::quality
