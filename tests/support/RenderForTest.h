// SPDX-License-Identifier: GPL-3.0-or-later
// Renders a scene through the planner and one named slice technique, as the session does: plan, execute,
// frame. GL techniques take part where OSMesa is there (VERNIER_REQUIRE_GL fails without it).
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "GlForTest.h"
#include "vernier/mpr/Mpr.h"
#include "vernier/plan/MakePlan.h"

namespace vernier::test {

class TestHost final : public Host {
 public:
  static TestHost& instance() {
    static TestHost host;
    return host;
  }
  Result<void> addTechnique(Technique t) override { return registry.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override {
    if (gpu::Device* device = vernier::test::glDevice()) return device;
    return makeError(ErrorCode::GlUnavailable, "GL is not here.");
  }
  TechniqueRegistry registry;
  Capabilities capabilities;

 private:
  TestHost() {
    EXPECT_TRUE(mpr::registerMpr(*this).ok());
    gpu::probe(capabilities);
  }
};

// The slice techniques that can draw here, native first. Those that draw planes and sample slabs:
// mpr.exact draws slabs only and is tested apart.
inline const std::vector<std::string>& sliceTechniques() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> v;
    for (const Technique* t : TestHost::instance().registry.drawing("slice"))
      if (t->name != "mpr.exact" && (t->engine == Engine::Native || vernier::test::glDevice()))
        v.push_back(t->name);
    return v;
  }();
  return names;
}

struct Rendered {
  Frame frame;
  bool fixedFunction = false;
};

// A technique may refuse a volume that it cannot hold: NoTechnique. Anything else is for the test to judge.
inline Result<Rendered> renderWith(const std::string& technique, const Scene& scene, View view,
                                   const Sources& sources, double step = 1) {
  TestHost& host = TestHost::instance();
  Quality quality;
  quality.technique = technique;
  quality.step = step;
  view.wantValues = true;
  const auto plan = makePlan(scene, view, quality, host.capabilities, CostTable{}, sources, host.registry);
  if (!plan) return plan.error();
  Rendered r;
  r.frame.images.allocate(view.width_px, view.height_px, true);
  for (const Pass& pass : plan->passes) {
    r.fixedFunction = r.fixedFunction || pass.fixedFunctionFiltering;
    const Technique* t = host.registry.find(pass.technique);
    if (!t) return makeError(ErrorCode::Internal, "no executor");
    if (auto done = t->execute(pass, r.frame.images, {}); !done) return done.error();
  }
  return r;
}

inline float valueOf(const Rendered& r, int x, int y) {
  return r.frame.images.values[static_cast<std::size_t>(x) +
                               static_cast<std::size_t>(r.frame.images.width) * static_cast<std::size_t>(y)];
}

}  // namespace vernier::test
