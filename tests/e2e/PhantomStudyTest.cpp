// SPDX-License-Identifier: GPL-3.0-or-later
// Every phantom through the real loader: scanStudy, buildVolume, probes. Truth: the phantom's answers file
// and the recipe's geometry typed again.
#include "PhantomStudy.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier::test {
namespace {

TEST(PhantomStudy, WholeSeriesLoadWithTheirGeometryAndValues) {
  const std::vector<std::pair<std::string, Settings>> cases{
      {"small-ct", {}},
      {"small-ct", {{"oblique", "25"}, {"slice-aspect", "4"}}},
      {"ct-head", {{"scale", "0.125"}}},
      {"vessels", {{"scale", "0.25"}}},
      {"marschner-lobb", {}},
      {"gaussian-vessel", {}},
      {"orbital", {{"oblique", "20"}}},
      {"plume", {}},
      {"ramp", {{"plane", "coronal"}, {"flip", "6"}}},
      {"grey-scale", {}},
      {"uniform", {}},
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

TEST(PhantomStudy, AMetaImageOfColoursHasTheColoursAndOpacityOfTheAnswers) {
  const TempDir dir;
  PhantomOptions options;
  options.format = PhantomFormat::MetaImage;
  const Result<PhantomInfo> info = writePhantom("rgba-spheres", dir.path(), options);
  ASSERT_TRUE(info.ok());
  const auto v = readVolumeFile(info->data.string());
  ASSERT_TRUE(v.ok()) << v.error().text();
  const Json probes = Json::parse(std::ifstream(info->answers))["series"][0]["probes"];
  ASSERT_GE(probes.size(), 4u);
  for (const Json& p : probes) {
    const auto found = probeStored(**v, pointOf(p["patient_mm"]));
    ASSERT_TRUE(found && found->rgba) << p;
    EXPECT_EQ(Json(*found->rgba), p["stored"]) << p;
  }
}

// Every voxel, from the spheres as docs/phantoms.md and the recipe describe them, written here once more.
TEST(PhantomStudy, RgbaSpheresHoldTheirColourInEveryVoxel) {
  struct Sphere {
    glm::dvec3 centre_mm;
    double radius_mm;
    std::array<std::uint8_t, 4> rgba;
  };
  const Sphere spheres[] = {{{-12, -8, -6}, 8, {230, 30, 25, 255}},
                            {{12, -8, 0}, 8, {20, 210, 60, 255}},
                            {{0, 12, 6}, 8, {40, 70, 240, 255}},
                            {{0, 0, 0}, 5, {255, 255, 255, 102}}};
  const TempDir dir;
  PhantomOptions options;
  options.format = PhantomFormat::MetaImage;
  const Result<PhantomInfo> info = writePhantom("rgba-spheres", dir.path(), options);
  ASSERT_TRUE(info.ok());
  const auto v = readVolumeFile(info->data.string());
  ASSERT_TRUE(v.ok()) << v.error().text();
  std::array<int, 4> inside{};
  for (int k = 0; k < 32; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 48; ++i) {
        const glm::dvec3 at((i - 23.5) * 1.0, (j - 19.5) * 1.25, (k - 15.5) * 1.5);
        std::array<std::uint8_t, 4> expected{0, 0, 0, 0};
        for (std::size_t n = 0; n < 4; ++n) {
          const glm::dvec3 d = at - spheres[n].centre_mm;
          if (glm::dot(d, d) > spheres[n].radius_mm * spheres[n].radius_mm) continue;
          expected = spheres[n].rgba;
          ++inside[n];
        }
        const PatientPoint p(at.x, at.y, at.z);
        const auto found = probeStored(**v, p);
        ASSERT_TRUE(found && found->rgba);
        ASSERT_EQ(*found->rgba, expected) << i << " " << j << " " << k;
      }
  // 4/3 pi r^3 in voxels of 1.875 mm^3: 1143.8 and 279.3; what the grid makes of a surface is within 2 %.
  for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR(inside[n], 1143.8, 23) << n;
  EXPECT_NEAR(inside[3], 279.3, 8);
}

}  // namespace
}  // namespace vernier::test
