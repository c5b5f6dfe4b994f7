// SPDX-License-Identifier: GPL-3.0-or-later
// Every stack of the shared data that passes 3-D validation: extrema and probes of the volume against what
// independent tools computed from the files (data/expected). Without the data the tests say so and pass.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "TestData.h"
#include "vernier/study/Load.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/Voi.h"

namespace vernier {
namespace {
using nlohmann::json;

std::map<std::string, json> objectsByFile(const std::string& folder) {
  std::ifstream in(test::dataDir() / "expected" / (folder + ".json"));
  const json all = json::parse(in);
  std::map<std::string, json> out;
  for (const json& o : all.at("objects")) out[o.at("file").get<std::string>()] = o;
  return out;
}

struct Truth {
  double min = INFINITY, max = -INFINITY;
  bool complete = true;
};

Truth truthOf(const StudySet& set, const Stack& stack, const std::map<std::string, json>& objects,
              bool withoutPadding) {
  Truth t;
  for (const SliceRef& ref : stack.slices) {
    const auto it = objects.find(set.files[set.instances[ref.instance].file].shown);
    if (it == objects.end() || !it->second.contains("pixels") ||
        !it->second.at("pixels").contains("modality_min")) {
      t.complete = false;
      return t;
    }
    const json& p = it->second.at("pixels");
    const bool has = withoutPadding && p.contains("modality_min_without_padding");
    t.min = std::min(t.min, p.at(has ? "modality_min_without_padding" : "modality_min").get<double>());
    t.max = std::max(t.max, p.at(has ? "modality_max_without_padding" : "modality_max").get<double>());
  }
  return t;
}

// Stored value at each probe's patient position, in slices that are on the fitted grid to 1e-4 mm or nearly
// so.
int checkProbes(const Volume& v, const StudySet& set, const Stack& stack,
                const std::map<std::string, json>& objects) {
  int checked = 0;
  for (const SliceRef& ref : stack.slices) {
    const auto it = objects.find(set.files[set.instances[ref.instance].file].shown);
    if (it == objects.end() || !it->second.contains("pixels") || !it->second.at("pixels").contains("probes"))
      continue;
    for (const json& p : it->second.at("pixels").at("probes")) {
      if (!p.contains("lps_mm")) continue;
      const json& at = p.at("lps_mm");
      const auto probe =
          probeStored(v, PatientPoint(at[0].get<double>(), at[1].get<double>(), at[2].get<double>()));
      EXPECT_TRUE(probe.has_value());
      if (!probe) continue;
      EXPECT_EQ(probe->i, p.at("column").get<std::int64_t>());
      EXPECT_EQ(probe->j, p.at("row").get<std::int64_t>());
      EXPECT_EQ(probe->stored, p.at("stored").get<double>());
      ++checked;
    }
  }
  return checked;
}

void checkFolder(const std::string& folder, int leastVolumes) {
  const auto objects = objectsByFile(folder);
  const auto set = scanStudy({(test::dataDir() / folder).string()});
  ASSERT_TRUE(set.ok()) << set.error().text();
  int volumes = 0, probes = 0;
  for (const Series& series : set->series)
    for (const Stack& stack : series.stacks) {
      if (!stack.volume3d) continue;
      const auto v = buildVolume(*set, series, stack);
      if (!v.ok() && v.error().code == ErrorCode::NotBuiltYet) continue;  // colour
      ASSERT_TRUE(v.ok()) << series.seriesUid << " " << v.error().text();
      ++volumes;
      EXPECT_TRUE(usableWindow(defaultWindow(**v)));
      probes += checkProbes(**v, *set, stack, objects);
      const Truth t = truthOf(*set, stack, objects, (*v)->info().noData.has_value());
      if (!t.complete || !(*v)->modalityRange()) continue;
      const Volume::Range range = *(*v)->modalityRange();
      const double tolerance =
          (*v)->type() == VoxelType::F32 ? 1e-6 * std::max(std::abs(t.min), std::abs(t.max)) : 1e-9;
      EXPECT_NEAR(range.max, t.max, tolerance) << series.seriesUid;
      const bool blurred = std::any_of((*v)->info().findings.begin(), (*v)->info().findings.end(),
                                       [](const Finding& f) { return f.code == "padding-blurred"; });
      if (blurred) {
        EXPECT_GE(range.min, t.min);
      } else {
        EXPECT_NEAR(range.min, t.min, tolerance) << series.seriesUid;
      }
    }
  EXPECT_GE(volumes, leastVolumes) << folder;
  std::cout << "[  NOTE    ] " << folder << ": " << volumes << " volumes, " << probes << " probes\n";
}

#define VERNIER_FOLDER_TEST(name, folder, least)         \
  TEST(RealVolumes, name) {                              \
    VERNIER_NEEDS_DATA(folder)                           \
    ASSERT_NO_FATAL_FAILURE(checkFolder(folder, least)); \
  }
VERNIER_FOLDER_TEST(CtPhantomHead, "ct_phantom_head_series", 1)
VERNIER_FOLDER_TEST(MrAdc, "mr_adc_series", 1)
VERNIER_FOLDER_TEST(MrBrainFse, "mr_brain_fse_series", 1)
VERNIER_FOLDER_TEST(GeometryFaults, "geometry_faults", 1)
VERNIER_FOLDER_TEST(OneSeriesFourSyntaxes, "codec_one_series_4_syntaxes", 1)
VERNIER_FOLDER_TEST(SegWithSource, "seg_sr_with_source", 0)
VERNIER_FOLDER_TEST(RtStructWithCt, "rtstruct_with_ct", 0)
VERNIER_FOLDER_TEST(DicomdirTree, "dicomdir_tree", 0)

// Every grey image of the folders, as a frame: extrema of what it shows against the files.
void checkFrames(const std::string& folder) {
  const auto objects = objectsByFile(folder);
  const auto set = scanStudy({(test::dataDir() / folder).string()});
  ASSERT_TRUE(set.ok());
  int frames = 0;
  std::map<std::string, int> refused;
  for (const Series& series : set->series)
    for (const Stack& stack : series.stacks)
      for (std::size_t s = 0; s < std::min<std::size_t>(stack.slices.size(), 6); ++s) {
        const Instance& instance = set->instances[stack.slices[s].instance];
        const auto it = objects.find(set->files[instance.file].shown);
        const auto f = buildImageFrame(*set, series, stack, s);
        if (!f.ok()) {
          EXPECT_FALSE(f.error().sentence.empty());
          ++refused[std::string(errorName(f.error().code))];
          continue;
        }
        ++frames;
        EXPECT_TRUE((*f)->isColour() || usableWindow((*f)->info().autoWindow));
        if (it == objects.end() || instance.pixels.framesDeclared != 1) continue;
        const json pixels = it->second.value("pixels", json::object());
        if (!pixels.contains("stored_min") || instance.pixels.isFloat()) continue;
        double low = INFINITY, high = -INFINITY;
        for (std::int64_t y = 0; y < (*f)->info().rows; ++y)
          for (std::int64_t x = 0; x < (*f)->info().columns; ++x) {
            low = std::min(low, (*f)->stored(x, y));
            high = std::max(high, (*f)->stored(x, y));
          }
        EXPECT_EQ(low, pixels.at("stored_min").get<double>()) << it->first;
        EXPECT_EQ(high, pixels.at("stored_max").get<double>()) << it->first;
      }
  EXPECT_GT(frames, 0);
  std::cout << "[  NOTE    ] " << folder << ": " << frames << " frames\n";
  for (const auto& [code, n] : refused) std::cout << "[  NOTE    ]   " << n << " x " << code << "\n";
}

TEST(RealFrames, CodecSmallSingles) {
  VERNIER_NEEDS_DATA("codec_small_singles")
  ASSERT_NO_FATAL_FAILURE(checkFrames("codec_small_singles"));
}
TEST(RealFrames, Mono1Radiographs) {
  VERNIER_NEEDS_DATA("mono1_cr_headless")
  ASSERT_NO_FATAL_FAILURE(checkFrames("mono1_cr_headless"));
}

}  // namespace
}  // namespace vernier
