// SPDX-License-Identifier: GPL-3.0-or-later
// Multi-frame phantoms read back with DCMTK: what the files say is what the answers state, and dciodvfy has
// no error.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numeric>

#include "Files.h"
#include "TestData.h"

namespace vernier::test {
namespace {
using Json = nlohmann::json;
using Settings = std::map<std::string, std::string>;

struct Phantom {
  TempDir dir;
  std::filesystem::path folder;
  Json answers;
  Phantom(const std::string& name, const Settings& settings) {
    const Result<PhantomInfo> info = writeOnly(dir.path(), name, settings);
    EXPECT_TRUE(info.ok()) << (info.ok() ? "" : info.error().text());
    if (!info) return;
    folder = info->data;
    answers = Json::parse(std::ifstream(info->answers));
  }
};

struct File {
  DcmFileFormat format;
  explicit File(const std::filesystem::path& p) { EXPECT_TRUE(format.loadFile(p.c_str()).good()) << p; }
  DcmDataset& root() { return *format.getDataset(); }
  // The attribute of a frame: of its own group, else of the shared one.
  std::string of(long frame, const DcmTagKey& macro, const DcmTagKey& tag, unsigned long pos = 0) {
    for (const auto& [sequence, n] : {std::pair(DCM_PerFrameFunctionalGroupsSequence, frame),
                                      std::pair(DCM_SharedFunctionalGroupsSequence, 0l)}) {
      DcmItem *groups = nullptr, *item = nullptr;
      OFString value;
      if (root().findAndGetSequenceItem(sequence, groups, n).good() &&
          groups->findAndGetSequenceItem(macro, item, 0).good() &&
          item->findAndGetOFString(tag, value, pos).good())
        return value.c_str();
    }
    return "";
  }
  double number(long frame, const DcmTagKey& macro, const DcmTagKey& tag, unsigned long pos = 0) {
    return std::stod(of(frame, macro, tag, pos));
  }
  std::string text(const DcmTagKey& tag, unsigned long pos = 0) {
    OFString value;
    root().findAndGetOFString(tag, value, pos);
    return value.c_str();
  }
  long frames() { return std::stol(text(DCM_NumberOfFrames)); }
  std::vector<std::int64_t> frame(long n) {
    Uint16 rows = 0, columns = 0, bits = 0;
    root().findAndGetUint16(DCM_Rows, rows);
    root().findAndGetUint16(DCM_Columns, columns);
    root().findAndGetUint16(DCM_BitsAllocated, bits);
    const std::size_t count = static_cast<std::size_t>(rows) * columns,
                      first = static_cast<std::size_t>(n) * count;
    std::vector<std::int64_t> out(count);
    const Uint16* words = nullptr;
    const Uint8* bytes = nullptr;
    if (bits == 1)
      root().findAndGetUint8Array(DCM_PixelData, bytes);
    else
      root().findAndGetUint16Array(DCM_PixelData, words);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = first + i;
      out[i] = bits == 1    ? bytes[at / 8] >> at % 8 & 1
               : bits == 16 ? words[at]
                            : words[2 * at] + (static_cast<std::int64_t>(words[2 * at + 1]) << 16);
    }
    return out;
  }
};

std::int64_t sum(const std::vector<std::int64_t>& v) {
  return std::accumulate(v.begin(), v.end(), std::int64_t{0});
}

void expectFrames(Phantom& p) {
  const Json& series = p.answers["series"][0];
  for (const Json& s : series["slices"]) {
    SCOPED_TRACE(s.dump());
    File f(p.folder / s["file"].get<std::string>());
    const long frame = s["frame"].get<long>() - 1;
    for (unsigned long a = 0; a < 3; ++a)
      EXPECT_NEAR(f.number(frame, DCM_PlanePositionSequence, DCM_ImagePositionPatient, a),
                  s["origin_mm"][a].get<double>(), 1e-9);
    EXPECT_EQ(sum(f.frame(frame)), s["stored_sum"].get<std::int64_t>());
    if (s.contains("echo_time_ms")) {
      EXPECT_EQ(f.number(frame, DCM_MREchoSequence, DCM_EffectiveEchoTime), s["echo_time_ms"].get<double>());
    }
    if (s.contains("rescale_slope")) {
      EXPECT_EQ(f.number(frame, DCM_PixelValueTransformationSequence, DCM_RescaleSlope),
                s["rescale_slope"].get<double>());
    }
  }
  for (const Json& probe : series["probes"]) {
    File f(p.folder / probe["file"].get<std::string>());
    const long frame = probe["frame"].get<long>() - 1;
    const std::int64_t stored =
        f.frame(frame)[probe["row"].get<std::size_t>() * series["columns"].get<std::size_t>() +
                       probe["column"].get<std::size_t>()];
    EXPECT_EQ(stored, probe["stored"].get<std::int64_t>()) << probe;
    EXPECT_NEAR(f.number(frame, DCM_PixelValueTransformationSequence, DCM_RescaleSlope) *
                        static_cast<double>(stored) +
                    f.number(frame, DCM_PixelValueTransformationSequence, DCM_RescaleIntercept),
                probe["modality"].get<double>(), 1e-12);
  }
}

TEST(MultiFramePhantom, EnhancedCtHoldsItsFramesShuffled) {
  Phantom p("enhanced-ct", {});
  expectFrames(p);
  File f(p.folder / "MF1.dcm");
  EXPECT_EQ(f.frames(), 16);
  bool ascending = true;
  for (long n = 1; n < 16; ++n)
    ascending &= f.number(n, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 2) >
                 f.number(n - 1, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 2);
  EXPECT_FALSE(ascending);
}

TEST(MultiFramePhantom, AConcatenationSaysWhereItsPartsBegin) {
  Phantom p("enhanced-ct", {{"parts", "3"}});
  expectFrames(p);
  std::map<std::string, std::pair<long, long>> parts;  // number -> offset, frames
  for (const char* name : {"MF1.dcm", "MF2.dcm", "MF3.dcm"}) {
    File f(p.folder / name);
    EXPECT_EQ(f.text(DCM_InConcatenationTotalNumber), "3");
    parts[f.text(DCM_InConcatenationNumber)] = {std::stol(f.text(DCM_ConcatenationFrameOffsetNumber)),
                                                f.frames()};
  }
  ASSERT_EQ(parts.size(), 3u);
  long next = 0;
  for (const auto& [number, part] : parts) {
    EXPECT_EQ(part.first, next) << number;
    next += part.second;
  }
  EXPECT_EQ(next, 16);
}

TEST(MultiFramePhantom, EnhancedMrHasTwoContrastsOfEachSlice) {
  for (const char* contrast : {"echoes", "diffusion"}) {
    SCOPED_TRACE(contrast);
    Phantom p("enhanced-mr", {{"contrast", contrast}});
    expectFrames(p);
    File f(p.folder / "MF1.dcm");
    EXPECT_EQ(f.frames(), 24);
    EXPECT_EQ(f.of(0, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 2),
              f.of(1, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 2));
    if (std::string(contrast) == "diffusion") {
      EXPECT_EQ(f.number(0, DCM_MRDiffusionSequence, DCM_DiffusionBValue), 0);
      EXPECT_EQ(f.number(1, DCM_MRDiffusionSequence, DCM_DiffusionBValue), 1000);
    } else {
      EXPECT_EQ(f.number(0, DCM_MREchoSequence, DCM_EffectiveEchoTime), 20);
      EXPECT_EQ(f.number(1, DCM_MREchoSequence, DCM_EffectiveEchoTime), 80);
    }
  }
}

// Inside or outside of the recipe's ellipsoids, typed again, at every pixel.
TEST(MultiFramePhantom, SegmentationIsItsSolids) {
  Phantom p("segmentation", {});
  const Json& a = p.answers["segmentation"];
  File f(p.folder / a["file"].get<std::string>());
  ASSERT_EQ(static_cast<std::size_t>(f.frames()), a["frames"].size());
  const auto inside = [](double x, double y, double z, double cx, double cy, double cz, double rx, double ry,
                         double rz) {
    return std::pow((x - cx) / rx, 2) + std::pow((y - cy) / ry, 2) + std::pow((z - cz) / rz, 2);
  };
  std::map<int, std::int64_t> voxels;
  for (long n = 0; n < f.frames(); ++n) {
    const Json& frame = a["frames"][static_cast<std::size_t>(n)];
    const auto bits = f.frame(n);
    EXPECT_EQ(sum(bits), frame["set_pixels"].get<std::int64_t>());
    EXPECT_GT(sum(bits), 0) << "empty frames are left out";
    const int segment = std::stoi(f.of(n, DCM_SegmentIdentificationSequence, DCM_ReferencedSegmentNumber));
    EXPECT_EQ(segment, frame["segment"].get<int>());
    voxels[segment] += sum(bits);
    const double x0 = f.number(n, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 0),
                 y0 = f.number(n, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 1),
                 z = f.number(n, DCM_PlanePositionSequence, DCM_ImagePositionPatient, 2);
    for (std::size_t i = 0; i < bits.size(); ++i) {
      const double x = x0 + 1.5 * static_cast<double>(i % 45), y = y0 + 1.75 * static_cast<double>(i / 45);
      const double d =
          segment == 1
              ? std::min(inside(x, y, z, 13, -4, 0, 9, 13, 40), inside(x, y, z, -13, -4, 0, 9, 13, 40))
              : std::min(inside(x, y, z, 13, -4, 12, 5, 5, 5), inside(x, y, z, -13, -4, -12, 4, 4, 4));
      if (std::abs(d - 1) > 1e-9) {
        ASSERT_EQ(bits[i], d < 1) << segment << " at " << x << "," << y << "," << z;
      }
    }
  }
  EXPECT_EQ(voxels[1], a["segments"][0]["voxels"].get<std::int64_t>());
  EXPECT_EQ(voxels[2], a["segments"][1]["voxels"].get<std::int64_t>());
}

TEST(MultiFramePhantom, DoseIsItsFormula) {
  for (const Settings& settings : {Settings{}, Settings{{"bits", "16"}, {"offsets", "absolute"}}}) {
    Phantom p("dose", settings);
    const Json& a = p.answers["dose"];
    File f(p.folder / a["file"].get<std::string>());
    const double scaling = std::stod(f.text(DCM_DoseGridScaling));
    EXPECT_EQ(f.text(DCM_GridFrameOffsetVector), settings.empty() ? "0" : "-25");
    for (long n = 0; n < f.frames(); ++n) {
      const auto v = f.frame(n);
      EXPECT_EQ(sum(v), a["planes"][static_cast<std::size_t>(n)]["stored_sum"].get<std::int64_t>());
      for (std::size_t i = 0; i < v.size(); ++i) {
        const double x = -32 + 4.0 * static_cast<double>(i % 17) - 4,
                     y = -31.5 + 4.5 * static_cast<double>(i / 17) + 2,
                     z = -25 + 5.0 * static_cast<double>(n);
        const double along = 0.6 * x + 0.8 * y, d2 = x * x + y * y + z * z - along * along;
        ASSERT_NEAR(scaling * static_cast<double>(v[i]), 0.5 + 59.5 * std::exp(-d2 / 162),
                    0.5 * scaling + 1e-9);
      }
    }
    for (const Json& probe : a["probes"])
      EXPECT_NEAR(probe["dose_gy"].get<double>(), probe["dose_gy_unrounded"].get<double>(),
                  0.5 * scaling + 1e-9);
  }
}

TEST(MultiFramePhantom, PassesDciodvfyWithoutError) {
  if (std::system("command -v dciodvfy > /dev/null 2>&1") != 0) {
    std::cout << "[  NOTE    ] dciodvfy (package dicom3tools) is not here: objects not checked\n";
    return;
  }
  for (const auto& [name, settings] :
       std::vector<std::pair<std::string, Settings>>{{"enhanced-ct", {}},
                                                     {"enhanced-ct", {{"parts", "2"}}},
                                                     {"enhanced-mr", {}},
                                                     {"enhanced-mr", {{"contrast", "diffusion"}}},
                                                     {"segmentation", {}},
                                                     {"dose", {}},
                                                     {"dose", {{"bits", "16"}, {"offsets", "absolute"}}}}) {
    Phantom p(name, settings);
    for (const auto& entry : std::filesystem::directory_iterator(p.folder)) {
      FILE* pipe = ::popen(("dciodvfy " + entry.path().string() + " 2>&1").c_str(), "r");
      char line[4096];
      int lines = 0;
      while (pipe && std::fgets(line, sizeof line, pipe)) {
        ++lines;
        EXPECT_EQ(std::string(line).find("Error"), std::string::npos)
            << name << ' ' << entry.path().filename() << ": " << line;
      }
      if (pipe) ::pclose(pipe);
      EXPECT_GT(lines, 0);
    }
  }
}

}  // namespace
}  // namespace vernier::test
