// SPDX-License-Identifier: GPL-3.0-or-later
#include "Text.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <memory>

namespace vernier {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

// One code element of ISO 2022 as PS3.3 Tables C.12-2 to C.12-4 list them.
struct CodeElement {
  int ir;              // the registration number in the defined term
  const char* escape;  // what follows ESC
  bool g1;             // used by bytes with the high bit set
  bool twoBytes;
  const char* iconvName;
  enum Shape { AsIs, SetHighBits, Ss3 } shape;  // how its bytes become the iconv code
};
constexpr CodeElement kElements[] = {
    {6, "(B", false, false, "ASCII", CodeElement::AsIs},
    {100, "-A", true, false, "ISO-8859-1", CodeElement::AsIs},
    {101, "-B", true, false, "ISO-8859-2", CodeElement::AsIs},
    {109, "-C", true, false, "ISO-8859-3", CodeElement::AsIs},
    {110, "-D", true, false, "ISO-8859-4", CodeElement::AsIs},
    {144, "-L", true, false, "ISO-8859-5", CodeElement::AsIs},
    {127, "-G", true, false, "ISO-8859-6", CodeElement::AsIs},
    {126, "-F", true, false, "ISO-8859-7", CodeElement::AsIs},
    {138, "-H", true, false, "ISO-8859-8", CodeElement::AsIs},
    {148, "-M", true, false, "ISO-8859-9", CodeElement::AsIs},
    {203, "-b", true, false, "ISO-8859-15", CodeElement::AsIs},
    {166, "-T", true, false, "TIS-620", CodeElement::AsIs},
    {13, ")I", true, false, "SHIFT_JIS", CodeElement::AsIs},  // half-width katakana
    {14, "(J", false, false, "ASCII", CodeElement::AsIs},     // JIS X 0201 romaji
    {87, "$B", false, true, "EUC-JP", CodeElement::SetHighBits},
    {159, "$(D", false, true, "EUC-JP", CodeElement::Ss3},
    {149, "$)C", true, true, "EUC-KR", CodeElement::AsIs},
    {58, "$)A", true, true, "EUC-CN", CodeElement::AsIs},
};
const CodeElement* byNumber(int ir) {
  for (const CodeElement& e : kElements)
    if (e.ir == ir) return &e;
  return nullptr;
}
const CodeElement* byEscape(std::string_view rest) {
  for (const CodeElement& e : kElements)
    if (rest.starts_with(e.escape)) return &e;
  return nullptr;
}

// Converters stay open: opening one costs more than most texts.
class Converter {
 public:
  explicit Converter(const char* from) : name_(from), cd_(iconv_open("UTF-8", from)) {}
  Converter(const Converter&) = delete;
  Converter& operator=(const Converter&) = delete;
  ~Converter() {
    if (open()) iconv_close(cd_);
  }
  bool open() const { return cd_ != reinterpret_cast<iconv_t>(-1); }
  std::string_view name() const { return name_; }
  bool convert(std::string in, DecodedText& out) {
    if (!open()) {
      out.utf8 += kReplacement;
      return !(out.damaged = true);
    }
    iconv(cd_, nullptr, nullptr, nullptr, nullptr);
    char* from = in.data();
    std::size_t left = in.size();
    while (left > 0) {
      std::array<char, 512> buffer;
      char* to = buffer.data();
      std::size_t room = buffer.size();
      const std::size_t rc = iconv(cd_, &from, &left, &to, &room);
      out.utf8.append(buffer.data(), buffer.size() - room);
      if (rc != static_cast<std::size_t>(-1) || errno == E2BIG) continue;
      out.utf8 += kReplacement;  // this byte is no character here; go on behind it
      out.damaged = true;
      ++from;
      --left;
    }
    return !out.damaged;
  }

 private:
  std::string name_;
  iconv_t cd_;
};

void convert(const char* from, std::string bytes, DecodedText& out) {
  thread_local std::vector<std::unique_ptr<Converter>> open;
  auto it = std::find_if(open.begin(), open.end(), [&](const auto& c) { return c->name() == from; });
  if (it == open.end()) it = open.insert(open.end(), std::make_unique<Converter>(from));
  (*it)->convert(std::move(bytes), out);
}

// The number in "ISO_IR 100", "ISO 2022 IR 87" and their common misspellings; 6 for an empty term; -1
// unknown.
int registration(const std::string& term) {
  if (term.empty()) return 6;
  std::size_t end = term.size(), begin = end;
  while (begin > 0 && term[begin - 1] >= '0' && term[begin - 1] <= '9') --begin;
  if (begin == end || end - begin > 4 || term.find("IR") == std::string::npos) return -1;
  return std::stoi(term.substr(begin));
}

// Characters that bring back the first character set (PS3.5 6.1.2.5.3).
bool resets(char c, bool personName) {
  return c == '\\' || c == '\r' || c == '\n' || c == '\f' || c == '\t' ||
         (personName && (c == '^' || c == '='));
}

DecodedText decodeIso2022(std::string_view in, const std::vector<std::string>& charset, bool personName) {
  const int first = charset.empty() ? 6 : registration(charset[0]);
  const CodeElement* const ascii = byNumber(6);
  const CodeElement* g0First = ascii;
  const CodeElement* g1First = nullptr;
  if (const CodeElement* e = byNumber(first)) (e->g1 ? g1First : g0First) = e;
  // Files that name a two-byte set in first place mean ASCII until an escape comes.
  if (g0First->twoBytes) g0First = ascii;
  const CodeElement* g0 = g0First;
  const CodeElement* g1 = g1First;

  DecodedText out;
  std::string run;
  const CodeElement* runOf = nullptr;
  const auto flush = [&] {
    if (run.empty()) return;
    if (runOf)
      convert(runOf->iconvName, run, out);
    else {
      for (std::size_t i = 0; i < run.size(); ++i) out.utf8 += kReplacement;
      out.damaged = true;
    }
    run.clear();
  };
  const auto add = [&](const CodeElement* e, std::string_view bytes) {
    if (e != runOf) flush();
    runOf = e;
    run += bytes;
  };
  for (std::size_t i = 0; i < in.size();) {
    const char c = in[i];
    if (c == '\x1b') {
      const CodeElement* e = byEscape(in.substr(i + 1));
      flush();
      if (!e) {
        out.utf8 += kReplacement;
        out.damaged = true;
        ++i;
        continue;
      }
      (e->g1 ? g1 : g0) = e;
      i += 1 + std::string_view(e->escape).size();
      continue;
    }
    const bool high = static_cast<unsigned char>(c) >= 0x80;
    const bool control = static_cast<unsigned char>(c) < 0x21;  // also in a two-byte set these stand alone
    const CodeElement* e = high ? g1 : g0;
    if (!high && (control || !g0->twoBytes)) {
      if (resets(c, personName)) {
        g0 = g0First;
        g1 = g1First;
      }
      if (g0->ir == 14 && c == '~') {
        flush();
        out.utf8 += "\xE2\x80\xBE";  // JIS X 0201 has an overline there
      } else {
        add(ascii, in.substr(i, 1));
      }
      ++i;
      continue;
    }
    const std::size_t n = e && e->twoBytes ? 2 : 1;
    std::string bytes(in.substr(i, n));
    if (e && e->shape != CodeElement::AsIs)
      for (char& b : bytes) b = static_cast<char>(b | 0x80);
    if (e && e->shape == CodeElement::Ss3) bytes.insert(0, 1, '\x8f');
    add(e, bytes);
    i += n;
  }
  flush();
  return out;
}

bool plainAscii(std::string_view s) {
  return std::all_of(s.begin(), s.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x80 && c != '\x1b'; });
}

}  // namespace

DecodedText decodeText(std::string_view in, const std::vector<std::string>& charset, bool personName) {
  while (!in.empty() && (in.back() == ' ' || in.back() == '\0')) in.remove_suffix(1);
  DecodedText out;
  const std::string term = charset.empty() ? std::string() : charset[0];
  if (plainAscii(in))
    out.utf8 = std::string(in);
  else if (term == "ISO_IR 192" || term == "ISO 2022 IR 192")
    convert("UTF-8", std::string(in), out);
  else if (term == "GB18030")
    convert("GB18030", std::string(in), out);
  else if (term == "GBK")
    convert("GBK", std::string(in), out);
  else
    out = decodeIso2022(in, charset, personName);
  if (personName)
    while (!out.utf8.empty() && (out.utf8.back() == '=' || out.utf8.back() == ' ')) out.utf8.pop_back();
  return out;
}

std::vector<std::string> splitValues(std::string_view text, char by) {
  std::vector<std::string> values;
  if (text.empty()) return values;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(text.find(by, begin), text.size());
    std::string_view v = text.substr(begin, end - begin);
    while (!v.empty() && (v.back() == ' ' || v.back() == '\0')) v.remove_suffix(1);
    while (!v.empty() && v.front() == ' ') v.remove_prefix(1);
    values.emplace_back(v);
    if (end == text.size()) return values;
    begin = end + 1;
  }
}

std::optional<double> parseDecimal(std::string_view s) {
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  double v = 0;
  const auto [end, wrong] = std::from_chars(s.data(), s.data() + s.size(), v);
  if (s.empty() || wrong != std::errc{} || end != s.data() + s.size()) return std::nullopt;
  return v;
}
std::optional<std::int64_t> parseInteger(std::string_view s) {
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  std::int64_t v = 0;
  const auto [end, wrong] = std::from_chars(s.data(), s.data() + s.size(), v);
  if (s.empty() || wrong != std::errc{} || end != s.data() + s.size()) return std::nullopt;
  return v;
}

}  // namespace vernier
