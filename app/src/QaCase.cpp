// SPDX-License-Identifier: GPL-3.0-or-later
#include "QaCase.h"

#include <algorithm>
#include <filesystem>

#include "JsonReader.h"
#include "OptionText.h"

namespace vernier::app {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "vernier-qa-case/1";
constexpr int kLargestCasePicture_px = 1024;
constexpr int kDeepest = 64;  // of nested brackets

// Into the case; a fault is handed to who reads it.
QaData readData(const Json& j, const std::string& where, JsonReader& outer) {
  Result<QaData> d = readQaData(j, where);
  if (!d) outer.fail(d.error());
  return d ? *d : QaData();
}

QaTolerance readTolerance(const Json& j, const std::string& where, JsonReader& outer) {
  JsonReader r(j, where);
  QaTolerance t;
  t.max = r.number("max", 0, 255, false);
  t.mean = r.number("mean", 0, 255, false);
  t.rmse = r.number("rmse", 0, 255, false);
  t.ssim = r.number("ssim", -1, 1, false);
  t.why = r.text("why");
  if (const Json* above = r.object("above")) {
    JsonReader a(*above, r.placeOf("above"));
    t.above = QaTolerance::Above{a.number("level", 0, 255).value_or(0), a.number("share", 0, 1).value_or(0)};
    if (const Result<void> done = a.done(); !done) r.fail(done.error());
  }
  if (!t.max && !t.mean && !t.rmse && !t.ssim && !t.above)
    r.fail("max", "A tolerance bounds at least one of max, mean, rmse, ssim, above.");
  if (const Result<void> done = r.done(); !done) outer.fail(done.error());
  return t;
}

void readGuard(const Json& j, const std::string& where, QaCase& c, JsonReader& outer) {
  JsonReader r(j, where);
  c.leastLevels = r.wholeNumber("least_levels", 2, 65536, c.leastLevels);
  if (const Json* exempt = r.object("exempt"))
    for (const auto& [name, why] : exempt->items()) {
      const auto mutant = mutantNamed(name);
      if (!mutant)
        r.fail("exempt/" + name,
               "No mutant has this name; there are shifted-right, shifted-down, mirrored, gamma, blank and "
               "object-missing.");
      else if (*mutant == Mutant::Blank)
        r.fail("exempt/" + name, "A case that a blank picture passes proves nothing; this cannot be exempt.");
      else if (!why.is_string() || why.get_ref<const std::string&>().empty())
        r.fail("exempt/" + name, "Say why, in a text.");
      else
        c.exempt[*mutant] = why.get<std::string>();
    }
  if (const Result<void> done = r.done(); !done) outer.fail(done.error());
}

void readChecks(const Json& list, const std::string& where, QaCase& c, JsonReader& outer) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = where + "/" + std::to_string(i);
    const Json& check = list[i];
    if (!check.is_object() || !check.contains("kind") || !check["kind"].is_string())
      outer.fail(
          makeError(ErrorCode::FileDamaged, "A check is an object with a \"kind\" (docs/qa.md).", place));
  }
  c.checks = list;
}

// What the runner itself says may not stand among a case's options.
void checkOptions(QaCase& c, JsonReader& r) {
  for (const std::string& option : c.options) {
    if (!option.starts_with("--")) r.fail("options", "'" + option + "' is no option; write --NAME=VALUE.");
    const std::string name = option.substr(0, option.find('='));
    for (const char* own : {"--engine", "--view", "--scene", "--series", "--size", "--surface"})
      if (name == own) r.fail("options", name + " has a key of its own, or is chosen by the run.");
  }
}

void readPictureKeys(JsonReader& r, QaCase& c) {
  c.view = r.text("view", false);
  if (const Json* scene = r.object("scene")) c.sceneText = scene->dump();
  if (!c.view.empty() && !c.sceneText.empty()) r.fail("scene", "Give either a view or a scene.");
  c.options = r.texts("options");
  checkOptions(c, r);
  if (r.has("size")) {
    const std::vector<double> size = r.numbers("size", 2);
    for (const double s : size)
      if (!(s >= 1 && s <= kLargestCasePicture_px && s == static_cast<int>(s)))
        r.fail("size", "Two whole numbers from 1 to 1024 were expected here.");
    c.width_px = static_cast<int>(std::clamp(size[0], 1.0, 1024.0));
    c.height_px = static_cast<int>(std::clamp(size[1], 1.0, 1024.0));
  }
  if (const Json* t = r.object("tolerance")) c.tolerance = readTolerance(*t, r.placeOf("tolerance"), r);
  if (const Json* t = r.object("tolerance_gl"))
    c.toleranceGl = readTolerance(*t, r.placeOf("tolerance_gl"), r);
  if (const Json* g = r.object("guard")) readGuard(*g, r.placeOf("guard"), c, r);
  if (c.toleranceGl && !c.tolerance) r.fail("tolerance_gl", "It goes beside a tolerance for all engines.");
  if (c.tolerance && !c.draws()) r.fail("tolerance", "A picture is judged, but no view or scene is given.");
}

}  // namespace

Result<QaCase> parseQaCase(const std::string& text, const std::string& folder, const std::string& name) {
  const std::string where = name + "/case.json#";
  int depth = 0;
  bool tooDeep = false;
  const Json::parser_callback_t shallow = [&](int d, Json::parse_event_t, Json&) {
    depth = std::max(depth, d);
    tooDeep = tooDeep || d > kDeepest;
    return !tooDeep;
  };
  const Json j = Json::parse(text, shallow, false);
  if (j.is_discarded() || tooDeep)
    return makeError(ErrorCode::FileDamaged, "The case is not valid JSON; compare it with docs/qa.md.",
                     name + "/case.json");
  QaCase c;
  c.name = name, c.folder = folder;
  JsonReader r(j, where);
  if (r.text("schema") != kSchema)
    r.fail("schema", std::string("The schema is not \"") + kSchema + "\", the only one that is read here.");
  c.title = r.text("title");
  c.why = r.text("why");
  c.requirement = r.text("requirement", false);
  c.hazard = r.text("hazard", false);
  if (const Json* d = r.object("data")) c.data = readData(*d, r.placeOf("data"), r);
  if (const Json* list = r.array("surfaces"))
    for (std::size_t i = 0; i < list->size(); ++i)
      c.surfaces.push_back(readData((*list)[i], r.placeOf("surfaces/" + std::to_string(i)), r));
  c.series = r.text("series", false);
  readPictureKeys(r, c);
  if (r.has("engines")) {
    c.engines = r.texts("engines");
    for (const std::string& e : c.engines)
      if (e != "native" && e != "gl") r.fail("engines", "'" + e + "' is no engine; there are native and gl.");
    if (c.engines.empty()) r.fail("engines", "Name native, gl or both.");
  }
  if (const Json* list = r.array("checks")) readChecks(*list, r.placeOf("checks"), c, r);
  if (!c.tolerance && c.checks.empty())
    r.fail("tolerance", "The case judges nothing: give a tolerance for its picture, or checks.");
  if (c.draws() && !c.data && c.surfaces.empty()) r.fail("data", "There is nothing to draw; give data.");
  if (const Result<void> done = r.done(); !done) return done.error();
  return c;
}

Result<QaData> readQaData(const Json& j, const std::string& where) {
  JsonReader r(j, where);
  QaData d;
  d.recipe = r.text("recipe", false);
  d.path = r.text("path", false);
  d.sha256 = r.text("sha256", false);
  if (const Json* settings = r.object("settings"))
    for (const auto& [name, value] : settings->items()) {
      if (value.is_string())
        d.settings[name] = value.get<std::string>();
      else
        r.fail("settings/" + name, "A text was expected here.");
    }
  if (d.recipe.empty() == d.path.empty()) r.fail("recipe", "Give either a recipe or a path.");
  if (!d.path.empty() && !d.settings.empty()) r.fail("settings", "Settings go with a recipe.");
  if (!d.path.empty() && d.sha256.empty())
    r.fail("sha256", "Files need their hash; leave it as \"?\" once, and the run says what it is.");
  if (const Result<void> done = r.done(); !done) return done.error();
  return d;
}

Result<QaCase> readQaCase(const std::string& folder, const std::string& name) {
  Result<std::string> text = textOf(folder + "/case.json", "The case");
  if (!text) return makeError(ErrorCode::FileNotFound, text.error().sentence, name + "/case.json");
  return parseQaCase(*text, folder, name);
}

Result<std::vector<std::string>> findQaCases(const std::string& suite) {
  std::error_code ec;
  if (!fs::is_directory(suite, ec))
    return makeError(ErrorCode::FileNotFound, "There is no folder of this name; name one that holds cases.",
                     suite);
  std::vector<std::string> names;
  fs::recursive_directory_iterator it(suite, fs::directory_options::skip_permission_denied, ec), end;
  for (; !ec && it != end; it.increment(ec)) {
    // A baseline whose case.json is gone is a case that cannot be read, not one that is not there.
    const bool lost =
        it->path().filename() == "expected.png" && !fs::exists(it->path().parent_path() / "case.json", ec);
    if (it->path().filename() == "case.json" || lost)
      names.push_back(it->path().parent_path().lexically_relative(suite).generic_string());
  }
  if (ec)
    return makeError(ErrorCode::FileNotFound, "The folder cannot be read: " + ec.message() + ".", suite);
  if (names.empty())
    return makeError(ErrorCode::NothingToLoad, "The folder holds no case: no case.json in it or below it.",
                     suite);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace vernier::app
