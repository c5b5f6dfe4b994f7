// SPDX-License-Identifier: GPL-3.0-or-later
// One series of records -> its stacks: what may not be mixed is split, positions that coincide are told
// apart, every stack is ordered and fitted. Pure; rules in docs/studies.md, "Stacks".
#pragma once
#include <vector>

#include "Record.h"

namespace vernier {

struct SplitResult {
  std::vector<Stack> stacks;      // largest first, then by first instance
  std::vector<Finding> findings;  // "split-into-stacks"
};
// `members`: indices into `records` of the objects that can be drawn. SliceRef::instance is that index.
SplitResult makeStacks(const std::vector<Record>& records, std::vector<std::size_t> members);

// Whether both have equal pixels' place: position, orientation and spacing (for equal SOP Instance UIDs).
bool sameGeometry(const Record& a, const Record& b);

}  // namespace vernier
