// SPDX-License-Identifier: GPL-3.0-or-later
// Every limit on what a file may ask for, in one place; `vernier doctor` prints them, tests stand at and over each.
#pragma once
#include <cstdint>

namespace vernier::limits {
inline constexpr std::uint64_t kMaxRows = 65535, kMaxColumns = 65535;
inline constexpr std::uint64_t kMaxFrames = 100'000;
inline constexpr std::uint64_t kMaxDecodedFrameBytes = std::uint64_t{2} << 30;
inline constexpr std::uint64_t kMaxNonPixelElementBytes = std::uint64_t{64} << 20;
inline constexpr int kMaxSequenceDepth = 64;
inline constexpr std::uint64_t kMaxFilesPerStudy = 200'000;
inline constexpr std::uint64_t kMaxInflateRatio = 200;  // deflated syntax: output bytes per input byte
inline constexpr std::uint64_t kMaxInflatedBytes = std::uint64_t{2} << 30;
inline constexpr std::uint64_t kMaxFragments = 1'000'000;
}  // namespace vernier::limits
