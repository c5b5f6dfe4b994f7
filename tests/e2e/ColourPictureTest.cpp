// SPDX-License-Identifier: GPL-3.0-or-later
// Colour objects of the shared data as pictures of the product, 1:1: their mean against data/expected, and
// pixel by pixel against dcmj2pnm where that can read them.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "RunProgram.h"
#include "Session.h"
#include "TestData.h"
#include "TestPaths.h"
#include "vernier/picture/Quantise.h"

namespace vernier::app {
namespace {
using Json = nlohmann::json;
using test::dataDir;
using test::TempDir;

SessionOptions options() {
  SessionOptions o;
  o.pluginFolders = {std::string(VERNIER_BUILD_DIR) + "/lib/vernier/plugins"};
  return o;
}

struct Shown {
  std::string file;
  Picture picture;
  bool lossy = false;
};

// Frame 0 of each colour object of a folder, as stored.
std::vector<Shown> colourPictures(const std::string& folder) {
  std::vector<Shown> out;
  Session session(options());
  EXPECT_TRUE(session.open({(dataDir() / folder).string()}).ok());
  const StudySet& set = session.study();
  for (std::size_t s = 0; s < set.series.size(); ++s)
    for (std::size_t k = 0; k < set.series[s].stacks.size(); ++k) {
      const Stack& stack = set.series[s].stacks[k];
      for (std::size_t n = 0; n < stack.slices.size(); ++n) {
        const Instance& i = set.instances[stack.slices[n].instance];
        if (!isColour(i.pixels.colourSpace()) || stack.slices[n].frame != 0) continue;
        session.use({s, k});
        Scene scene;
        ImageLayer layer;
        layer.index = static_cast<std::int64_t>(n);
        scene.layers = {layer};
        View view;
        view.width_px = static_cast<int>(i.pixels.columns);
        view.height_px = static_cast<int>(i.pixels.rows);
        // An image with pixels that are not square would be stretched: here each pixel is one pixel.
        RenderOptions render;
        const auto r = session.render(scene, view, {}, render);
        EXPECT_TRUE(r.ok()) << set.files[i.file].shown << " " << (r.ok() ? "" : r.error().text());
        if (!r) continue;
        EXPECT_LE(r->error->max, 0.01) << set.files[i.file].shown;
        out.push_back({set.files[i.file].shown, quantise(r->frame.images), i.lossy});
      }
    }
  return out;
}

std::array<double, 3> meanOf(const Picture& p) {
  std::array<double, 3> sum{};
  for (std::size_t n = 0; n < p.pixels.size(); ++n) sum[n % 3] += p.pixels[n];
  for (double& v : sum) v /= static_cast<double>(p.pixels.size()) / 3;
  return sum;
}

std::map<std::string, std::array<double, 3>> expectedMeans(const std::string& folder) {
  std::map<std::string, std::array<double, 3>> out;
  const Json j = Json::parse(std::ifstream(dataDir() / "expected" / (folder + ".json")));
  for (const Json& o : j.at("objects"))
    if (o.contains("pixels") && o["pixels"].contains("rgb_mean_dcmj2pnm"))
      out[o.at("file")] = o["pixels"]["rgb_mean_dcmj2pnm"].get<std::array<double, 3>>();
  return out;
}

bool isRepeated(const std::string& folder, const std::string& file) {
  const auto set = scanStudy({(dataDir() / folder).string()});
  if (!set) return false;
  for (const Instance& i : set->instances)
    if (set->files[i.file].shown == file) return i.identity == Identity::Repeated;
  return false;
}

class ColourPictures : public ::testing::TestWithParam<const char*> {};

TEST_P(ColourPictures, MeansAgreeWithDataExpected) {
  VERNIER_NEEDS_DATA(GetParam());
  auto wanted = expectedMeans(GetParam());
  ASSERT_FALSE(wanted.empty());
  for (const Shown& s : colourPictures(GetParam())) {
    const auto want = wanted.find(s.file);
    if (want == wanted.end()) continue;  // no independent tool could say
    const auto got = meanOf(s.picture);
    // JPEG's colour conversion rounds, so that a YBR file is never exact.
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(got[c], want->second[c], s.lossy || s.file.find("ybr") != std::string::npos ? 1.0 : 0.01)
          << s.file << " channel " << c;
    wanted.erase(want);
  }
  // Of objects with one SOP Instance UID and equal values one stands for all.
  for (const auto& [file, mean] : wanted)
    EXPECT_TRUE(isRepeated(GetParam(), file)) << file << " is not among the pictures";
}

// A binary PPM; empty where the tool wrote none.
Picture readPpm(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string magic;
  int width = 0, height = 0, most = 0;
  if (!(in >> magic >> width >> height >> most) || magic != "P6" || most != 255) return {};
  in.get();
  Picture p(width, height);
  in.read(reinterpret_cast<char*>(p.pixels.data()), static_cast<std::streamsize>(p.pixels.size()));
  return in ? p : Picture{};
}

TEST_P(ColourPictures, PixelsAgreeWithDcmj2pnm) {
  VERNIER_NEEDS_DATA(GetParam());
  if (!std::filesystem::exists("/usr/bin/dcmj2pnm")) {
    std::cout << "[  NOTE    ] dcmj2pnm is not here: not checked\n";
    return;
  }
  const TempDir dir;
  std::size_t compared = 0;
  for (const Shown& s : colourPictures(GetParam())) {
    const auto ppm = dir.path() / "a.ppm";
    std::filesystem::remove(ppm);
    const auto run = test::runProgram(
        {"/usr/bin/dcmj2pnm", "--write-raw-pnm", (dataDir() / GetParam() / s.file).string(), ppm.string()});
    const Picture theirs = readPpm(ppm);
    if (run.exitCode != 0 || theirs.width == 0) continue;
    ASSERT_EQ(theirs.width, s.picture.width) << s.file;
    ASSERT_EQ(theirs.height, s.picture.height) << s.file;
    int worst = 0;
    for (std::size_t n = 0; n < theirs.pixels.size(); ++n)
      worst = std::max(worst, std::abs(int(theirs.pixels[n]) - int(s.picture.pixels[n])));
    // Integer arithmetic of theirs against double here.
    EXPECT_LE(worst, 1) << s.file;
    ++compared;
  }
  EXPECT_GE(compared, std::string(GetParam()) == "codec_small_singles" ? 24u : 4u);
}

INSTANTIATE_TEST_SUITE_P(Folders, ColourPictures,
                         ::testing::Values("codec_emri_palette_planar", "codec_small_singles"),
                         [](const auto& p) { return std::string(p.param); });

// GDCMJ2K_TextGBR and the lossy JPEG-LS files, that DCMTK cannot read, and one whose markers are broken: the
// picture against what the test image is known to be, bars of red, green, blue... as in SC_rgb.dcm.
TEST(ColourPictures2, SamePictureWhateverTheCoding) {
  VERNIER_NEEDS_DATA("codec_small_singles");
  VERNIER_NEEDS_DATA("codec_emri_palette_planar");
  Picture truth;
  for (const Shown& s : colourPictures("codec_emri_palette_planar"))
    if (s.file == "SC_rgb.dcm") truth = s.picture;
  ASSERT_EQ(truth.width, 100);
  std::size_t compared = 0;
  for (const Shown& s : colourPictures("codec_small_singles")) {
    if (s.picture.width != 100 || s.picture.height != 100) continue;
    double sum = 0;
    for (std::size_t n = 0; n < truth.pixels.size(); ++n)
      sum += std::abs(int(truth.pixels[n]) - int(s.picture.pixels[n]));
    EXPECT_LT(sum / static_cast<double>(truth.pixels.size()), 3.0) << s.file;
    ++compared;
  }
  EXPECT_GE(compared, 15u);
}

}  // namespace
}  // namespace vernier::app
