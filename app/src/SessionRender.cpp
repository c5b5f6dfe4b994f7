// SPDX-License-Identifier: GPL-3.0-or-later
// Session, second half: capabilities, plans and pictures.

#include <algorithm>

#include "Clock.h"
#include "SessionImpl.h"
#include "vernier/base/Guarded.h"
#include "vernier/base/Threads.h"
#include "vernier/base/Trace.h"
#include "vernier/native/Simd.h"
#include "vernier/plan/SceneJson.h"
#include "vernier/plan/Volumetric.h"

namespace vernier::app {

const Capabilities& Session::capabilities(bool withGl) {
  const std::lock_guard lock(impl_->drawing);
  return impl_->look(withGl);
}

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
// draw a layer. A layer whose plugin is absent is no reason: GL would not bring it.
Result<Plan> Session::Impl::planFor(const Scene& scene, const View& view, const Quality& quality,
                                    const Sources& sources, bool explain) {
  const Technique* named = plugins.techniques().find(quality.technique);
  const bool glWanted =
      explain || quality.engine == EngineChoice::Gl || (named && named->engine == Engine::Gl);
  const auto make = [&](bool withGl) {
    return makePlan(scene, view, quality, look(withGl), costs, sources, plugins.techniques());
  };
  if (glWanted || quality.engine == EngineChoice::Native) return make(glWanted);
  Result<Plan> plan = make(false);
  if (plan || plan.error().code != ErrorCode::NoTechnique) return plan;
  return make(true);
}

Result<Sources> Session::Impl::sourcesFor(Session& session, const Scene& scene, std::stop_token stop) {
  Sources sources;
  const auto take = [&](const std::string& source) -> Result<void> {
    const auto v = session.volume(source, {}, stop);
    if (!v) return v.error();
    sources.volumes[source] = *v;
    return {};
  };
  for (const Layer& layer : scene.layers) {
    if (const std::string* read = volumeOf(layer)) {
      if (const Result<void> r = take(*read); !r) return r.error();
    } else if (const auto* image = std::get_if<ImageLayer>(&layer)) {
      const auto f = session.image(image->source, image->index);
      if (!f) return f.error();
      sources.images[{image->source, image->index}] = *f;
      if (const auto p = session.presentation(image->presentation))
        sources.presentations[image->presentation] = p;
    } else if (const auto* custom = std::get_if<CustomLayer>(&layer); custom) {
      const std::optional<std::string> source = sourceOf(*custom);
      if (!source || plugins.techniques().drawing(custom->kind).empty()) continue;
      const auto v = session.volume(*source, {}, stop);
      if (!v) return v.error();
      sources.volumes[*source] = *v;
    } else if (const auto* surface = std::get_if<SurfaceLayer>(&layer)) {
      const auto file = session.surface(surface->source);
      if (!file)
        return makeError(ErrorCode::SceneInvalid,
                         "The scene shows the surface '" + surface->source +
                             "', which was not given; name its file with --surface.",
                         "/layers");
      sources.meshes[surface->source] = file->mesh;
    } else if (const auto* lens = std::get_if<LensLayer>(&layer)) {
      const auto* mesh = std::get_if<MeshShape>(&lens->shape);  // without its file the planner says so
      if (const auto file = mesh ? session.surface(mesh->source) : nullptr)
        sources.meshes[mesh->source] = file->mesh;
    }
  }
  return sources;
}

Result<Plan> Session::plan(const Scene& scene, const View& view, const Quality& quality, bool explain) {
  const Result<Sources> sources = impl_->sourcesFor(*this, scene, {});
  if (!sources) return sources.error();
  const std::lock_guard lock(impl_->drawing);
  return impl_->planFor(impl_->withWindows(scene, *sources), view, quality, *sources, explain);
}

Scene Session::Impl::withWindows(Scene scene, const Sources& sources) {
  const auto fill = [&](auto* layer) {
    if (!layer || layer->window) return;
    if (const Volume& volume = *sources.volumes.at(layer->source); !volume.isColour())
      layer->window = windowOf(volume);
  };
  // A look through a volume shows what is brightest in it, which the file's window was not made for.
  const auto fillWhole = [&](auto* layer) {
    if (!layer || layer->window) return;
    if (const Volume& volume = *sources.volumes.at(layer->source); !volume.isColour())
      layer->window = wholeRange(volume);
  };
  // A name becomes the function that it stands for, so that a report says what was drawn. An unknown name is
  // left to the planner's sentence.
  const auto fillVolume = [&](VolumeLayer* layer) {
    if (!layer || layer->transfer) return;
    const Volume& volume = *sources.volumes.at(layer->source);
    if (volume.isColour()) return;
    if (layer->preset.empty()) layer->preset = defaultTransferPreset(volume);
    if (Result<TransferFunction> f = transferPreset(layer->preset, volume); f)
      layer->transfer = *std::move(f);
  };
  const auto fillLevel = [&](IsosurfaceLayer* iso) {
    if (!iso || iso->level) return;
    if (const Volume& volume = *sources.volumes.at(iso->source); !volume.isColour())
      iso->level = defaultIsoLevel(volume);
  };
  const auto fillThrough = [&](auto* any) {  // a layer, or what is inside a lens
    fillWhole(std::get_if<ProjectionLayer>(any));
    fillWhole(std::get_if<ShellsLayer>(any));
    fillVolume(std::get_if<VolumeLayer>(any));
    fillLevel(std::get_if<IsosurfaceLayer>(any));
  };
  std::optional<VoiWindow> ofSlice;  // the window of the slice that a lens looks into
  for (Layer& layer : scene.layers) {
    fill(std::get_if<SliceLayer>(&layer));
    fill(std::get_if<CurvedLayer>(&layer));
    fillThrough(&layer);
    if (const auto* slice = std::get_if<SliceLayer>(&layer); slice && !ofSlice) ofSlice = slice->window;
  }
  for (Layer& layer : scene.layers) {
    auto* lens = std::get_if<LensLayer>(&layer);
    if (!lens) continue;
    const auto sourceIsThere = [&](const auto& inner) {
      if constexpr (requires { inner.source; })
        return sources.volumes.contains(inner.source);  // another one is refused by the planner
      else
        return false;
    };
    if (std::visit(sourceIsThere, lens->inner)) fillThrough(&lens->inner);
    if (auto* look = std::get_if<SliceLook>(&lens->inner); look && !look->window) look->window = ofSlice;
  }
  return scene;
}

// The error of a picture is that of what it shows; layers that wait for a plugin are named in the plan's
// notes.
Scene Session::Impl::withoutAbsentLayers(Scene scene) const {
  std::erase_if(scene.layers,
                [&](const Layer& l) { return plugins.techniques().drawing(kindOf(l)).empty(); });
  return scene;
}

Result<std::map<std::size_t, PixelTruth>> Session::Impl::truthsOf(const Scene& shown, const View& view,
                                                                  const Quality& quality,
                                                                  const Sources& sources) {
  std::map<std::size_t, PixelTruth> truths;
  const PlanContext context{shown, view, quality, look(false), costs, sources};
  for (std::size_t n = 0; n < shown.layers.size(); ++n) {
    if (!std::holds_alternative<CustomLayer>(shown.layers[n])) continue;
    const std::string kind = kindOf(shown.layers[n]);
    const auto candidates = plugins.techniques().drawing(kind);
    const auto withTruth = std::find_if(candidates.begin(), candidates.end(),
                                        [](const Technique* t) { return t->truth != nullptr; });
    if (withTruth == candidates.end())
      return makeError(ErrorCode::NotBuiltYet, "error not measured: the plugin of layer " +
                                                   std::to_string(n) + " (" + kind +
                                                   ") brings no truth to measure against");
    Result<PixelTruth> truth = (*withTruth)->truth(shown.layers[n], n, context);
    if (!truth) return truth.error();
    truths[n] = std::move(*truth);
  }
  return truths;
}

namespace {
// A picture whose first pass draws over what lies below it: there is nothing below but the background.
void fillWith(Images& images, const Rgb& colour) {
  for (std::size_t n = 0; n < images.colour.size(); n += 4) {
    images.colour[n] = static_cast<float>(colour.r), images.colour[n + 1] = static_cast<float>(colour.g);
    images.colour[n + 2] = static_cast<float>(colour.b), images.colour[n + 3] = 1;
  }
}
// The plan's lenses as layers of what is shown, which lacks the layers that nothing here draws.
std::vector<PlacedLens> lensesIn(const Scene& shown, const Scene& drawn, std::vector<PlacedLens> lenses) {
  std::vector<std::size_t> in, out;
  for (std::size_t n = 0; n < drawn.layers.size(); ++n)
    if (std::holds_alternative<LensLayer>(drawn.layers[n])) in.push_back(n);
  for (std::size_t n = 0; n < shown.layers.size(); ++n)
    if (std::holds_alternative<LensLayer>(shown.layers[n])) out.push_back(n);
  // Layers stay or go by kind, so that either all lenses are shown or none is.
  if (in.size() != out.size()) return {};
  for (PlacedLens& lens : lenses)
    lens.layer = out[static_cast<std::size_t>(std::find(in.begin(), in.end(), lens.layer) - in.begin())];
  return lenses;
}
bool drawsOver(const Pass& pass) {
  return std::find(pass.inputs.begin(), pass.inputs.end(), "colour") != pass.inputs.end();
}
}  // namespace

Result<Frame> Session::Impl::execute(const Plan& plan, const View& view, const Rgb& background,
                                     std::stop_token stop, Frame reuse) {
  const TraceSpan span("frame");
  const auto begin = Clock::now();
  Frame frame = std::move(reuse);
  frame.images.counters = {};
  // Techniques size the images and write every pixel; clearing them first would cost as much as a slice.
  if (plan.passes.empty() || drawsOver(plan.passes.front())) {
    frame.images.allocate(view.width_px, view.height_px, view.wantValues);
    if (!plan.passes.empty()) fillWith(frame.images, background);
  }
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
    derivedBytes = derived.bytes() + (glDevice ? glDevice->cache().bytes() : 0);
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

namespace {

bool usesGl(const Plan& plan) {
  return std::any_of(plan.passes.begin(), plan.passes.end(),
                     [](const Pass& p) { return p.engine == Engine::Gl; });
}

// What another context, or none, may do better: everything that the device is to blame for.
bool isOfTheDevice(ErrorCode code) {
  return errorClass(code) == ErrorClass::Device || code == ErrorCode::OutOfMemory;
}

}  // namespace

Result<Frame> Session::Impl::drawOrRecover(const Asked& a, Plan& plan, std::stop_token stop, Frame reuse) {
  Result<Frame> frame = execute(plan, a.view, a.scene.background, stop, std::move(reuse));
  if (frame || !usesGl(plan) || !isOfTheDevice(frame.error().code)) return frame;
  if (frame.error().code == ErrorCode::GlLost) {
    renderThread.run([&] { glDevice.reset(); });
    if (!deviceWasRebuilt) {
      deviceWasRebuilt = true;
      frame = execute(plan, a.view, a.scene.background, stop, {});
      if (frame) plan.notes.push_back("OpenGL was lost (the driver was reset) and has been made anew");
      if (frame || !isOfTheDevice(frame.error().code)) return frame;
    }
  }
  Capabilities machine = look(true);
  machine.gl = false;
  machine.glWhyNot = frame.error().sentence;
  // Too little memory is of this picture; whatever else failed would fail again.
  if (frame.error().code != ErrorCode::OutOfMemory) *capabilities = machine;
  Result<Plan> native = makePlan(a.scene, a.view, a.quality, machine, costs, a.sources, plugins.techniques());
  if (!native) return frame.error();  // GL was asked for, or nothing else can draw this
  native->notes.push_back("drawn without OpenGL, which failed: " + frame.error().sentence);
  plan = std::move(*native);
  return execute(plan, a.view, a.scene.background, stop, {});
}

namespace {

// A draft is a time target: one picture, whatever its error. The others halve the step until they meet the
// goal.
quality::LadderOptions ladderOf(const Quality& asked, const RenderOptions& options) {
  quality::LadderOptions ladder;
  ladder.firstStep = asked.step;
  ladder.limit_ms =
      options.timeLimit_ms.value_or(asked.level == QualityLevel::Reference ? 60'000.0 : 5'000.0);
  if (asked.level == QualityLevel::Draft) ladder.leastStep = asked.step;
  Quality level = asked;
  level.maxError = options.goal;
  ladder.goal = errorGoal(level);
  return ladder;
}

// Colour, depth and values of a frame as floats, and the 8 bits made of them.
std::uint64_t bytesOfPicture(const View& view) {
  const std::uint64_t perPixel =
      4 * sizeof(float) + sizeof(float) + (view.wantValues ? sizeof(float) : 0) + 3;
  return perPixel * static_cast<std::uint64_t>(view.width_px) * static_cast<std::uint64_t>(view.height_px);
}

}  // namespace

Result<void> Session::Impl::checkShown(const Scene& scene, const View& view) const {
  if (view.width_px < 1 || view.height_px < 1 || view.width_px > 16384 || view.height_px > 16384)
    return makeError(ErrorCode::OptionInvalid, "A picture is 1 to 16384 pixels wide and high.", "--size");
  if (!scene.layers.empty() && withoutAbsentLayers(scene).layers.empty())
    return makeError(ErrorCode::PluginMissing,
                     "Nothing of the scene can be shown: " + kindOf(scene.layers[0]) + " needs plugin " +
                         pluginOf(kindOf(scene.layers[0])) +
                         ", which is not loaded; `vernier plugins` says why.");
  return {};
}

Result<Rendered> Session::render(const Scene& scene, const View& view, const Quality& asked,
                                 const RenderOptions& options, std::stop_token stop, Frame reuse) {
  if (const Result<void> r = impl_->checkShown(scene, view); !r) return r.error();
  const auto room =
      impl_->budget.reserve(bytesOfPicture(view), "A picture of " + std::to_string(view.width_px) + " x " +
                                                      std::to_string(view.height_px) + " pixels");
  if (!room) return room.error();
  const auto begin = Clock::now();
  const Result<Sources> sources = impl_->sourcesFor(*this, scene, stop);
  if (!sources) return sources.error();
  const Scene drawn = impl_->withWindows(scene, *sources);
  const double prepare_ms = msSince(begin);

  Rendered out;
  std::map<double, Plan> plans;  // by step: the one that belongs to the picture that is kept
  const quality::RenderAtStep draw = [&](double step) -> Result<Frame> {
    const std::lock_guard lock(impl_->drawing);
    Quality quality = asked;
    quality.step = step;
    Scene toDraw = drawn;
    const Sabotage& sabotage = impl_->sabotage;
    if (sabotage.scene) sabotage.scene(toDraw, view, *sources);
    Result<Plan> plan = impl_->planFor(toDraw, view, quality, *sources, options.explain);
    if (!plan) return plan.error();
    if (sabotage.plan) sabotage.plan(*plan);
    Result<Frame> frame =
        impl_->drawOrRecover({toDraw, view, quality, *sources}, *plan, stop, std::move(reuse));
    if (!frame) return frame;
    if (sabotage.picture) sabotage.picture(*plan, frame->images);
    frame->prepare_ms = prepare_ms;
    plans[step] = std::move(*plan);
    return frame;
  };
  const Scene shown = impl_->withoutAbsentLayers(drawn);
  const auto truths = [&] {
    const std::lock_guard lock(impl_->drawing);
    return impl_->truthsOf(shown, view, asked, *sources);
  }();
  if (!options.measure || !truths) {
    Result<Frame> frame = draw(asked.step);
    if (!frame) return frame.error();
    out.frame = std::move(*frame);
    out.plan = std::move(plans[asked.step]);
    out.step = asked.step;
    if (options.measure) out.plan.notes.push_back(truths.error().sentence);
    return out;
  }
  const quality::MeasureFrame measure = [&](const Frame& frame, double step) {
    quality::ErrorOptions error = options.error;
    error.reference.step = step;
    error.reference.truths = *truths;
    error.reference.lenses = lensesIn(shown, drawn, plans.at(step).lenses);
    return quality::measureError(frame, shown, view, *sources, error, stop);
  };
  Result<quality::LadderResult> reached = quality::climb(draw, measure, ladderOf(asked, options), stop);
  if (!reached) return reached.error();
  out.step = reached->reached.step;
  out.plan = std::move(plans.at(out.step));
  out.frame = std::move(reached->frame);
  out.error = std::move(reached->reached.error);
  out.goalReached = reached->goalReached;
  out.goalNote = std::move(reached->said);
  out.rungs = std::move(reached->rungs);
  return out;
}

}  // namespace vernier::app
