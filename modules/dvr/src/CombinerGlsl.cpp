// SPDX-License-Identifier: GPL-3.0-or-later
// Combiners as GLSL 3.30 text; CombinerValue.cpp is the same in double. The text is made of words of ours and
// of checked enumerations only: nothing that a file says reaches the compiler as it stands.
#include <cstdint>

#include "Combiner.h"
#include "CombinerNames.h"

namespace vernier::dvr {
namespace {

// The value as vec3 or float.
std::string mapped(Mapping m, const std::string& x) {
  switch (m) {
    case Mapping::Unsigned:
      return "max(" + x + ", 0.0)";
    case Mapping::Inverted:
      return "(1.0 - max(" + x + ", 0.0))";
    case Mapping::Expand:
      return "(2.0 * max(" + x + ", 0.0) - 1.0)";
    case Mapping::Signed:
      return x;
    case Mapping::Negate:
      return "(-" + x + ")";
  }
  return x;
}

std::string read(const Operand& o, bool rgb) {
  if (o.from == Register::Product) return "ef";
  if (o.from == Register::Zero) {
    const double x = o.mapping == Mapping::Inverted ? 1 : o.mapping == Mapping::Expand ? -1 : 0;
    return std::string(rgb ? "vec3(" : "(") + (x > 0 ? "1.0" : x < 0 ? "-1.0" : "0.0") + ")";
  }
  const std::string r = nameOf(o.from);
  if (o.part == Part::Rgb) return mapped(o.mapping, r + ".rgb");
  const std::string channel = mapped(o.mapping, r + (o.part == Part::Alpha ? ".a" : ".b"));
  return rgb ? "vec3(" + channel + ")" : channel;
}

std::string scaled(const Portion& p, std::string x) {
  if (p.bias != 0) x = "(" + x + " - 0.5)";
  if (p.scale == 0.5) x += " * 0.5";
  if (p.scale == 2) x += " * 2.0";
  if (p.scale == 4) x += " * 4.0";
  return "clamp(" + x + ", -1.0, 1.0)";
}

// Reads into new names first, writes in `writes`: both portions see the registers as they were.
void portion(const Portion& p, bool rgb, std::string& reads, std::string& writes) {
  const std::string type = rgb ? "    vec3 " : "    float ", suffix = rgb ? "3" : "1";
  const auto product = [&](std::size_t n, bool isDot) {
    const std::string x = read(p.in[n], rgb), y = read(p.in[n + 1], rgb);
    return isDot ? "vec3(dot(" + x + ", " + y + "))" : x + " * " + y;
  };
  if (p.ab || p.sum) reads += type + "ab" + suffix + " = " + product(0, p.abIsDot) + ";\n";
  if (p.cd || p.sum) reads += type + "cd" + suffix + " = " + product(2, p.cdIsDot) + ";\n";
  const auto write = [&](const std::optional<Register>& to, const std::string& x) {
    if (to) writes += "    " + nameOf(*to) + (rgb ? ".rgb = " : ".a = ") + scaled(p, x) + ";\n";
  };
  write(p.ab, "ab" + suffix);
  write(p.cd, "cd" + suffix);
  write(p.sum, "(ab" + suffix + " + cd" + suffix + ")");
}

}  // namespace

std::string combinerGlsl(const Combiner& c, const std::string& function) {
  std::vector<std::string> parameters;
  for (std::size_t n = 0; n < textureCount(c); ++n) parameters.push_back(nameOf(textureRegister(n)));
  for (const Register r : {Register::Primary, Register::Secondary, Register::Constant0, Register::Constant1})
    parameters.push_back(nameOf(r));
  std::string list, text;
  for (const std::string& p : parameters) {
    list += (list.empty() ? "vec4 " : ", vec4 ") + p;
    text += "  " + p + " = clamp(" + p + ", -1.0, 1.0);\n";
  }
  text = "vec4 " + function + "(" + list + ") {\n" + text;
  text += "  vec4 spare0 = vec4(0.0), spare1 = vec4(0.0);\n";
  for (const Stage& s : c.stages) {
    std::string reads, writes;
    if (s.rgb) portion(*s.rgb, true, reads, writes);
    if (s.alpha) portion(*s.alpha, false, reads, writes);
    text += "  {\n" + reads + writes + "  }\n";
  }
  const auto& in = c.final.in;
  text += "  vec3 ef = " + read(in[4], true) + " * " + read(in[5], true) + ";\n";
  text += "  vec3 a = " + read(in[0], true) + ";\n";
  text += "  vec3 rgb = a * " + read(in[1], true) + " + (1.0 - a) * " + read(in[2], true) + " + " +
          read(in[3], true) + ";\n";
  return text + "  return vec4(min(rgb, 1.0), " + read(in[6], false) + ");\n}\n";
}

std::string combinerDigest(const Combiner& c) {
  std::uint64_t h = 1469598103934665603u;  // FNV-1a
  for (const char x : combinerGlsl(c)) h = (h ^ static_cast<unsigned char>(x)) * 1099511628211u;
  std::string hex;
  for (int n = 60; n >= 0; n -= 4) hex += "0123456789abcdef"[(h >> n) & 15];
  return c.name + "-" + hex;
}

}  // namespace vernier::dvr
