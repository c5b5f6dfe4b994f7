// SPDX-License-Identifier: GPL-3.0-or-later
// Session: the one door. Opens studies, builds volumes, plans and renders; no globals, no argv, no exit().
// Command line, window, goldens, fuzzers and benchmarks use only this.
//
// Threads: open(), use() and bridgeGaps() are called while nothing else of the session runs. Then everything
// else may be called from several threads at once: so the window scrolls single frames while another thread
// builds the volume. A volume is built once: who asks for it meanwhile waits. Pictures are planned and drawn
// one after the other, on the session's render thread, which alone touches GL; errors are measured beside it.
// costs() is for one thread.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "PluginHost.h"
#include "vernier/base/Progress.h"
#include "vernier/gpu/Device.h"
#include "vernier/plan/MakePlan.h"
#include "vernier/quality/Ladder.h"
#include "vernier/study/Load.h"
#include "vernier/volume/SurfaceFile.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier::app {

// Breaks pictures on purpose, so that tests can show that a quality suite notices. What is said of a picture
// (letters, error) is still that of the scene that was asked for. Absent in the program.
struct Sabotage {
  std::function<void(Scene&, const View&, const Sources&)> scene;  // before it is planned
  std::function<void(Plan&)> plan;                                 // before it is drawn
  std::function<void(const Plan&, Images&)> picture;               // as drawn
};

struct SessionOptions {
  // How the render thread gets its GL device; absent: gpu::Device::make.
  std::function<Result<std::unique_ptr<gpu::Device>>()> makeDevice;
  int threads = 0;                         // 0 = all cores
  std::uint64_t memory_mb = 0;             // 0 = half of what is free
  std::vector<std::string> pluginFolders;  // besides the install folder
  Sabotage sabotage;
};

// One picture with all that is known of it.
struct Rendered {
  Frame frame;
  Plan plan;
  std::optional<quality::ErrorReport> error;  // when asked for
  double step = 1;                            // Quality::step that the picture was drawn with
  bool goalReached = true;                    // false: the closed loop stopped above the goal
  std::string goalNote;                       // "goal not reached: 0.9", or empty
  std::vector<quality::LadderRung> rungs;     // all steps of the closed loop that were drawn and measured
};

struct RenderOptions {
  bool measure = true;  // measure the error of the picture
  quality::ErrorOptions error;
  std::optional<double> goal;  // levels of 255; absent: the quality level's own (review 2, reference 0.5)
  std::optional<double> timeLimit_ms;  // of the closed loop; absent: 5 s at review, 60 s at reference
  bool explain = false;                // as in plan()
};

// Which stack, or which volume file, of what was opened. Sources in scenes are named "" (the chosen one),
// "UID", "UID#stack" or by a volume file's name.
struct StackChoice {
  std::size_t series = 0, stack = 0;
  std::optional<std::size_t> volumeFile =
      std::nullopt;  // position in Session::volumeFiles(); series and stack then mean nothing
  friend auto operator<=>(const StackChoice&, const StackChoice&) = default;
};

class Session {
 public:
  explicit Session(const SessionOptions&);
  ~Session();

  // Files or folders: DICOM and volume files. Reads headers only. Replaces what was open.
  Result<void> open(const std::vector<std::string>& paths, const ProgressFn& = {}, std::stop_token = {});
  const StudySet& study() const;
  const std::vector<VolumeFile>& volumeFiles() const;  // what of it is no DICOM, but a volume file
  bool isVolumeFile() const;                           // one volume file and nothing else

  // `series`: "" = the largest stack or volume file that can be shown in 3-D, else the largest image stack
  // (segmentations and doses only where there is nothing else); a Series Instance UID or a volume file's
  // name; or the position in `info`, counted from 1, volume files after the series; a series with an optional
  // "#stack" counted from 1.
  Result<StackChoice> choose(const std::string& series) const;
  // A source name that stands for this stack whatever use() says: "UID#stack", or "position#stack" where the
  // UID is empty or not unique.
  std::string sourceName(StackChoice) const;
  void use(StackChoice);  // what source "" means from now on
  const Series* seriesOf(StackChoice) const;
  const Stack* stackOf(StackChoice) const;
  const VolumeFile* volumeFileOf(StackChoice) const;

  // Builds (once) what a source names. The images of a volume file are its slices as they stand in the file.
  Result<std::shared_ptr<const Volume>> volume(const std::string& source, const ProgressFn& = {},
                                               std::stop_token = {});
  // What volume() would give at once; nullptr where it has not been built.
  std::shared_ptr<const Volume> readyVolume(const std::string& source) const;
  // Single frames are kept up to kKeptFrames_bytes, the least recently used ones go.
  Result<std::shared_ptr<const ImageFrame>> image(const std::string& source, std::int64_t index);
  // A presentation state of the study by its SOP Instance UID; nullptr where there is none.
  std::shared_ptr<const PresentationState> presentation(const std::string& sopInstanceUid) const;
  VoiWindow defaultWindowOf(
      const Volume&) const;  // the file's, else the automatic one; found once per volume
  Result<std::int64_t> imageCount(const std::string& source) const;
  void bridgeGaps(bool);

  // Surfaces stand beside what was opened, under the names that scenes use. Without a name: the file's, with
  // "#2"... where another file has it already.
  Result<std::string> addSurface(const std::string& path, std::stop_token = {});
  Result<void> addSurface(const std::string& name, const std::string& path, std::stop_token = {});
  std::vector<std::string> surfaceFiles() const;                              // their paths
  std::shared_ptr<const SurfaceFile> surface(const std::string& name) const;  // nullptr: none of this name

  // Of volume files: which of several volumes; of lists of images: the span of all slices (BuildOptions).
  void readVolumeFilesWith(std::optional<std::int64_t> frame, std::optional<double> zSpan);
  // What source "" stands for, once chosen: a stack of a series, or a volume file; nullptr for the other and
  // before.
  const Series* chosenSeries() const;
  const Stack* chosenStack() const;
  const VolumeFile* chosenVolumeFile() const;
  std::shared_ptr<const Volume> builtVolume() const;  // of source "", if it has been built
  int threadCount() const;
  std::uint64_t derivedBytes() const;  // textures, windows and other derived data held after the last frame

  // With `explain` GL is looked for even where the plan does not need it, so that its costs stand among the
  // rejected.
  Result<Plan> plan(const Scene&, const View&, const Quality&, bool explain = false);
  // `reuse` gives its buffers to the new frame. The closed loop of `review` and `reference` lowers
  // quality.step until the measured error meets the goal; without measuring, one frame at quality.step.
  // When GL fails while it draws: a lost context is made anew once; what still fails is drawn natively,
  // unless GL was asked for. Either stands in the plan's notes. Scene and study are untouched.
  Result<Rendered> render(const Scene&, const View&, const Quality&, const RenderOptions&,
                          std::stop_token = {}, Frame reuse = {});

  // GL is looked for only when `withGl` (tens of ms); until then Capabilities::gl is false and glWhyNot says
  // so.
  const Capabilities& capabilities(bool withGl);
  const std::vector<PluginInfo>& plugins() const;
  bool draws(const std::string& layerKind) const;  // is there a technique for it
  // The panel of a plugin's layer kind (plan/Panel.h), to be drawn by the window; nullptr: none.
  const Panel* panelOf(const std::string& kind) const;
  CostTable& costs();
  MemoryBudget& budget();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vernier::app
