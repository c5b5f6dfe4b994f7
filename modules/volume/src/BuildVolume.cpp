// SPDX-License-Identifier: GPL-3.0-or-later
// A stack becomes a volume: memory is reserved, slices are decoded into their place, what failed becomes a
// gap, padding is found, and only where slopes or padding differ (or a modality LUT stands) the values are
// converted once to float.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

#include "BuildColour.h"
#include "Keep.h"
#include "LossyPadding.h"
#include "StackFacts.h"
#include "StackGrid.h"
#include "VoxelAccess.h"
#include "vernier/base/Checked.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {

class Builder {
 public:
  Builder(const StudySet& set, const Series& series, const Stack& stack, const BuildOptions& options)
      : set_(set), series_(series), stack_(stack), options_(options) {}

  Result<std::shared_ptr<const Volume>> build(const ProgressFn& progress, std::stop_token stop) {
    const TraceSpan span("build volume");
    Result<void> ok = checkStack();
    if (ok) ok = reserve();
    if (ok) ok = decode(progress, stop);
    if (!ok) return ok.error();
    describe();
    markPadding();
    if (converts_)
      if (ok = convert(); !ok) return ok.error();
    Result<std::shared_ptr<const Volume>> v =
        converts_ ? Volume::make(std::move(info_), std::move(voxels_), std::move(original_))
                  : Volume::make(std::move(info_), std::move(voxels_));
    if (!v) return v.error();
    return keepReservation(std::move(v).value(), std::move(reservation_));
  }

 private:
  const Instance& instanceOf(std::size_t slice) const {
    return set_.instances[stack_.slices[slice].instance];
  }
  const SliceFacts& middle() const { return kept_[kept_.size() / 2]; }

  Result<void> checkStack() {
    if (!stack_.volume3d)
      return makeError(ErrorCode::GeometryRefused,
                       stack_.why2d.empty() ? "The stack was not found fit for 3-D; open it as single images."
                                            : stack_.why2d);
    if (stack_.slices.empty() || static_cast<std::size_t>(stack_.grid.slices) != stack_.slices.size())
      return makeError(ErrorCode::Internal,
                       "The stack's geometry does not have as many slices as the stack.");
    std::vector<const Instance*> objects;
    std::vector<SliceFacts> all;
    for (const SliceRef& s : stack_.slices) {
      if (s.instance >= set_.instances.size())
        return makeError(ErrorCode::Internal, "The stack names an object that is not in the study.");
      all.push_back(factsOf(set_, s));
      const Instance* const object = all.back().object;
      if (!objects.empty() && objects.back() == object) continue;
      objects.push_back(object);
      if (!object->pixelError)
        if (Result<void> single = checkSingleSample(*object); !single) return single;
    }
    sample_ = commonSample(objects);
    info_.type = voxelTypeOf(sample_);
    converts_ = needsConversion(all);
    return {};
  }

  // Different slopes or padding, or a modality LUT. Where a rescale is refused all slices are shown unscaled,
  // alike.
  bool needsConversion(const std::vector<SliceFacts>& all) {
    const SliceFacts* first = nullptr;
    bool differ = false;
    for (const SliceFacts& s : all) {
      if (s.object->pixelError) continue;
      if (!first) first = &s;
      info_.unscaled |= s.frame->rescaleInvalid;
      lut_ |= s.object->modalityLut && !s.object->modalityLut->data.empty();
      differ |= s.frame->rescale != first->frame->rescale;
      paddingDiffers_ |= s.frame->paddingFirst != first->frame->paddingFirst ||
                         s.frame->paddingLast != first->frame->paddingLast;
    }
    return paddingDiffers_ || (!info_.unscaled && (lut_ || differ));
  }

  Result<std::uint64_t> bytesFor(std::uint64_t perVoxel) const {
    const GridGeometry& g = stack_.grid;
    if (g.columns < 1 || g.rows < 1 || g.slices < 1)
      return makeError(ErrorCode::GeometryRefused, "The stack has no rows, columns or slices.");
    const auto n = checkedProduct({static_cast<std::uint64_t>(g.columns), static_cast<std::uint64_t>(g.rows),
                                   static_cast<std::uint64_t>(g.slices), perVoxel});
    if (!n) return makeError(ErrorCode::LimitExceeded, "The volume would take more than 2^64 bytes.");
    return *n;
  }

  Result<void> reserve() {
    const auto stored = bytesFor(bytesOf(info_.type));
    if (!stored) return stored.error();
    const auto both = bytesFor(bytesOf(info_.type) + (converts_ ? sizeof(float) : 0));
    if (!both) return both.error();
    if (options_.budget) {
      auto r = options_.budget->reserve(*both, "the volume");
      if (!r) return r.error();
      reservation_ = std::move(r).value();
    }
    auto made = Buffer::make(static_cast<std::size_t>(*stored));
    if (!made) return made.error();
    voxels_ = std::move(made).value();
    return {};
  }

  Result<void> decode(const ProgressFn& progress, std::stop_token stop) {
    std::vector<SliceFailure> failed;
    Result<void> ok = sample_ == SampleType::F64
                          ? decodeDoubles(failed, progress, stop)
                          : decodeStack(set_, stack_, sample_, voxels_.bytes(), failed, progress, stop);
    if (!ok) return ok;
    std::vector<bool> lost(stack_.slices.size(), false);
    for (const SliceFailure& f : failed) lost[f.slice] = true;
    std::vector<std::size_t> kept;
    for (std::size_t s = 0; s < lost.size(); ++s)
      if (!lost[s]) kept.push_back(s);
    if (kept.empty()) return failed.front().error;
    const std::size_t sliceBytes = voxels_.size() / stack_.slices.size();
    for (std::size_t n = 0; n < kept.size(); ++n) {
      if (n != kept[n])
        std::memmove(voxels_.data() + n * sliceBytes, voxels_.data() + kept[n] * sliceBytes, sliceBytes);
      kept_.push_back(factsOf(set_, stack_.slices[kept[n]]));
    }
    voxels_.shrink(kept.size() * sliceBytes);
    info_.grid = withoutSlices(stack_.grid, kept);
    if (!failed.empty()) info_.findings.push_back(lostSlices(stack_, failed));
    return {};
  }

  // Double pixels are shown as float: slice by slice, so that they never stand in memory twice.
  Result<void> decodeDoubles(std::vector<SliceFailure>& failed, const ProgressFn& progress,
                             std::stop_token stop) {
    const std::size_t perSlice = voxels_.size() / sizeof(float) / stack_.slices.size();
    std::vector<double> slice(perSlice);
    float* out = reinterpret_cast<float*>(voxels_.data());
    for (std::size_t s = 0; s < stack_.slices.size(); ++s, out += perSlice) {
      if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "Loading was cancelled.");
      Result<void> ok =
          instanceOf(s).pixels.sample == SampleType::F64
              ? decodeSlice(set_, stack_.slices[s], std::as_writable_bytes(std::span(slice)))
              : makeError(ErrorCode::CodecMismatch, "The slice has another pixel type than its stack.");
      if (!ok)
        failed.push_back({s, ok.error()});
      else
        std::transform(slice.begin(), slice.end(), out, [](double x) { return static_cast<float>(x); });
      if (progress) progress("decode", s + 1, stack_.slices.size());
    }
    Finding f;
    f.code = "double-pixels-rounded";
    f.severity = Severity::Notice;
    f.sentence = "The pixels are 64-bit floats; they are shown and measured as 32-bit floats.";
    info_.findings.push_back(std::move(f));
    return {};
  }

  void describe() {
    const Instance& m = *middle().object;
    const FrameAttributes& f = *middle().frame;
    info_.modality = series_.modality.empty() ? m.modality : series_.modality;
    if (!info_.unscaled) {
      info_.rescale = {kept_.front().frame->rescale};
      info_.unit = f.unit.empty() ? "stored value" : f.unit;
      info_.windows = windowsOf(f, info_.findings);  // one window for the stack: the middle slice's
      info_.voiLuts = m.voiLuts;
    }
    info_.inverted = isInverted(m);
    info_.seriesUid = series_.seriesUid;
    info_.studyUid = series_.studyUid;
    info_.frameOfReferenceUid = m.frameOfReferenceUid;
    info_.title = series_.description;
    info_.patientKey = patientKey(set_, stack_);
    info_.findings.insert(info_.findings.begin(), stack_.findings.begin(), stack_.findings.end());
    if (options_.bridgeGaps && !info_.grid.gapAfter.empty()) {
      info_.grid.gapAfter.clear();
      info_.bridged = true;
    }
  }

  std::size_t perSlice() const { return static_cast<std::size_t>(info_.grid.columns * info_.grid.rows); }
  std::byte* sliceAt(std::size_t s) { return voxels_.data() + s * perSlice() * bytesOf(info_.type); }

  void markPadding() {
    const auto padding = paddingOf(middle());
    if (paddingDiffers_) {
      // Each slice has its own, taken out when the values are converted.
    } else if (padding && liesInTissueRange(*middle().object, *padding)) {
      info_.paddingInTissueRange = true;
      info_.windowNoData = padding;
    } else {
      info_.noData = padding;
    }
    if (std::any_of(kept_.begin(), kept_.end(), mayBlur)) markBlurred();
  }

  static bool mayBlur(const SliceFacts& s) { return mayBlurPadding(*s.object, *s.frame); }

  void markBlurred() {
    const NoDataRange padding = info_.noData.value_or(blurredPaddingOf(info_.type));
    std::atomic<std::uint64_t> changed{0};
    parallelFor(kept_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        if (!mayBlur(kept_[s])) continue;
        changed += markBlurredPadding(info_.type, sliceAt(s), info_.grid.columns, info_.grid.rows, padding,
                                      leastTissue_stored(kept_[s].frame->rescale), padding.first);
      }
    });
    if (changed == 0) return;
    info_.noData = padding;
    Finding f;
    f.code = "padding-blurred";
    f.severity = Severity::Notice;
    f.sentence = "Padding was blurred by lossy compression: " + std::to_string(changed.load()) +
                 " voxels below -1024 HU that hang together with the border are taken as padding.";
    f.numbers = {{"voxels", static_cast<double>(changed.load())}, {"below_hu", kLeastTissue_hu}};
    info_.findings.push_back(std::move(f));
  }

  // The stored values stay beside the converted ones, for probes.
  Result<void> convert() {
    const std::size_t n = perSlice();
    auto made = Buffer::make(n * kept_.size() * sizeof(float));
    if (!made) return made.error();
    Buffer floats = std::move(made).value();
    parallelFor(kept_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s)
        withVoxels(info_.type, sliceAt(s), [&](const auto* v) {
          convertSlice(v, reinterpret_cast<float*>(floats.data()) + s * n, n, kept_[s]);
        });
    });
    original_.type = info_.type;
    for (const SliceFacts& s : kept_)
      original_.rescale.push_back(info_.unscaled ? ModalityRescale{} : s.frame->rescale);
    original_.noData = info_.noData;
    original_.throughLut = lut_;
    original_.voxels = std::exchange(voxels_, std::move(floats));
    info_.type = VoxelType::F32;
    info_.rescale = {ModalityRescale{}};
    info_.noData.reset();
    moveWindowPadding();
    return {};
  }

  template <class T>
  void convertSlice(const T* v, float* out, std::size_t n, const SliceFacts& s) const {
    const auto& table = s.object->modalityLut;
    const LutTable* const lut = !info_.unscaled && table && !table->data.empty() ? &*table : nullptr;
    const ModalityRescale rescale = info_.unscaled ? ModalityRescale{} : s.frame->rescale;
    const std::optional<NoDataRange> noData = paddingDiffers_ ? ownPadding(s) : info_.noData;
    for (std::size_t p = 0; p < n; ++p) {
      const double x = static_cast<double>(v[p]);
      const double y = lut ? lookUp(*lut, x) : rescale.slope * x + rescale.intercept;
      out[p] = inRange(noData, x) ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(y);
    }
  }

  static std::optional<NoDataRange> ownPadding(const SliceFacts& s) {
    const auto padding = paddingOf(s);
    return padding && liesInTissueRange(*s.object, *padding) ? std::nullopt : padding;
  }

  // Tissue-range padding is 0 stored, which is each slice's intercept. Where intercepts differ it cannot be
  // told from tissue any more and the automatic window does without the rule.
  void moveWindowPadding() {
    if (!info_.windowNoData) return;
    const double y = original_.rescale.front().intercept;
    const bool alike = std::all_of(original_.rescale.begin(), original_.rescale.end(),
                                   [y](const ModalityRescale& r) { return r.intercept == y; });
    if (alike && !lut_)
      info_.windowNoData = NoDataRange{y, y};
    else
      info_.windowNoData.reset();
  }

  const StudySet& set_;
  const Series& series_;
  const Stack& stack_;
  const BuildOptions& options_;
  SampleType sample_ = SampleType::U16;
  bool converts_ = false, lut_ = false, paddingDiffers_ = false;
  std::vector<SliceFacts> kept_;  // of each slice that was decoded
  VolumeInfo info_;
  Buffer voxels_;
  OriginalVoxels original_;
  MemoryBudget::Reservation reservation_;
};

}  // namespace

Result<std::shared_ptr<const Volume>> buildVolume(const StudySet& set, const Series& series,
                                                  const Stack& stack, const BuildOptions& options,
                                                  const ProgressFn& progress, std::stop_token stop) {
  if (isColourStack(set, stack)) return buildColourVolume(set, series, stack, options, progress, stop);
  return guarded("buildVolume", [&] { return Builder(set, series, stack, options).build(progress, stop); });
}

}  // namespace vernier
