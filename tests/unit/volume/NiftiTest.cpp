// SPDX-License-Identifier: GPL-3.0-or-later
// NIfTI files that nibabel wrote and read (files/make_nifti.py), and the same with single header fields
// changed.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "FileCases.h"
#include "vernier/study/Files.h"
#include "vernier/volume/VolumeFile.h"

namespace vernier {
namespace {
using nlohmann::json;
using test::bytesOfFile;
using test::has;
using ::testing::HasSubstr;

const std::filesystem::path kFiles = std::filesystem::path(VERNIER_SOURCE_DIR) / "tests/unit/volume/files";

std::vector<std::string> namesOf(const json& cases) {
  std::vector<std::string> names;
  for (const auto& [name, facts] : cases.items()) names.push_back(name);
  return names;
}
const json& cases() {
  static const json all = json::parse(std::ifstream(kFiles / "nifti.json"));
  return all;
}

class Nifti : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Nibabel, Nifti, ::testing::ValuesIn(namesOf(cases())), [](const auto& i) {
  std::string name = i.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

TEST_P(Nifti, EqualsWhatNibabelReads) {
  const json& truth = cases().at(GetParam());
  const std::int64_t n[] = {truth["dims"][0], truth["dims"][1],
                            truth["dims"].size() > 2 ? truth["dims"][2].get<int>() : 1};
  const std::size_t perFrame = static_cast<std::size_t>(n[0] * n[1] * n[2]);
  const std::size_t frames = truth["stored"].size() / perFrame;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    BuildOptions options;
    if (frames > 1) options.frame = static_cast<std::int64_t>(frame);
    const auto read = readVolumeFile((kFiles / GetParam()).string(), options);
    ASSERT_TRUE(read.ok()) << read.error().text();
    const Volume& v = **read;
    EXPECT_EQ(v.grid().columns, n[0]);
    EXPECT_EQ(v.grid().rows, n[1]);
    EXPECT_EQ(v.grid().slices, n[2]);
    for (std::size_t p = 0; p < perFrame; ++p) {
      const auto i = static_cast<std::int64_t>(p) % n[0], j = static_cast<std::int64_t>(p) / n[0] % n[1],
                 k = static_cast<std::int64_t>(p) / (n[0] * n[1]);
      const double stored = truth["stored"][frame * perFrame + p],
                   value = truth["value"][frame * perFrame + p];
      const bool rounded = truth["type"] == "float64";
      EXPECT_EQ(v.stored(i, j, k), rounded ? static_cast<double>(static_cast<float>(stored)) : stored);
      EXPECT_NEAR(v.modality(i, j, k), value, (rounded ? 1e-7 : 1e-15) * std::abs(value));
    }
    if (truth["affine_lps"].is_null()) {
      EXPECT_TRUE(has(v.info().findings, "axes-unknown"));
      const glm::dvec3 s = v.grid().spacing_mm();
      for (int a = 0; a < 3; ++a)
        EXPECT_NEAR(s[a], truth["zooms_mm"][static_cast<std::size_t>(a)].get<double>(), 1e-12);
      continue;
    }
    EXPECT_FALSE(has(v.info().findings, "axes-unknown"));
    const glm::dmat4 m = v.grid().patientFromVoxel.matrix();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        EXPECT_NEAR(m[column][row],
                    truth["affine_lps"][static_cast<std::size_t>(row)][static_cast<std::size_t>(column)]
                        .get<double>(),
                    1e-12)
            << row << "," << column;
  }
}

TEST(NiftiFiles, SayWhatIsOddAboutThem) {
  const auto findings = [](const char* name) {
    const auto facts = readVolumeFacts(*recordOf((kFiles / name).string()));
    EXPECT_TRUE(facts.ok()) << facts.error().text();
    return facts ? facts->info.findings : std::vector<Finding>{};
  };
  EXPECT_TRUE(has(findings("both-differ.nii"), "qform-sform-differ"));
  EXPECT_TRUE(has(findings("no-unit.nii"), "length-unit-assumed"));
  EXPECT_TRUE(findings("int16.nii").empty());
  EXPECT_TRUE(findings("qform-left.nii").empty());
  const auto read = [](const char* name) { return (*readVolumeFile((kFiles / name).string()))->info(); };
  EXPECT_TRUE(has(read("float64.nii").findings, "double-pixels-rounded"));
  EXPECT_TRUE(has(read("uint64.nii").findings, "values-converted"));
  EXPECT_EQ(read("scaled.nii.gz").unit, "stored value") << "a unit is never guessed";
  EXPECT_EQ(read("scaled.nii.gz").title, "scaled");
}

TEST(NiftiFiles, OfSeveralVolumesOneIsChosen) {
  const std::string path = (kFiles / "time.nii.gz").string();
  EXPECT_EQ(readVolumeFacts(*recordOf(path))->frames, 3);
  const auto none = readVolumeFile(path);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, ErrorCode::OptionInvalid);
  EXPECT_THAT(none.error().sentence, HasSubstr("3 volumes"));
  for (const std::int64_t bad : {std::int64_t{-1}, std::int64_t{3}, INT64_MAX}) {
    BuildOptions o;
    o.frame = bad;
    EXPECT_EQ(readVolumeFile(path, o).error().code, ErrorCode::OptionInvalid) << bad;
  }
}

TEST(NiftiFiles, APairIsOpenedByEitherNameAndListedOnce) {
  for (const char* name : {"pair.hdr", "pair.img"})
    EXPECT_EQ((*readVolumeFile((kFiles / name).string()))->grid().columns, 4) << name;
  test::TempDir dir;
  for (const char* name : {"pair.hdr", "pair.img"})
    std::filesystem::copy_file(kFiles / name, dir.path() / name);
  auto set = scanStudy({dir.path().string()});
  ASSERT_TRUE(set.ok());
  const auto found = findVolumeFiles(*set);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(set->files[found[0].file].shown, "pair.hdr");
  std::filesystem::remove(dir.path() / "pair.img");
  const auto alone = readVolumeFile((dir.path() / "pair.hdr").string());
  ASSERT_FALSE(alone.ok());
  EXPECT_EQ(alone.error().code, ErrorCode::FileNotFound);
  EXPECT_EQ(alone.error().where, "pair.img");
}

// int16.nii with some bytes changed.
struct Changed {
  explicit Changed(const char* name = "int16.nii") : bytes(bytesOfFile(kFiles / name)) {}
  test::TempDir dir;
  std::string bytes;
  template <class T>
  Changed& put(std::size_t offset, T value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    return *this;
  }
  Result<std::shared_ptr<const Volume>> read() {
    const auto path = dir.path() / "changed.nii";
    std::ofstream(path, std::ios::binary) << bytes;
    return readVolumeFile(path.string());
  }
  ErrorCode refusal() {
    const auto v = read();
    EXPECT_FALSE(v.ok());
    if (v.ok()) return ErrorCode::Internal;
    EXPECT_GT(v.error().sentence.size(), 20u);
    EXPECT_EQ(v.error().where.find('/'), std::string::npos);
    return v.error().code;
  }
};
constexpr std::size_t kDim = 40, kType = 70, kBits = 72, kPixdim = 76, kOffset = 108, kSlope = 112,
                      kInter = 116, kUnits = 123, kCalMax = 124, kQformCode = 252, kSformCode = 254,
                      kQuatern = 256, kSrow = 280;

TEST(NiftiHeaders, WrongSizesAreRefused) {
  using S = std::int16_t;
  EXPECT_EQ(Changed().put<S>(kDim, 0).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<S>(kDim, 8).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<S>(kDim + 2, 0).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<S>(kDim + 4, -3).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<S>(kDim + 6, 3).refusal(), ErrorCode::PixelDataShort);
  EXPECT_EQ(Changed().put<S>(kDim + 2, 32767).put<S>(kDim + 4, 32767).put<S>(kDim + 6, 32767).refusal(),
            ErrorCode::PixelDataShort);
  EXPECT_EQ(Changed().put<S>(kBits, 8).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<float>(kOffset, 1e30f).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<float>(kOffset, NAN).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<float>(kOffset, -352).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<float>(kOffset, 352.5f).refusal(), ErrorCode::FileDamaged);
  EXPECT_EQ(Changed().put<float>(kOffset, 100'000).refusal(), ErrorCode::PixelDataShort);
  Changed cut;
  cut.bytes.pop_back();
  EXPECT_EQ(cut.refusal(), ErrorCode::PixelDataShort);
  Changed longer;
  longer.bytes += "more";
  const auto read = longer.read();
  ASSERT_TRUE(read.ok());
  EXPECT_TRUE(has((*read)->info().findings, "bytes-after-voxels"));
}

TEST(NiftiHeaders, FiveDimensionsOddTypesAndAnalyzeAreRefused) {
  using S = std::int16_t;
  const auto five = Changed().put<S>(kDim, 5).put<S>(kDim + 8, 1).put<S>(kDim + 10, 3).read();
  ASSERT_FALSE(five.ok());
  EXPECT_EQ(five.error().code, ErrorCode::NotBuiltYet);
  EXPECT_THAT(five.error().sentence, HasSubstr("5 dimensions"));
  EXPECT_TRUE(Changed().put<S>(kDim, 5).put<S>(kDim + 8, 1).put<S>(kDim + 10, 1).read().ok())
      << "none beyond three";
  for (const S type : {S{1}, S{32}, S{1536}, S{1792}, S{2048}, S{0}, S{-2}})
    EXPECT_EQ(Changed().put<S>(kType, type).refusal(), ErrorCode::NotBuiltYet) << type;
  const auto analyze = Changed().put<std::int32_t>(344, 0).read();
  ASSERT_FALSE(analyze.ok());
  EXPECT_THAT(analyze.error().sentence, HasSubstr("Analyze"));
}

TEST(NiftiHeaders, AnAffineThatPlacesNothingIsRefused) {
  for (const float bad : {NAN, INFINITY, -INFINITY})
    for (const std::size_t at : {0, 5, 11})
      EXPECT_EQ(Changed().put<float>(kSrow + 4 * at, bad).refusal(), ErrorCode::GeometryRefused) << at;
  Changed zero;
  for (std::size_t at = 0; at < 12; ++at) zero.put<float>(kSrow + 4 * at, 0);
  EXPECT_EQ(zero.refusal(), ErrorCode::GeometryRefused);
  Changed flat;  // two axes in one direction
  for (const std::size_t row : {0, 1, 2}) {
    float x;
    std::memcpy(&x, flat.bytes.data() + kSrow + 16 * row, 4);
    flat.put<float>(kSrow + 16 * row + 4, 2 * x);
  }
  EXPECT_EQ(flat.refusal(), ErrorCode::GeometryRefused);
  EXPECT_EQ(Changed().put<float>(kSrow, 1e5f).refusal(), ErrorCode::GeometryRefused)
      << "100 m between voxels";
  for (const float bad : {NAN, INFINITY, 1.5f}) {
    EXPECT_EQ(Changed("qform.nii").put<float>(kQuatern, bad).refusal(), ErrorCode::GeometryRefused) << bad;
    if (bad == 1.5f) continue;
    EXPECT_EQ(Changed("qform.nii").put<float>(kPixdim + 4, bad).refusal(), ErrorCode::GeometryRefused) << bad;
    EXPECT_EQ(Changed("qform.nii").put<float>(kQuatern + 12, bad).refusal(), ErrorCode::GeometryRefused)
        << bad;
  }
  EXPECT_EQ(Changed("qform.nii").put<float>(kPixdim + 8, 0).refusal(), ErrorCode::GeometryRefused);
  const auto negative = Changed("qform.nii").put<float>(kPixdim + 4, -0.7f).read();
  ASSERT_TRUE(negative.ok());
  EXPECT_TRUE(has((*negative)->info().findings, "negative-spacing"));
  EXPECT_EQ(Changed().put<std::uint8_t>(kUnits, 5).refusal(), ErrorCode::FileDamaged);
}

TEST(NiftiHeaders, ScalingThatCannotBeUsed) {
  EXPECT_EQ((*Changed().put<float>(kSlope, 0).put<float>(kInter, 7).read())->info().rescale[0],
            ModalityRescale{});
  EXPECT_EQ((*Changed().put<float>(kSlope, NAN).put<float>(kInter, NAN).read())->info().unscaled, false);
  for (const auto& [slope, inter] : {std::pair{NAN, 0.f}, std::pair{INFINITY, 0.f}, std::pair{2.f, NAN}}) {
    const auto v = Changed().put<float>(kSlope, slope).put<float>(kInter, inter).read();
    ASSERT_TRUE(v.ok());
    EXPECT_TRUE((*v)->info().unscaled);
    EXPECT_TRUE(has((*v)->info().findings, "rescale-invalid"));
    EXPECT_EQ((*v)->info().rescale[0], ModalityRescale{});
  }
}

TEST(NiftiHeaders, CalMinAndMaxAreAWindow) {
  const auto v = Changed().put<float>(kCalMax, 300).put<float>(kCalMax + 4, -100).read();
  ASSERT_TRUE(v.ok());
  ASSERT_EQ((*v)->info().windows.size(), 1u);
  EXPECT_EQ((*v)->info().windows[0].center, 100);
  EXPECT_EQ((*v)->info().windows[0].width, 400);
  EXPECT_EQ((*v)->info().windows[0].function, VoiFunction::LinearExact);
}

TEST(NiftiValues, ThatDoNotFitIn32BitsAreRefused) {
  Changed big("int64.nii");
  EXPECT_EQ(big.put<std::int64_t>(352, std::int64_t{1} << 31).refusal(), ErrorCode::PixelDescriptionInvalid);
  Changed wide("float64.nii");
  EXPECT_EQ(wide.put<double>(352, 1e300).refusal(), ErrorCode::PixelDescriptionInvalid);
  Changed odd("float64.nii");
  const auto v = odd.put<double>(352, NAN).put<double>(360, INFINITY).read();
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_TRUE(has((*v)->info().findings, "non-finite-voxels"));
  EXPECT_TRUE((*v)->probe(0, 0, 0).noData);
}

// A flipped bit anywhere in packed voxels is found by the checksum, and every shorter file is refused.
TEST(NiftiPacked, DamageIsFound) {
  const std::string whole = bytesOfFile(kFiles / "sheared.nii.gz");
  test::TempDir dir;
  const std::string path = (dir.path() / "x.nii.gz").string();
  const auto read = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    return readVolumeFile(path);
  };
  ASSERT_TRUE(read(whole).ok());
  for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_FALSE(read(whole.substr(0, n)).ok()) << n;
  const auto good = read(whole);
  int refused = 0;
  for (std::size_t at = 10; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    const auto v = read(bytes);
    refused += !v.ok();
    if (!v.ok()) continue;
    EXPECT_EQ(std::memcmp((*v)->data(), (*good)->data(), (*v)->bytes()), 0) << at;
  }
  EXPECT_GT(refused, static_cast<int>(whole.size()) - 30);
  EXPECT_TRUE(read(whole + "something after it").ok());
}

}  // namespace
}  // namespace vernier
