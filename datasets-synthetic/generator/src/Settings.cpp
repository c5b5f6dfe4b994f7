// SPDX-License-Identifier: GPL-3.0-or-later
// Settings: what a caller may change of a recipe. Each is written into the recipe's JSON, so that the planner
// sees one plain recipe.
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>

#include "Plan.h"

namespace vernier::phantoms {
namespace {

std::optional<double> numberIn(const std::string& text, double low, double high) {
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc() || end != text.data() + text.size() || !(v >= low && v <= high))
    return std::nullopt;
  return v;
}

// Divides the number of voxels along an axis by `factor` and makes them larger; the box stays the same within
// a voxel.
void coarsen(Json& grid, const char* count, int axis, double factor) {
  const auto n = static_cast<std::int64_t>(std::floor(grid.at(count).get<double>() / factor + 0.5));
  grid[count] = std::max<std::int64_t>(1, n);
  grid["spacing_mm"][axis] = grid["spacing_mm"][axis].get<double>() * factor;
}

bool setGrid(Json& recipe, const std::string& name, double v) {
  Json& grid = recipe["grid"];
  if (name == "scale") {
    coarsen(grid, "columns", 0, 1.0 / v);
    coarsen(grid, "rows", 1, 1.0 / v);
    coarsen(grid, "slices", 2, 1.0 / v);
  } else if (name == "pixel-aspect") {
    coarsen(grid, "rows", 1, v);
  } else if (name == "slice-aspect") {
    coarsen(grid, "slices", 2, v);
  } else {
    return false;
  }
  return true;
}

// The recipe's setting has "kind": number (low, high), or "values": the words that it takes.
Result<Json> valueOf(const Json& setting, const std::string& name, const std::string& text) {
  if (setting.contains("values")) {
    std::string all;
    for (const Json& word : setting["values"]) {
      if (word.get<std::string>() == text) return Json(text);
      all += (all.empty() ? "" : ", ") + word.get<std::string>();
    }
    return makeError(ErrorCode::OptionInvalid, "The setting '" + name + "' takes one of " + all + ".", text);
  }
  const double low = setting.at("low"), high = setting.at("high");
  if (const auto v = numberIn(text, low, high)) return Json(*v);
  return makeError(ErrorCode::OptionInvalid,
                   "The setting '" + name + "' takes a number from " + dsOf(low) + " to " + dsOf(high) + ".",
                   text);
}

}  // namespace

Result<Json> applySettings(Json recipe, const std::map<std::string, std::string>& settings,
                           std::string& variant) {
  variant.clear();
  const Json known = recipe.value("settings", Json::object());
  for (const auto& [name, text] : settings) {
    if (!known.contains(name)) {
      std::string all;
      for (const auto& item : known.items()) all += (all.empty() ? "" : ", ") + item.key();
      return makeError(
          ErrorCode::OptionInvalid,
          "The recipe has no setting '" + name + "'; it takes " + (all.empty() ? "none" : all) + ".",
          recipe.at("name").get<std::string>());
    }
    Result<Json> value = valueOf(known[name], name, text);
    if (!value) return value;
    if (text == known[name].at("default").get<std::string>()) continue;
    variant += (variant.empty() ? "" : ",") + name + "=" + text;
    if (value->is_number() && setGrid(recipe, name, value->get<double>())) continue;
    // Any other setting names the place in the recipe that it replaces.
    recipe[Json::json_pointer(known[name].at("sets").get<std::string>())] = *value;
  }
  return recipe;
}

}  // namespace vernier::phantoms
