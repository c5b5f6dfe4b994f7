// SPDX-License-Identifier: GPL-3.0-or-later
// A host with OpenGL for the techniques that a test names.
#pragma once
#include <initializer_list>

#include "GlForTest.h"
#include "vernier/plan/Plugin.h"

namespace vernier::test {

class GlHost final : public Host {
 public:
  explicit GlHost(std::initializer_list<Result<void> (*)(Host&)> modules) {
    for (const auto add : modules) EXPECT_TRUE(add(*this).ok());
    gpu::probe(capabilities);
  }
  Result<void> addTechnique(Technique t) override { return registry.add(std::move(t)); }
  Result<gpu::Device*> glDevice() override {
    if (gpu::Device* device = test::glDevice()) return device;
    return makeError(ErrorCode::GlUnavailable, "GL is not here.");
  }
  TechniqueRegistry registry;
  Capabilities capabilities;
};

}  // namespace vernier::test
