// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/plan/Technique.h"

#include <gtest/gtest.h>

namespace vernier {
namespace {

Technique technique(const std::string& name) {
  Technique t;
  t.name = name, t.kinds = {"slice"};
  t.passesFor = [](const Layer&, std::size_t, const PlanContext&) -> Result<std::vector<Pass>> {
    return std::vector<Pass>{};
  };
  t.execute = [](const Pass&, Images&, std::stop_token) -> Result<void> { return {}; };
  return t;
}

TechniqueRegistry registry() {
  TechniqueRegistry r;
  EXPECT_TRUE(r.add(technique("mpr.native")).ok());
  return r;
}

TEST(TechniqueRegistry, RefusesDuplicatesAndHalfOnes) {
  TechniqueRegistry r = registry();
  EXPECT_EQ(r.add(technique("mpr.native")).error().code, ErrorCode::PluginFailed);
  Technique half = technique("mpr.strips");
  half.execute = nullptr;
  EXPECT_FALSE(r.add(half).ok());
  EXPECT_EQ(r.all().size(), 1u);
  EXPECT_NE(r.find("mpr.native"), nullptr);
  EXPECT_EQ(r.find("mpr.strips"), nullptr);
  EXPECT_EQ(r.drawing("slice").size(), 1u);
  EXPECT_TRUE(r.drawing("shells").empty());
}

}  // namespace
}  // namespace vernier
