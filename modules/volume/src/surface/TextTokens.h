// SPDX-License-Identifier: GPL-3.0-or-later
// Words of a text file with the line that they stand on. No copies, no allocation.
#pragma once
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "vernier/base/Result.h"

namespace vernier::surface {

class TextTokens {
 public:
  // `alone`: characters that are words of their own ("{}[]"). A comma is a space; `comment` runs to the
  // line's end.
  TextTokens(std::string_view text, std::string_view alone, char comment)
      : text_(text), alone_(alone), comment_(comment) {}

  // "" at the end.
  std::string_view next() {
    skipSpace();
    const std::size_t begin = at_;
    if (begin == text_.size()) return {};
    if (alone_.find(text_[begin]) != std::string_view::npos) return text_.substr(at_++, 1);
    if (text_[begin] == '"') return quoted();
    while (at_ < text_.size() && !isSpace(text_[at_]) && alone_.find(text_[at_]) == std::string_view::npos)
      ++at_;
    return text_.substr(begin, at_ - begin);
  }
  std::string_view peek() {
    const std::size_t at = at_, line = line_;
    const std::string_view word = next();
    at_ = at, line_ = line;
    return word;
  }
  // What is left of the current line.
  std::string_view restOfLine() {
    const std::size_t begin = at_, end = std::min(text_.find('\n', at_), text_.size());
    at_ = end;
    return text_.substr(begin, end - begin);
  }
  std::size_t line() const { return line_; }
  std::size_t offset() const { return at_; }

  Error damaged(const std::string& sentence) const {
    return makeError(ErrorCode::FileDamaged, "Line " + std::to_string(line_) + ": " + sentence);
  }

 private:
  static bool isSpace(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == '\0';
  }
  void skipSpace() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') ++line_;
      if (comment_ != '\0' && c == comment_) {
        at_ = std::min(text_.find('\n', at_), text_.size());
        if (at_ == text_.size()) return;
        ++line_;
      } else if (!isSpace(c)) {
        return;
      }
    }
  }
  std::string_view quoted() {
    const std::size_t begin = at_++;
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
    }
    at_ = std::min(at_ + 1, text_.size());
    return text_.substr(begin, at_ - begin);
  }

  std::string_view text_, alone_;
  char comment_;
  std::size_t at_ = 0, line_ = 1;
};

// A whole word as a number. Too large for double is infinity, too small is 0: neither is a damaged file.
inline std::optional<double> asNumber(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double x = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    const std::size_t e = word.find_first_of("eE");
    return e != std::string_view::npos && word.substr(e + 1).starts_with('-') ? 0.0 : HUGE_VAL;
  }
  if (error != std::errc()) return std::nullopt;
  return x;
}

inline std::optional<std::int64_t> asInteger(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  std::int64_t x = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return x;
}

// What an error may show of a word from a file: short and printable.
inline std::string shown(std::string_view word) {
  std::string out(word.substr(0, 32));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
  return word.empty() ? "the end of the file" : "'" + out + "'";
}

}  // namespace vernier::surface
