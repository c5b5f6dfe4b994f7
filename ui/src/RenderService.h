// SPDX-License-Identifier: GPL-3.0-or-later
// RenderService: one thread that turns scenes into finished 8-bit pictures. The window posts a snapshot with
// a generation number for each tile; the newest wins and older ones are dropped. While requests come, drafts
// are drawn without measuring; when none has come for kIdle_ms, tiles are drawn again at review quality with
// their measured error, which the next request cancels. Never more than one finished picture waits for a
// tile.
//
// Looks through a volume that take longer than kDraft_ms are drafted with fewer pixels and enlarged, so that
// they follow the hand; kSharpen_ms after the last request they are drawn with all of their pixels.
//
// Threads: all public functions from any thread. `wake` is called from the service's thread whenever a
// picture is ready.
#pragma once
#include <array>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "Workspace.h"
#include "vernier/picture/Annotate.h"

namespace vernier::ui {

inline constexpr int kIdle_ms = 180, kSharpen_ms = 60, kDraft_ms = 50;
inline constexpr int kCoarsest = 4;  // pixels of the screen a drafted one, each way

struct RenderRequest {
  int tile = 0;
  std::uint64_t generation = 0;
  std::shared_ptr<app::Session> session;
  Scene scene;  // its volumes are built already
  View view;
  double scale = 1;  // of letters
};

// What a look through a volume has at its pixels. A draft has fewer of them than the picture: `perPixel` is
// the length of one in pixels of the picture, whose middles coincide.
struct Depths {
  int width = 0, height = 0;
  double perPixel = 1;
  std::vector<float> depth_mm;  // along the pixel's ray (CameraPicture), kNothing_mm: nothing there
};

struct FinishedPicture {
  int tile = 0;
  std::uint64_t generation = 0;
  Scene scene;
  View view;
  std::optional<Error> error;  // then there is no picture
  Picture rgba;                // 4 channels
  vernier::Layout layout;      // of what was drawn on it, for hover
  bool measured = false;       // review quality, with its error; else a draft
  std::string errorText;       // the error in a sentence
  std::string errorLine;       // as it stands on the picture
  std::string engine;          // "native, AVX2"
  double render_ms = 0;
  std::vector<Finding> findings;
  std::shared_ptr<const ImageFrame> frame;  // of an image layer
  std::shared_ptr<const Volume> volume;     // of a slice, or of a look through it
  Depths depths;                            // of looks
  VoiWindow window;                         // in use
  bool inverted = false;                    // high values are dark
  WindowFacts windowFacts;
};

class RenderService {
 public:
  explicit RenderService(std::function<void()> wake);
  ~RenderService();  // cancels what runs
  RenderService(const RenderService&) = delete;
  RenderService& operator=(const RenderService&) = delete;

  void post(RenderRequest);
  void forget(int tile);  // drops what waits for the tile and what it shows
  std::vector<FinishedPicture> take();
  // Until every newest scene has its draft, or until `limit`; true when they have.
  bool waitForDrafts(std::chrono::milliseconds limit) const;
  bool idle() const;            // nothing waits, runs or is to be refined
  std::uint64_t drawn() const;  // drafts and refinements finished so far

 private:
  enum class Stage { Done, Draft, Sharpen, Refine };
  struct Slot {
    std::optional<RenderRequest> request;
    Stage stage = Stage::Done;
    std::optional<FinishedPicture> finished;
    Frame reuse;
    std::optional<double> msPerPixel;  // of the last look drawn here at draft quality
  };
  void loop(std::stop_token);
  Slot* due(Stage);
  FinishedPicture draw(const RenderRequest&, Stage, int coarse, Frame& reuse, std::stop_token);
  static int coarseOf(const Slot&);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  mutable std::condition_variable drafted_;
  std::array<Slot, kTiles> slots_;
  std::chrono::steady_clock::time_point lastPost_{};
  std::optional<int> working_;
  std::stop_source refining_;
  std::uint64_t drawn_ = 0;
  std::jthread thread_;
};

}  // namespace vernier::ui
