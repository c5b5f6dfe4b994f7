// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstring>

#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {

// The plane of slice k, when rows and columns stand at right angles as DICOM wants it.
std::optional<FramePlane> planeOf(const GridGeometry& g, std::int64_t k) {
  const glm::dmat3& m = g.patientFromVoxel.linear;
  if (std::abs(glm::dot(glm::normalize(m[0]), glm::normalize(m[1]))) > 1e-4) return std::nullopt;
  const glm::dvec3 at =
      g.even() ? glm::dvec3(0, 0, static_cast<double>(k)) : g.sliceOrigin_vox[static_cast<std::size_t>(k)];
  return FramePlane{g.patientFromVoxel * VoxelPoint(at), normalize(PatientVec(m[0])),
                    normalize(PatientVec(m[1]))};
}

// An image has no opacity: the colours stand as they are stored, and a finding counts what that shows more
// of.
Result<std::shared_ptr<const ImageFrame>> colourImage(const Volume& v, ImageFrameInfo info, std::size_t first,
                                                      std::size_t pixels) {
  constexpr std::size_t kColours = 3;
  info.colour = ColourSpace::Rgb;
  info.bitsStored = 8;
  auto made = Buffer::make(pixels * kColours);
  if (!made) return made.error();
  for (std::size_t c = 0; c < kColours; ++c) {
    const std::byte* const from = v.channel(static_cast<int>(c)).data() + first;
    for (std::size_t p = 0; p < pixels; ++p) made->data()[p * kColours + c] = from[p];
  }
  if (v.info().channels > static_cast<int>(kColours)) {
    const std::byte* const alpha = v.channel(3).data() + first;
    const auto opaque = std::count(alpha, alpha + pixels, std::byte{255});
    const double rest = static_cast<double>(pixels) - static_cast<double>(opaque);
    if (rest > 0)
      info.findings.push_back(
          {"alpha-not-shown",
           Severity::Notice,
           "The image is shown without the opacity that its pixels state; slices show it.",
           {{"pixels", rest}}});
  }
  return ImageFrame::make(std::move(info), std::move(*made));
}

}  // namespace

Result<std::shared_ptr<const ImageFrame>> imageOfVolume(const Volume& v, std::int64_t slice,
                                                        const VoiWindow& window) {
  const VolumeInfo& from = v.info();
  const GridGeometry& g = from.grid;
  if (slice < 0 || slice >= g.slices)
    return makeError(ErrorCode::OptionInvalid, "The volume has slices 0 to " + std::to_string(g.slices - 1) +
                                                   ", got " + std::to_string(slice) + ".");
  ImageFrameInfo info;
  info.columns = g.columns;
  info.rows = g.rows;
  info.type = from.type;
  info.rescale = v.rescaleOf(slice);
  info.noData = from.noData;
  info.windows = from.windows;
  info.voiLuts = from.voiLuts;
  info.autoWindow = window;
  info.inverted = from.inverted;
  info.unscaled = from.unscaled;
  info.modality = from.modality;
  info.unit = from.unit;
  info.plane = planeOf(g, slice);
  if (info.plane) info.pixelSpacing_mm = {g.spacing_mm().y, g.spacing_mm().x};
  info.index = slice;
  info.count = g.slices;
  info.title = from.title;
  info.findings = from.findings;
  const std::size_t pixels = static_cast<std::size_t>(g.columns * g.rows);
  const std::size_t first = pixels * static_cast<std::size_t>(slice);
  if (v.isColour()) return colourImage(v, std::move(info), first, pixels);
  const std::size_t bytes = pixels * bytesOf(from.type);
  auto made = Buffer::make(bytes);
  if (!made) return made.error();
  std::memcpy(made->data(), v.data() + first * bytesOf(from.type), bytes);
  return ImageFrame::make(std::move(info), std::move(*made));
}

}  // namespace vernier
