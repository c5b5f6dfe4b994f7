// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/Channels.h"

#include <atomic>

#include "vernier/base/Threads.h"

namespace vernier {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 16;

struct Opacity {
  std::uint64_t transparent = 0, translucent = 0, opaque = 0;  // alpha 0, 1..254, 255
};

Opacity opacityOf(const Buffer& alpha) {
  std::atomic<std::uint64_t> transparent{0}, opaque{0};
  parallelFor(alpha.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint64_t none = 0, full = 0;
    for (std::size_t v = begin; v < end; ++v) {
      none += alpha.data()[v] == std::byte{0};
      full += alpha.data()[v] == std::byte{255};
    }
    transparent += none;
    opaque += full;
  });
  return {transparent, alpha.size() - transparent - opaque, opaque};
}

}  // namespace

Result<void> setChannels(ParsedVolume& p, std::int64_t channels) {
  if (channels == 1) return {};
  const std::string values =
      "The file has " + std::to_string(channels) + " values of type " + nameOf(p.place.type) + " per voxel; ";
  if (channels != 3 && channels != 4)
    return makeError(ErrorCode::NotBuiltYet,
                     values +
                         "1 (grey), 3 (red, green, blue) or 4 (and alpha) are read. Save one component as a "
                         "file of its own.");
  if (p.place.type != FileType::U8)
    return makeError(ErrorCode::NotBuiltYet,
                     values +
                         "colours are read where each value is uint8. Convert the colours to 8 bits, or save "
                         "one component as a file of its own.");
  p.place.channels = static_cast<int>(channels);
  p.facts.info.channels = p.place.channels;
  p.facts.info.unit = "colour";
  return {};
}

void spreadChannels(std::span<const std::byte> interleaved, std::vector<Buffer>& planes, std::uint64_t at) {
  const std::size_t n = planes.size();
  parallelFor(interleaved.size() / n, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = 0; c < n; ++c) {
      std::byte* const out = planes[c].data() + at;
      const std::byte* in = interleaved.data() + begin * n + c;
      for (std::size_t v = begin; v < end; ++v, in += n) out[v] = *in;
    }
  });
}

void judgeAlpha(std::vector<Buffer>& planes, std::vector<Finding>& findings) {
  if (planes.size() != 4) return;
  const Opacity o = opacityOf(planes[3]);
  Finding f{"alpha-channel", Severity::Info, "", {}};
  f.numbers = {{"transparent_voxels", static_cast<double>(o.transparent)},
               {"translucent_voxels", static_cast<double>(o.translucent)},
               {"opaque_voxels", static_cast<double>(o.opaque)}};
  if (o.translucent == 0 && o.opaque == 0) {
    planes.pop_back();
    f = {
        "alpha-empty", Severity::Warning,
        "The opacity of every voxel is 0, so that nothing would be seen; it is left out, and the colours are "
        "shown opaque.",
        std::move(f.numbers)};
  } else if (o.transparent == 0 && o.translucent == 0) {
    f.sentence = "The file states an opacity for each voxel; all are opaque.";
  } else {
    f.severity = Severity::Notice;
    f.sentence = "The file states an opacity for each voxel, and slices show colours with it: " +
                 std::to_string(o.transparent) + " voxels are not seen, " + std::to_string(o.translucent) +
                 " in part.";
  }
  findings.push_back(std::move(f));
}

}  // namespace vernier
