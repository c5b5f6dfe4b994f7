// SPDX-License-Identifier: GPL-3.0-or-later
// "stages" and "final" of a combiner file.
#include <algorithm>

#include "CombinerNames.h"
#include "CombinerParts.h"

namespace vernier::dvr {
namespace {

enum class Where { Rgb, Alpha, FinalRgb, FinalFactor, FinalAlpha };
constexpr const char* kLetters[] = {"A", "B", "C", "D", "E", "F", "G"};

bool isFinal(Where w) { return w != Where::Rgb && w != Where::Alpha; }
bool isAlpha(Where w) { return w == Where::Alpha || w == Where::FinalAlpha; }

Register registerOf(const std::string& name, const Place& at) {
  for (std::size_t n = 0; n < kRegisters; ++n)
    if (nameOf(static_cast<Register>(n)) == name) return static_cast<Register>(n);
  at.fault("'" + name + "' is no register; there are texture0 to texture" +
           std::to_string(kMostTextures - 1) +
           ", primary, secondary, constant0, constant1, spare0, spare1, zero and one.");
}

Mapping mappingOf(const std::string& word, const Place& at, Where where) {
  std::string known;
  for (const auto& w : kMappingWords) {
    if (isFinal(where) && w.value != Mapping::Unsigned && w.value != Mapping::Inverted) continue;
    if (word == w.text) return w.value;
    known += (known.empty() ? "" : ", ") + std::string(w.text);
  }
  for (const auto& w : kMappingWords)
    if (word == w.text)
      at.fault("The final stage does not know the mapping '" + word + "'; it has " + known + ".");
  at.fault("'" + word + "' is no mapping; there are " + known + ".");
}

Part partOf(const std::string& word, const Place& at, Where where) {
  for (const auto& w : kPartWords) {
    if (word != w.text) continue;
    if (isAlpha(where) && w.value == Part::Rgb)
      at.fault("The alpha portion has one channel: it reads alpha or blue, not rgb.");
    if (!isAlpha(where) && w.value == Part::Blue)
      at.fault("The RGB portion reads rgb or alpha; blue is for the alpha portion.");
    return w.value;
  }
  at.fault("'" + word + "' is no part of a register; there are rgb, alpha and blue.");
}

// "inverted constant0.alpha": [mapping] register[.part].
Operand readOperand(const Place& at, Where where) {
  std::string text = at.text();
  Operand o;
  o.part = isAlpha(where) ? Part::Alpha : Part::Rgb;
  if (const std::size_t space = text.find(' '); space != std::string::npos) {
    o.mapping = mappingOf(text.substr(0, space), at, where);
    text = text.substr(space + 1);
  }
  if (text == "one") {
    if (o.mapping != Mapping::Unsigned) at.fault("'one' takes no mapping; there is 'zero' as well.");
    o.mapping = Mapping::Inverted;
    return o;
  }
  const std::size_t dot = text.find('.');
  o.from = registerOf(text.substr(0, dot), at);
  if (o.from == Register::Product) {
    if (where != Where::FinalRgb) at.fault("E*F is for A, B, C and D of the final stage.");
    if (dot != std::string::npos || o.mapping != Mapping::Unsigned)
      at.fault("E*F has neither parts nor mappings.");
  }
  if (dot != std::string::npos) o.part = partOf(text.substr(dot + 1), at, where);
  return o;
}

Register readOutput(const Place& at) {
  const std::string name = at.text();
  if (name.find_first_of(". ") != std::string::npos)
    at.fault("An output goes to a register, which is named without part and mapping.");
  const Register r = registerOf(name == "one" ? "zero" : name, at);
  if (r == Register::Zero || r == Register::Product || r == Register::Constant0 || r == Register::Constant1)
    at.fault("'" + name + "' cannot be written; textures, primary, secondary and the spares can.");
  return r;
}

double oneOf(const Place& at, std::initializer_list<double> allowed, const char* sentence) {
  const double x = at.number();
  if (std::find(allowed.begin(), allowed.end(), x) == allowed.end()) at.fault(sentence);
  return x;
}

// The operands of a product are both there when it is used, and neither when it is not.
void checkProduct(const Place& place, const char* const* letters, bool used) {
  for (int n = 0; n < 2; ++n) {
    if (used && !place.has(letters[n]))
      place.fault(std::string("An output needs ") + letters[n] + ", which is missing.");
    if (!used && place.has(letters[n]))
      place.at(letters[n]).fault(std::string(letters[n]) + " is in no output of this portion.");
  }
}

Portion readPortion(const Place& place, bool rgb) {
  refuseOtherKeys(place, {"A", "B", "C", "D", "AB", "CD", "A.B", "C.D", "AB+CD", "scale", "bias"});
  Portion p;
  for (std::size_t n = 0; n < 4; ++n)
    if (place.has(kLetters[n])) p.in[n] = readOperand(place.at(kLetters[n]), rgb ? Where::Rgb : Where::Alpha);
  for (const char* dot : {"A.B", "C.D"})
    if (place.has(dot) && !rgb)
      place.at(dot).fault("A dot product is of the RGB portion; the alpha portion reads its result as blue.");
  const auto product = [&](const char* plain, const char* dot, std::optional<Register>& to, bool& isDot) {
    if (place.has(plain) && place.has(dot))
      place.at(dot).fault(std::string("A portion has ") + plain + " or " + dot + ", not both.");
    isDot = place.has(dot);
    if (isDot || place.has(plain)) to = readOutput(place.at(isDot ? dot : plain));
  };
  product("AB", "A.B", p.ab, p.abIsDot);
  product("CD", "C.D", p.cd, p.cdIsDot);
  if (place.has("AB+CD")) p.sum = readOutput(place.at("AB+CD"));
  if (p.sum && (p.abIsDot || p.cdIsDot)) place.at("AB+CD").fault("With a dot product there is no sum.");
  if (!p.ab && !p.cd && !p.sum) place.fault("The portion has no output: AB, CD, AB+CD, A.B or C.D.");
  if ((p.ab && (p.ab == p.cd || p.ab == p.sum)) || (p.cd && p.cd == p.sum))
    place.fault("Two outputs of one portion go to the same register.");
  checkProduct(place, kLetters, p.ab || p.sum);
  checkProduct(place, kLetters + 2, p.cd || p.sum);
  if (place.has("scale")) p.scale = oneOf(place.at("scale"), {0.5, 1, 2, 4}, "A scale is 0.5, 1, 2 or 4.");
  if (place.has("bias")) p.bias = oneOf(place.at("bias"), {0, -0.5}, "A bias is 0 or -0.5.");
  return p;
}

// What holds a value so far: [register][0 rgb, 1 alpha].
using Filled = std::array<std::array<bool, 2>, kRegisters>;

bool writes(const Stage& s, const Operand& o) {
  const std::optional<Portion>& p = o.part == Part::Alpha ? s.alpha : s.rgb;
  return p && (p->ab == o.from || p->cd == o.from || p->sum == o.from);
}

void checkRead(const Combiner& c, const Filled& filled, const Operand& o, std::size_t stage,
               const std::string& where) {
  if (o.from == Register::Zero || o.from == Register::Product) return;
  if (filled[placeOf(o.from)][o.part == Part::Alpha ? 1 : 0]) return;
  const std::string what = nameOf(o.from) + (o.part == Part::Alpha ? ".alpha" : ".rgb");
  for (std::size_t n = stage; n < c.stages.size(); ++n)
    if (writes(c.stages[n], o))
      throw CombinerFault{what + " is read before it holds anything; stage " + std::to_string(n) +
                              " writes it, and stages run in order, each reading what was before it.",
                          where};
  throw CombinerFault{
      what + " is read, but " +
          (isSpare(o.from) ? "no stage writes it." : "neither 'inputs' nor a stage before fills it."),
      where};
}

}  // namespace

void refuseOtherKeys(const Place& object, std::initializer_list<const char*> known) {
  std::string list;
  for (const char* k : known) list += (list.empty() ? "" : ", ") + std::string(k);
  for (const auto& [key, value] : object.object().value.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      object.at(key).fault("The key '" + key + "' is not known here; there are " + list + ".");
}

std::vector<Stage> readStages(const Place& place) {
  const std::size_t count = place.list().value.size();
  if (count < 1 || count > kMostStages)
    place.fault("There are " + std::to_string(count) + " stages; a combiner has 1 to " +
                std::to_string(kMostStages) + ".");
  std::vector<Stage> stages;
  for (std::size_t n = 0; n < count; ++n) {
    const Place at = place.at(n);
    refuseOtherKeys(at, {"rgb", "alpha"});
    Stage s;
    if (at.has("rgb")) s.rgb = readPortion(at.at("rgb"), true);
    if (at.has("alpha")) s.alpha = readPortion(at.at("alpha"), false);
    if (!s.rgb && !s.alpha) at.fault("The stage has no output: neither an rgb nor an alpha portion.");
    stages.push_back(s);
  }
  return stages;
}

FinalStage readFinal(const Place& place) {
  refuseOtherKeys(place, {"A", "B", "C", "D", "E", "F", "G"});
  FinalStage f;
  bool colour = false, product = false;
  for (std::size_t n = 0; n < 7; ++n) {
    if (!place.has(kLetters[n])) continue;
    f.in[n] = readOperand(place.at(kLetters[n]), n < 4   ? Where::FinalRgb
                                                 : n < 6 ? Where::FinalFactor
                                                         : Where::FinalAlpha);
    colour = colour || n < 4;
    product = product || f.in[n].from == Register::Product;
  }
  if (!colour) place.fault("The colour is missing: none of A, B, C and D stands here.");
  if (!place.has("G")) place.fault("The alpha is missing: G says what it is.");
  checkProduct(place, kLetters + 4, product);
  return f;
}

void checkFlow(const Combiner& c, const std::string& stages, const std::string& final) {
  Filled filled{};
  for (const Input& in : c.inputs) {
    auto& parts = filled[placeOf(in.to)];
    parts[0] = parts[0] || in.rgb, parts[1] = parts[1] || in.alpha;
  }
  for (std::size_t n = 0; n < c.stages.size(); ++n) {
    const Stage& s = c.stages[n];
    const auto at = [&](const char* portion, std::size_t k) {
      return stages + "/" + std::to_string(n) + "/" + portion + "/" + kLetters[k];
    };
    for (std::size_t k = 0; k < 4; ++k) {
      if (s.rgb) checkRead(c, filled, s.rgb->in[k], n, at("rgb", k));
      if (s.alpha) checkRead(c, filled, s.alpha->in[k], n, at("alpha", k));
    }
    for (std::size_t part = 0; part < 2; ++part) {
      const std::optional<Portion>& p = part ? s.alpha : s.rgb;
      if (!p) continue;
      for (const std::optional<Register>& to : {p->ab, p->cd, p->sum})
        if (to) filled[placeOf(*to)][part] = true;
    }
  }
  for (std::size_t k = 0; k < 7; ++k)
    checkRead(c, filled, c.final.in[k], c.stages.size(), final + "/" + kLetters[k]);
}

}  // namespace vernier::dvr
