// SPDX-License-Identifier: GPL-3.0-or-later
// A study written to disk as real DICOM files, with its model filled in by hand: what is tested here is what
// becomes of a model, not how it is read from headers.
#pragma once
#include <string>
#include <vector>

#include "MakeDicom.h"
#include "TestData.h"
#include "vernier/study/Load.h"
#include "vernier/study/Model.h"

namespace vernier::test {

struct HandMadeStudy {
  TempDir dir;
  StudySet set;

  Series& series() { return set.series[0]; }
  Stack& stack() { return set.series[0].stacks[0]; }
  Instance& instance(std::size_t n) { return set.instances[n]; }
  // Replaces the model by what the loader makes of the files: instance n is then slice n of the first stack.
  bool scan() {
    auto scanned = scanStudy({dir.path().string()});
    EXPECT_TRUE(scanned.ok()) << (scanned.ok() ? "" : scanned.error().text());
    if (!scanned) return false;
    set = std::move(scanned).value();
    const bool one = set.series.size() == 1 && set.series[0].stacks.size() == 1;
    EXPECT_TRUE(one);
    return one;
  }
  std::filesystem::path file(std::size_t n) const { return set.files[n].path; }
};

inline SampleType sampleFor(const DicomSlice& d) {
  if (d.bitsAllocated == 8) return d.isSigned ? SampleType::I8 : SampleType::U8;
  if (d.bitsAllocated == 16) return d.isSigned ? SampleType::I16 : SampleType::U16;
  return d.isSigned ? SampleType::I32 : SampleType::U32;
}

inline Instance instanceFor(const DicomSlice& d, std::size_t file) {
  Instance i;
  i.file = file;
  i.sopClassUid = d.sopClassUid;
  i.modality = d.modality;
  i.frameOfReferenceUid = d.frameOfReferenceUid;
  i.isImage = true;
  i.pixels.transferSyntaxUid = i.transferSyntaxUid = d.transferSyntaxUid;
  i.pixels.rows = std::uint64_t(d.rows);
  i.pixels.columns = std::uint64_t(d.columns);
  i.pixels.framesDeclared = std::uint64_t(d.frames);
  i.pixels.samplesPerPixel = std::uint64_t(d.samplesPerPixel);
  i.pixels.bitsAllocated = std::uint32_t(d.bitsAllocated);
  i.pixels.bitsStored = std::uint32_t(d.bitsStored);
  i.pixels.highBit = std::uint32_t(d.bitsStored - 1);
  i.pixels.isSigned = d.isSigned;
  i.pixels.photometric = i.photometric = d.photometric;
  i.pixels.sample = sampleFor(d);
  i.plane = FramePlane{PatientPoint(d.position[0], d.position[1], d.position[2]), PatientVec(1, 0, 0),
                       PatientVec(0, 1, 0)};
  i.pixelSpacing_mm = {d.spacing[0], d.spacing[1]};
  i.rescale = {d.slope, d.intercept};
  i.unit = d.modality == "CT" ? "HU" : "stored value";
  return i;
}

// One slice per entry, at z = 0, 2, 4... mm.
inline void makeStudy(HandMadeStudy& s, std::vector<DicomSlice> slices) {
  Series series;
  series.seriesUid = "2.25.1002";
  series.studyUid = "2.25.1001";
  series.modality = slices.at(0).modality;
  series.description = "a series";
  Stack stack;
  for (std::size_t n = 0; n < slices.size(); ++n) {
    DicomSlice& d = slices[n];
    d.position = {0, 0, 2.0 * double(n)};
    d.instanceNumber = int(n) + 1;
    const std::string name = std::to_string(n) + ".dcm";
    writeDicom(s.dir.path() / name, d);
    FileRecord f;
    f.path = (s.dir.path() / name).string();
    f.shown = name;
    f.bytes = std::filesystem::file_size(f.path);
    f.kind = FileKind::Image;
    s.set.files.push_back(f);
    s.set.instances.push_back(instanceFor(d, n));
    series.instances.push_back(n);
    stack.slices.push_back({n, 0});
    stack.positions_mm.push_back(2.0 * double(n));
  }
  stack.shape = StackShape::Uniform;
  stack.volume3d = true;
  stack.step_mm = 2;
  stack.grid.columns = slices[0].columns;
  stack.grid.rows = slices[0].rows;
  stack.grid.slices = std::int64_t(slices.size());
  stack.grid.patientFromVoxel.linear[2] = {0, 0, 2};
  series.stacks.push_back(stack);
  s.set.series.push_back(series);
  s.set.studies.push_back({"2.25.1001", "", "", "", "", {0}});
  s.set.patients.push_back({"TEST-1", "HOSPITAL", "Test^Slice", "", "", {0}});
}

// n slices of 3 x 2 pixels, stored value = 100 * slice + pixel index.
inline std::vector<DicomSlice> countingSlices(int n) {
  std::vector<DicomSlice> all;
  for (int s = 0; s < n; ++s) {
    DicomSlice d;
    d.columns = 3;
    d.rows = 2;
    for (int p = 0; p < 6; ++p) d.pixels.push_back(100 * s + p);
    all.push_back(d);
  }
  return all;
}

}  // namespace vernier::test
