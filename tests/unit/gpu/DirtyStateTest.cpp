// SPDX-License-Identifier: GPL-3.0-or-later
// Each operation is preceded by a state that no pass would choose; the picture must not change by a bit.
#include <vector>

#include "GlForTest.h"
#include "GpuTestShaders.h"

namespace vernier::gpu {
namespace {
using namespace vernier::gpu::test;

std::vector<float> picture(Device& d, const DrawState& state, bool dirty) {
  unsigned seed = 0;
  const auto odd = [&] {
    if (dirty) d.setOddStateForTest(seed++);
  };
  std::vector<std::uint16_t> texels(15);
  for (std::size_t n = 0; n < texels.size(); ++n) texels[n] = static_cast<std::uint16_t>(4000 * n);
  odd();
  auto image = d.texture2d(Format::R16, 5, 3, std::as_bytes(std::span(texels)));
  odd();
  auto quad = d.vertices(kQuad, kQuadLayout);
  odd();
  auto program = d.program("test fetch", kVertex, kFetch);
  odd();
  auto target = d.target(33, 17, kFloat4, true);
  EXPECT_TRUE(image.ok() && quad.ok() && program.ok() && target.ok());
  odd();
  EXPECT_TRUE(d.clear(*target, 0, {0.25, 0.25, 0.25, 0.25}).ok());
  odd();
  EXPECT_TRUE(d.clearDepth(*target, 1.0f).ok());
  odd();
  const Draw draw{program->get(),
                  &*quad,
                  0,
                  6,
                  Primitive::Triangles,
                  state,
                  {{"image", &*image, Filter::Linear, Wrap::Edge}},
                  {{"size", glm::vec2(33, 17)}}};
  const Result<void> r = d.draw(*target, {&draw, 1});
  EXPECT_TRUE(r.ok()) << r.error().text();
  odd();
  std::vector<float> out(33 * 17 * 4);
  EXPECT_TRUE(d.read(*target, 0, out).ok());
  return out;
}

TEST(DirtyState, DoesNotChangeAPictureByABit) {
  VERNIER_NEEDS_GL(device);
  DrawState blended;
  blended.blend = Blend::Over, blended.scissor = Rect{1, 2, 20, 10};
  DrawState tested;
  tested.depth = DepthTest::LessEqual, tested.depthWrite = true, tested.cull = Cull::Front;
  DrawState masked;
  masked.blend = Blend::Max, masked.colourMask = {true, false, true, false},
  masked.viewport = Rect{4, 4, 20, 9};
  for (const DrawState& state : {DrawState{}, blended, tested, masked}) {
    const std::vector<float> clean = picture(*device, state, false);
    EXPECT_NE(clean.front(), clean[4 * (33 * 8 + 10)]);  // there is a picture
    EXPECT_EQ(clean, picture(*device, state, true));
  }
}

}  // namespace
}  // namespace vernier::gpu
