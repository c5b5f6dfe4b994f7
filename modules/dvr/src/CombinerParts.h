// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a combiner file, each read on its own, and the check of the whole. All throw CombinerFault.
#pragma once
#include "Combiner.h"
#include "CombinerJson.h"

namespace vernier::dvr {

void refuseOtherKeys(const Place& object, std::initializer_list<const char*> known);

std::vector<Input> readInputs(const Place&);
std::vector<Stage> readStages(const Place&);
FinalStage readFinal(const Place&);

// Nothing is read before it is filled. `stages` and `final`: where they stand.
void checkFlow(const Combiner&, const std::string& stages, const std::string& final);

}  // namespace vernier::dvr
