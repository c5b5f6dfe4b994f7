// SPDX-License-Identifier: GPL-3.0-or-later
// Accepting a new baseline: one case, with a reason, the old one kept.
#pragma once
#include "QaRun.h"

namespace vernier::app {

struct QaAccepted {
  bool changed = false;  // false: the baseline is this picture already
  std::string kept;      // name of the old baseline in the case's folder, "" if there was none
  std::string sha256;    // of the new expected.png
};

// Draws the case natively (the judge of baselines: bit-equal on any number of threads), checks that the
// picture is fit to be a baseline, moves the old one to history/expected-N.png and adds a line to
// history/accepted.json. In this order, each file whole, so that whatever interrupts it the old baseline or
// the new one is there. OptionInvalid, FileDamaged, WriteFailed and what drawing gives.
Result<QaAccepted> acceptQaCase(QaRunner&, const std::string& suite, const std::string& name,
                                const std::string& reason);

}  // namespace vernier::app
