// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels of slices and stacks: open, walk to the pixel data, read it into its place. One reader per thread
// keeps its buffers and the index of the object that it read last, so that a stack of n files costs n opens
// and no allocation. Readers of one multi-frame object share its index; a deflated one is inflated once, in
// order, as a stream.
#include <algorithm>
#include <map>
#include <mutex>
#include <optional>

#include "decode/FrameDecode.h"
#include "decode/InflatingSource.h"
#include "decode/Samples.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/study/Load.h"

namespace vernier {
namespace {

// Indices of multi-frame objects, made by the first reader that needs one while the others wait.
class IndexCache {
 public:
  using Made = Result<std::shared_ptr<const study::PixelIndex>>;
  template <class Make>
  Made get(std::size_t instance, const Make& make) {
    const std::scoped_lock lock(mutex_);
    const auto at = made_.find(instance);
    if (at != made_.end()) return at->second;
    return made_.emplace(instance, make()).first->second;
  }

 private:
  std::mutex mutex_;
  std::map<std::size_t, Made> made_;
};

class SliceReader {
 public:
  explicit SliceReader(const StudySet& set, IndexCache* cache = nullptr) : set_(set), cache_(cache) {}

  // One frame in its own container, or in `container`.
  Result<void> read(SliceRef ref, std::optional<SampleType> container, std::span<std::byte> out) {
    Result<void> r = guarded("decodeSlice", [&] { return readAny(ref, container, out); });
    if (r) return r;
    return refuse(ref, r.error(), out);
  }

  ColourSpace colours() const { return scratch_.colours; }  // of the frame read last

  Result<void> refuseShape(SliceRef ref, std::span<std::byte> out) {
    return refuse(
        ref,
        makeError(ErrorCode::CodecMismatch,
                  "The slice has other rows, columns or samples than its stack; show it on its own."),
        out);
  }

 private:
  Error refuse(SliceRef ref, Error e, std::span<std::byte> out) {
    std::ranges::fill(out, std::byte{0});
    if (e.where.empty() && ref.instance < set_.instances.size())
      e.where = nameOf(set_.instances[ref.instance]);
    return e;
  }

  std::string nameOf(const Instance& i) const {
    return i.file < set_.files.size() ? set_.files[i.file].shown : std::string();
  }

  Result<void> readAny(SliceRef ref, std::optional<SampleType> container, std::span<std::byte> out) {
    if (ref.instance >= set_.instances.size())
      return makeError(ErrorCode::Internal, "The slice names an object that is not in the study.");
    const Instance& instance = set_.instances[ref.instance];
    if (instance.pixelError) return *instance.pixelError;
    if (!instance.isImage) return makeError(ErrorCode::PixelDataMissing, "The object is not an image.");
    const FrameSpec& spec = instance.pixels;
    const auto bytes = spec.frameBytes();
    if (!bytes) return bytes.error();
    if (ref.frame == SliceRef::kEmptyFrame) {
      std::ranges::fill(out, std::byte{0});
      return {};
    }
    if (ref.frame >= spec.framesDeclared)
      return makeError(ErrorCode::PixelDataMissing,
                       "The object has only " + std::to_string(spec.framesDeclared) + " frame(s); frame " +
                           std::to_string(ref.frame + 1) + " was asked for.");
    if (auto r = openInstance(ref.instance); !r) return r;
    const bool same = !container || *container == spec.sample;
    const std::uint64_t wanted = same ? *bytes : *bytes / bytesOf(spec.sample) * bytesOf(*container);
    if (out.size() != wanted)
      return makeError(ErrorCode::Internal, "decodeSlice() was given a buffer of the wrong size.",
                       "decodeSlice");
    if (same || study::sameSizeIntegers(spec.sample, *container)) {
      if (auto r = decodeFrame(spec, ref.frame, out); !r) return r;
      if (same || study::fitsSameSize(spec.sample, *container, out)) return {};
      return makeError(
          ErrorCode::CodecMismatch,
          "The image has values that do not fit the container of its stack; show it on its own.");
    }
    samples_.resize(*bytes);
    if (auto r = decodeFrame(spec, ref.frame, samples_); !r) return r;
    return study::convertSamples(spec.sample, samples_, *container, out);
  }

  Result<void> decodeFrame(const FrameSpec& spec, std::uint64_t frame, std::span<std::byte> out) {
    Result<void> r = study::decodeFrame(*source_, *index_, spec, frame, out, scratch_);
    // What a stream has to say of itself is the cause of what was found missing.
    if (!r && stream_ && stream_->failure()) return *stream_->failure();
    return r;
  }

  Result<void> openInstance(std::size_t number) {
    if (opened_ == number) return {};
    opened_.reset();
    const Instance& instance = set_.instances[number];
    if (instance.file >= set_.files.size())
      return makeError(ErrorCode::Internal, "The object names a file that is not in the study.");
    if (auto r = study::checkSpec(instance.pixels); !r) return r;
    const FileRecord& record = set_.files[instance.file];
    if (auto r = file_.open(record); !r) return r;
    source_ = &file_;
    stream_.reset();
    auto dataSet = study::dataSetOffset(file_);
    if (!dataSet) return dataSet.error();
    const bool many = instance.pixels.framesDeclared > 1;
    if (syntaxKind(instance.pixels.transferSyntaxUid) == SyntaxKind::Deflated) {
      if (auto r = many ? stream(*dataSet) : inflate(*dataSet); !r) return r;
      dataSet = std::uint64_t{0};
    }
    const auto make = [&]() -> IndexCache::Made {
      auto index = study::indexPixels(*source_, *dataSet, instance.pixels);
      if (index) return std::make_shared<const study::PixelIndex>(std::move(*index));
      return stream_ && stream_->failure() ? *stream_->failure() : index.error();
    };
    const auto index = many && cache_ ? cache_->get(number, make) : make();
    if (!index) return index.error();
    index_ = *index;
    opened_ = number;
    return {};
  }

  Result<void> stream(std::uint64_t dataSet) {
    stream_.emplace(file_, dataSet);
    source_ = &*stream_;
    return {};
  }

  Result<void> inflate(std::uint64_t dataSet) {
    std::vector<std::byte> deflated(file_.size() - dataSet);
    if (!file_.read(dataSet, deflated))
      return makeError(ErrorCode::FileDamaged, "The file cannot be read to its end.");
    auto plain = study::inflateAll(deflated);
    if (!plain) return plain.error();
    inflated_ = std::move(*plain);
    memory_.emplace(inflated_);
    source_ = &*memory_;
    return {};
  }

  const StudySet& set_;
  IndexCache* cache_;
  std::optional<std::size_t> opened_;  // instance whose index is held
  study::FileSource file_;
  std::vector<std::byte> inflated_;
  std::optional<study::SpanSource> memory_;
  study::Source* source_ = nullptr;
  std::optional<study::InflatingSource> stream_;
  std::shared_ptr<const study::PixelIndex> index_;
  study::Scratch scratch_;
  std::vector<std::byte> samples_;
};

bool sameShape(const FrameSpec& a, const FrameSpec& b) {
  return a.rows == b.rows && a.columns == b.columns && a.samplesPerPixel == b.samplesPerPixel;
}

// What the threads of one decodeStack() share.
struct StackWork {
  IndexCache indices;
  std::mutex mutex;
  std::uint64_t done = 0;
  std::vector<SliceFailure> failed;
};

// The first usable slice rules: the others must have its rows, columns and samples.
Result<FrameSpec> shapeOf(const StudySet& set, const Stack& stack, SampleType sample) {
  for (const SliceRef& ref : stack.slices)
    if (ref.instance >= set.instances.size())
      return makeError(ErrorCode::Internal, "The stack names an object that is not in the study.",
                       "decodeStack");
  for (const SliceRef& ref : stack.slices) {
    if (set.instances[ref.instance].pixelError) continue;
    FrameSpec spec = set.instances[ref.instance].pixels;
    spec.sample = sample;
    const auto bytes = spec.frameBytes();
    if (bytes && *bytes > 0) return spec;
  }
  return makeError(ErrorCode::PixelDescriptionInvalid,
                   "No slice of the stack has a usable description of its pixels.");
}

// Slices that one reader takes one after the other: runs of neighbours, so that buffers and the index of a
// multi-frame object are used again, short enough to balance; of a deflated multi-frame object all, in the
// order of the file.
std::vector<std::vector<std::size_t>> jobsOf(const StudySet& set, const Stack& stack) {
  const std::size_t n = stack.slices.size();
  const std::size_t run = std::clamp<std::size_t>(n / (static_cast<std::size_t>(threads()) * 8), 1, 32);
  std::map<std::size_t, std::vector<std::size_t>> streams;
  std::vector<std::vector<std::size_t>> jobs;
  for (std::size_t s = 0; s < n; ++s) {
    const FrameSpec& spec = set.instances[stack.slices[s].instance].pixels;
    if (spec.framesDeclared > 1 && syntaxKind(spec.transferSyntaxUid) == SyntaxKind::Deflated) {
      streams[stack.slices[s].instance].push_back(s);
    } else {
      if (jobs.empty() || jobs.back().size() >= run) jobs.emplace_back();
      jobs.back().push_back(s);
    }
  }
  for (auto& [instance, slices] : streams) {
    std::ranges::sort(slices, {}, [&](std::size_t s) { return stack.slices[s].frame; });
    jobs.push_back(std::move(slices));
  }
  return jobs;
}

}  // namespace

struct FrameReader::Impl {
  explicit Impl(const StudySet& set) : reader(set) {}
  SliceReader reader;
};
FrameReader::FrameReader(const StudySet& set) : impl_(std::make_unique<Impl>(set)) {}
FrameReader::~FrameReader() = default;
Result<void> FrameReader::read(SliceRef ref, std::span<std::byte> out, ColourSpace* colours) {
  Result<void> r = impl_->reader.read(ref, std::nullopt, out);
  if (r && colours) *colours = impl_->reader.colours();
  return r;
}

Result<void> decodeSlice(const StudySet& set, SliceRef ref, std::span<std::byte> out, ColourSpace* colours) {
  return guarded("decodeSlice", [&] {
    SliceReader reader(set);
    Result<void> r = reader.read(ref, std::nullopt, out);
    if (r && colours) *colours = reader.colours();
    return r;
  });
}

Result<void> decodeStack(const StudySet& set, const Stack& stack, SampleType sample, std::span<std::byte> out,
                         std::vector<SliceFailure>& failed, const ProgressFn& progress,
                         std::stop_token stop) {
  failed.clear();
  const std::size_t n = stack.slices.size();
  if (n == 0) return makeError(ErrorCode::NothingToLoad, "The stack has no slice.");
  const auto shape = shapeOf(set, stack, sample);
  if (!shape) return shape.error();
  const auto sliceBytes = shape->frameBytes();
  if (!sliceBytes) return sliceBytes.error();
  if (out.size() / n != *sliceBytes || out.size() % n != 0)
    return makeError(ErrorCode::Internal, "decodeStack() was given a buffer of the wrong size.",
                     "decodeStack");

  StackWork work;
  const auto jobs = jobsOf(set, stack);
  const auto runJob = [&](const std::vector<std::size_t>& slices) {
    SliceReader reader(set, &work.indices);
    for (const std::size_t s : slices) {
      if (stop.stop_requested()) return;
      const std::span<std::byte> to = out.subspan(s * *sliceBytes, *sliceBytes);
      const FrameSpec& spec = set.instances[stack.slices[s].instance].pixels;
      const bool fits = sameShape(spec, *shape) || set.instances[stack.slices[s].instance].pixelError;
      Result<void> r =
          fits ? reader.read(stack.slices[s], sample, to) : reader.refuseShape(stack.slices[s], to);
      const std::scoped_lock lock(work.mutex);
      if (!r) work.failed.push_back({s, r.error()});
      ++work.done;
      if (progress) progress("decode", work.done, n);
    }
  };
  parallelFor(jobs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) runJob(jobs[j]);
  });
  if (stop.stop_requested() && work.done < n)
    return makeError(ErrorCode::Cancelled, "Loading was cancelled.");
  std::ranges::sort(work.failed, {}, &SliceFailure::slice);
  failed = std::move(work.failed);
  if (failed.size() == n) return failed.front().error;
  return {};
}

}  // namespace vernier
