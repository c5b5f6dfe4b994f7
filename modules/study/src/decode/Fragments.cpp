// SPDX-License-Identifier: GPL-3.0-or-later
#include "decode/Fragments.h"

#include <algorithm>
#include <array>

namespace vernier::study {
namespace {

// Entries are counted from the item header of the first fragment, which stands 8 bytes before its value.
bool byOffsetTable(Source& s, Extent table, std::uint64_t frames, PixelIndex& index) {
  if (table.length != frames * 4) return false;
  const std::uint64_t base = index.fragments.front().offset - 8;
  std::vector<std::uint32_t> first;
  std::size_t fragment = 0;
  for (std::uint64_t f = 0; f < frames; ++f) {
    std::array<std::byte, 4> b{};
    if (!s.read(table.offset + f * 4, b)) return false;
    std::uint64_t at = 0;
    for (int i = 3; i >= 0; --i)
      at = at << 8 | std::to_integer<std::uint64_t>(b[static_cast<std::size_t>(i)]);
    while (fragment < index.fragments.size() && index.fragments[fragment].offset - 8 - base < at) ++fragment;
    if (fragment == index.fragments.size() || index.fragments[fragment].offset - 8 - base != at) return false;
    if (f == 0 ? fragment != 0 : fragment <= first.back()) return false;
    first.push_back(static_cast<std::uint32_t>(fragment));
  }
  first.push_back(static_cast<std::uint32_t>(index.fragments.size()));
  index.firstFragment = std::move(first);
  return true;
}

// JPEG and JPEG-LS images begin with FFD8, JPEG 2000 codestreams with FF4F.
bool byMarkers(Source& s, std::uint64_t frames, PixelIndex& index) {
  std::vector<std::uint32_t> first;
  for (std::size_t i = 0; i < index.fragments.size(); ++i) {
    std::array<std::byte, 2> b{};
    if (index.fragments[i].length < 2 || !s.read(index.fragments[i].offset, b)) continue;
    if (b[0] == std::byte{0xFF} && (b[1] == std::byte{0xD8} || b[1] == std::byte{0x4F}))
      first.push_back(static_cast<std::uint32_t>(i));
  }
  if (first.size() != frames || first.front() != 0) return false;
  first.push_back(static_cast<std::uint32_t>(index.fragments.size()));
  index.firstFragment = std::move(first);
  return true;
}

}  // namespace

Result<void> assignFragments(Source& source, Extent offsetTable, const FrameSpec& spec, PixelIndex& index) {
  const std::uint64_t frames = spec.framesDeclared;
  auto n = index.fragments.size();
  if (n != frames) {
    std::erase_if(index.fragments, [](const Extent& e) { return e.length == 0; });
    n = index.fragments.size();
  }
  if (n == frames) {
    for (std::size_t f = 0; f <= n; ++f) index.firstFragment.push_back(static_cast<std::uint32_t>(f));
    return {};
  }
  if (n > 0 && frames == 1) {
    index.firstFragment = {0, static_cast<std::uint32_t>(n)};
    return {};
  }
  if (n > frames && (byOffsetTable(source, offsetTable, frames, index) || byMarkers(source, frames, index)))
    return {};
  return makeError(ErrorCode::CodecFailed, "The compressed pixel data has " + std::to_string(n) +
                                               " fragment(s), which do not make up the " +
                                               std::to_string(frames) +
                                               " frame(s) declared; fetch the file again from its source.");
}

}  // namespace vernier::study
