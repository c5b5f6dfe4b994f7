// SPDX-License-Identifier: GPL-3.0-or-later
// The closed loop behind `review` and `reference`: draw, measure, halve the sampling step until the measured
// bound meets the goal, or the step has reached 1/32, or time is up. The last picture with the smallest bound
// is kept, and it says what was reached.
#pragma once
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "vernier/quality/Badge.h"

namespace vernier::quality {

struct LadderOptions {
  double goal = 2;       // levels of 255: 2 for review, 0.5 for reference
  double firstStep = 1;  // in smallest voxel spacings
  double leastStep = 1.0 / 32;
  std::optional<double> limit_ms = std::nullopt;  // no further rung is begun after this
};

struct LadderRung {
  double step = 1;
  ErrorReport error;
};

struct LadderResult {
  Frame frame;
  LadderRung reached;
  bool goalReached = false;
  bool timeUp = false;
  std::vector<LadderRung> rungs;  // all that were drawn, in order
  std::string said;               // "" or "goal not reached: 0.9"
};

using RenderAtStep = std::function<Result<Frame>(double step)>;
using MeasureFrame = std::function<Result<ErrorReport>(const Frame&, double step)>;

// A picture whose error does not depend on the step (a plain slice) is drawn at most twice: the loop stops
// when halving changes nothing. Errors of render and measure are passed on; Cancelled when asked to stop
// before the first picture is measured, else the best so far.
VERNIER_API Result<LadderResult> climb(const RenderAtStep&, const MeasureFrame&, const LadderOptions&,
                                       std::stop_token = {});

}  // namespace vernier::quality
