// SPDX-License-Identifier: GPL-3.0-or-later
#include "vernier/gpu/Device.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <thread>
#include <vector>

#include "GlForTest.h"
#include "GpuTestShaders.h"

namespace vernier::gpu {
namespace {
using namespace vernier::gpu::test;
using testing::HasSubstr;

TEST(Device, LimitsAndNamesAreTheDriversOwn) {
  VERNIER_NEEDS_GL(device);
  EXPECT_GE(device->limits().max2d, 1024);  // the least that OpenGL 3.3 allows
  EXPECT_GE(device->limits().max3d, 256);
  EXPECT_GE(device->limits().maxColours, 8);
  EXPECT_FALSE(device->limits().renderer.empty());
  EXPECT_THAT(device->limits().version, HasSubstr("Core"));
  Capabilities c;
  c.glWhyNot = "old";
  describe(device->limits(), c);
  EXPECT_TRUE(c.gl);
  EXPECT_EQ(c.max3dTexture, device->limits().max3d);
  EXPECT_EQ(c.glWhyNot, "");
}

TEST(Device, MissingLibraryIsOneSentence) {
  const DeviceOptions options{"/nonexistent/libOSMesa.so", 1};
  const auto device = Device::make(options);
  ASSERT_FALSE(device.ok());
  EXPECT_EQ(device.error().code, ErrorCode::GlUnavailable);
  EXPECT_THAT(device.error().sentence, HasSubstr("install libosmesa6"));
  EXPECT_EQ(device.error().sentence.find("/nonexistent"), std::string::npos);
  Capabilities c;
  c.gl = true, c.max3dTexture = 1;
  probe(c, options);
  EXPECT_FALSE(c.gl);
  EXPECT_EQ(c.max3dTexture, 0);
  EXPECT_EQ(c.glWhyNot, device.error().sentence);
}

TEST(Device, LibraryOfAnotherKindIsRefused) {
  const auto device = Device::make({"libm.so.6", 1});
  ASSERT_FALSE(device.ok());
  EXPECT_EQ(device.error().code, ErrorCode::GlUnavailable);
  EXPECT_THAT(device.error().sentence, HasSubstr("OSMesaCreateContextAttribs"));
}

TEST(Device, EnvironmentSwitchesGlOff) {
  setenv("VERNIER_GL", "off", 1);
  const auto device = Device::make();
  unsetenv("VERNIER_GL");
  ASSERT_FALSE(device.ok());
  EXPECT_EQ(device.error().code, ErrorCode::GlUnavailable);
}

TEST(Device, AnotherThreadIsRefusedUntilItAdopts) {
  VERNIER_NEEDS_GL(device);
  std::thread([&] {
    const Result<void> r = device->finish();
    ASSERT_FALSE(r.ok());
    EXPECT_EQ(r.error().code, ErrorCode::GlFailed);
    EXPECT_FALSE(device->adopt().ok());
  }).join();
  ASSERT_TRUE(device->release().ok());
  EXPECT_FALSE(device->finish().ok());
  std::thread([&] {
    ASSERT_TRUE(device->adopt().ok());
    EXPECT_TRUE(device->target(4, 4, kFloat4).ok());
    ASSERT_TRUE(device->release().ok());
  }).join();
  ASSERT_TRUE(device->adopt().ok());
  EXPECT_TRUE(device->finish().ok());
}

TEST(Device, ShaderErrorsCarryTheDriversLogShortened) {
  VERNIER_NEEDS_GL(device);
  const auto bad =
      device->program("bad", kVertex, "#version 330 core\nout vec4 c;\nvoid main() { c = nowhere; }\n");
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().code, ErrorCode::ShaderInvalid);
  EXPECT_EQ(bad.error().where, "bad, fragment shader");
  EXPECT_THAT(bad.error().sentence, HasSubstr("nowhere"));
  EXPECT_EQ(bad.error().sentence.find('\n'), std::string::npos);

  std::string many = "#version 330 core\nout vec4 c;\nvoid main() {\n";
  for (int n = 0; n < 200; ++n) many += "c = missing" + std::to_string(n) + ";\n";
  const auto longLog = device->program("long", kVertex, many + "}\n");
  ASSERT_FALSE(longLog.ok());
  EXPECT_LT(longLog.error().sentence.size(), 500u);

  const auto unlinked = device->program(
      "unlinked", kVertex,
      "#version 330 core\nin vec4 vertexColour;\nout vec4 c;\nvoid main() { c = vertexColour; }\n");
  ASSERT_FALSE(unlinked.ok());
  EXPECT_EQ(unlinked.error().code, ErrorCode::ShaderInvalid);
  EXPECT_TRUE(device->finish().ok());  // no error is left behind
}

class DrawTest : public testing::Test {
 protected:
  // Draws the quad into an 8 x 8 target; `change` alters the draw before.
  template <class Change>
  Result<std::vector<float>> drawn(Device& d, Change change) {
    auto program = d.program("test colour", kVertex, kColour);
    auto quad = d.vertices(kQuad, kQuadLayout);
    auto target = d.target(8, 8, kFloat4, true);
    if (!program) return program.error();
    Draw draw{program->get(), &*quad, 0, 6, Primitive::Triangles, {}, {}, {{"gain", 2.0f}}};
    change(draw);
    if (auto r = d.clear(*target, 0, {9, 9, 9, 9}); !r) return r.error();
    if (auto r = d.clearDepth(*target, 1.0f); !r) return r.error();
    if (auto r = d.draw(*target, {&draw, 1}); !r) return r.error();
    std::vector<float> out(8 * 8 * 4);
    if (auto r = d.read(*target, 0, out); !r) return r.error();
    return out;
  }
};

TEST_F(DrawTest, RowZeroIsTheTopAndColoursAreNotClamped) {
  VERNIER_NEEDS_GL(device);
  const auto out = drawn(*device, [](Draw&) {});
  ASSERT_TRUE(out.ok()) << out.error().text();
  // Green is 0 at clip y = -1, our top row, and 1 at the bottom; the gain doubles it.
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const float* p = &(*out)[static_cast<std::size_t>(4 * (8 * y + x))];
      EXPECT_NEAR(p[0], 2 * (x + 0.5) / 8, 1e-6);
      EXPECT_NEAR(p[1], 2 * (y + 0.5) / 8, 1e-6);
      EXPECT_EQ(p[2], 2.0f);
      EXPECT_EQ(p[3], 0.5f);
    }
}

TEST_F(DrawTest, CountersCountTrianglesAndFragments) {
  VERNIER_NEEDS_GL(device);
  const Counters before = device->counters();
  ASSERT_TRUE(drawn(*device, [](Draw& d) { d.state.scissor = Rect{2, 1, 3, 4}; }).ok());
  EXPECT_EQ(device->counters().triangles - before.triangles, 2u);
  EXPECT_EQ(device->counters().samples - before.samples, 12u);
}

TEST_F(DrawTest, ScissorMaskBlendAndCullActAsStated) {
  VERNIER_NEEDS_GL(device);
  auto out = drawn(*device, [](Draw& d) { d.state.scissor = Rect{0, 0, 8, 2}; });
  EXPECT_EQ((*out)[2], 2.0f);              // top row drawn
  EXPECT_EQ((*out)[4 * 8 * 7 + 2], 9.0f);  // bottom row kept
  out = drawn(*device, [](Draw& d) { d.state.colourMask = {true, true, false, true}; });
  EXPECT_EQ((*out)[2], 9.0f);
  EXPECT_EQ((*out)[3], 0.5f);
  out = drawn(*device, [](Draw& d) { d.state.blend = Blend::Add; });
  EXPECT_EQ((*out)[2], 11.0f);
  out = drawn(*device, [](Draw& d) { d.state.blend = Blend::Max; });
  EXPECT_EQ((*out)[2], 9.0f);
  out = drawn(*device, [](Draw& d) { d.state.blend = Blend::Min; });
  EXPECT_EQ((*out)[2], 2.0f);
  out = drawn(*device, [](Draw& d) { d.state.blend = Blend::Over; });
  EXPECT_EQ((*out)[2], 2.0f + 9.0f * 0.5f);
  // Alpha 0.5 is what is left of colour and of alpha (9) behind.
  out = drawn(*device, [](Draw& d) { d.state.blend = Blend::Remaining; });
  EXPECT_EQ((*out)[2], 2.0f + 9.0f * 0.5f);
  EXPECT_EQ((*out)[3], 9.0f * 0.5f);
  // The quad runs top left, top right, bottom left: clockwise as one sees it, so it is a back face.
  out = drawn(*device, [](Draw& d) { d.state.cull = Cull::Back; });
  EXPECT_EQ((*out)[2], 9.0f);
  out = drawn(*device, [](Draw& d) { d.state.cull = Cull::Front; });
  EXPECT_EQ((*out)[2], 2.0f);
  out = drawn(*device, [](Draw& d) { d.state.depth = DepthTest::Greater; });
  EXPECT_EQ((*out)[2], 9.0f);
  out = drawn(*device, [](Draw& d) { d.state.depth = DepthTest::Less; });
  EXPECT_EQ((*out)[2], 2.0f);
}

TEST_F(DrawTest, MistakesAreRefusedByName) {
  VERNIER_NEEDS_GL(device);
  auto out = drawn(*device, [](Draw& d) { d.uniforms.clear(); });
  ASSERT_FALSE(out.ok());
  EXPECT_EQ(out.error().code, ErrorCode::GlFailed);
  EXPECT_THAT(out.error().sentence, HasSubstr("'gain' was not given"));
  out = drawn(*device, [](Draw& d) { d.uniforms = {{"gain", 1}}; });
  EXPECT_THAT(out.error().sentence, HasSubstr("another type"));
  out = drawn(*device, [](Draw& d) { d.count = 7; });
  EXPECT_THAT(out.error().sentence, HasSubstr("0 to 6 of 6"));
  EXPECT_TRUE(drawn(*device, [](Draw&) {}).ok());
}

TEST_F(DrawTest, ReadingTheImageThatIsDrawnIntoIsRefused) {
  VERNIER_NEEDS_GL(device);
  auto program = device->program("test fetch", kVertex, kFetch);
  ASSERT_TRUE(program.ok()) << program.error().text();
  auto quad = device->vertices(kQuad, kQuadLayout);
  auto target = device->target(8, 8, kFloat4);
  Draw draw{program->get(), &*quad, 0, 6, Primitive::Triangles, {}, {}, {{"size", glm::vec2(8, 8)}}};
  Result<void> r = device->draw(*target, {&draw, 1});
  EXPECT_THAT(r.error().sentence, HasSubstr("'image' was not given"));
  draw.textures = {{"image", &target->colour(0)}};
  r = device->draw(*target, {&draw, 1});
  ASSERT_FALSE(r.ok());
  EXPECT_THAT(r.error().sentence, HasSubstr("drawn into"));
}

TEST(Device, OwnersMayGoOnAnyThreadAndAfterTheDevice) {
  VERNIER_NEEDS_GL(shared);
  auto device = Device::make();
  ASSERT_TRUE(device.ok());  // a second context beside the shared one
  auto a = (*device)->target(4, 4, kFloat4, true);
  auto b = (*device)->target(4, 4, kFloat4, true);
  ASSERT_TRUE(a.ok() && b.ok());
  std::thread([gone = std::move(*a)]() mutable { const Target t = std::move(gone); }).join();
  EXPECT_TRUE((*device)->finish().ok());
  device->reset();
  { const Target t = std::move(*b); }
  EXPECT_TRUE(shared->finish().ok());  // makes itself current again
}

constexpr const char* kClipVertex = R"(#version 330 core
layout(location = 0) in vec2 position;
layout(location = 1) in vec3 colour;
uniform float z;
uniform vec2 cut;
out vec3 vertexColour;
out float gl_ClipDistance[8];
void main() {
  vertexColour = colour;
  gl_Position = vec4(position, z, 1.0);
  for (int n = 0; n < 8; ++n) gl_ClipDistance[n] = n == 1 ? cut.x + cut.y * position.x : 1.0;
})";

// How many pixels of an 8 x 8 target the two triangles cover.
std::size_t covered(Device& device, const VertexData& vertices, const DrawState& state, float z,
                    glm::vec2 cut = {1, 0}) {
  const auto program = device.program("clip", kClipVertex, kColour);
  const Result<Target> target = device.target(8, 8, kFloat4, true);
  EXPECT_TRUE(program.ok() && target.ok());
  EXPECT_TRUE(device.clear(*target, 0, {0, 0, 0, 0}).ok());
  EXPECT_TRUE(device.clearDepth(*target, 0).ok());
  Draw d;
  d.program = program->get(), d.vertices = &vertices, d.count = vertices.count(), d.state = state;
  d.uniforms = {{"gain", 1.0f}, {"z", z}, {"cut", cut}};
  EXPECT_TRUE(device.draw(*target, {&d, 1}).ok());
  std::vector<float> out(256);
  EXPECT_TRUE(device.read(*target, 0, out).ok());
  std::size_t n = 0;
  for (std::size_t p = 3; p < out.size(); p += 4) n += out[p] > 0;
  return n;
}

TEST(Device, ClipDistancesCutAndDepthIsHeldInRange) {
  VERNIER_NEEDS_GL(device);
  const Result<VertexData> quad = device->vertices(kQuad, kQuadLayout);
  ASSERT_TRUE(quad.ok());
  constexpr glm::vec2 kRightHalf{0, -1};
  DrawState state;
  state.clipDistances = 2;
  EXPECT_EQ(covered(*device, *quad, state, 0), 64u);
  EXPECT_EQ(covered(*device, *quad, state, 0, kRightHalf), 32u);
  EXPECT_EQ(covered(*device, *quad, state, 1.5), 0u);
  state.depthClamp = true;
  EXPECT_EQ(covered(*device, *quad, state, 1.5), 64u);
  state.depth = DepthTest::Greater;
  EXPECT_EQ(covered(*device, *quad, state, -1.5), 0u);  // held at 0, which is not above 0
  EXPECT_EQ(covered(*device, *quad, {}, 1.5), 0u);      // nothing of it stays
}

TEST(Device, IndicesShareVertices) {
  VERNIER_NEEDS_GL(device);
  const std::array<float, 20> corners{-1, -1, 0, 0, 1, 1, -1, 1, 0, 1, -1, 1, 0, 1, 1, 1, 1, 1, 1, 1};
  const std::array<std::uint32_t, 6> indices{0, 1, 2, 2, 1, 3};
  const Result<VertexData> quad = device->vertices(corners, kQuadLayout, indices);
  ASSERT_TRUE(quad.ok());
  EXPECT_EQ(quad->count(), 6);
  EXPECT_EQ(quad->bytes(), sizeof corners + sizeof indices);
  EXPECT_EQ(covered(*device, *quad, {}, 0), 64u);
  const std::array<std::uint32_t, 3> half{0, 1, 2};
  const Result<VertexData> one = device->vertices(corners, kQuadLayout, half);
  EXPECT_EQ(covered(*device, *one, {}, 0) +
                covered(*device, *device->vertices(corners, kQuadLayout, std::span(indices).last(3)), {}, 0),
            64u);
  const std::array<std::uint32_t, 3> beyond{0, 1, 4};
  EXPECT_THAT(device->vertices(corners, kQuadLayout, beyond).error().sentence,
              HasSubstr("names a vertex that is not there"));
}

TEST(Device, VertexDataAndTexturesShareOneLimit) {
  VERNIER_NEEDS_GL(device);
  DeviceCache cache(3 * sizeof kQuad);
  int made = 0;
  const auto make = [&] { return ++made, device->vertices(kQuad, kQuadLayout); };
  const auto first = cache.vertices({"quad", 1, 0}, make);
  EXPECT_EQ(*cache.vertices({"quad", 1, 0}, make), *first);
  EXPECT_EQ(made, 1);
  for (Revision r : {2, 3, 4}) ASSERT_TRUE(cache.vertices({"quad", r, 0}, make).ok());
  EXPECT_EQ(cache.bytes(), 3 * sizeof kQuad);
  ASSERT_TRUE(cache.vertices({"quad", 1, 0}, make).ok());  // went when the fourth came
  EXPECT_EQ(made, 5);
}

}  // namespace
}  // namespace vernier::gpu
