// SPDX-License-Identifier: GPL-3.0-or-later
// Surface phantoms: a recipe with "surface" in place of "source" becomes one binary STL in mm. Its answers
// hold what is exact of the triangles (count, box, area, volume: sums in double over the coordinates as the
// file holds them) and, under "solid", what is exact of the shape that they approach.
#pragma once
#include <filesystem>

#include "Field.h"
#include "vernier/phantoms/Phantoms.h"

namespace vernier::phantoms {

Result<PhantomInfo> writeSurface(const Json& recipe, const std::filesystem::path& outDir);

}  // namespace vernier::phantoms
