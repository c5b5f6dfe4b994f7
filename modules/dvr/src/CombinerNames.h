// SPDX-License-Identifier: GPL-3.0-or-later
// The words of combiner files.
#pragma once
#include <string>

#include "Combiner.h"

namespace vernier::dvr {

template <class E>
struct Word {
  E value;
  const char* text;
};

// What a quantity may fill: parts, textures or plain registers, and whether [n] follows its name.
enum class IndexOf { None, Slice, Light };
struct QuantityWord {
  Quantity value;
  const char* text;
  IndexOf index;
  bool inTexture;   // else in primary, secondary and constants
  bool rgb, alpha;  // which parts it has
  bool both;        // a register of it is filled as a whole: neither .rgb nor .alpha stands in its key
};

inline constexpr Word<Register> kRegisterWords[] = {
    {Register::Zero, "zero"},           {Register::Product, "E*F"},
    {Register::Primary, "primary"},     {Register::Secondary, "secondary"},
    {Register::Constant0, "constant0"}, {Register::Constant1, "constant1"},
    {Register::Spare0, "spare0"},       {Register::Spare1, "spare1"}};
inline constexpr Word<Mapping> kMappingWords[] = {{Mapping::Unsigned, "unsigned"},
                                                  {Mapping::Inverted, "inverted"},
                                                  {Mapping::Expand, "expand"},
                                                  {Mapping::Signed, "signed"},
                                                  {Mapping::Negate, "negate"}};
inline constexpr Word<Part> kPartWords[] = {{Part::Rgb, "rgb"}, {Part::Alpha, "alpha"}, {Part::Blue, "blue"}};
inline constexpr Word<Blending> kBlendWords[] = {{Blending::Off, "off"},
                                                 {Blending::Over, "over"},
                                                 {Blending::Weighted, "weighted"},
                                                 {Blending::Transmission, "transmission"}};
inline constexpr Word<FragmentTest> kTestWords[] = {{FragmentTest::None, "none"},
                                                    {FragmentTest::Level, "level"}};
inline constexpr QuantityWord kQuantityWords[] = {
    {Quantity::Colour, "colour", IndexOf::Slice, true, true, true, true},
    {Quantity::WeightedColour, "weighted-colour", IndexOf::Slice, true, true, true, true},
    {Quantity::NormalValue, "normal-value", IndexOf::Slice, true, true, true, true},
    {Quantity::NormalOpacity, "normal-opacity", IndexOf::Slice, true, true, true, true},
    {Quantity::Normal, "normal", IndexOf::Slice, true, true, false, false},
    {Quantity::Interpolation, "interpolation", IndexOf::None, false, false, true, false},
    {Quantity::LightDirection, "light-direction", IndexOf::Light, false, true, false, false},
    {Quantity::Diffuse, "diffuse", IndexOf::Light, false, true, false, false},
    {Quantity::OwnDiffuse, "own-diffuse", IndexOf::Light, false, true, false, false},
    {Quantity::Ambient, "ambient", IndexOf::None, false, true, false, false},
    {Quantity::AmbientStrength, "ambient-strength", IndexOf::None, false, true, true, false}};

inline std::string nameOf(Register r) {
  if (r >= Register::Texture0) return "texture" + std::to_string(placeOf(r) - placeOf(Register::Texture0));
  for (const auto& w : kRegisterWords)
    if (w.value == r) return w.text;
  return "?";
}
inline bool isSpare(Register r) { return r == Register::Spare0 || r == Register::Spare1; }
inline bool isTexture(Register r) { return r >= Register::Texture0; }

}  // namespace vernier::dvr
