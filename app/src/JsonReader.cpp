// SPDX-License-Identifier: GPL-3.0-or-later
#include "JsonReader.h"

#include <cmath>

namespace vernier::app {

JsonReader::JsonReader(const Json& object, std::string where) : object_(object), where_(std::move(where)) {
  if (!object_.is_object())
    fail(makeError(ErrorCode::FileDamaged, "An object in braces was expected here.", where_));
}

void JsonReader::fail(const Error& e) {
  if (!error_) error_ = e;
}
void JsonReader::fail(const std::string& key, const std::string& sentence) {
  fail(makeError(ErrorCode::FileDamaged, sentence, placeOf(key)));
}

const JsonReader::Json* JsonReader::find(const char* key, bool needed) {
  seen_.insert(key);
  if (has(key)) return &object_.at(key);
  if (needed) fail(key, "The key is missing.");
  return nullptr;
}

std::string JsonReader::text(const char* key, bool needed) {
  const Json* j = find(key, needed);
  if (!j) return {};
  if (!j->is_string() || (needed && j->get_ref<const std::string&>().empty())) {
    fail(key, "A text was expected here.");
    return {};
  }
  return j->get<std::string>();
}

std::optional<double> JsonReader::number(const char* key, double least, double most, bool needed) {
  const Json* j = find(key, needed);
  if (!j) return {};
  const double x = j->is_number() ? j->get<double>() : NAN;
  if (!(x >= least && x <= most) || !std::isfinite(x)) {
    fail(key, "A number" +
                  (std::isfinite(least) && std::isfinite(most)
                       ? " from " + Json(least).dump() + " to " + Json(most).dump()
                       : std::string()) +
                  " was expected here.");
    return {};
  }
  return x;
}

int JsonReader::wholeNumber(const char* key, int least, int most, int otherwise) {
  if (!has(key)) return otherwise;
  const auto x = number(key, least, most);
  if (x && *x != std::floor(*x)) fail(key, "A whole number was expected here.");
  return x ? static_cast<int>(*x) : otherwise;
}

std::vector<double> JsonReader::numbers(const char* key, std::size_t count) {
  const Json* j = find(key, true);
  std::vector<double> out;
  if (j && j->is_array())
    for (const Json& x : *j)
      if (x.is_number() && std::isfinite(x.get<double>())) out.push_back(x.get<double>());
  if (j && (!j->is_array() || out.size() != count || j->size() != count))
    fail(key, "A list of " + std::to_string(count) + " numbers was expected here.");
  out.resize(count);
  return out;
}

std::vector<std::string> JsonReader::texts(const char* key) {
  std::vector<std::string> out;
  const Json* j = array(key);
  if (!j) return out;
  for (const Json& x : *j)
    if (x.is_string())
      out.push_back(x.get<std::string>());
    else
      fail(key, "A list of texts was expected here.");
  return out;
}

const JsonReader::Json* JsonReader::object(const char* key, bool needed) {
  const Json* j = find(key, needed);
  if (j && !j->is_object()) {
    fail(key, "An object in braces was expected here.");
    return nullptr;
  }
  return j;
}
const JsonReader::Json* JsonReader::array(const char* key, bool needed) {
  const Json* j = find(key, needed);
  if (j && !j->is_array()) {
    fail(key, "A list in brackets was expected here.");
    return nullptr;
  }
  return j;
}
const JsonReader::Json* JsonReader::any(const char* key, bool needed) { return find(key, needed); }

Result<void> JsonReader::done() {
  if (!error_)
    for (const auto& [key, value] : object_.items())
      if (!seen_.contains(key)) fail(key, "No key of this name is known here; see docs/qa.md.");
  if (error_) return *error_;
  return {};
}

}  // namespace vernier::app
