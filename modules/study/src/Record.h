// SPDX-License-Identifier: GPL-3.0-or-later
// What the scan knows of one object: the Instance of the public model and what grouping and splitting look
// at. The stages behind the scan are pure functions over records, so their tests need no files.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "vernier/study/Model.h"

namespace vernier {

// Image Orientation as it stands in the file, and how far it is from orthonormal: the largest of | |row| - 1
// |, | |column| - 1 | and | row . column |.
struct RawPlane {
  glm::dvec3 position{0}, row{0}, column{0};
  double offOrthonormal = 0;
};

// What a Real World Value Mapping object says of one image of another object.
struct RealWorldReference {
  std::string sopInstanceUid;
  std::vector<std::uint64_t> frames;  // from 0; empty = all
  std::shared_ptr<const std::vector<RealWorldMapping>> mappings;
};

// Attributes that a series is split by (docs/studies.md); text as in the file, "" when absent. Of a classic
// object, or of one frame.
struct FrameKeys {
  std::optional<RawPlane> rawPlane;
  std::string kernel, kvp, echoNumbers, stackId, segmentNumber, rescaleType, units;
  std::string complexComponent;  // magnitude, phase, real, imaginary
  std::string gridVectors;       // nuclear medicine: energy window, detector... that tell volumes apart
  std::optional<double> bValue_s_mm2;
  std::optional<glm::dvec3> diffusionDirection;
  // ... only when positions coincide without them.
  std::string acquisitionNumber, contrastAgent, triggerTime, cardiacPhase, acquisitionTime, contentTime;
  std::string derivation;
};

// One dimension by which the frames of an object are ordered (PS3.3 C.7.6.17).
struct Dimension {
  std::uint32_t pointer = 0;  // tag of the attribute that varies
  std::string label;
};

struct Record : FrameKeys {
  Instance instance;
  std::optional<PresentationState> presentation;
  bool imageClass = false;  // of an image storage class, with or without pixel data
  std::string patientId, issuer, patientName, birthDate, sex;
  std::string studyUid, studyDate, studyTime, studyDescription, accession;
  std::string seriesUid, seriesDescription;
  std::optional<std::int64_t> seriesNumber;

  // Of instance.frames, one to one.
  std::vector<FrameKeys> frameKeys;
  std::vector<Dimension> dimensions;
  const FrameKeys& keys(std::uint64_t frame) const {
    return frame < frameKeys.size() ? frameKeys[frame] : *this;
  }

  // References to other objects of the study.
  std::vector<std::string> convertedFrom;  // SOP Instance UIDs that a Legacy Converted object was made of
  std::vector<RealWorldReference> realWorldOf;

  // For findings.
  std::vector<double> windowCenters, windowWidths;  // as in the file, valid or not
  std::vector<double> badWindowCenters, badWindowWidths;
  std::vector<Finding> findings;  // of what was read of the object itself: functional groups, grid vectors
  bool part10 = true;
  bool textDamaged = false;      // undecodable bytes in some text
  bool pixelSpacingBad = false;  // present, but 0, negative, not a number or out of 1e-4..1e3 mm
  bool contradictsSyntax = false;
  bool strayDelimiters = false;
  bool quadruped = false;        // Anatomical Orientation Type: L R A P H F do not apply
  bool volumeFrame = false;      // placed in the transducer's volume, not in the patient
  std::size_t frameWindows = 0;  // different windows among the frames of an enhanced object
  std::string lossyTag;          // (0028,2110)
};

}  // namespace vernier
