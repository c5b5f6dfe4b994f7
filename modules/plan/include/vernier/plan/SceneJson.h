// SPDX-License-Identifier: GPL-3.0-or-later
// Scene as JSON. Keys are written in a fixed order and numbers shortest-round-trip, so writing is canonical:
// parse(write(s)) == s bit for bit. Unknown keys inside a known layer, wrong types, NaN and a newer schema
// are refused with the JSON path ("/layers/0/plane/normal") in Error::where.
#pragma once
#include <string>
#include <string_view>

#include "vernier/plan/Scene.h"

namespace vernier {
VERNIER_API std::string writeScene(const Scene&);
VERNIER_API Result<Scene> parseScene(std::string_view json);
}  // namespace vernier
