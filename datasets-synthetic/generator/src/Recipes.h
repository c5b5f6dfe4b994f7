// SPDX-License-Identifier: GPL-3.0-or-later
// The recipes, embedded when Vernier is built (datasets-synthetic/recipes/*.json).
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Field.h"

namespace vernier::phantoms {

// File name without .json, text. Made by CMake.
const std::vector<std::pair<std::string, std::string>>& embeddedRecipes();

// The recipe with its "base" merged below it; nullopt: unknown.
std::optional<Json> findRecipe(const std::string& name);

}  // namespace vernier::phantoms
