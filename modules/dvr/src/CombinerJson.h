// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of combiner files share: JSON values with their places. Throws CombinerFault.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace vernier::dvr {

struct CombinerFault {
  std::string sentence, where;
};

// A value and where it stands: "iso.json#/stages/0".
struct Place {
  const nlohmann::json& value;
  std::string where;
  [[noreturn]] void fault(const std::string& sentence) const { throw CombinerFault{sentence, where}; }
  bool has(const char* key) const { return value.contains(key); }
  Place at(const std::string& key) const;  // of an object that has the key; '/' and '~' are escaped
  Place at(std::size_t index) const { return {value.at(index), where + "/" + std::to_string(index)}; }
  const Place& object() const;  // refuses what is none
  const Place& list() const;
  std::string text() const;
  double number() const;  // finite
};

// At most 64 KiB, keys once each.
nlohmann::json parseCombinerJson(std::string_view text, const std::string& file);

}  // namespace vernier::dvr
