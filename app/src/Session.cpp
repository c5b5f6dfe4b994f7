// SPDX-License-Identifier: GPL-3.0-or-later
#include "Session.h"

#include <algorithm>
#include <charconv>
#include <tuple>

#include "SessionImpl.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::app {
namespace {

// Segmentations and doses lie over pictures; they come first only where there is nothing else.
bool isPicture(const StudySet& study, const Stack& stack) {
  const Instance& i = study.instances[stack.slices.front().instance];
  return i.segmentation == SegmentationKind::None && i.modality != "RTDOSE";
}

std::optional<std::size_t> positiveNumber(std::string_view text) {
  std::size_t n = 0;
  const auto [p, ec] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (ec != std::errc() || p != text.data() + text.size() || n == 0) return std::nullopt;
  return n;
}

// For an input of one file its own sentence, else how much was looked at.
Error whyNothingIsShown(const StudySet& study) {
  if (study.files.size() == 1) {
    if (study.files[0].error) return *study.files[0].error;
    for (const Instance& i : study.instances) {
      if (i.pixelError) return *i.pixelError;
      if (!i.notShown.empty()) return makeError(ErrorCode::NothingToLoad, i.notShown, study.files[0].shown);
    }
  }
  return makeError(ErrorCode::NothingToLoad, "No image was found among " +
                                                 std::to_string(study.files.size()) +
                                                 " files; `vernier info` lists what each file is.");
}

}  // namespace

Session::Session(const SessionOptions& o) {
  setThreads(o.threads);
  impl_ = std::make_unique<Impl>(o);
}
Session::~Session() = default;

const StudySet& Session::study() const { return impl_->study; }
const std::vector<VolumeFile>& Session::volumeFiles() const { return impl_->volumeFiles; }
bool Session::isVolumeFile() const { return impl_->study.series.empty() && impl_->volumeFiles.size() == 1; }
const std::vector<PluginInfo>& Session::plugins() const { return impl_->plugins.plugins(); }
bool Session::draws(const std::string& kind) const {
  return !impl_->plugins.techniques().drawing(kind).empty();
}
const Panel* Session::panelOf(const std::string& kind) const { return impl_->plugins.panelOf(kind); }
CostTable& Session::costs() { return impl_->costs; }
MemoryBudget& Session::budget() { return impl_->budget; }
void Session::use(StackChoice c) { impl_->chosen = c; }
void Session::readVolumeFilesWith(std::optional<std::int64_t> frame, std::optional<double> zSpan) {
  if (impl_->fileFrame != frame || impl_->zSpan != zSpan) {
    impl_->volumes.clear();
    ++impl_->opened;  // no frame of it is taken for one of the new reading
  }
  impl_->fileFrame = frame;
  impl_->zSpan = zSpan;
}
void Session::bridgeGaps(bool on) {
  if (impl_->bridge != on) impl_->volumes.clear();
  impl_->bridge = on;
}

Result<void> Session::open(const std::vector<std::string>& paths, const ProgressFn& progress,
                           std::stop_token stop) {
  const TraceSpan span("open");
  impl_->study = {};
  impl_->volumeFiles.clear();
  impl_->chosen.reset();
  impl_->volumes.clear();
  impl_->stackWindows.clear();
  ++impl_->opened;
  Result<StudySet> set = scanStudy(paths, progress, stop);
  if (!set) return set.error();
  impl_->study = std::move(*set);
  impl_->volumeFiles = findVolumeFiles(impl_->study);
  return {};
}

const Series* Session::seriesOf(StackChoice c) const {
  return !c.volumeFile && c.series < impl_->study.series.size() ? &impl_->study.series[c.series] : nullptr;
}
const Stack* Session::stackOf(StackChoice c) const {
  const Series* s = seriesOf(c);
  return s && c.stack < s->stacks.size() ? &s->stacks[c.stack] : nullptr;
}

const VolumeFile* Session::volumeFileOf(StackChoice c) const {
  return c.volumeFile && *c.volumeFile < impl_->volumeFiles.size() ? &impl_->volumeFiles[*c.volumeFile]
                                                                   : nullptr;
}

const Series* Session::chosenSeries() const { return impl_->chosen ? seriesOf(*impl_->chosen) : nullptr; }
const Stack* Session::chosenStack() const { return impl_->chosen ? stackOf(*impl_->chosen) : nullptr; }
const VolumeFile* Session::chosenVolumeFile() const {
  return impl_->chosen ? volumeFileOf(*impl_->chosen) : nullptr;
}
int Session::threadCount() const { return threads(); }
std::uint64_t Session::derivedBytes() const { return impl_->derivedBytes; }
std::shared_ptr<const Volume> Session::builtVolume() const {
  if (!impl_->chosen) return nullptr;
  return impl_->ready(*impl_->chosen);
}

std::shared_ptr<const Volume> Session::Impl::ready(StackChoice c) const {
  const std::lock_guard lock(sourcesMutex);
  const auto it = volumes.find(c);
  return it == volumes.end() ? nullptr : it->second.volume;
}

std::string Session::sourceName(StackChoice c) const {
  const auto& series = impl_->study.series;
  if (c.volumeFile) return std::to_string(series.size() + *c.volumeFile + 1);
  VERNIER_ASSERT(c.series < series.size());
  const std::string& uid = series[c.series].seriesUid;
  const auto same =
      std::count_if(series.begin(), series.end(), [&](const Series& s) { return s.seriesUid == uid; });
  const bool uidNames =
      !uid.empty() && same == 1 && uid.find('#') == std::string::npos && !positiveNumber(uid);
  return (uidNames ? uid : std::to_string(c.series + 1)) + "#" + std::to_string(c.stack + 1);
}

namespace {

// The largest that can be shown in 3-D, else the largest image stack; of equals the first.
std::optional<StackChoice> largest(const StudySet& study, const std::vector<VolumeFile>& volumeFiles) {
  std::optional<StackChoice> best;
  std::tuple<bool, bool, std::int64_t> bestRank;
  const auto offer = [&](StackChoice c, bool picture, bool volume3d, std::int64_t slices) {
    const std::tuple<bool, bool, std::int64_t> rank{picture, volume3d, slices};
    if (best && rank <= bestRank) return;
    best = c;
    bestRank = rank;
  };
  for (std::size_t s = 0; s < study.series.size(); ++s)
    for (std::size_t k = 0; k < study.series[s].stacks.size(); ++k) {
      const Stack& stack = study.series[s].stacks[k];
      offer({s, k, {}}, isPicture(study, stack), stack.volume3d,
            static_cast<std::int64_t>(stack.slices.size()));
    }
  for (std::size_t v = 0; v < volumeFiles.size(); ++v)
    if (volumeFiles[v].facts) offer({0, 0, v}, true, true, volumeFiles[v].facts->info.grid.slices);
  return best;
}

}  // namespace

Result<StackChoice> Session::choose(const std::string& wanted) const {
  const auto& series = impl_->study.series;
  if (wanted.empty()) {
    if (const auto best = largest(impl_->study, impl_->volumeFiles)) return *best;
    return whyNothingIsShown(impl_->study);
  }
  if (const auto v = impl_->volumeFileNamed(wanted)) {
    if (impl_->volumeFiles[*v].error) return *impl_->volumeFiles[*v].error;
    return StackChoice{0, 0, v};
  }
  const std::size_t hash = wanted.find('#');
  const std::string name = wanted.substr(0, hash);
  StackChoice choice;
  if (const auto n = positiveNumber(name); n && *n <= series.size()) {
    choice.series = *n - 1;
  } else {
    const auto it =
        std::find_if(series.begin(), series.end(), [&](const Series& s) { return s.seriesUid == name; });
    if (it == series.end())
      return makeError(ErrorCode::SeriesNotFound,
                       "No series or volume file has this UID, number or name; `vernier info` numbers the " +
                           std::to_string(series.size() + impl_->volumeFiles.size()) + " that there are.",
                       "--series");
    choice.series = static_cast<std::size_t>(it - series.begin());
  }
  if (hash != std::string::npos) {
    const auto n = positiveNumber(std::string_view(wanted).substr(hash + 1));
    if (!n || *n > series[choice.series].stacks.size())
      return makeError(ErrorCode::SeriesNotFound,
                       "The series has " + std::to_string(series[choice.series].stacks.size()) +
                           " stacks; give #1 for the first.",
                       "--series");
    choice.stack = *n - 1;
  }
  if (series[choice.series].stacks.empty())
    return makeError(ErrorCode::NothingToLoad, "The series holds no image that can be shown.", "--series");
  return choice;
}

namespace {
Result<StackChoice> resolve(const Session& session, const std::optional<StackChoice>& chosen,
                            const std::string& source) {
  if (source.empty() && chosen) return *chosen;
  return session.choose(source);
}
}  // namespace

Result<std::shared_ptr<const Volume>> Session::volume(const std::string& source, const ProgressFn& progress,
                                                      std::stop_token stop) {
  const Result<StackChoice> c = resolve(*this, impl_->chosen, source);
  if (!c) return c.error();
  std::unique_lock lock(impl_->sourcesMutex);
  Impl::VolumeSlot& slot = impl_->volumes[*c];
  impl_->built.wait(lock, stop, [&] { return !slot.building; });
  if (slot.volume) return slot.volume;
  if (slot.building) return makeError(ErrorCode::Cancelled, "Loading was cancelled.");
  slot.building = true;
  lock.unlock();
  const TraceSpan span("build volume");
  BuildOptions options;
  options.budget = &impl_->budget;
  options.bridgeGaps = impl_->bridge;
  options.frame = impl_->fileFrame;
  options.zSpan = impl_->zSpan;
  const VolumeFile* const file = volumeFileOf(*c);
  Result<std::shared_ptr<const Volume>> built =
      file ? readVolumeFile(impl_->study.files[file->file], options, progress, stop)
           : buildVolume(impl_->study, *seriesOf(*c), *stackOf(*c), options, progress, stop);
  lock.lock();
  slot.building = false;
  if (built) slot.volume = *built;
  impl_->built.notify_all();
  return built;
}

std::shared_ptr<const Volume> Session::readyVolume(const std::string& source) const {
  const Result<StackChoice> c = resolve(*this, impl_->chosen, source);
  return c ? impl_->ready(*c) : nullptr;
}

std::shared_ptr<const PresentationState> Session::presentation(const std::string& uid) const {
  for (const PresentationState& p : impl_->study.presentations)
    if (!uid.empty() && p.sopInstanceUid == uid) return std::make_shared<PresentationState>(p);
  return nullptr;
}

// By name, or by its number in `info`, which follows those of the series.
std::optional<std::size_t> Session::Impl::volumeFileNamed(const std::string& wanted) const {
  const std::size_t before = study.series.size();
  if (const auto n = positiveNumber(wanted); n && *n > before && *n <= before + volumeFiles.size())
    return *n - before - 1;
  for (std::size_t v = 0; v < volumeFiles.size(); ++v)
    if (study.files[volumeFiles[v].file].shown == wanted) return v;
  return std::nullopt;
}

VoiWindow Session::Impl::windowOf(const Volume& volume) {
  const DerivedCache::Key key{"default window", volume.revision(), ""};
  const auto window = derived.get<VoiWindow>(key, [&]() -> Result<DerivedCache::Made<VoiWindow>> {
    return DerivedCache::Made<VoiWindow>{std::make_shared<VoiWindow>(defaultWindow(volume)),
                                         sizeof(VoiWindow)};
  });
  return **window;
}
VoiWindow Session::defaultWindowOf(const Volume& volume) const { return impl_->windowOf(volume); }

Result<std::int64_t> Session::imageCount(const std::string& source) const {
  const Result<StackChoice> c = resolve(*this, impl_->chosen, source);
  if (!c) return c.error();
  if (const VolumeFile* file = volumeFileOf(*c)) return file->facts->info.grid.slices;
  return static_cast<std::int64_t>(stackOf(*c)->slices.size());
}

Result<std::shared_ptr<const ImageFrame>> Session::image(const std::string& source, std::int64_t index) {
  const Result<StackChoice> c = resolve(*this, impl_->chosen, source);
  if (!c) return c.error();
  const Result<std::int64_t> count = imageCount(source);
  if (!count) return count.error();
  if (index < 0 || index >= *count)
    return makeError(
        ErrorCode::OptionInvalid,
        "The stack has slices 0 to " + std::to_string(*count - 1) + ", got " + std::to_string(index) + ".",
        "--slice");
  const auto made = [](const std::shared_ptr<const ImageFrame>& frame) {
    const ImageFrameInfo& info = frame->info();
    const auto pixels = static_cast<std::uint64_t>(info.columns) * static_cast<std::uint64_t>(info.rows);
    const auto samples = static_cast<std::uint64_t>(info.samples());
    return DerivedCache::Made<ImageFrame>{frame, pixels * samples * bytesOf(info.type)};
  };
  const std::string stackName = c->volumeFile ? "file " + std::to_string(*c->volumeFile)
                                              : std::to_string(c->series) + "#" + std::to_string(c->stack);
  const DerivedCache::Key key{"frame", impl_->opened, stackName + "#" + std::to_string(index)};
  return impl_->frames.get<ImageFrame>(key, [&]() -> Result<DerivedCache::Made<ImageFrame>> {
    if (c->volumeFile) {
      const auto v = volume(source);
      if (!v) return v.error();
      const auto built = imageOfVolume(**v, index, impl_->windowOf(**v));
      if (!built) return built.error();
      return made(*built);
    }
    const auto built = impl_->buildFrame(*c, *seriesOf(*c), *stackOf(*c), index);
    if (!built) return built.error();
    return made(*built);
  });
}

Result<std::shared_ptr<const ImageFrame>> Session::Impl::buildFrame(StackChoice c, const Series& series,
                                                                    const Stack& stack, std::int64_t index) {
  std::optional<VoiWindow> known;
  {
    const std::lock_guard lock(sourcesMutex);
    if (const auto it = stackWindows.find(c); it != stackWindows.end()) known = it->second;
  }
  Result<std::shared_ptr<const ImageFrame>> frame =
      buildImageFrame(study, series, stack, static_cast<std::size_t>(index), known);
  if (!frame || known) return frame;
  const ImageFrameInfo& info = (*frame)->info();
  if (info.windows.empty() && info.voiLuts.empty() && !windowPerImage(stack, info.modality)) {
    const std::lock_guard lock(sourcesMutex);
    stackWindows.emplace(c, info.autoWindow);
  }
  return frame;
}

}  // namespace vernier::app
