// SPDX-License-Identifier: GPL-3.0-or-later
// Files of colours, written here byte by byte: every format gives the colours that went in.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "ColourCases.h"
#include "vernier/base/Random.h"
#include "vernier/study/Files.h"

namespace vernier {
namespace {
using namespace test;
using ::testing::HasSubstr;

std::string nifti(int channels, const std::string& voxels) {
  std::string s(352, '\0');
  put<std::int32_t>(s, 0, 348);
  const std::int16_t dim[] = {3, kColumns, kRows, kSlices, 1, 1, 1, 1};
  for (std::size_t d = 0; d < 8; ++d) put(s, 40 + 2 * d, dim[d]);
  put<std::int16_t>(s, 70, channels == 3 ? 128 : 2304);
  put<std::int16_t>(s, 72, static_cast<std::int16_t>(8 * channels));
  put<float>(s, 108, 352);
  s[123] = 2;
  put<std::int16_t>(s, 254, 1);
  put<float>(s, 280, -1), put<float>(s, 300, -2), put<float>(s, 320, 3);
  std::memcpy(s.data() + 344, "n+1", 3);
  return s + voxels;
}

TEST(ColourFiles, Nifti) {
  for (const int channels : {3, 4}) {
    Folder f;
    const std::string file = nifti(channels, interleaved(channels));
    expectTruth(f.read("a.nii", file), channels);
    expectTruth(f.read("b.nii.gz", deflated(file, kGzipBits)), channels);
    // The standard: slope and intercept say nothing of colours.
    std::string scaled = file;
    put<float>(scaled, 112, 2), put<float>(scaled, 116, NAN);
    expectTruth(f.read("c.nii", scaled), channels);
    std::string wrong = file;
    put<std::int16_t>(wrong, 72, 8);
    EXPECT_EQ(f.refusal("d.nii", wrong).code, ErrorCode::FileDamaged);
    EXPECT_EQ(f.refusal("e.nii", file.substr(0, file.size() - 1)).code, ErrorCode::PixelDataShort);
  }
}

TEST(ColourFiles, OneFrameOfMany) {
  Folder f;
  std::string file = nifti(3, std::string(interleaved(3).size(), '\7') + interleaved(3));
  put<std::int16_t>(file, 40, 4), put<std::int16_t>(file, 48, 2);
  f.write("a.nii", file);
  BuildOptions o;
  o.frame = 1;
  expectTruth(f.read("a.nii", o), 3);
  o.frame = 0;
  EXPECT_EQ((*f.read("a.nii", o))->rgba(4, 3, 2), (Rgba{7, 7, 7, 255}));
}

std::string planes(int channels) {
  std::string s;
  const std::string all = interleaved(channels);
  for (int c = 0; c < channels; ++c)
    for (std::size_t at = static_cast<std::size_t>(c); at < all.size();
         at += static_cast<std::size_t>(channels))
      s.push_back(all[at]);
  return s;
}

const std::string kSizes =
    std::to_string(kColumns) + " " + std::to_string(kRows) + " " + std::to_string(kSlices);

std::string nrrd(const std::string& kind, int channels, const std::string& encoding = "raw",
                 const std::string& type = "uint8") {
  return "NRRD0005\ntype: " + type + "\ndimension: 4\nsizes: " + std::to_string(channels) + " " + kSizes +
         "\nkinds: " + kind + " domain domain domain\nspace: LPS\nspace directions: none (1,0,0) (0,2,0) " +
         "(0,0,3)\nspace origin: (0,0,0)\nendian: little\nencoding: " + encoding + "\n\n";
}

TEST(ColourFiles, NrrdOfEveryKindOfColour) {
  for (const auto& [kind, channels] :
       {std::pair{"RGB-color", 3}, std::pair{"3-color", 3}, std::pair{"3-vector", 3}, std::pair{"vector", 3},
        std::pair{"RGBA-color", 4}, std::pair{"4-color", 4}, std::pair{"4-vector", 4},
        std::pair{"vector", 4}}) {
    SCOPED_TRACE(kind);
    Folder f;
    const auto v = f.read("a.nrrd", nrrd(kind, channels) + interleaved(channels));
    expectTruth(v, channels);
    EXPECT_EQ(has((*v)->info().findings, "colours-assumed"), std::string(kind).ends_with("vector"));
    EXPECT_EQ((*v)->grid().spacing_mm(), glm::dvec3(1, 2, 3));
    expectTruth(f.read("b.nrrd", nrrd(kind, channels, "gzip") + deflated(interleaved(channels), kGzipBits)),
                channels);
  }
  std::string text;
  for (const char c : interleaved(3)) text += std::to_string(static_cast<unsigned char>(c)) + " ";
  Folder f;
  expectTruth(f.read("c.nrrd", nrrd("RGB-color", 3, "ascii") + text), 3);
}

TEST(ColourFiles, NrrdOfPlanes) {
  for (const int channels : {3, 4}) {
    const std::string head = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: " + kSizes + " " +
                             std::to_string(channels) + "\nkinds: domain domain domain " +
                             std::to_string(channels) +
                             "-color\nspacings: 1 2 3 nan\nencoding: raw\nsample units: HU\n\n";
    Folder f;
    expectTruth(f.read("a.nrrd", head + planes(channels)), channels);
    EXPECT_EQ(f.refusal("b.nrrd", head + planes(channels).substr(1)).code, ErrorCode::PixelDataShort);
  }
}

TEST(ColourFiles, NrrdThatIsNoColour) {
  Folder f;
  const std::string voxels(5 * 4 * interleaved(1).size(), '\1');
  for (const int n : {2, 5}) {
    const Error e = f.refusal("a.nrrd", nrrd("vector", n) + voxels);
    EXPECT_EQ(e.code, ErrorCode::NotBuiltYet);
    EXPECT_THAT(e.sentence, HasSubstr("has " + std::to_string(n) + " values of type uint8 per voxel"));
  }
  EXPECT_THAT(f.refusal("b.nrrd", nrrd("RGB-color", 3, "raw", "short") + voxels).sentence,
              HasSubstr("int16"));
  EXPECT_EQ(f.refusal("c.nrrd", nrrd("RGB-color", 4) + voxels).code, ErrorCode::FileDamaged);
  for (const char* kind : {"list", "HSV-color", "XYZ-color", "point", "3-normal"})
    EXPECT_EQ(f.refusal("d.nrrd", nrrd(kind, 3) + voxels).code, ErrorCode::NotBuiltYet) << kind;
  std::string placed = nrrd("RGB-color", 3);
  placed.replace(placed.find("none"), 4, "(1,1,1)");
  EXPECT_EQ(f.refusal("e.nrrd", placed + voxels).code, ErrorCode::FileDamaged);
  const std::string between =
      "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 5 3 4 3\nkinds: domain RGB-color "
      "domain domain\nspacings: 1 nan 1 1\nencoding: raw\n\n";
  EXPECT_THAT(f.refusal("f.nrrd", between + voxels).sentence, HasSubstr("between others"));
}

// Diffusion series end with a vector that is no colour.
TEST(ColourFiles, AVectorBehindSpaceIsAListOfVolumes) {
  Folder f;
  f.write("a.nrrd", "NRRD0005\ntype: uint8\ndimension: 4\nsizes: " + kSizes +
                        " 3\nkinds: domain domain domain vector\nspacings: 1 1 1 nan\nencoding: raw\n\n" +
                        planes(3));
  EXPECT_EQ(readVolumeFacts(*recordOf((f.dir.path() / "a.nrrd").string()))->frames, 3);
  BuildOptions o;
  o.frame = 1;
  const auto v = f.read("a.nrrd", o);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_FALSE((*v)->isColour());
  EXPECT_EQ((*v)->stored(1, 3, 2), truth(1, 1, 3, 2));
}

std::string meta(int channels, const std::string& more = "") {
  return "ObjectType = Image\nNDims = 3\nDimSize = " + kSizes +
         "\nElementSpacing = 1 2 3\nElementType = MET_UCHAR\nElementNumberOfChannels = " +
         std::to_string(channels) + "\n" + more + "ElementDataFile = LOCAL\n";
}

TEST(ColourFiles, MetaImage) {
  for (const int channels : {3, 4}) {
    Folder f;
    const std::string voxels = interleaved(channels);
    expectTruth(f.read("a.mha", meta(channels) + voxels), channels);
    expectTruth(f.read("b.mha", meta(channels, "CompressedData = True\n") + deflated(voxels)), channels);
    f.write("c.raw", "head" + voxels);
    std::string beside = meta(channels, "HeaderSize = -1\n");
    beside.replace(beside.find("LOCAL"), 5, "c.raw");
    expectTruth(f.read("c.mhd", beside), channels);
    const auto scaled = f.read("d.mha", meta(channels, "ElementToIntensityFunctionSlope = 2\n") + voxels);
    expectTruth(scaled, channels);
    EXPECT_TRUE(has((*scaled)->info().findings, "rescale-not-applied"));
    EXPECT_EQ(f.refusal("e.mha", meta(channels) + voxels.substr(1)).code, ErrorCode::PixelDataShort);
    EXPECT_FALSE(
        f.read("f.mha", meta(channels, "CompressedData = True\n") + deflated(voxels).substr(0, 60)).ok());
  }
  Folder f;
  for (const int n : {2, 5})
    EXPECT_THAT(f.refusal("a.mha", meta(n) + interleaved(4) + interleaved(4)).sentence,
                HasSubstr("has " + std::to_string(n) + " values"));
  for (const int n : {0, -3}) EXPECT_EQ(f.refusal("a.mha", meta(n)).code, ErrorCode::FileDamaged);
}

std::string vti(int channels, const std::string& array, const std::string& behind = "",
                const std::string& type = "UInt8") {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt32\">\n<ImageData WholeExtent=\"0 4 0 3 0 2\" Origin=\"0 0 0\" Spacing=\"1 2 3\">"
         "<Piece Extent=\"0 4 0 3 0 2\"><PointData Scalars=\"c\"><DataArray type=\"" +
         type + "\" Name=\"c\" NumberOfComponents=\"" + std::to_string(channels) + "\" " + array +
         "</DataArray></PointData></Piece></ImageData>" + behind + "</VTKFile>\n";
}

TEST(ColourFiles, Vti) {
  for (const int channels : {3, 4}) {
    Folder f;
    const std::string voxels = interleaved(channels);
    std::string text, length(4, '\0');
    for (const char c : voxels) text += std::to_string(static_cast<unsigned char>(c)) + " ";
    put(length, 0, static_cast<std::uint32_t>(voxels.size()));
    expectTruth(f.read("a.vti", vti(channels, "format=\"ascii\">" + text)), channels);
    const std::string appended = "<AppendedData encoding=\"raw\">_" + length;
    const std::string array = "format=\"appended\" offset=\"0\">";
    expectTruth(f.read("b.vti", vti(channels, array, appended + voxels + "</AppendedData>")), channels);
    EXPECT_FALSE(f.read("c.vti", vti(channels, array, appended + voxels.substr(60))).ok());
  }
  Folder f;
  for (const int n : {2, 5})
    EXPECT_THAT(f.refusal("a.vti", vti(n, "format=\"ascii\">1")).sentence,
                HasSubstr("has " + std::to_string(n) + " values of type uint8"));
  EXPECT_THAT(f.refusal("a.vti", vti(3, "format=\"ascii\">1", "", "Float32")).sentence,
              HasSubstr("has 3 values of type float32"));
  EXPECT_EQ(f.refusal("a.vti", vti(0, "format=\"ascii\">1")).code, ErrorCode::FileDamaged);
}

TEST(ColourFiles, RawWithAJsonFile) {
  for (const int channels : {3, 4}) {
    Folder f;
    nlohmann::json j{{"format", "vernier-raw/1"},
                     {"dims", {kColumns, kRows, kSlices}},
                     {"type", "uint8"},
                     {"channels", channels},
                     {"spacing_mm", {1, 2, 3}}};
    f.write("v.raw", interleaved(channels));
    expectTruth(f.read("v.raw.json", j.dump()), channels);
    f.write("v.raw", interleaved(channels).substr(1));
    EXPECT_EQ(f.refusal("v.raw.json", j.dump()).code, ErrorCode::PixelDataShort);
    for (const char* grey : {"slope", "intercept", "no_data", "unit"}) {
      nlohmann::json odd = j;
      odd[grey] = std::string(grey) == "unit" ? nlohmann::json("HU") : nlohmann::json(2);
      EXPECT_THAT(f.refusal("v.raw.json", odd.dump()).sentence, HasSubstr(std::string("/") + grey));
    }
    for (const int n : {2, 5, 0, -1}) {
      j["channels"] = n;
      EXPECT_EQ(f.refusal("v.raw.json", j.dump()).code,
                n > 0 ? ErrorCode::NotBuiltYet : ErrorCode::FileDamaged);
    }
    j["channels"] = channels, j["type"] = "int8";
    EXPECT_THAT(f.refusal("v.raw.json", j.dump()).sentence, HasSubstr("values of type int8"));
  }
}

const Finding* findingOf(const Volume& v, const std::string& code) {
  for (const Finding& f : v.info().findings)
    if (f.code == code) return &f;
  return nullptr;
}

// 60 voxels with the alphas of `alpha`, the rest opaque.
std::string withAlphas(const std::string& alpha, char rest) {
  std::string s = interleaved(4);
  for (std::size_t v = 0; 4 * v < s.size(); ++v) s[4 * v + 3] = v < alpha.size() ? alpha[v] : rest;
  return s;
}

TEST(ColourFiles, OpacityIsCounted) {
  Folder f;
  const auto some = f.read("a.nii", nifti(4, withAlphas(std::string("\0\0\1\x80\xfe", 5), '\xff')));
  ASSERT_TRUE(some.ok());
  const Finding* const counted = findingOf(**some, "alpha-channel");
  ASSERT_TRUE(counted);
  EXPECT_EQ(counted->severity, Severity::Notice);
  EXPECT_THAT(counted->sentence, HasSubstr("2 voxels are not seen, 3 in part"));
  EXPECT_EQ((*some)->rgba(3, 0, 0)[3], 0x80);
  const auto all = f.read("b.nii", nifti(4, withAlphas("", '\xff')));
  ASSERT_TRUE(all.ok());
  EXPECT_EQ((*all)->info().channels, 4);
  EXPECT_EQ(findingOf(**all, "alpha-channel")->severity, Severity::Info);
  const auto three = f.read("c.nii", nifti(3, interleaved(3)));
  EXPECT_FALSE(findingOf(**three, "alpha-channel"));
}

TEST(ColourFiles, OpacityThatHidesEverythingIsLeftOut) {
  Folder f;
  const auto v = f.read("a.nii", nifti(4, withAlphas("", '\0')));
  expectTruth(v, 3);
  ASSERT_TRUE(findingOf(**v, "alpha-empty"));
  EXPECT_EQ(findingOf(**v, "alpha-empty")->severity, Severity::Warning);
}

TEST(ColourFiles, AnImageOfAVolumeShowsItsColours) {
  Folder f;
  for (const int channels : {3, 4}) {
    const auto v = f.read("a.nii", nifti(channels, interleaved(channels)));
    ASSERT_TRUE(v.ok());
    const auto image = imageOfVolume(**v, 2, {});
    ASSERT_TRUE(image.ok()) << image.error().text();
    EXPECT_TRUE((*image)->isColour());
    for (int j = 0; j < kRows; ++j)
      for (int i = 0; i < kColumns; ++i)
        for (int c = 0; c < 3; ++c) ASSERT_EQ((*image)->stored(i, j, c), truth(c, i, j, 2));
    EXPECT_EQ((*image)->rgb(1, 2), glm::dvec3(22, 122, 203) / 255.0);
    // Alpha is 255 at one pixel of twenty.
    EXPECT_EQ(has((*image)->info().findings, "alpha-not-shown"), channels == 4);
    if (channels == 3) continue;
    EXPECT_EQ(std::get<double>((*image)->info().findings.back().numbers.at("pixels")), 19);
  }
}

TEST(ColourFiles, TheBudgetCountsEveryChannel) {
  Folder f;
  f.write("a.nii", nifti(4, interleaved(4)));
  MemoryBudget enough(240), less(239);
  BuildOptions o;
  o.budget = &less;
  const auto refused = f.read("a.nii", o);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::OutOfMemory);
  o.budget = &enough;
  const auto v = f.read("a.nii", o);
  ASSERT_TRUE(v.ok()) << v.error().text();
  EXPECT_EQ((*v)->bytes(), 240u);
}

// Cut anywhere: refused. Flipped anywhere: refused, or read as some volume; never a crash.
TEST(ColourFiles, DamagedFilesEndWell) {
  const std::string voxels = interleaved(4);
  std::string text;
  for (const char c : voxels) text += std::to_string(static_cast<unsigned char>(c)) + " ";
  const std::pair<const char*, std::string> files[] = {{"a.nii", nifti(4, voxels)},
                                                       {"a.nrrd", nrrd("RGBA-color", 4) + voxels},
                                                       {"a.mha", meta(4) + voxels},
                                                       {"a.vti", vti(4, "format=\"ascii\">" + text)}};
  for (const auto& [name, whole] : files) {
    SCOPED_TRACE(name);
    Folder f;
    const std::size_t end = whole.find("</DataArray>");  // what follows the voxels is not needed
    for (std::size_t n = 1; n + 3 < std::min(end, whole.size()); n += 7)
      EXPECT_FALSE(f.read(name, whole.substr(0, n)).ok()) << n;
    for (std::uint64_t k = 0; k < 400; ++k) {
      std::string bytes = whole;
      bytes[static_cast<std::size_t>(randomUnit(7, k) * static_cast<double>(whole.size()))] =
          static_cast<char>(256 * randomUnit(8, k));
      (void)f.read(name, bytes);
    }
  }
}

}  // namespace
}  // namespace vernier
