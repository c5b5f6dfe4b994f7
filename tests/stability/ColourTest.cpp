// SPDX-License-Identifier: GPL-3.0-or-later
// Extreme cases B14 (one inversion in all) and B15 (palette faults), from files to the picture; and slices of
// colour volumes against the double reference.
#include <cmath>

#include "MakeDicom.h"
#include "MakePresentation.h"
#include "RenderForTest.h"
#include "TestData.h"
#include "vernier/base/Random.h"
#include "vernier/quality/Badge.h"
#include "vernier/quality/Reference.h"
#include "vernier/study/Load.h"
#include "vernier/volume/Build.h"

namespace vernier {
namespace {

using namespace vernier::test;

// One row of 256 pixels, 0 to 255.
DicomSlice rampSlice() {
  DicomSlice s;
  s.rows = 1;
  s.columns = 256;
  s.bitsAllocated = s.bitsStored = 8;
  s.isSigned = false;
  s.modality = "OT";
  s.sopClassUid = "1.2.840.10008.5.1.4.1.1.7";
  s.hasGeometry = false;
  for (int n = 0; n < 256; ++n) s.pixels.push_back(n);
  s.set = {{"0028,1050", "128"}, {"0028,1051", "256"}};
  return s;
}

std::string descending() {
  std::vector<unsigned> entries;
  for (unsigned n = 0; n < 256; ++n) entries.push_back(255 - n);
  return lutWords(entries);
}

// What a file and, when there is one, its presentation state show; `error` takes the largest one measured.
struct Shown {
  std::vector<double> levels;  // red, of 255
  double error = 0;
};
Shown shownOf(const DicomSlice& image, const std::optional<PresentationFile>& state, bool ownVoiLut) {
  const TempDir dir;
  writeDicom(dir.path() / "a.dcm", image);
  if (state) writePresentation(dir.path() / "p.dcm", *state);
  const auto set = scanStudy({dir.path().string()});
  EXPECT_TRUE(set.ok());
  Sources sources;
  for (const Series& s : set->series)
    if (!s.stacks.empty()) {
      const auto frame = buildImageFrame(*set, s, s.stacks[0], 0);
      EXPECT_TRUE(frame.ok()) << (frame.ok() ? "" : frame.error().text());
      if (frame) sources.images[{"i", 0}] = *frame;
    }
  ImageLayer layer;
  layer.source = "i";
  if (ownVoiLut) layer.voiLut = 0;
  if (state) {
    layer.presentation = state->sopInstanceUid;
    sources.presentations[layer.presentation] = std::make_shared<PresentationState>(set->presentations.at(0));
  }
  Scene scene;
  scene.layers = {layer};
  View view;
  view.width_px = image.columns;
  view.height_px = 1;
  const auto drawn = renderWith("image.native", scene, view, sources);
  EXPECT_TRUE(drawn.ok()) << (drawn.ok() ? "" : drawn.error().text());
  Shown out;
  if (!drawn) return out;
  for (int x = 0; x < image.columns; ++x)
    out.levels.push_back(255.0 *
                         static_cast<double>(drawn->frame.images.colour[static_cast<std::size_t>(4 * x)]));
  const auto error = quality::measureError(drawn->frame, scene, view, sources, {});
  EXPECT_TRUE(error.ok());
  if (error) out.error = error->max;
  return out;
}

TEST(B14, OneInversionInAll) {
  struct Row {
    const char* photometric;
    const char* ownShape;  // of the image
    bool ownLut;           // the image's own VOI LUT, which descends
    const char* state;     // "", or the presentation state's shape, or "LUT" (which descends)
    bool stateLut;         // a descending VOI LUT in the presentation state
    bool inverted;         // what is to be seen: 255 - stored
  };
  const Row rows[] = {
      {"MONOCHROME2", "", false, "", false, false},
      {"MONOCHROME1", "", false, "", false, true},
      {"MONOCHROME1", "INVERSE", false, "", false, true},  // says the same thing twice
      {"MONOCHROME2", "INVERSE", false, "", false, true},
      {"MONOCHROME2", "IDENTITY", true, "", false, true},
      {"MONOCHROME1", "INVERSE", true, "", false, false},  // a VOI LUT that descends is undone by MONOCHROME1
      {"MONOCHROME1", "INVERSE", false, "IDENTITY", false,
       false},  // a presentation state overrides the image
      {"MONOCHROME1", "INVERSE", false, "INVERSE", false, true},
      {"MONOCHROME1", "INVERSE", false, "IDENTITY", true, true},
      {"MONOCHROME1", "INVERSE", false, "INVERSE", true, false},
      {"MONOCHROME1", "INVERSE", false, "LUT", false, true},
      {"MONOCHROME2", "", false, "LUT", true, false},
      {"MONOCHROME1", "INVERSE", true, "LUT", true,
       false}};  // the layer asks for the image's LUT: it replaces the state's
  for (const Row& row : rows) {
    SCOPED_TRACE(std::string(row.photometric) + " " + row.ownShape + (row.ownLut ? " own LUT" : "") +
                 " state " + row.state + (row.stateLut ? " VOI LUT" : ""));
    DicomSlice image = rampSlice();
    image.photometric = row.photometric;
    if (*row.ownShape) image.set.push_back({"2050,0020", row.ownShape});
    image.sequences = {"VOILUTSequence[0].LUTDescriptor=256\\0\\8",
                       "VOILUTSequence[0].LUTData=" + descending()};
    std::optional<PresentationFile> state;
    if (*row.state) {
      state.emplace();
      if (std::string(row.state) == "LUT")
        state->set = {"PresentationLUTSequence[0].LUTDescriptor=256\\0\\8",
                      "PresentationLUTSequence[0].LUTData=" + descending()};
      else
        state->set = {std::string("PresentationLUTShape=") + row.state};
      const std::string voi = "SoftcopyVOILUTSequence[0].";
      if (row.stateLut) {
        state->set.push_back(voi + "VOILUTSequence[0].LUTDescriptor=256\\0\\8");
        state->set.push_back(voi + "VOILUTSequence[0].LUTData=" + descending());
      } else {
        state->set.push_back(voi + "WindowCenter=128");
        state->set.push_back(voi + "WindowWidth=256");
      }
    }
    const Shown shown = shownOf(image, state, row.ownLut);
    EXPECT_LE(shown.error, 1e-4);
    for (int n = 0; n < 256; ++n)
      ASSERT_NEAR(shown.levels[static_cast<std::size_t>(n)], row.inverted ? 255 - n : n, 1e-4) << n;
  }
}

DicomSlice paletteSlice(std::vector<std::uint16_t> descriptor, std::size_t entries) {
  DicomSlice s = rampSlice();
  s.set.clear();
  s.photometric = "PALETTE COLOR";
  std::vector<std::uint16_t> table;
  for (std::size_t n = 0; n < entries; ++n) table.push_back(static_cast<std::uint16_t>(65535 - 300 * n));
  for (int c = 1; c <= 3; ++c) {
    s.words.push_back({"0028,110" + std::to_string(c), descriptor});
    s.words.push_back({"0028,120" + std::to_string(c), table});
  }
  return s;
}

TEST(B15, AnIndexPastThePaletteTakesItsEnd) {
  const Shown shown = shownOf(paletteSlice({100, 20, 16}, 100), {}, false);
  ASSERT_EQ(shown.levels.size(), 256u);
  EXPECT_LE(shown.error, 1e-4);
  for (int n = 0; n < 256; ++n)
    ASSERT_NEAR(shown.levels[static_cast<std::size_t>(n)], (65535 - 300 * std::clamp(n - 20, 0, 99)) / 257.0,
                1e-3)
        << n;
}

TEST(B15, ADescriptorOfZeroMeans65536Entries) {
  DicomSlice s = paletteSlice({0, 0, 16}, 65536);
  s.bitsAllocated = s.bitsStored = 16;
  s.pixels[255] = 65535;
  const Shown shown = shownOf(s, {}, false);
  ASSERT_EQ(shown.levels.size(), 256u);
  EXPECT_NEAR(shown.levels[100], (65535 - 30000) / 257.0, 1e-3);
  EXPECT_NEAR(shown.levels[255], std::uint16_t(65535 - 300u * 65535u) / 257.0, 1e-3);
}

TEST(B15, CountsThatLieAreRefusedWithASentence) {
  const auto refused = [](const DicomSlice& s) {
    const TempDir dir;
    writeDicom(dir.path() / "a.dcm", s);
    const auto set = scanStudy({dir.path().string()});
    ASSERT_TRUE(set.ok());
    ASSERT_TRUE(set->instances.at(0).pixelError);
    EXPECT_EQ(set->instances[0].pixelError->code, ErrorCode::PixelDescriptionInvalid);
    EXPECT_GT(set->instances[0].pixelError->sentence.size(), 40u);
    EXPECT_TRUE(set->series[0].stacks.empty());
  };
  refused(paletteSlice({256, 0, 16}, 100));
  refused(paletteSlice({0, 0, 16}, 100));   // 65536 declared
  refused(paletteSlice({256, 0, 0}, 256));  // entries of no bits
  refused(paletteSlice({256, 0, 33}, 256));
  for (const std::vector<std::uint16_t>& segments : {std::vector<std::uint16_t>{0, 300, 1, 2},
                                                     {1, 256, 9},
                                                     {0, 1, 5, 2, 9, 0, 0},
                                                     {0, 1, 5, 2, 0xFFFF, 0xFFFF, 0xFFFF},
                                                     {7, 256, 1},
                                                     {0, 1, 5, 1, 0xFFFF, 9}}) {
    DicomSlice s = paletteSlice({256, 0, 16}, 1);
    for (auto& [tag, words] : s.words)
      if (tag.starts_with("0028,120")) {
        tag = "0028,122" + tag.substr(8);
        words = segments;
      }
    refused(s);
  }
}

// --- slices of colour volumes

std::shared_ptr<const Volume> noise(int samples, glm::dvec3 spacing_mm) {
  VolumeInfo info;
  info.grid.columns = 17;
  info.grid.rows = 13;
  info.grid.slices = 11;
  for (int a = 0; a < 3; ++a) info.grid.patientFromVoxel.linear[a][a] = spacing_mm[a];
  std::vector<std::byte> bytes(static_cast<std::size_t>(17 * 13 * 11 * samples));
  for (std::size_t n = 0; n < bytes.size(); ++n) bytes[n] = static_cast<std::byte>(randomBits(7, n) & 255);
  const auto v = Volume::makeColour(std::move(info), samples, bytes);
  EXPECT_TRUE(v.ok());
  return *v;
}

TEST(ColourSlice, MeetsTheReferenceChannelByChannel) {
  for (const int samples : {3, 4})
    for (const Interpolation interpolation : {Interpolation::Linear, Interpolation::Nearest})
      for (const double slab_mm : {0.0, 4.0})
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
          const auto unit = [&](std::uint64_t n) { return 2 * randomUnit(seed, n) - 1; };
          Sources sources;
          sources.volumes["v"] = noise(samples, {1, 1.5, 2});
          SliceLayer layer;
          layer.source = "v";
          layer.interpolation = interpolation;
          layer.slab = {slab_mm, seed % 3 == 0   ? SlabMode::Max
                                 : seed % 3 == 1 ? SlabMode::Mean
                                                 : SlabMode::Min};
          layer.plane.normal = PatientVec(unit(0), unit(1), unit(2));
          layer.plane.up = PatientVec(unit(3), unit(4), unit(5));
          layer.plane.point = sources.volumes["v"]->grid().centre();
          layer.invert = seed == 4;
          Scene scene;
          scene.layers = {layer};
          scene.background = {0.25, 0.5, 0.75};
          View view;
          view.width_px = 40;
          view.height_px = 36;
          const auto drawn = renderWith("mpr.native", scene, view, sources);
          ASSERT_TRUE(drawn.ok()) << drawn.error().text();
          quality::ErrorOptions options;
          options.reference.kind = quality::ErrorKind::Implementation;
          const auto error = quality::measureError(drawn->frame, scene, view, sources, options);
          ASSERT_TRUE(error.ok()) << error.error().text();
          // Nearest neighbours change hands where rounding decides: edges only.
          if (interpolation == Interpolation::Linear) {
            EXPECT_LE(error->p99, 0.01) << samples << " slab " << slab_mm << " seed " << seed;
          } else {
            EXPECT_LE(error->p50, 0.01);
          }
          EXPECT_GT(error->n, 300u);
          for (const float v : drawn->frame.images.values) ASSERT_TRUE(std::isnan(v));
        }
}

TEST(ColourSlice, ThroughVoxelCentresItIsTheStoredColour) {
  Sources sources;
  const auto volume = noise(4, {1, 1, 1});
  sources.volumes["v"] = volume;
  SliceLayer layer;
  layer.source = "v";
  layer.plane = {PatientPoint(8, 6, 5), PatientVec(0, 0, -1), PatientVec(0, -1, 0)};
  Scene scene;
  scene.layers = {layer};
  scene.camera.height_mm = 13;
  View view;
  view.width_px = 17;
  view.height_px = 13;
  const auto drawn = renderWith("mpr.native", scene, view, sources);
  ASSERT_TRUE(drawn.ok());
  for (int y = 0; y < 13; ++y)
    for (int x = 0; x < 17; ++x) {
      const auto want = volume->rgba(x, y, 5);
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(drawn->frame.images.colour[static_cast<std::size_t>(4 * (x + 17 * y)) + c],
                    want[c] / 255.0 * want[3] / 255.0, 1e-6);
    }
}

TEST(ColourSlice, OnlyWhatDrawsColoursIsTaken) {
  Sources sources;
  sources.volumes["v"] = noise(3, {1, 1, 1});
  SliceLayer layer;
  layer.source = "v";
  layer.plane.point = sources.volumes["v"]->grid().centre();
  layer.window = VoiWindow{40, 400, VoiFunction::Linear, ""};
  Scene scene;
  scene.layers = {layer};
  TestHost& host = TestHost::instance();
  const auto plan = makePlan(scene, {}, {}, host.capabilities, {}, sources, host.registry);
  ASSERT_TRUE(plan.ok()) << plan.error().text();
  EXPECT_EQ(plan->passes.at(0).technique, "mpr.native");
  EXPECT_EQ(plan->notes, (std::vector<std::string>{"window not applied: a colour volume has none"}));
  for (const Technique* t : host.registry.drawing("slice")) {
    if (t->engine != Engine::Gl) continue;
    bool said = false;
    for (const Rejected& r : plan->rejected)
      said |= r.what == t->name && r.why.find("grey volumes only") != std::string::npos;
    EXPECT_TRUE(said || !host.capabilities.gl) << t->name;
  }
}

}  // namespace
}  // namespace vernier
