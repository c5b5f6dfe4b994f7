// SPDX-License-Identifier: GPL-3.0-or-later
// Volume: immutable voxels with their place in the patient and their meaning. Stored values in a Buffer;
// modality value = slope * stored + intercept (per slice when slices differ). Thread-safe: nothing changes
// after make().
//
// A colour volume has 3 (red, green, blue) or 4 (and alpha, not premultiplied) samples of 8 bits for each
// voxel. It holds one grey volume per channel on the same grid, so that whatever samples grey volumes samples
// colours, channel by channel; it has no voxels, windows, padding or modality values of its own.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vernier/base/Api.h"
#include "vernier/base/GridGeometry.h"
#include "vernier/base/Result.h"
#include "vernier/base/Revision.h"
#include "vernier/study/Model.h"

namespace vernier {

enum class VoxelType { U8, I8, U16, I16, U32, I32, F32 };
VERNIER_API std::size_t bytesOf(VoxelType);
VERNIER_API const char* nameOf(VoxelType);

// Page-aligned memory, huge pages where the system gives them, zeroed; kSlack bytes beyond size() may be
// read.
class VERNIER_API Buffer {
 public:
  static constexpr std::size_t kSlack = 64;
  Buffer() = default;
  static Result<Buffer> make(std::size_t bytes);
  void shrink(std::size_t bytes);  // bytes <= size(); gives whole pages back, keeps the slack
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;
  ~Buffer();
  std::byte* data() { return data_; }
  const std::byte* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::span<std::byte> bytes() { return {data_, size_}; }

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0, mapped_ = 0;
};

// Stored values in [first, last] (and NaN in float volumes) are no-data: excluded from statistics, extrema
// and interpolation, where the weights of the valid corners are renormalised. Infinite voxels of a float
// volume become NaN in make() (counted in the finding "non-finite-voxels"), so that NaN is the only test that
// anybody needs.
struct NoDataRange {
  double first = 0, last = 0;
};

struct VolumeInfo {
  GridGeometry grid;
  VoxelType type = VoxelType::I16;
  int channels = 1;  // 3 or 4 in colour volumes; set by makeColour()
  // One entry when equal for all slices, else one per slice.
  std::vector<ModalityRescale> rescale{ModalityRescale{}};
  std::optional<NoDataRange> noData;  // in stored values
  // MR padding that lies among tissue values (0): noData is empty then, the voxels are data like any other,
  // and only the automatic window leaves windowNoData out.
  bool paddingInTissueRange = false;
  std::optional<NoDataRange> windowNoData;
  std::string modality, unit = "stored value";
  std::vector<VoiWindow> windows;  // the file's own, first is the default; may be empty
  std::vector<LutTable> voiLuts;
  bool inverted = false;  // MONOCHROME1 or INVERSE, one inversion in all
  bool unscaled = false;  // rescale was refused, stored values are shown
  bool bridged = false;   // the user asked to bridge gaps
  std::string seriesUid, studyUid, frameOfReferenceUid,
      patientKey;     // patientKey: id + issuer, for equality only
  std::string title;  // series description, for the screen
  std::vector<Finding> findings;
};

// What the files held, when slopes differ from slice to slice: the voxels of such a volume are modality
// values (F32, rescale {1, 0}, no-data = NaN, made once at load time), and probes and statistics go back to
// these.
struct OriginalVoxels {
  VoxelType type = VoxelType::I16;
  std::vector<ModalityRescale> rescale;  // one per slice
  std::optional<NoDataRange> noData;     // in stored values
  Buffer voxels;                         // same layout as the volume's
  bool throughLut = false;               // rescale says nothing: modality values are the volume's own voxels
};

// What a statistics or probe needs of one voxel, from the original stored values.
struct VoxelValue {
  double stored = 0, modality = 0;
  bool noData = false;
};

class VERNIER_API Volume {
 public:
  // Checks sizes in 64 bits, that the grid is invertible and its slice positions ascend, and that the rescale
  // is usable; finds the range. GeometryRefused, PixelDataShort, PixelDescriptionInvalid or RescaleInvalid
  // otherwise.
  static Result<std::shared_ptr<const Volume>> make(VolumeInfo info, Buffer voxels);
  static Result<std::shared_ptr<const Volume>> make(VolumeInfo info, Buffer voxels, OriginalVoxels original);

  // Colour: `interleaved` holds `samples` (3 or 4) bytes for each voxel, in the order of a grey volume's
  // voxels.
  static Result<std::shared_ptr<const Volume>> makeColour(VolumeInfo info, int samples,
                                                          std::span<const std::byte> interleaved);
  // The same from 3 or 4 planes of bytes, which are taken over without a copy.
  static Result<std::shared_ptr<const Volume>> makeColour(VolumeInfo info, std::vector<Buffer> planes);

  bool isColour() const { return !channels_.empty(); }
  // Red, green, blue and, where there is one, alpha: a grey volume of stored values 0..255.
  const Volume& channel(int c) const { return *channels_[static_cast<std::size_t>(c)]; }
  // Stored values of a colour volume; alpha 255 where it has none.
  std::array<std::uint8_t, 4> rgba(std::int64_t i, std::int64_t j, std::int64_t k) const;

  const VolumeInfo& info() const { return info_; }
  const GridGeometry& grid() const { return info_.grid; }
  Revision revision() const { return revision_; }
  VoxelType type() const { return info_.type; }
  // Voxel (i, j, k) at index i + columns * (j + rows * k). Of grey volumes only, as all that speaks of one
  // value.
  const std::byte* data() const {
    VERNIER_ASSERT(!isColour());
    return voxels_.data();
  }
  std::size_t bytes() const;  // of all channels
  // stored(), modality() and isNoData() speak of data(), which the engines draw; probe() of the original
  // stored values, exact in double. They differ only in volumes with hasOriginal(), by the rounding to float.
  bool hasOriginal() const { return original_.has_value(); }
  const OriginalVoxels* original() const { return original_ ? &*original_ : nullptr; }
  VoxelValue probe(std::int64_t i, std::int64_t j, std::int64_t k) const;  // indices in range
  double stored(std::int64_t i, std::int64_t j, std::int64_t k) const;     // indices in range
  const ModalityRescale& rescaleOf(std::int64_t slice) const {
    return info_.rescale.size() == 1 ? info_.rescale[0] : info_.rescale[static_cast<std::size_t>(slice)];
  }
  double modality(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const ModalityRescale& r = rescaleOf(k);
    return r.slope * stored(i, j, k) + r.intercept;
  }
  bool isNoData(double storedValue) const {
    return storedValue != storedValue ||
           (info_.noData && storedValue >= info_.noData->first && storedValue <= info_.noData->last);
  }
  const VoxelFromPatient& voxelFromPatient() const { return voxelFromPatient_; }
  // Least and greatest modality value of data() without no-data; nullopt when all is no-data. Computed at
  // make().
  struct Range {
    double min = 0, max = 0;
  };
  std::optional<Range> modalityRange() const { return range_; }

 private:
  Volume() = default;
  static Result<std::shared_ptr<const Volume>> makeAny(VolumeInfo&&, Buffer&&,
                                                       std::optional<OriginalVoxels>&&);
  std::size_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(i + info_.grid.columns * (j + info_.grid.rows * k));
  }
  VolumeInfo info_;
  Buffer voxels_;
  std::optional<OriginalVoxels> original_;
  std::vector<std::shared_ptr<const Volume>> channels_;
  VoxelFromPatient voxelFromPatient_;
  Revision revision_ = 0;
  std::optional<Range> range_;
};

}  // namespace vernier
