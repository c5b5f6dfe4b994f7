// SPDX-License-Identifier: GPL-3.0-or-later
// NIfTI-1 and NIfTI-2 headers (nifti1.h of 2007, nifti2.h of 2011): single files and pairs.
#pragma once
#include <optional>
#include <span>

#include "files/LoadVoxels.h"

namespace vernier {

inline constexpr std::size_t kNiftiHeaderBytes = 540;  // of NIfTI-2; NIfTI-1 has 348

// Whether these first bytes of a file are a NIfTI header (or an Analyze 7.5 one, which parseNifti refuses).
bool looksLikeNifti(std::span<const std::byte> head);

// The header, with VoxelPlace::skip to the voxels of a single file. `packed`: the file is gzip around that. A
// header of a pair says so by `pair`; its voxels stand in a file of their own from VoxelPlace::skip on.
struct NiftiHeader {
  ParsedVolume parsed;
  bool pair = false;
};
Result<NiftiHeader> parseNifti(std::span<const std::byte> head);

}  // namespace vernier
