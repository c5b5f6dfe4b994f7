// SPDX-License-Identifier: GPL-3.0-or-later
// Scene as JSON (every key: docs/scene.md). Keys are written in a fixed order and numbers
// shortest-round-trip, so writing is canonical: parse(write(s)) == s bit for bit for every scene whose
// numbers are finite and whose text is UTF-8 (a number that is not finite is written as null, which
// parseScene refuses with its path).
//
// SceneInvalid, with the JSON path ("/layers/0/plane/normal") in Error::where: bad syntax, NaN or numbers
// beyond double, unknown or repeated keys inside what this build knows, missing keys, wrong types, values out
// of their range, a newer schema, nesting deeper than 32, text longer than 16 MiB, or more than 256 layers. A
// layer of an unknown kind is kept token by token as a CustomLayer and written back unchanged. Pure
// functions, safe on any thread.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "vernier/plan/Scene.h"

namespace vernier {

inline constexpr std::size_t kMaxSceneBytes = 16u << 20;
inline constexpr int kMaxSceneDepth = 32;
inline constexpr std::size_t kMaxSceneLayers = 256;

VERNIER_API std::string writeScene(const Scene&);
VERNIER_API Result<Scene> parseScene(std::string_view json);

// Points of a path, alone in a file: a list of lists of three numbers, mm in the patient. SceneInvalid as
// above.
VERNIER_API Result<std::vector<PatientPoint>> parsePath(std::string_view json);

// A transfer function, alone in a file: an object of `colours` (lists of value, red, green, blue),
// `opacities` (lists of value, opacity) and `opacity_length_mm`. SceneInvalid as above.
VERNIER_API std::string writeTransfer(const TransferFunction&);
VERNIER_API Result<TransferFunction> parseTransfer(std::string_view json);

// A layer object of a plugin's own kind, checked and brought into canonical text (no space outside strings).
// SceneInvalid when it is no object with a `kind` that is a name, or of a kind that this build knows itself.
VERNIER_API Result<CustomLayer> customLayer(std::string_view json);
// The volume that a plugin's layer reads: the text under its key `source`. nullopt: it names none.
VERNIER_API std::optional<std::string> sourceOf(const CustomLayer&);

}  // namespace vernier
