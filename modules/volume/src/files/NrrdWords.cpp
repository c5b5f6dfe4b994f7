// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/NrrdWords.h"

#include <algorithm>

#include "files/TextParts.h"

namespace vernier {

Result<NrrdLines> splitNrrdLines(std::string_view text) {
  NrrdLines out;
  std::size_t at = std::min(text.find('\n'), text.size() - 1) + 1;  // behind the magic
  while (at < text.size()) {
    const std::size_t eol = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, eol - at);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at = std::min(eol + 1, text.size());
    out.end = at;
    if (line.empty()) {
      out.closed = true;
      return out;
    }
    if (line.front() == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
      return makeError(
          ErrorCode::FileDamaged,
          "The NRRD header cannot be used: a line is neither a field, a key, a comment nor blank.");
    if (line.substr(colon).starts_with(":=")) continue;
    out.fields[lowerCase(trimmed(line.substr(0, colon)))] = std::string(trimmed(line.substr(colon + 1)));
  }
  return out;
}

std::optional<FileType> nrrdType(std::string_view name) {
  static const std::map<std::string_view, FileType> kTypes{{"signed char", FileType::I8},
                                                           {"int8", FileType::I8},
                                                           {"int8_t", FileType::I8},
                                                           {"uchar", FileType::U8},
                                                           {"unsigned char", FileType::U8},
                                                           {"uint8", FileType::U8},
                                                           {"uint8_t", FileType::U8},
                                                           {"short", FileType::I16},
                                                           {"short int", FileType::I16},
                                                           {"signed short", FileType::I16},
                                                           {"signed short int", FileType::I16},
                                                           {"int16", FileType::I16},
                                                           {"int16_t", FileType::I16},
                                                           {"ushort", FileType::U16},
                                                           {"unsigned short", FileType::U16},
                                                           {"unsigned short int", FileType::U16},
                                                           {"uint16", FileType::U16},
                                                           {"uint16_t", FileType::U16},
                                                           {"int", FileType::I32},
                                                           {"signed int", FileType::I32},
                                                           {"int32", FileType::I32},
                                                           {"int32_t", FileType::I32},
                                                           {"uint", FileType::U32},
                                                           {"unsigned int", FileType::U32},
                                                           {"uint32", FileType::U32},
                                                           {"uint32_t", FileType::U32},
                                                           {"longlong", FileType::I64},
                                                           {"long long", FileType::I64},
                                                           {"long long int", FileType::I64},
                                                           {"signed long long", FileType::I64},
                                                           {"signed long long int", FileType::I64},
                                                           {"int64", FileType::I64},
                                                           {"int64_t", FileType::I64},
                                                           {"ulonglong", FileType::U64},
                                                           {"unsigned long long", FileType::U64},
                                                           {"unsigned long long int", FileType::U64},
                                                           {"uint64", FileType::U64},
                                                           {"uint64_t", FileType::U64},
                                                           {"float", FileType::F32},
                                                           {"double", FileType::F64}};
  const auto it = kTypes.find(name);
  return it == kTypes.end() ? std::nullopt : std::optional(it->second);
}

std::optional<std::int64_t> nrrdValuesPerVoxel(std::string_view kind) {
  static const std::map<std::string_view, std::int64_t> kKinds{
      {"3-color", 3},  {"rgb-color", 3}, {"4-color", 4}, {"rgba-color", 4},
      {"3-vector", 3}, {"4-vector", 4},  {"vector", 0}};
  const auto it = kKinds.find(kind);
  return it == kKinds.end() ? std::nullopt : std::optional(it->second);
}

}  // namespace vernier
