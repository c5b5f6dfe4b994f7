// SPDX-License-Identifier: GPL-3.0-or-later
// Volume rendering on the quality ladder, through the session as a user has it: phantoms and real volumes,
// measured against the double reference.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "Session.h"
#include "TestData.h"
#include "vernier/phantoms/Phantoms.h"
#include "vernier/plan/Presets.h"

namespace vernier::app {
namespace {

struct Case {
  std::string name;
  std::string setting, value;  // of a phantom; "": a real file
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

// Values rise and fall without a bend that a step could see: a raised cosine of many points.
TransferFunction smoothFunction(const Volume::Range& r) {
  TransferFunction f;
  const double from = r.min + 0.2 * (r.max - r.min), to = r.max;
  for (int n = 0; n <= 512; ++n) {
    const double t = n / 512.0, s = 0.5 - 0.5 * std::cos(std::numbers::pi * t);
    f.colours.push_back({std::lerp(from, to, t), {0.5 + 0.5 * s, 0.4 + 0.4 * s, 0.2 + 0.6 * s}});
    f.opacities.push_back({std::lerp(from, to, t), 0.25 * s});
  }
  return f;
}

TransferFunction stepFunction(const Volume::Range& r) {
  const double at = std::lerp(r.min, r.max, 0.45);
  return {{{at, {1, 0.8, 0.6}}}, {{at, 0}, {at, 0.6}}, 1};
}

class VolumeLadder : public ::testing::TestWithParam<Case> {
 protected:
  // False, having said so, where the real volume is not here.
  bool open() {
    std::string path;
    if (GetParam().setting.empty()) {
      const auto file = test::dataDir() / GetParam().name;
      if (!std::filesystem::exists(file)) {
        std::cout << "[  NOTE    ] " << GetParam().name << " is not here: not checked\n";
        return false;
      }
      path = file.string();
    } else {
      PhantomOptions options;
      options.settings[GetParam().setting] = GetParam().value;
      const Result<PhantomInfo> made = writePhantom(GetParam().name, dir_.path(), options);
      EXPECT_TRUE(made) << (made ? "" : made.error().text());
      path = made->data.string();
    }
    SessionOptions options;
    options.pluginFolders = {std::string(VERNIER_BUILD_DIR) + "/lib/vernier/plugins"};
    session_ = std::make_unique<Session>(options);
    EXPECT_TRUE(session_->open({path}));
    const auto choice = session_->choose("");
    EXPECT_TRUE(choice);
    session_->use(*choice);
    volume_ = *session_->volume("");
    range_ = *volume_->modalityRange();
    return true;
  }

  Result<Rendered> draw(const std::string& view, QualityLevel level,
                        const std::optional<TransferFunction>& f = {}) {
    PresetOptions o;
    o.camera.azimuth_deg = 30, o.camera.elevation_deg = 20, o.camera.zoom = 1.3;
    if (f) o.volume.emplace().transfer = f;
    const Result<Scene> scene = presetScene(view, "", *volume_, o);
    if (!scene) return scene.error();
    View size;
    size.width_px = size.height_px = 48;
    Quality quality;
    quality.level = level;
    quality.engine = EngineChoice::Native;
    RenderOptions options;
    options.timeLimit_ms = 120'000;
    options.error.samples = 1024;
    return session_->render(*scene, size, quality, options);
  }

  test::TempDir dir_;
  std::unique_ptr<Session> session_;
  std::shared_ptr<const Volume> volume_;
  Volume::Range range_;
};

TEST_P(VolumeLadder, ReferenceReachesHalfALevelWithASmoothFunction) {
  if (!open()) return;
  for (const char* view : {"dvr", "dvr-shaded"}) {
    const Result<Rendered> r = draw(view, QualityLevel::Reference, smoothFunction(range_));
    ASSERT_TRUE(r) << r.error().text();
    ASSERT_TRUE(r->error && r->error->bound) << view;
    EXPECT_LE(*r->error->bound, 0.5) << view << " at step " << r->step;
    EXPECT_TRUE(r->goalReached) << view << ' ' << r->goalNote;
    EXPECT_GT(r->error->populationShare, 0.05) << "the picture shows something";
  }
}

TEST_P(VolumeLadder, StepsAndSurfacesAreRightApartFromTheirEdges) {
  if (!open()) return;
  for (const char* view : {"dvr", "iso"}) {
    const bool iso = std::string(view) == "iso";
    const Result<Rendered> r =
        draw(view, QualityLevel::Reference, iso ? std::optional<TransferFunction>() : stepFunction(range_));
    ASSERT_TRUE(r) << r.error().text();
    ASSERT_TRUE(r->error) << view;
    EXPECT_LE(r->error->innerP95, 0.5)
        << view << " at step " << r->step << ", edges " << r->error->edge.share;
    EXPECT_LT(r->error->edge.share, 0.8) << view << ": what is no edge is not told apart";
    EXPECT_TRUE(r->goalReached || !r->goalNote.empty()) << view;
  }
}

TEST_P(VolumeLadder, ReviewIsWithinTwoLevelsOrSaysWhatItReached) {
  if (!open()) return;
  for (const char* view : {"dvr", "dvr-shaded", "iso"}) {
    const Result<Rendered> r = draw(view, QualityLevel::Review);
    ASSERT_TRUE(r) << r.error().text();
    ASSERT_TRUE(r->error && r->error->bound) << view;
    if (r->goalReached)
      EXPECT_LE(*r->error->bound, 2.0) << view;
    else
      EXPECT_NE(r->goalNote.find("goal not reached"), std::string::npos) << view;
  }
}

TEST_P(VolumeLadder, ErrorNeverRisesFromDraftToReviewToReference) {
  if (!open()) return;
  const TransferFunction f = smoothFunction(range_);
  double last = 1e9;
  for (QualityLevel level : {QualityLevel::Draft, QualityLevel::Review, QualityLevel::Reference}) {
    const Result<Rendered> r = draw("dvr", level, f);
    ASSERT_TRUE(r) << r.error().text();
    ASSERT_TRUE(r->error);
    EXPECT_LE(r->error->rms, 1.02 * last + 0.01);
    last = r->error->rms;
  }
}

INSTANTIATE_TEST_SUITE_P(Volumes, VolumeLadder,
                         ::testing::Values(Case{"vessels", "scale", "0.5"}, Case{"marschner-lobb", "n", "41"},
                                           Case{"ct-head", "scale", "0.2"},
                                           Case{"vol_engine/engine.nii.gz", "", ""},
                                           Case{"vol_mr_t1_brain/T1.nii.gz", "", ""}),
                         [](const auto& tested) {
                           std::string name = tested.param.name.substr(0, tested.param.name.find('/'));
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

}  // namespace
}  // namespace vernier::app
