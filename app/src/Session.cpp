// SPDX-License-Identifier: GPL-3.0-or-later
#include "Session.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <tuple>

#include "SessionImpl.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"

namespace vernier::app {
namespace {

bool looksLikeMetaImage(const std::string& path) {
  std::string ext = std::filesystem::path(path).extension().string();
  for (char& c : ext) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ext == ".mhd" || ext == ".mha";
}

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
bool Session::isMetaImage() const { return impl_->metaImage != nullptr; }
const std::vector<PluginInfo>& Session::plugins() const { return impl_->plugins.plugins(); }
bool Session::draws(const std::string& kind) const {
  return !impl_->plugins.techniques().drawing(kind).empty();
}
const Panel* Session::panelOf(const std::string& kind) const { return impl_->plugins.panelOf(kind); }
CostTable& Session::costs() { return impl_->costs; }
MemoryBudget& Session::budget() { return impl_->budget; }
void Session::use(StackChoice c) { impl_->chosen = c; }
void Session::bridgeGaps(bool on) {
  if (impl_->bridge != on) impl_->volumes.clear();
  impl_->bridge = on;
}

Result<void> Session::open(const std::vector<std::string>& paths, const ProgressFn& progress,
                           std::stop_token stop) {
  const TraceSpan span("open");
  impl_->study = {};
  impl_->metaImage = nullptr;
  impl_->chosen.reset();
  impl_->volumes.clear();
  impl_->images.clear();
  if (paths.size() == 1 && looksLikeMetaImage(paths[0])) {
    BuildOptions options;
    options.budget = &impl_->budget;
    Result<std::shared_ptr<const Volume>> volume = readMetaImage(paths[0], options);
    if (!volume) return volume.error();
    impl_->metaImage = std::move(*volume);
    return {};
  }
  Result<StudySet> set = scanStudy(paths, progress, stop);
  if (!set) return set.error();
  impl_->study = std::move(*set);
  return {};
}

const Series* Session::seriesOf(StackChoice c) const {
  return c.series < impl_->study.series.size() ? &impl_->study.series[c.series] : nullptr;
}
const Stack* Session::stackOf(StackChoice c) const {
  const Series* s = seriesOf(c);
  return s && c.stack < s->stacks.size() ? &s->stacks[c.stack] : nullptr;
}

const Series* Session::chosenSeries() const { return impl_->chosen ? seriesOf(*impl_->chosen) : nullptr; }
const Stack* Session::chosenStack() const { return impl_->chosen ? stackOf(*impl_->chosen) : nullptr; }
int Session::threadCount() const { return threads(); }
std::uint64_t Session::derivedBytes() const { return impl_->derivedBytes; }
std::shared_ptr<const Volume> Session::builtVolume() const {
  if (impl_->metaImage) return impl_->metaImage;
  if (!impl_->chosen) return nullptr;
  const auto it = impl_->volumes.find({impl_->chosen->series, impl_->chosen->stack});
  return it == impl_->volumes.end() ? nullptr : it->second;
}

Result<StackChoice> Session::choose(const std::string& wanted) const {
  const auto& series = impl_->study.series;
  if (wanted.empty()) {
    std::optional<StackChoice> best;
    std::tuple<bool, bool, std::size_t> bestRank;
    for (std::size_t s = 0; s < series.size(); ++s)
      for (std::size_t k = 0; k < series[s].stacks.size(); ++k) {
        const Stack& stack = series[s].stacks[k];
        const std::tuple<bool, bool, std::size_t> rank{isPicture(impl_->study, stack), stack.volume3d,
                                                       stack.slices.size()};
        if (best && rank <= bestRank) continue;
        best = StackChoice{s, k};
        bestRank = rank;
      }
    if (best) return *best;
    return whyNothingIsShown(impl_->study);
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
                       "No series has this UID or number; `vernier info` numbers the " +
                           std::to_string(series.size()) + " series.",
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
  if (impl_->metaImage) return impl_->metaImage;
  const Result<StackChoice> c = resolve(*this, impl_->chosen, source);
  if (!c) return c.error();
  auto& slot = impl_->volumes[{c->series, c->stack}];
  if (slot) return slot;
  const TraceSpan span("build volume");
  BuildOptions options;
  options.budget = &impl_->budget;
  options.bridgeGaps = impl_->bridge;
  Result<std::shared_ptr<const Volume>> built =
      buildVolume(impl_->study, *seriesOf(*c), *stackOf(*c), options, progress, stop);
  if (built) slot = *built;
  return built;
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
  if (impl_->metaImage) return impl_->metaImage->grid().slices;
  const Result<StackChoice> c = resolve(*this, impl_->chosen, source);
  if (!c) return c.error();
  return static_cast<std::int64_t>(stackOf(*c)->slices.size());
}

Result<std::shared_ptr<const ImageFrame>> Session::image(const std::string& source, std::int64_t index) {
  if (impl_->metaImage)
    return makeError(
        ErrorCode::NothingToLoad,
        "A MetaImage volume has no stored frames; use the views axial, coronal, sagittal or oblique.",
        "stack");
  const Result<StackChoice> c = resolve(*this, impl_->chosen, source);
  if (!c) return c.error();
  const Stack& stack = *stackOf(*c);
  if (index < 0 || index >= static_cast<std::int64_t>(stack.slices.size()))
    return makeError(ErrorCode::OptionInvalid,
                     "The stack has slices 0 to " + std::to_string(stack.slices.size() - 1) + ", got " +
                         std::to_string(index) + ".",
                     "--slice");
  auto& slot = impl_->images[{c->series, c->stack, index}];
  if (slot) return slot;
  Result<std::shared_ptr<const ImageFrame>> built =
      buildImageFrame(impl_->study, *seriesOf(*c), stack, static_cast<std::size_t>(index));
  if (built) slot = *built;
  return built;
}

}  // namespace vernier::app
