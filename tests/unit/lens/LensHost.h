// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures with lenses drawn without GL: all techniques that may take part.
#pragma once
#include <gtest/gtest.h>

#include "PairsOfTheAlgebra.h"
#include "vernier/angiography/Angiography.h"
#include "vernier/dvr/Dvr.h"
#include "vernier/lens/Lens.h"
#include "vernier/surfaces/Surfaces.h"

namespace vernier::test {

class LensHost : public Host {
 public:
  // `together`: appearances are drawn together where that is possible; false: always in parts.
  explicit LensHost(bool together = true) : together_(together) {
    EXPECT_TRUE(angiography::registerAngiography(*this).ok());
    EXPECT_TRUE(dvr::registerDvr(*this).ok());
    EXPECT_TRUE(surfaces::registerSurfaces(*this).ok());
    EXPECT_TRUE(lens::registerLens(*this).ok());
  }
  Result<void> addTechnique(Technique t) override {
    if (!together_) t.together = nullptr;
    return techniques_.add(std::move(t));
  }
  Result<gpu::Device*> glDevice() override { return makeError(ErrorCode::GlUnavailable, "no GL here"); }

  Result<Plan> plan(const Scene& scene, const View& view, const Sources& sources,
                    QualityLevel level = QualityLevel::Reference) const {
    Quality quality;
    quality.level = level;
    quality.engine = EngineChoice::Native;
    Capabilities machine;
    machine.native = true;
    return makePlan(scene, view, quality, machine, {}, sources, techniques_);
  }
  Result<Images> draw(const Plan& p) const {
    Images images;
    for (const Pass& pass : p.passes)
      if (Result<void> r = techniques_.find(pass.technique)->execute(pass, images, {}); !r) return r.error();
    return images;
  }

 private:
  const bool together_;
  TechniqueRegistry techniques_;
};

}  // namespace vernier::test
