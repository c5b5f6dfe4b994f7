// SPDX-License-Identifier: GPL-3.0-or-later
#include "LoadService.h"

#include <algorithm>

#include "vernier/base/Guarded.h"
#include "vernier/picture/Quantise.h"
#include "vernier/plan/Presets.h"

namespace vernier::ui {
namespace {

Result<Picture> drawThumbnail(app::Session& session, const std::string& source, std::stop_token stop) {
  const Result<std::int64_t> count = session.imageCount(source);
  if (!count) return count.error();
  const View view{kThumbnail_px, kThumbnail_px, false};
  app::RenderOptions options;
  options.measure = false;
  Scene scene = stackScene(source, *count / 2, {});
  const Result<app::StackChoice> choice = session.choose(source);
  if (const auto volume = session.readyVolume(source); volume && choice && choice->volumeFile) {
    Result<Scene> axial = presetScene("axial", source, *volume, {});
    if (!axial) return axial.error();
    scene = std::move(*axial);
  }
  Quality quality;
  quality.level = QualityLevel::Draft;
  const Result<app::Rendered> r = session.render(scene, view, quality, options, stop);
  if (!r) return r.error();
  return quantise(r->frame.images);
}

}  // namespace

LoadService::LoadService(app::SessionOptions options, std::function<void()> wake)
    : options_(std::move(options)),
      wake_(std::move(wake)),
      thread_([this](std::stop_token stop) { loop(stop); }) {}

LoadService::~LoadService() {
  thread_.request_stop();
  const std::lock_guard lock(mutex_);
  jobs_.clear();
  stopCurrent_.request_stop();
}

void LoadService::add(Job job) {
  const auto same = [&](const Job& j) { return j.kind == job.kind && j.source == job.source; };
  if (std::any_of(jobs_.begin(), jobs_.end(), same) || (current_ && same(*current_))) return;
  const auto after =
      std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& j) { return j.kind > job.kind; });
  jobs_.insert(after, std::move(job));
  changed_.notify_all();
}

int LoadService::open(std::vector<std::string> paths) {
  const std::lock_guard lock(mutex_);
  const int document = documents_++;
  add({Kind::Open, {document, {}}, std::move(paths), nullptr});
  return document;
}
void LoadService::build(SourceId source, std::shared_ptr<app::Session> session) {
  const std::lock_guard lock(mutex_);
  add({Kind::Volume, std::move(source), {}, std::move(session)});
}
void LoadService::thumbnail(SourceId source, std::shared_ptr<app::Session> session) {
  const std::lock_guard lock(mutex_);
  add({Kind::Thumbnail, std::move(source), {}, std::move(session)});
}

void LoadService::cancel() {
  const std::lock_guard lock(mutex_);
  for (const Job& job : jobs_) {
    const Error cancelled = makeError(ErrorCode::Cancelled, "Loading was cancelled.");
    if (job.kind == Kind::Open) ready_.opened.push_back({job.source.document, job.paths, nullptr, cancelled});
    if (job.kind == Kind::Volume) ready_.volumes.push_back({job.source, nullptr, cancelled});
  }
  std::erase_if(jobs_, [](const Job& j) { return j.kind != Kind::Thumbnail; });
  if (current_ && current_->kind != Kind::Thumbnail) stopCurrent_.request_stop();
}

void LoadService::forget(int document) {
  const std::lock_guard lock(mutex_);
  std::erase_if(jobs_, [&](const Job& j) { return j.source.document == document; });
  if (current_ && current_->source.document == document) stopCurrent_.request_stop();
}

LoadService::Ready LoadService::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(ready_, {});
}

std::optional<LoadProgress> LoadService::progress() const {
  const std::lock_guard lock(mutex_);
  if (!current_ || current_->kind == Kind::Thumbnail) return std::nullopt;
  return progress_;
}

bool LoadService::idle() const {
  const std::lock_guard lock(mutex_);
  return jobs_.empty() && !current_ && ready_.opened.empty() && ready_.volumes.empty() &&
         ready_.thumbnails.empty();
}

void LoadService::advance(std::string_view stage, std::uint64_t done, std::uint64_t total) {
  const auto now = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(mutex_);
    progress_.stage = stage;
    progress_.done = done;
    progress_.total = total;
    if (now - lastWake_ < std::chrono::milliseconds(100)) return;
    lastWake_ = now;
  }
  wake_();
}

void LoadService::run(const Job& job, std::stop_token stop) {
  const ProgressFn progress = [this](std::string_view stage, std::uint64_t done, std::uint64_t total) {
    advance(stage, done, total);
  };
  if (job.kind == Kind::Open) {
    Opened opened{job.source.document, job.paths, std::make_shared<app::Session>(options_), {}};
    const auto read = [&] { return opened.session->open(job.paths, progress, stop); };
    if (const Result<void> done = guarded("open", read); !done)
      opened.error = done.error(), opened.session.reset();
    const std::lock_guard lock(mutex_);
    ready_.opened.push_back(std::move(opened));
  } else if (job.kind == Kind::Volume) {
    BuiltVolume built{job.source, nullptr, {}};
    const auto volume =
        guarded("volume", [&] { return job.session->volume(job.source.name, progress, stop); });
    if (volume)
      built.volume = *volume;
    else
      built.error = volume.error();
    const std::lock_guard lock(mutex_);
    ready_.volumes.push_back(std::move(built));
  } else {
    Thumbnail thumbnail{job.source, {}, {}};
    Result<Picture> picture =
        guarded("thumbnail", [&] { return drawThumbnail(*job.session, job.source.name, stop); });
    if (picture)
      thumbnail.rgba = std::move(*picture);
    else
      thumbnail.error = picture.error();
    const std::lock_guard lock(mutex_);
    ready_.thumbnails.push_back(std::move(thumbnail));
  }
}

void LoadService::loop(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [&] { return !jobs_.empty(); })) {
    current_ = std::move(jobs_.front());
    jobs_.pop_front();
    stopCurrent_ = std::stop_source();
    if (stop.stop_requested()) stopCurrent_.request_stop();  // closed meanwhile
    progress_ = {current_->kind == Kind::Open, current_->source, "", 0, 0};
    const Job job = *current_;
    const std::stop_token token = stopCurrent_.get_token();
    lock.unlock();
    run(job, token);
    lock.lock();
    current_.reset();
    lock.unlock();
    wake_();
    lock.lock();
    if (stop.stop_requested()) return;
  }
}

}  // namespace vernier::ui
