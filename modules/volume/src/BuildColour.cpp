// SPDX-License-Identifier: GPL-3.0-or-later
#include "BuildColour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <mutex>

#include "Keep.h"
#include "StackFacts.h"
#include "StackGrid.h"
#include "VoxelAccess.h"
#include "vernier/base/Checked.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"
#include "vernier/volume/Colour.h"

namespace vernier {
namespace {

constexpr std::size_t kChannels = 3;

const Instance* firstUsable(const StudySet& set, const Stack& stack) {
  for (const SliceRef& s : stack.slices)
    if (s.instance < set.instances.size() && !set.instances[s.instance].pixelError)
      return &set.instances[s.instance];
  return nullptr;
}

std::byte level(double v) {
  return static_cast<std::byte>(static_cast<std::uint8_t>(std::floor(255 * v + 0.5)));
}

// Stored samples of one slice into the three planes.
void spread(const Instance& i, ColourSpace space, const std::vector<std::byte>& slice, std::size_t pixels,
            const std::array<std::byte*, kChannels>& out) {
  if (space == ColourSpace::Rgb) {
    for (std::size_t p = 0; p < pixels; ++p)
      for (std::size_t c = 0; c < kChannels; ++c) out[c][p] = slice[p * kChannels + c];
    return;
  }
  const std::size_t n = space == ColourSpace::Palette ? 1 : kChannels;
  withVoxels(voxelTypeOf(i.pixels.sample), slice.data(), [&](const auto* v) {
    for (std::size_t p = 0; p < pixels; ++p) {
      std::array<double, kChannels> s{};
      for (std::size_t c = 0; c < n; ++c) s[c] = static_cast<double>(v[p * n + c]);
      const glm::dvec3 rgb = rgbOf(space, s, i.pixels.bitsStored, i.palette.get());
      for (std::size_t c = 0; c < kChannels; ++c) out[c][p] = level(rgb[static_cast<int>(c)]);
    }
  });
}

class ColourBuilder {
 public:
  ColourBuilder(const StudySet& set, const Series& series, const Stack& stack, const BuildOptions& options)
      : set_(set), series_(series), stack_(stack), options_(options) {}

  Result<std::shared_ptr<const Volume>> build(const ProgressFn& progress, std::stop_token stop) {
    const TraceSpan span("build colour volume");
    Result<void> ok = checkStack();
    if (ok) ok = reserve();
    if (ok) ok = decode(progress, stop);
    if (!ok) return ok.error();
    auto v = Volume::makeColour(describe(), std::move(planes_));
    if (!v) return v.error();
    return keepReservation(std::move(*v), std::move(reservation_));
  }

 private:
  Result<void> checkStack() {
    if (!stack_.volume3d)
      return makeError(ErrorCode::GeometryRefused,
                       stack_.why2d.empty() ? "The stack was not found fit for 3-D; open it as single images."
                                            : stack_.why2d);
    first_ = firstUsable(set_, stack_);
    const GridGeometry& g = stack_.grid;
    if (!first_ || g.slices != static_cast<std::int64_t>(stack_.slices.size()) || g.columns < 1 ||
        g.rows < 1 || static_cast<std::uint64_t>(g.columns) != first_->pixels.columns ||
        static_cast<std::uint64_t>(g.rows) != first_->pixels.rows)
      return makeError(ErrorCode::Internal, "The stack's geometry does not fit its images.");
    if (first_->pixels.samplesPerPixel > 1 && first_->pixels.bitsAllocated != 8)
      return makeError(
          ErrorCode::NotBuiltYet,
          "Colour volumes have 8 bits per channel in this version; the images can be opened one by one.");
    return {};
  }

  Result<void> reserve() {
    const GridGeometry& g = stack_.grid;
    const auto plane =
        checkedProduct({static_cast<std::uint64_t>(g.columns), static_cast<std::uint64_t>(g.rows),
                        static_cast<std::uint64_t>(g.slices)});
    const auto all = plane ? checkedProduct({*plane, kChannels}) : std::nullopt;
    if (!all) return makeError(ErrorCode::LimitExceeded, "The volume would take more than 2^64 bytes.");
    if (options_.budget) {
      auto r = options_.budget->reserve(*all, "the volume");
      if (!r) return r.error();
      reservation_ = std::move(*r);
    }
    for (std::size_t c = 0; c < kChannels; ++c) {
      auto made = Buffer::make(static_cast<std::size_t>(*plane));
      if (!made) return made.error();
      planes_.push_back(std::move(*made));
    }
    return {};
  }

  Result<void> decodeOne(FrameReader& reader, std::size_t s) {
    const Instance& i = set_.instances[stack_.slices[s].instance];
    if (i.pixelError) return *i.pixelError;
    if (i.pixels.samplesPerPixel != first_->pixels.samplesPerPixel ||
        i.pixels.sample != first_->pixels.sample || i.pixels.columns != first_->pixels.columns ||
        i.pixels.rows != first_->pixels.rows)
      return makeError(ErrorCode::CodecMismatch,
                       "The slice has other pixels than its stack; show it on its own.");
    const auto bytes = i.pixels.frameBytes();
    if (!bytes) return bytes.error();
    std::vector<std::byte> slice(static_cast<std::size_t>(*bytes));
    ColourSpace space = ColourSpace::Grey;
    if (Result<void> ok = reader.read(stack_.slices[s], slice, &space); !ok) return ok;
    const std::size_t pixels = perSlice();
    std::array<std::byte*, kChannels> out;
    for (std::size_t c = 0; c < kChannels; ++c) out[c] = planes_[c].data() + s * pixels;
    spread(i, space, slice, pixels, out);
    return {};
  }

  Result<void> decode(const ProgressFn& progress, std::stop_token stop) {
    const std::size_t n = stack_.slices.size();
    std::mutex mutex;
    std::size_t done = 0;
    parallelFor(n, std::clamp<std::size_t>(n / (static_cast<std::size_t>(threads()) * 8), 1, 32),
                [&](std::size_t begin, std::size_t end) {
                  FrameReader reader(set_);
                  for (std::size_t s = begin; s < end && !stop.stop_requested(); ++s) {
                    Result<void> ok = guarded("decode", [&] { return decodeOne(reader, s); });
                    const std::scoped_lock lock(mutex);
                    if (!ok) failed_.push_back({s, ok.error()});
                    if (progress) progress("decode", ++done, n);
                  }
                });
    if (stop.stop_requested()) return makeError(ErrorCode::Cancelled, "Loading was cancelled.");
    std::ranges::sort(failed_, {}, &SliceFailure::slice);
    for (std::size_t s = 0, f = 0; s < n; ++s) {
      if (f < failed_.size() && failed_[f].slice == s)
        ++f;
      else
        kept_.push_back(s);
    }
    if (kept_.empty()) return failed_.front().error;
    const std::size_t pixels = perSlice();
    for (Buffer& plane : planes_) {
      for (std::size_t k = 0; k < kept_.size(); ++k)
        if (k != kept_[k]) std::memmove(plane.data() + k * pixels, plane.data() + kept_[k] * pixels, pixels);
      plane.shrink(kept_.size() * pixels);
    }
    return {};
  }

  VolumeInfo describe() const {
    const Instance& m = set_.instances[stack_.slices[kept_[kept_.size() / 2]].instance];
    VolumeInfo info;
    info.grid = withoutSlices(stack_.grid, kept_);
    info.modality = series_.modality.empty() ? m.modality : series_.modality;
    info.unit = "colour";
    info.seriesUid = series_.seriesUid;
    info.studyUid = series_.studyUid;
    info.frameOfReferenceUid = m.frameOfReferenceUid;
    info.title = series_.description;
    info.patientKey = patientKey(set_, stack_);
    info.findings = stack_.findings;
    if (!failed_.empty()) info.findings.push_back(lostSlices(stack_, failed_));
    if (options_.bridgeGaps && !info.grid.gapAfter.empty()) {
      info.grid.gapAfter.clear();
      info.bridged = true;
    }
    return info;
  }

  std::size_t perSlice() const { return static_cast<std::size_t>(stack_.grid.columns * stack_.grid.rows); }

  const StudySet& set_;
  const Series& series_;
  const Stack& stack_;
  const BuildOptions& options_;
  const Instance* first_ = nullptr;
  std::vector<Buffer> planes_;
  std::vector<SliceFailure> failed_;
  std::vector<std::size_t> kept_;
  MemoryBudget::Reservation reservation_;
};

}  // namespace

bool isColourStack(const StudySet& set, const Stack& stack) {
  const Instance* const i = firstUsable(set, stack);
  return i && isColour(i->pixels.colourSpace());
}

Result<std::shared_ptr<const Volume>> buildColourVolume(const StudySet& set, const Series& series,
                                                        const Stack& stack, const BuildOptions& options,
                                                        const ProgressFn& progress, std::stop_token stop) {
  return guarded("buildColourVolume",
                 [&] { return ColourBuilder(set, series, stack, options).build(progress, stop); });
}

}  // namespace vernier
