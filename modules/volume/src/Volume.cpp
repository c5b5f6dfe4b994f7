// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/volume/Volume.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "GridCheck.h"
#include "Range.h"
#include "VoxelAccess.h"
#include "vernier/base/Checked.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"

namespace vernier {
namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Error refuse(std::string sentence) { return makeError(ErrorCode::GeometryRefused, std::move(sentence)); }

Result<void> checkSlices(const GridGeometry& g) {
  const std::size_t n = static_cast<std::size_t>(g.slices);
  if (g.even()) {
    if (!g.gapAfter.empty()) return refuse("Gaps are stated for a volume without slice positions.");
    return {};
  }
  if (g.sliceOrigin_vox.size() != n)
    return refuse("The volume has " + std::to_string(n) + " slices but " +
                  std::to_string(g.sliceOrigin_vox.size()) + " slice positions.");
  for (std::size_t s = 0; s < n; ++s) {
    if (!finite(g.sliceOrigin_vox[s]) || (s > 0 && !(g.sliceOrigin_vox[s].z > g.sliceOrigin_vox[s - 1].z)))
      return refuse("Slice positions do not ascend at slice " + std::to_string(s) +
                    "; two slices may lie at one place.");
  }
  for (std::size_t i = 0; i < g.gapAfter.size(); ++i) {
    const std::int64_t s = g.gapAfter[i];
    if (s < 0 || s + 1 >= g.slices || (i > 0 && s <= g.gapAfter[i - 1]))
      return refuse("A gap is stated after slice " + std::to_string(s) +
                    ", which is out of order or range (" + std::to_string(n) + " slices).");
  }
  return {};
}

Result<void> checkRescale(const std::vector<ModalityRescale>& rescale, std::int64_t slices) {
  if (rescale.size() != 1 && rescale.size() != static_cast<std::size_t>(slices))
    return makeError(ErrorCode::RescaleInvalid, "The volume has " + std::to_string(slices) + " slices but " +
                                                    std::to_string(rescale.size()) + " rescale entries.");
  for (const ModalityRescale& r : rescale)
    if (!std::isfinite(r.slope) || r.slope == 0 || !std::isfinite(r.intercept))
      return makeError(ErrorCode::RescaleInvalid,
                       "A rescale slope is 0 or not finite; stored values can be shown unscaled instead.");
  return {};
}

Result<void> checkNoData(const std::optional<NoDataRange>& range) {
  if (range && !(range->first <= range->last))
    return makeError(ErrorCode::PixelDescriptionInvalid, "The padding range is empty or not a number.");
  return {};
}

Result<void> checkSize(const GridGeometry& g, VoxelType type, std::size_t bytes) {
  if (g.columns < 1 || g.rows < 1 || g.slices < 1)
    return refuse("A volume needs at least one column, row and slice.");
  const auto need = checkedProduct({static_cast<std::uint64_t>(g.columns), static_cast<std::uint64_t>(g.rows),
                                    static_cast<std::uint64_t>(g.slices), bytesOf(type)});
  if (!need || *need != bytes)
    return makeError(ErrorCode::PixelDataShort,
                     "The volume needs " + (need ? std::to_string(*need) : std::string("more than 2^64")) +
                         " bytes of voxels and got " + std::to_string(bytes) + ".");
  return {};
}

std::optional<Finding> nonFiniteFinding(const NonFinite& n) {
  if (n.all() == 0) return std::nullopt;
  Finding f;
  f.code = "non-finite-voxels";
  f.severity = Severity::Warning;
  f.sentence =
      std::to_string(n.all()) + " voxels are not finite numbers (NaN or infinite) and are shown as no data.";
  f.numbers = {{"nan", static_cast<double>(n.nan)},
               {"plus_infinite", static_cast<double>(n.plusInf)},
               {"minus_infinite", static_cast<double>(n.minusInf)}};
  return f;
}

Finding nothingToShow() {
  Finding f;
  f.code = "all-padding";
  f.severity = Severity::Warning;
  f.sentence = "Every voxel is padding or not a number: there is no data to show.";
  return f;
}

}  // namespace

Result<void> checkMap(const PatientFromVoxel& map) {
  // The box that the three edge vectors span, relative to a right-angled one: 1 at right angles, 0 when flat.
  // Below this two directions are parallel for every practical purpose and the inverse would be noise.
  constexpr double kLeastRelativeDeterminant = 1e-6;
  const glm::dmat3& m = map.linear;
  if (!finite(m[0]) || !finite(m[1]) || !finite(m[2]) || !finite(map.translation))
    return refuse("The volume's position or spacing is not a finite number; check the file's geometry.");
  const double box = glm::length(m[0]) * glm::length(m[1]) * glm::length(m[2]);
  if (!(box > 0) || !std::isfinite(box) || std::abs(glm::determinant(m)) < kLeastRelativeDeterminant * box)
    return refuse(
        "The volume's axes have no length or lie in one plane; check spacing and orientation of the file.");
  return {};
}

std::size_t bytesOf(VoxelType t) {
  switch (t) {
    case VoxelType::U8:
    case VoxelType::I8:
      return 1;
    case VoxelType::U16:
    case VoxelType::I16:
      return 2;
    default:
      return 4;
  }
}

const char* nameOf(VoxelType t) {
  switch (t) {
    case VoxelType::U8:
      return "u8";
    case VoxelType::I8:
      return "i8";
    case VoxelType::U16:
      return "u16";
    case VoxelType::I16:
      return "i16";
    case VoxelType::U32:
      return "u32";
    case VoxelType::I32:
      return "i32";
    case VoxelType::F32:
      break;
  }
  return "f32";
}

Result<std::shared_ptr<const Volume>> Volume::make(VolumeInfo info, Buffer voxels) {
  return makeAny(std::move(info), std::move(voxels), std::nullopt);
}

Result<std::shared_ptr<const Volume>> Volume::make(VolumeInfo info, Buffer voxels, OriginalVoxels original) {
  return makeAny(std::move(info), std::move(voxels), std::move(original));
}

Result<std::shared_ptr<const Volume>> Volume::makeAny(VolumeInfo&& info, Buffer&& voxels,
                                                      std::optional<OriginalVoxels>&& original) {
  const GridGeometry& g = info.grid;
  Result<void> ok = checkSize(g, info.type, voxels.size());
  if (ok) ok = checkMap(g.patientFromVoxel);
  if (ok) ok = checkSlices(g);
  if (ok) ok = checkRescale(info.rescale, g.slices);
  if (ok) ok = checkNoData(info.noData);
  if (ok && original) {
    ok = checkSize(g, original->type, original->voxels.size());
    if (ok) ok = checkRescale(original->rescale, g.slices);
    if (ok) ok = checkNoData(original->noData);
  }
  if (!ok) return ok.error();

  return guarded("Volume::make", [&]() -> Result<std::shared_ptr<const Volume>> {
    const std::size_t perSlice = static_cast<std::size_t>(g.columns * g.rows);
    const std::size_t slices = static_cast<std::size_t>(g.slices);
    // In a converted volume NaN is padding, made by the conversion itself.
    const NonFinite odd = cleanFloats(info.type, voxels.data(), perSlice * slices);
    if (!original)
      if (auto finding = nonFiniteFinding(odd)) info.findings.push_back(std::move(*finding));

    std::shared_ptr<Volume> v(new Volume);
    v->range_ = modalityExtrema(info.type, voxels.data(), perSlice, slices, info.rescale, info.noData);
    if (!v->range_) info.findings.push_back(nothingToShow());
    v->voxelFromPatient_ = g.patientFromVoxel.inverse();
    v->info_ = std::move(info);
    v->voxels_ = std::move(voxels);
    v->original_ = std::move(original);
    v->revision_ = nextRevision();
    return std::shared_ptr<const Volume>(std::move(v));
  });
}

Result<std::shared_ptr<const Volume>> Volume::makeColour(VolumeInfo info, int samples,
                                                         std::span<const std::byte> interleaved) {
  const GridGeometry& g = info.grid;
  if (samples != 3 && samples != 4)
    return makeError(ErrorCode::PixelDescriptionInvalid,
                     "A colour volume has 3 or 4 samples per voxel, not " + std::to_string(samples) + ".");
  const std::size_t n = interleaved.size() / static_cast<std::size_t>(samples);
  Result<void> ok = checkSize(g, VoxelType::U8, n);
  if (ok && n * static_cast<std::size_t>(samples) != interleaved.size())
    ok = makeError(ErrorCode::PixelDataShort, "The colour volume's last voxel is not whole.");
  if (!ok) return ok.error();
  std::vector<Buffer> planes;
  for (int c = 0; c < samples; ++c) {
    auto plane = Buffer::make(n);
    if (!plane) return plane.error();
    planes.push_back(std::move(*plane));
  }
  parallelFor(n, std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
    for (int c = 0; c < samples; ++c) {
      std::byte* const out = planes[static_cast<std::size_t>(c)].data();
      const std::byte* in = interleaved.data() + begin * static_cast<std::size_t>(samples) + c;
      for (std::size_t v = begin; v < end; ++v, in += samples) out[v] = *in;
    }
  });
  return makeColour(std::move(info), std::move(planes));
}

Result<std::shared_ptr<const Volume>> Volume::makeColour(VolumeInfo info, std::vector<Buffer> planes) {
  if (planes.size() != 3 && planes.size() != 4)
    return makeError(ErrorCode::PixelDescriptionInvalid,
                     "A colour volume has 3 or 4 channels, not " + std::to_string(planes.size()) + ".");
  return guarded("Volume::makeColour", [&]() -> Result<std::shared_ptr<const Volume>> {
    std::shared_ptr<Volume> v(new Volume);
    info.type = VoxelType::U8;
    info.channels = static_cast<int>(planes.size());
    info.rescale = {ModalityRescale{}};
    info.noData.reset();
    info.windows.clear();
    info.voiLuts.clear();
    info.inverted = info.unscaled = false;
    for (Buffer& plane : planes) {
      VolumeInfo one;
      one.grid = info.grid;
      one.type = VoxelType::U8;
      auto channel = make(std::move(one), std::move(plane));
      if (!channel) return channel.error();
      v->channels_.push_back(std::move(*channel));
    }
    v->range_ = Range{0, 255};
    v->voxelFromPatient_ = info.grid.patientFromVoxel.inverse();
    v->info_ = std::move(info);
    v->revision_ = nextRevision();
    return std::shared_ptr<const Volume>(std::move(v));
  });
}

std::array<std::uint8_t, 4> Volume::rgba(std::int64_t i, std::int64_t j, std::int64_t k) const {
  std::array<std::uint8_t, 4> out{0, 0, 0, 255};
  for (std::size_t c = 0; c < channels_.size(); ++c)
    out[c] = std::to_integer<std::uint8_t>(channels_[c]->data()[index(i, j, k)]);
  return out;
}

std::size_t Volume::bytes() const {
  std::size_t all = voxels_.size();
  for (const auto& channel : channels_) all += channel->bytes();
  return all;
}

double Volume::stored(std::int64_t i, std::int64_t j, std::int64_t k) const {
  VERNIER_ASSERT(!isColour());
  return storedAt(info_.type, voxels_.data(), index(i, j, k));
}

VoxelValue Volume::probe(std::int64_t i, std::int64_t j, std::int64_t k) const {
  VoxelValue v;
  const ModalityRescale* r = &rescaleOf(k);
  if (original_) {
    v.stored = storedAt(original_->type, original_->voxels.data(), index(i, j, k));
    v.noData = inRange(original_->noData, v.stored) || isNoData(stored(i, j, k));
    if (original_->throughLut) {
      v.modality = modality(i, j, k);
      return v;
    }
    r = &original_->rescale[original_->rescale.size() == 1 ? 0 : static_cast<std::size_t>(k)];
  } else {
    v.stored = stored(i, j, k);
    v.noData = isNoData(v.stored);
  }
  v.modality = r->slope * v.stored + r->intercept;
  return v;
}

}  // namespace vernier
