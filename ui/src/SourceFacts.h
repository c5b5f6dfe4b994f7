// SPDX-License-Identifier: GPL-3.0-or-later
// What the desktop must know of a source before it has pixels: taken once from the study, immutable after.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Session.h"
#include "vernier/plan/PictureGeometry.h"

namespace vernier::ui {

// One stack of one opened input; `name` as Session::sourceName gives it.
struct SourceId {
  int document = -1;
  std::string name;
  friend auto operator<=>(const SourceId&, const SourceId&) = default;
};

struct SourceFacts {
  SourceId id;
  std::string title;  // series description, for the screen
  std::string modality;
  std::string patient;  // name as shown
  // Coordinates are shared only between sources with equal keys: frame of reference and patient.
  std::string linkKey;
  // Of one person only when equal: id, issuer, birth date and sex. Volume files name nobody: "".
  std::string personKey;
  std::string idKey;  // Patient ID and issuer, "" without an ID: equal for one ID with two birth dates
  std::vector<ImageFrameInfo> frames;  // geometry of each image, without pixels; empty for volume files
  std::vector<std::string> files;      // last part of each image's file name
  std::optional<GridGeometry> grid;    // of a stack that passed 3-D validation, or of a volume file
  std::string why2d;                   // else why it did not
  bool isVolumeFile = false;           // no stored frames
  bool colour = false;                 // its values are colours
  std::int64_t count() const { return static_cast<std::int64_t>(frames.size()); }
};

// The image whose plane lies nearest to the point; nullopt where images have no place.
std::optional<std::int64_t> nearestImage(const SourceFacts&, PatientPoint);

SourceFacts factsOf(const app::Session&, app::StackChoice, int document);
// Of a file whose header could be read: its voxels need not be there.
SourceFacts factsOfVolumeFile(const app::Session&, app::StackChoice, int document);
// The file's own title, else its name.
std::string titleOf(const app::Session&, const VolumeFile&);

// "DOE^JANE" as "Doe, Jane" is not for a program to guess: components are shown as stored, "^" as ", ".
std::string shownName(const std::string& dicomName);

}  // namespace vernier::ui
