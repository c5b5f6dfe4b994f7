// SPDX-License-Identifier: GPL-3.0-or-later
// Surface phantoms: their answers against the reader's facts, and against closed forms typed here once more.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "Files.h"
#include "TestData.h"
#include "vernier/volume/SurfaceFile.h"

namespace vernier::test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Made {
  nlohmann::json answers;
  SurfaceFile file;
  MeshFacts facts;
};

Made make(const std::string& name) {
  TempDir dir;
  const Result<PhantomInfo> info = writeOnly(dir.path(), name);
  EXPECT_TRUE(info.ok());
  Made m;
  m.answers = nlohmann::json::parse(std::ifstream(info->answers));
  Result<SurfaceFile> file = readSurface(info->data.string());
  EXPECT_TRUE(file.ok()) << file.error().text();
  m.file = std::move(*file);
  m.facts = meshFacts(*m.file.mesh);
  return m;
}

TEST(SurfacePhantoms, AreReadAsTheirAnswersSay) {
  std::size_t surfaces = 0;
  for (const PhantomRecipe& recipe : phantomRecipes()) {
    if (!recipe.isSurface) continue;
    SCOPED_TRACE(recipe.name);
    ++surfaces;
    const Made m = make(recipe.name);
    EXPECT_EQ(m.file.triangles, m.answers["triangles"]);
    EXPECT_EQ(m.file.dropped, MeshDropped{});
    EXPECT_EQ(m.file.findings.size(), 1u);  // the unit
    EXPECT_EQ(m.facts.closed, m.answers["closed"]);
    EXPECT_EQ(m.facts.duplicateTriangles, 0u);
    EXPECT_EQ(m.facts.directedEdgesUsedTwice, 0u);
    for (int a = 0; a < 3; ++a) {
      EXPECT_EQ(m.file.mesh->lowest().p[a], m.answers["lowest_mm"][static_cast<std::size_t>(a)]);
      EXPECT_EQ(m.file.mesh->highest().p[a], m.answers["highest_mm"][static_cast<std::size_t>(a)]);
    }
    const double area = m.answers["area_mm2"];
    EXPECT_NEAR(m.facts.area_mm2, area, 1e-10 * area);
    if (m.facts.closed) {
      const double volume = m.answers["volume_mm3"];
      EXPECT_GT(volume, 0);
      EXPECT_NEAR(m.facts.signedVolume_mm3, volume, 1e-10 * volume);
    }
  }
  EXPECT_EQ(surfaces, 3u);
}

TEST(SurfacePhantoms, ComeCloseToTheSolidsThatTheyStandFor) {
  const Made torus = make("torus");
  EXPECT_NEAR(torus.answers["solid"]["volume_mm3"], 2 * kPi * kPi * 20 * 36, 1e-9);
  EXPECT_NEAR(torus.answers["solid"]["area_mm2"], 4 * kPi * kPi * 20 * 6, 1e-9);
  // 96 x 48 chords lie inside the curve: the section loses (2 pi / 48)^2 / 6, the ring (2 pi / 96)^2 / 6.
  const double section = std::sin(2 * kPi / 48) / (2 * kPi / 48);
  EXPECT_NEAR(torus.facts.signedVolume_mm3 / (2 * kPi * kPi * 20 * 36), section, 2e-3);
  EXPECT_LT(torus.facts.area_mm2, 4 * kPi * kPi * 120);
  EXPECT_GT(torus.facts.area_mm2, 0.995 * 4 * kPi * kPi * 120);

  const Made screw = make("screw");
  const double solid = kPi * (30 * (2.25 * 2.25 + 0.5 * 0.16) + 5 * 16);
  EXPECT_NEAR(screw.answers["solid"]["volume_mm3"], solid, 1e-9);
  EXPECT_NEAR(screw.facts.signedVolume_mm3, solid, 3e-3 * solid);
  EXPECT_EQ(screw.file.mesh->highest().p.z, 35);
  EXPECT_EQ(screw.file.mesh->lowest().p.z, 0);

  const Made plane = make("cutting-plane");
  EXPECT_EQ(plane.facts.area_mm2, 9600);
  EXPECT_FALSE(plane.facts.closed);
  EXPECT_EQ(plane.facts.edgesUsedOnce, 4u);
}

TEST(SurfacePhantoms, AreNoMetaImages) {
  TempDir dir;
  PhantomOptions options;
  options.format = PhantomFormat::MetaImage;
  EXPECT_EQ(writePhantom("torus", dir.path(), options).error().code, ErrorCode::OptionInvalid);
}

}  // namespace
}  // namespace vernier::test
