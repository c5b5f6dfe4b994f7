// SPDX-License-Identifier: GPL-3.0-or-later
// Every object of the shared data against values that other decoders computed: SHA-256 of all stored values.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "DecodeSupport.h"
#include "FrameSpecFrom.h"
#include "PixelModule.h"
#include "TestData.h"

namespace vernier::test {
namespace {

using nlohmann::json;

struct Decoded {
  std::optional<Error> error;
  std::string sha;
  FrameSpec spec;
};

Result<FrameSpec> specOf(const std::filesystem::path& path) {
  DcmFileFormat file;
  OFLog::configure(OFLogger::OFF_LOG_LEVEL);
  // Up to the pixels only: some files carry megabytes of zeros behind them, and a warning for every two
  // bytes.
  const OFCondition read = file.loadFileUntilTag(path.c_str(), EXS_Unknown, EGL_noChange, DCM_MaxReadLength,
                                                 ERM_autoDetect, DCM_PixelData);
  if (read.bad()) {  // DCMTK gives up on some files that Vernier's own reader, GDCM and pydicom read
    const Bytes bytes = bytesOfFile(path);
    const auto header = readHeader(*memorySource(bytes));
    if (!header || !header->pixels) return makeError(ErrorCode::NotDicom, read.text());
    return frameSpecOf(*header);
  }
  OFString declared;
  file.getMetaInfo()->findAndGetOFString(DCM_TransferSyntaxUID, declared);
  const char* seen = DcmXfer(file.getDataset()->getOriginalXfer()).getXferID();
  const bool known = DcmXfer(declared.c_str()).getXfer() != EXS_Unknown;
  // What the parser saw rules (files contradict their meta header), unless it cannot know the syntax named.
  return frameSpecFrom(*file.getDataset(), !declared.empty() && !known ? declared.c_str() : seen);
}

Decoded decodeReal(const std::filesystem::path& path) {
  auto spec = specOf(path);
  if (!spec) return {spec.error(), {}, {}};
  spec->frameCount = spec->framesDeclared;
  const Bytes file = bytesOfFile(path);
  if (auto r = spec->checkFileCanHold(file.size()); !r) return {r.error(), {}, *spec};
  Bytes out(*spec->outputBytes());
  if (auto r = decode(file, *spec, out); !r) return {r.error(), {}, *spec};
  return {std::nullopt, sha256Int32(valuesOf(spec->sample, out)), *spec};
}

json expectedOf(const std::string& folder) {
  std::ifstream in(dataDir() / "expected" / (folder + ".json"));
  return json::parse(in);
}

// Objects of a folder that carry expected values: all must decode to them.
void checkFolder(const std::string& folder, const std::map<std::string, std::string>& exceptions = {}) {
  VERNIER_NEEDS_DATA("expected/" + folder + ".json");
  const json expected = expectedOf(folder);
  std::size_t checked = 0;
  for (const json& object : expected["objects"]) {
    const std::string file = object["file"];
    const std::string sha = object.value("pixels", json::object()).value("stored_sha256_int32le", "");
    if (sha.empty()) continue;
    const Decoded d = decodeReal(dataDir() / folder / file);
    if (const auto e = exceptions.find(file); e != exceptions.end()) {
      std::cout << "[  NOTE    ] " << file << ": " << e->second << " ("
                << (d.error        ? d.error->text()
                    : d.sha == sha ? "equal"
                                   : "other values")
                << ")\n";
      continue;
    }
    EXPECT_FALSE(d.error) << file << ": " << d.error->text();
    if (!d.error) {
      EXPECT_EQ(d.sha, sha) << file << " in " << d.spec.transferSyntaxUid;
    }
    ++checked;
  }
  EXPECT_GT(checked, 0u);
}

TEST(DecodeReal, Charsets) { checkFolder("charsets"); }
TEST(DecodeReal, CodecEmriPalettePlanar) { checkFolder("codec_emri_palette_planar"); }
TEST(DecodeReal, CodecOneSeries) { checkFolder("codec_one_series_4_syntaxes"); }
TEST(DecodeReal, CodecSmallSingles) { checkFolder("codec_small_singles"); }
TEST(DecodeReal, CtPhantomHead) { checkFolder("ct_phantom_head_series"); }
TEST(DecodeReal, DicomdirTree) { checkFolder("dicomdir_tree"); }
TEST(DecodeReal, EnhancedMr) { checkFolder("enhanced_mr_multiframe"); }
TEST(DecodeReal, GeometryFaults) { checkFolder("geometry_faults"); }
TEST(DecodeReal, GspsLuts) { checkFolder("gsps_luts"); }
TEST(DecodeReal, Mono1Headless) { checkFolder("mono1_cr_headless"); }
TEST(DecodeReal, MrAdc) { checkFolder("mr_adc_series"); }
TEST(DecodeReal, MrBrainFse) { checkFolder("mr_brain_fse_series"); }
TEST(DecodeReal, RtstructWithCt) { checkFolder("rtstruct_with_ct"); }
TEST(DecodeReal, SegSr) { checkFolder("seg_sr_with_source"); }

// No other tool here decodes RLE of single bits or deflated frames; both are the same image as liver.dcm.
TEST(DecodeReal, SingleBitTwinsAreEqual) {
  VERNIER_NEEDS_DATA("codec_emri_palette_planar");
  const auto dir = dataDir() / "codec_emri_palette_planar";
  const Decoded plain = decodeReal(dir / "liver.dcm");
  ASSERT_FALSE(plain.error) << plain.error->text();
  for (const char* twin : {"liver_rle.dcm", "liver_deflate.dcm"}) {
    const Decoded d = decodeReal(dir / twin);
    EXPECT_FALSE(d.error) << twin << ": " << d.error->text();
    EXPECT_EQ(d.sha, plain.sha) << twin;
  }
}

// Objects without expected values (colour and the like) decode without an error all the same.
TEST(DecodeReal, ColourDecodes) {
  VERNIER_NEEDS_DATA("expected/codec_small_singles.json");
  std::size_t checked = 0;
  for (const std::string folder : {"codec_small_singles", "codec_emri_palette_planar"}) {
    const json expected = expectedOf(folder);
    for (const json& object : expected["objects"]) {
      const json pixels = object.value("pixels", json::object());
      if (!pixels.contains("decoders") || pixels["decoders"].empty()) continue;
      const std::string file = object["file"];
      const Decoded d = decodeReal(dataDir() / folder / file);
      EXPECT_FALSE(d.error) << file << ": " << d.error->text();
      ++checked;
    }
  }
  EXPECT_GT(checked, 60u);
}

// Damaged objects: what must load equals its values, what must be refused is refused with one sentence, the
// rest may do either, and nothing crashes.
void checkVerdicts(const std::string& folder) {
  VERNIER_NEEDS_DATA("expected/" + folder + ".json");
  const json expected = expectedOf(folder);
  for (const json& object : expected["objects"]) {
    const std::string file = object["file"], verdict = object.value("verdict", "");
    const Decoded d = decodeReal(dataDir() / folder / file);
    const std::string sha = object.value("pixels", json::object()).value("stored_sha256_int32le", "");
    if (d.error) {
      EXPECT_FALSE(d.error->sentence.empty()) << file;
    }
    if (verdict == "must-load" && !sha.empty()) {
      EXPECT_FALSE(d.error) << file << ": " << d.error->text();
      EXPECT_EQ(d.sha, sha) << file;
    }
    if (verdict == "must-refuse-pixels") {
      EXPECT_TRUE(d.error) << file;
    }
    if (verdict == "either" && object.value("kind", "") == "image")
      std::cout << "[  NOTE    ] " << file << ": "
                << (d.error        ? d.error->text()
                    : d.sha == sha ? "equal"
                                   : "decoded")
                << "\n";
  }
}

TEST(DecodeReal, FuzzVerdicts) { checkVerdicts("fuzz_cat02_07"); }
TEST(DecodeReal, MalformedVerdicts) { checkVerdicts("malformed_small"); }

}  // namespace
}  // namespace vernier::test
