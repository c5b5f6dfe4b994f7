// SPDX-License-Identifier: GPL-3.0-or-later
// Multi-frame phantoms through the loader, the volume and every slice view; what loading a large multi-frame
// file needs of memory.
#include <nlohmann/json.hpp>

#include "MakeDicom.h"
#include "PhantomStudy.h"
#include "RunProgram.h"
#include "Session.h"
#include "TestPaths.h"
#include "vernier/plan/Presets.h"

namespace vernier::test {
namespace {

TEST(MultiFrameStudy, EnhancedCtIsTheVolumeOfItsAnswersWholeOrInParts) {
  for (const char* parts : {"1", "2", "4"}) {
    SCOPED_TRACE(parts);
    Loaded l("enhanced-ct", {{"parts", parts}});
    expectWhole(l, l.answers["series"][0]);
    EXPECT_EQ(codesOf(l.only()).contains("concatenation"), std::string(parts) != "1");
    EXPECT_EQ(l.study.instances.size(), static_cast<std::size_t>(std::stoi(parts)));
  }
}

TEST(MultiFrameStudy, APartThatIsMissingIsSaid) {
  Loaded l("enhanced-ct", {{"parts", "4"}});
  std::filesystem::remove(l.dir.path() / "enhanced-ct" / "MF2.dcm");
  const auto set = scanStudy({(l.dir.path() / "enhanced-ct").string()});
  ASSERT_TRUE(set);
  EXPECT_TRUE(codesOf(set->series.at(0)).contains("concatenation-incomplete"));
  EXPECT_TRUE(codesOf(set->series.at(0)).contains("gap"));
}

TEST(MultiFrameStudy, TwoContrastsAreTwoVolumesWithTheirOwnSlope) {
  for (const char* contrast : {"echoes", "diffusion"}) {
    SCOPED_TRACE(contrast);
    Loaded l("enhanced-mr", {{"contrast", contrast}});
    const Series& series = l.only();
    ASSERT_EQ(series.stacks.size(), 2u);
    const bool echoes = std::string(contrast) == "echoes";
    EXPECT_EQ(series.stacks[1].label, echoes ? "echo time 80 ms" : "b-value 1000");
    const double factor = echoes ? 0.25 : 0.375, slope = echoes ? 0.125 : 0.25;
    const auto first = volumeOf(l, series, series.stacks[0]), second = volumeOf(l, series, series.stacks[1]);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(second->info().rescale[0].slope, slope);
    const auto lesion =
        std::find_if(l.answers["series"][0]["probes"].begin(), l.answers["series"][0]["probes"].end(),
                     [](const Json& p) { return p["name"] == "lesion"; });
    const PatientPoint at = pointOf((*lesion)["patient_mm"]);
    EXPECT_EQ(probeStored(*first, at)->stored, (*lesion)["stored"].get<double>());
    EXPECT_EQ(probeStored(*first, at)->modality, 600);
    EXPECT_NEAR(probeStored(*second, at)->modality, factor * 600, slope / 2);
    // Each frame's sum, found by place and contrast.
    for (const Json& s : l.answers["series"][0]["slices"]) {
      const bool isSecond = s["rescale_slope"].get<double>() == slope;
      const Volume& v = isSecond ? *second : *first;
      const auto p = (v.voxelFromPatient() * pointOf(s["origin_mm"])).p;
      const std::int64_t k = std::llround(p.z);
      double sum = 0;
      for (std::int64_t j = 0; j < v.grid().rows; ++j)
        for (std::int64_t i = 0; i < v.grid().columns; ++i) sum += v.stored(i, j, k);
      EXPECT_EQ(sum, s["stored_sum"].get<double>()) << s;
    }
  }
}

// Each segment is a volume of 0 and 1 on the CT's lattice, with the empty frames in their places.
TEST(MultiFrameStudy, SegmentsLieWhereTheirAnswersSay) {
  Loaded l("segmentation", {{"plane", "axial"}});
  const Json& a = l.answers["segmentation"];
  const Series& series = l.seriesOf(a["series_uid"]);
  const Instance& object = l.study.instances[series.instances[0]];
  ASSERT_EQ(object.segments.size(), 2u);
  ASSERT_EQ(series.stacks.size(), 2u);
  EXPECT_TRUE(codesOf(series).contains("empty-frames-left-out"));
  EXPECT_FALSE(codesOf(series).contains("gap"));
  const auto ct = volumeOf(l, l.only(), l.only().stacks[0]);
  for (const Json& segment : a["segments"]) {
    SCOPED_TRACE(segment.dump());
    const Stack* stack = nullptr;
    for (const Stack& s : series.stacks)
      if (s.label.starts_with("segment " + std::to_string(segment["number"].get<int>()))) stack = &s;
    ASSERT_TRUE(stack);
    const auto v = volumeOf(l, series, *stack);
    ASSERT_TRUE(v);
    EXPECT_EQ(v->info().frameOfReferenceUid, ct->info().frameOfReferenceUid);
    double set = 0;
    for (std::int64_t k = 0; k < v->grid().slices; ++k)
      for (std::int64_t j = 0; j < v->grid().rows; ++j)
        for (std::int64_t i = 0; i < v->grid().columns; ++i) set += v->stored(i, j, k);
    EXPECT_EQ(set, segment["voxels"].get<double>());
    // Every voxel of it is a voxel of the CT.
    const glm::dvec3 p =
        (ct->voxelFromPatient() * (v->grid().patientFromVoxel * VoxelPoint(glm::dvec3(3, 4, 1)))).p;
    EXPECT_NEAR(glm::length(p - glm::round(p)), 0, 1e-6);
    EXPECT_TRUE(v->grid().even());
    for (const Json& f : a["frames"]) {
      if (f["segment"] != segment["number"]) continue;
      const std::int64_t k = std::llround((v->voxelFromPatient() * pointOf(f["origin_mm"])).p.z);
      double sum = 0;
      for (std::int64_t j = 0; j < v->grid().rows; ++j)
        for (std::int64_t i = 0; i < v->grid().columns; ++i) sum += v->stored(i, j, k);
      EXPECT_EQ(sum, f["set_pixels"].get<double>()) << f;
    }
  }
}

TEST(MultiFrameStudy, DoseIsGrayAtItsProbes) {
  for (const Settings& settings : {Settings{}, Settings{{"bits", "16"}}, Settings{{"offsets", "absolute"}}}) {
    Loaded l("dose", settings);
    const Json& a = l.answers["dose"];
    const Series& series = l.seriesOf(a["series_uid"]);
    const auto v = volumeOf(l, series, series.stacks.at(0));
    ASSERT_TRUE(v);
    EXPECT_EQ(v->info().unit, "Gy");
    EXPECT_NEAR(series.stacks[0].step_mm, a["step_mm"].get<double>(), 1e-9);
    for (const Json& p : a["probes"]) {
      const auto probe = probeStored(*v, pointOf(p["patient_mm"]));
      ASSERT_TRUE(probe) << p;
      EXPECT_EQ(probe->stored, p["stored"].get<double>());
      EXPECT_NEAR(probe->modality, p["dose_gy"].get<double>(), 1e-9);
      EXPECT_NEAR(*sampleModality(*v, pointOf(p["patient_mm"])), p["dose_gy"].get<double>(), 1e-5);
    }
  }
}

// Every slice view of every multi-frame volume is drawn by the techniques that are there, within their stated
// error, and is no blank.
TEST(MultiFrameStudy, AreDrawnInEverySliceView) {
  for (const auto& [name, choice] : std::vector<std::pair<std::string, std::string>>{
           {"enhanced-ct", ""}, {"enhanced-mr", "1#2"}, {"segmentation", "2"}, {"dose", "2"}}) {
    TempDir dir;
    const auto info = writePhantom(name, dir.path(), {});
    ASSERT_TRUE(info);
    app::SessionOptions options;
    options.pluginFolders = {std::string(VERNIER_BUILD_DIR) + "/lib/vernier/plugins"};
    app::Session session(options);
    ASSERT_TRUE(session.open({info->data.string()}));
    const std::string source = choice.empty() ? choice : [&] {
      // The series beside the CT is the one of another modality.
      if (choice.find('#') != std::string::npos) return choice;
      for (std::size_t s = 0; s < session.study().series.size(); ++s)
        if (session.study().series[s].modality != "CT") return std::to_string(s + 1);
      return std::string();
    }();
    const auto chosen = session.choose(source);
    ASSERT_TRUE(chosen) << chosen.error().text();
    session.use(*chosen);
    const auto volume = session.volume("");
    ASSERT_TRUE(volume) << volume.error().text();
    for (const char* view : {"axial", "coronal", "sagittal", "oblique", "slab"}) {
      SCOPED_TRACE(name + " " + view);
      const auto scene = presetScene(view, "", **volume, {});
      ASSERT_TRUE(scene);
      View size;
      size.width_px = size.height_px = 96;
      const auto r = session.render(*scene, size, {}, {});
      ASSERT_TRUE(r) << r.error().text();
      float low = 1, high = 0;
      for (std::size_t p = 0; p < r->frame.images.colour.size(); p += 4) {
        low = std::min(low, r->frame.images.colour[p]);
        high = std::max(high, r->frame.images.colour[p]);
      }
      // Between the lungs there is nothing to see of their segment.
      const bool between = name == "segmentation" && std::string(view) == "sagittal";
      if (!between) {
        EXPECT_GT(high - low, 0.1f);  // not an empty picture
      }
      ASSERT_TRUE(r->error);
      // A slab at draft is sampled, which its own tests bound.
      if (std::string(view) != "slab") {
        EXPECT_LE(r->error->max, 2.0) << "levels of 255";
      }
    }
    const auto frame = session.image("", 0);
    ASSERT_TRUE(frame) << frame.error().text();
  }
}

// --- memory ---

// A multi-frame CT of 256 frames of 512 x 512: 128 MB. Values that deflate packs, but not as a bomb.
std::filesystem::path writeLarge(const std::filesystem::path& dir, const std::string& syntax) {
  std::vector<double> z(256);
  for (std::size_t f = 0; f < z.size(); ++f) z[f] = static_cast<double>(f);
  EnhancedObject o = enhancedStack(z);
  o.rows = o.columns = 512;
  o.transferSyntaxUid = syntax;
  o.pixels.resize(512 * 512 * 256);
  std::uint32_t state = 1;
  for (std::int64_t& p : o.pixels) p = (state = state * 1664525u + 1013904223u) >> 30;
  writeEnhanced(dir / "large.dcm", o);
  return dir / "large.dcm";
}

TEST(MultiFrameStudy, LoadingTakesAtMostOnePointThreeTimesTheVolumeAnd100MB) {
  for (const char* syntax : {"1.2.840.10008.1.2.1", "1.2.840.10008.1.2.1.99", "1.2.840.10008.1.2.5"}) {
    SCOPED_TRACE(syntax);
    TempDir dir;
    const auto file = writeLarge(dir.path(), syntax);
    const ProgramRun r =
        runProgram({VERNIER_PROGRAM, "render", file.string(), "--view", "axial", "--no-error", "--size",
                    "64x64", "--out", (dir.path() / "a.png").string()},
                   120);
    ASSERT_EQ(r.exitCode, 0) << r.err;
    EXPECT_LE(r.peakRss_mb, 1.3 * 128 + 100) << "MB";
    std::cout << "[  NOTE    ] " << syntax << ": peak " << r.peakRss_mb << " MB for a volume of 128 MB\n";
  }
}

}  // namespace
}  // namespace vernier::test
