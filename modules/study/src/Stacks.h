// SPDX-License-Identifier: GPL-3.0-or-later
// One series of records -> its stacks: what may not be mixed is split, positions that coincide are told
// apart, every stack is ordered and fitted. Objects that describe their frames one by one are split frame by
// frame; of others all frames stay together. Pure; rules in docs/studies.md, "Stacks".
#pragma once
#include <vector>

#include "Record.h"

namespace vernier {

struct SplitResult {
  std::vector<Stack> stacks;      // largest first, then by first instance
  std::vector<Finding> findings;  // "split-into-stacks", "too-many-stacks"
};
// `members`: indices into `records` of the objects that can be drawn. SliceRef::instance is that index.
SplitResult makeStacks(const std::vector<Record>& records, std::vector<std::size_t> members);

// Whether all frames of both have equal places: position, orientation and spacing (for equal SOP Instance
// UIDs).
bool sameGeometry(const Record& a, const Record& b);

}  // namespace vernier
