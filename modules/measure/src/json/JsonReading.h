// SPDX-License-Identifier: GPL-3.0-or-later
// JSON text made safe to look at: limits first, repeated keys refused, every fault with its path. Throws
// JsonFault.
#pragma once
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>

namespace vernier::measure {

struct JsonFault {
  std::string sentence;
  std::string path;  // RFC 6901 pointer
};

std::string pointerTo(const std::string& parent, const std::string& key);
std::string pointerTo(const std::string& parent, std::size_t index);
nlohmann::json parseJson(std::string_view text);

// Reads keys of one object and remembers which, so that others can be refused.
class ObjectReader {
 public:
  ObjectReader(const nlohmann::json& object, std::string path);
  bool has(const std::string& key) const { return object_.contains(key); }
  const nlohmann::json& child(const std::string& key) const;  // required
  const nlohmann::json& array(const std::string& key) const;
  double number(const std::string& key) const;
  std::uint64_t count(const std::string& key, std::uint64_t most) const;
  std::string text(const std::string& key) const;
  std::string textOr(const std::string& key) const { return has(key) ? text(key) : std::string(); }
  std::string pathOf(const std::string& key) const { return pointerTo(path_, key); }
  const std::string& path() const { return path_; }
  void refuseOthers() const;  // call last

 private:
  const nlohmann::json& object_;
  std::string path_;
  mutable std::set<std::string> read_;
};

double numberAt(const nlohmann::json&, const std::string& path);
// A list of exactly n numbers.
std::vector<double> numbersAt(const nlohmann::json&, std::size_t n, const std::string& path);

}  // namespace vernier::measure
