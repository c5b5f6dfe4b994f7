// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures with lenses drawn by the engine: every pair of the algebra on four voxels, by hand.
#include <gtest/gtest.h>

#include "PairsOfTheAlgebra.h"
#include "vernier/angiography/Angiography.h"
#include "vernier/dvr/Dvr.h"
#include "vernier/lens/Lens.h"
#include "vernier/surfaces/Surfaces.h"

namespace vernier::lens {
namespace {

using namespace vernier::test;

class TestHost : public Host {
 public:
  Result<void> addTechnique(Technique t) override { return techniques.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override { return makeError(ErrorCode::GlUnavailable, "no GL here"); }
  TechniqueRegistry techniques;
};

class Pairs : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(angiography::registerAngiography(host_).ok());
    ASSERT_TRUE(dvr::registerDvr(host_).ok());
    ASSERT_TRUE(surfaces::registerSurfaces(host_).ok());
    ASSERT_TRUE(registerLens(host_).ok());
  }
  Result<Plan> plan(const Scene& scene, const View& view, const Sources& sources) const {
    Quality quality;
    quality.level = QualityLevel::Reference;
    quality.engine = EngineChoice::Native;
    Capabilities machine;
    machine.native = true;
    return makePlan(scene, view, quality, machine, {}, sources, host_.techniques);
  }
  Result<Images> draw(const Plan& p) const {
    Images images;
    for (const Pass& pass : p.passes)
      if (Result<void> r = host_.techniques.find(pass.technique)->execute(pass, images, {}); !r)
        return r.error();
    return images;
  }
  TestHost host_;
};

// Pairs that are not built: light that is weakened between translucent tools, and shells that replace a tool.
bool refused(const algebra::Case& c) {
  using algebra::Kind;
  using algebra::With;
  const auto has = [&](Kind k) { return c.outside == k || c.inside == k; };
  return (c.with == With::Translucent && has(Kind::Attenuation)) ||
         (c.with == With::Opaque && has(Kind::ShellsMax));
}

TEST_F(Pairs, AllByHandOrRefusedWithASentence) {
  std::size_t drawn = 0, sentences = 0;
  for (const algebra::Case& c : algebra::pairs()) {
    SCOPED_TRACE(c.name);
    const Result<Plan> p = plan(c.scene, c.view, c.sources);
    if (refused(c)) {
      ASSERT_FALSE(p.ok());
      EXPECT_NE(p.error().sentence.find("with a lens"), std::string::npos) << p.error().text();
      ++sentences;
      continue;
    }
    ASSERT_TRUE(p.ok()) << p.error().text();
    const Result<Images> images = draw(*p);
    ASSERT_TRUE(images.ok()) << images.error().text();
    ++drawn;
    for (const algebra::Case::Pixel& at : c.pixels)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(static_cast<double>(images->colour[4 * at.index + static_cast<std::size_t>(k)]),
                    at.ofLevels[k], 2e-3)
            << "pixel " << at.index << " channel " << k;
  }
  EXPECT_EQ(drawn + sentences, 10u * 11 * 4);
  EXPECT_EQ(sentences, 40u);
}

}  // namespace
}  // namespace vernier::lens
