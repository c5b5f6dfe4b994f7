// SPDX-License-Identifier: GPL-3.0-or-later
// Finds and opens the library of the window. WindowUnavailable says what is missing and what to do.
#pragma once
#include "UiEntry.h"

namespace vernier::app {

Result<void> checkUiLibrary();           // is it here, and of this build? For doctor
Result<void> runWindow(const UiStart&);  // until the window is closed

}  // namespace vernier::app
