// SPDX-License-Identifier: GPL-3.0-or-later
// The volume files of the shared data against what nibabel and numpy say of them (data/expected/vol_*.json).
#include <gmock/gmock.h>
#include <openssl/sha.h>

#include <nlohmann/json.hpp>

#include "FileCases.h"
#include "vernier/volume/Sampling.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {
using nlohmann::json;
using test::has;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

json expectedObject(const std::string& folder) {
  return json::parse(std::ifstream(test::dataDir() / "expected" / (folder + ".json"))).at("objects").at(0);
}

std::string sha256Of(const Volume& v) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(v.data()), v.bytes(), digest);
  std::string hex;
  for (const unsigned char d : digest) {
    hex += "0123456789abcdef"[d >> 4];
    hex += "0123456789abcdef"[d & 15];
  }
  return hex;
}

void expectValues(const Volume& v, const json& truth) {
  const GridGeometry& g = v.grid();
  EXPECT_EQ(json({g.columns, g.rows, g.slices}), truth["dims_ijk"]);
  double low = INFINITY, high = -INFINITY, sum = 0;
  for (std::int64_t k = 0; k < g.slices; ++k)
    for (std::int64_t j = 0; j < g.rows; ++j)
      for (std::int64_t i = 0; i < g.columns; ++i) {
        const double x = v.stored(i, j, k);
        low = std::min(low, x), high = std::max(high, x), sum += x;
      }
  EXPECT_EQ(low, truth["stored_min"].get<double>());
  EXPECT_EQ(high, truth["stored_max"].get<double>());
  EXPECT_EQ(sum, truth["stored_sum"].get<double>());
  for (const json& p : truth["probes"])
    EXPECT_EQ(v.stored(p["ijk"][0], p["ijk"][1], p["ijk"][2]), p["stored"].get<double>());
}

// As a user does it: the folder is opened, the volume file found in it.
void checkNifti(const std::string& folder) {
  const json truth = expectedObject(folder);
  auto set = scanStudy({(test::dataDir() / folder).string()});
  ASSERT_TRUE(set.ok()) << set.error().text();
  const auto found = findVolumeFiles(*set);
  ASSERT_EQ(found.size(), 1u);
  ASSERT_TRUE(found[0].facts) << found[0].error->text();
  EXPECT_EQ(set->files[found[0].file].shown, truth["file"]);
  EXPECT_EQ(found[0].facts->format, truth["kind"]);
  EXPECT_EQ(found[0].facts->storedType, truth["stored_type"]);
  const auto read = readVolumeFile(set->files[found[0].file]);
  ASSERT_TRUE(read.ok()) << read.error().text();
  const Volume& v = **read;
  expectValues(v, truth);
  EXPECT_EQ(sha256Of(v), truth["stored_sha256_fortran_order"]);
  ASSERT_TRUE(v.modalityRange());
  EXPECT_NEAR(v.modalityRange()->min, truth["value_min"].get<double>(), 1e-9);
  EXPECT_NEAR(v.modalityRange()->max, truth["value_max"].get<double>(), 1e-9);
  const glm::dmat4 m = v.grid().patientFromVoxel.matrix();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)  // the truth is printed to six places
      EXPECT_NEAR(
          m[column][row],
          truth["patientFromVoxel_lps"][static_cast<std::size_t>(row)][static_cast<std::size_t>(column)]
              .get<double>(),
          5.1e-7);
  EXPECT_EQ(glm::determinant(v.grid().patientFromVoxel.linear) > 0, truth["determinant_sign_lps"] == 1);
  for (const json& p : truth["probes"]) {
    const json& at = p["lps_mm"];
    const auto probe =
        probeStored(v, PatientPoint(at[0].get<double>(), at[1].get<double>(), at[2].get<double>()));
    ASSERT_TRUE(probe);
    EXPECT_EQ(json({probe->i, probe->j, probe->k}), p["ijk"]);
    EXPECT_EQ(probe->stored, p["stored"].get<double>());
    EXPECT_NEAR(v.modality(probe->i, probe->j, probe->k), p["value"].get<double>(), 1e-9);
  }
  EXPECT_FALSE(has(v.info().findings, "axes-unknown"));
  EXPECT_FALSE(has(v.info().findings, "qform-sform-differ"));
  EXPECT_EQ(v.info().unit, "stored value");
  if (truth["cal_max"].get<double>() > truth["cal_min"].get<double>()) {
    ASSERT_EQ(v.info().windows.size(), 1u);
    EXPECT_EQ(v.info().windows[0].width, truth["cal_max"].get<double>() - truth["cal_min"].get<double>());
  } else {
    EXPECT_TRUE(v.info().windows.empty());
  }
}

TEST(SharedVolumes, CtaAvm) {
  VERNIER_NEEDS_DATA("vol_cta_avm")
  checkNifti("vol_cta_avm");
}
TEST(SharedVolumes, Engine) {
  VERNIER_NEEDS_DATA("vol_engine")
  checkNifti("vol_engine");
}
TEST(SharedVolumes, MrT1Brain) {
  VERNIER_NEEDS_DATA("vol_mr_t1_brain")
  checkNifti("vol_mr_t1_brain");
}

// A data set of vtk.js is refused by name; its voxels are read as raw with a file beside them.
TEST(SharedVolumes, HeadsqCt) {
  VERNIER_NEEDS_DATA("vol_headsq_ct")
  const json truth = expectedObject("vol_headsq_ct");
  const fs::path folder = test::dataDir() / "vol_headsq_ct";
  auto set = scanStudy({folder.string()});
  ASSERT_TRUE(set.ok());
  const auto found = findVolumeFiles(*set);
  ASSERT_EQ(found.size(), 1u);
  ASSERT_TRUE(found[0].error);
  EXPECT_EQ(set->files[found[0].file].shown, truth["file"]);
  EXPECT_THAT(found[0].error->sentence, HasSubstr("vtk.js"));

  test::TempDir dir;
  fs::copy_file(folder / truth["data_file"].get<std::string>(), dir.path() / "headsq.gz");
  json sidecar{{"format", "vernier-raw/1"},
               {"data", "headsq.gz"},
               {"encoding", "gzip"},
               {"dims", truth["dims_ijk"]},
               {"type", "int16"},
               {"byte_order", "little"},
               {"spacing_mm", truth["spacing_mm"]},
               {"origin_mm", truth["origin"]},
               {"direction", truth["direction_as_written"]}};
  std::ofstream(dir.path() / "headsq.json") << sidecar.dump();
  const auto v = readVolumeFile((dir.path() / "headsq.json").string());
  ASSERT_TRUE(v.ok()) << v.error().text();
  expectValues(**v, truth);
  EXPECT_EQ(sha256Of(**v), truth["stored_sha256"]);
  EXPECT_TRUE(has((*v)->info().findings, "axes-unknown")) << "no letters are claimed";
  const glm::dvec3 s = (*v)->grid().spacing_mm();
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(s[a], truth["spacing_mm"][static_cast<std::size_t>(a)].get<double>(), 1e-4);
  const glm::dmat3& m = (*v)->grid().patientFromVoxel.linear;
  EXPECT_NEAR(std::atan2(m[0].y, m[0].x) * 180 / 3.14159265358979,
              truth["rotation_about_z_deg"].get<double>(), 1e-3);
}

}  // namespace
}  // namespace vernier
