// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/quality/Badge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "Layers.h"
#include "Population.h"
#include "vernier/base/Threads.h"
#include "vernier/quality/OrderStatistic.h"

namespace vernier::quality {
namespace {

constexpr double kLevels = 255;

struct Sample {
  double error = 0;  // levels of 255
  bool edge = false;
  std::optional<SliceValue> value;
};

double displayed(double v) { return std::clamp(v, 0.0, 1.0); }

double levelsBetween(const float* rgba, const glm::dvec4& truth) {
  double worst = 0;
  for (int c = 0; c < 3; ++c) {
    const double got = rgba[c];
    if (std::isnan(got)) return kLevels;
    worst = std::max(worst, std::abs(displayed(got) - displayed(truth[c])));
  }
  return kLevels * worst;
}

// The smallest value that at least `share` of the values do not exceed.
double percentile(const std::vector<double>& ascending, double share) {
  if (ascending.empty()) return 0;
  const auto n = static_cast<double>(ascending.size());
  const auto rank = static_cast<std::size_t>(std::ceil(share * n - 1e-9));
  return ascending[std::clamp<std::size_t>(rank, 1, ascending.size()) - 1];
}

void summarise(const std::vector<Sample>& samples, const ErrorOptions& options, ErrorReport& r) {
  std::vector<double> all, edge, inner;
  double squares = 0;
  for (const Sample& s : samples) {
    all.push_back(s.error);
    (s.edge ? edge : inner).push_back(s.error);
    squares += s.error * s.error;
  }
  std::sort(all.begin(), all.end());
  std::sort(edge.begin(), edge.end());
  std::sort(inner.begin(), inner.end());
  r.n = all.size();
  if (all.empty()) return;
  r.max = all.back();
  r.rms = std::sqrt(squares / static_cast<double>(all.size()));
  r.p50 = percentile(all, 0.5);
  r.p99 = percentile(all, 0.99);
  r.exhaustive = r.n == r.population;
  r.rank = rankForBound(r.n, r.population, options.share, options.confidence);
  if (r.rank > 0) r.bound = all[all.size() - r.rank];
  r.edge.share = static_cast<double>(edge.size()) / static_cast<double>(all.size());
  r.innerP95 = percentile(inner, 0.95);
  r.edge.p99 = percentile(edge, 0.99);
  r.edge.max = edge.empty() ? 0 : edge.back();
}

ValueError valueError(const std::vector<Sample>& samples, const std::vector<std::size_t>& pixels,
                      const Frame& frame, const Volume& volume) {
  ValueError e;
  const auto range = volume.modalityRange();
  const double stored = range ? range->max - range->min : 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double got = frame.images.values[pixels[n]];
    const Sample& s = samples[n];
    if (std::isnan(got) == s.value.has_value()) {
      ++e.coverageDiffers;
      if (!s.edge) ++e.coverageDiffersInside;
      continue;
    }
    if (!s.value) continue;
    const double difference = std::abs(got - s.value->value);
    // The last term: the frame keeps values as floats.
    const double allowed =
        1e-4 * s.value->localRange() + 1e-6 * stored + std::ldexp(std::abs(s.value->value), -24);
    ++e.n;
    e.max_val = std::max(e.max_val, difference);
    if (difference > 0) e.worstOfBound = std::max(e.worstOfBound, allowed > 0 ? difference / allowed : 1e9);
  }
  return e;
}

}  // namespace

Result<ErrorReport> measureError(const Frame& frame, const Scene& scene, const View& view,
                                 const Sources& sources, const ErrorOptions& options, std::stop_token stop) {
  const auto layers = Layers::make(scene, view, sources, options.reference);
  if (!layers) return layers.error();
  const std::size_t count =
      static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(view.height_px);
  if (frame.images.width != view.width_px || frame.images.height != view.height_px ||
      frame.images.colour.size() != 4 * count)
    return makeError(ErrorCode::SceneInvalid, "The frame is " + std::to_string(frame.images.width) + "x" +
                                                  std::to_string(frame.images.height) +
                                                  ", the view asks for " + std::to_string(view.width_px) +
                                                  "x" + std::to_string(view.height_px) +
                                                  "; measure the frame with the view that it was drawn for.");
  if (!(options.share > 0 && options.share < 1 && options.confidence > 0 && options.confidence < 1))
    return makeError(ErrorCode::SceneInvalid, "Share and confidence of the error must lie between 0 and 1.");

  const std::vector<std::size_t> all = population(*layers, view);
  const std::vector<std::size_t> drawn = stratifiedSample(options.samples, all.size(), options.seed);
  std::vector<std::size_t> pixels(drawn.size());
  std::transform(drawn.begin(), drawn.end(), pixels.begin(), [&](std::size_t d) { return all[d]; });

  const VolumeReading* top = layers->prepared().empty() ? nullptr : layers->prepared().back().reading();
  if (top && top->volume().isColour()) top = nullptr;  // a colour has no value
  const bool withValues = frame.images.values.size() == count && top;
  std::vector<Sample> samples(pixels.size());
  parallelFor(pixels.size(), 16, [&](std::size_t begin, std::size_t end) {
    // A pixel of a rendering may take milliseconds.
    for (std::size_t n = begin; n < end && !stop.stop_requested(); ++n) {
      const glm::dvec2 pixel = centreOf(pixels[n], view);
      Sample& s = samples[n];
      const ReferencePixel truth = layers->at(pixel, withValues ? &s.value : nullptr);
      s.error = levelsBetween(&frame.images.colour[4 * pixels[n]], truth.rgba);
      s.edge = layers->atEdge(pixel);
    }
  });
  if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "The error measurement was cancelled.");

  ErrorReport r;
  r.population = all.size();
  r.populationShare = static_cast<double>(all.size()) / static_cast<double>(count);
  r.share = options.share;
  r.confidence = options.confidence;
  r.kind = options.reference.kind;
  r.seed = options.seed;
  summarise(samples, options, r);
  if (withValues) r.values = valueError(samples, pixels, frame, top->volume());
  return r;
}

const char* nameOf(ErrorKind kind) { return kind == ErrorKind::Model ? "model" : "implementation"; }

std::string errorSentence(const ErrorReport& r) {
  if (r.n == 0) return "nothing to measure: no pixel of the picture meets the data";
  char text[160];
  if (!r.bound) {
    std::snprintf(text, sizeof text, "max seen %.2g levels of 255, n %zu: too few for a bound", r.max, r.n);
  } else if (r.exhaustive) {
    std::snprintf(text, sizeof text, "%g %% within %.2g levels of 255, max %.2g (all %zu pixels tested)",
                  100 * r.share, *r.bound, r.max, r.n);
  } else {
    std::snprintf(text, sizeof text, "%g %% within %.2g levels of 255 (%g %% sure), max seen %.2g, n %zu",
                  100 * r.share, *r.bound, 100 * r.confidence, r.max, r.n);
  }
  return text;
}

}  // namespace vernier::quality
