// SPDX-License-Identifier: GPL-3.0-or-later
// STL: 80 bytes of header, a count, 50 bytes per facet; or text. The facets' own normals are not used: three
// corners say the same.
#include <algorithm>
#include <bit>
#include <cstring>

#include "Readers.h"
#include "TextTokens.h"

namespace vernier::surface {
namespace {

constexpr std::uint64_t kHeader = 84, kFacet = 50;

static_assert(std::endian::native == std::endian::little, "STL is little endian");

template <class T>
T at(std::string_view bytes, std::size_t offset) {
  T x;
  std::memcpy(&x, bytes.data() + offset, sizeof x);
  return x;
}

bool sameWord(std::string_view a, std::string_view lower) {
  return a.size() == lower.size() && std::equal(a.begin(), a.end(), lower.begin(), [](char x, char y) {
           return (x >= 'A' && x <= 'Z' ? static_cast<char>(x + 32) : x) == y;
         });
}

// How many facets a binary file holds: what it declares, if its bytes agree.
Result<std::uint64_t> facetsOf(std::string_view bytes, SurfaceFile& file) {
  const std::uint64_t declared = at<std::uint32_t>(bytes, 80), room = (bytes.size() - kHeader) / kFacet;
  file.declaredTriangles = declared;
  file.bytesExpected = kHeader + kFacet * declared;
  const bool whole = (bytes.size() - kHeader) % kFacet == 0;
  if (declared == room && whole) return declared;
  const auto found = [&](std::string sentence) {
    file.findings.push_back(
        {"declared-count",
         Severity::Warning,
         std::move(sentence),
         {{"declared", static_cast<double>(declared)}, {"room", static_cast<double>(room)}}});
  };
  if ((declared == 0 || declared == 0xFFFFFFFF) && whole && room > 0) {
    found("The file does not say how many triangles it has; as many as its size holds are read: " +
          std::to_string(room) + ".");
    return room;
  }
  if (declared > room)
    return makeError(ErrorCode::FileDamaged,
                     "The file declares " + std::to_string(declared) + " triangles, which need " +
                         std::to_string(*file.bytesExpected) + " bytes, but it has " +
                         std::to_string(bytes.size()) + "; it is cut short: fetch it again.");
  found("The file has " + std::to_string(bytes.size() - *file.bytesExpected) + " bytes more than its " +
        std::to_string(declared) + " triangles need; only those are read.");
  return declared;
}

Result<void> readBinary(std::string_view bytes, Polygons& out, SurfaceFile& file) {
  file.format = "binary STL";
  const Result<std::uint64_t> facets = facetsOf(bytes, file);
  if (!facets) return facets.error();
  out.reserve(*facets);
  for (std::uint64_t i = 0; i < *facets; ++i) {
    float v[9];
    std::memcpy(v, bytes.data() + kHeader + kFacet * i + 12, sizeof v);
    if (Result<void> ok = out.triangle({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}); !ok)
      return ok;
  }
  return {};
}

// "outer loop", three vertices, "endloop", "endfacet".
Result<void> readFacet(TextTokens& words, Polygons& out) {
  const auto expect = [&](const char* word) { return sameWord(words.next(), word); };
  glm::dvec3 corner[3];
  const auto numbers = [&](glm::dvec3& v) {
    for (int i = 0; i < 3; ++i) {
      const auto x = asNumber(words.next());
      if (!x) return false;
      v[i] = *x;
    }
    return true;
  };
  if (!expect("normal") || !numbers(corner[0]))
    return words.damaged("'normal' and three numbers are expected.");
  if (!expect("outer") || !expect("loop")) return words.damaged("'outer loop' is expected.");
  for (glm::dvec3& v : corner)
    if (!expect("vertex") || !numbers(v)) return words.damaged("'vertex' and three numbers are expected.");
  if (!expect("endloop") || !expect("endfacet"))
    return words.damaged("'endloop' and 'endfacet' are expected after three vertices.");
  return out.triangle(corner[0], corner[1], corner[2]);
}

Result<void> readText(std::string_view bytes, Polygons& out, SurfaceFile& file) {
  file.format = "text STL";
  TextTokens words(bytes, "", '\0');
  bool inside = false;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (sameWord(word, inside ? "endsolid" : "solid")) {
      (void)words.restOfLine();  // its name
      inside = !inside;
    } else if (inside && sameWord(word, "facet")) {
      if (Result<void> ok = readFacet(words, out); !ok) return ok;
    } else {
      return words.damaged(std::string(inside ? "'facet' or 'endsolid'" : "'solid'") + " is expected, not " +
                           shown(word) + ".");
    }
  }
  if (inside)
    file.findings.push_back({"end-missing",
                             Severity::Warning,
                             "The text ends without 'endsolid': it may be cut short after a whole triangle.",
                             {}});
  return {};
}

bool isText(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 4096);
  return std::none_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t';
  });
}

}  // namespace

Result<void> readStl(std::string_view bytes, Polygons& out, SurfaceFile& file) {
  // Many binary files begin with "solid" too: the size decides first.
  const bool sizeFits =
      bytes.size() >= kHeader && bytes.size() == kHeader + kFacet * at<std::uint32_t>(bytes, 80);
  TextTokens words(bytes, "", '\0');
  if (!sizeFits && isText(bytes)) {
    if (sameWord(words.next(), "solid")) return readText(bytes, out, file);
    return makeError(
        ErrorCode::FormatUnknown,
        "This is text, but no STL: STL text begins with 'solid'; the file's name says more than it is.");
  }
  if (bytes.size() < kHeader)
    return makeError(ErrorCode::FileDamaged, "A binary STL has a header of 84 bytes, this file has " +
                                                 std::to_string(bytes.size()) + "; fetch it again.");
  return readBinary(bytes, out, file);
}

}  // namespace vernier::surface
