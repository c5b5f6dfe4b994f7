// SPDX-License-Identifier: GPL-3.0-or-later
// A phantom written, scanned and compared with its answers file.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "TestData.h"
#include "vernier/phantoms/Phantoms.h"
#include "vernier/study/Load.h"
#include "vernier/volume/Build.h"
#include "vernier/volume/Sampling.h"

namespace vernier::test {

using Json = nlohmann::json;
using Settings = std::map<std::string, std::string>;

struct Loaded {
  TempDir dir;
  Json answers;
  StudySet study;

  Loaded(const std::string& name, const Settings& settings) {
    PhantomOptions options;
    options.settings = settings;
    const Result<PhantomInfo> info = writePhantom(name, dir.path(), options);
    EXPECT_TRUE(info.ok()) << (info.ok() ? "" : info.error().text());
    if (!info) return;
    std::ifstream in(info->answers);
    answers = Json::parse(in);
    Result<StudySet> scanned = scanStudy({info->data.string()});
    EXPECT_TRUE(scanned.ok()) << (scanned.ok() ? "" : scanned.error().text());
    if (scanned) study = std::move(scanned).value();
    for (const FileRecord& f : study.files)
      EXPECT_FALSE(f.error.has_value()) << f.shown << ' ' << f.error->text();
  }
  const Series& seriesOf(const std::string& uid) const {
    for (const Series& s : study.series)
      if (s.seriesUid == uid) return s;
    ADD_FAILURE() << "series not found";
    return study.series.at(0);
  }
  const Series& only() const { return seriesOf(answers["series"][0]["series_uid"]); }
};

inline std::set<std::string> codesOf(const Series& series) {
  std::set<std::string> codes;
  for (const Finding& f : series.findings) codes.insert(f.code);
  for (const Stack& s : series.stacks)
    for (const Finding& f : s.findings) codes.insert(f.code);
  return codes;
}

inline PatientPoint pointOf(const Json& v) {
  return PatientPoint(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

// Each probe's stored value, under the patient point that the answers name, by nearest and by linear
// interpolation (the point is a voxel centre).
inline void expectProbes(const Volume& volume, const Json& series) {
  const double slope = series["rescale_slope"], bound = series["stored_bound"];
  for (const Json& p : series["probes"]) {
    const PatientPoint at = pointOf(p["patient_mm"]);
    const std::optional<StoredProbe> nearest = probeStored(volume, at);
    ASSERT_TRUE(nearest.has_value()) << p;
    EXPECT_NEAR(nearest->stored, p["stored"].get<double>(), bound) << p;
    EXPECT_NEAR(nearest->modality, p["modality"].get<double>(), bound * slope) << p;
    EXPECT_EQ(nearest->noData, p.contains("padding")) << p;
    if (nearest->noData) continue;
    const std::optional<double> linear = sampleModality(volume, at);
    ASSERT_TRUE(linear.has_value()) << p;
    EXPECT_NEAR(*linear, p["modality"].get<double>(), bound * slope + 1e-5) << p;
  }
}

// Slice by slice: the sum of all stored values, with the slice found by its position.
inline void expectSums(const Volume& volume, const Stack& stack, const Json& series) {
  if (series["stored_bound"] != 0.0) return;
  const GridGeometry& g = volume.grid();
  for (std::int64_t k = 0; k < g.slices; ++k) {
    double sum = 0;
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) sum += volume.probe(i, j, k).stored;
    const double position = stack.positions_mm[static_cast<std::size_t>(k)];
    bool found = false;
    for (const Json& s : series["slices"]) {
      if (std::fabs(s["position_along_normal_mm"].get<double>() - position) > 1e-6) continue;
      found = true;
      EXPECT_EQ(sum, s["stored_sum"].get<double>()) << s;
    }
    EXPECT_TRUE(found) << position;
  }
}

inline std::shared_ptr<const Volume> volumeOf(const Loaded& l, const Series& series, const Stack& stack) {
  EXPECT_TRUE(stack.volume3d) << stack.why2d;
  Result<std::shared_ptr<const Volume>> built = buildVolume(l.study, series, stack);
  EXPECT_TRUE(built.ok()) << (built.ok() ? "" : built.error().text());
  return built ? *built : nullptr;
}

inline void expectWhole(const Loaded& l, const Json& answers) {
  const Series& series = l.seriesOf(answers["series_uid"]);
  ASSERT_EQ(series.stacks.size(), 1u);
  const Stack& stack = series.stacks[0];
  const std::shared_ptr<const Volume> volume = volumeOf(l, series, stack);
  ASSERT_NE(volume, nullptr);
  EXPECT_EQ(volume->grid().columns, answers["columns"].get<std::int64_t>());
  EXPECT_EQ(volume->grid().rows, answers["rows"].get<std::int64_t>());
  EXPECT_EQ(volume->grid().slices, static_cast<std::int64_t>(answers["slices"].size()));
  EXPECT_NEAR(volume->grid().spacing_mm().x, answers["pixel_spacing_row_col_mm"][1].get<double>(), 1e-9);
  EXPECT_NEAR(volume->grid().spacing_mm().y, answers["pixel_spacing_row_col_mm"][0].get<double>(), 1e-9);
  EXPECT_NEAR(stack.step_mm, answers["step_mm"].get<double>(), 1e-6);
  expectProbes(*volume, answers);
  expectSums(*volume, stack, answers);
}

}  // namespace vernier::test
