// SPDX-License-Identifier: GPL-3.0-or-later
// What a Session holds. Private to Session.cpp (what is opened) and SessionRender.cpp (what is drawn).
#pragma once
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>

#include "RenderThread.h"
#include "Session.h"
#include "vernier/base/Cache.h"
#include "vernier/gpu/Device.h"

namespace vernier::app {

struct Session::Impl {
  explicit Impl(const SessionOptions& o)
      : makeDevice(o.makeDevice),
        sabotage(o.sabotage),
        budget(o.memory_mb > 0 ? o.memory_mb << 20 : MemoryBudget::halfOfFreeBytes()),
        plugins([this] { return device(); }, &derived) {
    std::vector<std::string> folders{PluginHost::installFolder()};
    folders.insert(folders.end(), o.pluginFolders.begin(), o.pluginFolders.end());
    plugins.load(folders);
  }
  ~Impl() {
    renderThread.run([&] { glDevice.reset(); });  // GL objects are freed where they were made
  }

  Result<gpu::Device*> device() {
    if (!glDevice) {
      Result<std::unique_ptr<gpu::Device>> made = makeDevice ? makeDevice() : gpu::Device::make();
      if (!made) return made.error();
      glDevice = std::move(*made);
    }
    return glDevice.get();
  }
  const Capabilities& look(bool withGl);
  // The scene with the window of each slice layer that names none: found once per volume, not once per frame.
  Scene withWindows(Scene, const Sources&);
  VoiWindow windowOf(const Volume&);
  std::optional<std::size_t> volumeFileNamed(const std::string&) const;
  std::shared_ptr<const Volume> ready(StackChoice) const;
  Result<std::shared_ptr<const ImageFrame>> buildFrame(StackChoice, const Series&, const Stack&,
                                                       std::int64_t index);
  Result<void> checkShown(const Scene&, const View&) const;
  Result<Sources> sourcesFor(Session&, const Scene&, std::stop_token);
  Result<Plan> planFor(const Scene&, const View&, const Quality&, const Sources&, bool explain);
  Scene withoutAbsentLayers(Scene) const;
  // The truths of plugins' own layers, by place; an Error when one brings none, so that no error can be
  // measured.
  Result<std::map<std::size_t, PixelTruth>> truthsOf(const Scene& shown, const View&, const Quality&,
                                                     const Sources&);
  Result<Frame> execute(const Plan&, const View&, const Rgb& background, std::stop_token, Frame reuse);

  // One picture of a scene: the plan it was drawn by, with a note when GL had to be given up on the way.
  struct Asked {
    const Scene& scene;
    const View& view;
    const Quality& quality;
    const Sources& sources;
  };
  Result<Frame> drawOrRecover(const Asked&, Plan&, std::stop_token, Frame reuse);

  std::function<Result<std::unique_ptr<gpu::Device>>()> makeDevice;
  const Sabotage sabotage;
  bool deviceWasRebuilt = false;
  static constexpr std::uint64_t kKeptFrames_bytes = std::uint64_t{64} << 20;
  static constexpr std::uint64_t kDerivedBytes = std::uint64_t{1} << 30;  // at least
  MemoryBudget budget;
  DerivedCache derived{std::max(kDerivedBytes, budget.limit() / 2)};
  StudySet study;
  std::vector<VolumeFile> volumeFiles;
  std::optional<StackChoice> chosen;
  Revision opened =
      0;  // counts what was opened: frames of earlier studies are not taken for those of this one
  bool bridge = false;
  std::optional<std::int64_t> fileFrame;
  std::optional<double> zSpan;
  std::map<std::string, std::shared_ptr<const SurfaceFile>> surfaces;
  std::map<std::string, std::string> surfacePaths;
  struct VolumeSlot {
    std::shared_ptr<const Volume> volume;
    bool building = false;  // by one thread; the others wait for `built`
  };
  // Guards volumes and stackWindows.
  mutable std::mutex sourcesMutex;
  std::condition_variable_any built;
  std::map<StackChoice, VolumeSlot> volumes;
  std::map<StackChoice, VoiWindow> stackWindows;  // automatic ones, which take many frames to find
  DerivedCache frames{kKeptFrames_bytes};
  std::mutex drawing;  // held while a picture is planned and drawn
  std::optional<Capabilities> capabilities;
  bool lookedForGl = false;
  std::atomic<std::uint64_t> derivedBytes = 0;
  CostTable costs;
  std::unique_ptr<gpu::Device> glDevice;  // touched on the render thread only
  PluginHost plugins;
  RenderThread renderThread;
};

}  // namespace vernier::app
