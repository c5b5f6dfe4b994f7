// SPDX-License-Identifier: GPL-3.0-or-later
#include "PresentationOption.h"

#include <algorithm>
#include <charconv>

namespace vernier::app {
namespace {

Error invalid(const std::string& sentence) {
  return makeError(ErrorCode::OptionInvalid, sentence, "--presentation");
}

const PresentationState* find(const StudySet& set, const std::string& wanted) {
  const auto& all = set.presentations;
  std::size_t n = 0;
  const char* const end = wanted.data() + wanted.size();
  if (const auto [p, ec] = std::from_chars(wanted.data(), end, n);
      ec == std::errc() && p == end && n >= 1 && n <= all.size())
    return &all[n - 1];
  const auto it = std::find_if(all.begin(), all.end(),
                               [&](const PresentationState& p) { return p.sopInstanceUid == wanted; });
  return it == all.end() ? nullptr : &*it;
}

std::optional<std::int64_t> firstSlice(const StudySet& set, const Stack& stack,
                                       const PresentationState& state) {
  for (std::size_t s = 0; s < stack.slices.size(); ++s) {
    const SliceRef& ref = stack.slices[s];
    if (refersTo(state.images, set.instances[ref.instance].sopInstanceUid,
                 static_cast<std::int64_t>(ref.frame) + 1))
      return static_cast<std::int64_t>(s);
  }
  return std::nullopt;
}

}  // namespace

Result<PresentationChoice> choosePresentation(const Session& session, const std::string& wanted,
                                              std::optional<StackChoice> within) {
  const StudySet& set = session.study();
  const PresentationState* const state = find(set, wanted);
  if (!state)
    return invalid("No presentation state has this UID or number; `vernier info` numbers the " +
                   std::to_string(set.presentations.size()) + " of the input.");
  for (std::size_t s = 0; s < set.series.size(); ++s)
    for (std::size_t k = 0; k < set.series[s].stacks.size(); ++k) {
      if (within && (within->series != s || within->stack != k)) continue;
      if (const auto slice = firstSlice(set, set.series[s].stacks[k], *state))
        return PresentationChoice{state->sopInstanceUid, {s, k}, *slice};
    }
  return invalid(within ? "The presentation state is for no image of the series that was chosen."
                        : "None of the images that the presentation state is for is among what was opened.");
}

}  // namespace vernier::app
