// SPDX-License-Identifier: GPL-3.0-or-later
// Every limit on what a file may ask for, in one place; `vernier doctor` prints them, tests stand at and over
// each.
#pragma once
#include <cstddef>
#include <cstdint>

namespace vernier::limits {
inline constexpr std::uint64_t kMaxRows = 65535, kMaxColumns = 65535;
inline constexpr std::uint64_t kMaxFrames = 100'000;
inline constexpr std::uint64_t kMaxDecodedFrameBytes = std::uint64_t{2} << 30;
inline constexpr std::uint64_t kMaxNonPixelElementBytes = std::uint64_t{64} << 20;
inline constexpr std::uint64_t kMaxHeaderBytes = std::uint64_t{512}
                                                 << 20;   // everything before the pixel data
inline constexpr std::uint64_t kMaxElements = 1'000'000;  // top-level elements of an object
inline constexpr int kMaxSequenceDepth = 64;
inline constexpr std::size_t kMaxStacksPerSeries = 2'000;
inline constexpr std::uint64_t kMaxFilesPerStudy = 200'000;
inline constexpr std::uint64_t kMaxInflateRatio = 200;  // deflated syntax: output bytes per input byte
// A mask or a dose that is mostly zero packs denser than any ratio, so that this much is granted to every
// data set.
inline constexpr std::uint64_t kAlwaysInflatedBytes = std::uint64_t{16} << 20;
inline constexpr std::uint64_t kMaxInflatedBytes = std::uint64_t{2} << 30;
inline constexpr std::uint64_t kMaxFragments = 1'000'000;
// JPEG, JPEG-LS, JPEG 2000: what a frame may decode to, so that a few bytes cannot ask for gigabytes. A blank
// image packs denser than any ratio, so that up to kAlwaysDecodedBytes are granted to every frame.
inline constexpr std::uint64_t kMaxImageRatio = 4096;
inline constexpr std::uint64_t kAlwaysDecodedBytes = std::uint64_t{64} << 20;
// Progressive JPEG goes over the whole image for each scan: a small file with very many scans is refused.
inline constexpr std::uint64_t kMaxJpegScans = 100;
// ZIP archives, which are unpacked to memory: entries, bytes of one entry and of all, and how often the
// packed bytes an entry or the whole may become. Masks pack denser than images, so a ratio counts only beyond
// a size that is granted to everybody.
inline constexpr std::uint64_t kMaxArchiveEntries = kMaxFilesPerStudy;
inline constexpr std::uint64_t kMaxArchiveEntryBytes = std::uint64_t{2} << 30;
inline constexpr std::uint64_t kMaxArchiveBytes = std::uint64_t{32} << 30;
inline constexpr std::uint64_t kMaxArchiveRatio = 200;
inline constexpr std::uint64_t kArchiveEntryAlwaysBytes = std::uint64_t{64} << 20;
inline constexpr std::uint64_t kArchiveAlwaysBytes = std::uint64_t{256} << 20;
// Surfaces: a whole file is read at once; 20 million triangles are 1 GB as binary STL.
inline constexpr std::uint64_t kMaxSurfaceFileBytes = std::uint64_t{4} << 30;
inline constexpr std::uint64_t kMaxTriangles = 20'000'000;
inline constexpr std::uint64_t kMaxConcaveCorners = 512;  // of one polygon that is not convex
inline constexpr int kMaxNodeDepth = 64;                  // Inventor and VRML

// All of the above, as `vernier doctor` prints them.
struct Limit {
  const char* name;
  std::uint64_t value;
  const char* unit;  // "bytes", or "" for a count
};
inline constexpr Limit kAll[] = {
    {"rows", kMaxRows, ""},
    {"columns", kMaxColumns, ""},
    {"frames", kMaxFrames, ""},
    {"decoded_frame", kMaxDecodedFrameBytes, "bytes"},
    {"element_without_pixels", kMaxNonPixelElementBytes, "bytes"},
    {"header", kMaxHeaderBytes, "bytes"},
    {"elements", kMaxElements, ""},
    {"sequence_depth", static_cast<std::uint64_t>(kMaxSequenceDepth), ""},
    {"stacks_per_series", kMaxStacksPerSeries, ""},
    {"files_per_study", kMaxFilesPerStudy, ""},
    {"inflate_ratio", kMaxInflateRatio, ""},
    {"always_inflated", kAlwaysInflatedBytes, "bytes"},
    {"inflated", kMaxInflatedBytes, "bytes"},
    {"fragments", kMaxFragments, ""},
    {"image_ratio", kMaxImageRatio, ""},
    {"always_decoded", kAlwaysDecodedBytes, "bytes"},
    {"jpeg_scans", kMaxJpegScans, ""},
    {"archive_entries", kMaxArchiveEntries, ""},
    {"archive_entry", kMaxArchiveEntryBytes, "bytes"},
    {"archive", kMaxArchiveBytes, "bytes"},
    {"archive_ratio", kMaxArchiveRatio, ""},
    {"archive_entry_always", kArchiveEntryAlwaysBytes, "bytes"},
    {"archive_always", kArchiveAlwaysBytes, "bytes"},
    {"surface_file", kMaxSurfaceFileBytes, "bytes"},
    {"triangles", kMaxTriangles, ""},
    {"concave_corners", kMaxConcaveCorners, ""},
    {"node_depth", static_cast<std::uint64_t>(kMaxNodeDepth), ""},
};
}  // namespace vernier::limits
