// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: v and f. Lines and points draw no surface, groups and materials no shape; free-form curves
// and surfaces are refused by name.
#include <algorithm>

#include "Readers.h"
#include "TextTokens.h"

namespace vernier::surface {
namespace {

constexpr std::string_view kIgnored[] = {
    "vn",  "vt", "vp",     "g",      "o",     "s",        "usemtl",   "mtllib",     "l",        "p",
    "lod", "mg", "maplib", "usemap", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj"};

// "7", "7/1", "7//3", "-1/2/3": the part before the first slash, counted from 1 or back from the last point.
std::optional<std::uint32_t> cornerOf(std::string_view word, std::size_t points) {
  const auto n = asInteger(word.substr(0, word.find('/')));
  const auto count = static_cast<std::int64_t>(points);
  if (!n || *n == 0 || *n > count || *n < -count) return std::nullopt;
  return static_cast<std::uint32_t>(*n > 0 ? *n - 1 : count + *n);
}

class ObjReader {
 public:
  ObjReader(std::string_view bytes, Polygons& out) : bytes_(bytes), out_(out) {}

  Result<void> read() {
    for (std::size_t at = 0; at < bytes_.size();) {
      ++line_;
      if (Result<void> ok = readLine(nextLine(at)); !ok) return ok;
    }
    if (out_.points() == 0)
      return makeError(ErrorCode::FormatUnknown,
                       "This is no OBJ file with a surface: it has no line 'v x y z' and 'f 1 2 3'.");
    return {};
  }

 private:
  // A backslash joins a line with the next one.
  std::string_view nextLine(std::size_t& at) {
    joined_.clear();
    for (;;) {
      const std::size_t end = std::min(bytes_.find('\n', at), bytes_.size());
      std::string_view line = bytes_.substr(at, end - at);
      at = std::min(end + 1, bytes_.size());
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (!line.ends_with('\\') || at == bytes_.size()) {
        if (joined_.empty()) return line;
        return joined_ += line;
      }
      joined_.append(line.substr(0, line.size() - 1)) += ' ';
      ++line_;
    }
  }

  Result<void> readLine(std::string_view line) {
    TextTokens words(line, "", '#');
    const std::string_view key = words.next();
    if (key.empty()) return {};
    if (key == "v") return readVertex(words);
    if (key == "f" || key == "fo") return readFace(words);
    if (std::find(std::begin(kIgnored), std::end(kIgnored), key) != std::end(kIgnored)) return {};
    return makeError(out_.points() > 0 ? ErrorCode::NotBuiltYet : ErrorCode::FormatUnknown,
                     "Line " + std::to_string(line_) + ": " + shown(key) +
                         " is not read; only polygons (v, f) are: save the surface as such.");
  }

  Result<void> readVertex(TextTokens& words) {
    glm::dvec3 p;
    for (int i = 0; i < 3; ++i) {
      const auto x = asNumber(words.next());
      if (!x) return damaged("'v' needs three numbers.");
      p[i] = *x;
    }
    out_.point(p);
    return {};
  }

  Result<void> readFace(TextTokens& words) {
    corners_.clear();
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      const auto corner = cornerOf(word, out_.points());
      if (!corner)
        return damaged("'f' names " + shown(word) + ", but there are " + std::to_string(out_.points()) +
                       " points before this line (counted from 1).");
      corners_.push_back(*corner);
    }
    if (corners_.size() < 3) return damaged("A face has at least three corners.");
    Result<void> ok = out_.polygon(corners_);
    if (!ok && ok.error().code == ErrorCode::FileDamaged) return damaged(ok.error().sentence);
    return ok;
  }

  Error damaged(const std::string& sentence) const {
    return makeError(ErrorCode::FileDamaged, "Line " + std::to_string(line_) + ": " + sentence);
  }

  std::string_view bytes_;
  Polygons& out_;
  std::string joined_;
  std::vector<std::uint32_t> corners_;
  std::size_t line_ = 0;
};

}  // namespace

Result<void> readObj(std::string_view bytes, Polygons& out, SurfaceFile& file) {
  file.format = "OBJ";
  return ObjReader(bytes, out).read();
}

}  // namespace vernier::surface
