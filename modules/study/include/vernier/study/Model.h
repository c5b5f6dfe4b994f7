// SPDX-License-Identifier: GPL-3.0-or-later
// The study model: Patient > Study > Series > Stack > slices, plus every file that was looked at. Plain
// values; no pixels. Lengths mm, positions LPS. Rules: DICOM PS3.3; grouping, splitting and geometry as
// docs/studies.md states.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vernier/base/GridGeometry.h"
#include "vernier/base/Result.h"
#include "vernier/study/Findings.h"
#include "vernier/study/FrameSpec.h"
#include "vernier/study/Palette.h"
#include "vernier/study/Presentation.h"
#include "vernier/study/Values.h"

namespace vernier {

class Archive;

// Position of one frame (Image Plane module or functional groups).
struct FramePlane {
  PatientPoint origin;         // centre of the first pixel
  PatientVec rowDirection;     // direction of increasing column index, unit
  PatientVec columnDirection;  // direction of increasing row index, unit
};

// What a stored value means in the real world beside its modality value (PS3.3 C.7.6.16.2.11): slope * stored
// + intercept, or a table, for stored values in [first, last].
struct RealWorldMapping {
  double first = 0, last = 0;  // stored values, inclusive
  double slope = 1, intercept = 0;
  std::vector<double> table;   // when not empty: entry stored - first
  std::string unit;            // UCUM code, "1" = no unit
  std::string label, meaning;  // LUT Label; what is measured ("SUVbw") or the unit in words
};

// What holds for one frame. Of a classic object: its own attributes. Of an object with functional groups:
// those of the frame, else the shared ones, never the root's (PS3.3 C.7.6.16).
struct FrameAttributes {
  std::optional<FramePlane> plane;      // absent: no geometry; directions made orthonormal
  std::optional<FramePlane> filePlane;  // directions as the file has them, for places of single pixels
  glm::dvec2 pixelSpacing_mm{0, 0};     // row\column as in (0028,0030): x = distance between rows; 0 = absent
  double sliceThickness_mm = 0;
  ModalityRescale rescale;
  bool rescaleInvalid = false;     // slope 0 or not finite: stored values are shown, marked "unscaled"
  std::vector<VoiWindow> windows;  // valid ones only
  std::optional<double> paddingFirst,
      paddingLast;   // stored values, inclusive; last = first without a range limit
  std::string unit;  // "HU", "SUVbw", "stored value"...
  std::optional<double> echoTime_ms;
  std::optional<std::int64_t> temporalPosition;
  std::vector<std::string> imageType;         // Image Type, or Frame Type where the frame has one
  std::vector<std::uint32_t> dimensionIndex;  // Dimension Index Values
  std::vector<std::uint16_t> segments;        // numbers of the segments that a segmentation's frame shows
  std::shared_ptr<const std::vector<RealWorldMapping>> realWorld;  // may be null
};

// One segment of a segmentation (PS3.3 C.8.20.2).
struct Segment {
  std::uint16_t number = 0;
  std::string label, category, type, algorithm;
  std::optional<std::array<double, 3>> colour;  // sRGB 0..1 of the Recommended Display CIELab Value
};
enum class SegmentationKind { None, Binary, Fractional };

// Parts of one object that was sent in several (PS3.3 C.7.6.16.2.2.4).
struct Concatenation {
  std::string uid;
  std::int64_t number = 0, total = 0;  // 1..; total 0 = not said
  std::uint64_t frameOffset = 0;       // of this part's first frame
};

// One person name of an object, wherever it stands in it.
struct NamedText {
  std::string at;    // keyword path: "PatientName", "RequestedProcedureCodeSequence[0].PatientName"
  std::string text;  // component groups divided by "="
};

// Objects with equal SOP Instance UIDs: one of those with the same decoded values and geometry is Kept, the
// others are Repeated; those that differ are in Conflict: each can be viewed, none goes into a volume.
enum class Identity { Unique, Kept, Repeated, Conflict };

// One object of a file. Attribute text is UTF-8. The attributes of the base are those of its first frame.
struct Instance : FrameAttributes {
  std::size_t file = 0;     // index into StudySet::files
  std::size_t series = 0;   // index into StudySet::series
  std::size_t patient = 0;  // index into StudySet::patients
  Identity identity = Identity::Unique;
  std::vector<NamedText> names;
  std::uint64_t framesDeclared = 1;  // also of objects whose pixels cannot be shown
  std::string sopClassUid, sopClassName, sopInstanceUid, transferSyntaxUid;
  std::string modality;
  std::optional<std::int64_t> instanceNumber, acquisitionNumber;
  std::string frameOfReferenceUid;
  bool isImage = false;  // an image storage object with pixel data
  std::string
      notShown;      // why it is listed but not drawn ("kept, not shown: encapsulated PDF"); empty = drawn
  FrameSpec pixels;  // valid when isImage and pixelError is empty
  std::optional<Error> pixelError;  // why its pixels cannot be shown
  std::optional<LutTable> modalityLut;
  std::vector<LutTable> voiLuts;
  bool lossy = false;
  std::string photometric;
  std::shared_ptr<const Palette> palette;  // of PALETTE COLOR images whose pixels can be shown
  std::string presentationLutShape;
  std::string patientOrientation;  // row\column letters, when there is no plane
  // One entry per frame where frames differ or may differ (functional groups, dose and slice vectors); null:
  // all frames have the attributes of the base.
  std::shared_ptr<const std::vector<FrameAttributes>> frames;
  std::vector<double>
      frameTimes_ms;  // of a cine: when each frame was taken, from the first; empty = not said
  std::optional<Concatenation> concatenation;
  SegmentationKind segmentation = SegmentationKind::None;
  double maxFractional = 0;  // of a fractional segmentation: the stored value that means 1
  std::vector<Segment> segments;

  const FrameAttributes& frame(std::uint64_t n) const {
    return frames && n < frames->size() ? (*frames)[n] : *this;
  }
};

// One slice of a stack: a frame of an instance.
struct SliceRef {
  // A place of a segmentation where its segment is empty and no frame was written: all zero.
  static constexpr std::uint64_t kEmptyFrame = ~std::uint64_t{0};
  std::size_t instance = 0;  // index into StudySet::instances
  std::uint64_t frame = 0;
};

// Uneven: GridGeometry::sliceOrigin_vox holds the true places, because of uneven steps or of gaps.
// NoGeometry: `grid` is not valid, no lengths, no 3-D; positions_mm may be filled all the same (a bad pixel
// spacing, for instance).
enum class StackShape { NoGeometry, Single, Uniform, Sheared, Uneven };

struct Stack {
  // Ascending along the normal; without geometry by instance number and, within an object, by dimension index
  // values or frame number.
  std::vector<SliceRef> slices;
  std::string label;  // what set it apart in its series, "" when alone: "echo time 90 ms"
  StackShape shape = StackShape::NoGeometry;
  GridGeometry grid;                 // valid unless NoGeometry
  std::vector<double> positions_mm;  // along the unit normal row x column
  double step_mm = 0;                // median, along the normal
  double shear_deg = 0;
  double deviation_mm = 0;             // e: largest distance of an origin from the straight even line
  double deviationAlongNormal_mm = 0;  // the part of it along the normal: uneven steps
  bool volume3d = false;               // passed 3-D validation: MPR, MIP and DVR are offered
  std::string why2d;                   // else the reason, one sentence
  bool orientationFixed = false;       // row and column direction were off orthonormal by 1e-4 to 1e-2
  std::vector<Finding> findings;
};

struct Series {
  std::string seriesUid, studyUid, modality, description;
  std::optional<std::int64_t> number;
  std::vector<std::size_t> instances;  // all objects, images and others
  std::vector<Stack> stacks;           // image stacks, largest first
  std::vector<Finding> findings;
};
struct Study {
  std::string studyUid, date, time, description, accession;
  std::vector<std::size_t> series;  // index into StudySet::series
};
// Of one Patient ID and issuer. Where such objects state two birth dates or two sexes, they are of as many
// patients as there are pairs of them.
struct Patient {
  std::string id, issuer, name, birthDate, sex;
  std::vector<std::size_t> studies;
};

// Volume: no DICOM, but a volume file (volume/VolumeFile.h).
enum class FileKind { Image, NonImage, DicomDir, NoSopClass, Unreadable, NotDicom, Volume };
struct FileRecord {
  std::string path;                        // to open it; of an entry of an archive: the archive's
  std::string shown;                       // relative to what the user named; of an entry: its last part
  std::shared_ptr<const Archive> archive;  // nullptr: the file itself
  std::size_t entry = 0;                   // which of Archive::entries()
  std::uint64_t bytes = 0;
  FileKind kind = FileKind::NotDicom;
  std::optional<Error> error;  // one sentence and a next step
};

struct StudySet {
  std::vector<FileRecord> files;
  std::vector<Instance> instances;
  std::vector<Series> series;
  std::vector<Study> studies;
  std::vector<Patient> patients;
  std::vector<PresentationState> presentations;  // in file order
  std::vector<Finding> findings;                 // those of no single series
};

// Whose a stack is: it never holds images of two patients, though its series or study may. nullptr: it holds
// nothing.
inline const Patient* patientOf(const StudySet& set, const Stack& stack) {
  if (stack.slices.empty() || stack.slices.front().instance >= set.instances.size()) return nullptr;
  const std::size_t n = set.instances[stack.slices.front().instance].patient;
  return n < set.patients.size() ? &set.patients[n] : nullptr;
}

}  // namespace vernier
