// SPDX-License-Identifier: GPL-3.0-or-later
// `vernier info --json` of a surface against data/expected/surf_pedicle_screw.json.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "InfoJson.h"
#include "TestData.h"

namespace vernier::test {
namespace {
using Json = nlohmann::json;

TEST(SurfaceExpected, PedicleScrew) {
  VERNIER_NEEDS_DATA("surf_pedicle_screw");
  const std::filesystem::path expected = dataDir() / "expected" / "surf_pedicle_screw.json";
  ASSERT_TRUE(std::filesystem::exists(expected));
  const Json want = Json::parse(std::ifstream(expected)).at("objects").at(0);

  const auto study = scanStudy({(dataDir() / "surf_pedicle_screw").string()});
  ASSERT_TRUE(study.ok());
  InfoOptions options;
  options.surfaces = surfacesOf(*study, nullptr, {});
  const Json info = Json::parse(infoJson(*study, options));
  ASSERT_EQ(info.at("surfaces").size(), 1u);
  const Json& got = info["surfaces"][0];

  EXPECT_EQ(info.at("totals").at("files_by_kind").at("surface"), 1);
  EXPECT_EQ(got.at("format"), want.at("kind"));
  const std::pair<const char*, const char*> equal[] = {
      {"file", "file"},
      {"triangles_in_header", "triangles_declared"},
      {"triangles_read", "triangles"},
      {"bytes", "bytes"},
      {"bytes_expected", "bytes_expected"},
      {"distinct_vertices_bitwise", "distinct_vertices"},
      {"distinct_edges", "distinct_edges"},
      {"edges_used_once", "edges_used_once"},
      {"edges_used_over_twice", "edges_used_over_twice"},
      {"directed_edges_used_over_once", "directed_edges_used_over_once"},
      {"zero_area_triangles", "zero_area_triangles"},
      {"not_finite", "not_finite_triangles"},
      {"closed", "closed"}};
  for (const auto& [theirs, ours] : equal) EXPECT_EQ(got.at(ours), want.at(theirs)) << theirs;
  const std::pair<const char*, const char*> points[] = {
      {"bounds_min", "lowest_mm"}, {"bounds_max", "highest_mm"}, {"extent", "extent_mm"}};
  for (const auto& [theirs, ours] : points)
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_NEAR(got.at(ours)[a].get<double>(), want.at(theirs)[a].get<double>(), 1e-6) << theirs;
    }
  // They give four digits, or two.
  EXPECT_NEAR(got.at("extent_along_principal_axis_mm").get<double>(),
              want.at("extent_along_principal_axis").get<double>(), 6e-5);
  EXPECT_NEAR(got.at("area_mm2").get<double>(), want.at("surface_area").get<double>(), 6e-5);
  EXPECT_NEAR(got.at("signed_volume_mm3").get<double>(), want.at("signed_volume").get<double>(), 6e-3);
  // "STL carries no unit; mm is an assumption that the program must state."
  EXPECT_EQ(got.at("unit"), "mm (assumed)");
  EXPECT_EQ(got.at("findings")[0].at("code"), "unit-assumed");

  const std::string text = infoText(*study, {}, options.surfaces);
  EXPECT_NE(text.find("Surface D4.5L30.stl  binary STL, 37916 triangles, 8.5 x 38 x 8.5 mm"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("mm is assumed"), std::string::npos) << text;
}

}  // namespace
}  // namespace vernier::test
