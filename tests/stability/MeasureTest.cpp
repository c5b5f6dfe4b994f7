// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements at their extremes: H1 to H4, H6 and H7 (H5, resampled images, is a matter of comparing
// pictures; here it is only held that no value comes from one).
#include <clocale>
#include <filesystem>
#include <fstream>
#include <locale>

#include "../unit/measure/MeasureCases.h"
#include "MakeDicom.h"
#include "TestData.h"
#include "TestPaths.h"
#include "vernier/measure/MeasurementJson.h"
#include "vernier/measure/Millimetres.h"
#include "vernier/measure/Outline.h"
#include "vernier/measure/Statistics.h"
#include "vernier/study/Load.h"
#include "vernier/volume/Build.h"

namespace vernier::measure::test {
namespace {

namespace fs = std::filesystem;
using vernier::test::DicomSlice;
using vernier::test::TempDir;

Measured said(const Result<Measured>& r) {
  EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
  return r ? *r : Measured{};
}

TEST(Stability, H01_DistancesFromNothingToTheDiagonalAcrossOneToFifty) {
  for (const double aspect : {1.0, 7.0, 50.0}) {
    const glm::dvec3 spacing(0.4, 0.4, 0.4 * aspect);
    const auto volume = volumeOf(gridOf({12, 9, 7}, spacing), [](glm::dvec3) { return 0; });
    const GridGeometry& g = volume->grid();
    const auto length = [&](glm::dvec3 a, glm::dvec3 b) {
      return said(measure(inPatient(Length{{a, b}}), sourcesOf(volume))).quantities.at(0);
    };
    const Quantity none = length(g.corner(0).p, g.corner(0).p);
    EXPECT_EQ(none.value, 0);
    EXPECT_GT(*none.expanded, 0) << "two points on one place may still be apart";
    const Quantity across = length(g.corner(0).p, g.corner(7).p);
    const double truth =
        std::sqrt(std::pow(11 * 0.4, 2) + std::pow(8 * 0.4, 2) + std::pow(6 * 0.4 * aspect, 2));
    EXPECT_NEAR(across.value, truth, 1e-9 * truth);
    // Half a voxel at each end is covered by what is stated along each axis.
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 d(0);
      d[axis] = 10 * spacing[axis];
      EXPECT_GE(*length({0, 0, 0}, d).expanded, 0.5 * spacing[axis]);
      EXPECT_LE(*length({0, 0, 0}, d).expanded, spacing[axis]);
    }
  }
}

TEST(Stability, H02_ArmsWithoutLengthOrOnOneLineAreRefusedAndNothingIsNaN) {
  const auto volume = volumeOf(gridOf({4, 4, 4}, {1, 1, 1}), [](glm::dvec3) { return 0; });
  const auto angle = [&](glm::dvec3 a, glm::dvec3 v, glm::dvec3 b) {
    return measure(inPatient(Angle{v, {a, b}}), sourcesOf(volume));
  };
  EXPECT_FALSE(angle({1, 0, 0}, {1, 0, 0}, {0, 1, 0}).ok());
  EXPECT_FALSE(angle({1, 0, 0}, {0, 0, 0}, {0, 0, 0}).ok());
  EXPECT_FALSE(angle({1, 0, 0}, {0, 0, 0}, {5, 0, 0}).ok());
  EXPECT_FALSE(angle({0.1, 0.2, 0.3}, {0, 0, 0}, {-0.3, -0.6, -0.9}).ok());
  EXPECT_FALSE(measure(inPatient(Cobb{{Spot(0, 0, 0), Spot(0, 0, 0)}, {Spot(0, 0, 0), Spot(1, 0, 0)}}),
                       sourcesOf(volume))
                   .ok());
  // Hardly open: the acos of a rounded cosine would give 0 or NaN.
  Draws d(31);
  for (int n = 0; n < 1000; ++n) {
    const double opening = std::pow(10, d.within(-9, -3));  // radians
    const Placement::Axes a = randomAxes(d);
    const glm::dvec3 u = 50.0 * rightOf(a);
    const glm::dvec3 v = 30.0 * (std::cos(opening) * rightOf(a) + std::sin(opening) * a.up.v);
    const Quantity q = said(angle(u, {0, 0, 0}, v)).quantities.at(0);
    ASSERT_NEAR(q.value * std::numbers::pi / 180, opening, 1e-14);
    ASSERT_TRUE(std::isfinite(*q.expanded));
    const Quantity r = said(angle(u, {0, 0, 0}, -v)).quantities.at(0);
    ASSERT_NEAR(r.value, 180 - q.value, 1e-9);
  }
  const Quantity parallel =
      said(measure(inPatient(Cobb{{Spot(0, 0, 0), Spot(9, 0, 0)}, {Spot(0, 5, 0), Spot(-9, 5, 0)}}),
                   sourcesOf(volume)))
          .quantities.at(0);
  EXPECT_EQ(parallel.value, 0);
  EXPECT_TRUE(std::isfinite(*parallel.expanded) && *parallel.expanded > 0);
}

TEST(Stability, H03_PolygonsCrossedTurnedAndFarAway) {
  EXPECT_EQ(areaOf(std::vector<glm::dvec2>{{0, 0}, {5, 5}}), 0);
  const std::vector<glm::dvec2> square{{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  const std::vector<glm::dvec2> turned(square.rbegin(), square.rend());
  EXPECT_EQ(areaOf(square), 100);
  EXPECT_EQ(areaOf(turned), 100);
  // A bow tie: two triangles of 25, whose signed areas cancel.
  EXPECT_NEAR(areaOf(std::vector<glm::dvec2>{{0, 0}, {10, 10}, {10, 0}, {0, 10}}), 50, 1e-12);
  // A pentagram by the even-odd rule: its five points, without the pentagon in the middle.
  std::vector<glm::dvec2> star;
  for (int n = 0; n < 5; ++n)
    star.emplace_back(std::cos(n * 4 * std::numbers::pi / 5), std::sin(n * 4 * std::numbers::pi / 5));
  const double inner = std::pow(std::sin(std::numbers::pi / 10) / std::sin(3 * std::numbers::pi / 10), 2);
  const double pentagon = 2.5 * std::sin(2 * std::numbers::pi / 5);  // of circumradius 1
  const double whole = 5 * std::sqrt(inner) * std::sin(std::numbers::pi / 5);
  EXPECT_NEAR(areaOf(star), whole - inner * pentagon, 1e-12);
  // A square of side 1 at an offset of a million: floats would keep two digits.
  for (const double offset : {1e3, 1e6, 1e9}) {
    std::vector<glm::dvec2> far = square;
    for (glm::dvec2& p : far) p = p / 8.0 + offset;
    EXPECT_EQ(areaOf(far), 100.0 / 64);
  }
  // Refused or even-odd as measurements too, with the same sign either way round.
  const auto frame = frameOf(20, 20, std::vector<std::int16_t>(400, 7));
  const auto region = [&](std::vector<Spot> corners) {
    return measure(inImage(PolygonRegion{std::move(corners)}), sourcesOf(frame));
  };
  EXPECT_FALSE(region({{1, 1, 0}, {9, 9, 0}}).ok());
  const Measured bow = said(region({{1, 1, 0}, {11, 11, 0}, {11, 1, 0}, {1, 11, 0}}));
  EXPECT_NEAR(bow.quantities.at(0).value, 50, 1e-12);
  EXPECT_THAT(bow.notes, ::testing::Contains("the outline crosses itself: even-odd"));
  EXPECT_EQ(bow.values->n, 60u);  // centres no farther from the middle in y than in x
}

TEST(Stability, H04_FromOnePixelToThirtyMillionVoxels) {
  // 3e7 values near a million with a small spread: sums in float lose both mean and SD.
  constexpr std::size_t count = 30'000'000;
  std::vector<double> values(count);
  long double sum = 0;
  for (std::size_t n = 0; n < count; ++n) {
    values[n] = 1e6 + 3 * randomUnit(32, n);
    sum += static_cast<long double>(values[n]) - 1e6L;
  }
  const long double mean = sum / count;
  long double squares = 0;
  for (const double x : values) {
    const long double d = (static_cast<long double>(x) - 1e6L) - mean;
    squares += d * d;
  }
  const long double sd = std::sqrt(squares / (count - 1));
  const Statistics s = statisticsOf(std::move(values), 0);
  EXPECT_EQ(s.n, count);
  EXPECT_LE(std::abs(s.mean - (1e6L + mean)), 1e-9L);
  EXPECT_LE(std::abs(*s.sd - sd), 1e-9L * sd);
  // One pixel, and the whole image.
  std::vector<std::int16_t> pixels(64 * 48);
  for (std::size_t n = 0; n < pixels.size(); ++n) pixels[n] = static_cast<std::int16_t>(n % 1000);
  const auto sources = sourcesOf(frameOf(64, 48, pixels));
  const Measured one =
      said(measure(inImage(RectangleRegion{{Spot(5.4, 7.4, 0), Spot(5.6, 7.6, 0)}}), sources));
  EXPECT_EQ(one.values->n, 1u);
  EXPECT_EQ(one.values->mean, pixels[7 * 64 + 5]);
  EXPECT_EQ(one.values->median, pixels[7 * 64 + 5]);
  EXPECT_FALSE(one.values->sd.has_value());
  const Measured all = said(measure(inImage(RectangleRegion{{Spot(0, 0, 0), Spot(64, 48, 0)}}), sources));
  EXPECT_EQ(all.values->n, pixels.size());
}

// No value comes from a resampled picture: the module does not even link what could resample one.
TEST(Stability, H05_NoValueComesFromAWarpedImage) {
  int looked = 0;
  for (const auto& e :
       fs::recursive_directory_iterator(fs::path(VERNIER_SOURCE_DIR) / "modules/measure/src")) {
    const std::string name = e.path().filename().string();
    if (name != "Regions.cpp" && name != "RegionValues.cpp" && name != "Probe.cpp" && name != "Contour.cpp" &&
        name != "Volumes.cpp" && name != "Statistics.cpp")
      continue;
    ++looked;
    std::ifstream f(e.path());
    const std::string text{std::istreambuf_iterator<char>(f), {}};
    for (const char* word :
         {"warpAffine", "warpPerspective", "remap", "cv::resize", "contourArea", "meanStdDev"})
      EXPECT_EQ(text.find(word), std::string::npos) << name << " uses " << word;
  }
  EXPECT_EQ(looked, 6);
}

struct ScaleCase {
  const char* name;
  DicomSlice slice;
  Origin origin;
  const char* unit;
  double across, down;  // of ten pixels
};

TEST(Stability, H06_MillimetresOnlyWhereTheFileGivesThem) {
  const auto image = [](const char* modality, const char* sopClass) {
    DicomSlice s;
    s.modality = modality;
    s.sopClassUid = sopClass;
    s.hasGeometry = false;
    s.rows = 40, s.columns = 40;
    s.erase = {"0028,0030"};
    return s;
  };
  const char* const ct = "1.2.840.10008.5.1.4.1.1.2";
  const char* const dx = "1.2.840.10008.5.1.4.1.1.1.1";
  const char* const xa = "1.2.840.10008.5.1.4.1.1.12.1";
  const char* const sc = "1.2.840.10008.5.1.4.1.1.7";
  const char* const us = "1.2.840.10008.5.1.4.1.1.6.1";
  const auto with = [](DicomSlice s, std::vector<std::pair<std::string, std::string>> set) {
    for (auto& x : set) {
      std::erase(s.erase, x.first);
      s.set.push_back(std::move(x));
    }
    return s;
  };
  DicomSlice plain = image("CT", ct);
  plain.hasGeometry = true;
  const auto region = [](int units, const char* x1) {
    const std::string r = "SequenceOfUltrasoundRegions[0].";
    return std::vector<std::string>{r + "RegionLocationMinX0=2",
                                    r + "RegionLocationMinY0=2",
                                    r + "RegionLocationMaxX1=" + x1,
                                    r + "RegionLocationMaxY1=38",
                                    r + "PhysicalUnitsXDirection=" + std::to_string(units),
                                    r + "PhysicalUnitsYDirection=" + std::to_string(units),
                                    r + "PhysicalDeltaX=0.05",
                                    r + "PhysicalDeltaY=0.02"};
  };
  const auto ultrasound = [&](int units, const char* x1) {
    DicomSlice s = image("US", us);
    s.sequences = region(units, x1);
    return s;
  };
  const std::vector<ScaleCase> cases = {
      {"ct", with(plain, {{"0028,0030", "0.7\\0.5"}}), Origin::PixelSpacing, "mm", 5, 7},
      {"dx with nothing", image("DX", dx), Origin::Pixels, "px", 10, 10},
      {"dx, spacing alone", with(image("DX", dx), {{"0028,0030", "0.7\\0.5"}}), Origin::Pixels, "px", 10, 10},
      {"dx at the detector", with(image("DX", dx), {{"0018,1164", "0.2\\0.1"}}), Origin::AtDetector, "mm", 1,
       2},
      {"dx, both the same",
       with(image("DX", dx),
            {{"0018,1164", "0.2\\0.1"}, {"0028,0030", "0.2\\0.1"}, {"0028,0A02", "GEOMETRY"}}),
       Origin::AtDetector, "mm", 1, 2},
      {"dx calibrated",
       with(image("DX", dx),
            {{"0018,1164", "0.2\\0.1"}, {"0028,0030", "0.16\\0.08"}, {"0028,0A02", "FIDUCIAL"}}),
       Origin::Calibrated, "mm", 0.8, 1.6},
      {"xa magnified", with(image("XA", xa), {{"0018,1164", "0.2\\0.1"}, {"0018,1114", "1.25"}}),
       Origin::Magnified, "mm", 0.8, 1.6},
      {"film", with(image("CR", "1.2.840.10008.5.1.4.1.1.1"), {{"0018,2010", "0.3\\0.3"}}), Origin::Film,
       "mm", 3, 3},
      {"aspect ratio", with(image("XA", xa), {{"0028,0034", "4\\3"}}), Origin::SquaredPixels, "px", 10,
       40.0 / 3},
      {"secondary capture of a CT", with(image("CT", sc), {{"0028,0030", "0.7\\0.5"}}), Origin::Pixels, "px",
       10, 10},
      {"secondary capture, calibrated",
       with(image("OT", sc), {{"0028,0030", "0.7\\0.5"}, {"0028,0A02", "GEOMETRY"}}), Origin::Calibrated,
       "mm", 5, 7},
      {"us within its region", ultrasound(3, "38"), Origin::UltrasoundRegion, "mm", 5, 2},
      {"us, one end outside", ultrasound(3, "14"), Origin::Pixels, "px", 10, 10},
      {"us, a region of time", ultrasound(4, "38"), Origin::Pixels, "px", 10, 10},
      {"us without regions", with(image("US", us), {{"0028,0030", "0.7\\0.5"}}), Origin::Pixels, "px", 10,
       10},
  };
  for (const ScaleCase& c : cases) {
    SCOPED_TRACE(c.name);
    TempDir dir;
    writeDicom(dir.path() / "a.dcm", c.slice);
    const auto set = scanStudy({dir.path().string()});
    ASSERT_TRUE(set.ok());
    ASSERT_EQ(set->instances.size(), 1u);
    const auto calibration = pixelCalibration(*set, 0);
    ASSERT_TRUE(calibration.ok()) << calibration.error().text();
    const auto frame = buildImageFrame(*set, set->series.at(0), set->series.at(0).stacks.at(0), 0);
    ASSERT_TRUE(frame.ok()) << frame.error().text();
    const auto length = [&](Spot d) {
      return said(
          measure(inImage(Length{{Spot(10, 10, 0), Spot(10, 10, 0) + d}}), sourcesOf(*frame, *calibration)));
    };
    const Measured across = length({10, 0, 0}), down = length({0, 10, 0});
    EXPECT_NEAR(across.quantities.at(0).value, c.across, 1e-9);
    EXPECT_EQ(across.quantities.at(0).unit, c.unit);
    EXPECT_EQ(across.origin, c.origin) << across.originText;
    if (std::string(c.name) != "us, one end outside") {
      EXPECT_NEAR(down.quantities.at(0).value, c.down, 1e-9);
    }
    // The user's own calibration stands above all, and says so.
    Measurement m = inImage(Length{{Spot(10, 10, 0), Spot(20, 10, 0)}});
    m.on.userSpacing_mm = glm::dvec2(0.4, 0.3);
    const Measured user = said(measure(m, sourcesOf(*frame, *calibration)));
    EXPECT_NEAR(user.quantities.at(0).value, 3, 1e-12);
    EXPECT_EQ(user.originText, "mm (user)");
  }
}

TEST(Stability, H06_AVolumeFileWithoutSpacingHasNoMillimetres) {
  VolumeInfo info = volumeOf(gridOf({8, 8, 8}, {1, 1, 1}), [](glm::dvec3) { return 0; })->info();
  info.seriesUid.clear();
  const auto said = [&](const char* finding, Shape shape) {
    info.findings.clear();
    if (*finding) info.findings.push_back({finding, Severity::Warning, "", {}});
    const auto v = *Volume::make(info, bytesOfFloats(std::vector<float>(512, 1)));
    return measure(inPatient(std::move(shape)), sourcesOf(v));
  };
  const Length line{{Spot(0, 0, 0), Spot(3, 0, 0)}};
  EXPECT_EQ(said("", line)->quantities.at(0).unit, "mm");
  EXPECT_EQ(said("", line)->origin, Origin::File);
  EXPECT_EQ(said("spacing-assumed", line)->quantities.at(0).unit, "px");
  EXPECT_EQ(said("spacing-assumed", line)->origin, Origin::Pixels);
  EXPECT_EQ(said("spacing-assumed", IsoVolume{0.5, {}})->quantities.at(0).unit, "px3");
  EXPECT_NE(said("length-unit-assumed", line)->originText.find("assumed"), std::string::npos);
}

// Commas for decimals and dots for thousands, for whatever streams would do; the C locale too where one is
// installed.
struct Commas : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Stability, H07_ReloadedOnAnotherScreenAndInAnotherLocaleItSaysTheSame) {
  const auto volume =
      volumeOf(gridOf({40, 40, 20}, {0.7, 0.7, 1.3}), [](glm::dvec3 p) { return p.x * 1234.5678; });
  MeasurementList list;
  Measurement m = inPatient(Length{{Spot(-1234.56789, 0.1, 0.2), Spot(1.0 / 3, 2.0 / 3, 5)}});
  m.on.axes = Placement::Axes{};
  m.on.screenPixel = 0.27;  // as placed: the screen that it is shown on later plays no part
  list.add(m);
  m.shape = EllipseRegion{{Spot(-5, -5, 0.65), Spot(5, 6, 0.65)}};
  list.add(m);
  for (std::size_t n = 0; n < list.size(); ++n)
    list.setResult(list.at(n).what.id, measure(list.at(n).what, sourcesOf(volume)));
  const auto strings = [](const std::vector<Entry>& entries) {
    std::vector<std::string> out;
    for (const Entry& e : entries)
      for (const Quantity& q : e.said->quantities) out.push_back(displayText(q));
    return out;
  };
  const std::string text = writeMeasurements(list.entries());
  const std::vector<std::string> before = strings(list.entries());
  ASSERT_EQ(before.size(), 4u);
  const std::locale old = std::locale::global(std::locale(std::locale::classic(), new Commas));
  const bool german = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  RecordProperty("c_locale", german ? "de_DE" : "not installed");
  const auto back = parseMeasurements(text);
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_TRUE(*back == list.entries());
  EXPECT_EQ(strings(*back), before);
  EXPECT_EQ(writeMeasurements(*back), text);
  MeasurementList again;
  again.load(*back);
  for (std::size_t n = 0; n < again.size(); ++n) {
    again.setResult(again.at(n).what.id, measure(again.at(n).what, sourcesOf(volume)));
    EXPECT_TRUE(again.at(n) == list.at(n)) << "measured again";
  }
  std::locale::global(old);
  std::setlocale(LC_ALL, "C");
}

}  // namespace
}  // namespace vernier::measure::test
