// SPDX-License-Identifier: GPL-3.0-or-later
// tests/corpus/hulls: awkward sets of points with the answers that mathematics gives.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "RegionChecks.h"
#include "TestPaths.h"
#include "vernier/lens/Shapes.h"

namespace vernier::lens {
namespace {

struct Case {
  std::string file, refused;
  std::size_t facets = 0, corners = 0;
  double volume = 0, tolerance = 0;
  HullShape hull;
};

Case read(const std::filesystem::path& path) {
  Case c;
  c.file = path.filename();
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string first, x, y, z;
    words >> first;
    if (first.empty() || first[0] == '#') continue;
    if (first == "refused") {
      std::getline(words >> std::ws, c.refused);
    } else if (first == "expected") {
      words >> c.facets >> c.corners >> c.volume >> c.tolerance;
      EXPECT_FALSE(words.fail()) << path;
    } else {
      words >> y >> z;
      EXPECT_FALSE(words.fail()) << path << ": " << line;
      c.hull.points.emplace_back(std::strtod(first.c_str(), nullptr), std::strtod(y.c_str(), nullptr),
                                 std::strtod(z.c_str(), nullptr));
    }
  }
  return c;
}

TEST(LensHullCorpus, EachFileHasItsExpectedAnswer) {
  std::size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(VERNIER_SOURCE_DIR) + "/tests/corpus/hulls")) {
    if (entry.path().extension() != ".txt") continue;
    ++files;
    const Case c = read(entry.path());
    SCOPED_TRACE(c.file);
    DerivedCache cache(64 << 20);
    const auto r = convexRegion({c.hull, {}, CutOut{}}, {}, cache);
    if (!c.refused.empty()) {
      EXPECT_FALSE(r.ok());
      if (r.ok()) continue;
      EXPECT_EQ(r.error().code, ErrorCode::SceneInvalid);
      EXPECT_NE(r.error().sentence.find(c.refused), std::string::npos) << r.error().sentence;
      continue;
    }
    EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
    if (!r.ok()) continue;
    test::expectRegion(**r, 1e-9);
    EXPECT_EQ((*r)->planes.size(), c.facets);
    EXPECT_EQ((*r)->corners.size(), c.corners);
    if (c.volume > 0) {
      EXPECT_NEAR(test::volumeOf(**r) / c.volume, 1, c.tolerance);
    }
    double outside = 0;
    for (const MeshPoint& p : c.hull.points)
      for (const HalfSpace& h : (*r)->planes) outside = std::max(outside, h.distance_mm(PatientPoint(p.p)));
    EXPECT_LE(outside, 1e-9);
  }
  EXPECT_GE(files, 25u);
}

}  // namespace
}  // namespace vernier::lens
