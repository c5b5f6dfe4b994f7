// SPDX-License-Identifier: GPL-3.0-or-later
// VTK images that VTK wrote (files/make_vti.py), and the same cut, flipped and edited.
#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "FileCases.h"
#include "vernier/base/Random.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {
using nlohmann::json;
using test::bytesOfFile;
using test::has;

const std::filesystem::path kFiles = std::filesystem::path(VERNIER_SOURCE_DIR) / "tests/unit/volume/files";

const json& cases() {
  static const json all = json::parse(std::ifstream(kFiles / "vti.json"));
  return all;
}

TEST(Vti, EqualsWhatVtkWrote) {
  for (const auto& [name, truth] : cases().items()) {
    SCOPED_TRACE(name);
    const auto read = readVolumeFile((kFiles / name).string());
    ASSERT_TRUE(read.ok()) << read.error().text();
    const Volume& v = **read;
    const std::int64_t n[] = {truth["dims"][0], truth["dims"][1], truth["dims"][2]};
    ASSERT_EQ(v.grid().columns, n[0]);
    ASSERT_EQ(v.grid().rows, n[1]);
    ASSERT_EQ(v.grid().slices, n[2]);
    const bool rounded = truth["type"] == "float64";
    for (std::int64_t p = 0; p < n[0] * n[1] * n[2]; ++p) {
      const double stored = truth["stored"][static_cast<std::size_t>(p)];
      ASSERT_EQ(
          v.stored(p % n[0], p / n[0] % n[1], p / (n[0] * n[1])),
          rounded || name == "ascii-float.vti" ? static_cast<double>(static_cast<float>(stored)) : stored);
    }
    for (const json& place : truth["places"]) {
      const VoxelPoint at(place["ijk"][0].get<double>(), place["ijk"][1].get<double>(),
                          place["ijk"][2].get<double>());
      const PatientPoint p = v.grid().patientFromVoxel * at;
      for (int a = 0; a < 3; ++a)
        EXPECT_NEAR(p.p[a], place["at"][static_cast<std::size_t>(a)].get<double>(), 1e-12);
    }
    EXPECT_TRUE(has(v.info().findings, "axes-unknown"));
    EXPECT_EQ(v.info().unit, "stored value");
  }
  EXPECT_GE(cases().size(), 20u);
}

struct Edited {
  test::TempDir dir;
  std::string bytes;
  explicit Edited(const char* name) : bytes(bytesOfFile(kFiles / name)) {}
  Edited& replace(const std::string& a, const std::string& b) {
    const std::size_t at = bytes.find(a);
    EXPECT_NE(at, std::string::npos) << a;
    if (at != std::string::npos) bytes.replace(at, a.size(), b);
    return *this;
  }
  Result<std::shared_ptr<const Volume>> read() {
    const auto path = dir.path() / "x.vti";
    std::ofstream(path, std::ios::binary) << bytes;
    return readVolumeFile(path.string());
  }
  ErrorCode refusal() {
    const auto v = read();
    EXPECT_FALSE(v.ok());
    if (v.ok()) return ErrorCode::Internal;
    EXPECT_GT(v.error().sentence.size(), 20u);
    EXPECT_EQ(v.error().where, "x.vti");
    return v.error().code;
  }
};

TEST(Vti, WhatCannotBeUsedSaysWhy) {
  const std::string whole = "WholeExtent=\"0 4 0 3 0 2\"", piece = "Piece Extent=\"0 4 0 3 0 2\"";
  EXPECT_EQ(Edited("inline.vti").replace(whole, "WholeExtent=\"0 4 0 3 0 9\"").refusal(),
            ErrorCode::NotBuiltYet);
  EXPECT_EQ(Edited("inline.vti")
                .replace(whole, "WholeExtent=\"0 4 0 3 0 9\"")
                .replace(piece, "Piece Extent=\"0 4 0 3 0 9\"")
                .refusal(),
            ErrorCode::PixelDataShort);
  EXPECT_EQ(Edited("inline-zlib.vti")
                .replace(whole, "WholeExtent=\"0 4 0 3 0 3\"")
                .replace(piece, "Piece Extent=\"0 4 0 3 0 3\"")
                .refusal(),
            ErrorCode::FileDamaged);
  const std::string huge = "0 2000000000 0 2000000000 0 2000000000";
  EXPECT_EQ(Edited("inline-zlib.vti")
                .replace(whole, "WholeExtent=\"" + huge + "\"")
                .replace(piece, "Piece Extent=\"" + huge + "\"")
                .refusal(),
            ErrorCode::LimitExceeded);
  const std::string large = "0 20000 0 20000 0 20000";
  EXPECT_EQ(Edited("inline-zlib.vti")
                .replace(whole, "WholeExtent=\"" + large + "\"")
                .replace(piece, "Piece Extent=\"" + large + "\"")
                .refusal(),
            ErrorCode::PixelDataShort);
  EXPECT_EQ(Edited("inline.vti").replace(whole, "WholeExtent=\"0 -4 0 3 0 2\"").refusal(),
            ErrorCode::NotBuiltYet);
  EXPECT_EQ(Edited("inline.vti").replace(whole, "WholeExtent=\"a b\"").refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Edited("inline.vti").replace("Spacing=\"0.5 ", "Spacing=\"nan ").refusal(),
            ErrorCode::GeometryRefused);
  EXPECT_EQ(Edited("inline.vti").replace("Spacing=\"0.5 ", "Spacing=\"0 ").refusal(),
            ErrorCode::GeometryRefused);
  EXPECT_EQ(Edited("inline.vti")
                .replace("Direction=\"0.8 -0.6 0 0.6 0.8", "Direction=\"0.8 0.8 0 0.6 0.6")
                .refusal(),
            ErrorCode::GeometryRefused);
  EXPECT_EQ(Edited("inline-zlib.vti").replace("vtkZLib", "vtkLZ4").refusal(), ErrorCode::NotBuiltYet);
  EXPECT_EQ(Edited("inline.vti").replace("type=\"Int16\"", "type=\"String\"").refusal(),
            ErrorCode::NotBuiltYet);
  EXPECT_EQ(Edited("inline.vti")
                .replace("type=\"Int16\" Name", "type=\"Int16\" NumberOfComponents=\"3\" Name")
                .refusal(),
            ErrorCode::NotBuiltYet);
  EXPECT_EQ(Edited("inline.vti").replace("type=\"ImageData\"", "type=\"PolyData\"").refusal(),
            ErrorCode::NotBuiltYet);
  EXPECT_EQ(Edited("inline.vti")
                .replace("format=\"binary\"", "format=\"morse\"")
                .replace("format=\"binary\"", "format=\"morse\"")
                .refusal(),
            ErrorCode::FileDamaged);
  EXPECT_EQ(Edited("int16.vti").replace("encoding=\"raw\"", "encoding=\"raw2\"").refusal(),
            ErrorCode::FileDamaged);
  EXPECT_EQ(Edited("int16.vti")
                .replace("offset=\"0\"", "offset=\"99999\"")
                .replace("offset=\"6", "offset=\"9996")
                .refusal(),
            ErrorCode::FileDamaged);
  EXPECT_EQ(Edited("ascii.vti").replace("<DataArray type=\"Int16\"", "<DataArray type=\"UInt8\"").refusal(),
            ErrorCode::FileDamaged);
  EXPECT_EQ(Edited("inline.vti").replace("?>", "?><!DOCTYPE a [<!ENTITY b \"c\">]>").refusal(),
            ErrorCode::FileDamaged);
}

TEST(Vti, DeepXmlAndLongTagsEnd) {
  Edited deep("inline.vti");
  std::string open;
  for (int i = 0; i < 100'000; ++i) open += "<a>";
  EXPECT_EQ(deep.replace("<PointData", open + "<PointData").refusal(), ErrorCode::FileDamaged);
  Edited longTag("inline.vti");
  EXPECT_EQ(longTag.replace("<PointData", "<PointData x=\"" + std::string(3 << 20, 'a') + "\"").refusal(),
            ErrorCode::FileDamaged);
}

// Damaged in a thousand places each: refused, or read with voxels that differ at most, never a crash or a
// hang.
TEST(Vti, CutAndFlippedFilesEndWell) {
  for (const char* name :
       {"inline-zlib-blocks.vti", "appended-zlib-blocks.vti", "appended-base64.vti", "ascii.vti"}) {
    Edited e(name);
    const std::string whole = e.bytes;
    for (std::size_t n = 0; n < whole.size(); n += 7) {
      e.bytes = whole.substr(0, n);
      (void)e.read();
    }
    for (std::uint64_t k = 0; k < 1000; ++k) {
      e.bytes = whole;
      const std::size_t at = static_cast<std::size_t>(randomUnit(3, k) * static_cast<double>(whole.size()));
      e.bytes[at] = static_cast<char>(256 * randomUnit(4, k));
      const auto v = e.read();
      if (!v.ok()) continue;
      EXPECT_LE((*v)->bytes(), std::size_t{1} << 20);
    }
  }
}

}  // namespace
}  // namespace vernier
