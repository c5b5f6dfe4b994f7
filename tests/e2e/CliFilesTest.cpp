// SPDX-License-Identifier: GPL-3.0-or-later
// Volume files, archives and DICOMDIRs through the program: opened as a user does, hostile ones refused with
// a sentence, and nothing written anywhere.
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "CliFixture.h"
#include "MakeDicomDir.h"
#include "MakeZip.h"

namespace vernier::test {
namespace {

class CliFiles : public Cli {
 protected:
  // The program in a home and a place for temporary files of its own.
  ProgramRun run(std::vector<std::string> args) {
    fs::create_directories(dir_.path() / "home");
    fs::create_directories(dir_.path() / "tmp");
    args.insert(args.begin(), kProgram);
    return runProgram(args, 20,
                      {"HOME=" + path("home"), "XDG_CONFIG_HOME=" + path("home"), "TMPDIR=" + path("tmp")});
  }
  std::set<std::string> everything() const {
    std::set<std::string> all;
    for (const auto& e : fs::recursive_directory_iterator(dir_.path())) all.insert(e.path().string());
    return all;
  }
  // A NIfTI-1 file of 4x3x2 int16 with the numbers 0 to 23, 1x2x3 mm, RAS axes; `change` edits the header.
  template <class T>
  static void put(std::string& s, std::size_t at, T x) {
    std::memcpy(s.data() + at, &x, sizeof x);
  }
  static std::string nifti() {
    std::string s(352, '\0');
    put<std::int32_t>(s, 0, 348);
    const std::int16_t dim[] = {3, 4, 3, 2, 1, 1, 1, 1};
    for (std::size_t i = 0; i < 8; ++i) put(s, 40 + 2 * i, dim[i]);
    put<std::int16_t>(s, 70, 4);
    put<std::int16_t>(s, 72, 16);
    put<float>(s, 108, 352);
    s[123] = 2;
    put<std::int16_t>(s, 254, 1);
    put<float>(s, 280, 1), put<float>(s, 300, 2), put<float>(s, 320, 3);
    std::memcpy(s.data() + 344, "n+1", 3);
    for (std::int16_t i = 0; i < 24; ++i) s.append(reinterpret_cast<const char*>(&i), 2);
    return s;
  }
  nlohmann::json info(const std::string& input) {
    const ProgramRun r = run({"info", input, "--json", "--pixels"});
    EXPECT_EQ(r.exitCode, 0) << show(r);
    return nlohmann::json::parse(r.out);
  }
};

TEST_F(CliFiles, AVolumeFileIsListedAndDrawn) {
  const std::string file = write("brain.nii", nifti());
  const auto j = info(file);
  ASSERT_EQ(j["volume_files"].size(), 1u);
  const auto& v = j["volume_files"][0];
  EXPECT_EQ(v["file"], "brain.nii");
  EXPECT_EQ(v["format"], "NIfTI-1");
  EXPECT_EQ(v["dims"], nlohmann::json({4, 3, 2}));
  EXPECT_EQ(v["spacing_mm"], nlohmann::json({1.0, 2.0, 3.0}));
  EXPECT_EQ(v["patient_from_voxel"][0], nlohmann::json({-1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(v["unit"], "stored value");
  EXPECT_EQ(v["voxels"]["stored_max"], 23);
  EXPECT_EQ(v["voxels"]["stored_sum"], 276);
  EXPECT_NE(run({"info", file}).out.find("Volume file 1  brain.nii  NIfTI-1"), std::string::npos);
  for (const char* view : {"stack", "axial", "coronal", "oblique"}) {
    const ProgramRun r = run({"render", file, "--view", view, "--size", "80x80", "--out", path("o.png")});
    EXPECT_EQ(r.exitCode, 0) << view << show(r);
  }
  expectSentence(run({"render", file, "--view", "axial", "--frame", "1", "--out", path("p.png")}), 2);
  expectSentence(run({"render", file, "--view", "axial", "--z-span", "9", "--out", path("p.png")}), 2);
  expectSentence(run({"render", file, "--view", "axial", "--out", file}), 2);
}

TEST_F(CliFiles, AnArchiveOfAStudyAndAVolumeFile) {
  writeSmallStudy(dir_.path() / "s");
  std::vector<ZipEntry> entries{{"x/brain.nii", nifti()}};
  for (const auto& e : fs::directory_iterator(dir_.path() / "s"))
    entries.push_back({"s/" + e.path().filename().string(), readFile(e.path())});
  entries.push_back({"../../escape.dcm", entries[1].bytes});
  writeZip(path("a.zip"), entries);
  const auto before = everything();
  const auto j = info(path("a.zip"));
  EXPECT_EQ(j["totals"]["objects"], 12);
  ASSERT_EQ(j["volume_files"].size(), 1u);
  EXPECT_EQ(j["volume_files"][0]["file"], "brain.nii");
  EXPECT_EQ(j["series"][0]["stacks"][0]["slices"], 12);
  for (const auto& f : j["files"]) EXPECT_EQ(f["file"].get<std::string>().find('/'), std::string::npos);
  EXPECT_EQ(everything(), [&] {
    auto all = before;
    all.insert({path("home"), path("tmp")});
    return all;
  }());
  const ProgramRun inside =
      run({"render", path("a.zip"), "--view", "coronal", "--no-letters", "--out", path("in.png")});
  const ProgramRun outside =
      run({"render", path("s"), "--view", "coronal", "--no-letters", "--out", path("out.png")});
  ASSERT_EQ(inside.exitCode, 0) << show(inside);
  ASSERT_EQ(outside.exitCode, 0) << show(outside);
  EXPECT_EQ(run({"compare", path("in.png"), path("out.png"), "--max-error", "0"}).exitCode, 0);
  const ProgramRun volume =
      run({"render", path("a.zip"), "--series", "brain.nii", "--view", "axial", "--out", path("v.png")});
  EXPECT_EQ(volume.exitCode, 0) << show(volume);
}

TEST_F(CliFiles, HostileInputIsRefusedAndNothingIsWritten) {
  const std::string good = nifti();
  const auto edited = [&](auto edit) {
    std::string s = good;
    edit(s);
    return s;
  };
  write("cut.nii", good.substr(0, good.size() - 1));
  write("nan.nii", edited([](std::string& s) { put<float>(s, 284, NAN); }));
  write("five.nii", edited([](std::string& s) { put<std::int16_t>(s, 40, 5), put<std::int16_t>(s, 50, 3); }));
  write("huge.nii", edited([](std::string& s) {
          for (std::size_t d = 42; d < 48; d += 2) put<std::int16_t>(s, d, 32767);
        }));
  write("four.nii", edited([](std::string& s) {
          put<std::int16_t>(s, 40, 4), put<std::int16_t>(s, 46, 1), put<std::int16_t>(s, 48, 2);
        }));
  writeZip(path("up.zip"), {{"../up.nii", good}});
  writeZip(path("absolute.zip"), {{"/tmp/absolute.nii", good}});
  writeZip(path("link.zip"), {{"link.nii", "/etc/passwd", false, 0120777}});
  writeZip(path("bomb.zip"), {{"bomb.nii", good + std::string(100 << 20, '\0')}});
  writeZip(path("nested.zip"), {{"inner.zip", zipBytes({{"brain.nii", good}}), false}});
  write("cut.zip", zipBytes({{"brain.nii", good}}).substr(0, 60));
  write("outside-DICOMDIR", dicomDirBytes({"..\\..\\etc\\passwd", "NONE"}));
  fs::create_directories(dir_.path() / "home");
  fs::create_directories(dir_.path() / "tmp");
  const auto before = everything();
  const std::pair<const char*, int> inputs[] = {
      {"cut.nii", 3},  {"nan.nii", 3},    {"five.nii", 1},     {"huge.nii", 3},
      {"four.nii", 2}, {"up.zip", 3},     {"absolute.zip", 3}, {"link.zip", 3},
      {"bomb.zip", 3}, {"nested.zip", 3}, {"cut.zip", 3},      {"outside-DICOMDIR", 3}};
  for (const auto& [name, code] : inputs) {
    SCOPED_TRACE(name);
    const ProgramRun r = run({"render", path(name), "--view", "axial", "--out", path("o.png")});
    expectSentence(r, code);
    EXPECT_LT(r.peakRss_mb, 150);
    (void)run({"info", path(name), "--json"});
    EXPECT_EQ(everything(), before);
  }
}

// One voxel and one slice are read.
TEST_F(CliFiles, TheSmallestVolumesAreDrawn) {
  for (const std::int16_t slices : {std::int16_t{1}, std::int16_t{2}})
    for (const bool one : {true, false}) {
      std::string s = nifti();
      put<std::int16_t>(s, 46, slices);
      if (one) put<std::int16_t>(s, 42, 1), put<std::int16_t>(s, 44, 1);
      const std::string file = write("small.nii", s);
      for (const char* view : {"stack", "axial", "sagittal"}) {
        const ProgramRun r = run({"render", file, "--view", view, "--size", "40x40", "--out", path("o.png")});
        EXPECT_EQ(r.exitCode, 0) << view << " " << slices << show(r);
      }
    }
}

}  // namespace
}  // namespace vernier::test
