// SPDX-License-Identifier: GPL-3.0-or-later
// Iso-surfaces of a volume by marching cubes: where the modality value, linear along the edges between
// neighbouring voxel centres, passes a level. Vertices in patient mm (the mesh's frame is the patient's), at
// the true places of the slices.
//
// A voxel whose value equals the level (both rounded to float) is inside. The volume counts as surrounded by
// what is below every level, so that surfaces are closed: where the inside reaches the border they run
// through the outermost voxel centres. No-data and gaps between slices count as outside in the same way, and
// the surface closes at the last voxel with data: half of nothing is shown of what is not known. Triangles
// are counter-clockwise seen from where values are lower, in left-handed grids too. They stand in the list by
// blocks of 16 voxels, so that neighbours in the list are neighbours in space.
//
// Spread over blocks of slices with parallelFor; the same bits for any number of threads. Needs VTK's
// libraries at run time. Source: W. Schroeder, R. Maynard, B. Geveci, Flying Edges (2015).
#pragma once
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "vernier/base/Cache.h"
#include "vernier/base/Progress.h"
#include "vernier/volume/Mesh.h"
#include "vernier/volume/Volume.h"

namespace vernier {

struct IsoSurfaces {
  std::vector<std::shared_ptr<const Mesh>> meshes;  // one per level; nullptr where no value reaches it
  std::size_t extracted = 0;                        // how many were not in the cache
};
// Each level is kept in the cache by the volume's revision and its value: only those that are missing are
// extracted. FormatUnknown where VTK is not installed, GeometryRefused for a
// colour volume, Cancelled (looked at between blocks), OutOfMemory by guarded() callers.
VERNIER_API Result<IsoSurfaces> isoSurfaces(const Volume&, std::span<const double> levels_val, DerivedCache&,
                                            std::stop_token = {}, const ProgressFn& = {});

// Host memory that extraction takes beside its results, on so many threads.
VERNIER_API std::uint64_t isoWorkingBytes(const GridGeometry&, int threads);
// About how many triangles each level has, from every fourth row of every fourth slice. Levels ascend.
VERNIER_API std::vector<std::uint64_t> estimateIsoTriangles(const Volume&,
                                                            std::span<const double> levels_val);
inline constexpr std::uint64_t kIsoBytesPerTriangle = 24;  // of a mesh: 12, and half a vertex

}  // namespace vernier
