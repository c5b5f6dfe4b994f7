// SPDX-License-Identifier: GPL-3.0-or-later
// The options of the views dvr, dvr-shaded and iso.
#pragma once
#include "ViewOptions.h"

namespace vernier::app {

void addRenderingFlags(CLI::App&, RenderingOptions&);

// The first of these options that was given; "" when none was.
std::string givenRenderingOption(const RenderingOptions&);

// Puts them into the options of the preset; `preset`: the value of --preset, here the name of a transfer
// function. Which view takes which is checked by presetScene.
Result<void> renderingOptions(const RenderingOptions&, const std::string& view, const std::string& preset,
                              PresetOptions&);

}  // namespace vernier::app
