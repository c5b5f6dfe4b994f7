// SPDX-License-Identifier: GPL-3.0-or-later
// The techniques of this module, one function each.
#pragma once
#include "vernier/plan/Technique.h"

namespace vernier::lens {

Technique nativeLensTechnique(Host&);
Technique glLensTechnique(Host&);

}  // namespace vernier::lens
