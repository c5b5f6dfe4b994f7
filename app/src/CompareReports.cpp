// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between two reports of `vernier render --report`: what was drawn, how, how exact, how fast.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "Compare.h"
#include "OptionText.h"

namespace vernier::app {
namespace {
using Json = nlohmann::ordered_json;
constexpr const char* kSchema = "vernier-report/1";

Result<Json> readReport(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  const Result<std::string> text = textOf(path, "The report");
  if (!text) return makeError(text.error().code, text.error().sentence, name);
  Json j = Json::parse(*text, nullptr, false);
  if (j.is_discarded()) return makeError(ErrorCode::FileDamaged, "The report is not valid JSON.", name);
  if (!j.is_object() || j.value("schema", "") != kSchema)
    return makeError(ErrorCode::FileDamaged,
                     "The file is no report of `vernier render --report` (schema vernier-report/1).", name);
  return j;
}

Json passesOf(const Json& report) {
  Json list = Json::array();
  for (const Json& p : report.at("plan").at("passes"))
    list.push_back(p.at("name").get<std::string>() + " (" + p.at("technique").get<std::string>() + ", " +
                   p.at("engine").get<std::string>() + ")");
  return list;
}

// a, b and b/a; the ratio is null where it means nothing.
Json ratio(double a, double b) { return {{"a", a}, {"b", b}, {"ratio", a > 0 ? Json(b / a) : Json()}}; }

Json errorOf(const Json& report) {
  const Json& e = report.at("error");
  if (e.is_null()) return Json();
  return {{"max", e.at("max")}, {"rms", e.at("rms")}, {"bound", e.at("bound")}};
}

Json differences(const Json& a, const Json& b) {
  Json j = {{"schema", "vernier-compare/1"}, {"what", "reports"}};
  for (const auto& [name, part] : {std::pair{"same_input", "input"}, {"same_scene", "scene"}})
    j[name] = a.at(part) == b.at(part);
  j["same_picture"] = a.at("image") == b.at("image");
  j["same_passes"] = passesOf(a) == passesOf(b);
  j["passes"] = {{"a", passesOf(a)}, {"b", passesOf(b)}};
  j["engine"] = {{"a", a.at("engine").at("renderer")}, {"b", b.at("engine").at("renderer")}};
  j["error"] = {{"unit", "level/255"}, {"a", errorOf(a)}, {"b", errorOf(b)}};
  const auto ms = [](const Json& r, const char* key) { return r.at("timing").at(key).get<double>(); };
  j["timing_ms"] = {{"load", ratio(ms(a, "load_ms"), ms(b, "load_ms"))},
                    {"first_frame", ratio(ms(a, "first_frame_ms"), ms(b, "first_frame_ms"))},
                    {"frame", ratio(a.at("timing").at("frame_ms").at("median"),
                                    b.at("timing").at("frame_ms").at("median"))}};
  j["timing_note"] = "ratios under 1.5 mean little on a machine that does other things too";
  return j;
}

void print(const Json& j) {
  const auto yes = [&](const char* key) { return j.at(key).get<bool>() ? "the same" : "DIFFERENT"; };
  std::printf("input %s, scene %s, passes %s, picture %s\n", yes("same_input"), yes("same_scene"),
              yes("same_passes"), yes("same_picture"));
  for (const char* side : {"a", "b"}) {
    std::printf("%s: ", side);
    for (const Json& p : j.at("passes").at(side)) std::printf("%s; ", p.get<std::string>().c_str());
    const Json& e = j.at("error").at(side);
    std::printf("error %s\n", e.is_null() ? "not measured" : e.dump().c_str());
  }
  for (const auto& [name, t] : j.at("timing_ms").items())
    std::printf("%s: %.4g ms, %.4g ms, B/A %s\n", name.c_str(), t.at("a").get<double>(),
                t.at("b").get<double>(), t.at("ratio").dump().substr(0, 5).c_str());
}

}  // namespace

bool isReport(const std::string& path) {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec)) return false;
  std::ifstream f(path, std::ios::binary);
  char c = 0;
  while (f.get(c) && (c == ' ' || c == '\n' || c == '\r' || c == '\t')) {
  }
  return f && c == '{' && std::filesystem::path(path).extension() == ".json";
}

int compareReports(const CompareOptions& o) {
  const Result<Json> a = readReport(o.a);
  if (!a) return report(a.error());
  const Result<Json> b = readReport(o.b);
  if (!b) return report(b.error());
  Json j;
  try {
    j = differences(*a, *b);
  } catch (const Json::exception&) {
    return report(makeError(ErrorCode::FileDamaged, "A report lacks some of its figures."));
  }
  if (o.json)
    std::cout << j.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
  else
    print(j);
  if (!o.maxError) return 0;
  for (const char* side : {"a", "b"}) {
    const Json& e = j["error"][side];
    if (e.is_null() || !e["bound"].is_number())
      return report(
          makeError(ErrorCode::OutOfTolerance, "The error of one picture was not measured.", "--max-error"));
    if (const int code = judgeMaxError(o, e["bound"].get<double>(), "levels of 255"); code != 0) return code;
  }
  return 0;
}

}  // namespace vernier::app
