// SPDX-License-Identifier: GPL-3.0-or-later
// study/Calibration.h for those who see images but not studies.
#pragma once
#include "vernier/study/Calibration.h"
