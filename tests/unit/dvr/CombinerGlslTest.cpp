// SPDX-License-Identifier: GPL-3.0-or-later
// Combiners as GLSL against their evaluation in double: 100 x 100 random inputs, one for each pixel of a
// float target, for every shipped combiner and for many made at random out of all that the format has.
#include <gtest/gtest.h>

#include "CombinerForTest.h"
#include "GlForTest.h"
#include "vernier/base/Random.h"

namespace vernier::dvr {
namespace {
using gpu::Format;
using test::shipped;

constexpr int kSide = 100;
constexpr std::size_t kPixels = kSide * kSide;
constexpr std::array<Format, 1> kFloat4{Format::Rgba32F};

constexpr const char* kVertex = R"(#version 330 core
layout(location = 0) in vec2 position;
void main() { gl_Position = vec4(position, 0.0, 1.0); })";

// A program reads at most 8 textures; where the combiner's own leave no room for the plain registers, these
// hold kPlain.
constexpr std::size_t kMostSamplers = 8;
constexpr glm::vec4 kPlain(0.25, -0.5, 0.75, 0.375);

std::vector<Register> registersOf(const Combiner& c) {
  std::vector<Register> out;
  for (std::size_t n = 0; n < textureCount(c); ++n) out.push_back(textureRegister(n));
  for (const Register r : {Register::Primary, Register::Secondary, Register::Constant0, Register::Constant1})
    out.push_back(r);
  return out;
}

// Every register comes from a texture of its own, one texel for each pixel. The function gets another name,
// so that it cannot lean on its usual one.
std::string fragmentOf(const Combiner& c) {
  std::string samplers, arguments;
  for (std::size_t n = 0; n < registersOf(c).size(); ++n) {
    const std::string name = "input" + std::to_string(n);
    if (n < kMostSamplers) samplers += "uniform sampler2D " + name + ";\n";
    arguments += n ? ", " : "";
    arguments += n < kMostSamplers ? "texelFetch(" + name + ", ivec2(gl_FragCoord.xy), 0)"
                                   : "vec4(0.25, -0.5, 0.75, 0.375)";
  }
  return "#version 330 core\n" + samplers + "layout(location = 0) out vec4 colour;\n" +
         combinerGlsl(c, "mixed") + "void main() { colour = mixed(" + arguments + "); }\n";
}

// The greatest difference over all pixels and channels.
double difference(gpu::Device& device, const Combiner& c, std::uint64_t seed) {
  const auto target = device.target(kSide, kSide, kFloat4);
  const std::array<float, 6> corners{-1, -1, 3, -1, -1, 3};
  const std::array<int, 1> layout{2};
  const auto vertices = device.vertices(corners, layout);
  const auto program = device.program("test " + combinerDigest(c), kVertex, fragmentOf(c));
  if (!target || !vertices || !program) {
    ADD_FAILURE() << c.name << ": " << (program ? "target" : program.error().text());
    return 9;
  }
  const std::vector<Register> registers = registersOf(c);
  std::vector<std::vector<float>> values(registers.size(), std::vector<float>(4 * kPixels));
  for (std::size_t r = 0; r < registers.size(); ++r)
    for (std::size_t n = 0; n < 4 * kPixels; ++n)  // beyond -1..1 too: the clamp is part of it
      values[r][n] = r < kMostSamplers ? static_cast<float>(2.4 * randomUnit(seed, r << 32 | n) - 1.2)
                                       : kPlain[static_cast<glm::length_t>(n % 4)];
  std::vector<gpu::Texture> textures;
  std::vector<std::string> names;
  for (std::size_t r = 0; r < std::min(registers.size(), kMostSamplers); ++r) {
    textures.push_back(
        std::move(*device.texture2d(Format::Rgba32F, kSide, kSide, std::as_bytes(std::span(values[r])))));
    names.push_back("input" + std::to_string(r));
  }
  gpu::Draw draw;
  draw.program = program->get(), draw.vertices = &*vertices, draw.count = 3;
  for (std::size_t r = 0; r < textures.size(); ++r) draw.textures.push_back({names[r].c_str(), &textures[r]});
  std::vector<float> got(4 * kPixels);
  const Result<void> drawn = device.draw(*target, std::span(&draw, 1));
  EXPECT_TRUE(drawn.ok()) << c.name;
  EXPECT_TRUE(device.read(*target, 0, got).ok());

  double worst = 0;
  for (std::size_t p = 0; p < kPixels; ++p) {
    Registers in{};
    for (std::size_t r = 0; r < registers.size(); ++r)
      for (glm::length_t k = 0; k < 4; ++k)
        in[placeOf(registers[r])][k] = values[r][4 * p + static_cast<std::size_t>(k)];
    const glm::dvec4 want = combine(c, in);
    for (glm::length_t k = 0; k < 4; ++k) {
      const double d = std::abs(got[4 * p + static_cast<std::size_t>(k)] - want[k]);
      worst = d <= worst ? worst : std::isnan(d) ? 9 : d;
    }
  }
  return worst;
}

TEST(CombinerGlsl, EveryShippedCombinerEqualsItsValuesInDouble) {
  VERNIER_NEEDS_GL(device);
  const std::vector<std::string> names = combinerNames(test::shippedFolder());
  EXPECT_GE(names.size(), 7u);
  for (const std::string& name : names) EXPECT_LE(difference(*device, shipped(name), 1), 1e-5) << name;
}

// A combiner of all that there is, by chance: valid by construction, since everything is filled.
Combiner random(std::uint64_t seed) {
  std::uint64_t at = 0;
  const auto pick = [&](std::size_t n) {
    return static_cast<std::size_t>(randomUnit(seed, at++) * static_cast<double>(n));
  };
  const std::array<Register, 9> from{Register::Zero,      Register::Primary,   Register::Secondary,
                                     Register::Constant0, Register::Constant1, Register::Spare0,
                                     Register::Spare1,    Register::Texture0,  textureRegister(2)};
  const std::array<Register, 4> to{Register::Spare0, Register::Spare1, Register::Primary, textureRegister(1)};
  const auto operand = [&](bool alpha, std::size_t mappings) {
    Operand o;
    o.from = from[pick(from.size())];
    o.part = pick(2) ? Part::Alpha : alpha ? Part::Blue : Part::Rgb;
    o.mapping = static_cast<Mapping>(pick(mappings));
    return o;
  };
  Combiner c;
  c.name = "random" + std::to_string(seed);
  for (std::size_t n = 1 + pick(3); n > 0; --n) {
    Stage s;
    for (const bool alpha : {false, true}) {
      Portion p;
      for (Operand& o : p.in) o = operand(alpha, 5);
      const std::size_t first = pick(4);
      p.ab = to[first];
      if (pick(2)) p.cd = to[(first + 1) % 4];
      p.abIsDot = !alpha && pick(3) == 0;
      p.cdIsDot = !alpha && pick(3) == 0;
      if (!p.abIsDot && !p.cdIsDot && pick(2)) p.sum = to[(first + 2) % 4];
      p.scale = std::array<double, 4>{0.5, 1, 2, 4}[pick(4)];
      p.bias = pick(2) ? -0.5 : 0;
      (alpha ? s.alpha : s.rgb) = p;
    }
    c.stages.push_back(s);
  }
  for (std::size_t n = 0; n < 6; ++n) c.final.in[n] = operand(false, 2);
  c.final.in[6] = operand(true, 2);
  if (pick(2)) c.final.in[pick(4)] = {Register::Product, Part::Rgb, Mapping::Unsigned};
  return c;
}

TEST(CombinerGlsl, CombinersMadeAtRandomEqualTheirValuesInDouble) {
  VERNIER_NEEDS_GL(device);
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Combiner c = random(seed);
    EXPECT_LE(difference(*device, c, seed), 1e-5) << combinerGlsl(c);
  }
}

TEST(CombinerGlsl, EightStagesAndEightTexturesCompile) {
  VERNIER_NEEDS_GL(device);
  Combiner c;
  c.name = "most";
  for (std::size_t n = 0; n < kMostStages; ++n) {
    Portion p;
    p.in[0] = {textureRegister(n), Part::Rgb, Mapping::Signed};
    p.in[1].mapping = p.in[3].mapping = Mapping::Inverted;  // one
    p.in[2] = {n ? Register::Spare0 : Register::Primary, Part::Rgb, Mapping::Signed};
    p.sum = Register::Spare0;
    p.scale = 0.5;
    c.stages.push_back({p, {}});
  }
  c.final.in[3].from = Register::Spare0;
  c.final.in[6] = {Register::Primary, Part::Alpha, Mapping::Unsigned};
  EXPECT_EQ(textureCount(c), kMostTextures);
  EXPECT_LE(difference(*device, c, 3), 1e-5);
}

TEST(CombinerGlsl, DigestTellsCombinersOfOneNameApart) {
  Combiner a = shipped("iso"), b = a;
  EXPECT_EQ(combinerDigest(a), combinerDigest(b));
  b.stages[1].rgb->in[0].mapping = Mapping::Expand;
  EXPECT_NE(combinerDigest(a), combinerDigest(b));
  a = shipped("shaded-global");  // the same function, another name
  EXPECT_NE(combinerDigest(a), combinerDigest(shipped("iso")));
  EXPECT_EQ(combinerGlsl(a), combinerGlsl(shipped("iso")));
}

}  // namespace
}  // namespace vernier::dvr
