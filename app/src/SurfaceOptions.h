// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces on the command line: as the input, by --surface, or named by a scene file.
#pragma once
#include "ViewOptions.h"

namespace vernier::app {

// Nothing but surface files was given as input.
bool onlySurfaces(const ViewOptions&);

// Reads the surfaces of input and --surface; gives the names that scenes use for them.
Result<std::vector<std::string>> addSurfaces(Session&, const ViewOptions&, std::stop_token);
// A scene's surfaces are files beside it, or were given under the same name.
Result<void> findSurfaces(Session&, const Scene&, const std::string& sceneFile, std::stop_token);

// A 3-D picture of surfaces alone.
Result<Scene> sceneOfSurfaces(const ViewOptions&, const std::vector<std::string>& names);
// Adds those that the scene does not show yet, as they lie.
void addSurfaceLayers(Scene&, const std::vector<std::string>& names);

}  // namespace vernier::app
