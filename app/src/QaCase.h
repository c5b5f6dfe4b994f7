// SPDX-License-Identifier: GPL-3.0-or-later
// One case of quality assurance: a folder with case.json and, where a picture is judged, expected.png
// (docs/qa.md has every key). Reading is strict: an unknown or missing key, a wrong type or a tolerance
// without a reason is refused with its place. Errors: FileNotFound, FileDamaged. Pure; any thread.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "vernier/base/Result.h"
#include "vernier/picture/Mutants.h"

namespace vernier::app {

// What a case looks at: a phantom by its recipe, or files whose hash is stated.
struct QaData {
  std::string recipe;
  std::map<std::string, std::string> settings;  // of the recipe
  std::string path;                             // as in case.json, relative to the case's folder
  std::string sha256;                           // of a recipe it may be absent
  bool empty() const { return recipe.empty() && path.empty(); }
  friend auto operator<=>(const QaData&, const QaData&) = default;
};

// All that is given must hold. Levels of 255, all channels alike.
struct QaTolerance {
  std::optional<double> max, mean, rmse, ssim;  // ssim: at least this
  struct Above {
    double level = 0, share = 0;  // at most `share` of the pixels (0..1) differ by more than `level`
  };
  std::optional<Above> above;
  std::string why;
};

struct QaCase {
  std::string name;    // of the folder, relative to the suite
  std::string folder;  // to open it
  std::string title, why, requirement, hazard;
  std::optional<QaData> data;
  std::vector<QaData> surfaces;
  std::string series, view;
  std::vector<std::string> options;  // as `vernier render` takes them
  std::string sceneText;             // Scene JSON in place of a view
  int width_px = 256, height_px = 256;
  std::vector<std::string> engines{"native", "gl"};                 // those that the case is meant for
  std::optional<QaTolerance> tolerance, toleranceGl;                // absent: no picture is judged
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();  // objects with "kind" (QaChecks.h)
  int leastLevels = 8;                   // different greys or colours that expected.png must have
  std::map<Mutant, std::string> exempt;  // mutants that the picture cannot tell, and why

  bool draws() const { return !view.empty() || !sceneText.empty(); }
  const std::optional<QaTolerance>& toleranceOf(const std::string& engine) const {
    return engine == "gl" && toleranceGl ? toleranceGl : tolerance;
  }
  std::string expectedFile() const { return folder + "/expected.png"; }
};

// `folder` holds case.json; `name` is how the case is called.
Result<QaCase> readQaCase(const std::string& folder, const std::string& name);
// The same from text; `folder` is only remembered. Error::where is "name/case.json#/place".
Result<QaCase> parseQaCase(const std::string& json, const std::string& folder, const std::string& name);

// A case's data, or that of a check; strict as the rest. Error::where is below `where`.
Result<QaData> readQaData(const nlohmann::ordered_json&, const std::string& where);

// Folders below `suite` that hold a case.json, as names relative to it, in order. FileNotFound,
// NothingToLoad.
Result<std::vector<std::string>> findQaCases(const std::string& suite);

}  // namespace vernier::app
