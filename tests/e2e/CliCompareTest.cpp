// SPDX-License-Identifier: GPL-3.0-or-later
// vernier compare: pictures, stacks, reports, and whom it refuses to compare.
#include <tiffio.h>

#include <nlohmann/json.hpp>

#include "CliFixture.h"
#include "vernier/picture/Png.h"

namespace vernier::test {
namespace {
using Json = nlohmann::json;

class Compare : public Cli {
 protected:
  std::string png(const std::string& name, const Picture& p) {
    EXPECT_TRUE(writePng(path(name), p).ok());
    return path(name);
  }
  std::string tiff16(const std::string& name, int width, int offset) {
    TIFF* t = TIFFOpen(path(name).c_str(), "w");
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, 20);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    std::vector<std::uint16_t> row(static_cast<std::size_t>(width));
    for (std::uint32_t y = 0; y < 20; ++y) {
      for (std::size_t x = 0; x < row.size(); ++x)
        row[x] = static_cast<std::uint16_t>(1000 + 300 * x + 77 * y + (y == 5 && x == 7 ? offset : 0));
      TIFFWriteScanline(t, row.data(), y);
    }
    TIFFClose(t);
    return path(name);
  }
  std::string study(const std::string& name, const DicomSlice& s = {}) {
    return writeSmallStudy(dir_.path() / name, s);
  }
  Json compared(std::vector<std::string> args) {
    args.insert(args.begin(), "compare");
    args.push_back("--json");
    const ProgramRun r = vernier(args);
    EXPECT_EQ(r.exitCode, 0) << show(r);
    return Json::parse(r.out, nullptr, false);
  }
};

// Something with edges and slopes.
Picture card(int shift = 0) {
  Picture p(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const int u = x - shift;
      const bool in =
          (u - 20) * (u - 20) + (y - 22) * (y - 22) < 150 || (u > 40 && u < 52 && y > 30 && y < 40);
      for (int c = 0; c < 3; ++c)
        p.at(x, y)[c] = static_cast<std::uint8_t>((in ? 200 : 30) + (c == 0 ? y / 2 : u / 8));
    }
  return p;
}

TEST_F(Compare, PicturesWithAllTheirFigures) {
  const std::string a = png("a.png", card()), b = png("b.png", card(2));
  const Json same = compared({a, a, "--max-error", "0"});
  EXPECT_EQ(same["max"], 0);
  EXPECT_EQ(same["ssim"], 1.0);
  EXPECT_EQ(same["psnr_dB"], "infinite");
  EXPECT_EQ(same["ciede2000"]["max"], 0.0);
  const Json j = compared({a, b, "--align"});
  EXPECT_GT(j["max"], 150);
  EXPECT_LT(j["ssim"], 0.95);
  EXPECT_NEAR(j["alignment"]["dx_px"].get<double>(), 2, 0.1);
  EXPECT_NEAR(j["alignment"]["dy_px"].get<double>(), 0, 0.1);
  EXPECT_NEAR(j["alignment"]["rotation_deg"].get<double>(), 0, 0.3);
  EXPECT_LT(j["alignment"]["residual_rms"], j["rmse"]);
  expectSentence(vernier({"compare", a, b, "--json", "--max-error", "1"}), 4);
}

TEST_F(Compare, SixteenBitsAreComparedAsTheyStand) {
  const std::string a = tiff16("a.tif", 24, 0), b = tiff16("b.tif", 24, 3), wide = tiff16("w.tif", 25, 0);
  const Json j = compared({a, b});
  EXPECT_EQ(j["unit"], "level/65535");
  EXPECT_EQ(j["max"], 3);
  EXPECT_EQ(j["worst"], Json({7, 5}));
  expectSentence(vernier({"compare", a, wide}), 2);                           // size
  expectSentence(vernier({"compare", a, png("p.png", Picture(24, 20))}), 2);  // depth or colour
  expectSentence(vernier({"compare", a, b, "--heatmap", path("h.png")}), 2);
}

TEST_F(Compare, ModesAreWritten) {
  const std::string a = png("a.png", card()), b = png("b.png", card(1));
  for (const char* mode : {"wipe", "checkerboard", "difference"}) {
    const ProgramRun r = vernier({"compare", a, b, "--mode", mode, "--out", path("both.png")});
    EXPECT_EQ(r.exitCode, 0) << show(r);
    const auto both = readPng(path("both.png"));
    ASSERT_TRUE(both.ok());
    EXPECT_EQ(both->width, 64);
    EXPECT_NE(*both, card());
    fs::remove(path("both.png"));
  }
  expectSentence(vernier({"compare", a, b, "--mode", "wipe"}), 2);
  expectSentence(vernier({"compare", a, b, "--mode", "wipe", "--out", a}), 2);
}

TEST_F(Compare, StacksSliceBySlice) {
  const std::string a = study("a");
  const Json same = compared({a, a, "--max-error", "0"});
  EXPECT_EQ(same["what"], "stacks");
  EXPECT_EQ(same["alignment"]["by"], "frame of reference");
  EXPECT_EQ(same["max"], 0);
  EXPECT_EQ(same["resampled"], false);
  EXPECT_EQ(same["slices"].size(), 12u);
  EXPECT_EQ(same["compared"], 12 * 24 * 20);
  const ProgramRun text = vernier({"compare", a, a});
  EXPECT_EQ(text.exitCode, 0);
  EXPECT_NE(text.out.find("voxel against voxel"), std::string::npos) << text.out;
  // The pattern rises by 11 from slice to slice of 2 mm.
  const Json moved = compared({a, a, "--offset", "0,0,2"});
  EXPECT_EQ(moved["alignment"]["by"], "manual");
  EXPECT_NEAR(moved["mean"].get<double>(), 11, 1e-9);
  EXPECT_NEAR(moved["max"].get<double>(), 11, 1e-9);
  expectSentence(vernier({"compare", a, a, "--offset", "0,0,2", "--max-error", "10", "--json"}), 4);
  expectSentence(vernier({"compare", a, a, "--offset", "0,0"}), 2);
  expectSentence(vernier({"compare", a, a, "--mode", "wipe", "--out", path("o.png")}), 2);
}

TEST_F(Compare, TwoPatientsAreRefusedWithoutAValueOfEither) {
  DicomSlice one, two;
  one.patientId = "ZZPHI-1", two.patientId = "ZZPHI-2";
  one.patientName = "ZZPHI^ONE", two.patientName = "ZZPHI^TWO";
  const std::string a = study("a", one), b = study("b", two);
  for (const auto& args : {std::vector<std::string>{"compare", a, b},
                           {"compare", a, b, "--offset", "0,0,0"},
                           {"compare", a, b, "--json"}}) {
    const ProgramRun r = vernier(args);
    expectSentence(r, 2);
    EXPECT_EQ(r.out, "");
    EXPECT_NE(r.err.find("different patients"), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find("ZZPHI"), std::string::npos) << r.err;
  }
}

TEST_F(Compare, OnePatientIdWithAnotherBirthDateOrSexIsRefused) {
  DicomSlice one, other, same;
  one.set = same.set = {{"0010,0030", "19700102"}, {"0010,0040", "F"}};
  other.set = {{"0010,0030", "19700103"}, {"0010,0040", "F"}};
  const std::string a = study("a", one), b = study("b", other), c = study("c", same);
  other.set = {{"0010,0030", "19700102"}, {"0010,0040", "M"}};
  const std::string d = study("d", other);
  for (const std::string& wrong : {b, d}) {
    const ProgramRun r = vernier({"compare", a, wrong});
    expectSentence(r, 2);
    EXPECT_NE(r.err.find("birth date or sex"), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find("1970"), std::string::npos) << r.err;
  }
  EXPECT_EQ(vernier({"compare", a, c, "--max-error", "0"}).exitCode, 0);
}

TEST_F(Compare, WithoutACommonFrameOfReferenceTheOffsetIsTheUsersWord) {
  DicomSlice elsewhere;
  elsewhere.frameOfReferenceUid = "2.25.77";
  const std::string a = study("a"), b = study("b", elsewhere);
  const ProgramRun r = vernier({"compare", a, b});
  expectSentence(r, 2);
  EXPECT_NE(r.err.find("--offset"), std::string::npos);
  EXPECT_EQ(compared({a, b, "--offset", "0,0,0"})["max"], 0);
}

TEST_F(Compare, ReportsSayWhatDiffers) {
  const std::string s = study("s");
  ASSERT_EQ(vernier({"render", s, "--view", "axial", "--report", path("a.json")}).exitCode, 0);
  ASSERT_EQ(vernier({"render", s, "--view", "coronal", "--report", path("b.json")}).exitCode, 0);
  const Json same = compared({path("a.json"), path("a.json")});
  EXPECT_EQ(same["what"], "reports");
  for (const char* key : {"same_input", "same_scene", "same_picture", "same_passes"})
    EXPECT_EQ(same[key], true);
  EXPECT_EQ(same["timing_ms"]["frame"]["ratio"], 1.0);
  const Json other = compared({path("a.json"), path("b.json")});
  EXPECT_EQ(other["same_input"], true);
  EXPECT_EQ(other["same_scene"], false);
  EXPECT_EQ(other["same_picture"], false);
  EXPECT_TRUE(other["error"]["b"]["bound"].is_number());
  expectSentence(vernier({"compare", path("a.json"), path("b.json"), "--json", "--max-error", "0"}), 4);
  write("c.json", "{}");
  expectSentence(vernier({"compare", path("a.json"), path("c.json")}), 3);
}

}  // namespace
}  // namespace vernier::test
