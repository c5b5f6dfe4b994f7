// SPDX-License-Identifier: GPL-3.0-or-later
#include "RenderService.h"

#include <algorithm>
#include <cmath>

#include "Annotations.h"
#include "Enlarge.h"
#include "vernier/base/Guarded.h"
#include "vernier/picture/Hatch.h"
#include "vernier/picture/Quantise.h"
#include "vernier/plan/Volumetric.h"
#include "vernier/volume/Voi.h"

namespace vernier::ui {
namespace {

Picture withAlpha(const Picture& rgb) {
  Picture out;
  out.width = rgb.width, out.height = rgb.height, out.channels = 4;
  const std::size_t n = static_cast<std::size_t>(rgb.width) * static_cast<std::size_t>(rgb.height);
  out.pixels.resize(4 * n);
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(rgb.pixels.data() + 3 * i, 3, out.pixels.data() + 4 * i);
    out.pixels[4 * i + 3] = 255;
  }
  return out;
}

const Layer* topSlice(const Scene& scene) {
  for (auto layer = scene.layers.rbegin(); layer != scene.layers.rend(); ++layer)
    if (std::holds_alternative<SliceLayer>(*layer)) return &*layer;
  return nullptr;
}

// What the tile shows, and how values become grey.
Result<void> describeSource(app::Session& session, FinishedPicture& out) {
  if (const ImageLayer* layer = imageOf(out.scene)) {
    auto frame = session.image(layer->source, layer->index);
    if (!frame) return frame.error();
    out.frame = std::move(*frame);
    const ImageFrameInfo& info = out.frame->info();
    out.window = layer->window && usableWindow(*layer->window) ? *layer->window
                 : !info.windows.empty()                       ? info.windows.front()
                                                               : info.autoWindow;
    out.inverted = layer->invert != info.inverted;
    out.findings = info.findings;
    out.windowFacts = {info.unit, info.windows, info.voiLuts, info.autoWindow, {}};
  } else if (const Layer* through = lookOf(out.scene) ? lookOf(out.scene) : topSlice(out.scene)) {
    auto volume = session.volume(*volumeOf(*through));
    if (!volume) return volume.error();
    out.volume = std::move(*volume);
    const VolumeInfo& info = out.volume->info();
    Layer shown = *through;
    const auto* window = windowOf(shown);
    const bool* inverted = inversionOf(shown);
    const bool colour = out.volume->isColour();
    const VoiWindow usual = session.defaultWindowOf(*out.volume);
    const VoiWindow first = lookOf(out.scene) && !colour ? wholeRange(*out.volume) : usual;
    out.window = window && *window && usableWindow(**window) ? **window : first;
    out.inverted = inverted && *inverted != info.inverted;
    out.findings = info.findings;
    out.windowFacts = {info.unit, info.windows, {}, info.windows.empty() ? usual : VoiWindow{}, {}};
    if (const auto range = out.volume->modalityRange()) out.windowFacts.range = {range->min, range->max};
  }
  return {};
}

// Fewer pixels than the picture has, with the same picture in them: its height is what cameras go by.
View coarser(View view, int coarse) {
  if (coarse < 2) return view;
  const int height = (view.height_px + coarse - 1) / coarse;
  const double perPixel = static_cast<double>(view.height_px) / height;
  view.width_px = static_cast<int>(std::ceil(view.width_px / perPixel));
  view.height_px = height;
  return view;
}

Depths depthsOf(const Images& images, const View& shown) {
  return {images.width, images.height, static_cast<double>(shown.height_px) / images.height, images.depth};
}

Result<void> finish(app::Session& session, const app::Rendered& r, double scale, FinishedPicture& out) {
  Picture picture = quantise(r.frame.images);
  if (lookOf(out.scene)) {
    out.depths = depthsOf(r.frame.images, out.view);
    if (picture.height != out.view.height_px)
      picture = enlarged(picture, out.depths.perPixel, out.view.width_px, out.view.height_px);
  }
  if (const SliceLayer* slice = sliceOf(out.scene); slice && out.volume) {
    const Result<SlicePicture> place = slicePicture(*slice, out.scene.camera, out.view, *out.volume);
    if (!place) return place.error();
    hatchGaps(picture, r.frame.images, *place, out.volume->grid());
  }
  Result<Annotations> a = app::annotationsFor(session, out.scene, out.view, r, std::nullopt);
  if (!a) return a.error();
  out.measured = r.error.has_value();
  if (!out.measured) a->status.insert(a->status.begin(), TextLine{"draft", "draft", Tone::Normal});
  if (!a->status.empty()) out.errorLine = a->status.front().text;
  if (r.error) out.errorText = quality::errorSentence(*r.error);
  out.layout = layoutAnnotations(*a, out.view.width_px, out.view.height_px, scale);
  drawLayout(picture, out.layout);
  out.rgba = withAlpha(picture);
  out.engine = r.frame.engine + ", " + r.frame.renderer;
  out.render_ms = r.frame.render_ms;
  return {};
}

}  // namespace

RenderService::RenderService(std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this](std::stop_token stop) { loop(stop); }) {}

RenderService::~RenderService() {
  thread_.request_stop();
  const std::lock_guard lock(mutex_);
  refining_.request_stop();
}

void RenderService::post(RenderRequest request) {
  const std::lock_guard lock(mutex_);
  Slot& slot = slots_[static_cast<std::size_t>(request.tile)];
  slot.request = std::move(request);
  slot.stage = Stage::Draft;
  lastPost_ = std::chrono::steady_clock::now();
  refining_.request_stop();
  changed_.notify_all();
}

void RenderService::forget(int tile) {
  const std::lock_guard lock(mutex_);
  Slot& slot = slots_[static_cast<std::size_t>(tile)];
  slot.request.reset();
  slot.finished.reset();
  slot.stage = Stage::Done;
  slot.msPerPixel.reset();
  if (working_ == tile) refining_.request_stop();
}

RenderService::Slot* RenderService::due(Stage stage) {
  for (Slot& slot : slots_)
    if (slot.stage == stage && slot.request) return &slot;
  return nullptr;
}

// Pixels of the screen for one of the draft.
int RenderService::coarseOf(const Slot& slot) {
  if (!lookOf(slot.request->scene)) return 1;
  if (!slot.msPerPixel) return 2;
  const View& v = slot.request->view;
  const double whole_ms = *slot.msPerPixel * v.width_px * v.height_px;
  return std::clamp(static_cast<int>(std::ceil(std::sqrt(whole_ms / kDraft_ms))), 1, kCoarsest);
}

std::vector<FinishedPicture> RenderService::take() {
  const std::lock_guard lock(mutex_);
  std::vector<FinishedPicture> all;
  for (Slot& slot : slots_)
    if (slot.finished) {
      all.push_back(std::move(*slot.finished));
      slot.finished.reset();
    }
  return all;
}

bool RenderService::waitForDrafts(std::chrono::milliseconds limit) const {
  std::unique_lock lock(mutex_);
  return drafted_.wait_for(lock, limit, [&] {
    return std::none_of(slots_.begin(), slots_.end(), [](const Slot& s) { return s.stage == Stage::Draft; });
  });
}

bool RenderService::idle() const {
  const std::lock_guard lock(mutex_);
  return !working_ && std::none_of(slots_.begin(), slots_.end(),
                                   [](const Slot& s) { return s.stage != Stage::Done || s.finished; });
}

std::uint64_t RenderService::drawn() const {
  const std::lock_guard lock(mutex_);
  return drawn_;
}

FinishedPicture RenderService::draw(const RenderRequest& request, Stage stage, int coarse, Frame& reuse,
                                    std::stop_token stop) {
  const bool measure = stage == Stage::Refine;
  FinishedPicture out;
  out.tile = request.tile, out.generation = request.generation;
  out.scene = request.scene, out.view = request.view;
  const auto work = [&]() -> Result<void> {
    if (const Result<void> known = describeSource(*request.session, out); !known) return known.error();
    Quality quality;
    quality.level = measure ? QualityLevel::Review : QualityLevel::Draft;
    app::RenderOptions options;
    options.measure = measure;
    const View view = coarser(request.view, coarse);
    const bool hurries = !measure && lookOf(request.scene);
    if (hurries) quality.minFps = 1000.0 / kDraft_ms;
    Result<app::Rendered> r =
        request.session->render(request.scene, view, quality, options, stop, std::move(reuse));
    if (!r) return r.error();
    if (hurries) r->plan.notes.clear();  // of a rate that nobody asked for; the refined picture has its own
    const Result<void> done = finish(*request.session, *r, request.scale, out);
    reuse = std::move(r->frame);
    return done;
  };
  if (const Result<void> done = guarded("picture", work); !done) out.error = done.error();
  return out;
}

void RenderService::loop(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    Slot* slot = nullptr;
    auto begin = lastPost_;
    for (const auto& [stage, after_ms] :
         {std::pair{Stage::Draft, 0}, {Stage::Sharpen, kSharpen_ms}, {Stage::Refine, kIdle_ms}})
      if ((slot = due(stage))) {
        begin = lastPost_ + std::chrono::milliseconds(after_ms);
        break;
      }
    if (!slot) {
      changed_.wait(lock, stop, [&] { return due(Stage::Draft) != nullptr; });
      continue;
    }
    if (std::chrono::steady_clock::now() < begin) {
      const auto seen = lastPost_;
      changed_.wait_until(lock, stop, begin, [&] { return lastPost_ != seen; });
      continue;
    }
    const Stage stage = slot->stage;
    const int coarse = stage == Stage::Draft ? coarseOf(*slot) : 1;
    const RenderRequest request = *slot->request;
    working_ = request.tile;
    refining_ = std::stop_source();
    if (stop.stop_requested()) refining_.request_stop();  // closed meanwhile
    const bool draft = stage == Stage::Draft;
    const std::stop_token cancel = draft ? stop : refining_.get_token();
    lock.unlock();
    FinishedPicture picture = draw(request, stage, coarse, slot->reuse, cancel);
    lock.lock();
    working_.reset();
    // A newer request, or one that was forgotten, takes no picture of the old one; a draft is shown all the
    // same, so that the picture moves while requests come faster than pictures.
    const bool current = slot->request && slot->request->generation == request.generation;
    const bool cancelled = picture.error && picture.error->code == ErrorCode::Cancelled;
    if (current && !cancelled)
      slot->stage = picture.error || stage == Stage::Refine ? Stage::Done
                    : coarse > 1                            ? Stage::Sharpen
                                                            : Stage::Refine;
    if (slot->request && stage != Stage::Refine && picture.depths.width > 0)
      slot->msPerPixel =
          picture.render_ms / (static_cast<double>(picture.depths.width) * picture.depths.height);
    const bool useless = draft ? cancelled || (picture.error && !current) : picture.error || !current;
    if (useless || !slot->request) continue;  // a refinement that fails leaves the draft in sight
    ++drawn_;
    slot->finished = std::move(picture);
    drafted_.notify_all();
    lock.unlock();
    wake_();
    lock.lock();
  }
}

}  // namespace vernier::ui
