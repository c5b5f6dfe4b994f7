// SPDX-License-Identifier: GPL-3.0-or-later
// The pipeline: scan -> group -> sort -> validate (here: headers only) and the decoding of one stack.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "vernier/base/Progress.h"
#include "vernier/study/Model.h"

namespace vernier {

// Reads the headers of all files under `paths` (files or folders, folders recursively, links not followed out
// of the folder), in parallel. Fails only when a path does not exist, is a device or a pipe, or when
// cancelled; a file that cannot be read is a FileRecord with its error. Deterministic: the order of directory
// entries does not matter.
VERNIER_API Result<StudySet> scanStudy(const std::vector<std::string>& paths, const ProgressFn& progress = {},
                                       std::stop_token stop = {});

// Decodes one frame (stored values, layout as Decode.h) into `out`. Opens the file with read(), never mmap.
// The empty frames of a segmentation (SliceRef::kEmptyFrame) are zeros. `colours`, when given, takes what the
// samples are: a JPEG image that says how it was coded overrules the photometric interpretation, so that no
// colour is converted twice or not at all.
VERNIER_API Result<void> decodeSlice(const StudySet&, SliceRef, std::span<std::byte> out,
                                     ColourSpace* colours = nullptr);

// The same for many frames one after the other: the file stays open and its pixel data indexed, so that each
// frame costs its own bytes only. Frames of a deflated object are cheapest in ascending order. One thread at
// a time; the set must outlive it.
class VERNIER_API FrameReader {
 public:
  explicit FrameReader(const StudySet&);
  ~FrameReader();
  Result<void> read(SliceRef, std::span<std::byte> out, ColourSpace* colours = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Decodes all slices of a stack in parallel, slice s to out + s * sliceBytes. All slices of a stack have the
// same rows, columns and samples; the container of all is `sample` (values that don't fit fail with
// CodecMismatch). A slice that fails is reported in `failed` (index, error) and left zero; the call itself
// fails when all fail.
struct SliceFailure {
  std::size_t slice;
  Error error;
};
VERNIER_API Result<void> decodeStack(const StudySet&, const Stack&, SampleType sample,
                                     std::span<std::byte> out, std::vector<SliceFailure>& failed,
                                     const ProgressFn& progress = {}, std::stop_token stop = {});

}  // namespace vernier
