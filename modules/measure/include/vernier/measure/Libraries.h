// SPDX-License-Identifier: GPL-3.0-or-later
// The image library that measuring and comparing stand on, hidden behind this module's headers.
#pragma once
#include <string>

#include "vernier/base/Api.h"

namespace vernier::measure {

// Its version, for the identity of a report: "OpenCV 4.6.0".
VERNIER_API std::string imageLibrary();

}  // namespace vernier::measure
