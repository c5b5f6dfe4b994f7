// SPDX-License-Identifier: GPL-3.0-or-later
#include "CombinerJson.h"

#include <set>
#include <vector>

namespace vernier::dvr {
namespace {
using nlohmann::json;

constexpr std::size_t kMostBytes = 64 * 1024;

std::string escaped(const std::string& key) {
  std::string out;
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

}  // namespace

Place Place::at(const std::string& key) const { return {value.at(key), where + "/" + escaped(key)}; }

const Place& Place::object() const {
  if (!value.is_object()) fault("An object is expected here.");
  return *this;
}

const Place& Place::list() const {
  if (!value.is_array()) fault("A list is expected here.");
  return *this;
}

std::string Place::text() const {
  if (!value.is_string()) fault("A text is expected here.");
  return value.get<std::string>();
}

double Place::number() const {
  if (!value.is_number()) fault("A number is expected here.");
  return value.get<double>();  // JSON has no NaN, and the parser refuses what no double holds
}

json parseCombinerJson(std::string_view text, const std::string& file) {
  const std::string where = file + "#";
  if (text.size() > kMostBytes)
    throw CombinerFault{"The file has " + std::to_string(text.size()) + " bytes; at most 65536 are read.",
                        where};
  std::vector<std::set<std::string>> keys;
  const auto follow = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      throw CombinerFault{"The key '" + value.get<std::string>() + "' stands twice in one object; keep one.",
                          where};
    return true;
  };
  try {
    return json::parse(text.begin(), text.end(), follow);
  } catch (const json::parse_error& e) {
    throw CombinerFault{"The text is not JSON from byte " + std::to_string(e.byte) +
                            " on: a comma, a quote or a bracket is missing or too many.",
                        where};
  } catch (const json::out_of_range&) {
    throw CombinerFault{"A number is too large for a double.", where};
  }
}

}  // namespace vernier::dvr
