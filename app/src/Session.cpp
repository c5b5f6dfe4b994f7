// SPDX-License-Identifier: GPL-3.0-or-later
#include "Session.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <map>

#include "RenderThread.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"
#include "vernier/gpu/Device.h"
#include "vernier/native/Simd.h"

namespace vernier::app {
namespace {

using Clock = std::chrono::steady_clock;
double msSince(Clock::time_point t) {
  return std::chrono::duration<double, std::milli>(Clock::now() - t).count();
}

bool looksLikeMetaImage(const std::string& path) {
  std::string ext = std::filesystem::path(path).extension().string();
  for (char& c : ext) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ext == ".mhd" || ext == ".mha";
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

struct Session::Impl {
  explicit Impl(const SessionOptions& o)
      : budget(o.memory_mb > 0 ? o.memory_mb << 20 : MemoryBudget::halfOfFreeBytes()),
        plugins([this] { return device(); }) {
    std::vector<std::string> folders{PluginHost::installFolder()};
    folders.insert(folders.end(), o.pluginFolders.begin(), o.pluginFolders.end());
    plugins.load(folders);
  }
  ~Impl() {
    renderThread.run([&] { glDevice.reset(); });  // GL objects are freed where they were made
  }

  Result<gpu::Device*> device() {
    if (!glDevice) {
      Result<std::unique_ptr<gpu::Device>> made = gpu::Device::make();
      if (!made) return made.error();
      glDevice = std::move(*made);
    }
    return glDevice.get();
  }
  const Capabilities& look(bool withGl);
  Result<Sources> sourcesFor(Session&, const Scene&, std::stop_token);
  Result<Plan> planFor(const Scene&, const View&, const Quality&, const Sources&, bool explain);
  Scene withoutAbsentLayers(Scene) const;
  Result<Frame> execute(const Plan&, const View&, std::stop_token, Frame reuse);

  MemoryBudget budget;
  StudySet study;
  std::shared_ptr<const Volume> metaImage;
  std::optional<StackChoice> chosen;
  bool bridge = false;
  std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<const Volume>> volumes;
  std::map<std::tuple<std::size_t, std::size_t, std::int64_t>, std::shared_ptr<const ImageFrame>> images;
  std::optional<Capabilities> capabilities;
  bool lookedForGl = false;
  std::uint64_t derivedBytes = 0;
  CostTable costs;
  std::unique_ptr<gpu::Device> glDevice;  // touched on the render thread only
  PluginHost plugins;
  RenderThread renderThread;
};

Session::Session(const SessionOptions& o) {
  setThreads(o.threads);
  impl_ = std::make_unique<Impl>(o);
}
Session::~Session() = default;

const StudySet& Session::study() const { return impl_->study; }
bool Session::isMetaImage() const { return impl_->metaImage != nullptr; }
const std::vector<PluginInfo>& Session::plugins() const { return impl_->plugins.plugins(); }
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
    std::pair<bool, std::size_t> bestRank;
    for (std::size_t s = 0; s < series.size(); ++s)
      for (std::size_t k = 0; k < series[s].stacks.size(); ++k) {
        const Stack& stack = series[s].stacks[k];
        const std::pair<bool, std::size_t> rank{stack.volume3d, stack.slices.size()};
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

const Capabilities& Session::capabilities(bool withGl) { return impl_->look(withGl); }

const Capabilities& Session::Impl::look(bool withGl) {
  if (!capabilities) {
    capabilities.emplace();
    capabilities->simd = native::simdTarget();
    capabilities->threads = threads();
    capabilities->glWhyNot = "OpenGL was not looked for: nothing needed it.";
  }
  if (withGl && !lookedForGl) {
    lookedForGl = true;
    renderThread.run([&] {
      if (const Result<gpu::Device*> d = device(); d)
        gpu::describe((*d)->limits(), *capabilities);
      else
        capabilities->glWhyNot = d.error().sentence;
    });
  }
  return *capabilities;
}

// Without a card native is the faster engine for all that it can draw, and looking for GL costs a context. So
// GL is looked for only when it was asked for, when the plan is to be explained, or when native alone cannot
// show the scene.
Result<Plan> Session::Impl::planFor(const Scene& scene, const View& view, const Quality& quality,
                                    const Sources& sources, bool explain) {
  const bool glWanted = explain || quality.engine == EngineChoice::Gl || !quality.technique.empty();
  const auto make = [&](bool withGl) {
    return makePlan(scene, view, quality, look(withGl), costs, sources, plugins.techniques());
  };
  if (glWanted || quality.engine == EngineChoice::Native) return make(glWanted);
  Result<Plan> plan = make(false);
  if (plan && plan->showsWholeScene) return plan;
  return make(true);
}

Result<Sources> Session::Impl::sourcesFor(Session& session, const Scene& scene, std::stop_token stop) {
  Sources sources;
  for (const Layer& layer : scene.layers) {
    if (const auto* slice = std::get_if<SliceLayer>(&layer)) {
      const auto v = session.volume(slice->source, {}, stop);
      if (!v) return v.error();
      sources.volumes[slice->source] = *v;
    } else if (const auto* image = std::get_if<ImageLayer>(&layer)) {
      const auto f = session.image(image->source, image->index);
      if (!f) return f.error();
      sources.images[{image->source, image->index}] = *f;
    }
  }
  return sources;
}

Result<Plan> Session::plan(const Scene& scene, const View& view, const Quality& quality, bool explain) {
  const Result<Sources> sources = impl_->sourcesFor(*this, scene, {});
  if (!sources) return sources.error();
  return impl_->planFor(scene, view, quality, *sources, explain);
}

// The error of a picture is that of what it shows; layers that wait for a plugin are named in the plan's
// notes.
Scene Session::Impl::withoutAbsentLayers(Scene scene) const {
  std::erase_if(scene.layers,
                [&](const Layer& l) { return plugins.techniques().drawing(kindOf(l)).empty(); });
  return scene;
}

Result<Frame> Session::Impl::execute(const Plan& plan, const View& view, std::stop_token stop, Frame reuse) {
  const TraceSpan span("frame");
  const auto begin = Clock::now();
  Frame frame = std::move(reuse);
  frame.images.counters = {};
  // Techniques size the images and write every pixel; clearing them first would cost as much as a slice.
  if (plan.passes.empty()) frame.images.allocate(view.width_px, view.height_px, view.wantValues);
  Result<void> done;
  renderThread.run([&] {
    for (const Pass& pass : plan.passes) {
      const TraceSpan passSpan("pass");
      const Technique* technique = plugins.techniques().find(pass.technique);
      VERNIER_ASSERT(technique != nullptr);  // the planner only names registered techniques
      done = guarded(pass.name, [&] { return technique->execute(pass, frame.images, stop); });
      if (!done) return;
      ++frame.images.counters.passes;
    }
    derivedBytes = glDevice ? glDevice->cache().bytes() : 0;
  });
  if (!done) return done.error();
  if (!plan.passes.empty()) {
    frame.technique = plan.passes.front().technique;
    frame.engine = plan.passes.front().engine == Engine::Native ? "native" : "gl";
  }
  frame.renderer = frame.engine == "gl" ? capabilities->glRenderer : capabilities->simd;
  frame.render_ms = msSince(begin);
  return frame;
}

Result<Rendered> Session::render(const Scene& scene, const View& view, const Quality& asked,
                                 const RenderOptions& options, std::stop_token stop, Frame reuse) {
  if (view.width_px < 1 || view.height_px < 1 || view.width_px > 16384 || view.height_px > 16384)
    return makeError(ErrorCode::OptionInvalid, "A picture is 1 to 16384 pixels wide and high.", "--size");
  const auto begin = Clock::now();
  const Result<Sources> sources = impl_->sourcesFor(*this, scene, stop);
  if (!sources) return sources.error();
  const double prepare_ms = msSince(begin);

  Rendered out;
  Quality quality = asked;
  Frame buffers = std::move(reuse);
  const quality::RenderAtStep draw = [&](double step) -> Result<Frame> {
    quality.step = step;
    Result<Plan> plan = impl_->planFor(scene, view, quality, *sources, options.explain);
    if (!plan) return plan.error();
    out.plan = std::move(*plan);
    Result<Frame> frame = impl_->execute(out.plan, view, stop, std::move(buffers));
    if (frame) frame->prepare_ms = prepare_ms;
    return frame;
  };
  const Scene shown = impl_->withoutAbsentLayers(scene);
  if (shown.layers.empty() && !scene.layers.empty())
    return makeError(ErrorCode::PluginMissing,
                     "Nothing of the scene can be shown: " + kindOf(scene.layers[0]) + " needs plugin " +
                         pluginOf(kindOf(scene.layers[0])) +
                         ", which is not loaded; `vernier plugins` says why.");
  const quality::MeasureFrame measure = [&](const Frame& frame, double step) {
    quality::ErrorOptions error = options.error;
    error.reference.step = step;
    return quality::measureError(frame, shown, view, *sources, error, stop);
  };
  if (!options.measure || asked.level == QualityLevel::Draft) {
    Result<Frame> frame = draw(asked.step);
    if (!frame) return frame.error();
    out.frame = std::move(*frame);
    out.step = asked.step;
    if (!options.measure) return out;
    Result<quality::ErrorReport> error = measure(out.frame, asked.step);
    if (!error) return error.error();
    out.error = std::move(*error);
    return out;
  }
  quality::LadderOptions ladder;
  ladder.goal = options.goal.value_or(asked.level == QualityLevel::Reference ? 0.5 : 2.0);
  ladder.firstStep = asked.step;
  ladder.limit_ms = options.timeLimit_ms.value_or(asked.level == QualityLevel::Reference ? 60'000.0 : 5'000.0);
  Result<quality::LadderResult> reached = quality::climb(draw, measure, ladder, stop);
  if (!reached) return reached.error();
  if (quality.step != reached->reached.step) {  // the plan that belongs to the picture that is kept
    quality.step = reached->reached.step;
    Result<Plan> plan = impl_->planFor(scene, view, quality, *sources, options.explain);
    if (!plan) return plan.error();
    out.plan = std::move(*plan);
  }
  out.frame = std::move(reached->frame);
  out.error = std::move(reached->reached.error);
  out.step = quality.step;
  out.goalReached = reached->goalReached;
  out.goalNote = std::move(reached->said);
  out.rungs = std::move(reached->rungs);
  return out;
}

}  // namespace vernier::app
