// SPDX-License-Identifier: GPL-3.0-or-later
// --presentation UID|N: which presentation state, and the first frame that it is meant for.
#pragma once
#include "Session.h"

namespace vernier::app {

struct PresentationChoice {
  std::string sopInstanceUid;
  StackChoice stack;
  std::int64_t slice = 0;  // of the stack
};
// `wanted`: SOP Instance UID, or the position among the presentation states in `info`, counted from 1.
// `within`: only frames of this stack count. OptionInvalid where there is none such, or where it is for no
// image that was opened.
Result<PresentationChoice> choosePresentation(const Session&, const std::string& wanted,
                                              std::optional<StackChoice> within);

}  // namespace vernier::app
