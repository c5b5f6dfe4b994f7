// SPDX-License-Identifier: GPL-3.0-or-later
// The options of views that look through a volume: projections and shells.
#pragma once
#include "ViewOptions.h"

namespace vernier::app {

void addVolumeFlags(CLI::App&, VolumeOptions&);

// The first of these options that was given; "" when none was.
std::string givenVolumeOption(const VolumeOptions&);

// Puts them into the options of the preset of that view; which view takes which is checked there.
Result<void> volumeOptions(const VolumeOptions&, const std::string& view, PresetOptions&);

}  // namespace vernier::app
