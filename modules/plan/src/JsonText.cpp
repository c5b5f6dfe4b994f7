// SPDX-License-Identifier: GPL-3.0-or-later
#include "JsonText.h"

#include <set>

#include "vernier/plan/SceneJson.h"

namespace vernier {
namespace {

// Where the parser is: one frame for each open object or array.
class Track {
 public:
  void open(bool array) { frames_.push_back({array, 0, "", {}}); }
  void close() {
    frames_.pop_back();
    next();
  }
  void key(const std::string& name) {
    Frame& f = frames_.back();
    f.key = name;
    if (!f.keys.insert(name).second)
      throw JsonFault{"The key '" + name + "' stands here twice; keep one.", path()};
  }
  void next() {
    if (frames_.empty()) return;
    if (frames_.back().array) ++frames_.back().index;
    frames_.back().key.clear();
  }
  std::string path() const {
    std::string p;
    for (const Frame& f : frames_) {
      if (f.array)
        p = pointerTo(p, f.index);
      else if (!f.key.empty())
        p = pointerTo(p, f.key);
    }
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

void checkLimits(std::string_view text) {
  if (text.size() > kMaxSceneBytes)
    throw JsonFault{"The scene's text has " + std::to_string(text.size()) + " bytes, at most " +
                        std::to_string(kMaxSceneBytes) + " are read.",
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
      if (++depth > kMaxSceneDepth)
        throw JsonFault{"The scene is nested deeper than " + std::to_string(kMaxSceneDepth) + " levels.", ""};
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

// Walks over JSON text that is known to be right.
class Walker {
 public:
  explicit Walker(std::string_view text) : text_(text) {}
  void skipSpace() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\n' || text_[at_] == '\t' || text_[at_] == '\r'))
      ++at_;
  }
  char peek() {
    skipSpace();
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  // One value of any kind, as it stands.
  std::string_view value() {
    skipSpace();
    const std::size_t begin = at_;
    int depth = 0;
    do {
      const char c = peek();
      if (c == '"') {
        string();
      } else {
        if (c == '{' || c == '[') ++depth;
        if (c == '}' || c == ']') --depth;
        ++at_;
      }
    } while (at_ < text_.size() && (depth > 0 || !ends()));
    return text_.substr(begin, at_ - begin);
  }

 private:
  void string() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    if (at_ < text_.size()) ++at_;
  }
  bool ends() const { return std::string_view(",:}] \n\t\r").find(text_[at_]) != std::string_view::npos; }
  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::string pointerTo(const std::string& parent, const std::string& key) {
  std::string out = parent + "/";
  for (char c : key) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}
std::string pointerTo(const std::string& parent, std::size_t index) {
  return parent + "/" + std::to_string(index);
}

nlohmann::json parseJson(std::string_view text) {
  using Json = nlohmann::json;
  checkLimits(text);
  Track track;
  const auto follow = [&](int, Json::parse_event_t event, Json& value) {
    switch (event) {
      case Json::parse_event_t::object_start:
        track.open(false);
        break;
      case Json::parse_event_t::array_start:
        track.open(true);
        break;
      case Json::parse_event_t::object_end:
      case Json::parse_event_t::array_end:
        track.close();
        break;
      case Json::parse_event_t::key:
        track.key(value.get_ref<const std::string&>());
        break;
      case Json::parse_event_t::value:
        track.next();
        break;
    }
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), follow);
  } catch (const Json::parse_error& e) {
    throw JsonFault{
        "The text is not JSON from byte " + std::to_string(e.byte) +
            " on (a comma, a quote or a bracket too many or missing, or a value that JSON does not have).",
        track.path()};
  } catch (const Json::out_of_range&) {
    throw JsonFault{"The number is too large for a double.", track.path()};
  }
}

std::vector<std::string> elementTexts(std::string_view text, std::string_view key) {
  std::vector<std::string> elements;
  Walker w(text);
  w.take('{');
  while (w.peek() == '"') {
    const nlohmann::json name = nlohmann::json::parse(w.value());
    w.take(':');
    if (name != key || !w.take('[')) {
      w.value();
    } else {
      while (w.peek() != ']') {
        elements.push_back(withoutSpace(w.value()));
        w.take(',');
      }
      return elements;
    }
    w.take(',');
  }
  return elements;
}

std::string withMember(std::string_view text, std::string_view key, std::string_view value) {
  Walker w(text);
  w.take('{');
  bool any = false;
  while (w.peek() == '"') {
    any = true;
    const nlohmann::json name = nlohmann::json::parse(w.value());
    w.take(':');
    const std::string_view old = w.value();
    if (name == key) {
      const auto at = static_cast<std::size_t>(old.data() - text.data());
      return std::string(text.substr(0, at)).append(value).append(text.substr(at + old.size()));
    }
    w.take(',');
  }
  const std::string name = nlohmann::json(key).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string out(text.substr(0, text.rfind('}')));
  return out.append(any ? "," : "").append(name).append(":").append(value).append("}");
}

std::string withoutSpace(std::string_view text) {
  std::string out;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (!inString && (c == ' ' || c == '\n' || c == '\t' || c == '\r')) continue;
    out += c;
    if (inString && c == '\\' && i + 1 < text.size()) out += text[++i];
    if (c == '"') inString = !inString;
  }
  return out;
}

}  // namespace vernier
