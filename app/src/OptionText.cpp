// SPDX-License-Identifier: GPL-3.0-or-later
// The values of options as text, each with its own sentence where they are wrong.
#include "OptionText.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "vernier/plan/LinkedViews.h"
#include "vernier/plan/SceneJson.h"
#include "vernier/volume/Voi.h"

namespace vernier::app {

namespace {
constexpr std::uintmax_t kMaxSceneBytes = std::uintmax_t{16} << 20;
}  // namespace

Error invalid(const std::string& option, const std::string& sentence) {
  return makeError(ErrorCode::OptionInvalid, sentence, option);
}

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> parts;
  std::size_t at = 0;
  while (at <= text.size()) {
    const std::size_t end = std::min(text.find(by, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

std::optional<double> number(const std::string& text) {
  double x = 0;
  const char* end = text.data() + text.size();
  const auto [p, ec] = std::from_chars(text.data(), end, x);
  if (ec != std::errc() || p != end || !std::isfinite(x)) return std::nullopt;
  return x;
}

Result<glm::dvec3> vec3(const std::string& option, const std::string& key,
                        const std::vector<std::string>& parts) {
  glm::dvec3 v;
  for (int i = 0; i < 3; ++i) {
    const auto x = parts.size() == 3 ? number(parts[static_cast<std::size_t>(i)]) : std::nullopt;
    if (!x) return invalid(option, key + " needs three numbers, such as " + key + "=0,0,1.");
    v[i] = *x;
  }
  return v;
}

Result<std::string> textOf(const std::string& path, const char* what) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec) || std::filesystem::file_size(path, ec) > kMaxSceneBytes)
    return makeError(ErrorCode::FileNotFound,
                     std::string(what) + " is not a readable file of at most 16 MiB.", path);
  std::ifstream f(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(f)), {});
}

namespace {

// "key=1,2,3,other=4": numbers that follow a key belong to it until the next key.
Result<std::vector<std::pair<std::string, std::vector<std::string>>>> keyed(const std::string& option,
                                                                            const std::string& text) {
  std::vector<std::pair<std::string, std::vector<std::string>>> out;
  for (const std::string& part : split(text, ',')) {
    const std::size_t eq = part.find('=');
    if (eq != std::string::npos)
      out.push_back({part.substr(0, eq), {part.substr(eq + 1)}});
    else if (!out.empty())
      out.back().second.push_back(part);
    else
      return invalid(option, "'" + text + "' does not begin with KEY=; --help shows the keys.");
  }
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (out[k].first == out[i].first) return invalid(option, out[i].first + " is given twice.");
  return out;
}

}  // namespace

Result<glm::ivec2> parseSize(const std::string& text) {
  const auto parts = split(text, 'x');
  const auto w = parts.size() == 2 ? number(parts[0]) : std::nullopt;
  const auto h = parts.size() == 2 ? number(parts[1]) : std::nullopt;
  if (!w || !h || *w != std::floor(*w) || *h != std::floor(*h) || *w < 1 || *h < 1 || *w > 16384 ||
      *h > 16384)
    return invalid("--size",
                   "'" + text + "' is not WIDTHxHEIGHT with 1 to 16384 pixels each, such as 512x512.");
  return glm::ivec2(static_cast<int>(*w), static_cast<int>(*h));
}

Result<VoiWindow> parseWindow(const std::string& text) {
  const auto parts = split(text, ',');
  const auto c = parts.size() == 2 ? number(parts[0]) : std::nullopt;
  const auto w = parts.size() == 2 ? number(parts[1]) : std::nullopt;
  if (!c || !w || *w <= 0)
    return invalid("--window", "'" + text + "' is not CENTER,WIDTH with a width above 0, such as 40,400.");
  return normalised(VoiWindow{*c, *w, VoiFunction::Linear, "as given"});
}

Result<VoiWindow> windowPreset(const std::string& name, const std::string& unit) {
  struct Row {
    const char* name;
    double center, width;
  };
  static constexpr Row kRows[] = {{"brain", 40, 80},        {"subdural", 75, 215}, {"stroke", 35, 40},
                                  {"lung", -600, 1500},     {"bone", 400, 1800},   {"abdomen", 50, 400},
                                  {"mediastinum", 50, 350}, {"liver", 100, 150}};
  std::string names;
  for (const Row& r : kRows) {
    if (name == r.name) {
      if (unit != "HU")
        return invalid("--preset",
                       "The preset " + name + " is for CT in HU; these values are '" + unit + "'.");
      return VoiWindow{r.center, r.width, VoiFunction::Linear, r.name};
    }
    names += std::string(names.empty() ? "" : ", ") + r.name;
  }
  return invalid("--preset", "No window preset '" + name + "'; there are " + names + ".");
}

Result<Camera> parseCamera(const std::string& text) {
  Camera c;
  if (text.empty()) return c;
  const auto pairs = keyed("--camera", text);
  if (!pairs) return pairs.error();
  for (const auto& [key, values] : *pairs) {
    if (key == "projection") {
      if (values.size() != 1 || (values[0] != "orthographic" && values[0] != "perspective"))
        return invalid("--camera", "projection is orthographic or perspective.");
      c.projection = values[0] == "perspective" ? Projection::Perspective : Projection::Orthographic;
      continue;
    }
    const auto x = values.size() == 1 ? number(values[0]) : std::nullopt;
    double* target = key == "azimuth"     ? &c.azimuth_deg
                     : key == "elevation" ? &c.elevation_deg
                     : key == "roll"      ? &c.roll_deg
                     : key == "fov"       ? &c.fov_deg
                     : key == "zoom"      ? &c.zoom
                     : key == "near"      ? &c.near_mm
                     : key == "distance"  ? &c.distance_mm.emplace(0)
                                          : nullptr;
    if (!target)
      return invalid("--camera",
                     "No key '" + key +
                         "'; there are azimuth, elevation, roll, projection, fov, zoom, distance and near.");
    if (!x) return invalid("--camera", key + " needs one number.");
    *target = *x;
  }
  if (!(c.near_mm >= 0)) return invalid("--camera", "near is at least 0 mm.");
  if (!(c.zoom > 0 && c.zoom <= 1e4)) return invalid("--camera", "zoom is above 0 and at most 10000.");
  if (!(c.fov_deg > 0 && c.fov_deg < 180))
    return invalid("--camera", "fov is above 0 and below 180 degrees.");
  return c;
}

Result<Plane> parsePlane(const std::string& text) {
  const auto pairs = keyed("--plane", text);
  if (!pairs) return pairs.error();
  std::map<std::string, glm::dvec3> given;
  for (const auto& [key, values] : *pairs) {
    if (key != "point" && key != "normal" && key != "up" && key != "from" && key != "to")
      return invalid("--plane", "No key '" + key + "'; there are point, normal and up, or from, to and up.");
    const Result<glm::dvec3> v = vec3("--plane", key, values);
    if (!v) return v.error();
    if (!given.emplace(key, *v).second) return invalid("--plane", "The key " + key + " was given twice.");
  }
  const auto has = [&](const char* a, const char* b) {
    return given.size() == 3 && given.contains("up") && given.contains(a) && given.contains(b);
  };
  if (has("point", "normal"))
    return Plane{PatientPoint(given["point"]), PatientVec(given["normal"]), PatientVec(given["up"])};
  if (!has("from", "to"))
    return invalid("--plane",
                   "A plane needs point=x,y,z,normal=x,y,z,up=x,y,z or from=x,y,z,to=x,y,z,up=x,y,z in "
                   "patient mm.");
  Result<Plane> plane =
      planeThrough(PatientPoint(given["from"]), PatientPoint(given["to"]), PatientVec(given["up"]));
  if (!plane) return makeError(plane.error().code, plane.error().sentence, "--plane");
  return plane;
}

Result<std::vector<PatientPoint>> parsePathOption(const std::string& text) {
  if (text.ends_with(".json")) {
    const Result<std::string> json = textOf(text, "The path");
    if (!json) return json.error();
    return parsePath(*json);
  }
  std::vector<PatientPoint> points;
  for (const std::string& part : split(text, ';')) {
    const Result<glm::dvec3> p = vec3("--path", "a point", split(part, ','));
    if (!p)
      return invalid(
          "--path",
          "'" + part + "' is no point; give x,y,z;x,y,z;... in patient mm, or the name of a .json file.");
    points.emplace_back(*p);
  }
  return points;
}

}  // namespace vernier::app
