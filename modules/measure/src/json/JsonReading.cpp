// SPDX-License-Identifier: GPL-3.0-or-later
#include "JsonReading.h"

#include <cmath>

namespace vernier::measure {
namespace {

constexpr std::size_t kMostBytes = 16u << 20;
constexpr int kMostDepth = 32;

void checkLimits(std::string_view text) {
  if (text.size() > kMostBytes)
    throw JsonFault{"The text has " + std::to_string(text.size()) + " bytes, at most " +
                        std::to_string(kMostBytes) + " are read.",
                    ""};
  int depth = 0;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inString) {
      if (c == '\\') ++i;
      if (c == '"') inString = false;
    } else if (c == '"') {
      inString = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kMostDepth)
        throw JsonFault{"The text is nested deeper than " + std::to_string(kMostDepth) + " levels.", ""};
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

// Where the parser is, and the keys of the objects that are open there.
class Track {
 public:
  using Event = nlohmann::json::parse_event_t;
  bool operator()(int, Event event, nlohmann::json& value) {
    if (event == Event::object_start || event == Event::array_start)
      frames_.push_back({event == Event::array_start, 0, "", {}});
    if (event == Event::object_end || event == Event::array_end) frames_.pop_back();
    if (event == Event::key) {
      Frame& f = frames_.back();
      f.key = value.get_ref<const std::string&>();
      if (!f.keys.insert(f.key).second)
        throw JsonFault{"The key '" + f.key + "' stands here twice; keep one.", path()};
    } else if (event != Event::object_start && event != Event::array_start && !frames_.empty()) {
      if (frames_.back().array) ++frames_.back().index;
      frames_.back().key.clear();
    }
    return true;
  }
  std::string path() const {
    std::string p;
    for (const Frame& f : frames_)
      if (f.array)
        p = pointerTo(p, f.index);
      else if (!f.key.empty())
        p = pointerTo(p, f.key);
    return p;
  }

 private:
  struct Frame {
    bool array;
    std::size_t index;
    std::string key;
    std::set<std::string> keys;
  };
  std::vector<Frame> frames_;
};

}  // namespace

std::string pointerTo(const std::string& parent, const std::string& key) {
  std::string out = parent + "/";
  for (const char c : key)
    out += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
  return out;
}
std::string pointerTo(const std::string& parent, std::size_t index) {
  return parent + "/" + std::to_string(index);
}

nlohmann::json parseJson(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark is no part of the text
  checkLimits(text);
  Track track;
  try {
    return nlohmann::json::parse(text.begin(), text.end(), std::ref(track));
  } catch (const nlohmann::json::parse_error& e) {
    throw JsonFault{
        "The text is not JSON from byte " + std::to_string(e.byte) +
            " on (a comma, a quote or a bracket too many or missing, or a value that JSON does not have).",
        track.path()};
  } catch (const nlohmann::json::out_of_range&) {
    throw JsonFault{"The number is too large for a double.", track.path()};
  }
}

ObjectReader::ObjectReader(const nlohmann::json& object, std::string path)
    : object_(object), path_(std::move(path)) {
  if (!object.is_object())
    throw JsonFault{std::string("An object is expected here, not ") + object.type_name() + ".", path_};
}

const nlohmann::json& ObjectReader::child(const std::string& key) const {
  read_.insert(key);
  const auto found = object_.find(key);
  if (found == object_.end()) throw JsonFault{"The key '" + key + "' is missing here.", path_};
  return *found;
}

const nlohmann::json& ObjectReader::array(const std::string& key) const {
  const nlohmann::json& v = child(key);
  if (!v.is_array())
    throw JsonFault{std::string("A list is expected here, not ") + v.type_name() + ".", pathOf(key)};
  return v;
}

double ObjectReader::number(const std::string& key) const { return numberAt(child(key), pathOf(key)); }

std::uint64_t ObjectReader::count(const std::string& key, std::uint64_t most) const {
  const nlohmann::json& v = child(key);
  if (!v.is_number_unsigned() || v.get<std::uint64_t>() > most)
    throw JsonFault{"A whole number from 0 to " + std::to_string(most) + " is expected here.", pathOf(key)};
  return v.get<std::uint64_t>();
}

std::string ObjectReader::text(const std::string& key) const {
  const nlohmann::json& v = child(key);
  if (!v.is_string())
    throw JsonFault{std::string("Text is expected here, not ") + v.type_name() + ".", pathOf(key)};
  return v.get<std::string>();
}

void ObjectReader::refuseOthers() const {
  for (const auto& item : object_.items())
    if (!read_.contains(item.key()))
      throw JsonFault{
          "The key '" + item.key() + "' is not known here; see docs/measurements.md for the keys there are.",
          pathOf(item.key())};
}

double numberAt(const nlohmann::json& v, const std::string& path) {
  if (!v.is_number())
    throw JsonFault{std::string("A number is expected here, not ") + v.type_name() + ".", path};
  const double x = v.get<double>();
  if (!std::isfinite(x)) throw JsonFault{"The number is too large for a double.", path};
  return x;
}

std::vector<double> numbersAt(const nlohmann::json& v, std::size_t n, const std::string& path) {
  if (!v.is_array() || v.size() != n)
    throw JsonFault{"A list of " + std::to_string(n) + " numbers is expected here.", path};
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(numberAt(v[i], pointerTo(path, i)));
  return out;
}

}  // namespace vernier::measure
