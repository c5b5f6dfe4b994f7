// SPDX-License-Identifier: GPL-3.0-or-later
// `vernier info --json` against data/expected: totals, kinds, stored values, modality extrema, probes, names
// and verdicts, for every DICOM folder; stacks and findings stand in InfoExpectedStacksTest.cpp. What the
// expected files compute by a simpler rule than ours is mapped here or in ExpectedFacts.cpp, with the reason
// beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <set>

#include "InfoExpected.h"
#include "InfoJson.h"

namespace vernier::test {

std::ostream& operator<<(std::ostream& o, const Totals& t) {
  return o << "files " << t.files << " objects " << t.objects << " images " << t.images << " frames "
           << t.frames << " uids " << t.distinctUids << " not DICOM " << t.notDicom << " directories "
           << t.directories;
}

namespace {

constexpr const char* kFolders[] = {"charsets",
                                    "codec_emri_palette_planar",
                                    "codec_one_series_4_syntaxes",
                                    "codec_small_singles",
                                    "ct_phantom_head_series",
                                    "dicomdir_tree",
                                    "enhanced_mr_multiframe",
                                    "fuzz_cat02_07",
                                    "geometry_faults",
                                    "gsps_luts",
                                    "malformed_small",
                                    "mono1_cr_headless",
                                    "mr_adc_series",
                                    "mr_brain_fse_series",
                                    "rtstruct_with_ct",
                                    "seg_sr_with_source"};

TEST_P(InfoExpected, Totals) {
  if (!here_) return;
  const Json &want = facts_.expected.at("totals"), &got = facts_.info.at("totals");
  // Every file is there, whatever it is.
  EXPECT_EQ(got.at("files"), want.at("files"));
  for (const char* key : {"patients", "studies", "series"}) EXPECT_EQ(got.at(key), want.at(key)) << key;
  // Where tools disagree whether a file can be read ("either": 18 of fuzz_cat02_07 that pydicom alone cannot
  // read, or alone reads as an empty object; 14 of malformed_small), no count is truth; all others must
  // agree.
  EXPECT_EQ(infoTotals(facts_, false), expectedTotals(facts_, false));
  bool allDecided = true;
  for (const Json& o : facts_.expected.at("objects"))
    allDecided = allDecided && o.value("verdict", "") != "either";
  if (!allDecided) return;
  for (const char* key :
       {"objects", "images", "frames", "distinct_sop_instance_uids", "files_repeating_a_sop_instance_uid"})
    EXPECT_EQ(got.at(key), want.at(key)) << key;
  for (const auto& [key, value] : want.items())
    if (key.starts_with("kind: ")) {
      EXPECT_EQ(got.at("files_by_kind").value(key.substr(6), 0), value) << key;
    }
}

TEST_P(InfoExpected, EachFileIsListedWithItsKindOrAnErrorOfOneSentence) {
  if (!here_) return;
  for (const Json& o : facts_.expected.at("objects")) {
    const std::string name = o.at("file");
    SCOPED_TRACE(name);
    const Json* file = facts_.file(name);
    ASSERT_TRUE(file);
    const Json* object = facts_.object(name);
    if (facts_.undecided(name)) {
      EXPECT_TRUE(object || file->contains("error"));
    } else {
      EXPECT_EQ(file->at("kind"), o.at("kind"));
    }
    if (file->contains("error")) {
      const std::string sentence = file->at("error").at("sentence");
      EXPECT_GT(sentence.size(), 20u);
      EXPECT_EQ(sentence.find('\n'), std::string::npos);
      EXPECT_EQ(sentence.back(), '.');
    }
    if (!object || facts_.undecided(name)) continue;
    for (const auto& [theirs, ours] :
         std::initializer_list<std::pair<const char*, const char*>>{{"sop_class", "sop_class_uid"},
                                                                    {"sop_instance", "sop_instance_uid"},
                                                                    {"modality", "modality"},
                                                                    {"frames", "frames"},
                                                                    {"photometric", "photometric"}})
      if (o.contains(theirs)) {
        EXPECT_EQ(object->at(ours), o[theirs]) << theirs;
      }
    // PS3.6 marks two old ultrasound classes as retired; pydicom leaves that out.
    if (o.contains("sop_class_name")) {
      std::string got = object->at("sop_class_name");
      if (const auto at = got.find(" (Retired)"); at != std::string::npos) got.erase(at);
      EXPECT_EQ(got, o["sop_class_name"]);
    }
    if (o.at("kind") == "non-image") {
      EXPECT_FALSE(object->value("not_shown", "").empty());
    }
  }
}

namespace {
void compareFrames(const Json& want, const Json& got) {
  ASSERT_EQ(got.size(), want.size());
  for (std::size_t f = 0; f < want.size(); ++f) {
    SCOPED_TRACE(f);
    const auto near = [&](const char* theirs, const Json& ours, double tolerance) {
      if (want[f].contains(theirs)) {
        EXPECT_NEAR(ours.get<double>(), want[f][theirs].get<double>(), tolerance) << theirs;
      }
    };
    for (std::size_t a = 0; want[f].contains("ipp") && a < 3; ++a)
      EXPECT_NEAR(got[f].at("origin_lps_mm")[a].get<double>(), want[f]["ipp"][a].get<double>(), 1e-9);
    near("slope", got[f].at("rescale")[0], 1e-12);
    near("inter", got[f].at("rescale")[1], 1e-12);
    if (want[f].contains("te")) near("te", got[f].at("echo_time_ms"), 1e-9);
    if (want[f].contains("idx")) {
      EXPECT_EQ(got[f].at("dimension_index"), want[f]["idx"]);
    }
    if (want[f].contains("seg")) {
      EXPECT_EQ(std::to_string(got[f].at("segment").get<int>()), want[f]["seg"].get<std::string>());
    }
    if (want[f].contains("tpi")) {
      EXPECT_EQ(std::to_string(got[f].at("temporal_position").get<int>()), want[f]["tpi"].get<std::string>());
    }
    if (want[f].contains("wc")) {
      EXPECT_EQ(got[f].at("window"), Json::array({want[f]["wc"][0], want[f].at("ww")[0]}));
    }
  }
}
}  // namespace

TEST_P(InfoExpected, StoredValuesExtremaAndProbes) {
  if (!here_) return;
  for (const Json& o : facts_.expected.at("objects")) {
    const std::string name = o.at("file");
    if (!o.contains("pixels") || facts_.undecided(name)) continue;
    SCOPED_TRACE(name);
    const Json& want = o["pixels"];
    const Json* object = facts_.object(name);
    ASSERT_TRUE(object);
    const Json& got = object->at("pixels");
    if (want.contains("rgb_mean_dcmj2pnm")) {
      ASSERT_TRUE(got.contains("rgb_mean")) << got.dump();
      // YBR is never exact: their conversion is made of whole numbers.
      const bool exact =
          !object->at("lossy").get<bool>() && o.value("photometric", "").starts_with("YBR") == false;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(got["rgb_mean"][c].get<double>(), want["rgb_mean_dcmj2pnm"][c].get<double>(),
                    exact ? 0.01 : 1.0);
    }
    if (!want.contains("stored_sha256_int32le")) continue;
    ASSERT_TRUE(got.contains("stored_sha256_int32le")) << got.dump();
    EXPECT_EQ(got["stored_sha256_int32le"], want["stored_sha256_int32le"]);
    for (const char* key : {"stored_min", "stored_max", "stored_sum"})
      EXPECT_EQ(got.at(key), want.at(key)) << key;
    const auto compare = [&](const std::string& theirs, const std::string& ours) {
      if (!want.contains(theirs)) return;
      ASSERT_TRUE(got.contains(ours)) << ours;
      const double value = want[theirs];
      EXPECT_NEAR(got[ours].get<double>(), value, 1e-9 * std::max(1.0, std::abs(value))) << theirs;
    };
    for (const char* key :
         {"modality_min", "modality_max", "modality_min_without_padding", "modality_max_without_padding"})
      compare(key, key);
    compare("dose_min", "modality_min");
    compare("dose_max", "modality_max");
    const Json probes = want.value("probes", Json::array());
    ASSERT_EQ(got.at("probes").size(), probes.size());
    for (std::size_t p = 0; p < probes.size(); ++p) {
      EXPECT_EQ(got["probes"][p].at("stored"), probes[p].at("stored"));
      if (!probes[p].contains("lps_mm")) continue;
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_NEAR(got["probes"][p].at("lps_mm")[a].get<double>(), probes[p]["lps_mm"][a].get<double>(),
                    1e-4);
    }
  }
}

// What each frame of an object with functional groups has, and where the planes of a dose grid lie.
TEST_P(InfoExpected, FramesOfMultiFrameObjects) {
  if (!here_) return;
  for (const Json& o : facts_.expected.at("objects")) {
    const Json* object = facts_.object(o.at("file"));
    SCOPED_TRACE(o.at("file").get<std::string>());
    const Json frames = o.value("per_frame", Json::array());
    const std::size_t count = o.value("frames", std::size_t{1});
    if (frames.size() == count && count > 0) compareFrames(frames, object->at("frame_attributes"));
    if (!o.contains("grid_frame_offsets_mm") || count == 1) continue;
    const Json& got = object->at("frame_attributes");
    ASSERT_EQ(got.size(), count);
    for (std::size_t f = 0; f < count; ++f)
      EXPECT_NEAR(got[f].at("origin_lps_mm")[2].get<double>(),
                  o.at("ipp")[2].get<double>() + o["grid_frame_offsets_mm"][f].get<double>(), 1e-9);
  }
}

TEST_P(InfoExpected, Verdicts) {
  if (!here_) return;
  for (const Json& o : facts_.expected.at("objects")) {
    const std::string verdict = o.value("verdict", ""), name = o.at("file");
    if (verdict != "must-load" && verdict != "must-refuse-pixels") continue;
    SCOPED_TRACE(name);
    const Json* object = facts_.object(name);
    ASSERT_TRUE(object);
    const bool refused = object->contains("pixel_error") || object->at("pixels").contains("error");
    EXPECT_EQ(refused, verdict == "must-refuse-pixels") << object->dump(1);
  }
}

INSTANTIATE_TEST_SUITE_P(Folders, InfoExpected, ::testing::ValuesIn(kFolders),
                         [](const auto& p) { return std::string(p.param); });

TEST(InfoNames, SeventeenCharacterSets) {
  VERNIER_NEEDS_DATA("charsets");
  const Facts facts = factsOf("charsets");
  std::size_t files = 0, names = 0;
  for (const Json& want : facts.expected.at("extra").at("names")) {
    SCOPED_TRACE(want.at("file").get<std::string>());
    const Json* object = facts.object(want.at("file"));
    ASSERT_TRUE(object);
    ++files;
    for (const Json& name : want.at("names")) {
      // pydicom prints several values as "[a, b]"; in DICOM a backslash stands between them.
      std::string text = name.at("pydicom");
      if (text.size() > 2 && text.front() == '[' && text.back() == ']') {
        text = text.substr(1, text.size() - 2);
        for (std::size_t at; (at = text.find(", ")) != std::string::npos;) text.replace(at, 2, "\\");
      }
      ++names;
      const Json want2{{"at", name.at("at")}, {"text", text}};
      const Json& got = object->at("names");
      EXPECT_NE(std::find(got.begin(), got.end(), want2), got.end()) << want2 << " not in " << got;
    }
  }
  EXPECT_EQ(files, 17u);
  EXPECT_GE(names, 30u);
  EXPECT_TRUE(facts.findings("text-undecodable").empty());
}

TEST(InfoValues, FilesWithEqualExpectedHashDecodeToEqualValues) {
  VERNIER_NEEDS_DATA("codec_one_series_4_syntaxes");
  const Facts facts = factsOf("codec_one_series_4_syntaxes");
  ASSERT_EQ(facts.info.at("series").size(), 1u);
  ASSERT_EQ(facts.info["series"][0].at("stacks").size(), 1u);
  EXPECT_EQ(facts.info["series"][0]["stacks"][0].at("slices"), 4);  // 16 files, 4 objects
  std::map<std::string, std::set<std::string>> hashes;
  for (const Json& o : facts.info.at("objects"))
    hashes[o.at("sop_instance_uid")].insert(o.at("pixels").at("stored_sha256_int32le").get<std::string>());
  EXPECT_EQ(hashes.size(), 4u);
  for (const auto& [uid, set] : hashes) EXPECT_EQ(set.size(), 1u);
}

// Counted by Patient ID, as the expected files are; listed apart, with a warning.
TEST(InfoValues, OneIdWithThreeBirthDatesIsListedAsThreePatients) {
  VERNIER_NEEDS_DATA("geometry_faults");
  const Facts facts = factsOf("geometry_faults");
  EXPECT_EQ(facts.info.at("totals").at("patients"), 1);
  EXPECT_EQ(facts.info.at("patients").size(), 3u);
  ASSERT_EQ(facts.findings("patient-id-of-several-people").size(), 1u);
}

TEST(InfoText, SaysGeometryFindingsAndWhatFailed) {
  VERNIER_NEEDS_DATA("geometry_faults");
  auto set = scanStudy({(dataDir() / "geometry_faults").string()});
  ASSERT_TRUE(set);
  set->patients[0].name = "Evil\x1b[2J^Name";  // a terminal must not obey it
  FileRecord broken;
  broken.shown = "broken.dcm", broken.bytes = 3, broken.kind = FileKind::Unreadable;
  broken.error = makeError(ErrorCode::FileDamaged, "It is broken.", "broken.dcm");
  set->files.push_back(std::move(broken));
  const std::string text = infoText(*set);
  for (const char* part :
       {"tilt 14 degrees", "1 gap", "WARNING gap: 1 slice is missing between 28.1 and 38.1 mm",
        "Failed broken.dcm: It is broken.", "3 studies, 3 series, 10 objects"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace vernier::test
