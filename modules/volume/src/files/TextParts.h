// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces of text headers.
#pragma once
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vernier {

inline std::string_view trimmed(std::string_view s) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = s.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return s.substr(first, s.find_last_not_of(kBlank) - first + 1);
}

inline std::string lowerCase(std::string_view s) {
  std::string out(s);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

inline std::vector<std::string_view> words(std::string_view s) {
  std::vector<std::string_view> out;
  for (s = trimmed(s); !s.empty(); s = trimmed(s)) {
    const std::size_t end = std::min(s.find_first_of(" \t"), s.size());
    out.push_back(s.substr(0, end));
    s.remove_prefix(end);
  }
  return out;
}

// A number that fills the whole word; "+5", "nan" and "inf" are numbers.
template <class T>
std::optional<T> numberIn(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  T x{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return x;
}

template <class T>
std::optional<std::vector<T>> numbersIn(std::string_view s) {
  std::vector<T> out;
  for (const std::string_view w : words(s)) {
    const auto x = numberIn<T>(w);
    if (!x) return std::nullopt;
    out.push_back(*x);
  }
  return out;
}

}  // namespace vernier
