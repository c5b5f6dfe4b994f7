// SPDX-License-Identifier: GPL-3.0-or-later
#include "Combiner.h"

#include <algorithm>

#include "CombinerNames.h"
#include "CombinerParts.h"
#include "vernier/base/Guarded.h"

namespace vernier::dvr {
namespace {

template <class E, std::size_t N>
E choiceOf(const Place& at, const Word<E> (&words)[N]) {
  const std::string given = at.text();
  std::string known;
  for (const Word<E>& w : words) {
    if (given == w.text) return w.value;
    known += (known.empty() ? "" : ", ") + std::string(w.text);
  }
  at.fault("'" + given + "' is none of: " + known + ".");
}

bool overlap(const Input& a, const Input& b) {
  return a.to == b.to && ((a.rgb && b.rgb) || (a.alpha && b.alpha));
}

// What a file says itself takes the place of what its base said; inputs one by one.
void addInputs(std::vector<Input>& inputs, const std::vector<Input>& own) {
  std::erase_if(inputs, [&](const Input& old) {
    return std::any_of(own.begin(), own.end(), [&](const Input& i) { return overlap(i, old); });
  });
  inputs.insert(inputs.end(), own.begin(), own.end());
}

Combiner read(std::string_view text, const std::string& name, const BaseText& base,
              std::vector<std::string> trail);

Combiner readBase(const Place& at, const BaseText& base, std::vector<std::string> trail) {
  const std::string name = at.text();
  if (!base) at.fault("A combiner can be based on another only where the others are known.");
  if (std::find(trail.begin(), trail.end(), name) != trail.end()) {
    std::string circle;
    for (const std::string& t : trail) circle += t + ", based on ";
    at.fault("The files are based on each other in a circle: " + circle + name + ".");
  }
  const Result<std::string> text = base(name);
  if (!text) at.fault(text.error().sentence);
  return read(*text, name, base, std::move(trail));
}

Combiner read(std::string_view text, const std::string& name, const BaseText& base,
              std::vector<std::string> trail) {
  const std::string file = name + ".json";
  const nlohmann::json json = parseCombinerJson(text, file);
  const Place top{json, file + "#"};
  refuseOtherKeys(top, {"schema", "title", "source", "base", "inputs", "stages", "final", "blend", "test"});
  for (const char* needed : {"schema", "title"})
    if (!top.has(needed)) top.fault(std::string("The key '") + needed + "' is missing.");
  if (top.at("schema").number() != 1) top.at("schema").fault("Only schema 1 is known.");
  Combiner c;
  trail.push_back(name);
  if (top.has("base")) c = readBase(top.at("base"), base, std::move(trail));
  c.name = name;
  c.title = top.at("title").text();
  if (top.has("source")) c.source = top.at("source").text();
  if (top.has("inputs")) addInputs(c.inputs, readInputs(top.at("inputs")));
  if (top.has("stages")) c.stages = readStages(top.at("stages"));
  if (top.has("final")) c.final = readFinal(top.at("final"));
  if (!top.has("base"))
    for (const char* needed : {"inputs", "stages", "final"})
      if (!top.has(needed)) top.fault(std::string("The key '") + needed + "' is missing.");
  if (top.has("blend")) c.blend = choiceOf(top.at("blend"), kBlendWords);
  if (top.has("test")) c.test = choiceOf(top.at("test"), kTestWords);
  const std::string inherited = file + "#/base";
  checkFlow(c, top.has("stages") ? file + "#/stages" : inherited,
            top.has("final") ? file + "#/final" : inherited);
  return c;
}

template <class Fn>
void forEachRegister(const Combiner& c, Fn&& fn) {
  for (const Input& i : c.inputs) fn(i.to);
  for (const Stage& s : c.stages)
    for (const std::optional<Portion>* p : {&s.rgb, &s.alpha}) {
      if (!*p) continue;
      for (const Operand& o : (*p)->in) fn(o.from);
      for (const std::optional<Register>& to : {(*p)->ab, (*p)->cd, (*p)->sum})
        if (to) fn(*to);
    }
  for (const Operand& o : c.final.in) fn(o.from);
}

std::size_t countOf(const Combiner& c, IndexOf kind) {
  std::size_t most = 0;
  for (const Input& i : c.inputs)
    for (const QuantityWord& w : kQuantityWords)
      if (w.value == i.what && w.index == kind) most = std::max(most, i.index + 1);
  return most;
}

}  // namespace

Result<Combiner> parseCombiner(std::string_view json, const std::string& name, const BaseText& base) {
  if (json.starts_with("\xEF\xBB\xBF")) json.remove_prefix(3);
  return guarded(name, [&]() -> Result<Combiner> {
    try {
      return read(json, name, base, {});
    } catch (const CombinerFault& f) {
      return makeError(ErrorCode::SceneInvalid, f.sentence, f.where);
    }
  });
}

std::size_t textureCount(const Combiner& c) {
  std::size_t count = 0;
  forEachRegister(c, [&](Register r) {
    if (isTexture(r)) count = std::max(count, placeOf(r) - placeOf(Register::Texture0) + 1);
  });
  return count;
}

std::size_t sliceCount(const Combiner& c) { return countOf(c, IndexOf::Slice); }
std::size_t lightCount(const Combiner& c) { return countOf(c, IndexOf::Light); }

bool uses(const Combiner& c, Quantity q) {
  return std::any_of(c.inputs.begin(), c.inputs.end(), [&](const Input& i) { return i.what == q; });
}

}  // namespace vernier::dvr
