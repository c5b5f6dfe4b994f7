// SPDX-License-Identifier: GPL-3.0-or-later
// A host for tests of this room: the techniques that it is given, somebody who draws tools, and the GL of the
// test program.
#pragma once
#include "GlForTest.h"
#include "vernier/plan/MakePlan.h"

namespace vernier::test {

class TechniqueHost : public Host {
 public:
  TechniqueHost() {
    Technique surfaces;  // only says that somebody here draws tools
    surfaces.name = "surface.test", surfaces.kinds = {"surface"};
    surfaces.passesFor = [](const Layer&, std::size_t, const PlanContext&) -> Result<std::vector<Pass>> {
      return std::vector<Pass>{};
    };
    surfaces.execute = [](const Pass&, Images&, std::stop_token) -> Result<void> { return {}; };
    EXPECT_TRUE(registry.add(std::move(surfaces)).ok());
    gpu::probe(capabilities);
  }
  Result<void> addTechnique(Technique t) override { return registry.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override {
    if (gpu::Device* device = vernier::test::glDevice()) return device;
    return makeError(ErrorCode::GlUnavailable, "GL is not here.");
  }
  TechniqueRegistry registry;
  Capabilities capabilities;
};

}  // namespace vernier::test
