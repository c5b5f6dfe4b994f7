// SPDX-License-Identifier: GPL-3.0-or-later
// Raw voxels with a file of schema vernier-raw/1 beside them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "FileCases.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {
using nlohmann::json;
using test::has;
using ::testing::HasSubstr;

struct Case {
  test::TempDir dir;
  json j{{"format", "vernier-raw/1"},
         {"dims", {4, 3, 2}},
         {"type", "int16"},
         {"byte_order", "little"},
         {"spacing_mm", {0.5, 0.75, 2}}};
  std::string raw;
  Case() {
    for (int i = -12; i < 12; ++i) {
      const auto x = static_cast<std::int16_t>(i);
      raw.append(reinterpret_cast<const char*>(&x), 2);
    }
  }
  void write() {
    std::ofstream(dir.path() / "v.raw", std::ios::binary) << raw;
    std::ofstream(dir.path() / "v.raw.json") << j.dump();
  }
  Result<std::shared_ptr<const Volume>> read(const char* name = "v.raw.json") {
    write();
    return readVolumeFile((dir.path() / name).string());
  }
  ErrorCode refusal() {
    const auto v = read();
    EXPECT_FALSE(v.ok()) << j;
    if (v.ok()) return ErrorCode::Internal;
    EXPECT_GT(v.error().sentence.size(), 20u);
    return v.error().code;
  }
};

TEST(Sidecar, SaysAllThatRawVoxelsDoNot) {
  for (const char* name : {"v.raw.json", "v.raw"}) {
    Case c;
    c.j["origin_mm"] = {1, 2, 3};
    c.j["direction"] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    c.j["axes"] = "LPS";
    c.j["unit"] = "HU";
    c.j["slope"] = 2.5;
    c.j["intercept"] = -1000;
    c.j["modality"] = "CT";
    c.j["no_data"] = -12;
    c.j["header_bytes"] = 3;
    c.raw = "abc" + c.raw;
    const auto v = c.read(name);
    ASSERT_TRUE(v.ok()) << v.error().text();
    for (std::int64_t p = 0; p < 24; ++p)
      ASSERT_EQ((*v)->stored(p % 4, p / 4 % 3, p / 12), static_cast<double>(p - 12));
    EXPECT_EQ((*v)->modality(3, 2, 1), 11 * 2.5 - 1000);
    EXPECT_TRUE((*v)->probe(0, 0, 0).noData);
    EXPECT_EQ((*v)->info().unit, "HU");
    EXPECT_EQ((*v)->info().modality, "CT");
    const PatientFromVoxel& m = (*v)->grid().patientFromVoxel;
    EXPECT_EQ(m.translation, glm::dvec3(1, 2, 3));
    EXPECT_EQ(m.linear[0], glm::dvec3(0, 0.5, 0));
    EXPECT_EQ(m.linear[1], glm::dvec3(0.75, 0, 0));
    EXPECT_EQ(m.linear[2], glm::dvec3(0, 0, -2));
    EXPECT_FALSE(has((*v)->info().findings, "axes-unknown"));
  }
}

TEST(Sidecar, AxesAreRasOrNotKnownWhenItSaysSo) {
  Case c;
  c.j["origin_mm"] = {1, 2, 3};
  EXPECT_TRUE(has((*c.read())->info().findings, "axes-unknown"));
  EXPECT_EQ((*c.read())->info().unit, "stored value");
  c.j["axes"] = "RAS";
  const auto v = c.read();
  ASSERT_TRUE(v.ok());
  EXPECT_EQ((*v)->grid().patientFromVoxel.translation, glm::dvec3(-1, -2, 3));
  EXPECT_EQ((*v)->grid().patientFromVoxel.linear[0], glm::dvec3(-0.5, 0, 0));
  EXPECT_EQ((*v)->grid().patientFromVoxel.linear[2], glm::dvec3(0, 0, 2));
}

TEST(Sidecar, HeaderBytesOfMinusOneCountFromTheEnd) {
  Case c;
  c.raw = "any length of header" + c.raw;
  c.j["header_bytes"] = -1;
  const auto v = c.read();
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->stored(0, 0, 0), -12);
}

TEST(Sidecar, EveryKeyIsCheckedByName) {
  const std::tuple<const char*, json, ErrorCode> wrong[] = {
      {"dims", {4, 3}, ErrorCode::FileDamaged},
      {"dims", {4, 3, 0}, ErrorCode::FileDamaged},
      {"dims", {4, 3, 2.5}, ErrorCode::FileDamaged},
      {"dims", {4, 3, 3}, ErrorCode::PixelDataShort},
      {"dims", {4000000000, 4000000000, 4000000000}, ErrorCode::LimitExceeded},
      {"dims", nullptr, ErrorCode::FileDamaged},
      {"type", "int17", ErrorCode::FileDamaged},
      {"type", 5, ErrorCode::FileDamaged},
      {"byte_order", "middle", ErrorCode::FileDamaged},
      {"spacing_mm", {1, 1, -1}, ErrorCode::FileDamaged},
      {"spacing_mm", {1, 1, 1e9}, ErrorCode::GeometryRefused},
      {"direction", {1, 0, 0, 1, 0, 0, 0, 0, 1}, ErrorCode::GeometryRefused},
      {"direction", {1, 0, 0}, ErrorCode::FileDamaged},
      {"axes", "LAS", ErrorCode::FileDamaged},
      {"slope", 0, ErrorCode::RescaleInvalid},
      {"encoding", "zip", ErrorCode::FileDamaged},
      {"header_bytes", -2, ErrorCode::FileDamaged},
      {"header_bytes", 1000, ErrorCode::PixelDataShort},
      {"data", "../v.raw", ErrorCode::FileDamaged},
      {"data", "none.raw", ErrorCode::FileNotFound},
      {"no_data", {5, 1}, ErrorCode::FileDamaged},
      {"spacing", {1, 1, 1}, ErrorCode::FileDamaged},
  };
  for (const auto& [key, value, code] : wrong) {
    Case c;
    c.j[key] = value;
    EXPECT_EQ(c.refusal(), code) << key << " " << value;
  }
  Case c;
  c.j["spacing"] = {1, 1, 1};
  EXPECT_THAT(c.read().error().sentence, HasSubstr("/spacing is not a key"));
  c.j = {{"format", "vernier-raw/2"}};
  EXPECT_EQ(c.refusal(), ErrorCode::NotBuiltYet);
}

}  // namespace
}  // namespace vernier
