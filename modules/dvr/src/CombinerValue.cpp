// SPDX-License-Identifier: GPL-3.0-or-later
// Combiners evaluated in double. CombinerGlsl.cpp says the same in GLSL, line by line.
#include "Combiner.h"

namespace vernier::dvr {
namespace {

glm::dvec3 mapped(Mapping m, const glm::dvec3& x) {
  switch (m) {
    case Mapping::Unsigned:
      return glm::max(x, 0.0);
    case Mapping::Inverted:
      return 1.0 - glm::max(x, 0.0);
    case Mapping::Expand:
      return 2.0 * glm::max(x, 0.0) - 1.0;
    case Mapping::Signed:
      return x;
    case Mapping::Negate:
      return -x;
  }
  return x;
}

// All three channels alike where the part is one channel.
glm::dvec3 read(const Registers& r, const Operand& o) {
  const glm::dvec4& x = r[placeOf(o.from)];
  return mapped(o.mapping, o.part == Part::Rgb     ? glm::dvec3(x)
                           : o.part == Part::Alpha ? glm::dvec3(x.w)
                                                   : glm::dvec3(x.z));
}

void run(const Portion& p, const Registers& before, Registers& after, bool rgb) {
  std::array<glm::dvec3, 4> v;
  for (std::size_t n = 0; n < 4; ++n) v[n] = read(before, p.in[n]);
  const glm::dvec3 ab = p.abIsDot ? glm::dvec3(glm::dot(v[0], v[1])) : v[0] * v[1];
  const glm::dvec3 cd = p.cdIsDot ? glm::dvec3(glm::dot(v[2], v[3])) : v[2] * v[3];
  const auto write = [&](const std::optional<Register>& to, const glm::dvec3& x) {
    if (!to) return;
    const glm::dvec3 y = glm::clamp((x + p.bias) * p.scale, -1.0, 1.0);
    glm::dvec4& out = after[placeOf(*to)];
    out = rgb ? glm::dvec4(y, out.w) : glm::dvec4(glm::dvec3(out), y.x);
  };
  write(p.ab, ab);
  write(p.cd, cd);
  write(p.sum, ab + cd);
}

}  // namespace

Registers filledRegisters(const Combiner& c, const std::function<glm::dvec4(const Input&)>& valueOf) {
  Registers out{};
  for (const Input& in : c.inputs) {
    const glm::dvec4 x = in.what == Quantity::Given ? in.given : valueOf(in);
    glm::dvec4& to = out[placeOf(in.to)];
    if (in.rgb) to = glm::dvec4(glm::dvec3(x), to.w);
    if (in.alpha) to.w = x.w;
  }
  return out;
}

glm::dvec4 combine(const Combiner& c, const Registers& given) {
  Registers r;
  for (std::size_t n = 0; n < kRegisters; ++n) r[n] = glm::clamp(given[n], -1.0, 1.0);
  for (const Register unset : {Register::Zero, Register::Product, Register::Spare0, Register::Spare1})
    r[placeOf(unset)] = glm::dvec4(0);
  for (const Stage& s : c.stages) {
    const Registers before = r;
    if (s.rgb) run(*s.rgb, before, r, true);
    if (s.alpha) run(*s.alpha, before, r, false);
  }
  const auto& in = c.final.in;
  r[placeOf(Register::Product)] = glm::dvec4(read(r, in[4]) * read(r, in[5]), 0);
  const glm::dvec3 a = read(r, in[0]), b = read(r, in[1]), x = read(r, in[2]), d = read(r, in[3]);
  return {glm::min(a * b + (1.0 - a) * x + d, 1.0), read(r, in[6]).x};
}

}  // namespace vernier::dvr
