// SPDX-License-Identifier: GPL-3.0-or-later
// The answers against what the files hold, and against formulas written here once more.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "Files.h"
#include "TestData.h"

namespace vernier::test {
namespace {

const ReadFile* fileNamed(const Written& w, const std::string& name) {
  for (const ReadFile& f : w.files)
    if (f.name == name) return &f;
  return nullptr;
}

// Probes: the stated pixel of the stated file holds the stated value and lies where the answer says.
void expectProbesHold(const Written& w) {
  for (const auto& series : w.answers["series"]) {
    for (const auto& p : series["probes"]) {
      const ReadFile* f = fileNamed(w, p["file"]);
      ASSERT_NE(f, nullptr) << p;
      const int column = p["column"], row = p["row"];
      EXPECT_NEAR(f->at(column, row), p["stored"].get<int>(), series["stored_bound"].get<double>()) << p;
      EXPECT_EQ(f->slope * p["stored"].get<int>() + f->intercept, p["modality"].get<double>()) << p;
      for (int axis = 0; axis < 3; ++axis) {
        const double mm = f->origin[axis] + column * f->spacing[1] * f->orientation[axis] +
                          row * f->spacing[0] * f->orientation[3 + axis];
        EXPECT_NEAR(mm, p["patient_mm"][static_cast<std::size_t>(axis)].get<double>(), 1e-9) << p;
      }
    }
  }
}

void expectSumsHold(const Written& w) {
  for (const auto& series : w.answers["series"]) {
    if (series["stored_bound"] != 0.0) continue;
    for (const auto& s : series["slices"]) {
      const ReadFile* f = fileNamed(w, s["file"]);
      ASSERT_NE(f, nullptr) << s;
      EXPECT_EQ(std::accumulate(f->stored.begin(), f->stored.end(), std::int64_t{0}), s["stored_sum"]) << s;
      EXPECT_EQ(f->sopUid, s["sop_instance_uid"]);
      EXPECT_NEAR(f->positionAlongNormal(), s["position_along_normal_mm"].get<double>(), 1e-9);
    }
  }
}

double valueOfProbe(const Written& w, const std::string& name) {
  for (const auto& p : w.answers["series"][0]["probes"])
    if (p["name"] == name) return p["modality"];
  ADD_FAILURE() << "no probe " << name;
  return 0;
}

TEST(PhantomAnswers, HoldForEveryRecipe) {
  for (const PhantomRecipe& recipe : phantomRecipes()) {
    if (isMultiFrame(recipe.name)) continue;
    SCOPED_TRACE(recipe.name);
    if (recipe.isSurface) continue;                 // SurfacesTest.cpp
    if (hasColoursOrStates(recipe.name)) continue;  // three samples a pixel, or objects without pixels
    TempDir dir;
    std::map<std::string, std::string> settings;
    for (const PhantomSetting& s : recipe.settings)
      if (s.name == "scale") settings["scale"] = "0.125";
    const Written w = writeAndRead(dir.path(), recipe.name, settings);
    ASSERT_FALSE(w.files.empty());
    expectProbesHold(w);
    expectSumsHold(w);
  }
}

// In all 8 flips, 3 planes and both file orders the solids lie on their side of the patient. The truth here
// is the geometry of the recipe, typed again; the position of each voxel comes from the file's own
// attributes.
TEST(OrientationPhantom, HoldsTheStatedValueAtEveryPatientPosition) {
  const auto truth = [](double x, double y, double z) {
    x -= 10, y += 20, z -= 30;
    if (std::hypot(x, y) <= 5 && std::fabs(z - 22) <= 8) return 900;
    if (x * x + (y - 22) * (y - 22) + z * z <= 49) return 600;
    if (std::fabs(x - 22) <= 6 && std::fabs(y) <= 6 && std::fabs(z) <= 6) return 300;
    return std::max({std::fabs(x), std::fabs(y), std::fabs(z)}) <= 34 ? 100 : -1000;
  };
  for (const char* plane : {"axial", "coronal", "sagittal"}) {
    for (int flip = 0; flip < 8; ++flip) {
      for (const char* left : {"no", "yes"}) {
        SCOPED_TRACE(std::string(plane) + " flip " + std::to_string(flip) + " left-handed " + left);
        TempDir dir;
        const Written w = writeAndRead(
            dir.path(), "orientation",
            {{"plane", plane}, {"flip", std::to_string(flip)}, {"left-handed", left}, {"scale", "0.5"}});
        ASSERT_EQ(w.files.size(), 24u);
        std::map<int, int> seen;
        for (const ReadFile& f : w.files) {
          for (int row = 0; row < f.rows; ++row) {
            for (int column = 0; column < f.columns; ++column) {
              double p[3];
              for (int a = 0; a < 3; ++a)
                p[a] = f.origin[a] + column * f.spacing[1] * f.orientation[a] +
                       row * f.spacing[0] * f.orientation[3 + a];
              const int expected = truth(p[0], p[1], p[2]);
              // A voxel centre on a face (to rounding) may be either.
              if (truth(p[0] + 1e-9, p[1] + 1e-9, p[2] + 1e-9) != expected ||
                  truth(p[0] - 1e-9, p[1] - 1e-9, p[2] - 1e-9) != expected)
                continue;
              ASSERT_EQ(f.at(column, row), expected) << f.name << ' ' << column << ' ' << row;
              ++seen[expected];
            }
          }
        }
        for (const int value : {-1000, 100, 300, 600, 900}) EXPECT_GT(seen[value], 20) << value;
        // File order against row x column is what "left-handed" means.
        const bool falling = w.files.front().positionAlongNormal() > w.files.back().positionAlongNormal();
        EXPECT_EQ(falling, std::string(left) == "yes");
        EXPECT_EQ(valueOfProbe(w, "L"), 300);
        EXPECT_EQ(valueOfProbe(w, "P"), 600);
        EXPECT_EQ(valueOfProbe(w, "H"), 900);
      }
    }
  }
}

TEST(RulerPhantom, StatesLengthsAnglesAreasAndVolumes) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "ruler", {{"scale", "0.2"}});
  const std::map<std::string, double> expected{{"a to b", 60},
                                               {"a to c", 45},
                                               {"a to d", 67.5},
                                               {"b to c", 75},
                                               {"b to d", std::hypot(60.0, 67.5)},
                                               {"b a c", 90},
                                               {"a b c", std::atan(0.75) * 180 / M_PI},
                                               {"disc", M_PI * 225},
                                               {"ellipse", M_PI * 84},
                                               {"plate", 28 * 18},
                                               {"ball", 4.0 / 3 * M_PI * 1728},
                                               {"ball section", M_PI * 144}};
  std::size_t found = 0;
  for (const auto& m : w.answers["measures"]) {
    const auto it = expected.find(m["name"]);
    if (it == expected.end()) continue;
    ++found;
    EXPECT_NEAR(m["value"].get<double>(), it->second, 1e-9 * it->second) << m;
  }
  EXPECT_EQ(found, expected.size());
}

// The pixels agree with the stated sizes: coverage summed over a solid is its area or volume.
TEST(RulerPhantom, CoverageOnItsPixelsSumsToTheStatedSizes) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "ruler");
  const ReadFile* middle = nullptr;
  for (const ReadFile& f : w.files)
    if (std::fabs(f.origin[2] - 0.375) < 1e-6) middle = &f;
  ASSERT_NE(middle, nullptr);
  const auto areaAbove0 = [&](double x0, double x1, double y0, double y1, double value) {
    double sum = 0;
    for (int row = 0; row < middle->rows; ++row)
      for (int column = 0; column < middle->columns; ++column) {
        const double x = middle->origin[0] + column * 0.75, y = middle->origin[1] + row * 0.75;
        if (x > x0 && x < x1 && y > y0 && y < y1) sum += middle->at(column, row) / value;
      }
    return sum * 0.75 * 0.75;
  };
  EXPECT_NEAR(areaAbove0(8, 42, 8.5, 42, 500), M_PI * 225, 0.003 * M_PI * 225);
  EXPECT_NEAR(areaAbove0(-34, -6, 21, 39, 400), M_PI * 84, 0.005 * M_PI * 84);
  EXPECT_NEAR(areaAbove0(9, 41, -23, -1.5, 300), 28 * 18, 0.003 * 28 * 18);
}

TEST(RulerPhantom, SpacingFromOneToFiftyKeepsTheBox) {
  for (const char* aspect : {"1", "5", "50"}) {
    TempDir dir;
    const Written w = writeAndRead(dir.path(), "ruler",
                                   {{"slice-aspect", aspect}, {"pixel-aspect", "2"}, {"oblique", "20"}});
    const ReadFile& f = w.files.front();
    EXPECT_EQ(w.files.size(), static_cast<std::size_t>(150 / std::stoi(aspect)));
    EXPECT_DOUBLE_EQ(f.spacing[0], 1.5);
    EXPECT_DOUBLE_EQ(f.spacing[1], 0.75);
    const double step = (w.files.back().positionAlongNormal() - f.positionAlongNormal()) /
                        static_cast<double>(w.files.size() - 1);
    EXPECT_NEAR(step, 0.75 * std::stoi(aspect), 1e-9);
    double dot = 0, rowLength = 0, columnLength = 0;
    for (int a = 0; a < 3; ++a) {
      dot += f.orientation[a] * f.orientation[3 + a];
      rowLength += f.orientation[a] * f.orientation[a];
      columnLength += f.orientation[3 + a] * f.orientation[3 + a];
    }
    EXPECT_NEAR(dot, 0, 1e-12);
    EXPECT_NEAR(rowLength, 1, 1e-12);
    EXPECT_NEAR(columnLength, 1, 1e-12);
    EXPECT_GT(std::fabs(f.normal(0)), 0.1);
  }
}

TEST(MarschnerLobbPhantom, IsTheFormula) {
  for (const int n : {41, 64}) {
    TempDir dir;
    const Written w = writeAndRead(dir.path(), "marschner-lobb", {{"n", std::to_string(n)}});
    ASSERT_EQ(w.files.size(), static_cast<std::size_t>(n));
    for (const ReadFile& f : w.files) {
      for (int row = 0; row < n; ++row) {
        for (int column = 0; column < n; ++column) {
          const double x = -1 + 2.0 * column / (n - 1), y = -1 + 2.0 * row / (n - 1), z = f.origin[2] / 20;
          const double r = std::sqrt(x * x + y * y);
          const double rho =
              (1 - std::sin(M_PI * z / 2) + 0.25 * (1 + std::cos(2 * M_PI * 6 * std::cos(M_PI * r / 2)))) /
              2.5;
          ASSERT_NEAR(f.at(column, row), 10000 * rho, 0.5 + 1e-7) << column << ' ' << row << ' ' << f.name;
        }
      }
    }
  }
}

TEST(GaussianVesselPhantom, IsTheFormulaForEachSigma) {
  for (const char* sigma : {"0.5", "1", "2"}) {
    TempDir dir;
    const Written w = writeAndRead(dir.path(), "gaussian-vessel", {{"sigma", sigma}});
    const double s = std::stod(sigma), d[3] = {0.6, 0.48, 0.64};
    for (const ReadFile& f : w.files) {
      for (int row = 0; row < f.rows; row += 3) {
        for (int column = 0; column < f.columns; ++column) {
          const double q[3] = {f.origin[0] + column - 0.3, f.origin[1] + row + 0.2, f.origin[2] - 0.1};
          double along = 0, square = 0;
          for (int a = 0; a < 3; ++a) along += q[a] * d[a], square += q[a] * q[a];
          const double value = 100 + 9900 * std::exp(-(square - along * along) / (2 * s * s));
          ASSERT_NEAR(f.at(column, row), value, 0.5 + 1e-6);
        }
      }
    }
  }
}

TEST(OrbitalPhantom, IsTheFormulaWhateverTheGrid) {
  for (const char* oblique : {"0", "25"}) {
    TempDir dir;
    const Written w = writeAndRead(dir.path(), "orbital", {{"oblique", oblique}});
    ASSERT_EQ(w.files.size(), 64u);
    double alongAxis = 0;
    for (const ReadFile& f : w.files) {
      ASSERT_EQ(f.rows, 64);
      ASSERT_EQ(f.columns, 64);
      for (int row = 0; row < 64; ++row) {
        for (int column = 0; column < 64; ++column) {
          double p[3];
          for (int a = 0; a < 3; ++a)
            p[a] = f.origin[a] + column * f.orientation[a] + row * f.orientation[3 + a];
          const double r = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
          const double psi = (3 * p[2] * p[2] - r * r) * std::exp(-r / 4.5);
          const double peak = 2 * 81 * std::exp(-2.0);  // at z = 9
          ASSERT_NEAR(f.at(column, row), 10000 * psi * psi / (peak * peak), 0.5 + 1e-6);
          if (std::fabs(p[0]) < 0.6 && std::fabs(p[1]) < 0.6) alongAxis += f.at(column, row) / 4.0;
        }
      }
    }
    // The four lines of voxels around the axis, 0.7 mm from it, hold less than the axis itself.
    if (std::string(oblique) == "0") {
      EXPECT_NEAR(alongAxis, 229920.1, 6000);
      EXPECT_LT(alongAxis, 229920.1);
    }
  }
}

TEST(PlumePhantom, IsTheFormulaAndHoldsAsMuchAtEveryHeight) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "plume");
  ASSERT_EQ(w.files.size(), 51u);
  for (const ReadFile& f : w.files) {
    ASSERT_EQ(f.rows, 21);
    ASSERT_EQ(f.columns, 21);
    const double h = f.origin[2] + 50, s = 3 + 0.05 * h, axis = -4 + 0.0006 * h * h;
    double section = 0;
    for (int row = 0; row < 21; ++row) {
      for (int column = 0; column < 21; ++column) {
        const double x = f.origin[0] + 2 * column - axis, y = f.origin[1] + 2 * row;
        ASSERT_NEAR(f.at(column, row), 90000 / (s * s) * std::exp(-(x * x + y * y) / (2 * s * s)),
                    0.5 + 1e-6);
        section += 4.0 * f.at(column, row);
      }
    }
    // The higher, the more of its flanks lies outside of the grid.
    EXPECT_NEAR(section, 10000 * 2 * M_PI * 9, 10000 * 2 * M_PI * 9 * (h < 40 ? 0.002 : 0.05)) << h;
  }
}

TEST(RampPhantom, IsTheFormulaWhateverTheAcquisition) {
  for (const auto& [plane, flip] : {std::pair{"axial", "0"}, {"coronal", "5"}, {"sagittal", "7"}}) {
    TempDir dir;
    const Written w = writeAndRead(dir.path(), "ramp", {{"plane", plane}, {"flip", flip}});
    ASSERT_FALSE(w.files.empty());
    for (const ReadFile& f : w.files)
      for (int row = 0; row < f.rows; ++row)
        for (int column = 0; column < f.columns; ++column) {
          double p[3];
          for (int a = 0; a < 3; ++a)
            p[a] = f.origin[a] + column * f.spacing[1] * f.orientation[a] +
                   row * f.spacing[0] * f.orientation[3 + a];
          ASSERT_NEAR(f.at(column, row), 2000 + 20 * p[0] + 16 * p[1] + 12 * p[2], 1e-6) << plane;
        }
  }
}

TEST(GreyScalePhantom, PatchesHaveTheirStepsAndNothingLiesBetween) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "grey-scale");
  ASSERT_EQ(w.files.size(), 5u);
  for (const ReadFile& f : w.files) {
    for (int row = 0; row < f.rows; ++row)
      for (int column = 0; column < f.columns; ++column) {
        const double x = f.origin[0] + column + 37.5, y = f.origin[1] + row + 15;  // from patch 1
        const double i = std::round(x / 15), k = std::round(y / 15);
        const bool inside =
            i >= 0 && i < 6 && k >= 0 && k < 3 && std::fabs(x - 15 * i) < 6.25 && std::fabs(y - 15 * k) < 6;
        // Stored: slope 2, intercept -1024.
        ASSERT_EQ(f.at(column, row), inside ? 12 + 100 * (6 * k + i) : 0) << column << " " << row;
      }
  }
}

TEST(UniformPhantom, IsOneValue) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "uniform");
  ASSERT_EQ(w.files.size(), 31u);
  for (const ReadFile& f : w.files)
    for (int row = 0; row < 41; ++row)
      for (int column = 0; column < 41; ++column) ASSERT_EQ(f.at(column, row) - 1024, 1000);
}

// Noise has the stated mean and spread, and the head's tissues their values.
TEST(CtHeadPhantom, TissuesHaveTheirStatedMeanAndNoise) {
  TempDir dir;
  const Written w = writeAndRead(dir.path(), "ct-head", {{"scale", "0.5"}});
  const auto around = [&](double x, double y, double z, double radius, double mean, double sd) {
    double n = 0, sum = 0, squares = 0;
    for (const ReadFile& f : w.files) {
      for (int row = 0; row < f.rows; ++row) {
        for (int column = 0; column < f.columns; ++column) {
          const double dx = f.origin[0] + column * f.spacing[1] - x,
                       dy = f.origin[1] + row * f.spacing[0] - y, dz = f.origin[2] - z;
          if (dx * dx + dy * dy + dz * dz > radius * radius) continue;
          const double v = f.at(column, row);
          n += 1, sum += v, squares += v * v;
        }
      }
    }
    ASSERT_GT(n, 100);
    const double m = sum / n;
    EXPECT_NEAR(m, mean, 3 * sd / std::sqrt(n / 2.25) + 0.05) << x << ' ' << y << ' ' << z;
    EXPECT_NEAR(std::sqrt(squares / n - m * m), sd, 0.12 * sd) << x << ' ' << y << ' ' << z;
  };
  around(-33, -32, 40, 5, 72, 4.2);   // lesion
  around(32, -78, -15, 7, 10, 5);     // eye
  around(30, -62, -44, 12, -990, 6);  // maxillary sinus
  around(-95, -95, 40, 8, -1000, 5);  // air
}

TEST(PhantomSettings, WrongOnesAreRefusedWithASentence) {
  TempDir dir;
  for (const auto& [name, settings] : std::vector<std::pair<std::string, std::map<std::string, std::string>>>{
           {"no-such-phantom", {}},
           {"orientation", {{"sigma", "1"}}},
           {"orientation", {{"flip", "8"}}},
           {"orientation", {{"flip", "x"}}},
           {"orientation", {{"plane", "diagonal"}}},
           {"ct-head", {{"scale", "2"}}},
           {"ct-head", {{"scale", "nan"}}}}) {
    const Result<PhantomInfo> r = writeOnly(dir.path(), name, settings);
    ASSERT_FALSE(r.ok()) << name;
    EXPECT_EQ(r.error().code, ErrorCode::OptionInvalid) << r.error().text();
    EXPECT_FALSE(r.error().sentence.empty());
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(PhantomOutput, AFolderThatCannotBeMadeIsWriteFailed) {
  const Result<PhantomInfo> r = writeOnly("/proc/nowhere", "small-ct");
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::WriteFailed);
}

TEST(PhantomOutput, CanBeCancelled) {
  TempDir dir;
  PhantomOptions options;
  std::stop_source source;
  options.stop = source.get_token();
  const Result<PhantomInfo> r =
      writePhantom("small-ct", dir.path(), options, [&](std::string_view, auto done, auto) {
        if (done == 3) source.request_stop();
      });
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::Cancelled);
}

}  // namespace
}  // namespace vernier::test
