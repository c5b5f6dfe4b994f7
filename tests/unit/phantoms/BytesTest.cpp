// SPDX-License-Identifier: GPL-3.0-or-later
// Same bytes on every run, with any number of threads, and equal to datasets-synthetic/manifest.sha256. Where
// the manifest no longer holds because a recipe was changed on purpose, VERNIER_WRITE_MANIFEST=1 writes it
// anew.
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "Files.h"
#include "TestData.h"
#include "TestPaths.h"
#include "vernier/base/Threads.h"

namespace vernier::test {
namespace {

struct Variant {
  std::string name;
  std::map<std::string, std::string> settings;
  std::string text() const {
    std::string t = name;
    for (const auto& [key, value] : settings) t.append(" ").append(key).append("=").append(value);
    return t;
  }
};

// Each recipe once, large ones small, and some settings that take other paths through the generator.
std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (const PhantomRecipe& recipe : phantomRecipes()) {
    Variant v{recipe.name, {}};
    for (const PhantomSetting& s : recipe.settings)
      if (s.name == "scale") v.settings["scale"] = "0.125";
    all.push_back(v);
  }
  all.push_back(
      {"orientation", {{"plane", "sagittal"}, {"flip", "5"}, {"left-handed", "yes"}, {"scale", "0.5"}}});
  all.push_back({"ruler", {{"oblique", "25"}, {"slice-aspect", "50"}, {"scale", "0.25"}}});
  all.push_back({"gaussian-vessel", {{"sigma", "0.5"}}});
  all.push_back({"marschner-lobb", {{"n", "64"}}});
  all.push_back({"duplicate", {{"kind", "position"}}});
  all.push_back({"small-ct", {{"seed", "7"}}});
  all.push_back({"enhanced-ct", {{"parts", "2"}}});
  all.push_back({"enhanced-mr", {{"contrast", "diffusion"}}});
  all.push_back({"dose", {{"bits", "16"}, {"offsets", "absolute"}}});
  return all;
}

std::string contentOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// SHA-256 over all files by name: name, length, bytes.
std::string digestOf(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  EVP_DigestInit_ex(context, EVP_sha256(), nullptr);
  for (const auto& file : files) {
    const std::string bytes = contentOf(file);
    const std::string head =
        std::filesystem::relative(file, folder).string() + "\n" + std::to_string(bytes.size()) + "\n";
    EVP_DigestUpdate(context, head.data(), head.size());
    EVP_DigestUpdate(context, bytes.data(), bytes.size());
  }
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned length = 0;
  EVP_DigestFinal_ex(context, digest, &length);
  EVP_MD_CTX_free(context);
  std::string hex;
  for (unsigned n = 0; n < length; ++n) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", digest[n]);
    hex += two;
  }
  return hex;
}

std::filesystem::path manifestFile() {
  return std::filesystem::path(VERNIER_SOURCE_DIR) / "datasets-synthetic/manifest.sha256";
}

TEST(PhantomBytes, EqualTheManifest) {
  std::map<std::string, std::string> manifest;  // variant -> digest
  std::ifstream in(manifestFile());
  for (std::string line; std::getline(in, line);)
    if (!line.empty() && line[0] != '#') manifest[line.substr(66)] = line.substr(0, 64);
  std::string made =
      "# SHA-256 over the files (DICOM and answers) of a phantom: tests/unit/phantoms/BytesTest.cpp\n";
  const bool write = std::getenv("VERNIER_WRITE_MANIFEST") != nullptr;
  std::size_t checked = 0;
  for (const Variant& v : variants()) {
    TempDir dir;
    const Result<PhantomInfo> info = writeOnly(dir.path(), v.name, v.settings);
    ASSERT_TRUE(info.ok()) << info.error().text();
    const std::string digest = digestOf(dir.path());
    made.append(digest).append("  ").append(v.text()).append("\n");
    if (write) continue;
    EXPECT_EQ(digest, manifest[v.text()]) << v.text();
    ++checked;
  }
  if (write) {
    std::ofstream(manifestFile()) << made;
  } else {
    EXPECT_EQ(checked, manifest.size()) << "the manifest has lines of no variant";
  }
}

TEST(PhantomBytes, DoNotDependOnThreadsOrOnFilesOfAnEarlierRun) {
  const int before = threads();
  for (const char* name : {"small-ct", "syntaxes", "shuffled", "enhanced-ct", "segmentation"}) {
    TempDir dir;
    std::string first;
    for (const int n : {1, 2, 3}) {
      setThreads(n);
      ASSERT_TRUE(writeOnly(dir.path(), name).ok());
      const std::string digest = digestOf(dir.path());
      if (first.empty()) first = digest;
      EXPECT_EQ(digest, first) << name << " with " << n << " threads";
      std::ofstream(dir.path() / name / "OLD.dcm") << "left by an earlier run";
    }
  }
  setThreads(before);
}

TEST(PhantomBytes, ChangeWithTheSeedUidsIncluded) {
  TempDir a, b;
  const Written one = writeAndRead(a.path(), "small-ct"),
                two = writeAndRead(b.path(), "small-ct", {{"seed", "7"}});
  ASSERT_EQ(one.files.size(), two.files.size());
  for (std::size_t k = 0; k < one.files.size(); ++k) {
    EXPECT_NE(one.files[k].sopUid, two.files[k].sopUid);
    EXPECT_NE(one.files[k].stored, two.files[k].stored);
  }
  EXPECT_NE(one.files[0].seriesUid, two.files[0].seriesUid);
}

TEST(PhantomMetaImage, HoldsTheSameVoxelsAsTheDicomFiles) {
  for (const char* name : {"ct-head", "vessels"}) {
    TempDir dir;
    const Written dicom = writeAndRead(dir.path(), name, {{"scale", "0.125"}});
    PhantomOptions options;
    options.settings = {{"scale", "0.125"}};
    options.format = PhantomFormat::MetaImage;
    const Result<PhantomInfo> info = writePhantom(name, dir.path(), options);
    ASSERT_TRUE(info.ok()) << info.error().text();
    const std::string header = contentOf(info->data),
                      raw = contentOf(dir.path() / (std::string(name) + ".raw"));
    EXPECT_NE(header.find("ElementType = MET_SHORT"), std::string::npos);
    EXPECT_NE(header.find("ElementDataFile = " + std::string(name) + ".raw"), std::string::npos);
    std::size_t at = 0;
    for (const ReadFile& f : dicom.files) {
      for (const int v : f.stored) {
        ASSERT_LT(at + 1, raw.size());
        const int word = static_cast<std::int16_t>(static_cast<unsigned char>(raw[at]) |
                                                   static_cast<unsigned char>(raw[at + 1]) << 8);
        ASSERT_EQ(word, v) << f.name;
        at += 2;
      }
    }
    EXPECT_EQ(at, raw.size());
  }
}

TEST(PhantomMetaImage, IsRefusedWhereItCannotHoldTheGeometry) {
  for (const char* name : {"tilt", "gap", "uneven", "duplicate", "syntaxes", "two-orientations"}) {
    TempDir dir;
    PhantomOptions options;
    options.format = PhantomFormat::MetaImage;
    const Result<PhantomInfo> info = writePhantom(name, dir.path(), options);
    ASSERT_FALSE(info.ok()) << name;
    EXPECT_EQ(info.error().code, ErrorCode::OptionInvalid);
  }
}

}  // namespace
}  // namespace vernier::test
