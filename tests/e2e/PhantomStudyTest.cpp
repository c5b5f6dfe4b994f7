// SPDX-License-Identifier: GPL-3.0-or-later
// Every phantom through the real loader: scanStudy, buildVolume, probes. Truth: the phantom's answers file
// and the recipe's geometry typed again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "TestData.h"
#include "vernier/phantoms/Phantoms.h"
#include "vernier/study/Load.h"
#include "vernier/volume/VolumeFile.h"
#include "vernier/volume/Sampling.h"

namespace vernier::test {
namespace {

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

std::set<std::string> codesOf(const Series& series) {
  std::set<std::string> codes;
  for (const Finding& f : series.findings) codes.insert(f.code);
  for (const Stack& s : series.stacks)
    for (const Finding& f : s.findings) codes.insert(f.code);
  return codes;
}

PatientPoint pointOf(const Json& v) {
  return PatientPoint(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}

// Each probe's stored value, under the patient point that the answers name, by nearest and by linear
// interpolation (the point is a voxel centre).
void expectProbes(const Volume& volume, const Json& series) {
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
void expectSums(const Volume& volume, const Stack& stack, const Json& series) {
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

std::shared_ptr<const Volume> volumeOf(const Loaded& l, const Series& series, const Stack& stack) {
  EXPECT_TRUE(stack.volume3d) << stack.why2d;
  Result<std::shared_ptr<const Volume>> built = buildVolume(l.study, series, stack);
  EXPECT_TRUE(built.ok()) << (built.ok() ? "" : built.error().text());
  return built ? *built : nullptr;
}

void expectWhole(const Loaded& l, const Json& answers) {
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

TEST(PhantomStudy, WholeSeriesLoadWithTheirGeometryAndValues) {
  const std::vector<std::pair<std::string, Settings>> cases{
      {"small-ct", {}},
      {"small-ct", {{"oblique", "25"}, {"slice-aspect", "4"}}},
      {"ct-head", {{"scale", "0.125"}}},
      {"vessels", {{"scale", "0.25"}}},
      {"marschner-lobb", {}},
      {"gaussian-vessel", {}},
      {"ruler", {{"scale", "0.25"}, {"oblique", "-30"}}},
      {"ruler", {{"scale", "0.5"}, {"pixel-aspect", "2"}, {"slice-aspect", "25"}}},
      {"shuffled", {}},
      {"padding", {}},
      {"window-odd", {}},
      {"duplicate", {}},
      {"tilt", {}}};
  for (const auto& [name, settings] : cases) {
    SCOPED_TRACE(name);
    Loaded l(name, settings);
    Json answers = l.answers["series"][0];
    if (name == "duplicate")
      answers["slices"].erase(answers["slices"].size() - 1);  // the same object twice: one slice
    expectWhole(l, answers);
  }
}

TEST(PhantomStudy, EveryTransferSyntaxGivesTheStatedValues) {
  Loaded l("syntaxes", {});
  ASSERT_EQ(l.study.series.size(), 12u);
  for (const Json& series : l.answers["series"]) {
    SCOPED_TRACE(series["description"].get<std::string>());
    expectWhole(l, series);
    EXPECT_EQ(l.study.instances[l.seriesOf(series["series_uid"]).instances[0]].lossy,
              series["lossy"].get<bool>());
  }
}

TEST(PhantomStudy, OrientationIsRightByValueInEveryAcquisition) {
  for (const char* plane : {"axial", "coronal", "sagittal"}) {
    for (int flip = 0; flip < 8; ++flip) {
      for (const char* left : {"no", "yes"}) {
        SCOPED_TRACE(std::string(plane) + " flip " + std::to_string(flip) + " left-handed " + left);
        Loaded l("orientation",
                 {{"plane", plane}, {"flip", std::to_string(flip)}, {"left-handed", left}, {"scale", "0.5"}});
        const Series& series = l.only();
        ASSERT_EQ(series.stacks.size(), 1u);
        const auto volume = volumeOf(l, series, series.stacks[0]);
        ASSERT_NE(volume, nullptr);
        const auto at = [&](double x, double y, double z) {
          return sampleModality(*volume, PatientPoint(x, y, z), Interpolation::Nearest).value_or(1e9);
        };
        EXPECT_EQ(at(32, -20, 30), 300);   // towards the patient's left
        EXPECT_EQ(at(10, 2, 30), 600);     // posterior
        EXPECT_EQ(at(10, -20, 52), 900);   // head
        EXPECT_EQ(at(-12, -20, 30), 100);  // and not on the other sides
        EXPECT_EQ(at(10, -42, 30), 100);
        EXPECT_EQ(at(10, -20, 8), 100);
        expectProbes(*volume, l.answers["series"][0]);
      }
    }
  }
}

TEST(PhantomStudy, TiltIsAShearedStackWithItsAngle) {
  Loaded l("tilt", {});
  const Stack& stack = l.only().stacks.at(0);
  EXPECT_EQ(stack.shape, StackShape::Sheared);
  EXPECT_NEAR(stack.shear_deg, 14, 1e-6);
  EXPECT_TRUE(codesOf(l.only()).contains("tilt"));
  const auto volume = volumeOf(l, l.only(), stack);
  ASSERT_NE(volume, nullptr);
  // The spine stands upright in the patient, whatever the gantry did.
  for (const double z : {-20.0, -7.3, 0.0, 11.2, 20.0}) {
    const auto v = sampleModality(*volume, PatientPoint(0, 18, z));
    ASSERT_TRUE(v.has_value()) << z;
    EXPECT_NEAR(*v, 600, 50) << z;
  }
}

TEST(PhantomStudy, GapIsNoDataBetweenItsNeighbours) {
  Loaded l("gap", {});
  const Stack& stack = l.only().stacks.at(0);
  EXPECT_TRUE(codesOf(l.only()).contains("gap"));
  const auto volume = volumeOf(l, l.only(), stack);
  ASSERT_NE(volume, nullptr);
  const double from = l.answers["findings"][0]["from_mm"], to = l.answers["findings"][0]["to_mm"];
  EXPECT_FALSE(sampleModality(*volume, PatientPoint(0, 18, 0.5 * (from + to))).has_value());
  EXPECT_TRUE(sampleModality(*volume, PatientPoint(0, 18, from)).has_value());
  EXPECT_TRUE(sampleModality(*volume, PatientPoint(0, 18, to)).has_value());
  EXPECT_EQ(volume->grid().gapAfter.size(), 1u);
  expectProbes(*volume, l.answers["series"][0]);
}

TEST(PhantomStudy, UnevenSlicesKeepTheirTruePositions) {
  Loaded l("uneven", {});
  const Stack& stack = l.only().stacks.at(0);
  EXPECT_EQ(stack.shape, StackShape::Uneven);
  EXPECT_TRUE(codesOf(l.only()).contains("uneven-spacing"));
  const auto volume = volumeOf(l, l.only(), stack);
  ASSERT_NE(volume, nullptr);
  expectProbes(*volume, l.answers["series"][0]);
  expectSums(*volume, stack, l.answers["series"][0]);
}

TEST(PhantomStudy, DuplicatesAreMergedKeptOutOrRefusedByKind) {
  Loaded same("duplicate", {{"kind", "identical"}});
  const auto repeated = [](const Finding& f) { return f.code == "repeated-sop-instance-uid"; };
  EXPECT_TRUE(std::any_of(same.study.findings.begin(), same.study.findings.end(), repeated));
  EXPECT_EQ(same.only().stacks.at(0).slices.size(), 32u);
  EXPECT_TRUE(same.only().stacks.at(0).volume3d);

  Loaded conflict("duplicate", {{"kind", "conflict"}});
  EXPECT_TRUE(codesOf(conflict.only()).contains("identity-conflict"));

  Loaded place("duplicate", {{"kind", "position"}});
  EXPECT_TRUE(codesOf(place.only()).contains("coincident-positions"));
  EXPECT_FALSE(place.only().stacks.at(0).volume3d);
  EXPECT_FALSE(place.only().stacks.at(0).why2d.empty());
}

TEST(PhantomStudy, TwoOrientationsAreTwoStacksOfOneSeries) {
  Loaded l("two-orientations", {});
  ASSERT_EQ(l.study.series.size(), 1u);
  ASSERT_EQ(l.study.series[0].stacks.size(), 2u);
  EXPECT_TRUE(codesOf(l.study.series[0]).contains("several-orientations-in-series"));
  for (const Stack& stack : l.study.series[0].stacks) {
    EXPECT_EQ(stack.slices.size(), 32u);
    const auto volume = volumeOf(l, l.study.series[0], stack);
    ASSERT_NE(volume, nullptr);
    const auto spine = sampleModality(*volume, PatientPoint(0, 18, 0), Interpolation::Nearest);
    ASSERT_TRUE(spine.has_value());
    EXPECT_NEAR(*spine, 600, 60);
  }
}

TEST(PhantomStudy, WindowsThatCannotBeUsedAreNotOffered) {
  Loaded l("window-odd", {});
  EXPECT_TRUE(codesOf(l.only()).contains("window-width-not-positive"));
  for (const Instance& i : l.study.instances)
    for (const VoiWindow& w : i.windows) EXPECT_GT(w.width, 0);
}

TEST(PhantomStudy, MetaImageEqualsTheDicomVolume) {
  Loaded l("ct-head", {{"scale", "0.125"}});
  PhantomOptions options;
  options.settings = {{"scale", "0.125"}};
  options.format = PhantomFormat::MetaImage;
  const Result<PhantomInfo> info = writePhantom("ct-head", l.dir.path(), options);
  ASSERT_TRUE(info.ok());
  const auto meta = readVolumeFile(info->data.string());
  ASSERT_TRUE(meta.ok()) << meta.error().text();
  expectProbes(**meta, l.answers["series"][0]);
}

}  // namespace
}  // namespace vernier::test
