// SPDX-License-Identifier: GPL-3.0-or-later
// Combiner: how the texels and colours of one fragment become its colour, as data. The machine is that of
// NV_register_combiners (Rezk-Salama 2000, section 3, figures 1 to 3) without its limits of 2 textures, 2
// stages and 9 bits: general stages one after the other, then the final one. docs/combiners.md has the
// format, the registers and the flow.
//
// Numbers. Registers hold -1..1; what is put in is clamped to that. A stage reads all operands through their
// mappings, then computes, adds the bias, multiplies by the scale, clamps to -1..1 and writes, all at once:
// both portions see the registers as they were before the stage. Final: every operand is clamped to 0..1,
// rgb = min(1, A B + (1 - A) C + D), alpha = G. Registers are finite; there is no NaN.
//
// Pure functions in double; safe on any thread.
#pragma once
#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier::dvr {

inline constexpr std::size_t kMostStages = 8, kMostTextures = 8;

// Texture0 + n is texture n. Product is E F, of the final stage only.
enum class Register { Zero, Product, Primary, Secondary, Constant0, Constant1, Spare0, Spare1, Texture0 };
inline constexpr std::size_t kRegisters = static_cast<std::size_t>(Register::Texture0) + kMostTextures;
// Values of all registers; Zero, Product and the spares of what a caller gives are not looked at.
using Registers = std::array<glm::dvec4, kRegisters>;
inline constexpr std::size_t placeOf(Register r, std::size_t n = 0) {
  return static_cast<std::size_t>(r) + n;
}
inline constexpr Register textureRegister(std::size_t n) {
  return static_cast<Register>(placeOf(Register::Texture0, n));
}

// Blue: of an alpha portion and of G, which take a dot product's result that way.
enum class Part { Rgb, Alpha, Blue };
// Of x: Unsigned max(0, x), Inverted 1 - max(0, x), Expand 2 max(0, x) - 1, Signed x, Negate -x.
enum class Mapping { Unsigned, Inverted, Expand, Signed, Negate };
struct Operand {
  Register from = Register::Zero;
  Part part = Part::Rgb;
  Mapping mapping = Mapping::Unsigned;
  friend bool operator==(const Operand&, const Operand&) = default;
};

// Half of a stage. A dot product is of the RGB portion, stands in all three channels, and excludes the sum.
struct Portion {
  std::array<Operand, 4> in;  // A, B, C, D
  std::optional<Register> ab, cd, sum;
  bool abIsDot = false, cdIsDot = false;
  double scale = 1, bias = 0;  // (x + bias) scale
  friend bool operator==(const Portion&, const Portion&) = default;
};
struct Stage {
  std::optional<Portion> rgb, alpha;
  friend bool operator==(const Stage&, const Stage&) = default;
};
struct FinalStage {
  std::array<Operand, 7> in;  // A to F: rgb, G: alpha
  friend bool operator==(const FinalStage&, const FinalStage&) = default;
};

// What a technique puts into a register. [n]: of light n of the scene, or of the slice n further than the
// polygon's own, in the order of drawing (back to front).
enum class Quantity {
  Colour,          // [n] rgb: colour, not multiplied by opacity; alpha: opacity of the slice distance
  WeightedColour,  // [n] rgb: colour multiplied by opacity; alpha: opacity of the slice distance
  NormalValue,    // [n] rgb: unit normal, signed; alpha: value, 0..1 over the range that the technique stores
  NormalOpacity,  // [n] rgb: unit normal, signed; alpha: opacity of the slice distance
  Normal,         // [n] rgb: unit normal, signed
  Interpolation,  // alpha: place between slice 0 (0) and slice 1 (1)
  LightDirection,   // [n] rgb: unit vector to the light, signed, in the frame of the normals
  Diffuse,          // [n] rgb: material's diffuse, its diffuse colour and the light's colour multiplied
  OwnDiffuse,       // [n] rgb: material's diffuse and the light's colour, for what has its own colour
  Ambient,          // rgb: material's ambient and its ambient colour
  AmbientStrength,  // rgb or alpha: material's ambient alone
  Given,            // the numbers that stand in the file
};
struct Input {
  Register to = Register::Zero;
  bool rgb = false, alpha = false;  // which parts of the register it fills
  Quantity what = Quantity::Given;
  std::size_t index = 0;
  glm::dvec4 given{0};
  friend bool operator==(const Input&, const Input&) = default;
};

// How the fragment (C, A) meets the picture (D).
//   Off: C. Over: C A + D (1 - A). Weighted: C + D (1 - A). Transmission: C + D A (equations 4 and 5: A is
//   what is let through).
enum class Blending { Off, Over, Weighted, Transmission };
// Level: fragments whose alpha is below the iso-surface's level are dropped, the others write depth.
enum class FragmentTest { None, Level };

struct Combiner {
  std::string name, title, source;
  std::vector<Input> inputs;
  std::vector<Stage> stages;
  FinalStage final;
  Blending blend = Blending::Over;
  FragmentTest test = FragmentTest::None;
  friend bool operator==(const Combiner&, const Combiner&) = default;
};

// Textures 0 to n - 1 are read, written or filled.
std::size_t textureCount(const Combiner&);
// How many slices its textures hold, how many lights its registers; 0: none.
std::size_t sliceCount(const Combiner&);
std::size_t lightCount(const Combiner&);
bool uses(const Combiner&, Quantity);

// The text of one file, whose name without .json is `name`. `base` gives the text of another file by its
// name, for the key "base"; without it that key is refused. SceneInvalid with the sentence, `where` the file
// and the place in it ("iso.json#/stages/0/rgb/A"): bad JSON, unknown keys, registers, mappings or
// quantities, parts that a portion does not have, a register that is read before anything fills it, too many
// stages or textures, missing outputs, files that are based on each other in a circle.
using BaseText = std::function<Result<std::string>(const std::string& name)>;
Result<Combiner> parseCombiner(std::string_view json, const std::string& name, const BaseText& base = {});

// The registers as the inputs say: numbers that the file gives, and what `valueOf` says of every other input;
// of its answer the parts count that the input fills. The rest is 0.
Registers filledRegisters(const Combiner&, const std::function<glm::dvec4(const Input&)>& valueOf);

// What the fragment's colour and alpha are, 0..1.
glm::dvec4 combine(const Combiner&, const Registers&);

// The same as GLSL 3.30: a function
//   vec4 FUNCTION(vec4 texture0, ..., vec4 texture<textureCount - 1>, vec4 primary, vec4 secondary,
//                 vec4 constant0, vec4 constant1)
// that needs nothing outside of itself. What the inputs say, numbers of the file too, is the caller's to
// pass.
std::string combinerGlsl(const Combiner&, const std::string& function = "combine");
// Names the program that is made of it: two combiners of one name but different text differ here.
std::string combinerDigest(const Combiner&);

// CombinerFiles.cpp: the files NAME.json of the folders, looked through in order; the first that has the name
// wins. By default: `combiners` beside the plugin (of a program that holds this module itself: under
// ../lib/vernier/plugins/dvr), then the user's $XDG_CONFIG_HOME/vernier/combiners.
std::vector<std::string> combinerFolders();
std::vector<std::string> combinerNames(const std::vector<std::string>& folders = combinerFolders());
// SceneInvalid: an unknown name (the sentence has the known ones), or as parseCombiner. Reads the file anew
// each time.
Result<Combiner> findCombiner(const std::string& name,
                              const std::vector<std::string>& folders = combinerFolders());

}  // namespace vernier::dvr
