// SPDX-License-Identifier: GPL-3.0-or-later
// The attributes that a series is split by (docs/studies.md, "Stacks"), as comparisons of two frames.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "Record.h"

namespace vernier {

// Frames that are not told apart: one frame of an object that describes each, or all of an object that does
// not.
struct FrameGroup {
  std::size_t record = 0;
  std::uint64_t first = 0, count = 1;
};
// What splits looks at.
struct FrameView {
  const Record* record;
  const FrameAttributes* frame;
  const FrameKeys* keys;
};
FrameView viewOf(const std::vector<Record>& records, const FrameGroup& g);

struct SplitKey {
  std::string name;
  std::function<std::string(const FrameView&)> value;  // how to say it
  // Empty: equal when the values are.
  std::function<bool(const FrameView&, const FrameView&)> equal;
  bool same(const FrameView& a, const FrameView& b) const {
    return equal ? equal(a, b) : value(a) == value(b);
  }
};

const std::vector<SplitKey>& splitKeys();
// Used only when positions coincide without them, in this order; the dimensions of the objects' own dimension
// index come after those of the standard, and whole objects last.
std::vector<SplitKey> tieKeys(const std::vector<Record>& records, const std::vector<FrameGroup>& members);

bool sameSpacing(const FrameAttributes& a, const FrameAttributes& b);
bool isLocalizer(const FrameView&);

}  // namespace vernier
