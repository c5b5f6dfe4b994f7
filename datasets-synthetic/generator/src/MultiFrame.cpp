// SPDX-License-Identifier: GPL-3.0-or-later
#include "MultiFrame.h"

#include <algorithm>

#include "vernier/base/Random.h"

namespace vernier::phantoms {
namespace {

// Frames in an order that says nothing about their places.
std::vector<std::size_t> shuffled(std::size_t n, std::uint64_t seed) {
  std::vector<std::size_t> order(n);
  for (std::size_t k = 0; k < n; ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [seed](std::size_t a, std::size_t b) {
    return randomBits(seed, 11000 + a) < randomBits(seed, 11000 + b);
  });
  return order;
}

// All slices once for each contrast: echo 1 of a place, echo 2 of the same place, the next place.
void addContrasts(const Json& contrasts, SeriesPlan& s) {
  std::vector<SlicePlan> all;
  for (const SlicePlan& place : s.slices)
    for (std::size_t c = 0; c < contrasts.size(); ++c) {
      SlicePlan p = place;
      p.factor = contrasts[c].at("factor");
      p.slope = contrasts[c].at("slope");
      p.echoTime_ms = contrasts[c].value("echo_time_ms", 0.0);
      p.bValue_s_mm2 = contrasts[c].value("b_value_s_mm2", -1.0);
      p.noiseKey += 200000 * static_cast<std::int64_t>(c);
      all.push_back(p);
    }
  s.slices = std::move(all);
}

}  // namespace

void makeMultiFrame(const Json& recipe, const std::function<std::string(const std::string&)>& uid,
                    StudyPlan& study) {
  const Json& multi = recipe.at("multi_frame");
  const std::string kind = multi.at("kind");
  if (kind == "segmentation" || kind == "dose") return;  // beside a series of single slices
  SeriesPlan& s = study.series.front();
  s.storage = s.storage == Storage::Mr ? Storage::EnhancedMr : Storage::EnhancedCt;
  for (std::size_t k = 0; k < s.slices.size(); ++k) s.slices[k].position = k;
  std::vector<std::size_t> order;
  if (multi.contains("contrasts")) {
    addContrasts(multi["contrasts"].at(multi.at("contrast").get<std::string>()), s);
    for (std::size_t k = 0; k < s.slices.size(); ++k) order.push_back(k);
  } else {
    order = shuffled(s.slices.size(), study.seed);
  }
  const std::size_t parts = static_cast<std::size_t>(multi.value("parts", 1.0));
  if (parts > 1) s.concatenationUid = uid("concatenation");
  for (std::size_t p = 0; p < parts; ++p) {
    ObjectPlan o;
    // The last part comes first by name and by instance number.
    o.fileName = "MF" + std::to_string(parts - p) + ".dcm";
    o.sopUid = uid("multi-frame " + std::to_string(p));
    o.firstFrame = p * order.size() / parts;
    const std::size_t end = (p + 1) * order.size() / parts;
    for (std::size_t f = o.firstFrame; f < end; ++f) {
      SlicePlan& slice = s.slices[order[f]];
      slice.fileName = o.fileName;
      slice.sopUid = o.sopUid;
      slice.frame = static_cast<int>(f - o.firstFrame) + 1;
      o.slices.push_back(order[f]);
    }
    s.objects.push_back(std::move(o));
  }
  if (parts > 1)
    study.findings.push_back({{"code", "concatenation"}, {"parts", parts}, {"frames", s.slices.size()}});
  if (multi.contains("contrasts"))
    study.findings.push_back(
        {{"code", "split-into-stacks"},
         {"stacks", multi["contrasts"].at(multi.at("contrast").get<std::string>()).size()}});
}

}  // namespace vernier::phantoms
