// SPDX-License-Identifier: GPL-3.0-or-later
// Reads an object of a JSON file key by key. The first fault is kept, with its place; what is read after it
// means nothing. Keys that nobody asked for are refused by done().
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "vernier/base/Result.h"

namespace vernier::app {

class JsonReader {
 public:
  using Json = nlohmann::ordered_json;
  // `where`: "file.json#" and the path so far.
  JsonReader(const Json& object, std::string where);

  bool has(const char* key) const { return object_.is_object() && object_.contains(key); }
  std::string text(const char* key, bool needed = true);  // not empty where needed
  std::optional<double> number(const char* key, double least, double most, bool needed = true);
  int wholeNumber(const char* key, int least, int most, int otherwise);
  std::vector<double> numbers(const char* key, std::size_t count);  // exactly so many, finite
  std::vector<std::string> texts(const char* key);                  // absent: none
  // nullptr when absent or of another type (which is a fault).
  const Json* object(const char* key, bool needed = false);
  const Json* array(const char* key, bool needed = false);
  const Json* any(const char* key, bool needed = true);

  std::string placeOf(const std::string& key) const { return where_ + "/" + key; }
  void fail(const std::string& key, const std::string& sentence);
  void fail(const Error& e);
  const std::optional<Error>& fault() const { return error_; }
  // The first fault, or the first key that was not asked for.
  Result<void> done();

 private:
  const Json* find(const char* key, bool needed);
  const Json& object_;
  std::string where_;
  std::set<std::string> seen_;
  std::optional<Error> error_;
};

}  // namespace vernier::app
