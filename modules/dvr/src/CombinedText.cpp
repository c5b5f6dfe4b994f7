// SPDX-License-Identifier: GPL-3.0-or-later
#include "CombinedText.h"

#include <algorithm>
#include <cstdio>

namespace vernier::dvr {
namespace {

std::string literal(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", v);
  std::string s = text;
  return s.find_first_of(".e") == std::string::npos ? s + ".0" : s;
}

// The texel of slice n in the order of drawing, or of the texture n between which the slice lies.
std::string texel(const Combiner& c, std::size_t n) {
  const std::string i = std::to_string(n), count = std::to_string(slicesPerPolygon(c));
  if (uses(c, Quantity::Interpolation)) return "texels[" + i + "]";
  return "texels[ascends ? " + count + " - 1 - " + i + " : " + i + "]";
}

std::string valueOf(const Combiner& c, const Input& in) {
  const std::string t = texel(c, in.index), light = std::to_string(in.index);
  switch (in.what) {
    case Quantity::Colour:
      return "colourOf(" + t + ")";
    case Quantity::WeightedColour:
      return "weightedOf(" + t + ")";
    case Quantity::NormalValue:
      return "vec4(" + t + ".mean.rgb, valueOf(" + t + "))";
    case Quantity::NormalOpacity:
      return "vec4(" + t + ".mean.rgb, colourOf(" + t + ").a)";
    case Quantity::Normal:
      return "vec4(" + t + ".mean.rgb, 0.0)";
    case Quantity::Interpolation:
      return "vec4(alphas[0])";
    case Quantity::LightDirection:
      return "vec4(lightDirection(" + light + "), 0.0)";
    case Quantity::Diffuse:
      return "vec4(material.y * diffuseColour * lightColours[" + light + "].rgb, 0.0)";
    case Quantity::OwnDiffuse:
      return "vec4(material.y * lightColours[" + light + "].rgb, 0.0)";
    case Quantity::Ambient:
      return "vec4(material.x * ambientColour, 0.0)";
    case Quantity::AmbientStrength:
      return "vec4(material.x)";
    case Quantity::Given:
      break;
  }
  return "vec4(" + literal(in.given.x) + ", " + literal(in.given.y) + ", " + literal(in.given.z) + ", " +
         literal(in.given.w) + ")";
}

std::string nameOf(Register r) {
  if (r >= Register::Texture0) return "t" + std::to_string(placeOf(r) - placeOf(Register::Texture0));
  return r == Register::Primary     ? "primary"
         : r == Register::Secondary ? "secondary"
         : r == Register::Constant0 ? "constant0"
                                    : "constant1";
}

}  // namespace

std::size_t slicesPerPolygon(const Combiner& c) {
  return uses(c, Quantity::Interpolation) ? 1 : std::max<std::size_t>(1, sliceCount(c));
}

bool needsNormals(const Combiner& c) {
  return uses(c, Quantity::NormalValue) || uses(c, Quantity::NormalOpacity) || uses(c, Quantity::Normal);
}

bool needsColours(const Combiner& c) {
  return uses(c, Quantity::Colour) || uses(c, Quantity::WeightedColour) || uses(c, Quantity::NormalOpacity);
}

std::string combinedDefines(const Combiner& c) {
  const bool between = uses(c, Quantity::Interpolation);
  const std::size_t slices = slicesPerPolygon(c), texels = between ? 2 : slices;
  std::string d, reads, fill, registers;
  for (std::size_t n = 0; n < slices; ++n) {
    const std::string i = std::to_string(n);
    d += "uniform sampler2D lower" + i + ";\nuniform sampler2D upper" + i + ";\n";
    if (!between)
      reads += "texels[" + i + "] = texelOf(lower" + i + ", upper" + i + ", alphas[" + i + "], " + i +
               ", start, along, box); ";
  }
  if (between)
    reads =
        "texels[0] = texelOf(lower0, lower0, 0.0, 0, start, along, box); "
        "texels[1] = texelOf(upper0, upper0, 0.0, 0, start, along, box);";
  std::vector<Register> all;
  for (std::size_t n = 0; n < textureCount(c); ++n) all.push_back(textureRegister(n));
  all.insert(all.end(), {Register::Primary, Register::Secondary, Register::Constant0, Register::Constant1});
  for (const Register r : all) {
    fill += "vec4 " + nameOf(r) + " = vec4(0.0); ";
    registers += (registers.empty() ? "" : ", ") + nameOf(r);
  }
  for (const Input& in : c.inputs) {
    const std::string value = "clamp(" + valueOf(c, in) + ", -1.0, 1.0)";
    if (in.rgb) fill += nameOf(in.to) + ".rgb = " + value + ".rgb; ";
    if (in.alpha) fill += nameOf(in.to) + ".a = " + value + ".a; ";
  }
  d += "#define TEXELS " + std::to_string(texels) + "\n#define READ_TEXELS " + reads + "\n";
  d += "#define FILL_REGISTERS " + fill + "\n#define REGISTERS " + registers + "\n";
  const int blend = c.blend == Blending::Off        ? 0
                    : c.blend == Blending::Over     ? 1
                    : c.blend == Blending::Weighted ? 2
                                                    : 3;
  d += "#define BLEND " + std::to_string(blend) + "\n";
  if (c.test == FragmentTest::Level) d += "#define LEVEL\n";
  return d + combinerGlsl(c, "combine");
}

}  // namespace vernier::dvr
