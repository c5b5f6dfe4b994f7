// SPDX-License-Identifier: GPL-3.0-or-later
// Where the program and what belongs to it lie: found from the running program, so that a build folder, an
// installation and a copied folder all work.
#pragma once
#include <string>

namespace vernier::app {

std::string installPrefix();  // the folder above the program's bin
std::string programFile();    // the running program
// The suite that comes with the program (docs/qa.md); it need not exist.
std::string clinicSuiteFolder();

}  // namespace vernier::app
