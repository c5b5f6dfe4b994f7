// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures under presentation states: the combined LUT test against its PNG in every pixel; synthetic states
// against dcmp2pgm (DCMTK's own display-consistency renderer) where that is here, and against what the
// standard says.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "Annotations.h"
#include "MakeDicom.h"
#include "MakePresentation.h"
#include "RunProgram.h"
#include "Session.h"
#include "TestData.h"
#include "TestPaths.h"
#include "vernier/picture/Png.h"
#include "vernier/picture/Quantise.h"

namespace vernier::app {
namespace {
using test::DicomSlice;
using test::lutWords;
using test::PresentationFile;
using test::TempDir;

constexpr int kRows = 9, kColumns = 13;

SessionOptions options() {
  SessionOptions o;
  o.pluginFolders = {std::string(VERNIER_BUILD_DIR) + "/lib/vernier/plugins"};
  return o;
}

// Draws image 0 of the study under its presentation state; `error` takes the largest one measured.
Result<Picture> drawn(Session& session, int width, int height, Interpolation interpolation,
                      double* error = nullptr, std::vector<std::string>* notes = nullptr) {
  Scene scene;
  ImageLayer layer;
  layer.presentation = session.study().presentations.at(0).sopInstanceUid;
  layer.interpolation = interpolation;
  scene.layers = {layer};
  View view;
  view.width_px = width;
  view.height_px = height;
  RenderOptions render;
  render.error.samples = 1'000'000;
  const auto r = session.render(scene, view, {}, render);
  if (!r) return r.error();
  if (error) *error = r->error->max;
  if (notes) *notes = r->plan.notes;
  return quantise(r->frame.images);
}

TEST(PresentationPicture, CombinedLutsEqualTheirPngInEveryPixel) {
  VERNIER_NEEDS_DATA("gsps_luts");
  const auto expected = readPng((test::dataDir() / "gsps_luts/expected_imgForPrLUT.png").string());
  ASSERT_TRUE(expected.ok());
  Session session(options());
  ASSERT_TRUE(session.open({(test::dataDir() / "gsps_luts").string()}).ok());
  for (const Interpolation interpolation : {Interpolation::Nearest, Interpolation::Linear}) {
    double error = 1;
    const auto picture = drawn(session, 512, 512, interpolation, &error);
    ASSERT_TRUE(picture.ok()) << picture.error().text();
    EXPECT_LE(error, 0.01);
    ASSERT_EQ(picture->width, expected->width);
    std::size_t differing = 0;
    for (int y = 0; y < 512; ++y)
      for (int x = 0; x < 512; ++x) differing += *picture->at(x, y) != *expected->at(x, y);
    EXPECT_EQ(differing, 0u);
  }
}

struct Study {
  TempDir dir;
  std::vector<std::int64_t> stored;

  explicit Study(const PresentationFile& state, DicomSlice image = {}) {
    image.rows = kRows;
    image.columns = kColumns;
    image.bitsStored = 12;
    image.sopClassUid = "1.2.840.10008.5.1.4.1.1.7";
    image.modality = "OT";
    image.hasGeometry = false;
    std::mt19937 random(3);
    for (int n = 0; n < kRows * kColumns; ++n) stored.push_back(static_cast<int>(random() % 4096) - 2048);
    stored[0] = -2048;
    stored[1] = 2047;
    image.pixels = stored;
    image.erase = {"0028,1052", "0028,1053"};
    writeDicom(dir.path() / "image.dcm", image);
    writePresentation(dir.path() / "state.dcm", state);
  }
  Result<Picture> draw(int width = kColumns, int height = kRows, double* error = nullptr,
                       std::vector<std::string>* notes = nullptr) const {
    Session session(options());
    if (auto opened = session.open({dir.path().string()}); !opened) return opened.error();
    return drawn(session, width, height, Interpolation::Nearest, error, notes);
  }
  int grey(const Picture& p, int x, int y) const { return *p.at(x, y); }
};

// What dcmp2pgm wants beside what a test is about.
PresentationFile stateWith(std::vector<std::string> set, const char* shape = "IDENTITY") {
  PresentationFile f;
  f.set = {"PatientName=Test^Slice",
           "PatientBirthDate=",
           "PatientSex=",
           "StudyDate=20000101",
           "StudyTime=120000",
           "StudyID=1",
           "AccessionNumber=",
           "ReferringPhysicianName=",
           "SeriesNumber=2",
           "InstanceNumber=1",
           "Manufacturer=",
           "ReferencedSeriesSequence[0].SeriesInstanceUID=2.25.1002",
           "ReferencedSeriesSequence[0].ReferencedImageSequence[0].ReferencedSOPClassUID=1.2.840.10008.5.1.4."
           "1.1.7",
           "ContentDescription=",
           "PresentationCreationDate=20000101",
           "PresentationCreationTime=120000",
           "ContentCreatorName=",
           "DisplayedAreaSelectionSequence[0].DisplayedAreaTopLeftHandCorner=1\\1",
           "DisplayedAreaSelectionSequence[0].DisplayedAreaBottomRightHandCorner=13\\9",
           "DisplayedAreaSelectionSequence[0].PresentationSizeMode=SCALE TO FIT",
           "DisplayedAreaSelectionSequence[0].PresentationPixelAspectRatio=1\\1"};
  if (shape) f.set.push_back(std::string("PresentationLUTShape=") + shape);
  f.set.insert(f.set.end(), set.begin(), set.end());
  return f;
}

std::vector<std::string> presentationLut(std::size_t entries, unsigned bits) {
  std::vector<unsigned> values;
  for (std::size_t n = 0; n < entries; ++n)  // bent, so that a wrong entry is seen
    values.push_back(
        static_cast<unsigned>(((1u << bits) - 1) * double(n * n) / double((entries - 1) * (entries - 1))));
  return {
      "PresentationLUTSequence[0].LUTDescriptor=" + std::to_string(entries) + "\\0\\" + std::to_string(bits),
      "PresentationLUTSequence[0].LUTData=" + lutWords(values)};
}

std::vector<std::string> window(const char* center, const char* width) {
  return {std::string("SoftcopyVOILUTSequence[0].WindowCenter=") + center,
          std::string("SoftcopyVOILUTSequence[0].WindowWidth=") + width};
}

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// A binary PGM of 8 bits.
std::vector<std::uint8_t> readPgm(const std::filesystem::path& path, int& width, int& height) {
  std::ifstream in(path, std::ios::binary);
  std::string magic, line;
  int most = 0;
  in >> magic >> std::ws;
  while (in.peek() == '#') std::getline(in, line), in >> std::ws;
  in >> width >> height >> most;
  in.get();
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  in.read(reinterpret_cast<char*>(pixels.data()), static_cast<std::streamsize>(pixels.size()));
  return in && magic == "P5" && most == 255 ? pixels : std::vector<std::uint8_t>();
}

void compareWithDcmp2pgm(const PresentationFile& state, const char* what,
                         const char* photometric = "MONOCHROME2", int width = kColumns, int height = kRows) {
  SCOPED_TRACE(what);
  DicomSlice image;
  image.photometric = photometric;
  const Study study(state, image);
  double error = 1;
  const auto ours = study.draw(width, height, &error);
  ASSERT_TRUE(ours.ok()) << ours.error().text();
  EXPECT_LE(error, 0.01);
  const auto pgm = study.dir.path() / "out.pgm";
  const auto run = test::runProgram({"/usr/bin/dcmp2pgm", "-p", (study.dir.path() / "state.dcm").string(),
                                     (study.dir.path() / "image.dcm").string(), pgm.string()});
  ASSERT_EQ(run.exitCode, 0) << run.err;
  int w = 0, h = 0;
  const auto theirs = readPgm(pgm, w, h);
  ASSERT_EQ(w, width);
  ASSERT_EQ(h, height);
  ASSERT_FALSE(theirs.empty());
  int worst = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      worst = std::max(worst, std::abs(int(*ours->at(x, y)) - int(theirs[std::size_t(x + w * y)])));
  EXPECT_LE(worst, 1);
}

TEST(PresentationPicture, AgreesWithDcmp2pgm) {
  if (!std::filesystem::exists("/usr/bin/dcmp2pgm")) {
    std::cout << "[  NOTE    ] dcmp2pgm is not here: not checked\n";
    return;
  }
  std::vector<unsigned> voi;
  for (unsigned n = 0; n < 300; ++n) voi.push_back(n * 7919 % 1024);
  const std::vector<std::string> voiLut = {
      "SoftcopyVOILUTSequence[0].VOILUTSequence[0].LUTDescriptor=300\\50\\10",
      "SoftcopyVOILUTSequence[0].VOILUTSequence[0].LUTData=" + lutWords(voi)};
  const std::vector<std::string> rescale = {"RescaleSlope=2", "RescaleIntercept=100", "RescaleType=US"};
  compareWithDcmp2pgm(stateWith({}), "identity");
  compareWithDcmp2pgm(stateWith(window("40", "1000")), "window");
  compareWithDcmp2pgm(stateWith(window("40", "1000"), "INVERSE"), "window, inverse");
  compareWithDcmp2pgm(stateWith(rescale + window("40", "3000")), "rescale, window");
  compareWithDcmp2pgm(stateWith(voiLut), "VOI LUT");
  compareWithDcmp2pgm(stateWith(window("40", "1000") + presentationLut(256, 12), nullptr),
                      "window, presentation LUT");
  compareWithDcmp2pgm(stateWith(voiLut + presentationLut(1024, 16), nullptr), "VOI LUT, presentation LUT");
  // The photometric interpretation counts no more.
  compareWithDcmp2pgm(stateWith(window("40", "1000")), "MONOCHROME1, identity", "MONOCHROME1");
  compareWithDcmp2pgm(stateWith(window("40", "1000"), "INVERSE"), "MONOCHROME1, inverse", "MONOCHROME1");
  for (const char* turn : {"0", "90", "180", "270"})
    for (const char* flip : {"N", "Y"}) {
      const bool turned = std::string(turn) == "90" || std::string(turn) == "270";
      compareWithDcmp2pgm(stateWith(window("40", "1000") +
                                    std::vector<std::string>{std::string("ImageRotation=") + turn,
                                                             std::string("ImageHorizontalFlip=") + flip}),
                          turn, "MONOCHROME2", turned ? kRows : kColumns, turned ? kColumns : kRows);
    }
}

TEST(PresentationPicture, ShuttersCoverWhatLiesOutside) {
  const auto covered = [](std::vector<std::string> shutter, auto&& outside) {
    shutter.push_back("ShutterPresentationValue=13107");  // 51 of 255
    // A window that makes every pixel white.
    const Study study(stateWith(window("-5000", "2") + shutter));
    double error = 1;
    const auto p = study.draw(kColumns, kRows, &error);
    ASSERT_TRUE(p.ok()) << p.error().text();
    EXPECT_LT(error, 1e-5);
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x)
        ASSERT_EQ(*p->at(x, y), outside(x + 1, y + 1) ? 51 : 255) << x << "," << y;
  };
  const std::vector<std::string> rectangle = {"ShutterShape=RECTANGULAR", "ShutterLeftVerticalEdge=3",
                                              "ShutterRightVerticalEdge=9", "ShutterUpperHorizontalEdge=2",
                                              "ShutterLowerHorizontalEdge=7"};
  covered(rectangle, [](int c, int r) { return c < 3 || c > 9 || r < 2 || r > 7; });
  covered({"ShutterShape=CIRCULAR", "CenterOfCircularShutter=5\\7", "RadiusOfCircularShutter=4"},
          [](int c, int r) { return (c - 7) * (c - 7) + (r - 5) * (r - 5) > 16; });
  // A triangle with corners (column, row) 1,1 and 13,1 and 1,9: below its long edge.
  covered({"ShutterShape=POLYGONAL", "VerticesOfThePolygonalShutter=1\\1\\1\\13\\9\\1"},
          [](int c, int r) { return (c - 1) * 8 + (r - 1) * 12 > 96; });
  // Several shapes: what all of them leave.
  std::vector<std::string> both =
      rectangle + std::vector<std::string>{"CenterOfCircularShutter=5\\7", "RadiusOfCircularShutter=4"};
  both[0] = "ShutterShape=RECTANGULAR\\CIRCULAR";
  covered(both, [](int c, int r) {
    return c < 3 || c > 9 || r < 2 || r > 7 || (c - 7) * (c - 7) + (r - 5) * (r - 5) > 16;
  });
}

TEST(PresentationPicture, DisplayedAreaFillsThePicture) {
  PresentationFile state = stateWith(window("0", "4096"));
  for (std::string& s : state.set) {
    if (s.find("TopLeftHandCorner") != std::string::npos)
      s = "DisplayedAreaSelectionSequence[0].DisplayedAreaTopLeftHandCorner=4\\3";
    if (s.find("BottomRightHandCorner") != std::string::npos)
      s = "DisplayedAreaSelectionSequence[0].DisplayedAreaBottomRightHandCorner=7\\6";
  }
  const Study study(state);
  double error = 1;
  const auto p = study.draw(8, 8, &error);  // 4 x 4 pixels at twice their size
  ASSERT_TRUE(p.ok()) << p.error().text();
  EXPECT_LE(error, 0.01);
  const auto whole = Study(stateWith(window("0", "4096"))).draw();
  ASSERT_TRUE(whole.ok());
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) EXPECT_EQ(*p->at(x, y), *whole->at(3 + x / 2, 2 + y / 2)) << x << "," << y;

  for (std::string& s : state.set)
    if (s.find("PresentationSizeMode") != std::string::npos)
      s = "DisplayedAreaSelectionSequence[0].PresentationSizeMode=MAGNIFY";
  state.set.push_back("DisplayedAreaSelectionSequence[0].PresentationPixelMagnificationRatio=3");
  const auto magnified = Study(state).draw(6, 6, &error);  // its middle 2 x 2 pixels
  ASSERT_TRUE(magnified.ok());
  EXPECT_LE(error, 0.01);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x)
      EXPECT_EQ(*magnified->at(x, y), *whole->at(4 + x / 3, 3 + y / 3)) << x << "," << y;
}

TEST(PresentationPicture, WhatIsNotAppliedIsSaid) {
  std::vector<std::string> notes;
  const Study study(stateWith({"ShutterShape=BITMAP", "(6000,1001)=LAYER"}));
  ASSERT_TRUE(study.draw(kColumns, kRows, nullptr, &notes).ok());
  EXPECT_EQ(notes, (std::vector<std::string>{"presentation: not applied: a bitmap shutter",
                                             "presentation: not applied: overlays"}));
}

TEST(PresentationPicture, AStateForAnotherImageIsRefused) {
  PresentationFile state = stateWith({});
  state.imageUids = {"2.25.99"};
  state.set.clear();
  const Study study(state);
  const auto p = study.draw();
  ASSERT_FALSE(p.ok());
  EXPECT_EQ(p.error().code, ErrorCode::SceneInvalid);
  EXPECT_NE(p.error().sentence.find("does not refer to this image"), std::string::npos);
}

TEST(PresentationPicture, TheFinishedPictureSaysThatItIsAppliedAndFlipped) {
  const Study study(stateWith({"ImageHorizontalFlip=Y", "ImageRotation=0"}));
  Session session(options());
  ASSERT_TRUE(session.open({study.dir.path().string()}).ok());
  Scene scene;
  ImageLayer layer;
  layer.presentation = "2.25.7001";
  scene.layers = {layer};
  const auto r = session.render(scene, {}, {}, {});
  ASSERT_TRUE(r.ok());
  const auto a = annotationsFor(session, scene, {}, *r, {});
  ASSERT_TRUE(a.ok());
  EXPECT_TRUE(a->flipped);
  EXPECT_EQ(a->what.at(1).text, "presentation TEST applied");
  bool said = false;
  for (const PngText& t : pngTexts(scene, *r)) said |= t.keyword == "Presentation";
  EXPECT_TRUE(said);
}

}  // namespace
}  // namespace vernier::app
