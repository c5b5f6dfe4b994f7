// SPDX-License-Identifier: GPL-3.0-or-later
// I1 to I5: what a small, poor, absent or dying OpenGL does to pictures. The truth is a closed form: the
// volume's value is a linear function of the place, so every picture, drawn in whatever way, is that
// function.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>

#include "FaultyGl.h"
#include "GlForTest.h"
#include "Session.h"
#include "TestData.h"

namespace vernier::app {
namespace {

using test::glFaults;
using test::GlFaults;
using ::testing::AllOf;
using ::testing::HasSubstr;

double valueAt(double i, double j, double k) { return 10 * i + 3 * j - 7 * k; }

class GlExtremes : public ::testing::Test {
 protected:
  GlExtremes() { glFaults() = GlFaults{}; }

  // A session on a volume of 1 mm voxels with the value of valueAt, whose GL device has the faults of
  // glFaults().
  Session& session(int columns, int rows, int slices, const SessionOptions& given = {}) {
    const std::string path = (dir_.path() / "volume.mha").string();
    std::ofstream f(path, std::ios::binary);
    f << "ObjectType = Image\nNDims = 3\nDimSize = " << columns << ' ' << rows << ' ' << slices
      << "\nElementSpacing = 1 1 1\nOffset = 0 0 0\nElementType = MET_SHORT\nElementByteOrderMSB = False\n"
         "ElementDataFile = LOCAL\n";
    std::vector<std::int16_t> plane(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (int k = 0; k < slices; ++k) {
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
          plane[static_cast<std::size_t>(i + columns * j)] = static_cast<std::int16_t>(valueAt(i, j, k));
      f.write(reinterpret_cast<const char*>(plane.data()), static_cast<std::streamsize>(2 * plane.size()));
    }
    f.close();
    SessionOptions options = given;
    if (!options.makeDevice) options.makeDevice = [this] { return test::makeFaultyDevice(deviceOptions_); };
    session_ = std::make_unique<Session>(options);
    const Result<void> opened = session_->open({path});
    EXPECT_TRUE(opened.ok()) << (opened ? "" : opened.error().text());
    centre_ = {0.5 * (columns - 1), 0.5 * (rows - 1), 0.5 * (slices - 1)};
    return *session_;
  }
  // The slice through the volume's centre, one pixel per mm at `scale` 1, seen from the feet.
  Scene scene(const View& view, double scale = 1) const {
    SliceLayer slice;
    slice.plane = {PatientPoint(centre_), PatientVec(0, 0, -1), PatientVec(0, -1, 0)};
    slice.window = VoiWindow{0, 4000, VoiFunction::LinearExact, ""};
    Scene s;
    s.layers = {slice};
    s.camera.height_mm = view.height_px / scale;
    return s;
  }
  static View viewOf(int width, int height) {
    View v;
    v.width_px = width, v.height_px = height, v.wantValues = true;
    return v;
  }
  Result<Rendered> draw(const View& view, const Quality& quality = {}, double scale = 1) {
    RenderOptions options;
    options.measure = false;
    options.explain = true;
    return session_->render(scene(view, scale), view, quality, options);
  }
  // Every pixel of the picture against the closed form, and no pixel missing where the volume is.
  void expectTrue(const Rendered& r, const View& view, double scale = 1) const {
    const glm::dvec3 last = 2.0 * centre_;
    std::size_t inside = 0;
    for (int y = 0; y < view.height_px; ++y)
      for (int x = 0; x < view.width_px; ++x) {
        const double i = centre_.x + (x + 0.5 - 0.5 * view.width_px) / scale;
        const double j = centre_.y + (y + 0.5 - 0.5 * view.height_px) / scale;
        if (i < 0 || j < 0 || i > last.x || j > last.y) continue;
        ++inside;
        const float got =
            r.frame.images.values[static_cast<std::size_t>(x) +
                                  static_cast<std::size_t>(view.width_px) * static_cast<std::size_t>(y)];
        ASSERT_NEAR(got, valueAt(i, j, centre_.z), 0.02) << x << "," << y << " by " << r.frame.technique;
      }
    EXPECT_GT(inside, 0u);
  }
  static std::string whyRejected(const Plan& plan, const std::string& technique) {
    for (const Rejected& r : plan.rejected)
      if (r.what == technique) return r.why;
    return "not rejected";
  }
  static Quality with(EngineChoice engine, const std::string& technique = "") {
    Quality q;
    q.engine = engine;
    q.technique = technique;
    return q;
  }
  // Where a card is there and the processor is slow, the plan takes GL without being asked.
  void makeGlAttractive() {
    glFaults().renderer = "Some card";
    session_->costs().nsPerSample["mpr.native"] = 1e6;
  }
  test::TempDir dir_;
  gpu::DeviceOptions deviceOptions_;
  std::unique_ptr<Session> session_;
  glm::dvec3 centre_{0};
};

#define VERNIER_SKIP_WITHOUT_GL \
  VERNIER_NEEDS_GL(unused);     \
  (void)unused

TEST_F(GlExtremes, I1_OneVoxelBeyondTheLimitOf3dTexturesIsDrawnFromSlices) {
  VERNIER_SKIP_WITHOUT_GL;
  glFaults().max3d = 256;
  const View view = viewOf(257, 24);
  session(257, 24, 5);
  const auto r = draw(view, with(EngineChoice::Gl));
  ASSERT_TRUE(r.ok()) << r.error().text();
  EXPECT_EQ(r->frame.technique, "mpr.strips");
  EXPECT_THAT(whyRejected(r->plan, "mpr.polygon"), AllOf(HasSubstr("257 voxels"), HasSubstr("up to 256")));
  expectTrue(*r, view);
  session(256, 24, 5);
  EXPECT_TRUE(draw(viewOf(64, 24), with(EngineChoice::Gl, "mpr.polygon")).ok()) << "256 is within the limit";
}

TEST_F(GlExtremes, I1_OneVoxelBeyondEveryTextureIsDrawnWithoutGl) {
  VERNIER_SKIP_WITHOUT_GL;
  glFaults().max2d = glFaults().max3d = 64;
  const View view = viewOf(64, 64);
  session(65, 65, 3);
  const auto gl = draw(view, with(EngineChoice::Gl));
  ASSERT_FALSE(gl.ok());
  EXPECT_EQ(gl.error().code, ErrorCode::NoTechnique);
  EXPECT_THAT(gl.error().sentence, AllOf(HasSubstr("65 x 65"), HasSubstr("up to 64")));
  const auto any = draw(view);
  ASSERT_TRUE(any.ok()) << any.error().text();
  EXPECT_EQ(any->frame.technique, "mpr.native");
  expectTrue(*any, view);
}

TEST_F(GlExtremes, I1_TheDriversOwnLimitIsAskedAndNamed) {
  VERNIER_NEEDS_GL(device);
  const int limit = device->limits().max3d;
  const auto texture = device->texture3d(gpu::Format::R8, limit + 1, 1, 1);
  ASSERT_FALSE(texture.ok());
  EXPECT_THAT(texture.error().sentence, AllOf(HasSubstr(std::to_string(limit + 1) + " x 1 x 1"),
                                              HasSubstr("1 to " + std::to_string(limit))));
}

TEST_F(GlExtremes, I2_AVolumeAboveTheTextureBudgetIsDrawnInPieces) {
  VERNIER_SKIP_WITHOUT_GL;
  deviceOptions_.cacheLimit_bytes = 1 << 20;
  const View view = viewOf(96, 96);
  Session& s = session(96, 96, 128);  // 2.25 MiB of 16-bit texels
  const auto r = draw(view, with(EngineChoice::Gl));
  ASSERT_TRUE(r.ok()) << r.error().text();
  EXPECT_EQ(r->frame.technique, "mpr.strips");
  EXPECT_THAT(whyRejected(r->plan, "mpr.polygon"), AllOf(HasSubstr("2 MB"), HasSubstr("1 MB")));
  expectTrue(*r, view);
  // A plane along the third axis crosses all slices: more than the budget, one batch after the other.
  Scene sagittal = scene(viewOf(96, 128));
  std::get<SliceLayer>(sagittal.layers[0]).plane.normal = PatientVec(1, 0, 0);
  std::get<SliceLayer>(sagittal.layers[0]).plane.up = PatientVec(0, 0, 1);
  RenderOptions options;
  options.measure = false;
  const auto across = s.render(sagittal, viewOf(96, 128), with(EngineChoice::Gl), options);
  ASSERT_TRUE(across.ok()) << across.error().text();
  for (int row = 0; row < 128; ++row)
    ASSERT_NEAR(across->frame.images.values[static_cast<std::size_t>(48 + 96 * row)],
                valueAt(47.5, row, 127 - row), 750)
        << "row " << row;
  EXPECT_LE(s.derivedBytes(), (1u << 20) + 4096u);
}

TEST_F(GlExtremes, I2_ADriverWithoutRoomIsAskedBeforehand) {
  VERNIER_SKIP_WITHOUT_GL;
  const View view = viewOf(32, 32);
  session(64, 64, 16);
  glFaults().room = false;
  const auto named = draw(view, with(EngineChoice::Gl, "mpr.polygon"));
  ASSERT_FALSE(named.ok());
  EXPECT_EQ(named.error().code, ErrorCode::OutOfMemory);
  EXPECT_THAT(named.error().sentence, AllOf(HasSubstr("no room"), HasSubstr("64 x 64 x 16")));

  makeGlAttractive();
  session_->costs().nsPerSample["mpr.strips"] = 1e5;  // the polygon goes first
  Session fresh = [this] {
    SessionOptions o;
    o.makeDevice = [this] { return test::makeFaultyDevice(deviceOptions_); };
    return Session(o);
  }();
  ASSERT_TRUE(fresh.open({(dir_.path() / "volume.mha").string()}).ok());
  fresh.costs() = session_->costs();
  RenderOptions options;
  options.measure = false;
  options.explain = true;
  const auto any = fresh.render(scene(view), view, {}, options);
  ASSERT_TRUE(any.ok()) << any.error().text();
  EXPECT_EQ(any->frame.engine, "native");
  ASSERT_FALSE(any->plan.notes.empty());
  EXPECT_THAT(any->plan.notes.back(), AllOf(HasSubstr("drawn without OpenGL"), HasSubstr("64 x 64 x 16")));
  expectTrue(*any, view);
  EXPECT_TRUE(fresh.capabilities(true).gl) << "too little memory for one picture is no reason to give GL up";
}

TEST_F(GlExtremes, I2_MoreThanTheRealDriverHoldsIsRefusedWithoutTakingIt) {
  VERNIER_NEEDS_GL(device);
  const int n = device->limits().max3d;  // 2048: 32 GiB
  const auto texture = device->texture3d(gpu::Format::R32F, n, n, n);
  ASSERT_FALSE(texture.ok());
  EXPECT_EQ(texture.error().code, ErrorCode::OutOfMemory);
  EXPECT_THAT(texture.error().sentence, HasSubstr("MiB"));
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss / 1024, 2000);
  EXPECT_TRUE(device->texture3d(gpu::Format::R8, 8, 8, 8).ok()) << "the device goes on";
}

TEST_F(GlExtremes, I3_NoContext) {
  SessionOptions none;
  none.makeDevice = []() -> Result<std::unique_ptr<gpu::Device>> {
    return makeError(ErrorCode::GlUnavailable, "OpenGL is not available: no driver at all.");
  };
  const View view = viewOf(40, 30);
  session(40, 30, 8, none);
  const auto any = draw(view);
  ASSERT_TRUE(any.ok()) << any.error().text();
  EXPECT_EQ(any->frame.engine, "native");
  EXPECT_THAT(whyRejected(any->plan, "mpr.polygon"), HasSubstr("no driver at all"));
  expectTrue(*any, view);
  const auto gl = draw(view, with(EngineChoice::Gl));
  ASSERT_FALSE(gl.ok());
  EXPECT_THAT(gl.error().sentence, HasSubstr("no driver at all"));
}

TEST_F(GlExtremes, I3_NoFloatImages) {
  VERNIER_SKIP_WITHOUT_GL;
  glFaults().floatImages = false;
  const auto device = test::makeFaultyDevice();
  ASSERT_FALSE(device.ok());
  EXPECT_EQ(device.error().code, ErrorCode::GlUnavailable);
  EXPECT_THAT(device.error().sentence, HasSubstr("float images"));
  const View view = viewOf(40, 30);
  session(40, 30, 8);
  const auto any = draw(view);
  ASSERT_TRUE(any.ok()) << any.error().text();
  EXPECT_EQ(any->frame.engine, "native");
  EXPECT_THAT(whyRejected(any->plan, "mpr.strips"), HasSubstr("float images"));
  EXPECT_THAT(session_->capabilities(true).glWhyNot, HasSubstr("float images"));
  expectTrue(*any, view);
}

TEST_F(GlExtremes, I3_No3dTextures) {
  VERNIER_SKIP_WITHOUT_GL;
  glFaults().max3d = 0;
  const View view = viewOf(40, 30);
  session(40, 30, 8);
  const auto r = draw(view, with(EngineChoice::Gl));
  ASSERT_TRUE(r.ok()) << r.error().text();
  EXPECT_EQ(r->frame.technique, "mpr.strips");
  EXPECT_THAT(whyRejected(r->plan, "mpr.polygon"), HasSubstr("up to 0"));
  expectTrue(*r, view);
}

TEST_F(GlExtremes, I4_OnePixel) {
  session(41, 31, 9);
  const View view = viewOf(1, 1);
  for (const char* technique : {"mpr.native", "mpr.strips", "mpr.polygon"}) {
    if (std::string(technique) != "mpr.native" && !test::glDevice()) continue;
    const auto r = draw(view, with(EngineChoice::Auto, technique));
    ASSERT_TRUE(r.ok()) << technique << ": " << r.error().text();
    EXPECT_NEAR(r->frame.images.values.at(0), valueAt(20, 15, 4), 0.01) << technique;
  }
}

TEST_F(GlExtremes, I4_NoPixelsAreRefusedAndNothingIsDrawn) {
  session(40, 30, 8);
  for (const auto& [w, h] : {std::pair{0, 0}, {0, 10}, {10, 0}, {-1, 10}, {16385, 1}, {1, 16385}}) {
    const auto r = draw(viewOf(w, h));
    ASSERT_FALSE(r.ok()) << w << "x" << h;
    EXPECT_EQ(r.error().code, ErrorCode::OptionInvalid);
    EXPECT_THAT(r.error().sentence, HasSubstr("1 to 16384"));
  }
  EXPECT_EQ(glFaults().contexts, 0);
}

TEST_F(GlExtremes, I4_ThinAndWidePicturesOfTheLargestSide) {
  session(300, 30, 8);
  for (const View& view : {viewOf(16384, 1), viewOf(1, 16384), viewOf(16384, 40)}) {
    const auto r = draw(view, {}, view.width_px > 1 ? 50 : 500);
    ASSERT_TRUE(r.ok()) << r.error().text();
    expectTrue(*r, view, view.width_px > 1 ? 50 : 500);
  }
}

TEST_F(GlExtremes, I4_ALargestPictureAboveTheBudgetIsRefusedWithItsNumbers) {
  SessionOptions small;
  small.memory_mb = 512;
  session(40, 30, 8, small);
  const auto r = draw(viewOf(16384, 16384));
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::OutOfMemory);
  EXPECT_THAT(r.error().sentence,
              AllOf(HasSubstr("16384 x 16384"), HasSubstr("6912 MiB"), HasSubstr("512 MiB")));
  EXPECT_EQ(session_->budget().used() >> 20, 0u) << "nothing stays reserved";
}

// 2.5 device pixels per point: the same part of the patient, finer.
TEST_F(GlExtremes, I4_HiDpiShowsTheSamePlaces) {
  session(60, 50, 8);
  const View points = viewOf(60, 50), pixels = viewOf(150, 125);
  const auto coarse = draw(points), fine = draw(pixels, {}, 2.5);
  ASSERT_TRUE(coarse.ok() && fine.ok());
  expectTrue(*coarse, points);
  expectTrue(*fine, pixels, 2.5);
}

TEST_F(GlExtremes, I5_ALostContextIsMadeAnewOnce) {
  VERNIER_SKIP_WITHOUT_GL;
  const View view = viewOf(40, 30);
  Session& s = session(40, 30, 8);
  makeGlAttractive();
  const auto before = draw(view);
  ASSERT_TRUE(before.ok()) << before.error().text();
  ASSERT_EQ(before->frame.engine, "gl");
  const Scene kept = scene(view);

  glFaults().loseAtDraw = 1;
  const auto once = draw(view);
  ASSERT_TRUE(once.ok()) << once.error().text();
  EXPECT_EQ(once->frame.engine, "gl");
  EXPECT_EQ(glFaults().contexts, 2);
  EXPECT_EQ(once->frame.images.colour, before->frame.images.colour) << "the same picture, bit for bit";
  ASSERT_FALSE(once->plan.notes.empty());
  EXPECT_THAT(once->plan.notes.back(), HasSubstr("made anew"));

  glFaults().loseAtDraw = 2;
  const auto twice = draw(view);
  ASSERT_TRUE(twice.ok()) << twice.error().text();
  EXPECT_EQ(twice->frame.engine, "native");
  EXPECT_THAT(twice->plan.notes.back(), AllOf(HasSubstr("drawn without OpenGL"), HasSubstr("lost")));
  expectTrue(*twice, view);
  EXPECT_FALSE(s.capabilities(true).gl);
  EXPECT_THAT(s.capabilities(true).glWhyNot, HasSubstr("lost"));

  const auto later = draw(view);
  ASSERT_TRUE(later.ok());
  EXPECT_EQ(later->frame.engine, "native");
  EXPECT_TRUE(later->plan.notes.empty()) << "said once";
  EXPECT_EQ(glFaults().contexts, 2) << "no third try";
  EXPECT_EQ(scene(view), kept);
  EXPECT_EQ(draw(view, with(EngineChoice::Gl)).error().code, ErrorCode::NoTechnique);
}

TEST_F(GlExtremes, I5_WhenGlWasAskedForASecondLossIsAnError) {
  VERNIER_SKIP_WITHOUT_GL;
  session(40, 30, 8);
  const View view = viewOf(40, 30);
  glFaults().loseAtDraw = 1;
  ASSERT_TRUE(draw(view, with(EngineChoice::Gl)).ok());
  glFaults().loseAtDraw = 1;
  const auto r = draw(view, with(EngineChoice::Gl));
  ASSERT_FALSE(r.ok());
  EXPECT_EQ(r.error().code, ErrorCode::GlLost);
  EXPECT_EQ(exitCode(r.error().code), 1);
}

TEST_F(GlExtremes, I5_TheErrorIsMeasuredOfThePictureThatIsShown) {
  VERNIER_SKIP_WITHOUT_GL;
  session(40, 30, 8);
  makeGlAttractive();
  const View view = viewOf(40, 30);
  glFaults().loseAtDraw = 1;
  RenderOptions options;
  options.explain = true;
  const auto r = session_->render(scene(view), view, {}, options);
  ASSERT_TRUE(r.ok()) << r.error().text();
  ASSERT_TRUE(r->error && r->error->bound);
  EXPECT_LE(*r->error->bound, 0.05);
  EXPECT_EQ(r->plan.passes.at(0).engine, Engine::Gl);
}

}  // namespace
}  // namespace vernier::app
