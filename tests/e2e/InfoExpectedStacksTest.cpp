// SPDX-License-Identifier: GPL-3.0-or-later
// `vernier info --json` against data/expected: series, stacks and findings with their numbers. The folders
// are named in InfoExpectedTest.cpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "InfoExpected.h"

namespace vernier::test {
namespace {

// The largest distance of an origin from the straight even line between first and last origin, as the
// expected files compute it; our own e is the distance from the fitted line, which is never larger.
double deviationFromEndToEndLine(const Facts& facts, const Json& stack) {
  std::vector<std::array<double, 3>> origins;
  for (const std::string file : stack.at("order")) {
    const auto at = file.find('#');  // a frame of a file
    const Json& object = *facts.object(file.substr(0, at));
    if (at == std::string::npos)
      origins.push_back(object.at("origin_lps_mm"));
    else
      origins.push_back(
          object.at("frame_attributes").at(std::stoul(file.substr(at + 1)) - 1).at("origin_lps_mm"));
  }
  double e = 0;
  const std::size_t n = origins.size();
  for (std::size_t k = 0; k < n; ++k) {
    double d = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double t = static_cast<double>(k) / static_cast<double>(n - 1);
      d += std::pow(origins[k][a] - (origins[0][a] + t * (origins[n - 1][a] - origins[0][a])), 2);
    }
    e = std::max(e, std::sqrt(d));
  }
  return e;
}

void compareStack(const Facts& facts, const Json& want, const Json& got) {
  EXPECT_EQ(got.at("order"), want.at("order_along_normal"));
  EXPECT_EQ(got.at("rows"), want.at("rows"));
  EXPECT_EQ(got.at("columns"), want.at("columns"));
  if (want.contains("echo_time")) {
    EXPECT_NEAR(got.at("echo_time_ms").get<double>(), want["echo_time"].get<double>(), 1e-9);
  }
  for (std::size_t a = 0; a < 2; ++a)
    EXPECT_NEAR(got.at("pixel_spacing_row_col_mm")[a].get<double>(),
                want.at("pixel_spacing_row_col_mm")[a].get<double>(), 1e-9);
  const auto closeAll = [](const Json& a, const Json& b, double tolerance) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_NEAR(a[i].get<double>(), b[i].get<double>(), tolerance) << i;
  };
  closeAll(got.at("positions_along_normal_mm"), want.at("positions_along_normal_mm"), 2e-6);
  closeAll(got.at("first_origin_lps_mm"), want.at("first_origin_lps_mm"), 1e-6);
  if (want.at("slices") == 1) return;
  closeAll(got.at("last_origin_lps_mm"), want.at("last_origin_lps_mm"), 1e-6);
  for (const char* key : {"step_mm", "distance_between_origins_mm"})
    for (const char* part : {"min", "median", "max"})
      EXPECT_NEAR(got.at(key).at(part).get<double>(), want.at(key).at(part).get<double>(), 2e-6)
          << key << part;
  for (const char* part : {"min", "max"})
    EXPECT_NEAR(got.at("shear_between_neighbours_deg").at(part).get<double>(),
                want.at("shear_deg").at(part).get<double>(), 1e-4);
  EXPECT_EQ(got.at("gap_after_slice").size(), want.at("gaps_over_1.5_median").size());
  EXPECT_NEAR(deviationFromEndToEndLine(facts, got),
              want.at("max_deviation_of_origins_from_straight_even_line_mm").get<double>(), 2e-6);
  // With a gap our line counts the slices that are missing, theirs does not.
  if (want.at("gaps_over_1.5_median").empty()) {
    EXPECT_NEAR(got.at("max_deviation_along_normal_mm").get<double>(),
                want.at("max_deviation_from_uniform_grid_mm").get<double>(), 2e-6);
  }
  EXPECT_EQ(got.at("volume_3d"), want.at("coincident_pairs").empty());
}

TEST_P(InfoExpected, SeriesAndStacks) {
  if (!here_) return;
  for (const Json& want : facts_.expected.at("series")) {
    if (!want.contains("series")) continue;
    SCOPED_TRACE(want["series"].get<std::string>());
    const Json* got = facts_.series(want.value("study", ""), want["series"]);
    ASSERT_TRUE(got);
    bool undecided = false;
    for (const Json& f : got->at("files")) undecided = undecided || facts_.undecided(f);
    if (!undecided) {
      for (const char* key : {"objects", "images", "frames"}) EXPECT_EQ(got->at(key), want.at(key)) << key;
    }
    for (const Json& stack : want.at("stacks_by_size_orientation_spacing_echo_time")) {
      const Json& order = stack.at("order_along_normal");
      const std::string firstFile = order.at(0);
      // They take a dose grid for its first plane; InfoExpectedTest.cpp compares all of them.
      if (facts_.object(firstFile.substr(0, firstFile.find('#')))->at("modality") == "RTDOSE") continue;
      if (facts_.undecided(firstFile))
        continue;  // malformed_small/MR_truncated: its pixels are short, so it is in no stack
      std::vector<const Json*> ours;
      for (const Json& s : got->at("stacks"))
        if (std::any_of(order.begin(), order.end(), [&](const Json& f) {
              return std::find(s.at("order").begin(), s.at("order").end(), f) != s.at("order").end();
            }))
          ours.push_back(&s);
      // The rules of docs/studies.md split by more than these keys, but in no series of this data.
      ASSERT_EQ(ours.size(), 1u) << order.dump();
      compareStack(facts_, stack, *ours[0]);
    }
  }
}

// The files of all findings of a code, in one sorted list.
std::vector<std::string> filesOf(const std::vector<Json>& findings) {
  std::vector<std::string> files;
  for (const Json& f : findings)
    for (const Json& file : f.at("files")) files.push_back(file);
  std::sort(files.begin(), files.end());
  return files;
}

// Findings that list files: `expected` gives one for the folder (shortened with "..."), we give one for each
// series.
void compareFileList(const Json& want, std::vector<std::string> got) {
  ASSERT_EQ(got.size(), want.at("number_of_files").get<std::size_t>());
  for (const Json& file : want.at("files"))
    if (file != "...") {
      EXPECT_TRUE(std::binary_search(got.begin(), got.end(), file.get<std::string>())) << file;
    }
}

const Json* findingOfSeries(const std::vector<Json>& findings, const Json& series) {
  for (const Json& f : findings)
    if (f.value("series", "") == series) return &f;
  return nullptr;
}

void compareGeometryFinding(const Facts& facts, const Json& want) {
  const std::string code = want.at("code");
  const auto ours = facts.findings(code);
  const Json* got = findingOfSeries(ours, want.at("series"));
  ASSERT_TRUE(got);
  const auto near = [&](const char* ourKey, const Json& value, double tolerance) {
    EXPECT_NEAR(got->at(ourKey).get<double>(), value.get<double>(), tolerance) << ourKey;
  };
  if (code == "tilt") {
    near("shear_deg", want.at("shear_deg"), 1e-3);
    near("along_column_axis_deg", want.at("along_column_axis_deg"), 1e-3);
    near("step_along_normal_mm", want.at("step_along_normal_mm"), 1e-5);
    near("distance_between_origins_mm", want.at("distance_between_origins_mm"), 1e-5);
  } else if (code == "gap") {
    near("step_mm", want.at("step_mm"), 1e-5);
    near("missing_slices", want.at("missing_slices"), 0);
    for (std::size_t a = 0; a < 2; ++a)
      EXPECT_NEAR(got->at("at_mm")[a].get<double>(), want.at("at_mm")[a].get<double>(), 1e-5);
  } else {
    near("step_min_mm", want.at("step_mm").at("min"), 1e-5);
    near("step_median_mm", want.at("step_mm").at("median"), 1e-5);
    near("step_max_mm", want.at("step_mm").at("max"), 1e-5);
    near("max_deviation_from_uniform_grid_mm", want.at("max_deviation_from_uniform_grid_mm"), 1e-5);
  }
}

void compareRepeated(const Facts& facts, const Json& want) {
  for (const Json& f : facts.findings("repeated-sop-instance-uid")) {
    std::vector<std::string> a = f.at("files"), b = want.at("files");
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    if (a != b) continue;
    // Theirs is "not computed" for colour and for what they could not decode.
    if (want.at("stored_values_identical").is_boolean()) {
      EXPECT_EQ(f.at("stored_values_identical"), want["stored_values_identical"].get<bool>() ? "yes" : "no");
    }
    return;
  }
  ADD_FAILURE() << "no finding for " << want.dump();
}

TEST_P(InfoExpected, Findings) {
  if (!here_) return;
  std::map<std::string, std::size_t> wanted;
  for (const Json& want : facts_.expected.at("findings")) {
    const std::string code = want.at("code");
    SCOPED_TRACE(want.dump());
    ++wanted[code];
    if (code == "tilt" || code == "gap" || code == "uneven-spacing") {
      compareGeometryFinding(facts_, want);
    } else if (code == "repeated-sop-instance-uid") {
      compareRepeated(facts_, want);
    } else if (code == "padding-pixels") {
      // The header only declares padding; that such pixels occur is known once they are decoded.
      std::vector<std::string> files;
      for (const Json& o : facts_.info.at("objects"))
        if (o.contains("pixels") && o["pixels"].value("padding_pixels", 0) > 0) files.push_back(o.at("file"));
      std::sort(files.begin(), files.end());
      compareFileList(want, files);
    } else if (code == "several-orientations-in-series" || code == "window-differs-within-series") {
      const auto ours = facts_.findings(code);
      const Json* got = findingOfSeries(ours, want.at("series"));
      ASSERT_TRUE(got);
      for (const char* key : {"orientations", "different"})
        if (want.contains(key)) {
          EXPECT_EQ(got->at(key), want[key]);
        }
    } else if (code == "series-uid-in-several-studies") {
      ASSERT_EQ(facts_.findings(code).size(), 1u);
      EXPECT_EQ(facts_.findings(code)[0].at("series"), want.at("series"));
      EXPECT_EQ(facts_.findings(code)[0].at("studies"), want.at("studies"));
    } else if (code == "independent-decoders-disagree") {
      // A remark on other programs: both misread 32-bit words in big endian, where we must not.
      EXPECT_FALSE(facts_.object(want.at("file"))->at("pixels").contains("error"));
    } else if (code == "window-differs-per-frame") {
      const auto ours = facts_.findings(code);
      const auto got = std::find_if(ours.begin(), ours.end(),
                                    [&](const Json& f) { return f.at("file") == want.at("file"); });
      ASSERT_NE(got, ours.end());
      EXPECT_EQ(got->at("different"), want.at("different"));
    } else {
      std::vector<Json> ours = facts_.findings(code);
      std::vector<std::string> files = filesOf(ours);
      // An undecided file that we list as an image, and they as an object without pixels: its pixel data is
      // there, but cut short (malformed_small/emri_small_jpeg_2k_lossless_too_short.dcm).
      for (const Json& f : want.at("files"))
        if (f != "..." && facts_.undecided(f) &&
            !std::binary_search(files.begin(), files.end(), f.get<std::string>())) {
          EXPECT_TRUE(facts_.object(f) && facts_.object(f)->at("kind") == "image") << f;
          files.insert(std::upper_bound(files.begin(), files.end(), f.get<std::string>()), f);
        }
      compareFileList(want, files);
      if (code == "window-width-not-positive") {
        EXPECT_EQ(ours.at(0).at("first_window_center"), want.at("first").at("window_center"));
        EXPECT_EQ(ours.at(0).at("first_window_width"), want.at("first").at("window_width"));
      }
    }
  }
  // And none of these that is not expected.
  for (const char* code :
       {"tilt", "gap", "uneven-spacing", "coincident-positions", "repeated-sop-instance-uid",
        "series-uid-in-several-studies", "several-orientations-in-series", "window-differs-within-series",
        "rescale-differs-within-series", "window-differs-per-frame"})
    EXPECT_EQ(facts_.findings(code).size(), wanted[code]) << code;
  for (const char* code :
       {"window-width-not-positive", "lossy", "no-part10-header", "image-object-without-pixel-data"})
    if (wanted[code] == 0) {
      EXPECT_TRUE(facts_.findings(code).empty()) << code;
    }
}

}  // namespace
}  // namespace vernier::test
