// SPDX-License-Identifier: GPL-3.0-or-later
// The pixels that a scene can contribute to, told from geometry alone: the outline of what each layer's plane
// or slab cuts from its volume, or of its frame; of layers that look through a volume, of each brick whose
// voxels can show something, inside lenses where the lens is; of triangles. Dilated by 2 pixels.
#pragma once
#include "Layers.h"

namespace vernier::quality {

// Indices x + width * y, tile by tile (16 x 16), so that neighbours in the list are neighbours in the
// picture.
std::vector<std::size_t> population(const Layers&, const View&);

}  // namespace vernier::quality
