// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/Ladder.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

namespace vernier::quality {
namespace {

// Without a bound (too few samples) the largest difference seen is what there is.
double figure(const ErrorReport& e) { return e.bound.value_or(e.max); }

// To two digits, upwards: what is said must hold.
std::string notReached(double levels) {
  if (levels > 0 && std::isfinite(levels)) {
    const double unit = std::pow(10.0, std::floor(std::log10(levels)) - 1);
    levels = std::ceil(levels / unit - 1e-9) * unit;
  }
  char text[48];
  std::snprintf(text, sizeof text, "goal not reached: %.2g", levels);
  return text;
}

}  // namespace

Result<LadderResult> climb(const RenderAtStep& render, const MeasureFrame& measure,
                           const LadderOptions& options, std::stop_token stop) {
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed_ms = [&] {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  };
  LadderResult best;
  for (double step = options.firstStep;; step /= 2) {
    if (stop.stop_requested()) {
      if (best.rungs.empty()) return makeError(ErrorCode::Cancelled, "The picture was cancelled.");
      break;
    }
    auto frame = render(step);
    if (!frame) return frame.error();
    auto error = measure(*frame, step);
    if (!error) return error.error();
    const bool first = best.rungs.empty();
    const bool unchanged = !first && figure(*error) == figure(best.rungs.back().error) &&
                           error->rms == best.rungs.back().error.rms;
    best.rungs.push_back({step, *error});
    if (first || figure(*error) < figure(best.reached.error)) {
      best.frame = std::move(*frame);
      best.reached = best.rungs.back();
    }
    best.goalReached = figure(best.reached.error) <= options.goal;
    best.timeUp = options.limit_ms && elapsed_ms() >= *options.limit_ms;
    if (best.goalReached || best.timeUp || unchanged || step / 2 < options.leastStep) break;
  }
  if (!best.goalReached) best.said = notReached(figure(best.reached.error));
  return best;
}

}  // namespace vernier::quality
