// SPDX-License-Identifier: GPL-3.0-or-later
// "inputs" of a combiner file: {"texture0": "colour[0]", "constant0.alpha": "interpolation", ...}.
#include <charconv>

#include "CombinerNames.h"
#include "CombinerParts.h"
#include "vernier/plan/Scene.h"

namespace vernier::dvr {
namespace {

// "constant0.alpha" into the register and the parts that are filled.
Input targetOf(const std::string& key, const Place& at) {
  const std::size_t dot = key.find('.');
  const std::string name = key.substr(0, dot);
  const std::string part = dot == std::string::npos ? "" : key.substr(dot + 1);
  Input in;
  for (std::size_t n = 0; n < kRegisters; ++n) {
    const auto r = static_cast<Register>(n);
    if (r != Register::Zero && r != Register::Product && !isSpare(r) && nameOf(r) == name) in.to = r;
  }
  if (in.to == Register::Zero)
    at.fault("'" + name + "' is no register that can be filled; there are texture0 to texture" +
             std::to_string(kMostTextures - 1) + ", primary, secondary, constant0 and constant1.");
  if (!part.empty() && part != "rgb" && part != "alpha")
    at.fault("'" + part + "' is no part of a register; there are rgb and alpha.");
  in.rgb = part != "alpha", in.alpha = part != "rgb";
  return in;
}

std::string knownQuantities() {
  std::string known;
  for (const QuantityWord& w : kQuantityWords)
    known += (known.empty() ? "" : ", ") + std::string(w.text) + (w.index == IndexOf::None ? "" : "[n]");
  return known;
}

// "light-direction[1]" into the quantity's row and 1; without brackets: 0.
const QuantityWord& quantityOf(const std::string& text, const Place& at, std::size_t& index) {
  const std::size_t open = text.find('[');
  index = 0;
  for (const QuantityWord& w : kQuantityWords) {
    if (text.substr(0, open) != w.text) continue;
    if (open == std::string::npos) return w;
    if (w.index == IndexOf::None) at.fault("'" + std::string(w.text) + "' takes no number in brackets.");
    const char* const end = text.data() + text.size() - 1;
    const auto [stop, error] = std::from_chars(text.data() + open + 1, end, index);
    const std::size_t most = w.index == IndexOf::Slice ? kMostTextures : kMostLights;
    if (*end != ']' || stop != end || error != std::errc() || index >= most)
      at.fault("In brackets stands the number of a " +
               std::string(w.index == IndexOf::Slice ? "slice" : "light") + ", 0 to " +
               std::to_string(most - 1) + ".");
    return w;
  }
  at.fault("'" + text + "' is no quantity; there are " + knownQuantities() + ", or numbers.");
}

void readQuantity(const Place& at, Input& in) {
  const QuantityWord& w = quantityOf(at.text(), at, in.index);
  in.what = w.value;
  if (w.inTexture != isTexture(in.to))
    at.fault("'" + std::string(w.text) + "' " +
             (w.inTexture ? "lies in a texture" : "is a colour or a constant, not a texture") + ", but " +
             nameOf(in.to) + " is named here.");
  if (w.both ? !(in.rgb && in.alpha) : in.rgb && in.alpha)
    at.fault("'" + std::string(w.text) + "' fills " +
             (w.both ? "a whole register: write '" + nameOf(in.to) + "'."
                     : "one part: write '" + nameOf(in.to) + (w.rgb ? ".rgb" : ".alpha") + "'."));
  if ((in.rgb && !w.rgb) || (in.alpha && !w.alpha))
    at.fault("'" + std::string(w.text) + "' has no " + (in.rgb ? "rgb" : "alpha") + " part.");
}

void readGiven(const Place& at, Input& in) {
  const std::size_t count = (in.rgb ? 3 : 0) + (in.alpha ? 1 : 0);
  const auto one = [&](const Place& p) {
    const double x = p.number();
    if (!(x >= -1 && x <= 1)) p.fault("A register holds -1 to 1.");
    return x;
  };
  if (isTexture(in.to)) at.fault("A texture cannot be filled with numbers; use a constant.");
  if (at.value.is_number() && count == 1) {
    in.given.w = one(at);
    return;
  }
  if (at.list().value.size() != count || count == 1)
    at.fault(count == 1 ? "One number is expected here."
                        : "A list of " + std::to_string(count) + " numbers is expected here.");
  for (std::size_t n = 0; n < count; ++n) in.given[static_cast<glm::length_t>(n)] = one(at.at(n));
}

}  // namespace

std::vector<Input> readInputs(const Place& place) {
  std::vector<Input> inputs;
  for (const auto& [key, value] : place.object().value.items()) {
    const Place at = place.at(key);
    Input in = targetOf(key, at);
    if (value.is_string())
      readQuantity(at, in);
    else if (value.is_array() || value.is_number())
      readGiven(at, in);
    else
      at.fault("A quantity or numbers are expected here.");
    for (const Input& other : inputs)
      if (other.to == in.to && ((other.rgb && in.rgb) || (other.alpha && in.alpha)))
        at.fault(nameOf(in.to) + " is filled twice; keep one.");
    inputs.push_back(in);
  }
  return inputs;
}

}  // namespace vernier::dvr
