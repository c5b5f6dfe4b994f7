// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces from files: STL (binary, text), PLY (text, both byte orders), OBJ, VTP, VRML 1.0 and 2.0, and the
// IndexedFaceSet subset of Inventor text files (docs/surfaces.md says what each reader takes).
//
// None of these carries a unit: mm is assumed, and the finding "unit-assumed" says so with the size that
// follows. Polygons are cut into triangles; colours, normals and textures of the file are not used. What
// cannot be drawn is dropped and counted (Mesh.h). Nothing is set aside for what a file declares before its
// bytes are there. Errors: FileNotFound, NotAFile, FormatUnknown (another kind of file, whatever its name
// says), FileDamaged (cut short, or it contradicts itself; with the line for text), NothingToLoad (no
// triangle), LimitExceeded (study/ Limits.h), NotBuiltYet (a node or element that is not read, by its name),
// OutOfMemory, Cancelled. Errors and findings name the file, never its path. Safe on any thread.
#pragma once
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "vernier/base/Budget.h"
#include "vernier/study/Findings.h"
#include "vernier/volume/Mesh.h"
#include "vernier/volume/MeshFacts.h"

namespace vernier {

struct SurfaceFile {
  std::string format;  // "binary STL", "text STL", "PLY", "OBJ", "VTP", "VRML 2.0", "Inventor"...
  std::uint64_t bytes = 0;
  std::optional<std::uint64_t> declaredTriangles, bytesExpected;  // binary STL says both
  std::uint64_t triangles = 0;                                    // read, before any were dropped
  MeshDropped dropped;
  std::shared_ptr<const Mesh> mesh;
  std::vector<Finding> findings;
};

struct SurfaceOptions {
  MemoryBudget* budget = nullptr;  // asked for the file's bytes and the mesh while reading
};

// By the name alone: .stl .ply .obj .vtp .wrl .vrml .iv, in any case.
VERNIER_API bool looksLikeSurface(const std::string& path);

VERNIER_API Result<SurfaceFile> readSurface(const std::string& path, const SurfaceOptions& = {},
                                            std::stop_token = {});

// The findings that need the facts: open, not a manifold, turned inside out, duplicates, an unlikely size.
VERNIER_API std::vector<Finding> surfaceFindings(const Mesh&, const MeshFacts&);

}  // namespace vernier
