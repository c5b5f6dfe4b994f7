// SPDX-License-Identifier: GPL-3.0-or-later
// Volume files that are no DICOM objects: NIfTI, NRRD, MetaImage, VTK image data, raw with a JSON file, lists
// of images (docs/files.md has their rules and limits). A file is known by its first bytes; its name decides
// only where several formats begin alike. Affines are turned to LPS mm exactly (oblique, sheared and
// left-handed ones too). What values mean is never guessed: the unit is "stored value" unless the file states
// one. Where a file does not say what its axes mean, the volume carries the finding "axes-unknown" and
// pictures of it have no letters. Three or four values of 8 bits per voxel are colours; other numbers and
// types of values per voxel are refused.
#pragma once
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "vernier/study/Model.h"
#include "vernier/volume/Build.h"

namespace vernier {

// What the header of a volume file says, without its voxels.
struct VolumeFileFacts {
  std::string format;      // "NIfTI-1", "NIfTI-2", "NRRD", "MetaImage", "VTK image", "raw", "image list"
  std::string storedType;  // type of a value in the file: "int16", "float64"
  std::int64_t frames =
      1;                // volumes in the file; of more than one, BuildOptions::frame names the one to read
  FileRecord dataFile;  // that the voxels stand in: the file itself, or one beside it
  // Grid, type and channels in memory, rescale, unit, windows, title and findings of the header.
  VolumeInfo info;
};

// A file that is a volume file, by its place in StudySet::files. Without facts the header cannot be used:
// `error`.
struct VolumeFile {
  std::size_t file = 0;
  std::optional<VolumeFileFacts> facts;
  std::optional<Error> error;
};

// Which of the files that are not DICOM are volume files, in their order; their kind becomes FileKind::Volume
// and their error that of the header. Reads headers only, in parallel.
VERNIER_API std::vector<VolumeFile> findVolumeFiles(StudySet&);

// Header only. FormatUnknown when the file is of no format that is read; FileDamaged, PixelDataShort,
// GeometryRefused (an affine that is not finite or flat, impossible spacing) or NotBuiltYet (valid, but not
// read) with a sentence that says why.
VERNIER_API Result<VolumeFileFacts> readVolumeFacts(const FileRecord&);

// The whole volume. Sizes are checked against the file before memory is set aside; 64-bit floats become
// 32-bit floats and 64-bit integers 32-bit ones, with a finding, or are refused where they do not fit.
// Colours become a colour volume; an alpha that is 0 everywhere is left out ("alpha-empty"), any other is
// counted ("alpha-channel"). OptionInvalid where a frame must be chosen and is not, or does not exist.
VERNIER_API Result<std::shared_ptr<const Volume>> readVolumeFile(const FileRecord&, const BuildOptions& = {},
                                                                 const ProgressFn& = {},
                                                                 std::stop_token = {});
VERNIER_API Result<std::shared_ptr<const Volume>> readVolumeFile(const std::string& path,
                                                                 const BuildOptions& = {});

// Slice k of a volume as it stands in the file, unresampled: columns and rows are the file's own. Of a colour
// volume red, green and blue, without alpha (finding "alpha-not-shown" where it is not 255 everywhere).
// `window` as autoWindow: automaticWindow() of the volume, found once by the caller.
VERNIER_API Result<std::shared_ptr<const ImageFrame>> imageOfVolume(const Volume&, std::int64_t slice,
                                                                    const VoiWindow& window);

}  // namespace vernier
